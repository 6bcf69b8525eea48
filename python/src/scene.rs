//! Scenes: files, built-in ones, and models as Python has them.

use std::path::{Path, PathBuf};

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString, PyTuple};
use tumble_import::InertiaRepairs;
use tumble_scene::{BodyNames, Format, RunOverrides, SceneTemplate, builtin_scenes};

use crate::MODULE;
use crate::error::Failure;
use crate::state;

/// Bodies with their shapes, forces and joints, and what to step them with.
///
/// `scene` is the name of a built-in scene (see `tumble.scenes()`), the path of a `.json`, `.ron`,
/// `.gltf`, `.glb` or `.urdf` file, or a dict with the keys of a scene file, in which numbers and
/// lists may be NumPy's. `bodies` and `seed` are for scenes that are generated; `repair` mends the
/// inertias of a glTF or URDF file. All lengths are in metres, masses in kilograms, times in
/// seconds, angles in radians.
#[cfg_attr(not(feature = "f64"), pyclass(module = "tumble", frozen))]
#[cfg_attr(feature = "f64", pyclass(module = "tumble.double", frozen))]
#[derive(Clone)]
pub(crate) struct Scene {
    pub(crate) scene: tumble_scene::Scene,
    source: Source,
    pub(crate) names: Vec<String>,
    pub(crate) joint_names: Vec<String>,
    /// The same, for what records a run.
    pub(crate) recorded_names: BodyNames,
}

/// Where a scene comes from, which is enough to make it again.
#[derive(Clone)]
enum Source {
    Named { name: String, bodies: Option<u64>, seed: Option<u64>, repair: bool },
    Text { kind: Kind, text: String, file: String },
}

/// What a text is written in.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Json,
    Ron,
    Urdf,
}

impl Kind {
    const EACH: [(&'static str, Self); 3] = [("json", Self::Json), ("ron", Self::Ron), ("urdf", Self::Urdf)];

    fn name(self) -> &'static str {
        Self::EACH.iter().find(|(_, kind)| *kind == self).map_or("", |(name, _)| name)
    }
}

impl Source {
    fn open(&self) -> Result<tumble_scene::Scene, Failure> {
        Ok(match self {
            Self::Named { name, repair: true, .. } => {
                tumble_scene::Scene::load_with(Path::new(name), InertiaRepairs::Made)?
            }
            Self::Named { name, bodies, seed, .. } => tumble_scene::Scene::open_with(name, *bodies, *seed)?,
            Self::Text { kind: Kind::Json, text, file } => tumble_scene::Scene::from_json(text, file)?,
            Self::Text { kind: Kind::Ron, text, file } => tumble_scene::Scene::from_ron(text, file)?,
            Self::Text { kind: Kind::Urdf, text, file } => tumble_scene::Scene::from_urdf(text, file)?,
        })
    }
}

impl Scene {
    fn of(source: Source) -> PyResult<Self> {
        let scene = source.open()?;
        let mut world = hecs::World::new();
        let recorded_names = scene.clone().spawn(&mut world).map_err(Failure::from)?;
        let (names, joint_names) = state::names(&world, &recorded_names);
        Ok(Self { scene, source, names, joint_names, recorded_names })
    }

    /// The scene of an argument: one, or what one is made of.
    pub(crate) fn from_argument(argument: &Bound<'_, PyAny>) -> PyResult<Self> {
        match argument.cast::<Self>() {
            Ok(scene) => Ok(scene.get().clone()),
            Err(_) => Self::new(argument, None, None, false),
        }
    }

    /// The scene with its fields, to make worlds of that differ.
    pub(crate) fn template(&self) -> Result<SceneTemplate, Failure> {
        let overrides = RunOverrides::default();
        let refuse = |problem: &str| Err(Failure::argument("vary", problem));
        Ok(match &self.source {
            Source::Named { bodies: None, seed: None, name, repair } => {
                let repairs = if *repair { InertiaRepairs::Made } else { InertiaRepairs::Refused };
                SceneTemplate::open_with(name, overrides, repairs)?
            }
            Source::Named { .. } => return refuse("a scene with a number of bodies or a seed has no fields to vary"),
            Source::Text { kind: Kind::Json, text, file } => {
                SceneTemplate::from_text(text, Format::Json, file, overrides)?
            }
            Source::Text { kind: Kind::Ron, text, file } => {
                SceneTemplate::from_text(text, Format::Ron, file, overrides)?
            }
            Source::Text { .. } => return refuse("fields of a URDF text cannot vary; those of a file can"),
        })
    }

    /// What the scene is called.
    pub(crate) fn title(&self) -> &str {
        self.scene.name.as_deref().unwrap_or(&self.scene.origin)
    }
}

fn small(field: &str, value: Option<i64>) -> PyResult<Option<u64>> {
    let convert =
        |value: i64| u64::try_from(value).map_err(|_| Failure::argument(field, format!("{value} is negative")));
    Ok(value.map(convert).transpose()?)
}

#[pymethods]
impl Scene {
    #[new]
    #[pyo3(signature = (scene, *, bodies=None, seed=None, repair=false))]
    fn new(scene: &Bound<'_, PyAny>, bodies: Option<i64>, seed: Option<i64>, repair: bool) -> PyResult<Self> {
        let (bodies, seed) = (small("bodies", bodies)?, small("seed", seed)?);
        if let Ok(made) = scene.cast::<Self>() {
            if bodies.is_some() || seed.is_some() || repair {
                return Err(Failure::argument("scene", "bodies, seed and repair do not go with a Scene").into());
            }
            return Ok(made.get().clone());
        }
        if let Ok(model) = scene.cast::<PyDict>() {
            if bodies.is_some() || seed.is_some() || repair {
                return Err(Failure::argument("scene", "bodies, seed and repair do not go with a dict").into());
            }
            let to_json = scene.py().import("tumble._model")?.getattr("to_json")?;
            let text = to_json.call1((model,))?.extract()?;
            return Self::of(Source::Text { kind: Kind::Json, text, file: "scene".to_owned() });
        }
        if repair && (bodies.is_some() || seed.is_some()) {
            return Err(Failure::argument("repair", "does not go with bodies and seed").into());
        }
        let name = match scene.cast::<PyString>() {
            Ok(name) => name.to_str()?.to_owned(),
            Err(_) => {
                let needed = "a name, a path, a dict or a tumble.Scene is needed";
                let found = scene.get_type();
                let wrong = |_| Failure::type_of("scene", format!("{needed}, not {found}"));
                let path = scene.extract::<PathBuf>().map_err(wrong)?;
                // A path is one, whatever it is called.
                let path = if path.components().count() == 1 { Path::new(".").join(path) } else { path };
                path.to_string_lossy().into_owned()
            }
        };
        Self::of(Source::Named { name, bodies, seed, repair })
    }

    /// Reads a scene in the text of a `json`, `ron` or `urdf` file. `file` is what messages call
    /// it.
    #[staticmethod]
    #[pyo3(signature = (text, kind="json", file="scene"))]
    fn from_text(text: String, kind: &str, file: &str) -> PyResult<Self> {
        let found = Kind::EACH.iter().find(|(name, _)| *name == kind);
        let unknown = || Failure::argument("kind", format!("json, ron or urdf is needed, not {kind:?}"));
        let (_, kind) = *found.ok_or_else(unknown)?;
        Self::of(Source::Text { kind, text, file: file.to_owned() })
    }

    fn __reduce__<'py>(this: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let (py, class) = (this.py(), this.get_type());
        Ok(match &this.get().source {
            Source::Text { kind, text, file } => {
                (class.getattr("from_text")?, (text, kind.name(), file).into_pyobject(py)?)
            }
            Source::Named { name, bodies, seed, repair } => {
                let options = PyDict::new(py);
                options.set_item("bodies", bodies)?;
                options.set_item("seed", seed)?;
                options.set_item("repair", repair)?;
                let partial = py.import("functools")?.getattr("partial")?.call((class,), Some(&options))?;
                (partial, (name,).into_pyobject(py)?)
            }
        })
    }

    /// Where it comes from: the name of a built-in scene, or of a file.
    #[getter]
    fn origin(&self) -> &str {
        &self.scene.origin
    }

    /// What it is called, if it says so.
    #[getter]
    fn name(&self) -> Option<&str> {
        self.scene.name.as_deref()
    }

    /// What it shows, if it says so.
    #[getter]
    fn description(&self) -> Option<&str> {
        self.scene.description.as_deref()
    }

    /// How many steps it is to be run.
    #[getter]
    fn steps(&self) -> u64 {
        self.scene.steps
    }

    /// Time step [s].
    #[getter]
    #[allow(clippy::useless_conversion, reason = "dt is f64 already in one of the two builds")]
    fn dt(&self) -> f64 {
        f64::from(self.scene.settings.dt)
    }

    /// What was read and is not simulated, or decided where the file is silent.
    #[getter]
    fn notices(&self) -> Vec<String> {
        self.scene.notices.clone()
    }

    /// Names of the bodies, in the order of all arrays.
    #[getter]
    fn body_names(&self) -> Vec<String> {
        self.names.clone()
    }

    /// Names of the joints, in the order of all arrays.
    #[getter]
    fn joint_names(&self) -> Vec<String> {
        self.joint_names.clone()
    }

    fn __len__(&self) -> usize {
        self.scene.body_count()
    }

    fn __repr__(&self) -> String {
        let (bodies, joints) = (crate::bodies(self.names.len()), self.joint_names.len());
        let joints = match joints {
            0 => String::new(),
            1 => ", 1 joint".to_owned(),
            more => format!(", {more} joints"),
        };
        format!("<{MODULE}.Scene {:?}: {bodies}{joints}, {} steps of {:.6} s>", self.title(), self.steps(), self.dt())
    }
}

/// The built-in scenes: their names, each with what it shows.
#[pyfunction]
pub(crate) fn scenes(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let scenes = PyDict::new(py);
    for (name, about) in builtin_scenes() {
        scenes.set_item(name, about)?;
    }
    Ok(scenes)
}
