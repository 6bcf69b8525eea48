//! Many worlds of one scene.

use std::sync::{Mutex, PoisonError};

use hecs::World;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use tumble::{BodyOrder, Totals, Trial};

use crate::MODULE;
use crate::arrays::filled;
use crate::body_arrays::body_arrays;
use crate::error::Failure;
use crate::joints::{DriveQuantity, JointQuantity};
use crate::maker::{Maker, Varied};
use crate::scene::Scene;
use crate::selection::select;
use crate::settings::{Options, Overrides, count};
use crate::snapshot::Snapshot;
use crate::state::{self, Layout, Property, Quantity};
use crate::threads::{Burst, in_bursts, in_pool, pool};
use crate::worlds::Worlds;

/// Many independent worlds of one scene, stepped in parallel. Each gets the bits that it gets
/// alone.
///
/// `vary` has fields of the scene by their paths, each with a number for every world, such as
/// `{"bodies.brick.mass": masses, "gravity.1": numpy.linspace(-10, 0, worlds)}`. The other
/// arguments are those of `tumble.Simulation`.
///
/// Arrays are those of a simulation with an axis of worlds before the others: `positions` has the
/// shape (worlds, bodies, 3). Where fewer axes are given, all worlds get the same.
#[cfg_attr(not(feature = "f64"), pyclass(module = "tumble"))]
#[cfg_attr(feature = "f64", pyclass(module = "tumble.double"))]
pub(crate) struct Batch {
    batch: tumble::Batch,
    layout: Layout,
    scene: Py<Scene>,
    maker: Maker,
    burst: Burst,
}

impl Batch {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn worlds(&mut self) -> Worlds<'_> {
        let worlds = self.batch.len();
        Worlds { layout: &self.layout, trials: self.batch.trials_mut().iter_mut().collect(), axes: vec![worlds] }
    }

    /// The chosen worlds, in the order of the batch.
    fn chosen(&mut self, worlds: Option<&Bound<'_, PyAny>>) -> PyResult<Worlds<'_>> {
        let Some(worlds) = worlds.filter(|worlds| !worlds.is_none()) else { return Ok(self.worlds()) };
        let chosen = increasing(select(Some(worlds), "worlds", self.batch.len(), None)?)?;
        let mut next = chosen.iter().copied().peekable();
        let trials = self.batch.trials_mut().iter_mut().enumerate();
        let trials = trials.filter(|(index, _)| next.next_if_eq(index).is_some()).map(|(_, trial)| trial).collect();
        Ok(Worlds { layout: &self.layout, trials, axes: vec![chosen.len()] })
    }

    fn trial_mut(&mut self, world: i64) -> PyResult<&mut Trial> {
        let worlds = self.batch.len();
        let index = if world < 0 { world + worlds as i64 } else { world };
        let trial = usize::try_from(index).ok().and_then(|index| self.batch.trials_mut().get_mut(index));
        Ok(trial.ok_or_else(|| Failure::argument("world", format!("there is no {world}, of {worlds}")))?)
    }
}

/// Rows of arrays are in the order of the worlds, so the choice has to be too.
fn increasing(chosen: Vec<usize>) -> PyResult<Vec<usize>> {
    if chosen.is_sorted() {
        Ok(chosen)
    } else {
        Err(Failure::argument("worlds", "increasing indices are needed, or a mask").into())
    }
}

body_arrays!(Batch);

#[pymethods]
impl Batch {
    #[new]
    #[pyo3(signature = (scene, worlds, *, vary=None, dt=None, substeps=None, contact_substeps=None, gravity=None, integrator=None, sleep=None))]
    #[allow(clippy::too_many_arguments, reason = "they are keywords in Python")]
    fn new(
        scene: &Bound<'_, PyAny>,
        worlds: i64,
        vary: Option<&Bound<'_, PyDict>>,
        dt: Option<f64>,
        substeps: Option<i64>,
        contact_substeps: Option<i64>,
        gravity: Option<Bound<'_, PyAny>>,
        integrator: Option<String>,
        sleep: Option<bool>,
    ) -> PyResult<Self> {
        let py = scene.py();
        let overrides = Overrides::read(&Options { dt, substeps, contact_substeps, gravity, integrator, sleep })?;
        let count = usize::try_from(worlds).ok().filter(|count| (1..=MAX_WORLDS).contains(count));
        let count =
            count.ok_or_else(|| Failure::argument("worlds", format!("1 to {MAX_WORLDS} are needed, not {worlds}")))?;
        let scene = Scene::from_argument(scene)?;
        let vary = vary.filter(|vary| !vary.is_empty());
        let varied = vary.map(|vary| Varied::read(&scene, vary, count, &overrides)).transpose()?;
        let maker = Maker { overrides, varied };
        let all: Vec<usize> = (0..count).collect();
        let trials = maker.make_all(py, &scene, maker.values(), &all)?;
        let layout = match trials.first() {
            Some(first) => Layout::of(&first.world, &scene.names, &scene.joint_names),
            None => Layout::of(&World::new(), &[], &[]),
        };
        Ok(Self {
            batch: trials.into_iter().collect(),
            layout,
            scene: Py::new(py, scene)?,
            maker,
            burst: Burst::default(),
        })
    }

    /// Takes `count` steps in every world. Several steps in one call cost less than one each. With
    /// an array `out` of the shape and dtype of `states` these are written there, world by world
    /// while it is in the cache: that costs less than reading them afterwards. Other threads of
    /// Python run meanwhile, and Ctrl-C ends it between two steps.
    #[pyo3(signature = (count=1, *, out=None))]
    fn step(&mut self, py: Python<'_>, count: i64, out: Option<Bound<'_, PyAny>>) -> PyResult<()> {
        let steps = self::count("count", count)?;
        let pool = pool()?;
        let (batch, burst) = (&mut self.batch, &mut self.burst);
        let Some(out) = out else {
            return in_bursts(py, burst, steps, |count, _| pool.install(|| batch.step_many(count)));
        };
        if steps == 0 {
            return self.worlds().read_state(py, Quantity::States, Some(out)).map(drop);
        }
        let shape = [batch.len(), self.layout.bodies(), Quantity::States.width()];
        let numbers = (shape[1] * shape[2]).max(1);
        filled(py, Some(out), &shape, |to| {
            let places: Vec<_> = to.chunks_mut(numbers).map(Mutex::new).collect();
            in_bursts(py, burst, steps, |count, is_last| {
                let observe = |index: usize, trial: &mut Trial| {
                    if let Some(place) = places.get(index).filter(|_| is_last) {
                        let mut place = place.lock().unwrap_or_else(PoisonError::into_inner);
                        state::read(&mut trial.world, Quantity::States, &mut place);
                    }
                };
                pool.install(|| batch.step_many_then(count, observe));
            })
        })
        .map(drop)
    }

    /// Makes the chosen worlds again as they were at the start, by indices or a mask of booleans;
    /// with `vary` with other numbers, one for each chosen world, which stay for later resets.
    #[pyo3(signature = (worlds=None, *, vary=None))]
    fn reset(
        &mut self,
        py: Python<'_>,
        worlds: Option<&Bound<'_, PyAny>>,
        vary: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<()> {
        let chosen = increasing(select(worlds, "worlds", self.batch.len(), None)?)?;
        let values = match (vary, &self.maker.varied) {
            (None, _) => self.maker.values().to_vec(),
            (Some(vary), Some(varied)) => varied.change(vary, &chosen)?,
            (Some(_), None) => return Err(Failure::argument("vary", "the batch was made without").into()),
        };
        let made = self.maker.make_all(py, self.scene.get(), &values, &chosen)?;
        for (&world, trial) in chosen.iter().zip(made) {
            if let Some(place) = self.batch.trials_mut().get_mut(world) {
                *place = trial;
            }
        }
        if let Some(varied) = &mut self.maker.varied {
            varied.values = values;
        }
        Ok(())
    }

    /// The scene that the worlds are made of.
    #[getter]
    fn scene(&self, py: Python<'_>) -> Py<Scene> {
        self.scene.clone_ref(py)
    }

    /// Steps that each world has taken (worlds,), since it was made or reset.
    #[getter]
    fn steps<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u64>> {
        PyArray1::from_iter(py, self.batch.trials().iter().map(|trial| trial.simulation.steps()))
    }

    /// Simulated time of each world (worlds,) [s].
    #[getter]
    fn times<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_iter(py, self.batch.trials().iter().map(|trial| trial.simulation.time()))
    }

    /// As `Simulation.set_state`, in the chosen worlds: arrays are (chosen worlds, chosen bodies, 3
    /// or 4).
    #[pyo3(signature = (bodies=None, *, worlds=None, positions=None, orientations=None, linear_velocities=None, angular_velocities=None))]
    fn set_state(
        &mut self,
        bodies: Option<&Bound<'_, PyAny>>,
        worlds: Option<&Bound<'_, PyAny>>,
        positions: Option<&Bound<'_, PyAny>>,
        orientations: Option<&Bound<'_, PyAny>>,
        linear_velocities: Option<&Bound<'_, PyAny>>,
        angular_velocities: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let given = [positions, orientations, linear_velocities, angular_velocities];
        let quantities: Vec<_> = Quantity::EACH.into_iter().zip(given).collect();
        self.chosen(worlds)?.set_state(bodies, &quantities)
    }

    /// As `Simulation.push`, in the chosen worlds: (chosen worlds, chosen bodies, 3) each.
    #[pyo3(signature = (bodies=None, *, worlds=None, forces=None, torques=None, points=None))]
    fn push(
        &mut self,
        py: Python<'_>,
        bodies: Option<&Bound<'_, PyAny>>,
        worlds: Option<&Bound<'_, PyAny>>,
        forces: Option<&Bound<'_, PyAny>>,
        torques: Option<&Bound<'_, PyAny>>,
        points: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        self.chosen(worlds)?.push(py, bodies, forces, torques, points)
    }

    /// As `Simulation.set_forces`, in the chosen worlds: (chosen worlds, chosen bodies, 3) each.
    #[pyo3(signature = (bodies=None, *, worlds=None, forces=None, torques=None, frame="world"))]
    fn set_forces(
        &mut self,
        py: Python<'_>,
        bodies: Option<&Bound<'_, PyAny>>,
        worlds: Option<&Bound<'_, PyAny>>,
        forces: Option<&Bound<'_, PyAny>>,
        torques: Option<&Bound<'_, PyAny>>,
        frame: &str,
    ) -> PyResult<()> {
        self.chosen(worlds)?.hold(py, bodies, forces, torques, frame)
    }

    /// As `Simulation.set_drives`, in the chosen worlds: (chosen worlds, chosen drives) each.
    #[pyo3(signature = (drives=None, *, worlds=None, positions=None, velocities=None, max_forces=None))]
    fn set_drives(
        &mut self,
        drives: Option<&Bound<'_, PyAny>>,
        worlds: Option<&Bound<'_, PyAny>>,
        positions: Option<&Bound<'_, PyAny>>,
        velocities: Option<&Bound<'_, PyAny>>,
        max_forces: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let quantities = [
            (DriveQuantity::Positions, positions),
            (DriveQuantity::Velocities, velocities),
            (DriveQuantity::MaxForces, max_forces),
        ];
        self.chosen(worlds)?.set_drives(drives, &quantities)
    }

    /// Energy of each world (worlds,) [J]: kinetic, and the potential of gravity and of forces.
    fn energies<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let energy = |trial: &mut Trial| {
            Totals::of(&trial.world, trial.simulation.settings(), &BodyOrder::of(&trial.world)).energy()
        };
        let energies = in_pool(py, || self.batch.map(|_, trial| energy(trial)))?;
        Ok(PyArray1::from_vec(py, energies))
    }

    /// Hash of the state of each world, 16 hexadecimal digits.
    fn state_hashes(&mut self, py: Python<'_>) -> PyResult<Vec<String>> {
        in_pool(py, || self.batch.map(|_, trial| format!("{:016x}", trial.state_hash())))
    }

    /// The state of one world, to go back to, there or in another world of the scene.
    fn snapshot(&mut self, world: i64) -> PyResult<Snapshot> {
        let trial = self.trial_mut(world)?;
        let snapshot = trial.simulation.snapshot(&trial.world);
        Ok(Snapshot(snapshot.map_err(Failure::from)?))
    }

    /// Brings one world to a snapshot.
    fn restore(&mut self, world: i64, snapshot: &Bound<'_, Snapshot>) -> PyResult<()> {
        Ok(snapshot.get().restore(self.trial_mut(world)?)?)
    }

    fn __len__(&self) -> usize {
        self.batch.len()
    }

    fn __repr__(&self) -> String {
        let (worlds, bodies) = (self.batch.len(), crate::bodies(self.layout.bodies()));
        format!("<{MODULE}.Batch {:?}: {worlds} worlds of {bodies}>", self.scene.get().title())
    }
}

/// Most worlds of a batch, all of which are in memory.
const MAX_WORLDS: usize = 1_000_000;
