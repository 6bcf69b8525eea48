//! Random numbers, vectors and rotations for properties of inertia tensors and bodies.

use glam::{DQuat, DVec3};
use proptest::prelude::*;

pub(crate) const EPS: f64 = f64::EPSILON;

pub(crate) fn vector(range: f64) -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-range..range).prop_map(DVec3::from)
}

pub(crate) fn rotation() -> impl Strategy<Value = DQuat> {
    prop::array::uniform4(-1.0..1.0_f64)
        .prop_filter("a direction", |q| q.iter().map(|x| x * x).sum::<f64>() > 1e-3)
        .prop_map(|q| DQuat::from_array(q).normalize())
}

pub(crate) fn length() -> impl Strategy<Value = f64> {
    0.1..3.0_f64
}

/// Any f64 at all, with the troublesome ones often.
pub(crate) fn anything() -> impl Strategy<Value = f64> {
    let troublesome =
        [0.0, -0.0, 1.0, -1.0, f64::NAN, f64::INFINITY, 1e300, -1e300, 1e-300, 1e-45, f64::MIN_POSITIVE, 5e-324];
    prop_oneof![any::<f64>(), prop::sample::select(troublesome.to_vec()), 0.5..2.0_f64]
}
