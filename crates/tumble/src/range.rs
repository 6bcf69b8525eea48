//! What is in range: numbers with which nothing that bodies do to each other overflows, in either precision.
//!
//! Squares of these fit single precision with room for what they are multiplied by. A body with other numbers does what it does by itself, and touches and pulls nothing.

use std::ops::RangeInclusive;

use tumble_math::lane::{Quat, Vec3};

use crate::math::Real;
use crate::state::{Constants, Moments};

/// Steps and their parts \[s\].
pub(crate) const SECONDS: RangeInclusive<Real> = 1e-9..=1e9;
/// Sizes of colliders \[m\], and how far one may be from its body.
pub(crate) const LENGTHS: RangeInclusive<Real> = 1e-9..=1e9;
/// Acceleration of gravity [m/s^2].
pub(crate) const MOST_GRAVITY: Real = 1e9;
/// How far from the origin a body may be made \[m\].
pub(crate) const MOST_DISTANCE: Real = 1e15;
/// Speeds [m/s] and [rad/s].
pub(crate) const MOST_SPEED: Real = 1e9;
/// How far from the origin \[m\] bodies touch.
pub(crate) const MOST_DISTANCE_OF_CONTACTS: Real = 1e9;
/// Masses \[kg\] of bodies that touch or that springs hold.
const MASSES: RangeInclusive<Real> = 1e-16..=1e24;
/// What an impulse of 1 N s at the furthest point of a body may change its velocity there by turning it [1/kg], and one of 1 N m s its angular velocity [1/(kg m^2)].
const MOST_RESPONSES: [Real; 2] = [1e17, 1e32];
/// Pull of a mass [m^3/s^2]; that of a galaxy is 1e32.
pub(crate) const MOST_MU: Real = 1e33;
/// Force times a step and pull of a spring times a kick [N s].
pub(crate) const MOST_IMPULSE: Real = 1e30;

/// Whether no coordinate is further from zero; what is not a number is not.
pub(crate) fn within(v: Vec3<Real>, most: Real) -> bool {
    v.x.abs() <= most && v.y.abs() <= most && v.z.abs() <= most
}

/// Whether it turns: its length is one, or so near that nothing suffers when it is taken for it.
pub(crate) fn is_rotation(q: Quat<Real>) -> bool {
    (0.25..=4.0).contains(&q.length_squared())
}

/// Whether a body with these momenta, and points at most so far from its centre \[m\], answers to impulses by numbers that are in range.
pub(crate) fn answers(constants: &Constants<Real>, [linear, angular]: [Vec3<Real>; 2], radius: Real) -> bool {
    let Constants { mass, inertia, .. } = constants;
    let turns = |Moments { inverse_moments, axes, .. }: &Moments<Real>| {
        let most = inverse_moments.x.max(inverse_moments.y).max(inverse_moments.z);
        let least = inverse_moments.x.min(inverse_moments.y).min(inverse_moments.z);
        let responses = least > 0.0 && most <= MOST_RESPONSES[1] && radius * most * radius <= MOST_RESPONSES[0];
        responses && within(angular * most, MOST_SPEED) && axes.is_none_or(is_rotation)
    };
    MASSES.contains(mass)
        && within(linear * (1.0 / *mass), MOST_SPEED)
        && within(angular, MOST_IMPULSE)
        && inertia.as_ref().is_none_or(turns)
}
