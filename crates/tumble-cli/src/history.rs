//! The ledger of a run, as the report shows it.

use std::io::{self, Write};

use hecs::World;
use tumble::{ForceLaws, Ledger, Simulation, Work};
use tumble_record::{Plot, drift_plot, energy_plot};

use crate::interval::EVERY_STEP_UP_TO;

/// Energy, momentum and work at every sample of a run.
///
/// Booking the work makes a step about ten times as expensive. Long runs do without, so that the
/// speed a report states is the engine's.
pub(crate) struct History {
    ledger: Ledger,
    works: bool,
    /// Steps from one entry to the next.
    every: u64,
    steps: u64,
}

/// Entries of a long run: more than a plot can show, few enough to hold.
const MAX_ENTRIES: u64 = 10_000;

impl History {
    pub(crate) fn open(world: &mut World, simulation: &Simulation, bodies: u64, steps: u64) -> Self {
        let works = bodies.saturating_mul(steps) <= EVERY_STEP_UP_TO;
        let ledger = if works { Ledger::attach(world, simulation) } else { Ledger::watch(world, simulation) };
        Self { ledger, works, every: steps.div_ceil(MAX_ENTRIES).max(1), steps }
    }

    pub(crate) fn record(&mut self, world: &World, simulation: &Simulation) {
        let step = simulation.steps();
        if step.is_multiple_of(self.every) || step == self.steps {
            self.ledger.record(world, simulation);
        }
    }

    /// One row a sample: energies and works \[J\], momenta \[kg m/s\], \[kg m^2/s\] about the
    /// world's origin. Of the kinds of force components those have a column that did any work.
    pub(crate) fn write_csv(&self, to: &mut impl Write) -> io::Result<()> {
        let kinds = if self.works { self.working_kinds() } else { Vec::new() };
        write!(to, "step,time,linear_kinetic,rotational_kinetic,potential,force_potential,energy,px,py,pz,lx,ly,lz")?;
        if self.works {
            write!(to, ",work_gravity,work_applied,work_damping,work_contacts,work_joints,work_sleep,work_integrator")?;
        }
        for kind in &kinds {
            write!(to, ",work_{}", snake_case(ForceLaws::COMPONENTS[*kind]))?;
        }
        writeln!(to)?;
        for entry in self.ledger.entries() {
            let (totals, work) = (&entry.totals, &entry.work);
            let [px, py, pz] = totals.linear_momentum.to_array();
            let [lx, ly, lz] = totals.angular_momentum.to_array();
            let mut numbers = vec![entry.time, totals.linear_kinetic, totals.rotational_kinetic, totals.potential];
            numbers.extend([totals.force_potential, entry.energy(), px, py, pz, lx, ly, lz]);
            if self.works {
                let Work { gravity, applied, damping, contacts, joints, sleep, integrator, .. } = *work;
                numbers.extend([gravity, applied, damping, contacts, joints, sleep, integrator]);
            }
            numbers.extend(kinds.iter().map(|kind| work.forces[*kind]));
            write!(to, "{}", entry.step)?;
            for number in numbers {
                write!(to, ",{number:?}")?;
            }
            writeln!(to)?;
        }
        Ok(())
    }

    /// The kinds of force components that did work, by their index in [`ForceLaws::COMPONENTS`].
    fn working_kinds(&self) -> Vec<usize> {
        let worked = |kind: &usize| self.ledger.entries().iter().any(|entry| entry.work.forces[*kind] != 0.0);
        (0..ForceLaws::COMPONENTS.len()).filter(worked).collect()
    }

    /// Where the energy is, over time.
    pub(crate) fn energy_plot(&self) -> Plot {
        energy_plot(self.ledger.entries())
    }

    /// How far the energy is from where it began, relative to the scale \[J\] of the largest drift
    /// beside it.
    pub(crate) fn drift_plot(&self, scale: f64) -> Plot {
        drift_plot(self.ledger.entries(), scale)
    }
}

/// `GravityMass` as `gravity_mass`.
fn snake_case(name: &str) -> String {
    let mut snake = String::new();
    for (at, letter) in name.char_indices() {
        if letter.is_uppercase() && at > 0 {
            snake.push('_');
        }
        snake.extend(letter.to_lowercase());
    }
    snake
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn accounts_are_named_as_forces_are_in_files() {
        let names = ForceLaws::COMPONENTS.map(snake_case);
        for name in ["drag", "spring_to_point", "angular_velocity_servo", "gravity_mass"] {
            assert!(names.iter().any(|known| known == name), "{name} is not in {names:?}");
        }
    }
}
