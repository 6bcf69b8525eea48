//! Which bodies fall asleep and which wake when a step begins.

use tumble_math::lane::{Quat, Vec3};

use crate::collision::collider::Collider;
use crate::collision::contact::ContactRecord;
use crate::collision::contact_ways::length;
use crate::collision::pipeline::CollisionPipeline;
use crate::collision::sleep::{Rest, Sleepers, moves};
use crate::collision::traveller::energy;
use crate::components::{Momentum, Pose, Velocity, Wrench};
use crate::forces::registry::ForceLaws;
use crate::integrators::derived::derived;
use crate::joints::axis_lock::LockedSlot;
use crate::joints::joint_list::JointList;
use crate::joints::joint_marks::JointMarks;
use crate::math::{Real, Vec3 as WorldVec3};
use crate::settings::{Settings, Sleep};
use crate::storage::body_index::Slot;
use crate::storage::chunk::Chunk;
use crate::storage::world_columns::WorldColumns;

/// Poses of a body that does not move differ by less than this many roundings.
const ROUNDING: Real = 8.0;

impl CollisionPipeline {
    /// Wakes what was disturbed since the last step, and puts to sleep what has been still for long
    /// enough. `is_pulled` says of the number of an entity whether forces between bodies act on it.
    pub(crate) fn update_sleep(
        &mut self,
        columns: &mut WorldColumns<'_>,
        (settings, laws): (&Settings, &ForceLaws),
        joints: &JointList,
        is_pulled: impl Fn(u32) -> bool,
    ) {
        let Some(sleep) = settings.sleep else {
            if !self.sleepers.rests.is_empty() {
                self.sleepers.end(&mut self.contacts.records);
                self.joint_marks = JointMarks::default();
            }
            self.sleepers.disturbed.clear();
            self.sleepers.changed.clear();
            return;
        };
        // What was laid into the air is still when its first step begins, and not after that.
        let sleep = Sleep { time: sleep.time.max(2.0 * settings.dt), ..sleep };
        self.sleepers.rests.resize(self.body_index.len(), Rest::UNKNOWN);
        self.notice_joints(joints);
        let knows_all = self.sleepers.are_on() && !std::mem::take(&mut self.sleepers.are_restored);
        if self.sleepers.settings.replace(*settings).is_some_and(|before| before != *settings) {
            self.sleepers.disturb_all();
        }
        self.find_movers(columns, knows_all);
        self.compare_dynamic(columns, (settings, laws), &sleep, is_pulled);
        // After a restore all are with the others.
        self.sleepers.take_contacts(&mut self.contacts.records);
        self.sleepers.links.clear();
        self.sleepers.links.extend(joints.links());
        self.disturb_by_contacts((settings.dt / sleep.time).min(1.0));
        let Self { sleepers, contacts, .. } = self;
        let mut disturbed = std::mem::take(&mut sleepers.disturbed);
        for slot in sleepers.wake(&disturbed, &mut contacts.records) {
            sleepers.awake.is_dynamic[slot.index()] = true;
        }
        // What is awake begins to be still with what was changed.
        disturbed.drain(..).for_each(|slot| sleepers.rests[slot.index()].still = 0.0);
        sleepers.disturbed = disturbed;
        let has_gravity = settings.gravity != WorldVec3::ZERO;
        sleepers.find_tired(&contacts.records, &sleep, has_gravity);
        let tired = std::mem::take(&mut sleepers.tired);
        tired.iter().for_each(|slot| self.put_to_sleep(*slot, columns));
        self.sleepers.tired = tired;
        self.sleepers.take_contacts(&mut self.contacts.records);
    }

    /// Disturbs what has joints that are not as they were, or drives that oscillate.
    fn notice_joints(&mut self, joints: &JointList) {
        let Self { sleepers, joint_marks, body_index, .. } = self;
        joint_marks.update(joints, |body| sleepers.disturbed.extend(body_index.slot(body.id())));
        sleepers.disturbed.extend(joints.oscillating().flatten());
    }

    /// Disturbs bodies that are locked otherwise than in the last step.
    pub(crate) fn notice_locks(&mut self, locked: &[LockedSlot]) {
        let Self { sleepers, body_index, .. } = self;
        let now = || locked.iter().map(|it| (body_index.key(it.slot).2, it.lock.0));
        if now().eq(sleepers.locks.iter().copied()) {
            return;
        }
        if sleepers.are_on() && !sleepers.are_restored {
            let entities = now().chain(sleepers.locks.iter().copied()).map(|(entity, _)| entity);
            sleepers.disturbed.extend(entities.filter_map(|entity| body_index.slot(entity)));
        }
        sleepers.locks.clear();
        sleepers.locks.extend(now());
    }

    /// Disturbs bodies that are to touch from now on, or no longer.
    pub(crate) fn notice_pairs(&mut self, joints: &JointList) {
        if self.sleepers.are_on() && !self.sleepers.are_restored {
            self.sleepers.disturbed.extend(joints.changed_pairs().flatten());
        }
    }

    /// Finds the bodies that are not dynamic and move, or were moved or changed since the last
    /// step; `knows_all` says whether those that are not known are new.
    fn find_movers(&mut self, columns: &WorldColumns<'_>, knows_all: bool) {
        let Self { sleepers, body_index, .. } = self;
        sleepers.movers.clear();
        sleepers.changed.sort_unstable();
        for (archetype, bodies) in columns.pose_views().filter(|(_, bodies)| bodies.dynamic.is_none()) {
            for (row, slot) in body_index.slots_in(archetype).iter().enumerate() {
                let pose = Some(bodies.pose[row]);
                let rest = &mut sleepers.rests[slot.index()];
                let before = std::mem::replace(rest, Rest { pose, ..Rest::UNKNOWN });
                let is_known = before.pose.is_some() && !before.is_dynamic;
                let is_other = if is_known { before.pose != pose } else { knows_all };
                let is_changed = is_other || sleepers.changed.binary_search(slot).is_ok();
                if is_changed || moves(bodies.velocity.map(|column| &column[row])) {
                    sleepers.movers.push(*slot);
                }
                if sleepers.asleep.has(*slot) {
                    sleepers.disturbed.push(*slot);
                }
            }
        }
        let Sleepers { disturbed, changed, .. } = sleepers;
        disturbed.append(changed);
    }

    /// Compares sleeping bodies with what they were, and finds out for how long others are still.
    fn compare_dynamic(
        &mut self,
        columns: &mut WorldColumns<'_>,
        (settings, laws): (&Settings, &ForceLaws),
        sleep: &Sleep,
        is_pulled: impl Fn(u32) -> bool,
    ) {
        let Self { sleepers, body_index, colliders, .. } = self;
        let (mut awake, mut disturbed) = (std::mem::take(&mut sleepers.awake), std::mem::take(&mut sleepers.disturbed));
        awake.reset(body_index.len());
        laws.for_each_archetype_of(columns, |archetype, chunk, laws| {
            for (row, slot) in body_index.slots_in(archetype).iter().enumerate() {
                let is_asleep = sleepers.asleep.has(*slot);
                let rest = &mut sleepers.rests[slot.index()];
                let is_pulled = !laws.is_empty() || is_pulled(body_index.key(*slot).2);
                if is_asleep {
                    if rest.pose.is_none() || rest.least_speed == 0.0 {
                        let now = Rest::of(&chunk, row, colliders.get(*slot), sleep);
                        let (pose, weight) = rest.pose.map_or((now.pose, now.weight), |it| (Some(it), rest.weight));
                        *rest = Rest { pose, weight, ..now };
                    }
                    if is_pulled || rest.differs(&chunk, row) || is_pushed(&chunk, row) {
                        disturbed.push(*slot);
                        // As a snapshot has it, after which it would not differ once more.
                        rest.weight = weight_of(&chunk, row);
                    }
                    continue;
                }
                if rest.pose.is_some() && !rest.is_dynamic {
                    sleepers.movers.push(*slot);
                }
                let is_changed = rest.pose.is_some() && rest.differs(&chunk, row);
                *rest = Rest { still: rest.still, ..Rest::of(&chunk, row, colliders.get(*slot), sleep) };
                let is_free = !is_pulled && !is_changed && chunk.wrench[row] == Wrench::default();
                let is_still = is_free && is_slow(&chunk, row, rest);
                rest.still = if is_still { (rest.still + settings.dt).min(sleep.time) } else { 0.0 };
                awake.is_dynamic[slot.index()] = true;
                awake.moves[slot.index()] = chunk.momentum[row] != Momentum::default();
            }
        });
        (sleepers.awake, sleepers.disturbed) = (awake, disturbed);
        sleepers.movers.sort_unstable();
    }

    /// To be called at the end of a step of `dt` \[s\]: joints that close and what is pushed out of
    /// another move bodies without a velocity.
    pub(crate) fn notice_ways(&mut self, columns: &WorldColumns<'_>, dt: Real) {
        let Self { sleepers: Sleepers { rests, asleep, .. }, body_index, .. } = self;
        if rests.is_empty() {
            return;
        }
        for (archetype, bodies) in columns.pose_views().filter(|(_, bodies)| bodies.dynamic.is_some()) {
            for (slot, pose) in body_index.slots_in(archetype).iter().zip(bodies.pose) {
                if !asleep.has(*slot) {
                    rests[slot.index()].take_pose(*pose, dt);
                }
            }
        }
    }

    /// Keeps awake what is in contact with something that moves by itself, and disturbs what sleeps
    /// and lost its support or carries a load that it did not fall asleep under.
    /// A step is this `share` of the time that bodies have to be still for.
    fn disturb_by_contacts(&mut self, share: Real) {
        let Self { sleepers, contacts, colliders, .. } = self;
        let Sleepers { movers, contacts: of_sleepers, disturbed, rests, asleep, links, .. } = sleepers;
        let is_mover = |slot: &Slot| movers.binary_search(slot).is_ok();
        if !movers.is_empty() {
            let with_mover = of_sleepers.iter().filter(|contact| contact.slots.iter().any(is_mover));
            disturbed.extend(with_mover.flat_map(|contact| contact.slots));
            for slot in links.iter().filter(|link| link.iter().any(is_mover)).flatten() {
                rests[slot.index()].still = 0.0;
                disturbed.push(*slot);
            }
        }
        let conveys = |contact: &ContactRecord| {
            let surfaces = || colliders.materials.surface_velocities(contact.slots, contact.part);
            contacts.extras.conveys && surfaces().iter().any(|velocity| *velocity != WorldVec3::ZERO)
        };
        for contact in &contacts.records {
            let is_restless = contact.slots.iter().any(is_mover) || conveys(contact);
            for slot in contact.slots {
                let rest = &mut rests[slot.index()];
                if is_restless {
                    rest.still = 0.0;
                }
                if asleep.has(slot) && contact.impulse_of_step() > rest.least_momentum * share {
                    disturbed.push(slot);
                }
            }
        }
    }

    /// Takes the momentum of a body, books that, and leaves it out from now on.
    fn put_to_sleep(&mut self, slot: Slot, columns: &mut WorldColumns<'_>) {
        let place = self.body_index.place(slot);
        let row = place.row as usize;
        let given_up = energy(columns, place).unwrap_or_default();
        let Some(columns) = columns.dynamic_mut(place) else { return };
        columns.momentum[row] = Momentum::default();
        if let Some(velocity) = columns.velocity.as_deref_mut() {
            velocity[row] = Velocity::default();
        }
        if let Some(work) = columns.work.as_deref_mut() {
            work[row].sleep -= given_up;
        }
        self.sleepers.asleep.insert(slot, self.body_index.len());
        self.sleepers.awake.is_dynamic[slot.index()] = false;
    }

    /// Wakes what something strikes or comes near, so that it is solved in this substep. Returns
    /// the bodies that slept.
    pub(crate) fn wake_struck(&mut self) -> Vec<Slot> {
        let mut struck = Vec::new();
        if self.sleepers.asleep.is_empty() {
            return struck;
        }
        self.disturb_near_movers(&mut struck);
        let Self { sleepers, contacts, collider_states, cache, .. } = self;
        sleepers.struck(&contacts.records, &collider_states.states, self.ahead, &mut struck);
        if struck.is_empty() {
            return struck;
        }
        let woken = sleepers.wake(&struck, &mut cache.last);
        cache.remember_woken(&woken);
        woken
    }

    /// Adds the sleeping bodies that are near something that moves by itself.
    fn disturb_near_movers(&self, struck: &mut Vec<Slot>) {
        let Self { sleepers, broad_phase, collider_states, colliders, .. } = self;
        let is_solid = |slot: &&Slot| colliders.get(**slot).is_some_and(|(it, _)| !it.is_sensor());
        for mover in sleepers.movers.iter().filter(is_solid) {
            let touch = |slot: &Slot| colliders.groups[slot.index()].touch(colliders.groups[mover.index()]);
            let proxies = &collider_states.proxies;
            let proxy = &proxies[mover.index()];
            // Which boxes the search has depends on what was before; who wakes must not.
            let is_near = |slot: &Slot| proxy.is_near(&proxies[slot.index()]);
            let mut show = |slot: Slot| {
                if sleepers.asleep.has(slot) && touch(&slot) && is_near(&slot) {
                    struck.push(slot);
                }
            };
            match &proxy.aabb {
                Some(aabb) => broad_phase.meeting(aabb, &mut |other| show(Slot(other))),
                None => self.body_index.all().for_each(show),
            }
        }
    }
}

impl Rest {
    fn of(chunk: &Chunk<'_>, row: usize, collider: Option<&(Collider, WorldVec3)>, sleep: &Sleep) -> Self {
        let radius = radius_of(chunk, row, collider);
        let least_speed = sleep.speed_of(radius);
        let least_momentum = chunk.mass[row].kilograms() * least_speed;
        let (pose, weight) = (Some(chunk.pose[row]), weight_of(chunk, row));
        Self { pose, radius, weight, least_momentum, least_speed, still: 0.0, is_dynamic: true }
    }

    /// Takes over the pose at the end of a step of `dt` \[s\]. What went further in it than a still
    /// body may go is not still.
    fn take_pose(&mut self, pose: Pose, dt: Real) {
        if let Some(before) = self.pose.replace(pose) {
            let way = length((pose.position - before.position).into());
            let turned = (Quat::from(before.orientation).conjugate() * Quat::from(pose.orientation)).vector();
            let rounding = ROUNDING * Real::EPSILON * (length(pose.position.into()) + self.radius);
            if way + 2.0 * length(turned) * self.radius > (self.least_speed * dt).max(rounding) {
                self.still = 0.0;
            }
        }
    }

    /// Whether a body is not what it was.
    fn differs(&self, chunk: &Chunk<'_>, row: usize) -> bool {
        let now = numbers_of(&chunk.pose[row]);
        let is_there = self.pose.is_some_and(|before| {
            // Bits are compared without a branch between them, for they are mostly equal.
            numbers_of(&before).iter().zip(now).fold(0, |all, (before, now)| all | (before.to_bits() ^ now.to_bits()))
                == 0
        });
        !is_there || self.weight != weight_of(chunk, row)
    }
}

fn numbers_of(Pose { position, orientation }: &Pose) -> [Real; 7] {
    let ([a, b, c], [d, e, f, g]) = (position.to_array(), orientation.to_array());
    [a, b, c, d, e, f, g]
}

/// Mass by scale of gravity \[kg\].
fn weight_of(chunk: &Chunk<'_>, row: usize) -> Real {
    chunk.mass[row].kilograms() * chunk.gravity_scale.map_or(1.0, |scales| scales[row].0)
}

/// Whether a body was given a momentum or a force.
fn is_pushed(chunk: &Chunk<'_>, row: usize) -> bool {
    let (Momentum { linear, angular }, Wrench { force, torque }) = (&chunk.momentum[row], &chunk.wrench[row]);
    let bits = |vector: &WorldVec3| vector.x.to_bits() | vector.y.to_bits() | vector.z.to_bits();
    // All but the sign, which nothing may have too.
    (bits(linear) | bits(angular) | bits(force) | bits(torque)) << 1 != 0
}

/// How far a body reaches from its centre of mass \[m\]; where it has no collider, as far as its
/// inertia tells.
fn radius_of(chunk: &Chunk<'_>, row: usize, collider: Option<&(Collider, WorldVec3)>) -> Real {
    if let Some((collider, offset)) = collider
        && let Some(reach) = collider.geometry().reach()
    {
        let center = collider.place().map_or(Vec3::zero(), |place| place.position) - Vec3::from(*offset);
        return reach + length(center);
    }
    let most = chunk.inertia.map_or(0.0, |inertia| inertia[row].moments().max_element());
    (most / chunk.mass[row].kilograms()).sqrt()
}

/// Whether no point of a body is faster than what is still may be.
fn is_slow(chunk: &Chunk<'_>, row: usize, rest: &Rest) -> bool {
    if chunk.momentum[row] == Momentum::default() {
        return true;
    }
    let moving = derived(&chunk.constants::<Real>(row), &chunk.state::<Real>(row));
    length(moving.linear) + length(moving.angular) * rest.radius <= rest.least_speed
}
