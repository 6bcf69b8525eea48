//! Simulation settings and their validation.

use crate::integrator::Integrator;
use crate::math::{Real, Vec3};
use crate::range::{MAX_GRAVITY, MAX_SPEED, SECONDS, within};

/// The settings of a simulation.
///
/// ```
/// # use tumble::{Integrator, Settings, math::Vec3};
/// let settings = Settings::default().with_gravity(Vec3::ZERO).with_dt(1.0 / 240.0);
/// assert_eq!(settings.integrator, Integrator::MoserVeselov);
/// ```
#[doc(alias("gravity", "timestep", "IntegrationParameters"))]
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Settings {
    /// Acceleration of gravity in the world frame [m/s^2]. (0, -9.81, 0) unless set.
    pub gravity: Vec3,
    /// Length of a step \[s\]. 1/60 unless set.
    pub dt: Real,
    /// How many equal parts the integration of a step is divided into. Gravity and wrenches are
    /// constant over them, force laws are evaluated in each. 1 unless set.
    pub substeps: u32,
    /// How the state is advanced.
    pub integrator: Integrator,
    /// Into how many parts a step is divided where bodies touch; never fewer than `substeps`.
    /// Contacts are stiffer the more there are. Islands whose stacks would buckle, or be pressed in
    /// too deep, have up to 64 times as many. 4 unless set.
    pub contact_substeps: u32,
    /// Bodies that come together slower than this \[m/s\] do not bounce, whatever their
    /// restitution: they would never come to rest. 1 unless set.
    pub restitution_threshold: Real,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            gravity: Vec3::new(0.0, -9.81, 0.0),
            dt: 1.0 / 60.0,
            substeps: 1,
            integrator: Integrator::default(),
            contact_substeps: 4,
            restitution_threshold: 1.0,
        }
    }
}

impl Settings {
    /// The most substeps a step can have.
    pub const MAX_SUBSTEPS: u32 = 1_000_000;

    /// The most parts a step can have where bodies touch.
    pub const MAX_CONTACT_SUBSTEPS: u32 = 1_000;

    /// The same with another gravity [m/s^2].
    #[must_use]
    pub fn with_gravity(self, gravity: Vec3) -> Self {
        Self { gravity, ..self }
    }

    /// The same with another step \[s\].
    #[doc(alias = "timestep")]
    #[must_use]
    pub fn with_dt(self, dt: Real) -> Self {
        Self { dt, ..self }
    }

    /// The same with another number of substeps.
    #[must_use]
    pub fn with_substeps(self, substeps: u32) -> Self {
        Self { substeps, ..self }
    }

    /// The same with another integrator.
    #[must_use]
    pub fn with_integrator(self, integrator: Integrator) -> Self {
        Self { integrator, ..self }
    }

    /// The same with another number of substeps where bodies touch.
    #[doc(alias("solver iterations", "SubstepCount"))]
    #[must_use]
    pub fn with_contact_substeps(self, contact_substeps: u32) -> Self {
        Self { contact_substeps, ..self }
    }

    /// The same with another speed \[m/s\] below which nothing bounces.
    #[must_use]
    pub fn with_restitution_threshold(self, restitution_threshold: Real) -> Self {
        Self { restitution_threshold, ..self }
    }

    /// Whether a simulation can run with these.
    ///
    /// # Errors
    /// [`SettingsError`] names the first setting that cannot be.
    pub fn validate(&self) -> Result<(), SettingsError> {
        if !SECONDS.contains(&self.dt) {
            return Err(SettingsError::Step(self.dt));
        }
        if !within(self.gravity.into(), MAX_GRAVITY) {
            return Err(SettingsError::Gravity(self.gravity));
        }
        if self.substeps == 0 || self.substeps > Self::MAX_SUBSTEPS {
            return Err(SettingsError::Substeps(self.substeps));
        }
        if !SECONDS.contains(&self.substep()) {
            return Err(SettingsError::Step(self.substep()));
        }
        if self.contact_substeps == 0 || self.contact_substeps > Self::MAX_CONTACT_SUBSTEPS {
            return Err(SettingsError::ContactSubsteps(self.contact_substeps));
        }
        if !SECONDS.contains(&self.contact_substep()) {
            return Err(SettingsError::Step(self.contact_substep()));
        }
        if !(0.0..=MAX_SPEED).contains(&self.restitution_threshold) {
            return Err(SettingsError::RestitutionThreshold(self.restitution_threshold));
        }
        Ok(())
    }

    /// Length of a substep of bodies that touch \[s\]: what impulses of a
    /// [`Contact`](crate::Contact) are divided by to be forces.
    ///
    /// ```
    /// # use tumble::Settings;
    /// let settings = Settings::default().with_dt(0.125).with_contact_substeps(4);
    /// assert_eq!(settings.contact_substep(), 0.03125);
    /// ```
    pub fn contact_substep(&self) -> Real {
        self.substep() / self.contact_substeps_each() as Real
    }

    /// How many substeps of bodies that touch each substep has.
    pub(crate) fn contact_substeps_each(&self) -> u32 {
        self.contact_substeps.div_ceil(self.substeps.max(1)).max(1)
    }

    /// Length of a substep \[s\].
    pub(crate) fn substep(&self) -> Real {
        self.dt / self.substeps as Real
    }
}

/// A setting that no simulation can run with.
///
/// ```
/// # use tumble::{Settings, SettingsError, Simulation};
/// let error = Simulation::new(Settings::default().with_dt(0.0)).unwrap_err();
/// assert_eq!(error, SettingsError::Step(0.0));
/// ```
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SettingsError {
    /// The step, or one of the equal parts that it is divided into, is not from 1e-9 to 1e9
    /// seconds.
    #[error("dt, divided by the substeps, must be from 1e-9 to 1e9 seconds, got {0:e}")]
    Step(Real),
    /// A component of gravity is beyond 1e9 m/s^2, or not a number.
    #[error("gravity must be within 1e9 m/s^2 along each axis, got {0}")]
    Gravity(Vec3),
    /// No substeps, or more than [`Settings::MAX_SUBSTEPS`].
    #[error("substeps must be from 1 to {most}, got {0}", most = Settings::MAX_SUBSTEPS)]
    Substeps(u32),
    /// No substeps where bodies touch, or more than [`Settings::MAX_CONTACT_SUBSTEPS`].
    #[error("contact substeps must be from 1 to {most}, got {0}", most = Settings::MAX_CONTACT_SUBSTEPS)]
    ContactSubsteps(u32),
    /// The speed below which nothing bounces is not from 0 to 1e9 m/s.
    #[error("the restitution threshold must be from 0 to 1e9 m/s, got {0}")]
    RestitutionThreshold(Real),
}

tumble_math::debug_as_display!(SettingsError);

impl SettingsError {
    /// The field of [`Settings`] that is at fault; of a step that is divided into parts too short,
    /// `dt`.
    ///
    /// ```
    /// # use tumble::{Settings, math::Vec3};
    /// let error = Settings::default().with_gravity(Vec3::splat(1e10)).validate().unwrap_err();
    /// assert_eq!(error.field(), "gravity");
    /// ```
    #[must_use]
    pub fn field(&self) -> &'static str {
        match self {
            Self::Step(_) => "dt",
            Self::Gravity(_) => "gravity",
            Self::Substeps(_) => "substeps",
            Self::ContactSubsteps(_) => "contact_substeps",
            Self::RestitutionThreshold(_) => "restitution_threshold",
        }
    }
}
