//! What a simulation did: states and energies, and a page that replays it.

use std::time::{Duration, Instant};

use numpy::PyArray1;
use pyo3::prelude::*;
use tumble::math::PRECISION;
use tumble::{BodyOrder, Ledger, simd_name, state_hash};
use tumble_record::{Drift, Frame, Kept, Replay, ReportPage, Summary, drift_plot, energy_plot};

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

impl Recording {
    pub(crate) fn of(simulation: &mut Simulation, py: Python<'_>, steps: u32, every: u32) -> PyResult<Self> {
        let scene = simulation.scene.clone_ref(py);
        let (begun, names) = (Instant::now(), &scene.get().recorded_names);
        let mut replay = Replay::of(&scene.get().scene).map_err(Failure::from)?;
        let order = BodyOrder::of(&simulation.trial.world);
        let not_finite = |_| Failure::argument("steps", "the state of a body, or a sum over all, is not finite");
        let settings = *simulation.trial.simulation.settings();
        let mut drift = Drift::start(&simulation.trial.world, &settings, &order).map_err(not_finite)?;
        let mut ledger = Ledger::watch(&simulation.trial.world, &simulation.trial.simulation);
        let (mut numbers, mut times) = (Vec::new(), Vec::new());
        let (mut step_time, mut done) = (Duration::ZERO, 0);
        let first = simulation.trial.simulation.steps();
        let width = Quantity::States.width() * simulation.layout.bodies();
        loop {
            let (trial, from) = (&mut simulation.trial, numbers.len());
            times.push(trial.simulation.time());
            numbers.resize(from + width, 0.0);
            read(&mut trial.world, Quantity::States, numbers.get_mut(from..).unwrap_or_default());
            if done > 0 {
                drift.sample(&trial.world, &settings, &order).map_err(not_finite)?;
                ledger.record(&trial.world, &trial.simulation);
            }
            let frame = Frame { step: u64::from(done), ..Frame::of(&trial.simulation, &trial.world, &order, names) };
            if done == steps {
                replay.finish(&frame);
                break;
            }
            replay.record(&frame);
            let now = every.min(steps - done);
            let stepping = Instant::now();
            simulation.step_by(py, now)?;
            step_time += stepping.elapsed();
            done += now;
        }
        let bodies = order.len() as u64;
        let taken = simulation.trial.simulation.steps() - first;
        let seconds = step_time.as_secs_f64();
        let rate = bodies as f64 * taken as f64 / seconds;
        let summary = Summary {
            bodies,
            worlds: 1,
            steps: taken,
            dt: settings.dt,
            substeps: settings.substeps,
            integrator: settings.integrator.name().to_owned(),
            precision: PRECISION.to_owned(),
            threads: pool()?.current_num_threads() as u64,
            simd: simd_name().to_owned(),
            wall_seconds: begun.elapsed().as_secs_f64(),
            step_seconds: seconds,
            body_steps_per_second: if rate.is_finite() { rate } else { 0.0 },
            energy: drift.energy(),
            linear_momentum: drift.linear_momentum(),
            angular_momentum: drift.angular_momentum(),
            state_hash: format!("{:016x}", state_hash(&simulation.trial.world, &order)),
        };
        let kept = Kept::of(&simulation.trial.world, &settings);
        let plots = [energy_plot(ledger.entries()), drift_plot(ledger.entries(), drift.energy_scale())];
        let page = ReportPage {
            summary: &summary,
            kept,
            steps_asked: u64::from(steps),
            phases: &[],
            plots: &plots,
            replay: &replay,
        };
        let mut html = Vec::new();
        page.write(&mut html)?;
        let frames = times.len();
        Ok(Self {
            names: simulation.layout.names.clone(),
            title: scene.get().title().to_owned(),
            times,
            energies: ledger.entries().iter().map(tumble::LedgerEntry::energy).collect(),
            states: array(py, numbers, &[frames, simulation.layout.bodies(), Quantity::States.width()])?.unbind(),
            page: String::from_utf8_lossy(&html).into_owned(),
        })
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

    /// Position, orientation, velocity and angular velocity (frames, bodies, 13).
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
