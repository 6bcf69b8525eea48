//! Contacts of round shapes, found again where their bodies have moved to within a step.

use tumble_collide::{ColliderShape, Isometry, Manifold, contact_manifolds};
use tumble_math::lane::{Quat, Vec3};

use crate::collision::collider_state::ColliderState;
use crate::collision::contact::ContactRecord;
use crate::collision::pipeline::Colliders;
use crate::math::Real;

/// A contact of which a shape is round. Lengths are from the second body's centre of mass when the
/// step began.
#[derive(Clone)]
pub(crate) struct RoundContact {
    /// Its number among the contacts.
    pub(crate) contact: u32,
    part: u32,
    geometries: [ColliderShape<Real>; 2],
    placements: [Isometry<Real>; 2],
    /// Whether impulses move the second body alone.
    pub(crate) alone: bool,
    /// The first body's centre of mass.
    apart: Vec3<Real>,
    /// How near surfaces are a contact \[m\].
    margin: Real,
}

/// How a body has moved since the step began.
#[derive(Clone, Copy)]
pub(crate) struct Displacement {
    /// Of its centre of mass \[m\].
    pub(crate) way: Vec3<Real>,
    pub(crate) turn: Quat<Real>,
    /// Whether it has turned at all.
    pub(crate) has_turned: bool,
}

/// A pair that has moved by less than this part of its margin is where it was.
const STILL: Real = 1e-3;

impl RoundContact {
    /// Of a contact of this number; `None` of one that is not found again.
    pub(crate) fn of(
        (number, contact): (u32, &ContactRecord),
        colliders: &Colliders,
        states: &[ColliderState],
    ) -> Option<Self> {
        if !contact.is_refined() {
            return None;
        }
        let shapes = contact.slots.map(|slot| &states[slot.index()]);
        let [Some((a, _)), Some((b, _))] = contact.slots.map(|slot| colliders.get(slot)) else { return None };
        let origin = shapes[1].center;
        let placements = shapes.map(|shape| Isometry {
            position: shape.placement.position - origin,
            orientation: shape.placement.orientation,
        });
        Some(Self {
            contact: number,
            part: contact.part,
            geometries: [a.geometry.clone(), b.geometry.clone()],
            placements,
            alone: !shapes[0].moves,
            apart: shapes[0].center - origin,
            margin: shapes[0].reach + shapes[1].reach,
        })
    }

    /// What has become of it, if its bodies have moved: a manifold about the second body's centre
    /// of mass as it is now.
    pub(crate) fn find(&self, [first, second]: [Displacement; 2]) -> Option<Manifold<Real>> {
        let slid = first.way - second.way;
        let still = STILL * self.margin;
        if !(first.has_turned || second.has_turned) && slid.dot(slid) < still * still {
            return None;
        }
        let [a, b] = &self.placements;
        let (p, q) = (first.turn, second.turn);
        let first_at = Isometry {
            position: self.apart + slid + p.rotate(a.position - self.apart),
            orientation: p * a.orientation,
        };
        let second_at = Isometry { position: q.rotate(b.position), orientation: q * b.orientation };
        let mut found = Manifold::none();
        let [one, other] = &self.geometries;
        contact_manifolds(one, &first_at, other, &second_at, self.margin, &mut |part, manifold| {
            if part == self.part {
                found = *manifold;
            }
        });
        Some(found)
    }
}
