//! Simulation time: the step count, the simulated time and the unspent frame time.

use crate::math::Real;

/// Where a [`Simulation`](crate::Simulation) stands in time: its steps, its simulated time, and the
/// frame time that it still owes.
///
/// Force laws see the time, so it is a part of what a run continues from.
/// [`Simulation::clock`](crate::Simulation::clock) reads it,
/// [`Simulation::set_clock`](crate::Simulation::set_clock) sets it.
///
/// ```
/// # use tumble::{Settings, Simulation};
/// # let mut world = hecs::World::new();
/// let mut simulation = Simulation::new(Settings::default().with_dt(0.5))?;
/// simulation.step(&mut world);
/// let clock = simulation.clock();
/// simulation.step_many(&mut world, 10);
/// simulation.set_clock(clock);
/// assert_eq!((simulation.steps(), simulation.time()), (1, 0.5));
/// # Ok::<(), tumble::SettingsError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock {
    pub(crate) steps: u64,
    /// Steps and time \[s\] from which on time is a multiple of `dt`.
    pub(crate) since: (u64, f64),
    /// Length of a step when the clock was read \[s\].
    pub(crate) dt: Real,
    /// Frame time that no step has covered yet \[s\].
    pub(crate) owed: f64,
}

impl Clock {
    /// Of a single step that begins at a time \[s\].
    pub(crate) fn at(time: f64) -> Self {
        Self { steps: 0, since: (0, time), dt: 0.0, owed: 0.0 }
    }

    /// How many steps have been taken.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Simulated time \[s\].
    pub fn time(&self) -> f64 {
        self.time_after(0)
    }

    /// Simulated time \[s\] after this many more steps.
    pub(crate) fn time_after(&self, steps: u32) -> f64 {
        let (since, time) = self.since;
        time + (self.steps + u64::from(steps) - since) as f64 * f64::from(self.dt)
    }

    /// Whether a simulation can have left it so, and can go on from it: more steps than f64 counts
    /// are not taken in a lifetime.
    pub(crate) fn is_possible(&self) -> bool {
        const MAX_STEPS: u64 = 1 << f64::MANTISSA_DIGITS;
        let (steps, time) = self.since;
        let finite = time.is_finite() && self.dt.is_normal() && self.owed.is_finite();
        let positive = self.dt > 0.0 && self.owed >= 0.0;
        steps <= self.steps && self.steps <= MAX_STEPS && finite && positive && self.time().is_finite()
    }
}
