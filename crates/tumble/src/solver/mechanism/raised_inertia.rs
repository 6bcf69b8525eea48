//! How much inertia the loads of joints ask of a light body.

use tumble_math::lane::{Lane, Quat, Vec3};

/// A body turns under its load by at most the square root of this [rad] a substep: what is
/// lighter is given that much inertia.
const MAX_SQUARED_ANGLE: f64 = 0.5;
/// What is this many times the inertia is a sudden load.
pub(super) const SUDDEN: f64 = 2.0;
/// What is left of the raised inertia in the next substep, where the load is gone.
pub(crate) const KEPT_LOAD: f64 = 0.9;

/// The angular momentum with other moments at the angular velocity that it is with those before.
#[inline(always)]
pub(crate) fn momentum_with<L: Lane>(
    moments: Vec3<L>,
    before: Vec3<L>,
    orientation: Quat<L>,
    momentum: Vec3<L>,
) -> Vec3<L> {
    let ratio = Vec3::new(moments.x / before.x, moments.y / before.y, moments.z / before.z);
    orientation.rotate(orientation.rotate_back(momentum).scale(ratio))
}

/// What moments are raised to by impulses times arms [kg m^2/s] in a substep of `h` \[s\].
#[inline(always)]
pub(crate) fn load_of<L: Lane>(impulse_times_arm: L, h: f64) -> L {
    L::splat(h) * impulse_times_arm / L::splat(MAX_SQUARED_ANGLE)
}
