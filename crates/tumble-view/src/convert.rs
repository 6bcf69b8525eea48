//! The one place where numbers change their type: the engine's [`Real`], double precision for
//! geometry, single precision for the graphics card.

use tumble::glam::DVec3;
use tumble::math::Real;
pub(crate) use tumble::math::{dquat, dvec3};

pub(crate) fn real(value: f64) -> Real {
    value as Real
}

pub(crate) fn single3(vector: DVec3) -> [f32; 3] {
    vector.to_array().map(|part| part as f32)
}
