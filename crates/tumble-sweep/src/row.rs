//! One world of a sweep: run, and what became of it as a line of CSV.

use std::fmt::Write as _;
use std::time::{Duration, Instant};

use tumble::math::Real;
use tumble::{BodyOrder, Pose, Trial, Velocity};
use tumble_record::{Drift, STATE_COLUMNS, csv_cell, state_numbers};
use tumble_scene::VariedWorld;

use crate::observation::Observation;
use crate::run_status::RunStatus;
use crate::series::Series;
use crate::sweep::Sweep;

/// Between two questions whether to stop, unless a single step takes longer.
const UNINTERRUPTED: Duration = Duration::from_millis(50);

/// What became of one world.
///
/// ```
/// use tumble_sweep::{RunStatus, Sweep, SweepPlan};
///
/// let plan = SweepPlan { scene: "t-handle".into(), worlds: Some(1), ..SweepPlan::default() };
/// let row = Sweep::new(plan)?.row(0, &|| false).expect("nothing stops it");
/// assert_eq!((row.outcome, row.series.as_str()), (RunStatus::Ok, ""));
/// assert!(row.text.starts_with("0,ok,") && row.text.ends_with('\n'));
/// # Ok::<(), tumble_sweep::SweepError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Row {
    /// Its line of the file, with the line's end.
    pub text: String,
    /// How it ended.
    pub outcome: RunStatus,
    /// The lines of its time series; empty where there is none.
    pub series: String,
}

/// The end of a world that was run.
struct End {
    steps: u64,
    time: f64,
    states: Vec<[Real; STATE_COLUMNS.len()]>,
    energy: f64,
    drift: f64,
    hash: u64,
    seen: Vec<Option<f64>>,
}

impl Sweep {
    /// The names of the columns of a row.
    #[must_use]
    pub fn columns(&self) -> Vec<String> {
        let mut columns = vec!["world".to_owned()];
        columns.extend(self.fields().map(str::to_owned));
        columns.extend(["outcome", "steps_taken", "time"].map(str::to_owned));
        columns.extend(
            self.reported_names()
                .iter()
                .flat_map(|name| STATE_COLUMNS.map(|of| csv_cell(&format!("{name}.{of}")).into_owned())),
        );
        columns.extend(["energy", "energy_drift", "hash"].map(str::to_owned));
        columns.extend(self.plan().observe.iter().map(|what| csv_cell(what).into_owned()));
        columns
    }

    /// Runs a world; `None` if `stop` said so before its end. It is asked before each step or,
    /// where steps are short, about every 50 ms.
    ///
    /// The index may be past the last world: grids start over, and the rest is drawn as ever.
    #[must_use]
    pub fn row(&self, world: u64, stop: &(dyn Fn() -> bool + Sync)) -> Option<Row> {
        let drawn = self.draw(world);
        let mut series = String::new();
        let (outcome, end) = match self.build(&drawn) {
            Ok(varied) => match run(self, (world, varied), stop, &mut series)? {
                Ok(end) => (RunStatus::Ok, Some(end)),
                Err(()) => (RunStatus::NotFinite, None),
            },
            Err(_) => (RunStatus::Impossible, None),
        };
        let mut text = world.to_string();
        for value in drawn {
            put(&mut text, format_args!(",{value:?}"));
        }
        put(&mut text, format_args!(",{}", outcome.name()));
        if series.is_empty() && self.plan().series.is_some() {
            series = Series::of_impossible(world);
        }
        let empty = 5 + STATE_COLUMNS.len() * self.reported().len() + self.observables().len();
        match end {
            Some(end) => end.write(&mut text),
            // The columns are there, with nothing in them.
            None => text.extend(std::iter::repeat_n(',', empty)),
        }
        text.push('\n');
        Some(Row { text, outcome, series })
    }
}

/// The end of a world, or an error if it is not finite; `lines` are those of its time series.
fn run(
    sweep: &Sweep,
    (index, world): (u64, VariedWorld),
    stop: &(dyn Fn() -> bool + Sync),
    lines: &mut String,
) -> Option<Result<End, ()>> {
    let VariedWorld { mut trial, steps } = world;
    let order = BodyOrder::of(&trial.world);
    let Ok(mut drift) = Drift::start(&trial.world, trial.simulation.settings(), &order) else { return Some(Err(())) };
    let mut observation = Observation::start(sweep.observables(), sweep.until(), &trial, &order);
    let mut series = Series::start(sweep, index, &trial, &order);
    all_steps(&mut trial, steps, stop, (&mut observation, series.as_mut()), &order)?;
    if let Some(series) = series {
        *lines = series.finish(&trial, &order);
    }
    if drift.sample(&trial.world, trial.simulation.settings(), &order).is_err() {
        return Some(Err(()));
    }
    let energy = drift.energy();
    Some(Ok(End {
        steps: trial.simulation.steps(),
        time: trial.simulation.time(),
        states: sweep.reported().iter().filter_map(|&body| state(&trial, *order.entities().get(body)?)).collect(),
        energy: energy.r#final,
        drift: energy.max_relative_drift,
        hash: tumble::state_hash(&trial.world, &order),
        seen: observation.seen(),
    }))
}

/// Takes all steps, as many at once as fill the time between two questions whether to stop; `None`
/// if so.
fn all_steps(
    trial: &mut Trial,
    steps: u64,
    stop: &(dyn Fn() -> bool + Sync),
    (observation, mut series): (&mut Observation<'_>, Option<&mut Series>),
    order: &BodyOrder,
) -> Option<()> {
    let mut at_once = 1_u32;
    while trial.simulation.steps() < steps {
        if stop() {
            return None;
        }
        if observation.needs_every_step() || series.is_some() {
            trial.step_many(1);
            if let Some(series) = &mut series {
                series.see(trial, order);
            }
            if observation.see(trial, order) {
                break;
            }
            continue;
        }
        let left = u32::try_from(steps - trial.simulation.steps()).unwrap_or(u32::MAX);
        let begun = Instant::now();
        trial.step_many(at_once.min(left));
        let taken = begun.elapsed();
        if taken < UNINTERRUPTED / 2 {
            at_once = at_once.saturating_mul(2);
        } else if taken > UNINTERRUPTED {
            at_once = (at_once / 2).max(1);
        }
    }
    Some(())
}

fn state(trial: &Trial, body: tumble::hecs::Entity) -> Option<[Real; STATE_COLUMNS.len()]> {
    let body = trial.world.entity(body).ok()?;
    let (pose, velocity) = (body.get::<&Pose>()?, body.get::<&Velocity>());
    Some(state_numbers(&pose, velocity.as_deref()))
}

impl End {
    /// The fewest digits that read back to the same bits.
    fn write(&self, text: &mut String) {
        put(text, format_args!(",{},{:?}", self.steps, self.time));
        for number in self.states.iter().flatten() {
            put(text, format_args!(",{number:?}"));
        }
        put(text, format_args!(",{:?},{:?},{:016x}", self.energy, self.drift, self.hash));
        for seen in &self.seen {
            match seen {
                Some(seen) => put(text, format_args!(",{seen:?}")),
                None => text.push(','),
            }
        }
    }
}

fn put(text: &mut String, what: std::fmt::Arguments<'_>) {
    // Writing to a string cannot fail.
    let _ = text.write_fmt(what);
}
