//! Simulation settings and their validation.

use crate::integrator::Integrator;
use crate::joint_solver::JointSolver;
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
    /// When bodies at rest are left out of the steps. `None` unless set: none is.
    pub sleep: Option<Sleep>,
    /// How joints are solved. [`JointSolver::Auto`] unless set.
    pub joint_solver: JointSolver,
}

/// When bodies at rest fall asleep: they are left out of the steps until something disturbs them.
///
/// Bodies that hang together by contacts or joints fall asleep at once, when all of them have been
/// still for `time`. A body is still while none of its points is faster than `speed`, nor than a
/// fifth of its radius a second, and nothing that moves by itself touches it. Bodies under force
/// laws, springs or mutual gravity do not sleep, nor those that nothing holds and that move or
/// would fall.
///
/// ```
/// use tumble::{Sleep, prelude::*};
///
/// let mut world = hecs::World::new();
/// spawn_ground(&mut world);
/// let block = RigidBody::new(Shape::cuboid([0.5, 0.5, 0.5])).mass(2.0).position(Vec3::Y * 0.5);
/// let block = block.build()?.spawn(&mut world);
/// let mut simulation = Simulation::new(Settings::default().with_sleep(Sleep::default()))?;
/// simulation.step_many(&mut world, 60);
/// assert!(simulation.is_asleep(block));
/// world.get::<&mut Momentum>(block)?.apply_impulse(Vec3::X * 4.0);
/// simulation.step(&mut world);
/// assert!(!simulation.is_asleep(block));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias("can_sleep", "deactivation", "IslandManager"))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sleep {
    /// The fastest point of a body that is still \[m/s\]. 0.05 unless set.
    pub speed: Real,
    /// How long bodies are still before they fall asleep \[s\], two steps at least. 0.5 unless set.
    pub time: Real,
}

impl Default for Sleep {
    fn default() -> Self {
        Self { speed: 0.05, time: 0.5 }
    }
}

impl Sleep {
    /// The most of its radius that a point of a still body goes in a second.
    const RADII: Real = 0.2;

    /// How fast the points of a still body of a radius \[m\] may be \[m/s\].
    pub(crate) fn speed_of(&self, radius: Real) -> Real {
        self.speed.min(Self::RADII * radius)
    }
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
            sleep: None,
            joint_solver: JointSolver::Auto,
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

    /// The same with bodies at rest left out of the steps, or with `None` without.
    #[doc(alias = "can_sleep")]
    #[must_use]
    pub fn with_sleep(self, sleep: impl Into<Option<Sleep>>) -> Self {
        Self { sleep: sleep.into(), ..self }
    }

    /// The same with joints solved in another way.
    #[must_use]
    pub fn with_joint_solver(self, joint_solver: JointSolver) -> Self {
        Self { joint_solver, ..self }
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
        if let Some(Sleep { speed, time }) = self.sleep {
            if !(0.0..=MAX_SPEED).contains(&speed) {
                return Err(SettingsError::SleepSpeed(speed));
            }
            if !SECONDS.contains(&time) {
                return Err(SettingsError::SleepTime(time));
            }
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
    /// The speed below which bodies are still is not from 0 to 1e9 m/s.
    #[error("the speed of sleep must be from 0 to 1e9 m/s, got {0}")]
    SleepSpeed(Real),
    /// The time after which bodies fall asleep is not from 1e-9 to 1e9 seconds.
    #[error("the time of sleep must be from 1e-9 to 1e9 seconds, got {0:e}")]
    SleepTime(Real),
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
            Self::SleepSpeed(_) => "sleep.speed",
            Self::SleepTime(_) => "sleep.time",
        }
    }
}
