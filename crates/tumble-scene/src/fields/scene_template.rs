//! A scene whose fields are found by their paths, before worlds are made of it.

use std::path::{Path, PathBuf};

use tumble::Integrator;
use tumble::math::Real;
use tumble_import::{FieldError, InertiaRepairs, MAX_FILE_BYTES, MeshFormat, one_line, read_bytes, read_text};

use crate::bodies::scene_body::SceneBody;
use crate::bodies::scene_joints::SceneJoints;
use crate::builtin::contact_scenes;
use crate::error::{SceneError, invalid};
use crate::fields::field_path::{FieldPath, Owner};
use crate::fields::file_scene::FileScene;
use crate::fields::varied_scene::VariedScene;
use crate::model::parse::{Format, parse};
use crate::model::scene_model::SceneModel;
use crate::scene::settings::settings;
use crate::scene::{Scene, is_path, is_urdf, unknown};
use crate::values::checked::double_vector;
use crate::values::tuple::Tuple;
use crate::{builtin, convert};

/// How long a world is run.
///
/// ```
/// use tumble_scene::{RunLength, RunOverrides, SceneTemplate};
///
/// let overrides = RunOverrides { length: Some(RunLength::Steps(50)), ..RunOverrides::default() };
/// let scene = SceneTemplate::open("t-handle", overrides)?.varied(Vec::new());
/// assert_eq!(scene.build(&[])?.steps, 50);
/// # Ok::<(), tumble_scene::SceneError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RunLength {
    /// Number of steps.
    Steps(u64),
    /// This much simulated time \[s\], rounded to whole steps of the world's own length.
    Duration(f64),
}

/// What to run a scene with instead of what it says.
///
/// ```
/// use tumble_scene::{RunOverrides, SceneTemplate};
///
/// let overrides = RunOverrides { dt: Some(0.25), ..RunOverrides::default() };
/// let scene = SceneTemplate::open("t-handle", overrides)?.varied(Vec::new());
/// assert_eq!(scene.build(&[])?.trial.simulation.settings().dt, 0.25);
/// # Ok::<(), tumble_scene::SceneError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RunOverrides {
    /// How long to run.
    pub length: Option<RunLength>,
    /// Step \[s\].
    pub dt: Option<Real>,
    /// Substeps.
    pub substeps: Option<u32>,
    /// Integrator.
    pub integrator: Option<Integrator>,
}

/// A scene that has been read and checked, whose numbers go by their paths in the file:
/// `gravity.1`, `dt`, `bodies.0.mass`, `bodies.brick.angular_velocity.2`,
/// `bodies.0.shape.cuboid.half_extents.0`, `joints.elbow.drives.0.stiffness`. Bodies and joints go
/// by index or name, and `bodies[0]` is understood too.
///
/// ```
/// use tumble_scene::{RunOverrides, SceneTemplate};
///
/// let scene = SceneTemplate::open("t-handle", RunOverrides::default())?;
/// let spin = scene.field("bodies.0.angular_velocity.1")?;
/// let scene = scene.varied(vec![spin]);
/// scene.build(&[5.0])?.trial.step_many(10);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct SceneTemplate {
    pub(crate) origin: String,
    pub(crate) overrides: RunOverrides,
    pub(crate) model: SceneModel,
    pub(crate) bodies: Vec<SceneBody>,
    pub(crate) joints: SceneJoints,
    /// Of a glTF or URDF file.
    pub(crate) of_file: Option<FileScene>,
    hash: u64,
    files: Vec<PathBuf>,
}

impl SceneTemplate {
    /// Opens a file or a built-in scene; names as in [`Scene::open`].
    ///
    /// # Errors
    /// [`SceneError`], whose message names file, body and field;
    /// [`Generated`](SceneError::Generated) for a scene that has no fields. A glTF file of which
    /// [`Scene::open`] leaves a body out is refused.
    pub fn open(name_or_path: &str, overrides: RunOverrides) -> Result<Self, SceneError> {
        Self::open_with(name_or_path, overrides, InertiaRepairs::Refused)
    }

    /// As [`open`](Self::open), where moments of inertia may be repaired as by
    /// [`Scene::load_with`].
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub fn open_with(name_or_path: &str, overrides: RunOverrides, repairs: InertiaRepairs) -> Result<Self, SceneError> {
        let path = Path::new(name_or_path);
        if is_path(name_or_path) && (MeshFormat::of_path(path) == Some(MeshFormat::Gltf) || is_urdf(path)) {
            return Self::of_file(Scene::load_with(path, repairs)?, overrides);
        }
        let (model, text_hash) = scene_model(name_or_path)?;
        let own_file = is_path(name_or_path).then(|| PathBuf::from(name_or_path));
        Self::of_model(model, text_hash, name_or_path, own_file, overrides)
    }

    /// Reads a scene from text; `file` is what messages call it, and beside it are its meshes.
    ///
    /// ```
    /// use tumble_scene::{Format, RunOverrides, SceneTemplate};
    ///
    /// let text = r#"{ "bodies": [ { "name": "stone", "shape": "point", "mass": 2 } ] }"#;
    /// let overrides = RunOverrides::default();
    /// let scene = SceneTemplate::from_text(text, Format::Json, "stone.json", overrides)?;
    /// let mass = scene.field("bodies.stone.mass")?;
    /// assert!(scene.varied(vec![mass]).build(&[3.0]).is_ok());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`SceneError`], whose message names file, body and field.
    pub fn from_text(text: &str, format: Format, file: &str, overrides: RunOverrides) -> Result<Self, SceneError> {
        let model = parse(text, format, file)?;
        Self::of_model(model, fnv1a(FNV_BASIS, text.as_bytes()), file, None, overrides)
    }

    fn of_model(
        mut model: SceneModel,
        text_hash: u64,
        name: &str,
        own_file: Option<PathBuf>,
        overrides: RunOverrides,
    ) -> Result<Self, SceneError> {
        apply(&overrides, &mut model);
        let scene = Scene::from_model(&model, name)?;
        let hash = text_hash ^ model.meshes_hash;
        let files = own_file.into_iter().chain(std::mem::take(&mut model.files)).collect();
        let (bodies, joints, ..) = scene.into_bodies();
        Ok(Self { origin: name.to_owned(), overrides, model, bodies, joints, of_file: None, hash, files })
    }

    fn of_file(mut scene: Scene, overrides: RunOverrides) -> Result<Self, SceneError> {
        if !scene.left_out.is_empty() {
            return Err(scene.left_out.swap_remove(0));
        }
        let gravity = Tuple(double_vector(scene.settings.gravity));
        let mut model = SceneModel { gravity: Some(gravity), steps: Some(scene.steps), ..SceneModel::default() };
        apply(&overrides, &mut model);
        let (origin, files) = (scene.origin.clone(), std::mem::take(&mut scene.files));
        settings(&model).map_err(|error| invalid(&origin, None, error))?;
        let mut hash = FNV_BASIS;
        for file in &files {
            hash = fnv1a(hash, &read_bytes(file, MAX_FILE_BYTES)?);
        }
        let (bodies, joints, file_joints, names) = scene.into_bodies();
        let file = FileScene::new(&bodies, &names, file_joints);
        file.fill(&mut model);
        Ok(Self { origin, overrides, model, bodies, joints, of_file: Some(file), hash, files })
    }

    /// The field of that path. Whether the scene has the number is found by
    /// [`check`](Self::check).
    ///
    /// # Errors
    /// [`FieldError`] if the path is none, or leads to a body or joint that there is not.
    pub fn field(&self, path: &str) -> Result<FieldPath, FieldError> {
        FieldPath::new(path, &self.model)
    }

    /// Whether the scene has the number of a field: it is set in a copy.
    ///
    /// # Errors
    /// [`FieldError`] with what there may be.
    pub fn check(&self, field: &FieldPath) -> Result<(), FieldError> {
        let SceneModel { bodies, joints, .. } = &self.model;
        self.of_file.as_ref().map_or(Ok(()), |file| file.check(field))?;
        match field.owner() {
            Owner::Body(index) => bodies.get(index).map_or(Ok(()), |body| field.set_in_body(&mut body.clone(), 0.0)),
            Owner::Joint(index) => {
                joints.get(index).map_or(Ok(()), |joint| field.set_in_joint(&mut joint.clone(), 0.0))
            }
            Owner::Scene => field.set_in_scene(&mut self.model.head(), 0.0),
        }
    }

    /// Names of the bodies, by their [`BodyId`](tumble::BodyId).
    #[must_use]
    pub fn body_names(&self) -> Vec<String> {
        self.model.bodies.iter().enumerate().map(|(index, body)| convert::name(body, index)).collect()
    }

    /// The first body that is neither fixed nor kinematic, by its [`BodyId`](tumble::BodyId).
    #[must_use]
    pub fn first_dynamic(&self) -> Option<usize> {
        self.bodies.iter().position(|body| body.body.properties().is_some())
    }

    /// A hash of what the scene says: of its text and its meshes.
    #[must_use]
    pub fn hash(&self) -> u64 {
        self.hash
    }

    /// The files that the scene was read from: its own and those of meshes.
    #[must_use]
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// The scene, to make worlds of in which these fields have other values.
    #[must_use]
    pub fn varied(self, fields: Vec<FieldPath>) -> VariedScene {
        VariedScene::new(self, fields)
    }
}

/// The scene, and a hash of its text; of one that is made, of what it is made of.
fn scene_model(name: &str) -> Result<(SceneModel, u64), SceneError> {
    let parsed = |text: &str, format| Ok((parse(text, format, name)?, fnv1a(FNV_BASIS, text.as_bytes())));
    if is_path(name) {
        let path = Path::new(name);
        let format = Format::of_path(path).ok_or_else(|| SceneError::UnknownFormat { file: one_line(name) })?;
        return parsed(&read_text(path)?, format);
    }
    if name == builtin::STRESS {
        return Err(SceneError::Generated { name: builtin::STRESS.to_owned() });
    }
    match (builtin::text(name), contact_scenes::named(name)) {
        (Some(text), _) => parsed(text, Format::Json),
        (None, Some(scene)) => {
            let model = scene.model(None, None);
            let hash = fnv1a(FNV_BASIS, format!("{model:?}").as_bytes());
            Ok((model, hash))
        }
        (None, None) => Err(unknown(name)),
    }
}

/// What is said instead of the scene.
#[allow(clippy::useless_conversion, reason = "dt is f64 already in one of the two builds")]
fn apply(overrides: &RunOverrides, model: &mut SceneModel) {
    model.dt = overrides.dt.map(f64::from).or(model.dt);
    model.substeps = overrides.substeps.or(model.substeps);
    if let Some(integrator) = overrides.integrator {
        model.integrator = Some(integrator.name().to_owned());
    }
    if let Some(RunLength::Steps(steps)) = overrides.length {
        model.steps = Some(steps);
    }
}

/// What a hash begins with.
const FNV_BASIS: u64 = 0xcbf2_9ce4_8422_2325;

/// 64-bit FNV-1a of some bytes, after those that `hash` is of.
fn fnv1a(hash: u64, bytes: &[u8]) -> u64 {
    bytes.iter().fold(hash, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3))
}
