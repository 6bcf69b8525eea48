//! The ledger of a run, as the report shows it.

use std::io::{self, Write};

use hecs::World;
use tumble::{Ledger, LedgerEntry, Simulation};
use tumble_scene::{Mark, Plot, Scale};

use crate::drift::EVERY_STEP_UP_TO;

/// Energy, momentum and work at every sample of a run.
///
/// Booking the work makes a step about ten times as expensive. Long runs do without, so that the speed a report states is the engine's.
pub(crate) struct History {
    ledger: Ledger,
    works: bool,
    /// Steps from one entry to the next.
    every: u64,
    steps: u64,
}

/// Entries of a long run: more than a plot can show, few enough to hold.
const MOST_ENTRIES: u64 = 10_000;

impl History {
    pub(crate) fn open(world: &mut World, simulation: &Simulation, bodies: u64, steps: u64) -> Self {
        let works = bodies.saturating_mul(steps) <= EVERY_STEP_UP_TO;
        let ledger = if works { Ledger::attach(world, simulation) } else { Ledger::watch(world, simulation) };
        Self { ledger, works, every: steps.div_ceil(MOST_ENTRIES).max(1), steps }
    }

    pub(crate) fn record(&mut self, world: &World, simulation: &Simulation) {
        let step = simulation.steps();
        if step.is_multiple_of(self.every) || step == self.steps {
            self.ledger.record(world, simulation);
        }
    }

    /// One row a sample: energies and works \[J\], momenta \[kg m/s\], \[kg m^2/s\] about the world's origin.
    pub(crate) fn write_csv(&self, to: &mut impl Write) -> io::Result<()> {
        let works = if self.works { ",work_gravity,work_applied,work_damping,work_integrator" } else { "" };
        writeln!(to, "step,time,linear_kinetic,rotational_kinetic,potential,energy,px,py,pz,lx,ly,lz{works}")?;
        for entry in self.ledger.entries() {
            let (totals, work) = (&entry.totals, &entry.work);
            let [px, py, pz] = totals.linear_momentum.to_array();
            let [lx, ly, lz] = totals.angular_momentum.to_array();
            let mut numbers = vec![entry.time, totals.linear_kinetic, totals.rotational_kinetic, totals.potential];
            numbers.extend([entry.energy(), px, py, pz, lx, ly, lz]);
            if self.works {
                numbers.extend([work.gravity, work.applied, work.damping, work.integrator]);
            }
            write!(to, "{}", entry.step)?;
            for number in numbers {
                write!(to, ",{number:?}")?;
            }
            writeln!(to)?;
        }
        Ok(())
    }

    /// Where the energy is, over time.
    pub(crate) fn energy_plot(&self) -> Plot {
        Plot::new("Energy")
            .x_axis("time [s]", Scale::Linear)
            .y_axis("energy [J]", Scale::Linear)
            .series("kinetic, linear", Mark::Line, self.over_time(|entry| entry.totals.linear_kinetic))
            .series("kinetic, rotation", Mark::Line, self.over_time(|entry| entry.totals.rotational_kinetic))
            .series("potential", Mark::Line, self.over_time(|entry| entry.totals.potential + entry.law_potential))
            .series("sum", Mark::Line, self.over_time(LedgerEntry::energy))
    }

    /// How far the energy is from where it began, relative to the kinetic energy at the start or the most that the potential has
    /// changed so far, whichever is larger.
    pub(crate) fn drift_plot(&self) -> Plot {
        let entries = self.ledger.entries();
        let (energy, potential) = entries.first().map_or((0.0, 0.0), |first| (first.energy(), first.totals.potential));
        let mut scale = entries.first().map_or(0.0, LedgerEntry::kinetic);
        let drift = self.over_time(move |entry| {
            scale = scale.max((entry.totals.potential - potential).abs());
            if scale > 0.0 { (entry.energy() - energy) / scale } else { 0.0 }
        });
        Plot::new("Change of energy")
            .x_axis("time [s]", Scale::Linear)
            .y_axis("relative to the energy at play", Scale::Linear)
            .series("", Mark::Line, drift)
    }

    fn over_time<'a>(
        &'a self,
        mut value: impl FnMut(&LedgerEntry) -> f64 + 'a,
    ) -> impl Iterator<Item = (f64, f64)> + 'a {
        self.ledger.entries().iter().map(move |entry| (entry.time, value(entry)))
    }
}
