//! The mass component, positive and finite by construction.

use crate::components::property_error::PropertyError;
use crate::math::{Real, real};

/// Mass of a body \[kg\]: positive and finite, as is its inverse.
///
/// ```
/// # use tumble::Mass;
/// let mass = Mass::new(2.0)?;
/// assert_eq!(mass.kilograms(), 2.0);
/// assert!(Mass::new(0.0).is_err());
/// # Ok::<(), tumble::PropertyError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(transparent)]
pub struct Mass(Real);

impl Mass {
    /// A mass \[kg\].
    ///
    /// # Errors
    /// [`PropertyError`] where the mass is not positive and finite, or too large or small for the
    /// precision of the build.
    pub fn new(kilograms: impl Into<f64>) -> Result<Self, PropertyError> {
        PropertyError::check("mass", kilograms.into()).map(|mass| Self(real(mass)))
    }

    /// The mass \[kg\].
    #[inline]
    pub fn kilograms(self) -> Real {
        self.0
    }
}
