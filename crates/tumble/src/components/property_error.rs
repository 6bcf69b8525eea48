//! Range checks and errors of masses and moments of inertia.

use crate::math::{PRECISION, Real, real};

/// Why a mass or a moment of inertia cannot be one.
///
/// ```
/// # use tumble::{Mass, PropertyError};
/// assert_eq!(Mass::new(-1.0), Err(PropertyError::NotPositive { quantity: "mass", value: -1.0 }));
/// ```
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PropertyError {
    /// Zero, negative, NaN or infinite.
    #[error("{quantity} must be positive and finite, got {value}")]
    NotPositive {
        /// What it was to be.
        quantity: &'static str,
        /// What was given.
        value: f64,
    },
    /// The moments of a body are too unequal: the angular momentum cannot hold the spin about the
    /// axis of the smallest.
    #[error("the principal moments {smallest:e} and {largest:e} are too unequal for {PRECISION}, which resolves one part in {:.0e}", 1.0 / f64::from(Real::EPSILON))]
    TooUnequal {
        /// The smallest principal moment [kg m^2].
        smallest: f64,
        /// The largest principal moment [kg m^2].
        largest: f64,
    },
    /// The number or its inverse does not fit the precision that the engine simulates in.
    #[error("{quantity} {value:e} or its inverse is out of the range of {PRECISION}")]
    OutOfRange {
        /// What it was to be.
        quantity: &'static str,
        /// What was given.
        value: f64,
    },
}

tumble_math::debug_as_display!(PropertyError);

impl PropertyError {
    /// Passes on a value that is positive and, like its inverse, a normal number in the build's
    /// precision.
    pub(crate) fn check(quantity: &'static str, value: f64) -> Result<f64, Self> {
        if !(value > 0.0 && value.is_finite()) {
            return Err(Self::NotPositive { quantity, value });
        }
        let rounded = real(value);
        let in_range = |r: Real| r.is_normal();
        if !(in_range(rounded) && in_range(1.0 / rounded)) {
            return Err(Self::OutOfRange { quantity, value });
        }
        Ok(value)
    }
}
