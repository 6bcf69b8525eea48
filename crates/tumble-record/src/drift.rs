//! How well energy and momentum are kept, sampled now and then.

use hecs::{Entity, World};
use tumble::{BodyOrder, Settings, Totals};

use crate::energy_scale::energy_scale;
use crate::momentum_scale::MomentumScale;
use crate::summary::Conserved;

/// Why a sample cannot be taken.
///
/// ```
/// use tumble_record::NotFinite;
///
/// assert_eq!(NotFinite::Total.to_string(), "the total energy or momentum is not finite");
/// ```
#[derive(Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum NotFinite {
    /// This body's state is not finite.
    #[error("the state of entity {0:?} is not finite")]
    Body(Entity),
    /// The states are, but a sum over them is not.
    #[error("the total energy or momentum is not finite")]
    Total,
}

/// As it is displayed, so that a `main` that returns it ends with a sentence.
impl std::fmt::Debug for NotFinite {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        std::fmt::Display::fmt(self, formatter)
    }
}

/// The totals at both ends, and the largest departures from the start in between.
///
/// Departures are divided by scales. For energy: the largest of `|initial|`, the kinetic energy at
/// the start and the most that the potentials of gravity and forces together have changed (what was
/// exchanged, for a body dropped from rest at the origin has no energy at all). For the momenta:
/// the sum over bodies of their magnitudes at the start, which is `|initial|` for one body and does
/// not cancel for many.
///
/// ```
/// use tumble_record::Drift;
/// use tumble_scene::Scene;
///
/// let scene = Scene::open("t-handle")?;
/// let mut simulation = tumble::Simulation::new(scene.settings)?;
/// let mut world = hecs::World::new();
/// scene.spawn(&mut world)?;
/// let order = tumble::BodyOrder::of(&world);
/// let mut drift = Drift::start(&world, simulation.settings(), &order)?;
/// for _ in 0..10 {
///     simulation.step_many(&mut world, 6);
///     drift.sample(&world, simulation.settings(), &order)?;
/// }
/// assert!(drift.energy().max_relative_drift < 1e-5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Drift {
    initial: Totals,
    latest: Totals,
    scale: MomentumScale,
    energy: f64,
    exchanged: f64,
    linear: f64,
    angular: f64,
}

impl Drift {
    /// Begins with the state at the start.
    ///
    /// # Errors
    /// [`NotFinite`] if a body's state or a sum over the states is not finite.
    pub fn start(world: &World, settings: &Settings, order: &BodyOrder) -> Result<Self, NotFinite> {
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

    /// Takes a sample of the state as it is now.
    ///
    /// # Errors
    /// [`NotFinite`] if a body's state or a sum over the states is not finite; the samples before
    /// it stay.
    pub fn sample(&mut self, world: &World, settings: &Settings, order: &BodyOrder) -> Result<(), NotFinite> {
        let now = finite_totals(world, settings, order)?;
        let start = &self.initial;
        self.energy = self.energy.max((now.energy() - start.energy()).abs());
        self.exchanged = self.exchanged.max((now.all_potential() - start.all_potential()).abs());
        self.linear = self.linear.max((now.linear_momentum - start.linear_momentum).length());
        self.angular = self.angular.max((now.angular_momentum - start.angular_momentum).length());
        self.latest = now;
        Ok(())
    }

    /// The totals at the start.
    #[must_use]
    pub fn initial(&self) -> &Totals {
        &self.initial
    }

    /// The totals at the last sample.
    #[must_use]
    pub fn latest(&self) -> &Totals {
        &self.latest
    }

    /// What departures of the energy are compared to \[J\].
    #[must_use]
    pub fn energy_scale(&self) -> f64 {
        energy_scale(&self.initial, self.exchanged)
    }

    /// Kinetic energy and potentials together \[J\].
    #[must_use]
    pub fn energy(&self) -> Conserved<f64> {
        let start = &self.initial;
        Conserved {
            initial: start.energy(),
            r#final: self.latest.energy(),
            max_relative_drift: relative(self.energy, self.energy_scale()),
        }
    }

    /// Linear momentum \[kg m/s\].
    #[must_use]
    pub fn linear_momentum(&self) -> Conserved<[f64; 3]> {
        Conserved {
            initial: self.initial.linear_momentum.to_array(),
            r#final: self.latest.linear_momentum.to_array(),
            max_relative_drift: relative(self.linear, self.scale.linear),
        }
    }

    /// Angular momentum about the world's origin \[kg m^2/s\].
    #[must_use]
    pub fn angular_momentum(&self) -> Conserved<[f64; 3]> {
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
    fn a_drift_is_always_a_finite_number() {
        assert_eq!(relative(0.0, 0.0), 0.0);
        assert_eq!(relative(1.0, 0.0), 1.0);
        assert_eq!(relative(1.0, 4.0), 0.25);
        assert_eq!(relative(1e300, 1e-300), f64::MAX);
    }
}
