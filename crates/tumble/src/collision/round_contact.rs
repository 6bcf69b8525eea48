//! Contacts of round shapes, found again where their bodies have moved to within a step.

use tumble_collide::{ColliderShape, Isometry, Manifold, contact_manifold_near, contact_manifolds};
use tumble_math::lane::Vec3;

use crate::collision::collider_state::ColliderState;
use crate::collision::compound_parts::numbers;
use crate::collision::contact::ContactRecord;
use crate::collision::contact_ways::length;
use crate::collision::crossed_axes::CrossedAxes;
use crate::collision::pipeline::Colliders;
use crate::math::Real;
use crate::storage::body_index::Slot;

/// A contact of which a shape is round. Lengths are from the second body's centre of mass when the
/// step began.
#[derive(Clone)]
pub(crate) struct RoundContact {
    /// Its number among the contacts.
    pub(crate) contact: u32,
    /// Of the pair of parts that meet, in what follows: of compounds the two parts alone.
    part: u32,
    /// Of its bodies, if neither shape is a part of a compound.
    whole: Option<[Slot; 2]>,
    geometries: [ColliderShape<Real>; 2],
    /// As it was found, of two shapes of one part.
    normal: Option<Vec3<Real>>,
    placements: [Isometry<Real>; 2],
    /// Whether the first body is not dynamic.
    pub(crate) has_non_dynamic: bool,
    /// The first body's centre of mass.
    apart: Vec3<Real>,
    /// How near surfaces are a contact within a substep \[m\].
    margin: Real,
    /// Shapes whose origins are further apart \[m\] are no contact.
    far: Real,
    /// Of capsules that cross, which are found again in lanes.
    pub(crate) crossed_axes: Option<CrossedAxes>,
}

/// Within a substep bodies come together by at most this number of times what a substep's part of a
/// step takes them.
const SPEED_UP: Real = 2.0;

/// A pair that has moved by less than this part of its margin is where it was.
const STILL: Real = 1e-3;

impl RoundContact {
    /// Of a contact of this number, in substeps of this part of the step; `None` of one that is not
    /// found again.
    pub(crate) fn of(
        (number, contact): (u32, &ContactRecord),
        colliders: &Colliders,
        states: &[ColliderState],
        part_of_step: Real,
    ) -> Option<Self> {
        if !contact.is_refined() {
            return None;
        }
        let slots = contact.slots;
        let states = slots.map(|slot| &states[slot.index()]);
        let [Some((a, _)), Some((b, _))] = contact.slots.map(|slot| colliders.get(slot)) else { return None };
        let origin = states[1].center;
        let (part, [(inner, first), (other_inner, second)]) = parts([a.geometry(), b.geometry()], contact.part);
        let inner = [inner, other_inner];
        let placements = [0, 1].map(|which| {
            let Isometry { position, orientation } = states[which].placement;
            let body = Isometry { position: position - origin, orientation };
            inner[which].map_or(body, |inner| body.then(&inner))
        });
        let [reach, margin] = [states[0].reach + states[1].reach, states[0].margin + states[1].margin];
        let margin = reach.min(margin + SPEED_UP * part_of_step * (reach - margin));
        let has_non_dynamic = !states[0].is_dynamic;
        let apart = states[0].center - origin;
        let [mut about_first, about_second] = placements;
        about_first.position = about_first.position - apart;
        let turns = states.map(|state| length(state.motion.turn));
        let share = if has_non_dynamic { 1.0 } else { 0.5 };
        let crossed_axes = CrossedAxes::of([first, second], [about_first, about_second], turns, share);
        let radius = |shape: &ColliderShape<Real>| shape.reach().unwrap_or(Real::INFINITY);
        Some(Self {
            contact: number,
            part,
            whole: inner.iter().all(Option::is_none).then_some(slots),
            geometries: [first.clone(), second.clone()],
            normal: [first, second].iter().all(|shape| shape.parts() == 1).then_some(contact.geometry.normal),
            placements,
            has_non_dynamic,
            apart,
            margin,
            far: radius(first) + radius(second) + margin,
            crossed_axes: crossed_axes.filter(|_| contact.count() == 1),
        })
    }

    /// Whether the manifolds of another contact of the same bodies are found with this one's.
    pub(crate) fn is_found_with(&self, other: &Self) -> bool {
        self.whole.is_some() && self.whole == other.whole
    }

    /// Of those that were found, its own.
    pub(crate) fn of_part(&self, found: &[(u32, Manifold<Real>)]) -> Manifold<Real> {
        let own = found.iter().rev().find(|(part, _)| *part == self.part);
        own.map_or(Manifold::none(), |(_, manifold)| *manifold)
    }

    /// Finds the manifolds now, by part, about the second body's centre of mass as it is now, if
    /// the bodies have moved: by these delta poses since the step began, of centres of mass \[m\]
    /// and orientations. Returns whether they have.
    pub(crate) fn find(
        &self,
        delta_poses: [Isometry<Real>; 2],
        has_turned: bool,
        found: &mut Vec<(u32, Manifold<Real>)>,
    ) -> bool {
        let [first, second] = delta_poses;
        let slid = first.position - second.position;
        let still = STILL * self.margin;
        if !has_turned && slid.dot(slid) < still * still {
            return false;
        }
        let [a, b] = &self.placements;
        let (p, q) = (first.orientation, second.orientation);
        let positions = [self.apart + slid + p.rotate(a.position - self.apart), q.rotate(b.position)];
        let apart = positions[1] - positions[0];
        if apart.dot(apart) > self.far * self.far {
            return true;
        }
        let first_at = Isometry { position: positions[0], orientation: p * a.orientation };
        let second_at = Isometry { position: positions[1], orientation: q * b.orientation };
        let [one, other] = &self.geometries;
        if let Some(normal) = self.normal {
            let manifold = contact_manifold_near(one, &first_at, other, &second_at, self.margin, normal);
            if !manifold.points().is_empty() {
                found.push((0, manifold));
            }
            return true;
        }
        contact_manifolds(one, &first_at, other, &second_at, self.margin, &mut |part, manifold| {
            found.push((part, *manifold));
        });
        true
    }
}

/// A shape, and where it is in a collider if it is a part of that.
type Placed<'a> = (Option<Isometry<Real>>, &'a ColliderShape<Real>);

/// The parts of two shapes that have a pair's number, and its number among the pairs of these.
fn parts([first, second]: [&ColliderShape<Real>; 2], pair: u32) -> (u32, [Placed<'_>; 2]) {
    let is_compound = [first, second].iter().any(|shape| matches!(shape, ColliderShape::Compound(_)));
    if !is_compound || first.parts().checked_mul(second.parts()).is_none() {
        return (pair, [(None, first), (None, second)]);
    }
    let [on_first, on_second] = numbers(pair, second.parts());
    let [(from, at, one), (other_from, other_at, other)] = [first.part_of(on_first), second.part_of(on_second)];
    let part = (on_first - from) * other.parts() + (on_second - other_from);
    (part, [(Some(at), one), (Some(other_at), other)])
}
