//! Contact detection of a substep: broad phase, narrow phase, and matching with the previous
//! contacts.

use std::fmt;

use hecs::World;
use rayon::prelude::*;
use tumble_collide::{BroadPhase, ColliderShape, Isometry, contact_manifolds, nearest_manifold};
use tumble_math::lane::Vec3;

use crate::collision::aabb_tiles::CenteredShape;
use crate::collision::collider::{Collider, Groups};
use crate::collision::collider_state::{ColliderState, ColliderStates};
use crate::collision::contact::{ContactRecord, Second, UpdateRule};
use crate::collision::contact_cache::ContactCache;
use crate::collision::contact_hook::ContactHook;
use crate::collision::contact_materials::{Extras, Materials};
use crate::collision::contact_set::ContactSet;
use crate::collision::contact_ways::Way;
use crate::collision::internal_edges::InternalEdges;
use crate::collision::narrow_phase::LaneKind;
use crate::collision::near_pairs::{NearPairs, Roles, SensorRole};
use crate::collision::pair_limit::FoundContacts;
use crate::collision::partners::Partners;
use crate::collision::round_contact::RoundContact;
use crate::collision::sensors::Sensors;
use crate::collision::sleep::Sleepers;
use crate::collision::sweep::Sweep;
use crate::collision::update_aabbs::Intervals;
use crate::components::CenterOfMass;
use crate::joints::joint_list::{JointEnds, JointList};
use crate::joints::joint_marks::JointMarks;
use crate::joints::locked_axes::LockedAxes;
use crate::math::{Real, Vec3 as WorldVec3};
use crate::settings::Settings;
use crate::storage::body_index::{BodyIndex, Slot, by_new_slot};
use crate::storage::world_columns::WorldColumns;
use crate::threads::InParts;

/// Finds the contacts of a world, and keeps what the next step begins with.
#[derive(Clone, Default)]
pub(crate) struct CollisionPipeline {
    /// The bodies with colliders or joints, as of the last [`update`](Self::update).
    pub(crate) body_index: BodyIndex,
    pub(crate) colliders: Colliders,
    /// In this substep.
    pub(crate) collider_states: ColliderStates,
    /// Whether slots and colliders are those of the last substep, so that what sleeps is as it was.
    pub(crate) are_states_known: bool,
    pub(crate) contacts: ContactSet,
    /// Kept from step to step.
    pub(crate) broad_phase: BroadPhase<Real>,
    pub(crate) cache: ContactCache,
    /// Memory that every substep overwrites.
    pub(crate) near: NearPairs,
    found: Vec<FoundContacts>,
    pub(crate) ways: Vec<Way>,
    pub(crate) partners: Partners,
    pub(crate) internal_edges: InternalEdges,
    /// Kept from step to step.
    pub(crate) sensors: Sensors,
    pub(crate) sleepers: Sleepers,
    /// Kept from step to step, where bodies may sleep.
    pub(crate) joint_marks: JointMarks,
    /// Memory that every substep overwrites.
    pub(crate) sweep: Sweep,
    /// The time that contacts look ahead \[s\].
    pub(crate) ahead: Real,
    /// The caller's, and the pairs that it refused in this substep.
    pub(crate) hook: Option<ContactHook>,
    pub(crate) refused: Vec<[Slot; 2]>,
}

/// The colliders of a world, by slot.
#[derive(Clone, Default)]
pub(crate) struct Colliders {
    /// Each with its body's centre of mass, in the body's frame \[m\].
    pub(crate) list: Vec<Option<(Collider, WorldVec3)>>,
    pub(crate) centered: Vec<CenteredShape>,
    pub(crate) groups: Vec<Groups>,
    /// Empty where there are no sensors.
    pub(crate) sensors: Vec<SensorRole>,
    pub(crate) materials: Materials,
    /// Whether any was another before the last update.
    are_changed: bool,
}

/// Contacts that one thread takes at a time.
pub(crate) const PART: usize = 512;
/// Pairs of shapes without lanes of their own that one thread takes at a time.
const OTHERS_PART: usize = 16;

impl fmt::Debug for CollisionPipeline {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("CollisionPipeline").field("contacts", &self.contacts.records.len()).finish_non_exhaustive()
    }
}

impl Colliders {
    /// That of a slot, if its body has one, with the centre of mass in the body's frame \[m\].
    pub(crate) fn get(&self, slot: Slot) -> Option<&(Collider, WorldVec3)> {
        self.list[slot.index()].as_ref()
    }

    /// Of which shapes a contact between slots is.
    pub(crate) fn kind_of(&self, slots: [Slot; 2]) -> LaneKind {
        LaneKind::of_both(slots.map(|slot| self.get(slot).map(|(it, _)| it)))
    }

    /// Gives colliders the slots that their bodies have now; `slots` are these by slot before.
    fn renumber(&mut self, slots: &[Slot], count: usize) {
        self.list = by_new_slot(std::mem::take(&mut self.list), slots, count, None);
    }

    /// Reads the colliders of a world, and adds the slots of those that are others than they were.
    /// Returns whether pairs are filtered as before.
    fn update(&mut self, world: &World, body_index: &BodyIndex, same_slots: bool, changed: &mut Vec<Slot>) -> bool {
        let Self { list, centered, groups, sensors, materials, are_changed } = self;
        // Groups and materials are by slot too.
        let mut is_same = same_slots && list.len() == body_index.len();
        list.resize(body_index.len(), None);
        for (archetype, places) in body_index.archetypes(world) {
            let column = archetype.get::<&Collider>();
            let offsets = archetype.get::<&CenterOfMass>();
            let offset = |row: usize| offsets.as_deref().map_or(WorldVec3::ZERO, |offsets| offsets[row].0);
            for (row, slot) in places {
                let collider = column.as_deref().map(|column| (&column[row], offset(row)));
                let known = &mut list[slot.index()];
                if !is_known(known.as_ref(), collider) {
                    // What is here for the first time was not another.
                    changed.extend(known.is_some().then_some(slot));
                    *known = collider.map(|(collider, offset)| (collider.clone(), offset));
                    is_same = false;
                }
            }
        }
        *are_changed = !is_same;
        if is_same {
            return true;
        }
        centered.clear();
        centered.extend(list.iter().map(CenteredShape::of));
        materials.list(list.iter().map(|collider| collider.as_ref().map(|(collider, _)| collider)));
        let of = |collider: &Option<(Collider, _)>| collider.as_ref().map_or(Groups::ALL, |(it, _)| it.filter_groups());
        let of_sensor = |collider: &Option<(Collider, _)>| {
            let [has_sensor, has_solid] =
                collider.as_ref().map_or([false; 2], |(it, _)| [it.has_sensor(), !it.is_sensor()]);
            SensorRole { has_sensor, has_solid }
        };
        let is_any_sensor = list.iter().map(of_sensor).any(|role| role.has_sensor);
        let roles = || list.iter().map(of_sensor).filter(|_| is_any_sensor);
        let same = list.iter().map(of).eq(groups.iter().copied()) && roles().eq(sensors.iter().copied());
        if !same {
            groups.clear();
            groups.extend(list.iter().map(of));
            sensors.clear();
            sensors.extend(roles());
        }
        same
    }
}

/// Whether a collider, with its body's centre of mass, is the one that is known.
fn is_known(known: Option<&(Collider, WorldVec3)>, now: Option<(&Collider, WorldVec3)>) -> bool {
    match (known, now) {
        (Some((known, before)), Some((now, offset))) => known.is_same(now) && *before == offset,
        (None, None) => true,
        _ => false,
    }
}

impl CollisionPipeline {
    /// Lists the bodies with colliders or joints. To be called again when anything was spawned,
    /// despawned or changed but momentum and pose.
    ///
    /// Returns whether all slots are what they were.
    pub(crate) fn update(&mut self, world: &World, joints: &JointEnds) -> bool {
        self.body_index.find(world, |archetype, marks| {
            if archetype.has::<Collider>() || archetype.has::<LockedAxes>() || joints.connect_any_of(archetype) {
                marks.mark_archetype();
            }
        });
        let Self {
            body_index,
            colliders,
            collider_states,
            contacts,
            broad_phase,
            cache,
            sensors,
            sleepers,
            hook,
            are_states_known,
            ..
        } = self;
        let of_sleepers = &mut sleepers.contacts;
        let same_slots = cache.renumber(world, body_index, [&mut contacts.records, of_sleepers]);
        if !same_slots {
            let now = cache.body_keys.renumbered();
            collider_states.renumber(now, body_index.len());
            colliders.renumber(now, body_index.len());
            sensors.renumber(now);
            sleepers.renumber(now, body_index.len());
        }
        sleepers.disturbed.append(&mut cache.bereaved);
        let same_groups = colliders.update(world, body_index, same_slots, &mut sleepers.changed);
        *are_states_known &= same_slots && !colliders.are_changed;
        cache.arrange(&mut contacts.records, colliders, *are_states_known);
        if !same_slots || colliders.are_changed {
            cache.arrange(&mut sleepers.contacts, colliders, false);
        }
        // A hook may ask for any of them, from step to step others.
        contacts.extras = if hook.is_some() { Extras::ALL } else { colliders.materials.extras() };
        if !(same_groups && same_slots) {
            // It asks once whether a pair is wanted.
            broad_phase.reset();
        }
        same_slots
    }

    /// A step, or several, in which nothing has a collider.
    pub(crate) fn pass(&mut self, world: &World, steps: u32) {
        self.update(world, &JointEnds::default());
        self.sensors.end_all();
        for _ in 0..steps.min(2) {
            self.begin_step();
            self.cache.pass();
        }
    }

    /// To be called before the first substep of every step.
    pub(crate) fn begin_step(&mut self) {
        if self.cache.goes_on() {
            let events: Vec<_> = self.events_of_step().collect();
            self.cache.events.extend(events);
        }
        self.cache.begin_step();
    }

    /// Finds the contacts of a substep of the settings, with the impulses that they begin with.
    ///
    /// Returns the bodies that it woke, in the order in which they were struck.
    pub(crate) fn find_contacts(
        &mut self,
        columns: &WorldColumns<'_>,
        settings: &Settings,
        joints: &JointList,
    ) -> Vec<Slot> {
        // After the last substep contacts see to it that in one more nothing would come too near.
        let ahead = settings.substep() + settings.contact_substep();
        self.ahead = ahead;
        let drop = settings.gravity * (0.5 * ahead * (ahead + settings.contact_substep()));
        let intervals = Intervals { interval: settings.substep(), ahead, drop };
        self.cache.keep_previous(&mut self.contacts.records);
        self.contacts.substep = settings.contact_substep();
        let mut woken = Vec::new();
        loop {
            self.list_contacts(columns, (settings, intervals), joints);
            // What was asleep may touch others that are asleep.
            let more = self.wake_struck();
            if more.is_empty() {
                break;
            }
            woken.extend(more);
        }
        self.match_impulses();
        self.propose_contacts();
        let Self { collider_states, colliders, contacts: ContactSet { records, rounds, .. }, .. } = self;
        rounds.clear();
        let numbered = (0..).zip(&*records);
        let part_of_step = 1.0 / settings.contact_substeps_each() as Real;
        let of = |contact| RoundContact::of(contact, colliders, &collider_states.states, part_of_step);
        rounds.extend(numbered.filter_map(of));
        woken
    }

    /// Lists the contacts between the bodies as they are.
    fn list_contacts(
        &mut self,
        columns: &WorldColumns<'_>,
        (settings, intervals): (&Settings, Intervals),
        joints: &JointList,
    ) {
        self.update_aabbs(columns, intervals);
        self.widen_jointed(joints);
        let Self { collider_states, colliders, broad_phase, near, .. } = self;
        let roles = Roles { groups: &colliders.groups, sensors: &colliders.sensors };
        near.find(collider_states, roles, broad_phase, joints);
        self.find_manifolds();
        let fall = settings.gravity.length() * intervals.ahead * intervals.ahead;
        self.limit_speculative((fall, 1.0 / settings.contact_substeps_each() as Real), joints);
        self.leave_out_internal_edges();
    }

    /// How many contacts there were after the last step, and how many pairs of shapes without lanes
    /// of their own.
    pub(crate) fn counts(&self) -> (usize, usize) {
        (self.contacts.records.len(), self.near.others.len())
    }

    /// The narrow phase: contacts of the pairs that are near each other.
    fn find_manifolds(&mut self) {
        let Self { collider_states, near, found, contacts: ContactSet { records: contacts, .. }, colliders, .. } = self;
        let (end, some_empty) = near.cuboids.touch(LaneKind::Cuboid, &collider_states.lanes, contacts, 0);
        if some_empty {
            contacts[..end].iter_mut().for_each(|contact| fill_fast(contact, &collider_states.states, colliders));
        }
        let (end, more_empty) = near.spheres.touch(LaneKind::Sphere, &collider_states.lanes, contacts, end);
        contacts.truncate(end);
        let parts = near.others.len().div_ceil(OTHERS_PART);
        found.resize_with(parts.max(found.len()), FoundContacts::default);
        near.others.par_chunks(OTHERS_PART).zip(&mut *found).by_at_least(2).for_each(|(pairs, found)| {
            found.clear();
            pairs.iter().for_each(|slots| collide_pair(*slots, &collider_states.states, colliders, found));
        });
        for FoundContacts { contacts: found, left_out } in &found[..parts] {
            contacts.extend_from_slice(found);
            near.limit.left_out += left_out;
        }
        if some_empty || more_empty || contacts[end..].iter().any(|contact| contact.count() == 0) {
            contacts.retain(|contact| contact.count() > 0);
        }
    }

    /// Begins contacts with the impulses of those of the last substep.
    fn match_impulses(&mut self) {
        let Self { contacts: ContactSet { records, extras, .. }, cache, colliders, collider_states, .. } = self;
        let (states, materials, ahead) = (&collider_states.states, &colliders.materials, self.ahead);
        let before = Before { contacts: &cache.last, is_of_step: !cache.is_first_substep() };
        let closing_speed = |it: &ContactRecord| it.closing_speed_of(it.slots.map(|slot| &states[slot.index()]), ahead);
        records.par_chunks_mut(PART).by_at_least(2).for_each(|contacts| {
            match_impulses(contacts, before, materials, closing_speed);
        });
        if extras.conveys {
            records.iter_mut().for_each(|it| convey(it, materials, states));
        }
        // The next step's list takes the place of the last one's: so it allocates nothing. Exactly
        // as much, for with some more both would outgrow each other forever.
        cache.last.reserve_exact(records.capacity().saturating_sub(cache.last.len()));
    }
}

/// A body that goes further in a step than this part of the half thickness of the thinner of two is
/// fast.
const FAST: Real = 0.5;

/// Gives a contact of boxes without points, as no faces lie over one another there, the point where
/// they are nearest if they are so fast that what comes next may be past it.
fn fill_fast(contact: &mut ContactRecord, states: &[ColliderState], colliders: &Colliders) {
    let [first, second] = contact.slots.map(|slot| &states[slot.index()]);
    let (reach, margin) = (first.reach + second.reach, first.margin + second.margin);
    let is_fast = reach - margin > FAST * first.half_thickness.min(second.half_thickness);
    let [Some((a, _)), Some((b, _))] = contact.slots.map(|slot| colliders.get(slot)) else { return };
    if contact.count() == 0 && is_fast {
        let manifold = nearest_manifold(a.geometry(), &first.placement, b.geometry(), &second.placement, reach);
        let second = Second { center: second.center, has_non_dynamic: !first.is_dynamic, margin };
        let found = ContactRecord::new(contact.slots, 0, &manifold, second, UpdateRule::BodyFixed);
        *contact = ContactRecord { kind: LaneKind::Cuboid, ..found };
    }
}

/// Adds the contacts of shapes that have no lanes of their own.
fn collide_pair(slots: [Slot; 2], states: &[ColliderState], colliders: &Colliders, found: &mut FoundContacts) {
    let [first, second] = slots.map(|slot| &states[slot.index()]);
    if let [Some((a, _)), Some((b, _))] = slots.map(|slot| colliders.get(slot)) {
        let before = found.contacts.len();
        let margin = first.reach + second.reach;
        let of_second =
            Second { center: second.center, has_non_dynamic: !first.is_dynamic, margin: first.margin + second.margin };
        let rule = update_rule([first, second], [a.geometry(), b.geometry()]);
        contact_manifolds(
            a.geometry(),
            &first.placement,
            b.geometry(),
            &second.placement,
            margin,
            &mut |part, manifold| {
                if a.parts_touch(b, part) {
                    let rule = match rule {
                        // What lies on three points does not roll.
                        _ if manifold.points().len() > 2 => UpdateRule::BodyFixed,
                        UpdateRule::RoundOnFlat if !a.geometry().is_flat_part(part) => UpdateRule::Refined,
                        rule => rule,
                    };
                    let mut contact = ContactRecord::new(slots, part, manifold, of_second, rule);
                    if let (UpdateRule::RoundOnFlat, Some((radius, _))) = (rule, core(b.geometry())) {
                        contact.go_with_core(radius);
                    }
                    found.push(contact, before);
                }
            },
        );
        found.keep_deepest(before);
        found.contacts[before..].sort_by_key(ContactRecord::key);
    }
}

/// How the geometry of a contact of two shapes follows its bodies.
fn update_rule(states: [&ColliderState; 2], shapes: [&ColliderShape<Real>; 2]) -> UpdateRule {
    if !shapes.iter().any(|geometry| geometry.is_round()) {
        return UpdateRule::BodyFixed;
    }
    // Where only one is dynamic, it is the second.
    let [ground, body] = states;
    let turns = ground.velocity.1;
    let Some((_, length)) = core(shapes[1]) else { return UpdateRule::Refined };
    let apart = body.placement.position - body.center;
    let off_center = apart.dot(apart).sqrt();
    let is_flat = match shapes[0] {
        ColliderShape::HalfSpace | ColliderShape::Mesh(_) | ColliderShape::HeightField(_) => true,
        ColliderShape::Cuboid { half_extents } => {
            let Isometry { position, orientation } = ground.placement;
            let center = orientation.rotate_back(body.placement.position - position);
            // What turns takes its middle around its centre of mass.
            stays_over_face(center, *half_extents, length + 2.0 * off_center + ground.reach + body.reach)
        }
        _ => false,
    };
    if !is_flat || ground.is_dynamic || [turns.x, turns.y, turns.z] != [0.0; 3] {
        UpdateRule::Refined
    } else if length == 0.0 && off_center == 0.0 {
        UpdateRule::Constant
    } else {
        UpdateRule::RoundOnFlat
    }
}

/// Of a ball or a capsule its radius, and how far its core reaches from its middle \[m\].
fn core(shape: &ColliderShape<Real>) -> Option<(Real, Real)> {
    match *shape {
        ColliderShape::Sphere { radius } => Some((radius, 0.0)),
        ColliderShape::Capsule { radius, half_height } => Some((radius, half_height)),
        _ => None,
    }
}

/// Whether a point in the frame of a box is over a face of it, further than `reach` \[m\] from what
/// is over the face's sides.
fn stays_over_face(point: Vec3<Real>, half_extents: Vec3<Real>, reach: Real) -> bool {
    let h = half_extents;
    let beyond = [point.x.abs() - h.x, point.y.abs() - h.y, point.z.abs() - h.z];
    let is_over = |axis: &usize| beyond[*axis] > 0.0;
    (0..3).filter(is_over).count() == 1 && (0..3).filter(|axis| beyond[*axis] > -reach).count() == 1
}

/// Says how the surfaces of a contact move on their bodies.
fn convey(contact: &mut ContactRecord, materials: &Materials, states: &[ColliderState]) {
    let [first, second] = materials.surface_velocities(contact.slots, contact.part);
    let world = |which: usize, velocity: WorldVec3| {
        states[contact.slots[which].index()].placement.orientation.rotate(velocity.into())
    };
    contact.surface_velocity = world(0, first) - world(1, second);
}

/// The contacts of before a substep of the settings.
#[derive(Clone, Copy)]
struct Before<'a> {
    contacts: &'a [ContactRecord],
    /// Whether they are of the same step.
    is_of_step: bool,
}

/// Begins contacts with the impulses of those there were, both in the order of their keys.
fn match_impulses(
    contacts: &mut [ContactRecord],
    before: Before<'_>,
    materials: &Materials,
    closing_speed: impl Fn(&ContactRecord) -> Real,
) {
    let Some(first) = contacts.first().map(ContactRecord::key) else { return };
    let last = before.contacts;
    let mut last = last[last.partition_point(|old| old.key() < first)..].iter().peekable();
    for contact in contacts {
        while last.next_if(|old| old.key() < contact.key()).is_some() {}
        if let Some(old) = last.next_if(|old| old.key() == contact.key()) {
            contact.take_impulses_of(old);
            contact.closing_speed = if contact.touched { old.closing_speed } else { closing_speed(contact) };
            contact.earlier_impulse = if before.is_of_step { old.impulse_of_step() } else { 0.0 };
        } else {
            contact.closing_speed = closing_speed(contact);
        }
        contact.set_surface(&materials.between(contact.slots, contact.part));
    }
}
