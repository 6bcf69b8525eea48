//! The ledger of a run, as the report shows it.

use std::io::{self, Write};

use hecs::World;
use tumble::{ForceLaws, Ledger, LedgerEntry, Simulation, Totals, Work};
use tumble_record::{Plot, Scale, SeriesStyle};

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

    /// Where the energy is, over time. A potential that there is none of is left out where there is
    /// another.
    pub(crate) fn energy_plot(&self) -> Plot {
        let is_there = |of: fn(&Totals) -> f64| self.ledger.entries().iter().any(|entry| of(&entry.totals) != 0.0);
        let of_forces = is_there(|totals| totals.force_potential);
        let mut plot = Plot::new("Energy")
            .x_axis("time [s]", Scale::Linear)
            .y_axis("energy [J]", Scale::Linear)
            .series("kinetic, linear", SeriesStyle::Line, self.over_time(|entry| entry.totals.linear_kinetic))
            .series("kinetic, rotation", SeriesStyle::Line, self.over_time(|entry| entry.totals.rotational_kinetic));
        if !of_forces || is_there(|totals| totals.potential) {
            plot = plot.series("potential", SeriesStyle::Line, self.over_time(|entry| entry.totals.potential));
        }
        if of_forces {
            let potential = self.over_time(|entry| entry.totals.force_potential);
            plot = plot.series("potential of forces", SeriesStyle::Line, potential);
        }
        plot.series("sum", SeriesStyle::Line, self.over_time(LedgerEntry::energy))
    }

    /// How far the energy is from where it began, relative to the scale \[J\] of the largest drift
    /// beside it.
    pub(crate) fn drift_plot(&self, scale: f64) -> Plot {
        let energy = self.ledger.entries().first().map_or(0.0, LedgerEntry::energy);
        let drift = self.over_time(move |entry| if scale > 0.0 { (entry.energy() - energy) / scale } else { 0.0 });
        Plot::new("Change of energy")
            .x_axis("time [s]", Scale::Linear)
            .y_axis("relative to its scale", Scale::Linear)
            .series("", SeriesStyle::Line, drift)
    }

    fn over_time<'a>(
        &'a self,
        mut value: impl FnMut(&LedgerEntry) -> f64 + 'a,
    ) -> impl Iterator<Item = (f64, f64)> + 'a {
        self.ledger.entries().iter().map(move |entry| (entry.time, value(entry)))
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
