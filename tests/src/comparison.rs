//! How results in the precision of the build are compared with references in double precision.

use glam::{DMat3, DQuat, DVec3};
use hecs::{Entity, World};
pub use tumble::math::dvec3;
use tumble::math::{Quat, Real, Vec3};
use tumble::{Inertia, Momentum, Pose, PrincipalAxes};

/// The spacing of numbers at one in the precision of the build.
pub const EPSILON: f64 = Real::EPSILON as f64;

/// Whether the build simulates in double precision.
pub const DOUBLE: bool = size_of::<Real>() == size_of::<f64>();

/// One of two tolerances, by the precision of the build.
pub fn by_precision(single: f64, double: f64) -> f64 {
    if DOUBLE { double } else { single }
}

/// A number in the precision of the build.
pub fn real(number: f64) -> Real {
    number as Real
}

/// A vector in the precision of the build.
pub fn vec3(v: DVec3) -> Vec3 {
    Vec3::new(real(v.x), real(v.y), real(v.z))
}

/// A rotation in the precision of the build.
pub fn quat(q: DQuat) -> Quat {
    Quat::from_xyzw(real(q.x), real(q.y), real(q.z), real(q.w))
}

/// An orientation of the simulation in double precision, of unit length.
pub fn dquat(q: Quat) -> DQuat {
    tumble::math::dquat(q).normalize()
}

/// A step in double precision as the simulation takes it: rounded to the precision of the build.
pub fn seconds(dt: Real) -> f64 {
    dt.into()
}

/// The angle \[rad\] of the rotation from one orientation to the other, exact where it is tiny.
pub fn attitude_error(a: DQuat, b: DQuat) -> f64 {
    let between = a.conjugate() * b;
    2.0 * between.xyz().length().atan2(between.w.abs())
}

/// The largest absolute value of the elements; NaN if there is one.
pub fn largest(m: DMat3) -> f64 {
    if m.is_nan() { f64::NAN } else { m.to_cols_array().iter().fold(0.0, |largest: f64, x| largest.max(x.abs())) }
}

/// Rotational energy \[J\] of one body from its state, `L.w/2`, summed in double precision.
pub fn energy_of(world: &World, body: Entity) -> f64 {
    let mut query = world.query_one::<(&Pose, &Momentum, &Inertia, Option<&PrincipalAxes>)>(body);
    let (pose, momentum, inertia, axes) = query.get().expect("a moving body with inertia");
    let frame = dquat(pose.orientation) * axes.map_or(DQuat::IDENTITY, |axes| dquat(axes.0));
    let principal = frame.conjugate() * dvec3(momentum.angular);
    0.5 * (principal * principal / dvec3(inertia.moments())).element_sum()
}
