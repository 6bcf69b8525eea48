//! Pictures of a ledger: where the energy is, and how well it is kept.

use tumble::{LedgerEntry, Totals};

use crate::plot::Plot;
use crate::plot::SeriesStyle;
use crate::plot::axis::Scale;

/// Where the energy is, over time. A potential that there is none of is left out where there is
/// another.
///
/// ```
/// # use tumble::{Ledger, prelude::*};
/// # let mut world = hecs::World::new();
/// RigidBody::new(Shape::sphere(0.1)).mass(2.0).build()?.spawn(&mut world);
/// let mut simulation = Simulation::new(Settings::default())?;
/// let mut ledger = Ledger::watch(&world, &simulation);
/// simulation.step_many(&mut world, 60);
/// ledger.record(&world, &simulation);
/// assert!(tumble_record::energy_plot(ledger.entries()).to_svg().contains("potential"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn energy_plot(entries: &[LedgerEntry]) -> Plot {
    let is_there = |of: fn(&Totals) -> f64| entries.iter().any(|entry| of(&entry.totals) != 0.0);
    let of_forces = is_there(|totals| totals.force_potential);
    let mut plot = Plot::new("Energy")
        .x_axis("time [s]", Scale::Linear)
        .y_axis("energy [J]", Scale::Linear)
        .series("kinetic, linear", SeriesStyle::Line, over_time(entries, |entry| entry.totals.linear_kinetic))
        .series("kinetic, rotation", SeriesStyle::Line, over_time(entries, |entry| entry.totals.rotational_kinetic));
    if !of_forces || is_there(|totals| totals.potential) {
        plot = plot.series("potential", SeriesStyle::Line, over_time(entries, |entry| entry.totals.potential));
    }
    if of_forces {
        let potential = over_time(entries, |entry| entry.totals.force_potential);
        plot = plot.series("potential of forces", SeriesStyle::Line, potential);
    }
    plot.series("sum", SeriesStyle::Line, over_time(entries, LedgerEntry::energy))
}

/// How far the energy is from where it began, relative to a scale \[J\].
///
/// ```
/// # use tumble::{Ledger, prelude::*};
/// # let world = hecs::World::new();
/// # let simulation = Simulation::new(Settings::default())?;
/// let ledger = Ledger::watch(&world, &simulation);
/// let plot = tumble_record::drift_plot(ledger.entries(), 2.0);
/// assert!(plot.to_svg().contains("Change of energy"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn drift_plot(entries: &[LedgerEntry], scale: f64) -> Plot {
    let energy = entries.first().map_or(0.0, LedgerEntry::energy);
    let drift = over_time(entries, move |entry| if scale > 0.0 { (entry.energy() - energy) / scale } else { 0.0 });
    Plot::new("Change of energy")
        .x_axis("time [s]", Scale::Linear)
        .y_axis("relative to its scale", Scale::Linear)
        .series("", SeriesStyle::Line, drift)
}

fn over_time<'a>(
    entries: &'a [LedgerEntry],
    mut value: impl FnMut(&LedgerEntry) -> f64 + 'a,
) -> impl Iterator<Item = (f64, f64)> + 'a {
    entries.iter().map(move |entry| (entry.time, value(entry)))
}
