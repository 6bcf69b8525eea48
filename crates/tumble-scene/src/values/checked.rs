//! Checks of single values, and their conversion to the precision of the engine.

use glam::{DQuat, DVec3};
use tumble::math::{Quat, Real, Vec3};

use crate::error::{FieldError, shortest};
use crate::values::tuple::{Quadruple, Triple};

/// Larger components of positions, velocities and gravity are refused as absurd: the square of
/// 1e18 still has room in f32.
pub(crate) const LARGEST: f64 = 1e18;

/// A quaternion further than this from unit length is a mistake, not rounding.
const UNIT_TOLERANCE: f64 = 1e-3;

/// Longest name of a body \[bytes\].
pub(crate) const LONGEST_NAME: usize = 256;

pub(crate) fn check_name(name: &str) -> Result<(), FieldError> {
    let problem = if name.is_empty() {
        "is empty".to_owned()
    } else if name.len() > LONGEST_NAME {
        format!("is {} bytes long, more than {LONGEST_NAME}", name.len())
    } else if name.chars().any(char::is_control) {
        format!("{name:?} has a control character")
    } else {
        return Ok(());
    };
    Err(FieldError::new("name", problem))
}

/// Unit length within [`UNIT_TOLERANCE`] is taken as rounding and normalised.
pub(crate) fn unit_quaternion(field: &str, components: &Quadruple) -> Result<DQuat, FieldError> {
    let [x, y, z, w] = components.0;
    let quaternion = DQuat::from_xyzw(x, y, z, w);
    let length = quaternion.length();
    if (length - 1.0).abs() <= UNIT_TOLERANCE {
        Ok(quaternion.normalize())
    } else {
        let problem = format!("[{x}, {y}, {z}, {w}] is not a unit quaternion, its length is {length}");
        Err(FieldError::new(field, problem))
    }
}

/// In the engine's precision.
#[allow(clippy::unnecessary_cast, reason = "Real is f64 in one of the two builds")]
pub(crate) fn real(value: f64) -> Real {
    value as Real
}

/// A vector in the engine's precision.
pub(crate) fn real_vector(vector: DVec3) -> Vec3 {
    Vec3::from_array(vector.to_array().map(real))
}

/// The components of an engine's vector, as they stand in files.
#[allow(clippy::useless_conversion, reason = "Real is f64 already in one of the two builds")]
pub(crate) fn double_vector(vector: Vec3) -> [f64; 3] {
    vector.to_array().map(f64::from)
}

/// A quaternion in the engine's precision.
pub(crate) fn real_quaternion(quaternion: DQuat) -> Quat {
    Quat::from_array(quaternion.to_array().map(real))
}

pub(crate) fn finite_triple(field: &str, components: &Triple) -> Result<DVec3, FieldError> {
    for component in components.0 {
        finite(field, component)?;
    }
    Ok(DVec3::from_array(components.0))
}

pub(crate) fn finite(field: &str, value: f64) -> Result<f64, FieldError> {
    if !value.is_finite() {
        Err(FieldError::new(field, format!("{value} is not a finite number")))
    } else if value.abs() > LARGEST {
        Err(FieldError::new(field, format!("{} is absurd: more than {LARGEST:e}", shortest(value))))
    } else {
        Ok(value)
    }
}

/// Upper bounds of masses are the engine's affair: they depend on its precision.
pub(crate) fn positive(field: &str, value: f64) -> Result<f64, FieldError> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(FieldError::new(field, format!("must be positive and finite, not {}", shortest(value))))
    }
}

/// A damping rate \[1/s\].
pub(crate) fn rate(field: &str, value: f64) -> Result<f64, FieldError> {
    if (0.0..=LARGEST).contains(&value) {
        Ok(value)
    } else {
        Err(FieldError::new(field, format!("must be a rate from 0 to {LARGEST:e}, not {}", shortest(value))))
    }
}

/// The value, or a note of what is wrong with it.
pub(crate) fn note<T>(problems: &mut Vec<FieldError>, result: Result<T, FieldError>) -> Option<T> {
    result.map_err(|problem| problems.push(problem)).ok()
}
