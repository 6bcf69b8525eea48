//! From double precision, in which forces are computed, to that of the build.

use tumble::glam::{DQuat, DVec3};
use tumble::math::{Quat, Real, Vec3};

pub(crate) fn real(value: f64) -> Real {
    value as Real
}

pub(crate) fn vec3(value: DVec3) -> Vec3 {
    Vec3::new(real(value.x), real(value.y), real(value.z))
}

pub(crate) fn quat(value: DQuat) -> Quat {
    Quat::from_xyzw(real(value.x), real(value.y), real(value.z), real(value.w))
}
