//! Pairwise forces and contacts of a world, kept between steps.

use std::fmt;

use hecs::World;

use crate::collision;
use crate::collision::contact_hook::ContactHook;
use crate::collision::pipeline::CollisionPipeline;
use crate::components::Momentum;
use crate::forces::pairwise;
use crate::forces::pairwise::PairForces;
use crate::joints;
use crate::joints::axes::Axes;
use crate::joints::axis_lock::{AxisLock, LockedSlot};
use crate::joints::joint_list::{JointEnds, JointList};
use crate::joints::locked_axes::LockedAxes;
use crate::solver::constrained_bodies::ConstrainedBodies;
use crate::solver::mechanism::mechanisms::Mechanisms;
use crate::solver::substeps::Solver;
use crate::storage::body_index::{BodyIndex, Slot};

/// Interactions of bodies, kept from step to step.
#[derive(Clone, Default)]
pub(crate) struct Interactions {
    pub(crate) pairs: Option<PairForces>,
    pub(crate) collision: Option<CollisionPipeline>,
    pub(crate) mechanisms: Mechanisms,
    /// The caller's.
    pub(crate) contact_hook: Option<ContactHook>,
    joint_ends: JointEnds,
    /// In the last substep; no state.
    pub(crate) constrained: ConstrainedBodies,
    /// Where contacts are not solved together with those of other worlds; no state.
    pub(crate) solver: Option<Box<Solver>>,
}

impl fmt::Debug for Interactions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { pairs, collision, mechanisms: _, contact_hook: _, joint_ends: _, constrained: _, solver: _ } = self;
        f.debug_struct("Interactions").field("pairs", pairs).field("collision", collision).finish_non_exhaustive()
    }
}

impl Interactions {
    /// Lists springs, gravity sources and colliders. To be called again when anything was spawned,
    /// despawned or changed but momentum and pose.
    pub(crate) fn update(&mut self, world: &World) {
        if pairwise::are_in(world) {
            self.pairs.get_or_insert_default().find(world);
        } else {
            self.pairs = None;
        }
        if collision::are_in(world)
            || joints::are_in(world)
            || self.collision.as_ref().is_some_and(|collision| !collision.are_over())
        {
            let Self { collision, mechanisms, joint_ends, contact_hook, constrained, .. } = self;
            let collision = collision.get_or_insert_default();
            collision.hook.clone_from(contact_hook);
            joint_ends.find(world);
            let same_slots = collision.update(world, joint_ends);
            if !same_slots {
                mechanisms.renumber(collision.cache.body_keys.renumbered(), collision.body_index.len());
            }
            let same_pairs = mechanisms.list.find(world, &collision.body_index);
            if mechanisms.list.is_empty() {
                mechanisms.passed.held.clear();
            }
            find_locked(world, &collision.body_index, &mechanisms.list, &mut constrained.locked);
            collision.notice_locks(&constrained.locked);
            if !same_pairs {
                collision.broad_phase.reset();
                if same_slots {
                    collision.notice_pairs(&mechanisms.list);
                }
            }
        } else {
            self.collision = None;
            self.mechanisms.forget();
        }
    }

    /// To be called before the first substep of every step.
    pub(crate) fn begin_step(&mut self) {
        if let Some(collision) = &mut self.collision {
            collision.begin_step();
        }
        self.mechanisms.begin_step();
    }

    /// To be called before each step of a call but the first.
    pub(crate) fn begin_next_step(&mut self) {
        self.mechanisms.list.events.begin_next_step();
        if let Some(collision) = &mut self.collision {
            collision.sensors.events.begin_next_step();
        }
    }

    /// Steps of a world without interactions: contacts end.
    pub(crate) fn pass(&mut self, world: &World, steps: u32) {
        self.mechanisms.forget();
        if let Some(collision) = self.collision.as_mut().filter(|collision| !collision.are_over()) {
            collision.pass(world, steps);
        } else {
            self.collision = None;
        }
    }
}

/// Lists the dynamic bodies with locked axes.
fn find_locked(world: &World, body_index: &BodyIndex, joints: &JointList, locked: &mut Vec<LockedSlot>) {
    locked.clear();
    for (index, archetype) in world.archetypes().enumerate() {
        let Some(column) = archetype.get::<&LockedAxes>().filter(|_| archetype.has::<Momentum>()) else { continue };
        let slots = body_index.slots_in(index);
        locked.extend(slots.iter().map(|slot| {
            let lock = AxisLock(column[body_index.place(*slot).row as usize].0);
            LockedSlot { slot: *slot, lock, has_joint: false }
        }));
    }
    locked.retain(|it| it.lock.0 != Axes::NONE);
    // As archetypes list them they would be in an order that the bodies do not have.
    locked.sort_unstable_by_key(|it| it.slot);
    if locked.is_empty() || joints.is_empty() {
        return;
    }
    let mut jointed: Vec<Slot> = joints.pairs().flatten().collect();
    jointed.sort_unstable();
    locked.iter_mut().for_each(|it| it.has_joint = jointed.binary_search(&it.slot).is_ok());
}
