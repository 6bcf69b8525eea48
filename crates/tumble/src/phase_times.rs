use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Time spent in each system, summed over threads and steps: with two threads busy it grows by two seconds a second.
///
/// ```
/// # use tumble::{PhaseTimes, prelude::*};
/// # let mut world = hecs::World::new();
/// RigidBody::new(Shape::sphere(1.0)).mass(2.0).build()?.spawn(&mut world);
/// let times = PhaseTimes::default();
/// Simulation::new(Settings::default())?.step_timed(&mut world, &times);
/// println!("{:?} in the integrator", times.integrate());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Default)]
pub struct PhaseTimes {
    nanoseconds: [AtomicU64; 3],
}

/// A system of the step, as an index into the times.
#[derive(Clone, Copy)]
pub(crate) enum Phase {
    AccumulateForces,
    Integrate,
    UpdateDerived,
}

/// Runs from one phase's end to the next; does nothing where no one asked for times.
pub(crate) struct Stopwatch<'a> {
    running: Option<(&'a PhaseTimes, Instant)>,
}

impl PhaseTimes {
    /// In [`accumulate_forces`](crate::accumulate_forces).
    pub fn accumulate_forces(&self) -> Duration {
        self.of(Phase::AccumulateForces)
    }

    /// In [`integrate`](crate::integrate).
    pub fn integrate(&self) -> Duration {
        self.of(Phase::Integrate)
    }

    /// In [`update_derived`](crate::update_derived).
    pub fn update_derived(&self) -> Duration {
        self.of(Phase::UpdateDerived)
    }

    fn of(&self, phase: Phase) -> Duration {
        Duration::from_nanos(self.nanoseconds[phase as usize].load(Ordering::Relaxed))
    }

    pub(crate) fn start(times: Option<&Self>) -> Stopwatch<'_> {
        Stopwatch { running: times.map(|times| (times, Instant::now())) }
    }
}

impl Stopwatch<'_> {
    pub(crate) fn end_of(&mut self, phase: Phase) {
        if let Some((times, since)) = &mut self.running {
            let now = Instant::now();
            let spent = u64::try_from(now.duration_since(*since).as_nanos()).unwrap_or(u64::MAX);
            times.nanoseconds[phase as usize].fetch_add(spent, Ordering::Relaxed);
            *since = now;
        }
    }
}
