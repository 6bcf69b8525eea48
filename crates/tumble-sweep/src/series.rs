//! Time series of a world: where the reported bodies are on the way, as lines of CSV.

use std::fmt::Write as _;

use tumble::{BodyOrder, Pose, Trial, Velocity};
use tumble_record::{COLUMNS, csv_cell, state_numbers};

use crate::sweep::Sweep;

/// The states of the reported bodies of one world, as lines of the file.
pub(crate) struct Series {
    every: u64,
    /// World and names, as they stand in the file.
    world: u64,
    bodies: Vec<(usize, String)>,
    last: Option<u64>,
    text: String,
}

impl Series {
    /// That of a world, if the sweep has any; begins with the state at the start.
    pub(crate) fn start(sweep: &Sweep, world: u64, trial: &Trial, order: &BodyOrder) -> Option<Self> {
        let every = sweep.plan().series?.get();
        let names = sweep.reported_names().iter().map(|name| quoted(&csv_cell(name)));
        let bodies = sweep.reported().iter().copied().zip(names).collect();
        let mut series = Self { every, world, bodies, last: None, text: String::new() };
        series.write(trial, order);
        Some(series)
    }

    /// Sees a step that was just done.
    pub(crate) fn see(&mut self, trial: &Trial, order: &BodyOrder) {
        if trial.simulation.steps().is_multiple_of(self.every) {
            self.write(trial, order);
        }
    }

    /// The lines, with the last state whichever step it is of.
    pub(crate) fn finish(mut self, trial: &Trial, order: &BodyOrder) -> String {
        if self.last != Some(trial.simulation.steps()) {
            self.write(trial, order);
        }
        self.text
    }

    /// The line of a world that no body can have, which is empty but for the world.
    pub(crate) fn of_impossible(world: u64) -> String {
        format!("{world}{}\n", ",".repeat(COLUMNS.len()))
    }

    fn write(&mut self, trial: &Trial, order: &BodyOrder) {
        let (step, time) = (trial.simulation.steps(), trial.simulation.time());
        self.last = Some(step);
        for (body, name) in &self.bodies {
            let entity = order.entities().get(*body).and_then(|entity| trial.world.entity(*entity).ok());
            let Some((entity, pose)) = entity.and_then(|entity| Some((entity, *entity.get::<&Pose>()?))) else {
                continue;
            };
            // Writing to a string cannot fail.
            let _ = write!(self.text, "{},{step},{time:?},{name}", self.world);
            for number in state_numbers(&pose, entity.get::<&Velocity>().as_deref()) {
                let _ = write!(self.text, ",{number:?}");
            }
            self.text.push('\n');
        }
    }
}

/// As a field of CSV.
fn quoted(name: &str) -> String {
    if name.contains([',', '"', '\r', '\n']) { format!("\"{}\"", name.replace('"', "\"\"")) } else { name.to_owned() }
}
