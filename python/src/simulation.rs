//! One world.

use hecs::World;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use tumble::math::{Real, Vec3};
use tumble::{BodyOrder, ContactEvent, QueryFilter, Ray, Totals, Trial};

use crate::MODULE;
use crate::arrays::{array, finite, real, shape_of};
use crate::body_arrays::body_arrays;
use crate::error::Failure;
use crate::joints::{self, DriveQuantity, JointQuantity};
use crate::recording::Recording;
use crate::scene::Scene;
use crate::settings::{Options, Overrides, count, not_negative, refused};
use crate::snapshot::Snapshot;
use crate::state::{Layout, Property, Quantity};
use crate::threads::{Burst, ONE_THREAD, in_bursts, pool};
use crate::worlds::Worlds;

/// One world of a scene, stepped.
///
/// `scene` is a `tumble.Scene`, or what one is made of. The other arguments go in the place of what
/// it says: `dt` [s], `gravity` [m/s^2], `integrator` one of `semi-implicit-euler`,
/// `runge-kutta4` and `moser-veselov`, `sleep` whether bodies at rest are left out.
///
/// Arrays have a row for each body, in the order of `body_names`: `positions` (bodies, 3) of the
/// centres of mass [m], `orientations` (bodies, 4) as quaternions x, y, z, w from the body's frame
/// to the world's, `linear_velocities` (bodies, 3) [m/s] and `angular_velocities` (bodies, 3)
/// [rad/s], all in the world frame. `states` (bodies, 13) are these side by side. Reading makes a
/// new array; setting copies.
#[cfg_attr(not(feature = "f64"), pyclass(module = "tumble"))]
#[cfg_attr(feature = "f64", pyclass(module = "tumble.double"))]
pub(crate) struct Simulation {
    pub(crate) trial: Trial,
    pub(crate) layout: Layout,
    pub(crate) scene: Py<Scene>,
    /// Of all bursts of the last call.
    pub(crate) events: Vec<ContactEvent>,
    burst: Burst,
}

impl Simulation {
    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn worlds(&mut self) -> Worlds<'_> {
        Worlds { layout: &self.layout, trials: vec![&mut self.trial], axes: Vec::new() }
    }

    pub(crate) fn step_by(&mut self, py: Python<'_>, count: u32) -> PyResult<()> {
        let (trial, events) = (&mut self.trial, &mut self.events);
        events.clear();
        let is_small = self.layout.bodies() <= ONE_THREAD;
        let pool = if is_small { None } else { Some(pool()?) };
        in_bursts(py, &mut self.burst, count, |count, _| {
            match &pool {
                Some(pool) => pool.install(|| trial.step_many(count)),
                None => trial.step_many(count),
            }
            events.extend(trial.simulation.contact_events());
        })
    }

    fn index_of(&self, entity: hecs::Entity) -> i64 {
        let found = self.layout.entities.iter().position(|body| *body == entity);
        found.and_then(|index| i64::try_from(index).ok()).unwrap_or(-1)
    }
}

/// A vector of each row, as an array.
fn vectors<'py>(py: Python<'py>, rows: &[Vec3]) -> PyResult<Bound<'py, PyAny>> {
    array(py, rows.iter().flat_map(Vec3::to_array).collect(), &[rows.len(), 3])
}

body_arrays!(Simulation);

#[pymethods]
impl Simulation {
    #[new]
    #[pyo3(signature = (scene, *, dt=None, substeps=None, contact_substeps=None, gravity=None, integrator=None, sleep=None))]
    #[allow(clippy::too_many_arguments, reason = "they are keywords in Python")]
    fn new(
        scene: &Bound<'_, PyAny>,
        dt: Option<f64>,
        substeps: Option<i64>,
        contact_substeps: Option<i64>,
        gravity: Option<Bound<'_, PyAny>>,
        integrator: Option<String>,
        sleep: Option<bool>,
    ) -> PyResult<Self> {
        let py = scene.py();
        let overrides = Overrides::read(&Options { dt, substeps, contact_substeps, gravity, integrator, sleep })?;
        let scene = Scene::from_argument(scene)?;
        let settings = overrides.apply(scene.scene.settings)?;
        let mut world = World::new();
        scene.scene.clone().spawn(&mut world).map_err(Failure::from)?;
        let layout = Layout::of(&world, &scene.names, &scene.joint_names);
        joints::watch(&mut world, &layout.joints);
        let trial = Trial::new(settings, world).map_err(refused)?;
        Ok(Self { trial, layout, scene: Py::new(py, scene)?, events: Vec::new(), burst: Burst::default() })
    }

    /// Takes `count` steps. Other threads of Python run meanwhile, and Ctrl-C ends it between two
    /// steps.
    #[pyo3(signature = (count=1))]
    fn step(&mut self, py: Python<'_>, count: i64) -> PyResult<()> {
        let steps = self::count("count", count)?;
        self.step_by(py, steps)
    }

    /// Takes `steps` steps, as many as the scene says unless given, and keeps the start, every
    /// `every`-th state and the end. `control` is called with the simulation before each step.
    #[pyo3(signature = (steps=None, *, every=1, control=None))]
    fn record(
        this: &Bound<'_, Self>,
        steps: Option<i64>,
        every: i64,
        control: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Recording> {
        let of_scene = i64::try_from(this.try_borrow()?.scene.get().scene.steps).unwrap_or(i64::MAX);
        let steps = count("steps", steps.unwrap_or(of_scene))?;
        let every = count("every", every)?;
        if every == 0 {
            return Err(Failure::argument("every", "1 step at least").into());
        }
        Recording::of(this, steps, every, control.as_ref())
    }

    /// The scene that it was made of.
    #[getter]
    fn scene(&self, py: Python<'_>) -> Py<Scene> {
        self.scene.clone_ref(py)
    }

    /// Steps that were taken.
    #[getter]
    fn steps(&self) -> u64 {
        self.trial.simulation.steps()
    }

    /// Simulated time [s].
    #[getter]
    fn time(&self) -> f64 {
        self.trial.simulation.time()
    }

    /// Time step [s].
    #[getter]
    #[allow(clippy::useless_conversion, reason = "dt is f64 already in one of the two builds")]
    fn dt(&self) -> f64 {
        f64::from(self.trial.simulation.settings().dt)
    }

    /// Gives the chosen bodies, by names or indices, what stands there: all of it, or nothing if
    /// something is impossible. Arrays have a row for each body that is chosen. What is left out
    /// stays, the velocities of a body that is turned too.
    #[pyo3(signature = (bodies=None, *, positions=None, orientations=None, linear_velocities=None, angular_velocities=None))]
    fn set_state(
        &mut self,
        bodies: Option<&Bound<'_, PyAny>>,
        positions: Option<&Bound<'_, PyAny>>,
        orientations: Option<&Bound<'_, PyAny>>,
        linear_velocities: Option<&Bound<'_, PyAny>>,
        angular_velocities: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let given = [positions, orientations, linear_velocities, angular_velocities];
        let quantities: Vec<_> = Quantity::EACH.into_iter().zip(given).collect();
        self.worlds().set_state(bodies, &quantities)
    }

    /// Adds forces [N] and torques [N m] that act in the next step only, world frame: (chosen, 3)
    /// each. Forces act at the `points` [m], or at the centres of mass.
    #[pyo3(signature = (bodies=None, *, forces=None, torques=None, points=None))]
    fn push(
        &mut self,
        py: Python<'_>,
        bodies: Option<&Bound<'_, PyAny>>,
        forces: Option<&Bound<'_, PyAny>>,
        torques: Option<&Bound<'_, PyAny>>,
        points: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        self.worlds().push(py, bodies, forces, torques, points)
    }

    /// Sets forces [N] at the centres of mass and torques [N m] that act in all steps until they
    /// are set to others: (chosen, 3) each, in the frame `"world"` or `"body"`.
    #[pyo3(signature = (bodies=None, *, forces=None, torques=None, frame="world"))]
    fn set_forces(
        &mut self,
        py: Python<'_>,
        bodies: Option<&Bound<'_, PyAny>>,
        forces: Option<&Bound<'_, PyAny>>,
        torques: Option<&Bound<'_, PyAny>>,
        frame: &str,
    ) -> PyResult<()> {
        self.worlds().hold(py, bodies, forces, torques, frame)
    }

    /// Sets targets and greatest forces [N] [N m] of the chosen drives, by `drive_names` or
    /// indices; (chosen,) each. A position of nan is none: the velocity is kept.
    #[pyo3(signature = (drives=None, *, positions=None, velocities=None, max_forces=None))]
    fn set_drives(
        &mut self,
        drives: Option<&Bound<'_, PyAny>>,
        positions: Option<&Bound<'_, PyAny>>,
        velocities: Option<&Bound<'_, PyAny>>,
        max_forces: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let quantities = [
            (DriveQuantity::Positions, positions),
            (DriveQuantity::Velocities, velocities),
            (DriveQuantity::MaxForces, max_forces),
        ];
        self.worlds().set_drives(drives, &quantities)
    }

    /// What touched in the last step: a dict of arrays with a row for each point. `bodies` (n, 2)
    /// are indices, `points` (n, 3) [m], `normals` (n, 3) from the first body to the second,
    /// `separations` (n,) [m], `impulses` (n,) along the normals [N s] of the last substep,
    /// `substep` its length [s]: impulses divided by it are forces.
    fn contacts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (mut bodies, mut points, mut normals) = (Vec::new(), Vec::new(), Vec::new());
        let (mut separations, mut impulses) = (Vec::new(), Vec::new());
        for contact in self.trial.simulation.contacts() {
            let [first, second] = contact.bodies.map(|body| self.index_of(body));
            for point in contact.points() {
                bodies.extend([first, second]);
                points.push(point.position);
                normals.push(contact.normal);
                separations.push(point.separation);
                impulses.push(point.impulse);
            }
        }
        let count = points.len();
        let found = PyDict::new(py);
        found.set_item("bodies", PyArray1::from_vec(py, bodies).call_method1("reshape", ((count, 2),))?)?;
        found.set_item("points", vectors(py, &points)?)?;
        found.set_item("normals", vectors(py, &normals)?)?;
        found.set_item("separations", array(py, separations, &[count])?)?;
        found.set_item("impulses", array(py, impulses, &[count])?)?;
        found.set_item("substep", self.trial.simulation.settings().contact_substep())?;
        Ok(found)
    }

    /// Which bodies began and ended to touch in the last call of `step`: tuples
    /// `("begin" or "end", first body, second body)`, by names.
    fn contact_events(&self) -> Vec<(&'static str, String, String)> {
        let name = |entity| usize::try_from(self.index_of(entity)).ok().and_then(|index| self.layout.names.get(index));
        let event = |event: ContactEvent| {
            let [first, second] = event.bodies().map(|body| name(body).cloned().unwrap_or_default());
            (if matches!(event, ContactEvent::Begin(..)) { "begin" } else { "end" }, first, second)
        };
        self.events.iter().copied().map(event).collect()
    }

    /// What rays hit first, with rows for each: `origins` and `directions` (n, 3), whose lengths do
    /// not matter. A dict of `bodies` (n,), -1 for none, `distances` (n,) [m], infinite for none,
    /// `points` (n, 3) and `normals` (n, 3), nan for none.
    #[pyo3(signature = (origins, directions, max_distance=f64::INFINITY))]
    fn cast_rays<'py>(
        &self,
        py: Python<'py>,
        origins: &Bound<'py, PyAny>,
        directions: &Bound<'py, PyAny>,
        max_distance: f64,
    ) -> PyResult<Bound<'py, PyDict>> {
        let max_distance = not_negative("max_distance", max_distance)?;
        let rows_of = |value, field| -> PyResult<usize> {
            let shape = shape_of(value, field)?;
            Ok(if shape.len() == 2 { shape.first().copied().unwrap_or(0) } else { 1 })
        };
        let (from, along) = (rows_of(origins, "origins")?, rows_of(directions, "directions")?);
        let rows = if from == 1 { along } else { from };
        let vectors_of = |value: &Bound<'py, PyAny>, field| -> PyResult<Vec<Vec3>> {
            let numbers = finite(value, field, &[rows, 3])?;
            Ok(numbers.chunks(3).filter_map(|it| <[Real; 3]>::try_from(it).ok()).map(Vec3::from).collect())
        };
        let (origins, directions) = (vectors_of(origins, "origins")?, vectors_of(directions, "directions")?);
        if let Some(row) = directions.iter().position(|direction| *direction == Vec3::ZERO) {
            return Err(Failure::argument("directions", format!("row {row} is 0, and no direction")).into());
        }
        let ray = |(origin, direction): (&Vec3, &Vec3)| Ray::new(*origin, *direction).with_max_distance(max_distance);
        let rays: Vec<Ray> = origins.iter().zip(&directions).map(ray).collect();
        let (simulation, world) = (&self.trial.simulation, &self.trial.world);
        let pool = pool()?;
        let hits = py.detach(|| pool.install(|| simulation.queries(world).cast_rays(&rays, &QueryFilter::new())));
        let bodies: Vec<i64> = hits.iter().map(|hit| hit.map_or(-1, |hit| self.index_of(hit.entity))).collect();
        let distances = hits.iter().map(|hit| hit.map_or(Real::INFINITY, |hit| hit.distance)).collect();
        let none = Vec3::splat(real(f64::NAN));
        let points: Vec<Vec3> = hits.iter().map(|hit| hit.map_or(none, |hit| hit.point)).collect();
        let normals: Vec<Vec3> = hits.iter().map(|hit| hit.map_or(none, |hit| hit.normal)).collect();
        let found = PyDict::new(py);
        found.set_item("bodies", PyArray1::from_vec(py, bodies))?;
        found.set_item("distances", array(py, distances, &[rows])?)?;
        found.set_item("points", vectors(py, &points)?)?;
        found.set_item("normals", vectors(py, &normals)?)?;
        Ok(found)
    }

    /// Energy and momentum of all bodies: a dict of `linear_kinetic`, `rotational_kinetic`,
    /// `potential` of gravity and forces, `energy`, their sum [J], `linear_momentum` [kg m/s] and
    /// `angular_momentum` about the origin [kg m^2/s].
    fn totals<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let order = BodyOrder::of(&self.trial.world);
        let totals = Totals::of(&self.trial.world, self.trial.simulation.settings(), &order);
        let found = PyDict::new(py);
        found.set_item("linear_kinetic", totals.linear_kinetic)?;
        found.set_item("rotational_kinetic", totals.rotational_kinetic)?;
        found.set_item("potential", totals.all_potential())?;
        found.set_item("energy", totals.energy())?;
        found.set_item("linear_momentum", PyArray1::from_slice(py, &totals.linear_momentum.to_array()))?;
        found.set_item("angular_momentum", PyArray1::from_slice(py, &totals.angular_momentum.to_array()))?;
        Ok(found)
    }

    /// Hash of the state of all bodies, 16 hexadecimal digits, as `tumble run` prints it.
    #[getter]
    fn state_hash(&self) -> String {
        format!("{:016x}", self.trial.state_hash())
    }

    /// The state now, to go back to.
    fn snapshot(&self) -> PyResult<Snapshot> {
        let snapshot = self.trial.simulation.snapshot(&self.trial.world);
        Ok(Snapshot(snapshot.map_err(Failure::from)?))
    }

    /// Goes back to a snapshot of this scene, and on from there with the same bits.
    fn restore(&mut self, snapshot: &Bound<'_, Snapshot>) -> PyResult<()> {
        self.events.clear();
        Ok(snapshot.get().restore(&mut self.trial)?)
    }

    fn __len__(&self) -> usize {
        self.layout.bodies()
    }

    fn __repr__(&self) -> String {
        let (bodies, steps, time) = (crate::bodies(self.layout.bodies()), self.steps(), self.time());
        format!("<{MODULE}.Simulation {:?}: {bodies}, step {steps}, t = {time:.6} s>", self.scene.get().title())
    }
}
