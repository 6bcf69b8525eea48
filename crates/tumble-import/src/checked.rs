//! Checks of single values, and their conversion to the precision of the engine.

use glam::{DQuat, DVec3};
use tumble::math::{Quat, Real, Vec3};

use crate::error::FieldError;
use crate::terminal::shortest;

/// Larger components of positions, velocities and gravity are refused as absurd: the square of
/// 1e18 still has room in f32.
pub const MAX_COMPONENT: f64 = 1e18;

/// A quaternion further than this from unit length is a mistake, not rounding.
const UNIT_TOLERANCE: f64 = 1e-3;

/// Longest name of a body \[bytes\].
pub const MAX_NAME_BYTES: usize = 256;

/// A name of a body: not empty, not too long, without control characters.
///
/// # Errors
/// [`FieldError`] of the field `name`.
///
/// ```
/// assert!(tumble_import::checked::check_name("brick").is_ok());
/// assert!(tumble_import::checked::check_name("").is_err());
/// ```
pub fn check_name(name: &str) -> Result<(), FieldError> {
    let problem = if name.is_empty() {
        "is empty".to_owned()
    } else if name.len() > MAX_NAME_BYTES {
        format!("is {} bytes long, more than {MAX_NAME_BYTES}", name.len())
    } else if name.chars().any(char::is_control) {
        format!("{name:?} has a control character")
    } else {
        return Ok(());
    };
    Err(FieldError::new("name", problem))
}

/// A quaternion `x, y, z, w` of unit length; a thousandth off is taken as rounding and normalised.
///
/// # Errors
/// [`FieldError`] with the length that it has.
///
/// ```
/// use tumble_import::checked::unit_quaternion;
///
/// assert_eq!(unit_quaternion("orientation", [0.0, 0.0, 0.0, 1.0])?.w, 1.0);
/// assert!(unit_quaternion("orientation", [0.0, 0.0, 0.0, 2.0]).is_err());
/// # Ok::<(), tumble_import::FieldError>(())
/// ```
pub fn unit_quaternion(field: &str, [x, y, z, w]: [f64; 4]) -> Result<DQuat, FieldError> {
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
///
/// ```
/// assert_eq!(tumble_import::checked::real(0.5), 0.5);
/// ```
#[must_use]
#[allow(clippy::unnecessary_cast, reason = "Real is f64 in one of the two builds")]
pub fn real(value: f64) -> Real {
    value as Real
}

/// A vector in the engine's precision.
///
/// ```
/// use tumble::{glam::DVec3, math::Vec3};
///
/// assert_eq!(tumble_import::checked::real_vector(DVec3::X), Vec3::X);
/// ```
#[must_use]
pub fn real_vector(vector: DVec3) -> Vec3 {
    Vec3::from_array(vector.to_array().map(real))
}

/// A quaternion in the engine's precision.
///
/// ```
/// use tumble::{glam::DQuat, math::Quat};
///
/// assert_eq!(tumble_import::checked::real_quaternion(DQuat::IDENTITY), Quat::IDENTITY);
/// ```
#[must_use]
pub fn real_quaternion(quaternion: DQuat) -> Quat {
    Quat::from_array(quaternion.to_array().map(real))
}

/// A number that is finite, and not absurd: of at most [`MAX_COMPONENT`].
///
/// # Errors
/// [`FieldError`] with the value.
///
/// ```
/// assert!(tumble_import::checked::finite("position", 1e9).is_ok());
/// assert!(tumble_import::checked::finite("position", 1e300).is_err());
/// ```
pub fn finite(field: &str, value: f64) -> Result<f64, FieldError> {
    if !value.is_finite() {
        Err(FieldError::new(field, format!("{value} is not a finite number")))
    } else if value.abs() > MAX_COMPONENT {
        Err(FieldError::new(field, format!("{} is absurd: more than {MAX_COMPONENT:e}", shortest(value))))
    } else {
        Ok(value)
    }
}

/// A number that is positive and finite. Upper bounds of masses are the engine's affair: they
/// depend on its precision.
///
/// # Errors
/// [`FieldError`] with the value.
///
/// ```
/// assert!(tumble_import::checked::positive("mass", 1e-9).is_ok());
/// assert!(tumble_import::checked::positive("mass", 0.0).is_err());
/// ```
pub fn positive(field: &str, value: f64) -> Result<f64, FieldError> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(FieldError::new(field, format!("must be positive and finite, not {}", shortest(value))))
    }
}

/// The value, or a note of what is wrong with it.
///
/// ```
/// use tumble_import::checked::{note, positive};
///
/// let mut problems = Vec::new();
/// assert_eq!(note(&mut problems, positive("mass", -1.0)), None);
/// assert_eq!(problems.len(), 1);
/// ```
pub fn note<T>(problems: &mut Vec<FieldError>, result: Result<T, FieldError>) -> Option<T> {
    result.map_err(|problem| problems.push(problem)).ok()
}
