//! Speculative contacts: those that bodies miss on their paths through a step are left out, and the
//! others lie where the bodies meet.
//!
//! A body that is stopped goes on along what stops it, so what it would have met behind is left
//! out, and what is beside counts.

use rayon::prelude::*;
use tumble_collide::{ColliderShape, Course, Meeting};
use tumble_math::lane::Vec3;

use crate::collision::collider_state::ColliderState;
use crate::collision::compound_parts::numbers;
use crate::collision::contact::ContactRecord;
use crate::collision::contact_ways::{Way, least_margin, nearest, stays_round};
use crate::collision::narrow_phase::LaneKind;
use crate::collision::partners::Partners;
use crate::collision::pipeline::{Colliders, CollisionPipeline, PART};
use crate::joints::joint_list::JointList;
use crate::math::Real;
use crate::storage::body_index::Slot;
use crate::threads::InParts;

/// Surfaces nearer than this part of their margin meet, but than no more than the smaller body's.
const MEETING: Real = 0.25;
/// What comes nearer by more than this part of its way is steep.
const STEEP: f64 = 0.2;
/// It meets where it is nearer than this part of that: edges have another normal a little later.
const MEETING_STEEPLY: f64 = 1e-2;
/// And balls where they are nearer than this part of their radii: on the way from there to where
/// they touch the line of their centres turns.
const MEETING_OF_BALLS: f64 = 1e-7;
/// How often a body may be stopped in a step and slide on along the obstacle.
const ROUNDS: usize = 3;
/// Slower than this part of the way they go they do not approach what they go along.
const ALONG: f64 = 1e-6;
/// Encounters that one thread follows at a time.
const FEW: usize = 4;

/// Two parts of two bodies that may meet.
pub(crate) struct Encounter<'a> {
    pub(crate) slots: [Slot; 2],
    pub(crate) kind: LaneKind,
    /// Numbers of the parts, and what they are.
    pub(crate) numbers: [u32; 2],
    pub(crate) shapes_of_pair: [&'a ColliderShape<Real>; 2],
    /// Of the parts in the bodies' colliders.
    pub(crate) inner: [tumble_collide::Isometry<Real>; 2],
    /// Of a half-space, which has an end nowhere: when its plane is met.
    pub(crate) plane: Option<Meeting>,
    pub(crate) meetings: Vec<Meeting>,
}

/// A body on its way.
pub(crate) struct Traveller {
    pub(crate) slot: Slot,
    pub(crate) course: Course,
    /// Outward normals of what has stopped it.
    pub(crate) stops: Vec<Vec3<f64>>,
    pub(crate) turned_off: f64,
}

impl CollisionPipeline {
    /// Goes along the ways of bodies that are about to get through the plane of a contact, under
    /// gravity that takes them so far \[m\] in a step, of which substeps are this part.
    pub(crate) fn limit_speculative(&mut self, (fall, substep): (Real, Real), joints: &JointList) {
        let Self { contacts, collider_states, colliders, ways, partners, ahead, .. } = self;
        let contacts = &mut contacts.records;
        let states = &collider_states.states[..];
        let radius = |slot: Slot| colliders.get(slot).map_or(0.0, |(it, _)| radius_of_curvature(it.geometry()));
        let class = |contact: &ContactRecord| {
            let of_pair = contact.slots.map(|slot| &states[slot.index()]);
            let way = Way::of(contact, of_pair, fall);
            let is_followed = || stays_round(contact, of_pair, substep, contact.slots.map(radius));
            if way == Way::Doubtful && is_followed() { Way::Plain } else { way }
        };
        ways.clear();
        ways.resize(contacts.len(), Way::Plain);
        let parts = ways.par_chunks_mut(PART).zip(contacts.par_chunks(PART));
        parts.by_at_least(2).for_each(|(ways, contacts)| {
            ways.iter_mut().zip(contacts).for_each(|(way, contact)| *way = class(contact));
        });
        let jointed = joints.joints.iter().flat_map(|joint| joint.slots);
        partners.count(contacts, ways, states, jointed);
        for (way, contact) in ways.iter_mut().zip(&*contacts).filter(|(way, _)| **way == Way::Free) {
            *way = if partners.are_alone(contact.slots, true) { Way::Doubtful } else { Way::Plain };
        }
        if ways.iter().all(|way| *way == Way::Plain) {
            return;
        }
        let mut encounters = encounters((contacts, ways), colliders, states);
        let mut travellers = travellers(&encounters, states);
        let view = View { states, colliders, fall, partners, ahead: *ahead };
        view.meet(&mut encounters, &travellers);
        let held = held_already((contacts, ways), &travellers, states);
        for _ in 0..ROUNDS {
            if !turn_off(&mut travellers, &encounters, &held, states) {
                break;
            }
            view.meet_again(&mut encounters, &travellers);
        }
        let (mut ways, mut before) = (ways.iter(), Vec::new());
        contacts.retain(|contact| {
            let way = ways.next();
            if way == Some(&Way::Doubtful) {
                before.push(contact.clone());
            }
            way == Some(&Way::Plain)
        });
        let plain = contacts.len();
        for encounter in &encounters {
            view.add(encounter, &travellers, (&before, plain), contacts);
        }
        if !encounters.is_empty() {
            contacts.sort_by_key(ContactRecord::key);
        }
    }
}

/// Those of doubtful contacts, each once.
fn encounters<'a>(
    (contacts, ways): (&[ContactRecord], &[Way]),
    colliders: &'a Colliders,
    states: &[ColliderState],
) -> Vec<Encounter<'a>> {
    let mut encounters: Vec<Encounter<'a>> = Vec::new();
    for (contact, _) in contacts.iter().zip(ways).filter(|(_, way)| **way == Way::Doubtful) {
        let [Some((a, _)), Some((b, _))] = contact.slots.map(|slot| colliders.get(slot)) else {
            continue;
        };
        let [first, second] = numbers(contact.part, b.geometry().parts());
        let [(first, at, one), (second, other_at, other)] = [a.geometry().part_of(first), b.geometry().part_of(second)];
        let is_known = |known: &Encounter<'_>| known.slots == contact.slots && known.numbers == [first, second];
        // Contacts of one pair of bodies follow each other.
        let of_pair = encounters.iter().rev().take_while(|known| known.slots == contact.slots);
        if !of_pair.into_iter().any(is_known) {
            encounters.push(Encounter {
                slots: contact.slots,
                kind: contact.kind,
                numbers: [first, second],
                shapes_of_pair: [one, other],
                inner: [at, other_at],
                plane: [one, other]
                    .contains(&&ColliderShape::HalfSpace)
                    .then(|| plane(contact, contact.slots.map(|slot| &states[slot.index()]))),
                meetings: Vec::new(),
            });
        }
    }
    encounters
}

/// When the plane of a contact is met.
fn plane(contact: &ContactRecord, states: [&ColliderState; 2]) -> Meeting {
    let normal = normal(contact);
    let [first, second] = states.map(|state| state.motion.way + state.motion.drop);
    let way = wide(second - first);
    let (gap, along) = (f64::from(nearest(contact)), -normal.dot(way));
    Meeting { moment: if along > gap { gap / along } else { 1.0 }, is_hit: along > gap, distance: 0.0, normal }
}

/// The least that the surface of a shape has wherever it is touched \[m\].
fn radius_of_curvature(shape: &ColliderShape<Real>) -> Real {
    match shape {
        ColliderShape::Sphere { radius } | ColliderShape::Capsule { radius, .. } => *radius,
        _ => 0.0,
    }
}

pub(crate) fn is_surface(geometry: &ColliderShape<Real>) -> bool {
    matches!(geometry, ColliderShape::Mesh(_) | ColliderShape::HeightField(_))
}

pub(crate) fn normal(contact: &ContactRecord) -> Vec3<f64> {
    wide(contact.geometry.normal)
}

/// The bodies of encounters, by slot.
fn travellers(encounters: &[Encounter<'_>], states: &[ColliderState]) -> Vec<Traveller> {
    let mut slots: Vec<Slot> = encounters.iter().flat_map(|encounter| encounter.slots).collect();
    slots.sort_unstable();
    slots.dedup();
    let traveller = |slot: Slot| {
        let ColliderState { placement, center, motion, .. } = &states[slot.index()];
        let course = Course::new(placement, *center, motion.way + motion.drop, motion.turn);
        Traveller { slot, course, stops: Vec::new(), turned_off: 0.0 }
    };
    slots.into_iter().map(traveller).collect()
}

fn find(travellers: &[Traveller], slot: Slot) -> usize {
    travellers.partition_point(|traveller| traveller.slot < slot)
}

/// The contacts that hold travellers from the beginning: who, the other body, the outward normal.
fn held_already(
    (contacts, ways): (&[ContactRecord], &[Way]),
    travellers: &[Traveller],
    states: &[ColliderState],
) -> Vec<(usize, Slot, Vec3<f64>)> {
    let mut held = Vec::new();
    if travellers.is_empty() {
        return held;
    }
    for (contact, way) in contacts.iter().zip(ways) {
        let [a, b] = contact.slots;
        let (slot, other, sign) = match [a, b].map(|slot| states[slot.index()].is_dynamic) {
            [true, false] => (a, b, -1.0),
            [false, true] => (b, a, 1.0),
            _ => continue,
        };
        if *way == Way::Doubtful || nearest(contact) > contact.margin() {
            continue;
        }
        let place = find(travellers, slot);
        if travellers.get(place).is_some_and(|traveller| traveller.slot == slot) {
            held.push((place, other, normal(contact) * sign));
        }
    }
    held
}

/// How far a body goes in a step at a moment.
fn linear(travellers: &[Traveller], states: &[ColliderState], slot: Slot, moment: f64) -> Vec3<f64> {
    match travellers.get(find(travellers, slot)).filter(|traveller| traveller.slot == slot) {
        Some(traveller) => traveller.course.linear(moment),
        None => wide(states[slot.index()].motion.way),
    }
}

pub(crate) fn wide(v: Vec3<Real>) -> Vec3<f64> {
    Vec3::new(v.x.into(), v.y.into(), v.z.into())
}

/// When a body is stopped, how it goes on, and the normals of what has stopped it.
type Change = (f64, Vec3<f64>, Vec<Vec3<f64>>);

/// Lets those that are stopped for the next time go on along what stops them; whether there are
/// any.
fn turn_off(
    travellers: &mut [Traveller],
    encounters: &[Encounter<'_>],
    held: &[(usize, Slot, Vec3<f64>)],
    states: &[ColliderState],
) -> bool {
    // By traveller: when, by whom, and the outward normal.
    let mut stops: Vec<Vec<(f64, Slot, Vec3<f64>)>> = travellers.iter().map(|_| Vec::new()).collect();
    for (place, other, normal) in held {
        stops[*place].push((0.0, *other, *normal));
    }
    for encounter in encounters {
        let [a, b] = encounter.slots;
        for met in encounter.meetings.iter().filter(|met| met.is_hit) {
            // A dynamic body may be left out of the step later, and must not have changed others.
            if !states[b.index()].is_dynamic {
                stops[find(travellers, a)].push((met.moment, b, met.normal * -1.0));
            }
            if !states[a.index()].is_dynamic {
                stops[find(travellers, b)].push((met.moment, a, met.normal));
            }
        }
    }
    let mut changes: Vec<Option<Change>> = Vec::new();
    for (traveller, stops) in travellers.iter().zip(&mut stops) {
        changes.push(None);
        if !states[traveller.slot.index()].is_dynamic {
            continue;
        }
        stops.sort_by(|a, b| a.0.total_cmp(&b.0));
        let stop =
            stops.iter().filter(|(moment, ..)| *moment >= traveller.turned_off).find(|(moment, other, normal)| {
                let (way, its) = (traveller.course.linear(*moment), linear(travellers, states, *other, *moment));
                let most = (way.dot(way) + its.dot(its)).sqrt();
                normal.dot(way - its) < -ALONG * most
            });
        let Some((moment, other, normal)) = stop else { continue };
        let (way, its) = (traveller.course.linear(*moment), linear(travellers, states, *other, *moment));
        let mut way = way - *normal * normal.dot(way - its);
        let mut normals = traveller.stops.clone();
        normals.push(*normal);
        // Into a corner, it goes along none of the planes there but along their edge.
        for _ in 0..ROUNDS {
            for normal in &normals {
                way = way - *normal * normal.dot(way - its).min(0.0);
            }
        }
        if let Some(change) = changes.last_mut() {
            *change = Some((*moment, way, normals));
        }
    }
    let is_any = changes.iter().any(Option::is_some);
    for (traveller, change) in travellers.iter_mut().zip(changes) {
        if let Some((moment, way, normals)) = change {
            traveller.course = traveller.course.turned_off(moment, way);
            (traveller.turned_off, traveller.stops) = (moment, normals);
        }
    }
    is_any
}

/// The states and colliders of the bodies.
pub(crate) struct View<'a> {
    pub(crate) states: &'a [ColliderState],
    pub(crate) colliders: &'a Colliders,
    pub(crate) fall: Real,
    pub(crate) partners: &'a Partners,
    /// The time in which they go their ways \[s\].
    pub(crate) ahead: Real,
}

impl View<'_> {
    pub(crate) fn margin(&self, slots: [Slot; 2]) -> Real {
        slots.iter().fold(0.0, |sum, slot| sum + self.states[slot.index()].margin)
    }

    pub(crate) fn courses(&self, encounter: &Encounter<'_>, travellers: &[Traveller]) -> [Course; 2] {
        let course = |which: usize| {
            let traveller = &travellers[find(travellers, encounter.slots[which])];
            traveller.course.of_part(&encounter.inner[which])
        };
        [course(0), course(1)]
    }

    fn find(&self, encounter: &Encounter<'_>, travellers: &[Traveller]) -> Option<Meeting> {
        let [first, second] = self.courses(encounter, travellers);
        let margin = self.margin(encounter.slots);
        let slack = f64::from(margin + self.fall);
        if encounter.plane.is_some() {
            return encounter.plane;
        }
        let least = least_margin(encounter.slots.map(|slot| &self.states[slot.index()]));
        let radius = |shape: &ColliderShape<Real>| match shape {
            ColliderShape::Sphere { radius } => f64::from(*radius),
            _ => f64::INFINITY,
        };
        let radii: f64 = encounter.shapes_of_pair.into_iter().map(radius).sum();
        let tolerance = f64::from((MEETING * margin).min(least)).min(MEETING_OF_BALLS * radii);
        let find = |tolerance: f64| Meeting::find(encounter.shapes_of_pair, [&first, &second], tolerance, slack);
        let met = find(tolerance)?;
        let way = second.linear(met.moment) - first.linear(met.moment);
        let is_steep = -met.normal.dot(way) > STEEP * way.dot(way).sqrt();
        Some(match radii.is_finite() {
            true => touching(met, [&first, &second], radii),
            false if met.is_hit && is_steep => {
                find(MEETING_STEEPLY * tolerance).filter(|met| met.is_hit).unwrap_or(met)
            }
            false => met,
        })
    }

    fn meet(&self, encounters: &mut [Encounter<'_>], travellers: &[Traveller]) {
        encounters.par_chunks_mut(FEW).by_at_least(2).for_each(|encounters| {
            for encounter in encounters {
                encounter.meetings = self.find(encounter, travellers).into_iter().collect();
            }
        });
    }

    /// The same for those whose bodies have turned off before they met.
    fn meet_again(&self, encounters: &mut [Encounter<'_>], travellers: &[Traveller]) {
        encounters.par_chunks_mut(FEW).by_at_least(2).for_each(|encounters| {
            for encounter in encounters {
                let of = |slot: Slot| &travellers[find(travellers, slot)];
                let turned = encounter
                    .slots
                    .map(of)
                    .map(|traveller| if traveller.stops.is_empty() { f64::INFINITY } else { traveller.turned_off });
                let turned = f64::min(turned[0], turned[1]);
                let is_over = |met: &Meeting| met.is_hit && met.moment <= turned;
                if turned.is_finite() && !encounter.meetings.iter().any(is_over) {
                    encounter.meetings = self.find(encounter, travellers).into_iter().collect();
                }
            }
        });
    }
}

/// The meeting of balls in the moment when they touch, from shortly before.
fn touching(met: Meeting, [first, second]: [&Course; 2], radii: f64) -> Meeting {
    let [apart, way] = [
        second.at(met.moment).position - first.at(met.moment).position,
        second.linear(met.moment) - first.linear(met.moment),
    ];
    let (a, b, c) = (way.dot(way), -apart.dot(way), apart.dot(apart) - radii * radii);
    let root = b * b - a * c;
    if !met.is_hit || b <= 0.0 || root < 0.0 {
        return met;
    }
    let moment = (met.moment + c / (b + root.sqrt())).clamp(0.0, 1.0);
    let between = apart + way * (moment - met.moment);
    Meeting { moment, distance: 0.0, normal: between * (1.0 / radii), is_hit: true }
}
