//! Checks of values that only scene files have.

use glam::DVec3;
use tumble::math::{Real, Vec3};
use tumble_import::checked::{MAX_COMPONENT, finite, real};
use tumble_import::{FieldError, shortest};

use crate::values::tuple::Triple;

/// A number of the engine, to the bit.
#[allow(clippy::useless_conversion, reason = "Real is f64 already in one of the two builds")]
pub(crate) fn double(value: Real) -> f64 {
    value.into()
}

/// The components of an engine's vector, as they stand in files.
#[allow(clippy::useless_conversion, reason = "Real is f64 already in one of the two builds")]
pub(crate) fn double_vector(vector: Vec3) -> [f64; 3] {
    vector.to_array().map(f64::from)
}

pub(crate) fn finite_triple(field: &str, components: &Triple) -> Result<DVec3, FieldError> {
    for component in components.0 {
        finite(field, component)?;
    }
    Ok(DVec3::from_array(components.0))
}

/// A damping rate \[1/s\].
pub(crate) fn rate(field: &str, value: f64) -> Result<f64, FieldError> {
    if (0.0..=MAX_COMPONENT).contains(&value) {
        Ok(value)
    } else {
        Err(FieldError::new(field, format!("must be a rate from 0 to {MAX_COMPONENT:e}, not {}", shortest(value))))
    }
}

/// A number of any size that the engine's precision has, and not below zero.
pub(crate) fn not_negative(field: &str, value: f64) -> Result<f64, FieldError> {
    if value < 0.0 {
        return Err(FieldError::new(field, format!("must not be negative, as {} is", shortest(value))));
    }
    number(field, value)
}

/// A number of any size that the engine's precision has.
pub(crate) fn number(field: &str, value: f64) -> Result<f64, FieldError> {
    if real(value).is_finite() {
        Ok(value)
    } else {
        let precision = tumble::math::PRECISION;
        Err(FieldError::new(field, format!("{} is not a finite number of {precision}", shortest(value))))
    }
}
