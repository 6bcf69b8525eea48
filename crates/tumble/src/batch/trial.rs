//! One world with its simulation, run until an observer stops it.

use std::ops::ControlFlow;

use hecs::World;

use crate::settings::{Settings, SettingsError};
use crate::snapshot::state_hash::state_hash;
use crate::step::simulation::Simulation;
use crate::storage::body_order::BodyOrder;

/// One world with the simulation that steps it: a member of a [`Batch`](crate::Batch), and the same
/// alone.
///
/// ```
/// use std::ops::ControlFlow;
/// use tumble::Trial;
/// use tumble::prelude::*;
///
/// let mut world = hecs::World::new();
/// let stone =
///     RigidBody::new(Shape::Point).mass(1.0).position(Vec3::Y * 20.0).build()?.spawn(&mut world);
/// let mut trial = Trial::new(Settings::default(), world)?;
/// let landed = trial.run(600, 10, |trial| match trial.world.get::<&Pose>(stone) {
///     Ok(pose) if pose.position.y <= 0.0 => ControlFlow::Break(trial.simulation.time()),
///     _ => ControlFlow::Continue(()),
/// });
/// // The square root of 2 h / g is 2.02 s; tested every sixth of a second, it is seen at 2 1/6 s.
/// assert!(matches!(landed, ControlFlow::Break(time) if (time - 13.0 / 6.0).abs() < 1e-6));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Trial {
    /// Settings, force laws and time.
    pub simulation: Simulation,
    /// The bodies.
    pub world: World,
}

impl Trial {
    /// A world at time zero, without force laws.
    ///
    /// # Errors
    /// [`SettingsError`] where the settings are ones that nothing can be simulated with.
    pub fn new(settings: Settings, world: World) -> Result<Self, SettingsError> {
        Ok(Self { simulation: Simulation::new(settings)?, world })
    }

    /// Advances the world by `count` steps; see [`Simulation::step_many`].
    pub fn step_many(&mut self, count: u32) {
        crate::scope::scope!("tumble::trial");
        self.simulation.step_many(&mut self.world, count);
    }

    /// Takes up to `steps` steps, and calls `observe` after every `every`-th of them and after the
    /// last; with an `every` of zero only after the last. What it sees it may also change, and it
    /// ends the run with [`ControlFlow::Break`].
    ///
    /// With no steps to take nothing is observed.
    pub fn run<B>(
        &mut self,
        steps: u64,
        every: u32,
        mut observe: impl FnMut(&mut Self) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        let mut left = steps;
        while left > 0 {
            let period = if every == 0 { left } else { left.min(u64::from(every)) };
            self.step_long(period);
            observe(self)?;
            left -= period;
        }
        ControlFlow::Continue(())
    }

    /// More steps than fit one call.
    fn step_long(&mut self, mut count: u64) {
        while count > 0 {
            let part = u32::try_from(count).unwrap_or(u32::MAX);
            self.step_many(part);
            count -= u64::from(part);
        }
    }

    /// The hash of the state, to compare runs by; see
    /// [`state_hash`](crate::state_hash()).
    pub fn state_hash(&self) -> u64 {
        state_hash(&self.world, &BodyOrder::of(&self.world))
    }
}
