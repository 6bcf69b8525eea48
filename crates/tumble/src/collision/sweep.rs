//! The second net for fast bodies: the way that a body really took in a substep is swept, and one
//! of which the core would be through something is put back to where that touches, with a blow.
//!
//! Contacts foresee what bodies do with the velocities that a substep begins with. A blow changes
//! them within it: a box that hits a wall with a corner spins, and other corners follow. The way
//! from the first to the last pose is continuous, so what is on the other side at its end has
//! crossed.

use glam::DVec3;
use rayon::prelude::*;
use tumble_collide::{Aabb, ColliderShape, Passage};
use tumble_math::lane::{Quat, Vec3};

use crate::collision::collider::Collider;
use crate::collision::contact::ContactRecord;
use crate::collision::contact_ways::length;
use crate::collision::lost_momentum::LostMomentum;
use crate::collision::pipeline::CollisionPipeline;
use crate::collision::strike::{Struck, strike};
use crate::collision::traveller::{Traveller, find, first_passage, moves_in_range, pose_of, turned_end};
use crate::components::Pose;
use crate::joints::axis_lock::AxisLock;
use crate::joints::joint_list::JointList;
use crate::math::{Real, quat, vec3};
use crate::range::{MAX_DISTANCE_OF_CONTACTS, within};
use crate::settings::Settings;
use crate::storage::body_index::Slot;
use crate::storage::world_columns::WorldColumns;
use crate::threads::InParts;

/// A body of which no point goes further than this part of its half thickness is not swept.
const SLOW: Real = 0.5;
/// What is in something else by this part of its half thickness is swept however slow it is.
const DEEP: Real = 0.25;
/// What comes nearer to another's middle than this part of both half thicknesses, or ends a substep
/// this deep in it, went through.
const DEEP_IN: f64 = 0.5;
/// Just under half a turn \[rad\]: beyond it the last pose does not tell how far a body has turned.
const HALF_TURN: Real = 3.0;
/// Bodies that one thread compares, and that it follows, at a time.
const PART: usize = 1024;
const FEW: usize = 4;
/// How often bodies are followed again where others were stopped on their ways.
const ROUNDS: usize = 4;

/// Memory of the second net; nothing in it outlives a substep.
#[derive(Clone, Default)]
pub(crate) struct Sweep {
    /// In parts that threads find.
    found: Vec<Vec<Slot>>,
    /// The bodies that are swept, in order.
    fast: Vec<Slot>,
    /// Each of them with what is near its way; what may be put back is the second.
    pairs: Vec<[Slot; 2]>,
    /// Half-spaces, and compounds with one, which no box is around.
    endless: Vec<Slot>,
    places: Vec<[usize; 2]>,
    /// The bodies of pairs, by slot.
    travellers: Vec<Traveller>,
    jointed: Vec<Slot>,
    stops: Vec<Option<Stop>>,
    sorted: Vec<Stop>,
    limits: Vec<f64>,
    /// Travellers that were stopped, after what stopped them.
    stopped: Vec<[Slot; 2]>,
    lost: LostMomentum,
    /// The contacts of blows.
    blows: Vec<ContactRecord>,
}

/// The end of a body's way: whose it is, and what is touched.
#[derive(Clone, Copy)]
struct Stop {
    traveller: usize,
    other: usize,
    /// The number of the pair of their parts.
    part: u32,
    passage: Passage,
}

/// What says which bodies may touch a body.
#[derive(Clone, Copy)]
pub(crate) struct Surroundings<'a> {
    joints: &'a JointList,
    endless: &'a [Slot],
}

impl CollisionPipeline {
    /// Puts back the dynamic bodies of which the core would be through something at the end of a
    /// substep of the settings.
    pub(crate) fn stop_crossings(&mut self, columns: &mut WorldColumns<'_>, joints: &JointList, settings: &Settings) {
        let mut sweep = std::mem::take(&mut self.sweep);
        self.find_fast(&mut sweep, columns);
        if !sweep.fast.is_empty() {
            self.find_pairs(&mut sweep, columns, joints);
        }
        if !sweep.pairs.is_empty() {
            self.list_travellers(&mut sweep, columns, settings.substep());
            self.stop_all(&mut sweep, columns, settings);
            let surroundings = Surroundings { joints, endless: &sweep.endless };
            self.move_on(&sweep.travellers, columns, surroundings, settings);
            self.forget_impulses(&sweep.travellers, columns);
            self.add_blows(&mut sweep.blows);
        }
        self.sweep = sweep;
    }

    /// Has the next substep begin without the impulses on what stands otherwise now than the solver
    /// left it: what turned a rod that lay would spin one that stands about its own axis.
    fn forget_impulses(&mut self, travellers: &[Traveller], columns: &WorldColumns<'_>) {
        if travellers.iter().all(|it| it.until >= 1.0) {
            return;
        }
        let stands_otherwise = |slot: &Slot| {
            let it = travellers.get(find(travellers, *slot)).filter(|it| it.slot == *slot);
            it.is_some_and(|it| it.stands_otherwise(columns))
        };
        for contact in self.contacts.records.iter_mut().filter(|it| it.slots.iter().any(stands_otherwise)) {
            contact.normal_impulses.steady = 0.0;
        }
    }

    /// Adds blows to the contacts of the same parts, or as contacts.
    fn add_blows(&mut self, blows: &mut Vec<ContactRecord>) {
        let contacts = &mut self.contacts.records;
        blows.retain_mut(|blow| {
            blow.kind = self.colliders.kind_of(blow.slots);
            let known = contacts.binary_search_by_key(&blow.key(), ContactRecord::key);
            if let Ok(place) = known {
                contacts[place].add_blow(blow);
            }
            known.is_err()
        });
        if !blows.is_empty() {
            blows.sort_by_key(ContactRecord::key);
            blows.dedup_by(|later, first| {
                let is_same = later.key() == first.key();
                if is_same {
                    first.add_blow(later);
                }
                is_same
            });
            contacts.append(blows);
            contacts.sort_by_key(ContactRecord::key);
        }
    }

    /// Lists the bodies with colliders that are fast, or deep in others.
    fn find_fast(&self, Sweep { found, fast, pairs, .. }: &mut Sweep, columns: &WorldColumns<'_>) {
        fast.clear();
        pairs.clear();
        for (archetype, bodies) in columns.pose_views() {
            if bodies.dynamic.is_none() && bodies.velocity.is_none() {
                continue;
            }
            let slots = self.body_index.slots_in(archetype);
            in_parts(found, slots.par_chunks(PART).zip(bodies.pose.par_chunks(PART)), |(slots, poses), found| {
                let both = slots.iter().zip(poses).filter(|(slot, pose)| self.is_fast(**slot, pose));
                found.extend(both.map(|(slot, _)| *slot));
            });
            fast.extend(found.iter().flatten());
        }
        let states = &self.collider_states.states;
        let deep = |slot: Slot| {
            let state = &states[slot.index()];
            if state.is_dynamic { DEEP * state.half_thickness } else { Real::INFINITY }
        };
        in_parts(found, self.contacts.records.par_chunks(PART), |contacts, found| {
            for contact in contacts {
                let least = (0..contact.count()).fold(0.0, |least, j| contact.separation(j).min(least));
                found.extend(contact.slots.into_iter().filter(|slot| least < -deep(*slot)));
            }
        });
        fast.extend(found.iter().flatten());
        fast.sort_unstable();
        fast.dedup();
    }

    fn is_fast(&self, slot: Slot, pose: &Pose) -> bool {
        if self.sleepers.asleep.has(slot) {
            return false;
        }
        let state = &self.collider_states.states[slot.index()];
        let way = Vec3::from(pose.position) - state.center;
        let most = SLOW * state.half_thickness;
        if way.dot(way) > most * most {
            return true;
        }
        // How far its outside is from that of a ball about its centre of mass.
        let arm = state.motion.radius - state.half_thickness;
        if arm <= 0.0 || state.half_thickness <= 0.0 {
            return false;
        }
        let Some((collider, _)) = self.colliders.get(slot) else { return false };
        let end = turned_end(pose, collider);
        let (turn, axis_turn) = (state.motion.turn.dot(state.motion.turn).sqrt(), state.motion.axis_turn);
        // How far a point at a distance of one goes at most, about; most of all of what may have
        // turned by more than half.
        let gone = match axis_turn {
            Some(axis_turn) => {
                let [[_, before, _], [_, after, _]] = [state.placement.orientation, end].map(Quat::axes);
                let around = if turn > HALF_TURN { axis_turn.min(2.0) } else { 0.0 };
                length(after - before).max(around)
            }
            None if turn > HALF_TURN => 2.0,
            None => 2.0 * length((end.conjugate() * state.placement.orientation).vector()),
        };
        gone * arm > most
    }

    /// Lists each fast body with what is near its way, where one of the two can be put back.
    fn find_pairs(&self, sweep: &mut Sweep, columns: &WorldColumns<'_>, joints: &JointList) {
        let Sweep { fast, pairs, endless, jointed, .. } = sweep;
        jointed.clear();
        jointed.extend(joints.joints.iter().flat_map(|joint| joint.slots));
        jointed.sort_unstable();
        let states = &self.collider_states.states;
        let is_free = |slot: Slot| states[slot.index()].is_dynamic && jointed.binary_search(&slot).is_err();
        if !(0..states.len() as u32).any(|slot| is_free(Slot(slot))) {
            return;
        }
        endless.clear();
        let proxies = (0..).zip(&self.collider_states.proxies);
        endless.extend(proxies.filter(|(_, proxy)| proxy.aabb.is_none()).map(|(slot, _)| Slot(slot)));
        for slot in fast.iter().copied() {
            let Some(aabb) = self.swept_aabb(slot, columns) else { continue };
            self.for_each_near((slot, &aabb), columns, Surroundings { joints, endless }, |other| {
                if is_free(slot) {
                    pairs.push([other, slot]);
                }
                if is_free(other) {
                    pairs.push([slot, other]);
                }
            });
        }
        pairs.sort_unstable();
        pairs.dedup();
    }

    /// Shows the solid bodies that are near a box and that a solid body may touch.
    pub(crate) fn for_each_near(
        &self,
        (slot, aabb): (Slot, &Aabb<Real>),
        columns: &WorldColumns<'_>,
        Surroundings { joints, endless }: Surroundings<'_>,
        mut visit: impl FnMut(Slot),
    ) {
        let groups = &self.colliders.groups;
        let is_solid = |slot: Slot| {
            self.colliders.get(slot).is_some_and(|(it, _)| !it.is_sensor()) && self.is_in_range(slot, columns)
        };
        if !is_solid(slot) {
            return;
        }
        let mut show = |other: Slot| {
            let touch = groups[slot.index()].touch(groups[other.index()]) && !joints.keeps_apart([slot, other]);
            if other != slot && touch && is_solid(other) {
                visit(other);
            }
        };
        // The search has larger boxes, which depend on what was before.
        let proxies = &self.collider_states.proxies;
        let is_near = |other: Slot| proxies[other.index()].aabb.is_some_and(|its| its.meets(aabb));
        self.broad_phase.meeting(aabb, &mut |other| {
            if is_near(Slot(other)) {
                show(Slot(other));
            }
        });
        endless.iter().copied().filter(|other| !self.is_outside(aabb, *other)).for_each(show);
    }

    /// Whether a box is outside of a fixed half-space.
    fn is_outside(&self, aabb: &Aabb<Real>, ground: Slot) -> bool {
        let state = &self.collider_states.states[ground.index()];
        let is_half_space =
            self.colliders.get(ground).is_some_and(|(it, _)| matches!(it.geometry(), ColliderShape::HalfSpace));
        let (up, half) = (state.placement.orientation.rotate(Vec3::new(0.0, 1.0, 0.0)), (aabb.high - aabb.low) * 0.5);
        let reach = half.dot(Vec3::new(up.x.abs(), up.y.abs(), up.z.abs()));
        is_half_space && state.is_fixed && up.dot(aabb.low + half - state.placement.position) > reach
    }

    /// Whether a body is where contacts find it, at the end too, and went no faster than bodies
    /// may: others are to notice nothing of one that is not.
    fn is_in_range(&self, slot: Slot, columns: &WorldColumns<'_>) -> bool {
        let state = &self.collider_states.states[slot.index()];
        let Some(end) = pose_of(columns, self.body_index.place(slot)) else { return false };
        let places = [state.placement.position, state.center, end.position.into()];
        let moves = moves_in_range(columns, self.body_index.place(slot), state.motion.radius);
        places.into_iter().all(|at| within(at, MAX_DISTANCE_OF_CONTACTS)) && end.orientation.is_finite() && moves
    }

    /// The box around a body's way.
    fn swept_aabb(&self, slot: Slot, columns: &WorldColumns<'_>) -> Option<Aabb<Real>> {
        let state = &self.collider_states.states[slot.index()];
        let end = pose_of(columns, self.body_index.place(slot))?.position;
        let half = Vec3::splat(state.motion.radius);
        let [a, b] = [Aabb::about(state.center, half), Aabb::about(Vec3::from(end), half)];
        Some(a.union(&b))
    }

    /// Lists the bodies of pairs.
    fn list_travellers(&self, sweep: &mut Sweep, columns: &WorldColumns<'_>, h: Real) {
        let Sweep { fast, pairs, places, travellers, jointed, found, .. } = sweep;
        found.resize_with(found.len().max(1), Vec::new);
        let slots = &mut found[0];
        slots.clear();
        slots.extend(pairs.iter().flatten());
        slots.sort_unstable();
        slots.dedup();
        travellers.clear();
        travellers.extend(slots.iter().filter_map(|slot| {
            let state = &self.collider_states.states[slot.index()];
            let (collider, _) = self.colliders.get(*slot)?;
            let is_free = state.is_dynamic && jointed.binary_search(slot).is_err();
            let is_fast = fast.binary_search(slot).is_ok();
            Traveller::of(*slot, self.body_index.place(*slot), (state, collider), [is_free, is_fast], columns, h)
        }));
        places.clear();
        places.extend(pairs.iter().map(|pair| pair.map(|slot| find(travellers, slot))));
    }

    /// Notes the forces of contacts when the substep ends, the last of substeps of `h` \[s\].
    fn note_pushes(&self, travellers: &mut [Traveller], h: Real) {
        for contact in self.contacts.records.iter().filter(|it| it.has_impulses()) {
            let last = f64::from(h) / f64::from(1_u32 << contact.halvings());
            let force = contact.impulse_of_substep() / last;
            for (slot, sign) in contact.slots.into_iter().zip([-1.0, 1.0]) {
                let place = find(travellers, slot);
                if let Some(it) = travellers.get_mut(place).filter(|it| it.slot == slot) {
                    it.pushed += force * sign;
                }
            }
        }
    }

    /// Follows all pairs, and stops what crosses, the earliest first.
    fn stop_all(&self, sweep: &mut Sweep, columns: &mut WorldColumns<'_>, settings: &Settings) {
        sweep.lost.begin(&sweep.travellers, columns);
        sweep.stopped.clear();
        for round in 0..ROUNDS {
            let Sweep { travellers, places, stops, sorted, limits, stopped, blows, .. } = sweep;
            stops.clear();
            stops.resize(places.len(), None);
            let parts = places.par_chunks(FEW).zip(stops.par_chunks_mut(FEW)).by_at_least(1);
            parts.for_each(|(pairs, stops)| {
                pairs.iter().zip(stops).for_each(|(pair, stop)| *stop = self.find_stop(travellers, *pair));
            });
            sorted.clear();
            sorted.extend(stops.iter().flatten());
            if sorted.is_empty() {
                break;
            }
            if round == 0 {
                self.note_pushes(travellers, settings.contact_substep());
            }
            // The earliest first; of equal ones the body that comes first.
            let order = |it: &Stop| (it.traveller, it.other);
            sorted.sort_unstable_by(|a, b| a.passage.until.total_cmp(&b.passage.until).then(order(a).cmp(&order(b))));
            limits.clear();
            limits.extend(travellers.iter().map(|it| it.until));
            for stop in &*sorted {
                // What was stopped in this round is followed again in the next.
                if [stop.traveller, stop.other].iter().all(|it| travellers[*it].until == limits[*it]) {
                    blows.extend(self.stop(stop, travellers, columns, settings));
                    stopped.push([stop.other, stop.traveller].map(|it| Slot(it as u32)));
                }
            }
        }
        let Sweep { travellers, stopped, lost, .. } = sweep;
        for it in travellers.iter() {
            it.write(travellers, columns);
        }
        lost.give_back(travellers, stopped, columns);
    }

    /// Where the core of a body touches another on its way.
    fn find_stop(&self, travellers: &[Traveller], [other, traveller]: [usize; 2]) -> Option<Stop> {
        let [first, second] = [travellers.get(other)?, travellers.get(traveller)?];
        if !second.is_free || first.with == Some(traveller) || second.with == Some(other) {
            return None;
        }
        let [Some((a, _)), Some((b, _))] = [first, second].map(|it| self.colliders.get(it.slot)) else { return None };
        // Both go on, and then one of them stays where it was stopped.
        let both = first.until.min(second.until);
        let rest = |it: &Traveller| it.course.part(both, it.until.max(both));
        let parts = [
            (0.0, both, [first.course.part(0.0, both), second.course.part(0.0, both)]),
            (both, second.until, [rest(first), rest(second)]),
        ];
        let stop = parts.into_iter().filter(|(from, to, _)| from < to).find_map(|(from, to, courses)| {
            let (part, passage) = first_passage([a, b], &courses, Passage::find_crossing)?;
            let until = from + passage.until * (to - from);
            Some(Stop { traveller, other, part, passage: Passage { until, ..passage } })
        })?;
        // Two that move and overlap in the end are held by their contact, unless one is past the
        // middle of the other: that would push them on.
        let deep = DEEP_IN * f64::from(a.geometry().ccd_thickness() + b.geometry().ccd_thickness());
        let is_past = is_one_piece(a) && is_one_piece(b) && first.is_passed(second, stop.passage.normal, deep);
        let is_through =
            !first.is_dynamic || is_past || !first.holds_in_the_end(a, (second, b), stop.passage.normal, deep);
        let is_stop = is_through && !self.lets_pass([first.slot, second.slot], stop.part, &stop.passage);
        is_stop.then_some(stop)
    }

    /// Stops a body, and another that is as fast, with the impulses of a blow, which is returned.
    fn stop(
        &self,
        &Stop { traveller, other, part, passage }: &Stop,
        travellers: &mut [Traveller],
        columns: &mut WorldColumns<'_>,
        settings: &Settings,
    ) -> Option<ContactRecord> {
        let (gained, h) = (settings.gravity * settings.substep(), f64::from(settings.substep()));
        // What was stopped before stays where it is, and so does what comes up to it.
        let is_still = travellers[other].until < passage.until;
        let Traveller { is_free, is_fast, with: its, .. } = travellers[other];
        // A slow free body is left to its contact: its spin would lead round it, and through walls.
        let with = if is_still { its } else { (!is_free).then_some(other) };
        // What is stopped again and again may come nearer each time; free bodies keep their centre
        // of mass.
        let off = if is_free { DVec3::ZERO } else { (passage.normal * passage.too_near).into() };
        travellers[traveller].stop(passage.until, (with, off), columns, (gained, h));
        if is_free && is_fast && !is_still {
            travellers[other].stop(passage.until, (None, DVec3::ZERO), columns, (gained, h));
        }
        let both = [other, traveller].map(|it| &travellers[it]);
        let [first, second] = both.map(|it| {
            let at = it.at(it.until.min(passage.until));
            // What turns by more than half a turn hits again and again: in the mean it is a ball.
            let arm = if it.spins { Vec3::zero() } else { passage.point - at.position };
            let arm: Vec3<Real> = vec3(arm.into()).into();
            let orientation: Quat<Real> = quat(at.orientation.into()).into();
            let lock = AxisLock(it.locked_axes(columns));
            Struck { place: it.place, arm, orientation: orientation.normalize(), lock }
        });
        let slots = both.map(|it| it.slot);
        let surface = self.colliders.materials.between(slots, part);
        let normal: Vec3<Real> = vec3(passage.normal.into()).into();
        let blow = strike(columns, &[first, second], normal, &surface, settings.restitution_threshold)?;
        let states = slots.map(|slot| &self.collider_states.states[slot.index()]);
        let point = Vec3::from(vec3(passage.point.into())) - states[1].center;
        let margin = states[0].margin + states[1].margin;
        let contact = ContactRecord::of_blow(slots, part, normal, point, margin);
        Some(ContactRecord { closing_speed: blow.closing_speed, total_impulse: blow.impulse, ..contact })
    }
}

/// Whether a collider is one convex shape about its origin.
fn is_one_piece(collider: &Collider) -> bool {
    use ColliderShape::{Compound, HeightField, Hull, Mesh};
    !matches!(collider.geometry(), Compound(_) | HeightField(_) | Hull(_) | Mesh(_))
}

/// Has threads find something in parts, into lists that are used again.
fn in_parts<I: IndexedParallelIterator>(
    found: &mut Vec<Vec<Slot>>,
    parts: I,
    find: impl Fn(I::Item, &mut Vec<Slot>) + Sync,
) {
    found.resize_with(parts.len().max(found.len()), Vec::new);
    found.iter_mut().for_each(Vec::clear);
    parts.zip(found.par_iter_mut()).by_at_least(2).for_each(|(part, found)| find(part, found));
}
