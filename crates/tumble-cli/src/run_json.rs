//! What a run did, as one JSON object for programs.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Serialize;
use tumble::PhaseTimes;
use tumble_import::printable_json;
use tumble_record::{Drift, Kept, Summary};

use crate::failure::Failure;
use crate::table::systems;

/// The keys of `tumble run --json`: those of `summary.json`, and what else the table says.
#[derive(Serialize)]
pub(crate) struct RunJson<'a> {
    scene: &'a str,
    steps_asked: u64,
    /// \[s\].
    simulated_seconds: f64,
    #[serde(flatten)]
    summary: &'a Summary,
    /// \[J\].
    kinetic_energy: Ends,
    /// Of gravity and of forces \[J\].
    potential_energy: Ends,
    energy_is_kept: bool,
    momentum_is_kept: bool,
    /// Of each system of a step, over all threads \[s\].
    system_seconds: BTreeMap<&'static str, f64>,
    sensor_events: SensorEvents,
    record: Option<&'a Path>,
    report: Option<&'a Path>,
}

#[derive(Serialize)]
struct Ends {
    initial: f64,
    r#final: f64,
}

#[derive(Serialize)]
struct SensorEvents {
    begins: u64,
    ends: u64,
}

impl<'a> RunJson<'a> {
    pub(crate) fn new(scene: &'a str, report: &crate::table::Report<'a>) -> Self {
        let drift: &Drift = report.drift;
        let (start, end) = (drift.initial(), drift.latest());
        let Kept { energy, momentum } = report.kept;
        let times: &PhaseTimes = report.times;
        let [begins, ends] = report.sensed;
        Self {
            scene,
            steps_asked: report.asked,
            simulated_seconds: report.simulated,
            summary: report.summary,
            kinetic_energy: Ends { initial: start.kinetic(), r#final: end.kinetic() },
            potential_energy: Ends { initial: start.all_potential(), r#final: end.all_potential() },
            energy_is_kept: energy,
            momentum_is_kept: momentum,
            system_seconds: systems(times).into_iter().map(|(name, time)| (name, time.as_secs_f64())).collect(),
            sensor_events: SensorEvents { begins, ends },
            record: report.record,
            report: report.page,
        }
    }

    /// One object, with a line for each key.
    pub(crate) fn text(&self) -> Result<String, Failure> {
        let text = serde_json::to_string_pretty(self);
        let text = text.map_err(|error| Failure::Running(format!("the run cannot be written as JSON: {error}")))?;
        Ok(printable_json(&text) + "\n")
    }
}
