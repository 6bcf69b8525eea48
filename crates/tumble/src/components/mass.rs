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
///
/// The state of a body is its momentum, so one that is given another mass goes at another velocity:
///
/// ```
/// # use tumble::prelude::*;
/// let mut world = hecs::World::new();
/// let ball = RigidBody::new(Shape::sphere(0.5)).mass(1.0).linear_velocity(Vec3::X * 6.0);
/// let ball = ball.build()?.spawn(&mut world);
/// *world.get::<&mut Mass>(ball)? = Mass::new(2.0)?;
///
/// let mut simulation = Simulation::new(Settings::default().with_gravity(Vec3::ZERO))?;
/// simulation.step(&mut world);
/// assert_eq!(world.get::<&Velocity>(ball)?.linear, Vec3::X * 3.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
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
