//! Time spent in each phase of the step, accumulated over steps and threads.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use crate::step::phased_step::StepPhase;

/// Time spent in each system, summed over steps, and over threads where bodies do not act on each
/// other: with two threads busy it then grows by two seconds a second. A step in which bodies act
/// on each other goes from system to system together, and its times are those of the thread that
/// steps.
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
    /// By phase.
    nanoseconds: [AtomicU64; StepPhase::COUNT],
}

/// Runs from one phase's end to the next; does nothing where no one asked for times.
pub(crate) struct Stopwatch<'a> {
    running: Option<(&'a PhaseTimes, Instant)>,
}

impl PhaseTimes {
    /// In [`accumulate_forces`](crate::accumulate_forces).
    pub fn accumulate_forces(&self) -> Duration {
        self.of(StepPhase::AccumulateForces)
    }

    /// In [`integrate`](crate::integrate).
    pub fn integrate(&self) -> Duration {
        self.of(StepPhase::Integrate)
    }

    /// In [`update_derived`](crate::update_derived).
    pub fn update_derived(&self) -> Duration {
        self.of(StepPhase::UpdateDerived)
    }

    /// In what springs and the gravity of bodies do to others: [`Spring`](crate::Spring),
    /// [`GravityMass`](crate::GravityMass).
    pub fn pairs(&self) -> Duration {
        self.of(StepPhase::PairForcesBefore) + self.of(StepPhase::PairForcesAfter)
    }

    /// In finding contacts, and in solving them: [`Collider`](crate::Collider).
    pub fn contacts(&self) -> Duration {
        self.of(StepPhase::FindContacts) + self.of(StepPhase::SolveContacts)
    }

    fn of(&self, phase: StepPhase) -> Duration {
        Duration::from_nanos(self.nanoseconds[phase as usize].load(Ordering::Relaxed))
    }

    pub(crate) fn start(times: Option<&Self>) -> Stopwatch<'_> {
        Stopwatch { running: times.map(|times| (times, Instant::now())) }
    }
}

impl Stopwatch<'_> {
    /// Ends a phase that may not be there; if it is not, what little was done counts for the next.
    pub(crate) fn end_if(&mut self, is_there: bool, phase: StepPhase) {
        if is_there {
            self.end_of(phase);
        }
    }

    pub(crate) fn end_of(&mut self, phase: StepPhase) {
        if let Some((times, since)) = &mut self.running {
            let now = Instant::now();
            let spent = u64::try_from(now.duration_since(*since).as_nanos()).unwrap_or(u64::MAX);
            times.nanoseconds[phase as usize].fetch_add(spent, Ordering::Relaxed);
            *since = now;
        }
    }
}
