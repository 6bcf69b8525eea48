//! The one place where numbers change their type: the engine's [`Real`], double precision for geometry, single precision for the graphics card.

use tumble::glam::{DQuat, DVec3};
use tumble::math::{Quat, Real, Vec3};

pub(crate) fn dvec3(vector: Vec3) -> DVec3 {
    DVec3::from_array(vector.to_array().map(f64::from))
}

pub(crate) fn dquat(quat: Quat) -> DQuat {
    DQuat::from_array(quat.to_array().map(f64::from))
}

pub(crate) fn real(value: f64) -> Real {
    value as Real
}

pub(crate) fn single3(vector: DVec3) -> [f32; 3] {
    vector.to_array().map(|part| part as f32)
}
