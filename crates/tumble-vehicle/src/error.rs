//! What can be wrong with the settings of a vehicle.

use std::fmt;

use tumble::math::Real;
use tumble::{BodyError, JointError};

/// The most wheels that a vehicle has.
pub const MAX_WHEELS: usize = 12;

/// Why a vehicle cannot be made.
///
/// ```
/// use tumble_vehicle::{Vehicle, VehicleError, VehiclePlan};
///
/// let mut settings = VehiclePlan::car(4.5, 1500.0).settings()?;
/// settings.wheels[2].radius = -0.3;
/// let error = Vehicle::new(settings).unwrap_err();
/// assert_eq!(error.field(), Some("wheels[2].radius"));
/// # Ok::<(), VehicleError>(())
/// ```
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum VehicleError {
    /// A number is out of its range, or not a number.
    #[error("{field} must be from {low:e} to {high:e}, it is {value:e}")]
    Number {
        /// The setting, with the wheel or bar that it is of.
        field: String,
        /// What was given.
        value: f64,
        /// The least it may be.
        low: f64,
        /// The greatest it may be.
        high: f64,
    },
    /// No wheels, or more than [`MAX_WHEELS`](crate::MAX_WHEELS).
    #[error("wheels must be from 1 to {most}, there are {0}", most = MAX_WHEELS)]
    Wheels(usize),
    /// An anti-roll bar does not join two wheels.
    #[error("{field} must join two wheels of {wheels}, it joins {joined:?}")]
    Bar {
        /// Which bar.
        field: String,
        /// The wheels that it is to join.
        joined: [usize; 2],
        /// How many wheels there are.
        wheels: usize,
    },
    /// The body of the chassis, or of a wheel, cannot be made.
    #[error(transparent)]
    Body(#[from] BodyError),
    /// A joint cannot be made.
    #[error(transparent)]
    Joint(#[from] JointError),
}

impl fmt::Debug for VehicleError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self}")
    }
}

impl VehicleError {
    /// The setting that is at fault.
    #[must_use]
    pub fn field(&self) -> Option<&str> {
        match self {
            Self::Number { field, .. } | Self::Bar { field, .. } => Some(field),
            Self::Wheels(_) => Some("wheels"),
            Self::Body(_) | Self::Joint(_) => None,
        }
    }
}

/// Beyond this no length, mass, stiffness or torque makes sense; single precision holds its square.
pub(crate) const MAX: f64 = 1e12;
/// Below this what must be positive is none.
pub(crate) const MIN: f64 = 1e-12;

/// Checks the numbers of one part of the settings.
pub(crate) struct Check<'a>(pub(crate) &'a str);

impl Check<'_> {
    /// From `low` to `high`, both included.
    pub(crate) fn within(&self, field: &str, value: Real, low: f64, high: f64) -> Result<(), VehicleError> {
        let value = f64::from(value);
        if (low..=high).contains(&value) {
            return Ok(());
        }
        Err(VehicleError::Number { field: format!("{}{field}", self.0), value, low, high })
    }

    pub(crate) fn positive(&self, field: &str, value: Real) -> Result<(), VehicleError> {
        self.within(field, value, MIN, MAX)
    }

    pub(crate) fn not_negative(&self, field: &str, value: Real) -> Result<(), VehicleError> {
        self.within(field, value, 0.0, MAX)
    }
}
