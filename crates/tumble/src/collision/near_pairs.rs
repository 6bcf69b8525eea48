//! Pairs of colliders that are near each other: the broad phase's candidates, tested and sorted by
//! the kind of their shapes.

use rayon::prelude::*;
use tumble_collide::{BroadPhase, Proxy};

use crate::collision::collider::Groups;
use crate::collision::collider_state::{Activity, ColliderState, ColliderStates};
use crate::collision::narrow_phase::{LaneKind, Pairs};
use crate::collision::pair_limit::{PairLimit, most_listed};
use crate::joints::joint_list::JointList;
use crate::math::Real;
use crate::storage::body_index::Slot;
use crate::threads::InParts;

/// The pairs of a substep.
#[derive(Clone, Default)]
pub(crate) struct NearPairs {
    pub(crate) limit: PairLimit,
    /// In parts that threads find, before they are sorted.
    found: Vec<Vec<NearPair>>,
    pub(crate) cuboids: Pairs,
    pub(crate) spheres: Pairs,
    /// Of shapes without lanes of their own.
    pub(crate) others: Vec<[Slot; 2]>,
    /// Sensors, each with a body near it.
    pub(crate) sensed: Vec<[Slot; 2]>,
}

/// What colliders are in the search for pairs.
#[derive(Clone, Copy)]
pub(crate) struct Roles<'a> {
    /// By slot.
    pub(crate) groups: &'a [Groups],
    /// The same; empty where there are no sensors.
    pub(crate) sensors: &'a [SensorRole],
}

/// Whether a collider, or some of its parts, are sensors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SensorRole {
    pub(crate) has_sensor: bool,
    pub(crate) has_solid: bool,
}

/// A pair with the kind of its shapes.
pub(crate) type NearPair = (LaneKind, [Slot; 2]);

/// Candidates that one thread takes at a time.
const PART: usize = 1024;

impl NearPairs {
    /// Finds the pairs that may touch, and sorts them by the kind of their shapes. Where only one
    /// of two is dynamic, it is the second.
    pub(crate) fn find(
        &mut self,
        collider_states: &ColliderStates,
        roles: Roles<'_>,
        broad_phase: &mut BroadPhase<Real>,
        joints: &JointList,
    ) {
        let Self { found, limit, cuboids, spheres, others, sensed } = self;
        let ColliderStates { states, activity, proxies, .. } = collider_states;
        let searched = collider_states.searched();
        let Roles { groups, sensors } = roles;
        let is_awake = |slot: u32| activity[slot as usize] == Activity::Awake;
        let senses =
            |a: u32, b: u32| [a, b].iter().any(|slot| sensors.get(*slot as usize).is_some_and(|it| it.has_sensor));
        let pushes = |a: u32, b: u32| {
            let are_solid = [a, b].iter().all(|slot| sensors.get(*slot as usize).is_none_or(|it| it.has_solid));
            are_solid && (is_awake(a) || is_awake(b)) && !joints.keeps_apart([Slot(a), Slot(b)])
        };
        let are_near = |of: &[Proxy<Real>], a: u32, b: u32| of[a as usize].is_near(&of[b as usize]);
        let wanted = |a: u32, b: u32| {
            groups[a as usize].touch(groups[b as usize]) && (senses(a, b) || !joints.keeps_apart([Slot(a), Slot(b)]))
        };
        let mut parts = 1;
        sensed.clear();
        if let Some(candidates) = broad_phase.update_within(searched, most_listed(searched.len()), wanted) {
            parts = candidates.len().div_ceil(PART);
            found.resize_with(parts.max(found.len()), Vec::new);
            candidates.par_chunks(PART).zip(&mut *found).by_at_least(2).for_each(|(candidates, near)| {
                near.clear();
                for &(first, second) in candidates {
                    // Which others are candidates depends on what was before; the contacts must
                    // not.
                    let is_sought = is_awake(first) || is_awake(second) || !sensors.is_empty();
                    if is_sought && are_near(searched, first, second) {
                        near.push(near_pair(states, (first, second)));
                    }
                }
            });
            if !sensors.is_empty() {
                let all = || found[..parts].iter().flatten().map(|(_, slots)| slots);
                sensed.extend(all().flat_map(|slots| sensed_in(*slots, states, sensors)));
                // What sensors look ahead finds no contacts.
                let touches = |[a, b]: [Slot; 2]| are_near(proxies, a.0, b.0) && pushes(a.0, b.0);
                found[..parts].iter_mut().for_each(|near| near.retain(|(_, slots)| touches(*slots)));
            }
            limit.thin_out(&mut found[..parts], proxies);
        } else {
            found.resize_with(found.len().max(1), Vec::new);
            found[0].clear();
            if !sensors.is_empty() {
                broad_phase.for_each_pair(searched, senses, |a, b| {
                    if wanted(a, b) && are_near(searched, a, b) {
                        sensed.extend(sensed_in([Slot(a), Slot(b)], states, sensors));
                    }
                });
            }
            let kept = limit.nearest_pairs(proxies, broad_phase, |a, b| wanted(a, b) && pushes(a, b));
            found[0].extend(kept.into_iter().map(|[a, b]| near_pair(states, (a, b))));
        }
        sensed.sort_unstable();
        cuboids.clear();
        spheres.clear();
        others.clear();
        for &(kind, slots) in found[..parts].iter().flatten() {
            match kind {
                LaneKind::Cuboid => cuboids.push(slots),
                LaneKind::Sphere => spheres.push(slots),
                LaneKind::Other => others.push(slots),
            }
        }
    }
}

/// Those of two that sense the other, each first.
fn sensed_in<'a>(
    [a, b]: [Slot; 2],
    states: &'a [ColliderState],
    sensors: &'a [SensorRole],
) -> impl Iterator<Item = [Slot; 2]> + 'a {
    let is_sensed = move |[sensor, other]: &[Slot; 2]| {
        let are_fixed = states[sensor.index()].is_fixed && states[other.index()].is_fixed;
        sensors[sensor.index()].has_sensor && sensors[other.index()].has_solid && !are_fixed
    };
    [[a, b], [b, a]].into_iter().filter(is_sensed)
}

/// A pair with the kind of its shapes. Where only one of two is dynamic, it is the second.
fn near_pair(states: &[ColliderState], (first, second): (u32, u32)) -> NearPair {
    let [p, q] = [&states[first as usize], &states[second as usize]];
    let kind = LaneKind::both(p.kind, q.kind);
    if p.is_dynamic && !q.is_dynamic {
        (kind, [Slot(second), Slot(first)])
    } else {
        (kind, [Slot(first), Slot(second)])
    }
}
