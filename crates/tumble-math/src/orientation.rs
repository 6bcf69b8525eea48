//! How an orientation changes under an angular velocity.
//!
//! With `q` the orientation (body to world) and `w` the angular velocity in the world frame
//! [rad/s],
//!
//! ```text
//! dq/dt = 1/2 [0, w] q
//! ```
//!
//! (D. Baraff, "Rigid body simulation", SIGGRAPH course notes 1997, part I, section 4).

use crate::lane::{Lane, Quat, Vec3};

/// Rate of change of an orientation, `1/2 [0, w] q`, with the angular velocity `w` in the world
/// frame [rad/s].
///
/// ```
/// use tumble_math::lane::{Quat, Vec3};
/// use tumble_math::orientation_rate;
/// let at_rest = Quat { x: 0.0, y: 0.0, z: 0.0, w: 1.0 };
/// let rate = orientation_rate(at_rest, Vec3::new(0.0, 0.0, 3.0));
/// assert_eq!(rate, Quat { x: 0.0, y: 0.0, z: 1.5, w: 0.0 });
/// ```
#[inline(always)]
pub fn orientation_rate<L: Lane>(orientation: Quat<L>, angular_velocity: Vec3<L>) -> Quat<L> {
    Quat::from_parts(L::splat(0.0), angular_velocity) * orientation * L::splat(0.5)
}

/// The orientation after `dt` to first order, `normalise(q + dt/2 [0, w] q)`.
///
/// The turn comes out as `2 atan(|w| dt/2)` about the right axis, short by `(|w| dt)^3/12`;
/// [`rotate_exactly`] has no such error. A rate too large to compute with leaves the orientation as
/// it was.
///
/// ```
/// use glam::{DQuat, DVec3};
/// use tumble_math::rotate_to_first_order;
/// let turned: DQuat =
///     rotate_to_first_order(DQuat::IDENTITY.into(), (DVec3::Z * 2.0).into(), 0.5).into();
/// // One radian, less an error of about 1/12.
/// assert!((turned.angle_between(DQuat::IDENTITY) - 2.0 * 0.5_f64.atan()).abs() < 1e-12);
/// ```
#[inline(always)]
pub fn rotate_to_first_order<L: Lane>(orientation: Quat<L>, angular_velocity: Vec3<L>, dt: L) -> Quat<L> {
    (orientation + orientation_rate(orientation, angular_velocity) * dt).normalize_or(orientation)
}

/// The orientation after turning with a constant world-frame angular velocity [rad/s] for `dt`,
/// exactly: `[cos(|w| dt/2), sin(|w| dt/2) w/|w|] q`.
///
/// ```
/// use glam::{DQuat, DVec3};
/// use tumble_math::rotate_exactly;
/// let turned: DQuat =
///     rotate_exactly(DQuat::IDENTITY.into(), DVec3::new(0.0, 2.0, 0.0).into(), 0.5).into();
/// assert!(turned.angle_between(DQuat::from_rotation_y(1.0)) < 1e-15);
/// ```
#[inline(always)]
pub fn rotate_exactly<L: Lane>(orientation: Quat<L>, angular_velocity: Vec3<L>, dt: L) -> Quat<L> {
    let half = angular_velocity * (L::splat(0.5) * dt);
    let half_angle = half.dot(half).sqrt();
    let (sine, cosine) = half_angle.sin_cos();
    // sin(a)/a, whose limit at rest is 1. A half angle whose square underflows turns nothing that
    // the lane can hold.
    let still = half_angle.lt(L::splat(f64::from(f32::MIN_POSITIVE)));
    let ratio = L::select(still, L::splat(1.0), sine / L::select(still, L::splat(1.0), half_angle));
    let turn = Quat::from_parts(L::select(still, L::splat(1.0), cosine), half * ratio);
    let turned = (turn * orientation).normalize_or(orientation);
    // A non-finite rate leaves the orientation as it was: a direction cannot be infinite.
    let finite = half_angle.lt(L::splat(f64::INFINITY));
    Quat::select(finite, turned, orientation)
}
