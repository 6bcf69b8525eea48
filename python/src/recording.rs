//! What a simulation did: states and energies, and a page that replays it.

use std::time::{Duration, Instant};

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::IntoPyDict;
use tumble::math::{PRECISION, Real};
use tumble::{BodyOrder, Ledger, Trial, simd_name, state_hash};
use tumble_record::{Drift, Frame, Kept, NotFinite, Replay, ReportPage, Summary, drift_plot, energy_plot};

use crate::MODULE;
use crate::arrays::array;
use crate::error::Failure;
use crate::simulation::Simulation;
use crate::state::{Quantity, read};
use crate::threads::pool;

/// States of all bodies along a run: `times` (frames,) [s], `states` (frames, bodies, 13) as those
/// of a simulation, `energies` (frames,) [J]. A notebook shows it as a replay.
#[cfg_attr(not(feature = "f64"), pyclass(module = "tumble", frozen))]
#[cfg_attr(feature = "f64", pyclass(module = "tumble.double", frozen))]
pub(crate) struct Recording {
    names: Vec<String>,
    title: String,
    times: Vec<f64>,
    energies: Vec<f64>,
    states: Py<PyAny>,
    page: String,
}

/// A run that is being recorded.
struct Recorder {
    begun: Instant,
    step_time: Duration,
    order: BodyOrder,
    drift: Drift,
    ledger: Ledger,
    replay: Replay,
    times: Vec<f64>,
    numbers: Vec<Real>,
}

fn not_finite(_: NotFinite) -> Failure {
    Failure::NotFinite
}

impl Recorder {
    fn start(simulation: &Simulation) -> Result<Self, Failure> {
        let Trial { simulation: clock, world } = &simulation.trial;
        let order = BodyOrder::of(world);
        Ok(Self {
            begun: Instant::now(),
            step_time: Duration::ZERO,
            drift: Drift::start(world, clock.settings(), &order).map_err(not_finite)?,
            ledger: Ledger::watch(world, clock),
            replay: Replay::of(&simulation.scene.get().scene)?,
            order,
            times: Vec::new(),
            numbers: Vec::new(),
        })
    }

    /// Keeps the state after some steps.
    fn frame(&mut self, simulation: &mut Simulation, done: u32, is_last: bool) -> Result<(), Failure> {
        let width = Quantity::States.width() * simulation.layout.bodies();
        let (Trial { simulation: clock, world }, from) = (&mut simulation.trial, self.numbers.len());
        self.times.push(clock.time());
        self.numbers.resize(from + width, 0.0);
        read(world, Quantity::States, self.numbers.get_mut(from..).unwrap_or_default());
        if done > 0 {
            self.drift.sample(world, clock.settings(), &self.order).map_err(not_finite)?;
            self.ledger.record(world, clock);
        }
        let names = &simulation.scene.get().recorded_names;
        let frame = Frame { step: u64::from(done), ..Frame::of(clock, world, &self.order, names) };
        if is_last {
            self.replay.finish(&frame);
        } else {
            self.replay.record(&frame);
        }
        Ok(())
    }

    fn summary(&self, trial: &Trial, steps: u64) -> PyResult<Summary> {
        let (settings, bodies) = (trial.simulation.settings(), self.order.len() as u64);
        let seconds = self.step_time.as_secs_f64();
        let rate = bodies as f64 * steps as f64 / seconds;
        Ok(Summary {
            bodies,
            worlds: 1,
            steps,
            dt: settings.dt,
            substeps: settings.substeps,
            integrator: settings.integrator.name().to_owned(),
            precision: PRECISION.to_owned(),
            threads: pool()?.current_num_threads() as u64,
            simd: simd_name().to_owned(),
            wall_seconds: self.begun.elapsed().as_secs_f64(),
            step_seconds: seconds,
            body_steps_per_second: if rate.is_finite() { rate } else { 0.0 },
            energy: self.drift.energy(),
            linear_momentum: self.drift.linear_momentum(),
            angular_momentum: self.drift.angular_momentum(),
            state_hash: format!("{:016x}", state_hash(&trial.world, &self.order)),
        })
    }

    fn finish(self, py: Python<'_>, simulation: &Simulation, steps: u32) -> PyResult<Recording> {
        let trial = &simulation.trial;
        let (summary, entries) = (self.summary(trial, u64::from(steps))?, self.ledger.entries());
        let page = ReportPage {
            summary: &summary,
            kept: Kept::of(&trial.world, trial.simulation.settings()),
            steps_asked: u64::from(steps),
            phases: &[],
            plots: &[energy_plot(entries), drift_plot(entries, self.drift.energy_scale())],
            replay: &self.replay,
        };
        let mut html = Vec::new();
        page.write(&mut html)?;
        let shape = [self.times.len(), simulation.layout.bodies(), Quantity::States.width()];
        Ok(Recording {
            names: simulation.layout.names.clone(),
            title: simulation.scene.get().title().to_owned(),
            energies: entries.iter().map(tumble::LedgerEntry::energy).collect(),
            times: self.times,
            states: {
                let states = array(py, self.numbers, &shape)?;
                states.call_method("setflags", (), Some(&[("write", false)].into_py_dict(py)?))?;
                states.unbind()
            },
            page: String::from_utf8_lossy(&html).into_owned(),
        })
    }
}

impl Recording {
    /// Takes steps, each after a call of `control`, which has the simulation for itself meanwhile.
    pub(crate) fn of(
        simulation: &Bound<'_, Simulation>,
        steps: u32,
        every: u32,
        control: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let py = simulation.py();
        let mut recorder = Recorder::start(&*simulation.try_borrow()?)?;
        let mut done = 0;
        recorder.frame(&mut *simulation.try_borrow_mut()?, done, steps == 0)?;
        while done < steps {
            let now = every.min(steps - done);
            for _ in 0..if control.is_some() { now } else { 1 } {
                let count = if let Some(control) = control {
                    control.call1((simulation,))?;
                    1
                } else {
                    now
                };
                let stepping = Instant::now();
                simulation.try_borrow_mut()?.step_by(py, count)?;
                recorder.step_time += stepping.elapsed();
            }
            done += now;
            recorder.frame(&mut *simulation.try_borrow_mut()?, done, done == steps)?;
        }
        recorder.finish(py, &*simulation.try_borrow()?, steps)
    }
}

#[pymethods]
impl Recording {
    /// Times (frames,) [s].
    #[getter]
    fn times<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.times)
    }

    /// Kinetic and potential energy of all bodies (frames,) [J].
    #[getter]
    fn energies<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.energies)
    }

    /// Position, orientation, velocity and angular velocity (frames, bodies, 13): read-only.
    #[getter]
    fn states(&self, py: Python<'_>) -> Py<PyAny> {
        self.states.clone_ref(py)
    }

    /// Names of the bodies, in the order of the rows.
    #[getter]
    fn body_names(&self) -> Vec<String> {
        self.names.clone()
    }

    /// The report with figures, plots and a replay: one page that loads nothing from elsewhere.
    fn html(&self) -> &str {
        &self.page
    }

    fn _repr_html_(&self) -> String {
        let page = self.page.replace('&', "&amp;").replace('"', "&quot;");
        format!("<iframe srcdoc=\"{page}\" style=\"width:100%;height:640px;border:0\"></iframe>")
    }

    fn __len__(&self) -> usize {
        self.times.len()
    }

    fn __repr__(&self) -> String {
        let (frames, end) = (self.times.len(), self.times.last().copied().unwrap_or_default());
        format!("<{MODULE}.Recording of {:?}: {frames} frames to t = {end:.6} s>", self.title)
    }
}
