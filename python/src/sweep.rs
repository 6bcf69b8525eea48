//! Sweeps: the rows of a scene's worlds, and the file that they are written to.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use pyo3::prelude::*;
use pyo3::types::PyBytes;
use rayon::prelude::*;
use tumble::math::Real;
use tumble_scene::RunLength;
use tumble_sweep::{Row, RunStatus, Sweep, SweepFile, SweepIdentity, SweepParameter, SweepPlan};

use crate::error::Failure;
use crate::settings::count;
use crate::threads::pool;

/// What `tumble.Sweep` is made of: worlds by their index.
#[pyclass(frozen)]
pub(crate) struct SweepCore {
    sweep: Sweep,
}

/// Between two looks for a Ctrl-C.
const PATIENCE: Duration = Duration::from_millis(50);

fn parameter(text: &str) -> Result<SweepParameter, Failure> {
    text.parse().map_err(|error| Failure::argument("vary", format!("{error}")))
}

fn length(steps: Option<u64>, duration: Option<f64>) -> Result<Option<RunLength>, Failure> {
    match (steps, duration) {
        (Some(_), Some(_)) => Err(Failure::argument("duration", "does not go with steps")),
        (Some(steps), None) => {
            let steps = tumble_scene::step_count(steps).map_err(|problem| Failure::argument("steps", problem))?;
            Ok(Some(RunLength::Steps(steps)))
        }
        (None, Some(seconds)) if seconds.is_finite() && seconds >= 0.0 => Ok(Some(RunLength::Duration(seconds))),
        (None, Some(seconds)) => Err(Failure::argument("duration", format!("{seconds} is no time"))),
        (None, None) => Ok(None),
    }
}

#[pymethods]
impl SweepCore {
    #[new]
    #[pyo3(signature = (*, scene, vary, worlds, seed, bodies, steps, duration, dt, substeps, integrator, observe, until, repair))]
    #[allow(clippy::too_many_arguments, reason = "they are keywords in Python")]
    fn new(
        scene: String,
        vary: Vec<String>,
        worlds: Option<u64>,
        seed: u64,
        bodies: Vec<String>,
        steps: Option<u64>,
        duration: Option<f64>,
        dt: Option<f64>,
        substeps: Option<i64>,
        integrator: Option<&str>,
        observe: Vec<String>,
        until: Option<String>,
        repair: bool,
    ) -> PyResult<Self> {
        let dt: Option<Real> =
            dt.map(tumble_scene::time_step).transpose().map_err(|problem| Failure::argument("dt", problem))?;
        let parsed = integrator.map(str::parse).transpose();
        let integrator = parsed.map_err(|error| Failure::argument("integrator", format!("{error}")))?;
        let plan = SweepPlan {
            scene,
            worlds,
            seed,
            vary: vary.iter().map(|text| parameter(text)).collect::<Result<_, _>>()?,
            length: length(steps, duration)?,
            dt,
            substeps: substeps.map(|substeps| count("substeps", substeps)).transpose()?,
            integrator,
            bodies,
            observe,
            until,
            series: None,
            repair,
        };
        Ok(Self { sweep: Sweep::new(plan).map_err(Failure::from)? })
    }

    /// How many worlds there are.
    #[getter]
    fn worlds(&self) -> u64 {
        self.sweep.worlds()
    }

    /// Names of the columns.
    #[getter]
    fn columns(&self) -> Vec<String> {
        self.sweep.columns()
    }

    /// What tells it from others: all that its rows depend on.
    #[getter]
    fn identity(&self) -> String {
        format!("{:?}", SweepIdentity::new(&self.sweep, None))
    }

    /// Runs the worlds from `start` to `stop` and gives their lines.
    fn rows<'py>(&self, py: Python<'py>, start: u64, stop: u64) -> PyResult<Bound<'py, PyBytes>> {
        if start > stop || stop > self.sweep.worlds() {
            let problem = format!("worlds {start} to {stop} are not among {}", self.sweep.worlds());
            return Err(Failure::argument("stop", problem).into());
        }
        let (pool, is_over) = (pool()?, AtomicBool::new(false));
        let over = || is_over.load(Ordering::Relaxed);
        let run = || (start..stop).into_par_iter().map(|world| self.sweep.row(world, &over)).collect();
        let rows = interruptible(py, &is_over, || pool.install(run))?;
        let rows: Option<Vec<Row>> = rows;
        let lines: String = rows.unwrap_or_default().into_iter().map(|row| row.text).collect();
        Ok(PyBytes::new(py, lines.as_bytes()))
    }
}

/// Calls `work` in a thread of its own, and ends it early on Ctrl-C.
fn interruptible<R: Send>(py: Python<'_>, is_over: &AtomicBool, work: impl FnOnce() -> R + Send) -> PyResult<R> {
    std::thread::scope(|scope| {
        let working = scope.spawn(work);
        loop {
            py.detach(|| {
                let begun = std::time::Instant::now();
                while !working.is_finished() && begun.elapsed() < PATIENCE {
                    std::thread::sleep(Duration::from_millis(1));
                }
            });
            if working.is_finished() {
                break;
            }
            if let Err(interrupt) = py.check_signals() {
                is_over.store(true, Ordering::Relaxed);
                drop(py.detach(|| working.join()));
                return Err(interrupt);
            }
        }
        working.join().or_else(|panic| std::panic::resume_unwind(panic))
    })
}

/// The file of a sweep, which goes on where it ended.
#[pyclass]
pub(crate) struct SweepWriter {
    file: Option<SweepFile>,
    next: u64,
}

#[pymethods]
impl SweepWriter {
    #[new]
    fn new(path: PathBuf, sweep: &Bound<'_, SweepCore>) -> PyResult<Self> {
        let sweep = &sweep.get().sweep;
        let identity = SweepIdentity::new(sweep, None);
        let file = SweepFile::open(&path, &identity, &sweep.columns()).map_err(Failure::from)?;
        Ok(Self { next: file.first_missing_world(), file: Some(file) })
    }

    /// The first world that has no row.
    #[getter]
    fn next_world(&self) -> u64 {
        self.next
    }

    /// Appends the lines of the next worlds.
    fn append(&mut self, py: Python<'_>, lines: &[u8], worlds: u64) -> PyResult<()> {
        let text = str::from_utf8(lines).ok().filter(|text| text.lines().count() as u64 == worlds);
        let text = text.ok_or_else(|| Failure::argument("lines", format!("{worlds} whole lines are needed")))?;
        let row = Row { text: text.to_owned(), outcome: RunStatus::Ok, series: String::new() };
        let closed = || Failure::argument("lines", "the file is closed");
        let file = self.file.as_mut().ok_or_else(closed)?;
        py.detach(|| file.append(&row)).map_err(Failure::from)?;
        self.next += worlds;
        Ok(())
    }

    /// Waits until all is on the disk, and closes the file.
    fn close(&mut self, py: Python<'_>) -> PyResult<()> {
        match self.file.take() {
            Some(file) => Ok(py.detach(|| file.finish()).map_err(Failure::from)?),
            None => Ok(()),
        }
    }
}
