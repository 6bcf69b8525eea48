//! What a run did, for people.

use std::fmt::{self, Display};
use std::path::Path;
use std::time::Duration;

use clap::builder::styling::Style;
use tumble::PhaseTimes;
use tumble_import::printable;
use tumble_record::{Conserved, Drift, Kept, Summary};

use crate::print::HEADING;

/// The table at the end of a run.
pub(crate) struct Report<'a> {
    pub(crate) summary: &'a Summary,
    pub(crate) drift: &'a Drift,
    /// What has a drift.
    pub(crate) kept: Kept,
    pub(crate) times: &'a PhaseTimes,
    /// Simulated time \[s\].
    pub(crate) simulated: f64,
    /// Steps that were asked for.
    pub(crate) asked: u64,
    /// How often a body came into a sensor, and left one.
    pub(crate) sensed: [u64; 2],
    /// Where the record is.
    pub(crate) record: Option<&'a Path>,
    /// Where the report's page is.
    pub(crate) page: Option<&'a Path>,
}

/// What stands over the columns of what is conserved.
pub(crate) fn heading(line: &str) -> Option<(usize, Style)> {
    line.starts_with("                       ").then_some((line.len(), HEADING))
}

impl Display for Report<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let summary = self.summary;
        line(f, "bodies", summary.bodies)?;
        if summary.steps < self.asked {
            line(f, "steps", format_args!("{} (interrupted, of {})", summary.steps, self.asked))?;
        } else {
            line(f, "steps", summary.steps)?;
        }
        let parts = if summary.substeps == 1 { String::new() } else { format!(" in {} parts", summary.substeps) };
        line(f, "step", format_args!("{} s{parts}, {}, {}", summary.dt, summary.integrator, summary.precision))?;
        line(f, "threads", format_args!("{}, {}", summary.threads, summary.simd))?;
        line(f, "simulated time", format_args!("{:.6} s", self.simulated))?;
        line(f, "wall time", format_args!("{:.6} s", summary.wall_seconds))?;
        line(f, "stepping", format_args!("{:.6} s", summary.step_seconds))?;
        self.systems(f)?;
        line(f, "body-steps per second", format_args!("{:.4e}", summary.body_steps_per_second))?;
        if self.sensed != [0; 2] {
            line(f, "sensor events", format_args!("{} in, {} out", self.sensed[0], self.sensed[1]))?;
        }
        self.conserved(f)?;
        line(f, "state hash", &summary.state_hash)?;
        for (what, path) in [("record", self.record), ("report", self.page)] {
            if let Some(path) = path {
                line(f, what, printable(&path.to_string_lossy()))?;
            }
        }
        Ok(())
    }
}

impl Report<'_> {
    fn systems(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let systems = systems(self.times);
        let all: Duration = systems.iter().map(|(_, time)| *time).sum();
        for (system, time) in systems {
            // No time at all has no shares.
            let share = 100.0 * time.as_secs_f64() / all.as_secs_f64().max(f64::MIN_POSITIVE);
            line(f, &format!("  {system}"), format_args!("{:.6} s, {share:.0} %", time.as_secs_f64()))?;
        }
        Ok(())
    }

    fn conserved(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (start, end) = (self.drift.initial(), self.drift.latest());
        let Kept { energy: keeps_energy, momentum: keeps_momentum } = self.kept;
        let drift = if keeps_energy || keeps_momentum { "   largest drift" } else { "" };
        writeln!(f, "\n{:<22} {:>15} {:>15}{drift}", "", "start", "end")?;
        row(f, "kinetic energy [J]", start.kinetic(), end.kinetic(), None)?;
        row(f, "potential energy [J]", start.all_potential(), end.all_potential(), None)?;
        let energy = &self.summary.energy;
        row(f, "energy [J]", energy.initial, energy.r#final, keeps_energy.then_some(energy.max_relative_drift))?;
        vector(f, "momentum [kg m/s]", &self.summary.linear_momentum, keeps_momentum)?;
        vector(f, "ang. mom. [kg m2/s]", &self.summary.angular_momentum, keeps_momentum)?;
        writeln!(f)
    }
}

/// The systems of a step, and the time spent in each, over all threads; of what bodies do to each
/// other only where they did.
pub(crate) fn systems(times: &PhaseTimes) -> Vec<(&'static str, Duration)> {
    let always = [
        ("accumulate_forces", times.accumulate_forces()),
        ("integrate", times.integrate()),
        ("update_derived", times.update_derived()),
    ];
    let together = [("pairs", times.pairs()), ("contacts", times.contacts())];
    always.into_iter().chain(together.into_iter().filter(|(_, time)| !time.is_zero())).collect()
}

fn line(f: &mut fmt::Formatter<'_>, label: &str, value: impl Display) -> fmt::Result {
    writeln!(f, "{label:<22} {value}")
}

fn row(f: &mut fmt::Formatter<'_>, label: &str, start: f64, end: f64, drift: Option<f64>) -> fmt::Result {
    write!(f, "{label:<22} {start:>15.7e} {end:>15.7e}")?;
    match drift {
        Some(drift) => writeln!(f, " {drift:>15.2e}"),
        None => writeln!(f),
    }
}

/// The drift is that of the vector, so it stands in the first row only, where there is one.
fn vector(f: &mut fmt::Formatter<'_>, label: &str, vector: &Conserved<[f64; 3]>, is_kept: bool) -> fmt::Result {
    let drift = vector.max_relative_drift;
    for (axis, (start, end)) in ["x", "y", "z"].iter().zip(vector.initial.iter().zip(vector.r#final)) {
        let first = (is_kept && *axis == "x").then_some(drift);
        row(f, &format!("{label} {axis}"), *start, end, first)?;
    }
    Ok(())
}
