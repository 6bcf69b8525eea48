//! Floors of several: what slides over one is not stopped by the edge of the next.
//!
//! A contact holds a body over a plane through the whole step. What lies beside with its highest
//! point at that plane is not met, whatever way out of it is the shortest: the body would have to
//! be under the plane.

use tumble_collide::ColliderShape;
use tumble_math::lane::Vec3;

use crate::collision::collider_state::{Activity, ColliderState};
use crate::collision::compound_parts::numbers;
use crate::collision::contact::ContactRecord;
use crate::collision::contact_set::ContactSet;
use crate::collision::pipeline::{Colliders, CollisionPipeline};
use crate::math::Real;
use crate::storage::body_index::Slot;

/// A body that slides less than this part of a margin in a step meets no internal edge.
const SLIDES: Real = 0.5;
/// Tops that differ by less than this part of the margin are one floor: a hundredth of half the
/// thickness of what slides.
const LEVEL: Real = 0.5;
/// Normals with a cosine above this are those of one floor: of faces, which may lie on it at a
/// small angle, ...
const SAME_FACE: Real = 0.9999;
/// ... and of single points, which are exact.
const SAME_NORMAL: Real = 0.999_999;
/// Most contacts of a body on a floor that are compared.
const MAX: usize = 64;

/// Scratch memory of the search for internal edges.
#[derive(Clone, Default)]
pub(crate) struct InternalEdges {
    /// By slot: whether the body is in contact with a non-dynamic body, or is one.
    on_fixed: Vec<bool>,
    /// Slots of bodies on a floor, and the numbers of their contacts with what they go past.
    sliding: Vec<(Slot, u32)>,
    /// Numbers of contacts with an edge, and with the floor beside it.
    left_out: Vec<(u32, u32)>,
}

/// A plane that holds a body over it.
#[derive(Clone, Copy)]
pub(crate) struct Floor {
    normal: Vec3<Real>,
    /// A point of the plane.
    point: Vec3<Real>,
    /// Differences in height that do not count \[m\].
    level: Real,
}

impl Floor {
    /// That of a contact, under its second body or the first.
    pub(crate) fn of(contact: &ContactRecord, under_second: bool, states: &[ColliderState]) -> Self {
        let normal = contact.geometry.normal;
        let [first, second] = contact.slots.map(|slot| states[slot.index()].center);
        let sign = if under_second { 0.5 } else { -0.5 };
        let point = match contact.met_point() {
            // How far it turns until then is in the separation too.
            Some(met) if under_second => first + met,
            _ => second + contact.half_way(0) - normal * (contact.separation(0) * sign),
        };
        let normal = if under_second { normal } else { normal * -1.0 };
        Self { normal, point, level: LEVEL * contact.margin() }
    }

    /// Whether the highest point of a part of a body is at the plane.
    pub(crate) fn is_level_with(&self, geometry: &ColliderShape<Real>, number: u32, shape: &ColliderState) -> bool {
        let (_, inner, part) = geometry.part_of(number);
        let at = shape.placement.then(&inner);
        let top = part.furthest(at.orientation.rotate_back(self.normal));
        top.is_some_and(|top| {
            let height = self.normal.dot(at.position + at.orientation.rotate(top) - self.point);
            height.abs() <= self.level
        })
    }
}

impl InternalEdges {
    /// Finds the bodies on a floor that go past something else that they are in contact with.
    fn find_sliding(&mut self, contacts: &[ContactRecord], states: &[ColliderState]) {
        let Self { on_fixed, sliding, .. } = self;
        // Only non-dynamic bodies are floors: a dynamic one may be left out of the step later.
        on_fixed.clear();
        on_fixed.resize(states.len(), false);
        for ContactRecord { slots: [a, b], .. } in contacts {
            if states[a.index()].is_dynamic != states[b.index()].is_dynamic {
                (on_fixed[a.index()], on_fixed[b.index()]) = (true, true);
            }
        }
        sliding.clear();
        for (index, contact) in (0_u32..).zip(contacts) {
            let may_slide = |slot: Slot| on_fixed[slot.index()] && states[slot.index()].is_dynamic;
            if !contact.slots.into_iter().any(may_slide) {
                continue;
            }
            let [a, b] = contact.slots.map(|slot| &states[slot.index()]);
            let (way, most) = (b.motion.way - a.motion.way, SLIDES * contact.margin());
            if way.dot(way) > most * most {
                sliding.extend(contact.slots.into_iter().filter(|slot| may_slide(*slot)).map(|slot| (slot, index)));
            }
        }
        sliding.sort_unstable();
    }

    /// Finds the contacts with what lies level with a floor.
    fn find_seams(&mut self, contacts: &[ContactRecord], states: &[ColliderState], colliders: &Colliders) {
        let Self { sliding, left_out, .. } = self;
        left_out.clear();
        for group in sliding.chunk_by(|a, b| a.0 == b.0).filter(|group| group.len() > 1) {
            let slot = group[0].0;
            for (_, of_edge) in group.iter().take(MAX) {
                let edge = &contacts[*of_edge as usize];
                let other = usize::from(edge.slots[0] == slot);
                let its_slot = edge.slots[other];
                let Some((collider, _)) = colliders.get(its_slot) else { continue };
                let Some((second, _)) = colliders.get(edge.slots[1]) else { continue };
                let number = numbers(edge.part, second.geometry().parts())[other];
                let away = normal_of(edge, slot);
                let floor = group.iter().take(MAX).filter(|(_, index)| index != of_edge).find(|(_, index)| {
                    let contact = &contacts[*index as usize];
                    let under = contact.slots[usize::from(contact.slots[0] == slot)];
                    let up = normal_of(contact, slot).dot(away);
                    let floor = || Floor::of(contact, contact.slots[1] == slot, states);
                    let is_one_point = contact.count() == 1 && edge.count() == 1;
                    let same = if is_one_point { SAME_NORMAL } else { SAME_FACE };
                    (SAME_FACE - 1.0..same).contains(&up)
                        && !states[under.index()].is_dynamic
                        && floor().is_level_with(collider.geometry(), number, &states[its_slot.index()])
                        && is_face(contact, slot, states, colliders)
                });
                if let Some((_, of_floor)) = floor {
                    left_out.push((*of_edge, *of_floor));
                }
            }
        }
    }
}

impl CollisionPipeline {
    /// Leaves out the contacts of bodies with what lies level with the floor that they slide over.
    pub(crate) fn leave_out_internal_edges(&mut self) {
        let Self { contacts: ContactSet { records: contacts, .. }, collider_states, colliders, internal_edges, .. } =
            self;
        let states = &collider_states.states[..];
        let slides = |state: &ColliderState, margin: Real| {
            let way = state.motion.way;
            way.dot(way) > SLIDES * SLIDES * margin * margin
        };
        let mut awake =
            states.iter().zip(&collider_states.activity).filter(|(_, activity)| **activity == Activity::Awake);
        if !awake.any(|(state, _)| slides(state, state.margin)) {
            return;
        }
        internal_edges.find_sliding(contacts, states);
        internal_edges.find_seams(contacts, states, colliders);
        let left_out = &mut internal_edges.left_out;
        if left_out.is_empty() {
            return;
        }
        left_out.sort_unstable();
        left_out.dedup_by_key(|(of_edge, _)| *of_edge);
        for (_, of_floor) in &*left_out {
            // Where the one ends the plane goes on.
            contacts[*of_floor as usize].hold_still();
        }
        let left_out = left_out.iter().map(|(of_edge, _)| *of_edge);
        let (mut left_out, mut index) = (left_out.peekable(), 0);
        contacts.retain(|_| {
            let stays = left_out.next_if_eq(&index).is_none();
            index += 1;
            stays
        });
    }
}

/// Whether a contact holds a body over a flat face of the other: what holds it over an edge may
/// itself be a seam.
fn is_face(contact: &ContactRecord, slot: Slot, states: &[ColliderState], colliders: &Colliders) -> bool {
    let other = usize::from(contact.slots[0] == slot);
    let [Some((collider, _)), Some((second, _))] = [other, 1].map(|which| colliders.get(contact.slots[which])) else {
        return false;
    };
    let number = numbers(contact.part, second.geometry().parts())[other];
    let (_, inner, part) = collider.geometry().part_of(number);
    let at = states[contact.slots[other].index()].placement.then(&inner);
    part.has_face(at.orientation.rotate_back(normal_of(contact, slot)))
}

/// The normal of a contact towards a body.
fn normal_of(contact: &ContactRecord, slot: Slot) -> Vec3<Real> {
    let normal = contact.geometry.normal;
    if contact.slots[1] == slot { normal } else { normal * -1.0 }
}
