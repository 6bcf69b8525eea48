//! How well energy and momentum are kept, sampled now and then.

use hecs::{Entity, World};
use tumble::{BodyOrder, Settings, Totals};
use tumble_record::{Conserved, MomentumScale, energy_scale};

/// Up to this number of body-steps every step is a sample: measuring them all takes a second at
/// most.
pub(crate) const EVERY_STEP_UP_TO: u64 = 1_000_000;

/// Samples of longer runs.
const SAMPLES: u64 = 64;

/// Steps between samples; the last step is always one.
pub(crate) fn interval(bodies: u64, steps: u64) -> u64 {
    if bodies.max(1).saturating_mul(steps) <= EVERY_STEP_UP_TO { 1 } else { steps.div_ceil(SAMPLES).max(1) }
}

/// Why a sample cannot be taken.
pub(crate) enum NotFinite {
    /// This body's state is not finite.
    Body(Entity),
    /// The states are, but a sum over them is not.
    Total,
}

/// The totals at both ends, and the largest departures from the start in between.
///
/// Departures are divided by scales. For energy: the largest of `|initial|`, the kinetic energy at
/// the start and the most that the potentials of gravity and forces together have changed (what was
/// exchanged, for a body dropped from rest at the origin has no energy at all). For the momenta:
/// the sum over bodies of their magnitudes at the start, which is `|initial|` for one body and does
/// not cancel for many.
pub(crate) struct Drift {
    initial: Totals,
    latest: Totals,
    scale: MomentumScale,
    energy: f64,
    exchanged: f64,
    linear: f64,
    angular: f64,
}

impl Drift {
    pub(crate) fn start(world: &World, settings: &Settings, order: &BodyOrder) -> Result<Self, NotFinite> {
        let initial = finite_totals(world, settings, order)?;
        let nothing = 0.0;
        Ok(Self {
            initial,
            latest: initial,
            scale: MomentumScale::of(world, order),
            energy: nothing,
            exchanged: nothing,
            linear: nothing,
            angular: nothing,
        })
    }

    pub(crate) fn sample(&mut self, world: &World, settings: &Settings, order: &BodyOrder) -> Result<(), NotFinite> {
        let now = finite_totals(world, settings, order)?;
        let start = &self.initial;
        self.energy = self.energy.max((now.energy() - start.energy()).abs());
        self.exchanged = self.exchanged.max((now.all_potential() - start.all_potential()).abs());
        self.linear = self.linear.max((now.linear_momentum - start.linear_momentum).length());
        self.angular = self.angular.max((now.angular_momentum - start.angular_momentum).length());
        self.latest = now;
        Ok(())
    }

    pub(crate) fn initial(&self) -> &Totals {
        &self.initial
    }

    pub(crate) fn latest(&self) -> &Totals {
        &self.latest
    }

    /// What departures of the energy are compared to \[J\].
    pub(crate) fn energy_scale(&self) -> f64 {
        energy_scale(&self.initial, self.exchanged)
    }

    pub(crate) fn energy(&self) -> Conserved<f64> {
        let start = &self.initial;
        Conserved {
            initial: start.energy(),
            r#final: self.latest.energy(),
            max_relative_drift: relative(self.energy, self.energy_scale()),
        }
    }

    pub(crate) fn linear_momentum(&self) -> Conserved<[f64; 3]> {
        Conserved {
            initial: self.initial.linear_momentum.to_array(),
            r#final: self.latest.linear_momentum.to_array(),
            max_relative_drift: relative(self.linear, self.scale.linear),
        }
    }

    pub(crate) fn angular_momentum(&self) -> Conserved<[f64; 3]> {
        Conserved {
            initial: self.initial.angular_momentum.to_array(),
            r#final: self.latest.angular_momentum.to_array(),
            max_relative_drift: relative(self.angular, self.scale.angular),
        }
    }
}

/// Always finite: with nothing to compare to, any departure counts as 1.
fn relative(departure: f64, scale: f64) -> f64 {
    if departure == 0.0 {
        0.0
    } else if scale > 0.0 {
        (departure / scale).min(f64::MAX)
    } else {
        1.0
    }
}

fn finite_totals(world: &World, settings: &Settings, order: &BodyOrder) -> Result<Totals, NotFinite> {
    let totals = Totals::of(world, settings, order);
    if let Some(body) = totals.non_finite {
        return Err(NotFinite::Body(body));
    }
    let (linear, angular) = (totals.linear_momentum, totals.angular_momentum);
    if totals.energy().is_finite() && linear.length().is_finite() && angular.length().is_finite() {
        Ok(totals)
    } else {
        Err(NotFinite::Total)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_runs_are_sampled_at_every_step_and_long_ones_at_most_64_times() {
        assert_eq!(interval(1, 1_000_000), 1);
        assert_eq!(interval(10_000, 600), 10);
        assert!(1_000_000_007_u64.div_ceil(interval(1, 1_000_000_007)) <= SAMPLES);
        assert_eq!(interval(u64::MAX, 1), 1);
    }

    #[test]
    fn a_drift_is_always_a_finite_number() {
        assert_eq!(relative(0.0, 0.0), 0.0);
        assert_eq!(relative(1.0, 0.0), 1.0);
        assert_eq!(relative(1.0, 4.0), 0.25);
        assert_eq!(relative(1e300, 1e-300), f64::MAX);
    }
}
