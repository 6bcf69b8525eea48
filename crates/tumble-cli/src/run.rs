//! `tumble run`.

use std::path::Path;
use std::time::{Duration, Instant};

use hecs::World;
use rayon::{ThreadPool, ThreadPoolBuilder};
use tumble::math::PRECISION;
use tumble::{BodyId, BodyOrder, PhaseTimes, Simulation, simd_name, state_hash};
use tumble_import::InertiaRepairs;
use tumble_record::{Drift, Frame, Kept, NotFinite, Replay, Summary};
use tumble_scene::{BodyNames, Scene, steps_of_duration};

use crate::failure::Failure;
use crate::first_run::{self, FirstRun};
use crate::history::History;
use crate::inspect::{REPAIR, is_repairable};
use crate::interval::interval;
use crate::options::{RunOptions, StepOptions};
use crate::outputs::{Findings, Outputs};
use crate::progress::Progress;
use crate::resolution::TooLong;
use crate::run_json::RunJson;
use crate::table::{Report, heading};
use crate::{interrupt, print};

/// Between two looks at the clock, at Ctrl-C and at the progress bar.
const BURST: Duration = Duration::from_millis(50);

/// What a run writes to standard output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum OutputForm {
    Table,
    /// In plain words, with what to try next.
    Words,
    Json,
}

impl OutputForm {
    /// Of `tumble run`.
    pub(crate) fn of(options: &RunOptions) -> Self {
        if options.json { Self::Json } else { Self::Table }
    }
}

/// Runs a scene, records and reports.
pub(crate) fn run(options: &RunOptions, form: OutputForm) -> Result<(), Failure> {
    let scene = scene(options)?;
    if !options.quiet {
        print::notices(&scene.notices);
    } else {
        scene.left_out.iter().for_each(|error| print::error(&format_args!("left out: {error}")));
    }
    let steps = steps(options, &scene)?;
    check_simd()?;
    let bodies = scene.body_count() as u64;
    let pool = pool(&options.stepping)?;
    // First, so that a Ctrl-C from here on leaves no unfinished files.
    interrupt::watch()?;
    let outputs = Outputs::open(options, &scene, steps)?;
    let simulation = Simulation::new(scene.settings).map_err(|error| Failure::Input(error.to_string()))?;
    let replay = options.report.as_ref().map(|_| Replay::of(&scene)).transpose()?;
    let mut world = World::new();
    let names = scene.spawn(&mut world)?;
    let too_long = TooLong::of(&world, simulation.settings(), &names);
    warn(too_long.as_ref(), options);
    let history = options.report.is_some().then(|| History::open(&mut world, &simulation, bodies, steps));
    let run = Run {
        order: BodyOrder::of(&world),
        is_warned: too_long.is_some(),
        kept: Kept::of(&world, simulation.settings()),
        world,
        names,
        history,
        replay,
        simulation,
        outputs,
        progress: Progress::start(bodies, steps, options.quiet),
        times: PhaseTimes::default(),
        step_time: Duration::ZERO,
        sensed: [0; 2],
        every: options.every.map_or(1, std::num::NonZero::get),
    };
    pool.install(|| run.complete((options, form), bodies, steps, pool.current_num_threads() as u64))
}

/// The instruction set that the environment asks for, if any, is to be the one that runs: a figure
/// must not be another's.
pub(crate) fn check_simd() -> Result<(), Failure> {
    match std::env::var("TUMBLE_SIMD") {
        Ok(wanted) if wanted != simd_name() => Err(Failure::Input(format!(
            "TUMBLE_SIMD={wanted} is not to be had, this machine would run {}; there are scalar, baseline and, on x86-64, avx2 and avx512",
            simd_name()
        ))),
        _ => Ok(()),
    }
}

/// The scene with the options applied.
fn scene(options: &RunOptions) -> Result<Scene, Failure> {
    let name = scene_name(options);
    let mut scene = match options.repair {
        false => Scene::open_with(name, options.bodies, options.seed)?,
        true if is_repairable(name) => Scene::load_with(Path::new(name), InertiaRepairs::Made)?,
        true => return Err(Failure::Input(format!("{REPAIR}, not with {name:?}"))),
    };
    if let Some(dt) = options.stepping.dt {
        scene.settings.dt = dt;
    }
    if let Some(substeps) = options.stepping.substeps {
        scene.settings.substeps = substeps;
    }
    if let Some(integrator) = options.stepping.integrator {
        scene.settings.integrator = integrator;
    }
    Ok(scene)
}

fn scene_name(options: &RunOptions) -> &str {
    options.scene.as_deref().unwrap_or("stress")
}

fn steps(options: &RunOptions, scene: &Scene) -> Result<u64, Failure> {
    let Some(seconds) = options.stepping.duration else { return Ok(options.stepping.steps.unwrap_or(scene.steps)) };
    let steps = steps_of_duration(seconds, scene.settings.dt);
    steps.map_err(|problem| Failure::Input(format!("--duration {problem}")))
}

pub(crate) fn pool(options: &StepOptions) -> Result<ThreadPool, Failure> {
    pool_of(options.threads)
}

/// A pool of as many threads, or of one for each core.
pub(crate) fn pool_of(threads: Option<u64>) -> Result<ThreadPool, Failure> {
    // Zero lets rayon choose.
    let threads = threads.and_then(|threads| usize::try_from(threads).ok()).unwrap_or(0);
    ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|error| Failure::Running(format!("cannot start {threads} threads: {error}")))
}

fn warn(too_long: Option<&TooLong>, options: &RunOptions) {
    if let Some(too_long) = too_long.filter(|_| !options.quiet) {
        print::warning(too_long);
    }
}

struct Run {
    order: BodyOrder,
    /// Whether the step was found too long at the start.
    is_warned: bool,
    kept: Kept,
    world: World,
    names: BodyNames,
    history: Option<History>,
    replay: Option<Replay>,
    simulation: Simulation,
    outputs: Outputs,
    progress: Progress,
    times: PhaseTimes,
    step_time: Duration,
    /// How often a body came into a sensor, and left one.
    sensed: [u64; 2],
    every: u64,
}

impl Run {
    fn complete(
        mut self,
        (options, form): (&RunOptions, OutputForm),
        bodies: u64,
        steps: u64,
        threads: u64,
    ) -> Result<(), Failure> {
        let started = Instant::now();
        let stepped = self.all_steps(interval(bodies, steps), steps);
        let wall_time = started.elapsed();
        let drift = match stepped {
            Ok(drift) => drift,
            Err(Stopped::Failed(failure)) => return Err(failure),
            Err(Stopped::NotFinite(what)) => {
                let failure = self.not_finite(&what);
                // The way there is worth a look, but its sums mean nothing.
                self.outputs.finish(None)?;
                return Err(failure);
            }
        };
        self.progress.end();
        if let Some(replay) = &mut self.replay {
            replay.finish(&Frame::of(&self.simulation, &self.world, &self.order, &self.names));
        }
        let summary = self.summary(&drift, wall_time, bodies, threads);
        let (history, replay) = (self.history.as_ref(), self.replay.as_ref());
        self.outputs.finish(Some(Findings {
            summary: &summary,
            drift: &drift,
            kept: self.kept,
            asked: steps,
            history,
            replay,
            times: &self.times,
        }))?;
        let interrupted = summary.steps < steps;
        if !self.is_warned {
            // What was slow at the start may be fast now.
            warn(TooLong::of(&self.world, self.simulation.settings(), &self.names).as_ref(), options);
        }
        let page = options.report.as_ref().map(|directory| directory.join("report.html"));
        let report = Report {
            summary: &summary,
            drift: &drift,
            kept: self.kept,
            times: &self.times,
            simulated: self.simulation.time(),
            asked: steps,
            sensed: self.sensed,
            record: options.record.as_deref(),
            page: page.as_deref(),
        };
        if !options.quiet {
            // The words are for a whole run.
            let form = if interrupted && form == OutputForm::Words { OutputForm::Table } else { form };
            show_report(&report, options, form)?;
        }
        if interrupted {
            return Err(Failure::Interrupted);
        }
        if let Some(page) = page.filter(|_| options.open) {
            open_page(&page);
        }
        Ok(())
    }

    fn summary(&self, drift: &Drift, wall_time: Duration, bodies: u64, threads: u64) -> Summary {
        Summary {
            bodies,
            worlds: 1,
            steps: self.simulation.steps(),
            dt: self.simulation.settings().dt,
            substeps: self.simulation.settings().substeps,
            integrator: self.simulation.settings().integrator.name().to_owned(),
            precision: PRECISION.to_owned(),
            threads,
            simd: simd_name().to_owned(),
            wall_seconds: wall_time.as_secs_f64(),
            step_seconds: self.step_time.as_secs_f64(),
            body_steps_per_second: rate(bodies, self.simulation.steps(), self.step_time),
            energy: drift.energy(),
            linear_momentum: drift.linear_momentum(),
            angular_momentum: drift.angular_momentum(),
            state_hash: format!("{:016x}", state_hash(&self.world, &self.order)),
        }
    }

    /// Steps, records and samples until all steps are done or Ctrl-C came.
    fn all_steps(&mut self, interval: u64, steps: u64) -> Result<Drift, Stopped> {
        self.show();
        self.record()?;
        let mut drift = Drift::start(&self.world, self.simulation.settings(), &self.order)?;
        while self.simulation.steps() < steps && !interrupt::asked() {
            let done = self.simulation.steps();
            let next = |every: u64| (done / every + 1).saturating_mul(every);
            self.burst(steps.min(next(interval)).min(next(self.every)));
            let done = self.simulation.steps();
            if done.is_multiple_of(self.every) {
                self.record()?;
            } else {
                self.outputs.keep_pace()?;
            }
            if done.is_multiple_of(interval) {
                self.sample(&mut drift)?;
            }
            self.progress.at(done);
        }
        if !self.simulation.steps().is_multiple_of(interval) {
            self.sample(&mut drift)?;
        }
        Ok(drift)
    }

    fn sample(&mut self, drift: &mut Drift) -> Result<(), NotFinite> {
        drift.sample(&self.world, self.simulation.settings(), &self.order)?;
        if let Some(history) = &mut self.history {
            history.record(&self.world, &self.simulation);
        }
        Ok(())
    }

    /// Steps to the given number, or for as long as a burst lasts, and shows what is to be shown on
    /// the way.
    fn burst(&mut self, until: u64) {
        let started = Instant::now();
        while self.simulation.steps() < until && started.elapsed() <= BURST {
            let every = self.replay.as_ref().map_or(u64::MAX, Replay::every);
            let shown = (self.simulation.steps() / every + 1).saturating_mul(every);
            while self.simulation.steps() < until.min(shown) && started.elapsed() <= BURST {
                // Only what is inside the steps counts as their time.
                let stepping = Instant::now();
                self.simulation.step_timed(&mut self.world, &self.times);
                self.step_time += stepping.elapsed();
                for event in self.simulation.sensor_events() {
                    self.sensed[usize::from(!event.begins)] += 1;
                }
            }
            self.show();
        }
    }

    fn record(&mut self) -> Result<(), Failure> {
        self.outputs.record(&Frame::of(&self.simulation, &self.world, &self.order, &self.names))
    }

    /// Keeps a frame for the report's replay, if it is the step's turn.
    fn show(&mut self) {
        if let Some(replay) = &mut self.replay {
            replay.record(&Frame::of(&self.simulation, &self.world, &self.order, &self.names));
        }
    }

    fn not_finite(&self, what: &NotFinite) -> Failure {
        let step = self.simulation.steps();
        let what = match *what {
            NotFinite::Total => "the total energy or momentum".to_owned(),
            NotFinite::Body(entity) => match self.world.get::<&BodyId>(entity) {
                Ok(id) => format!("body {:?} (bodies[{}])", self.names.of(id.0), id.0),
                Err(_) => "a body".to_owned(),
            },
        };
        Failure::Running(format!("{what} is not finite after step {step}; the run ends there"))
    }
}

fn show_report(report: &Report<'_>, options: &RunOptions, form: OutputForm) -> Result<(), Failure> {
    match form {
        OutputForm::Table => print::output_with(&report.to_string(), heading),
        OutputForm::Words => {
            let (summary, simulated) = (report.summary, report.simulated);
            print::output_with(&FirstRun { summary, simulated }.to_string(), first_run::heading)
        }
        OutputForm::Json => print::output(&RunJson::new(scene_name(options), report).text()?),
    }
}

/// Shows a page in the user's browser; where there is none, says where the page is.
fn open_page(page: &Path) {
    if let Err(error) = open::that_detached(page) {
        print::warning(&format_args!("{} is written, but no browser could be started: {error}", page.display()));
    }
}

/// Why the steps were not all done, other than by Ctrl-C.
enum Stopped {
    Failed(Failure),
    NotFinite(NotFinite),
}

impl From<Failure> for Stopped {
    fn from(failure: Failure) -> Self {
        Self::Failed(failure)
    }
}

impl From<NotFinite> for Stopped {
    fn from(what: NotFinite) -> Self {
        Self::NotFinite(what)
    }
}

/// Body-steps per second; 0 where nothing was done.
fn rate(bodies: u64, steps: u64, time: Duration) -> f64 {
    let rate = bodies as f64 * steps as f64 / time.as_secs_f64();
    if rate.is_finite() { rate } else { 0.0 }
}
