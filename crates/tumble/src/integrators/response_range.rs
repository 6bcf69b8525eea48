//! Range check for masses, momenta and impulse responses of interacting bodies.

use std::ops::RangeInclusive;

use tumble_math::lane::Vec3;

use crate::integrators::state::{Constants, Moments};
use crate::math::Real;
use crate::range::{MAX_IMPULSE, MAX_SPEED, is_rotation, within};

/// Masses \[kg\] of bodies that touch or that springs hold.
pub(crate) const MASSES: RangeInclusive<Real> = 1e-16..=1e24;
/// What an impulse of 1 N s at the furthest point of a body may change its velocity there by
/// turning it [1/kg], and one of 1 N m s its angular velocity [1/(kg m^2)].
pub(crate) const MAX_RESPONSES: [Real; 2] = [1e17, 1e32];

/// Whether a body with these momenta, and points at most so far from its centre \[m\], answers to
/// impulses by numbers that are in range.
pub(crate) fn responds_in_range(constants: &Constants<Real>, [linear, angular]: [Vec3<Real>; 2], radius: Real) -> bool {
    let Constants { mass, inertia, .. } = constants;
    let turns = |Moments { inverse_moments, axes, .. }: &Moments<Real>| {
        let most = inverse_moments.x.max(inverse_moments.y).max(inverse_moments.z);
        let least = inverse_moments.x.min(inverse_moments.y).min(inverse_moments.z);
        let responses = least > 0.0 && most <= MAX_RESPONSES[1] && radius * most * radius <= MAX_RESPONSES[0];
        responses && within(angular * most, MAX_SPEED) && axes.is_none_or(is_rotation)
    };
    MASSES.contains(mass)
        && within(linear * (1.0 / *mass), MAX_SPEED)
        && within(angular, MAX_IMPULSE)
        && inertia.as_ref().is_none_or(turns)
}
