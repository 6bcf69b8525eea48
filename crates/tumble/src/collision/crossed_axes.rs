//! Capsules that cross, and so touch in one point.

use tumble_collide::{ColliderShape, Isometry};
use tumble_math::lane::Vec3;

use crate::math::Real;

/// Axes that cross by an angle of a smaller sine, and twice what both bodies turn in the step, may
/// be parallel within it and touch in two points.
const CROSSING: Real = 0.1;

/// The axes of two capsules, or of one and a ball.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CrossedAxes {
    /// Their middles from the centres of mass of their bodies when the step began, and from there
    /// to their ends \[m\].
    pub(crate) middles: [Vec3<Real>; 2],
    pub(crate) halves: [Vec3<Real>; 2],
    pub(crate) radii: [Real; 2],
    /// Which share of the gap between the surfaces is before the point.
    pub(crate) share: Real,
}

impl CrossedAxes {
    /// Of shapes placed about their bodies' centres of mass, if they stay crossed while both turn
    /// by no more than these angles \[rad\]; `share` of the gap is before the point.
    pub(crate) fn of(
        shapes: [&ColliderShape<Real>; 2],
        placements: [Isometry<Real>; 2],
        turns: [Real; 2],
        share: Real,
    ) -> Option<Self> {
        let axis = |which: usize| match *shapes[which] {
            ColliderShape::Sphere { radius } => Some((Vec3::zero(), radius)),
            ColliderShape::Capsule { radius, half_height } => {
                let [_, along, _] = placements[which].orientation.axes();
                Some((along * half_height, radius))
            }
            _ => None,
        };
        let ((first, radius), (second, other)) = (axis(0)?, axis(1)?);
        let across = first.cross(second);
        let least = CROSSING + 2.0 * (turns[0] + turns[1]);
        let lengths = first.dot(first) * second.dot(second);
        let crosses = lengths == 0.0 || across.dot(across) > least * least * lengths;
        let middles = placements.map(|at| at.position);
        crosses.then_some(Self { middles, halves: [first, second], radii: [radius, other], share })
    }
}
