//! Limits of numbers within which no interaction of bodies overflows, in either precision.
//!
//! Squares of these fit single precision with room for what they are multiplied by. A body with
//! other numbers does what it does by itself, and touches and pulls nothing.

use std::ops::RangeInclusive;

use tumble_math::lane::{Quat, Vec3};

use crate::math::Real;

/// Steps and their parts \[s\].
pub(crate) const SECONDS: RangeInclusive<Real> = 1e-9..=1e9;
/// Sizes of colliders \[m\], and how far one may be from its body.
pub(crate) const LENGTHS: RangeInclusive<Real> = 1e-9..=1e9;
/// Acceleration of gravity [m/s^2].
pub(crate) const MAX_GRAVITY: Real = 1e9;
/// How far from the origin a body may be made \[m\].
pub(crate) const MAX_DISTANCE: Real = 1e15;
/// Speeds [m/s] and [rad/s].
pub(crate) const MAX_SPEED: Real = 1e9;
/// How far from the origin \[m\] bodies touch.
pub(crate) const MAX_DISTANCE_OF_CONTACTS: Real = 1e9;
/// Pull of a mass [m^3/s^2]; that of a galaxy is 1e32.
pub(crate) const MAX_MU: Real = 1e33;
/// Force times a step and pull of a spring times a kick [N s].
pub(crate) const MAX_IMPULSE: Real = 1e30;

/// Whether no coordinate is further from zero; what is not a number is not.
pub(crate) fn within(v: Vec3<Real>, most: Real) -> bool {
    v.x.abs() <= most && v.y.abs() <= most && v.z.abs() <= most
}

/// Whether it turns: its length is one, or so near that nothing suffers when it is taken for it.
pub(crate) fn is_rotation(q: Quat<Real>) -> bool {
    (0.25..=4.0).contains(&q.length_squared())
}
