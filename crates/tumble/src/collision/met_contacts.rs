//! The contacts of bodies that meet on their ways, as they lie when the step begins.

use tumble_collide::{ColliderShape, Course, Follow, Manifold, Meeting};
use tumble_math::lane::Vec3;

use crate::collision::collider_state::ColliderState;
use crate::collision::compound_parts::numbers;
use crate::collision::contact::{ContactKey, ContactRecord, MeetingPlace, Second, UpdateRule};
use crate::collision::contact_ways::{SAME_NORMAL, length};
use crate::collision::speculative::{Encounter, Traveller, View, is_surface, normal, wide};
use crate::math::{Real, real, vec3};
use crate::storage::body_index::Slot;

/// A contact stays as it was found if its normal is the same and the bodies go past each other by
/// less than this many margins until they meet.
const BESIDE: f64 = 10.0;
/// And if its plane is, to this part of the margin.
const SAME_PLANE: f64 = 0.05;
/// Contact points stay where they are on a body that turns by less \[rad\] about axes other than
/// its axis of symmetry.
const ROLLS: Real = 0.2;
/// What goes past another by less than this part of its radius lands on it: its points turn with
/// the bodies, to second order in the angle, and not with the arms that they have when they meet.
const PAST: f64 = 0.02;

impl View<'_> {
    /// Adds the contacts of an encounter; those there were `before` stay where they hold as well,
    /// and so do the first contacts, as many as are `plain`.
    pub(crate) fn add(
        &self,
        encounter: &Encounter<'_>,
        travellers: &[Traveller],
        (before, plain): (&[ContactRecord], usize),
        contacts: &mut Vec<ContactRecord>,
    ) {
        let Encounter { slots, kind, shapes_of_pair, .. } = encounter;
        let states = slots.map(|slot| &self.states[slot.index()]);
        let [Some((a, _)), Some((b, _))] = slots.map(|slot| self.colliders.get(slot)) else { return };
        let [first, second] = self.courses(encounter, travellers);
        let (margin, parts) = (self.margin(*slots), b.geometry().parts());
        let from = contacts.len();
        let pair = ContactKey::new(*kind, *slots, 0);
        let before = &before[before.partition_point(|known| known.key() < pair)..];
        let before = before.iter().take_while(|known| known.slots == *slots);
        // Of the parts' contacts, of which a surface has one a triangle.
        let is_theirs = |known: &ContactRecord| {
            let [on_first, on_second] = numbers(known.part, parts);
            [a.geometry().part_of(on_first).0, b.geometry().part_of(on_second).0] == encounter.numbers
        };
        if encounter.plane.is_some() {
            contacts.extend(before.filter(|known| is_theirs(known)).cloned());
            return;
        }
        let are_balls = before.clone().any(ContactRecord::is_between_centers);
        let (follow, rule) = self.update_rule(encounter, [&first, &second], are_balls);
        let of_second = Second { center: states[1].center, has_non_dynamic: !states[0].is_dynamic, margin };
        // Once they have met, what is behind comes down on the same plane.
        let reach = states[0].reach + states[1].reach;
        let mut is_shown = false;
        for met in &encounter.meetings {
            let least = margin + real(met.distance.clamp(0.0, f64::from(reach)));
            let way = second.gone(met.moment) - first.gone(met.moment);
            let meeting = self.meeting_place(met, [&first, &second], follow);
            // Of a surface only some triangles are met; the nearest points of others need not be
            // over a face.
            let near = if shapes_of_pair.iter().any(|it| is_surface(it)) { least } else { Real::INFINITY };
            met.manifolds(
                *shapes_of_pair,
                [&first, &second],
                [near, reach.max(least)],
                follow,
                &mut |part, manifold| {
                    let [on_first, on_second] = numbers(part, shapes_of_pair[1].parts());
                    let of_first = (encounter.numbers[0] + on_first).wrapping_mul(parts);
                    let part = of_first.wrapping_add(encounter.numbers[1] + on_second);
                    let is_there = |known: &ContactRecord| known.slots == *slots && known.part == part;
                    let key = ContactKey::new(*kind, *slots, part);
                    let stays = contacts[..plain].binary_search_by_key(&key, ContactRecord::key).is_ok();
                    is_shown |= stays;
                    if stays || !a.parts_touch(b, part) || contacts[from..].iter().any(is_there) {
                        return;
                    }
                    let known = before.clone().find(|known| is_there(known));
                    let same = known
                        .filter(|known| !known.is_between_centers() && met.is_hit && is_same(known, manifold, way));
                    contacts.push(match same {
                        Some(known) => known.clone(),
                        None => {
                            let found = ContactRecord::new(*slots, part, manifold, of_second, rule);
                            ContactRecord { kind: *kind, meeting, ..found }
                        }
                    });
                },
            );
            if contacts.len() == from && met.is_hit && !is_shown {
                contacts.extend(before.clone().filter(|known| is_theirs(known)).cloned());
            }
        }
    }

    /// Where and when they meet, for contacts that have the arms of then.
    fn meeting_place(&self, met: &Meeting, courses: [&Course; 2], follow: Follow) -> MeetingPlace {
        if follow != Follow::Velocities {
            return MeetingPlace::NONE;
        }
        let [first, second] = courses.map(|course| course.center_and_turn(met.moment).0);
        MeetingPlace { apart: vec3((second - first).into()).into(), time: real(met.moment) * self.ahead }
    }

    /// What points of an encounter go along with until the bodies meet, and within the step.
    fn update_rule(&self, encounter: &Encounter<'_>, courses: [&Course; 2], are_balls: bool) -> (Follow, UpdateRule) {
        let slots = encounter.slots;
        let goes_past = are_balls || encounter.meetings.iter().any(|met| self.goes_past(slots, met, courses));
        // Impulses before two meet act in one point, or angular momentum would be lost that only
        // two that are alone get back.
        let are_both_free = slots.iter().all(|slot| self.states[slot.index()].is_dynamic);
        let keeps_momentum = if are_both_free {
            self.partners.are_alone(slots, are_balls)
        } else {
            let is_held = |slot: &Slot| self.states[slot.index()].is_dynamic && self.partners.is_jointed(*slot);
            are_balls || !slots.iter().any(is_held)
        };
        match (keeps_momentum && goes_past, are_balls) {
            (true, true) => (Follow::Velocities, UpdateRule::MeetingCenters),
            (true, false) => (Follow::Velocities, UpdateRule::Meeting),
            (false, _) if self.rolls(encounter) => (Follow::Centers, UpdateRule::Constant),
            (false, _) => (Follow::Bodies, UpdateRule::BodyFixed),
        }
    }

    /// Whether until two meet one goes past the other by more than what its arms may be off by.
    fn goes_past(&self, slots: [Slot; 2], met: &Meeting, [first, second]: [&Course; 2]) -> bool {
        let way = second.gone(met.moment) - first.gone(met.moment);
        let dynamic = slots.into_iter().map(|slot| &self.states[slot.index()]).filter(|state| state.is_dynamic);
        let least = dynamic.fold(f64::INFINITY, |least, state| least.min(state.motion.radius.into()));
        across(way, met.normal) > PAST * least
    }

    /// Whether one of two bodies turns under its points.
    fn rolls(&self, encounter: &Encounter<'_>) -> bool {
        let rolls = |which: usize| {
            let ColliderState { motion, placement, .. } = &self.states[encounter.slots[which].index()];
            let turn = motion.turn;
            let is_round = encounter.shapes_of_pair[which].is_round();
            let [_, axis, _] = placement.orientation.axes();
            let about_others = turn - axis * axis.dot(turn);
            let ball = matches!(encounter.shapes_of_pair[which], ColliderShape::Sphere { .. });
            is_round && (ball || length(about_others) <= ROLLS)
        };
        rolls(0) || rolls(1)
    }
}

/// How far a way goes past what has this normal.
fn across(way: Vec3<f64>, normal: Vec3<f64>) -> f64 {
    let across = way - normal * normal.dot(way);
    across.dot(across).sqrt()
}

/// Whether a contact has the plane that the bodies meet with, after one has gone this way past the
/// other.
fn is_same(known: &ContactRecord, manifold: &Manifold<Real>, way: Vec3<f64>) -> bool {
    let (before, now, margin) = (normal(known), wide(manifold.normal), f64::from(known.margin()));
    let (turned, across) = (before.cross(now), across(way, now));
    let turned = turned.dot(turned).sqrt();
    before.dot(now) > 0.0
        && across <= BESIDE * margin
        && turned <= SAME_NORMAL
        && turned * across <= SAME_PLANE * margin
}
