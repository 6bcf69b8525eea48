//! A scene: settings, bodies and their names.

pub(crate) mod body_names;
pub(crate) mod settings;

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use hecs::World;
use tumble::{BodyError, BodyId, Settings};
use tumble_import::gltf::{GltfBodies, GltfBody};
use tumble_import::{
    Appearance, FieldError, ImportedCollider, ImportedJoint, InertiaRepairs, MeshFormat, Robot, Scope, one_line,
    read_text,
};

use crate::bodies::file_joint::FileJoints;
use crate::bodies::scene_body::SceneBody;
use crate::bodies::scene_joints::SceneJoints;
use crate::builtin::stress::StressBodies;
use crate::builtin::{builtin_names, contact_scenes, nearest_builtin, stress};
use crate::convert::forces::Others;
use crate::error::{SceneError, invalid};
use crate::limits::MAX_BODIES;
use crate::model::parse::{Format, parse};
use crate::model::scene_model::SceneModel;
use crate::scene::body_names::BodyNames;
use crate::scene::settings::settings;
use crate::{builtin, convert};

/// Steps of a scene that does not say how many.
pub const DEFAULT_STEPS: u64 = 600;

/// Bodies with names, and what to run them with. Everything in it is checked.
///
/// ```
/// use tumble_scene::Scene;
///
/// let scene = Scene::from_ron(
///     r#"( gravity: (0, 0, 0),
///          bodies: [ ( name: "ball", shape: sphere(radius: 0.5), mass: 2 ) ] )"#,
///     "ball.ron",
/// )?;
/// let mut world = hecs::World::new();
/// let names = scene.spawn(&mut world)?;
/// assert_eq!((names.of(0).as_ref(), world.len()), ("ball", 1));
/// # Ok::<(), tumble_scene::SceneError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Scene {
    /// Where the scene came from: a file, or the name of a built-in.
    pub origin: String,
    /// What the scene is called, if it says so.
    pub name: Option<String>,
    /// What it shows, if it says so.
    pub description: Option<String>,
    /// Where its figures come from, if it says so.
    pub source: Option<String>,
    /// What to run it with; gravity \[m/s^2\], time step \[s\].
    pub settings: Settings,
    /// How many steps to run.
    pub steps: u64,
    /// What the file says that is read and not simulated, or was decided where it is silent: a line
    /// each.
    pub notices: Vec<String>,
    /// Bodies of a glTF file that are impossible, each with what is wrong with it. They are left
    /// out, which the notices say too.
    pub left_out: Vec<SceneError>,
    /// The files that it was read from: its own and those that it names.
    pub files: Vec<PathBuf>,
    bodies: Bodies,
}

#[derive(Clone, Debug)]
enum Bodies {
    Listed { bodies: Vec<SceneBody>, joints: SceneJoints, file_joints: FileJoints, names: Vec<String> },
    Stress { count: usize, seed: u64 },
}

impl Scene {
    /// Opens a file or a built-in scene.
    ///
    /// What has an extension or a slash is a file; every other name is that of a built-in scene,
    /// even where a file of that name exists.
    ///
    /// # Errors
    /// [`SceneError`], whose message names file, body and field.
    pub fn open(name_or_path: &str) -> Result<Self, SceneError> {
        if is_path(name_or_path) {
            return Self::load(Path::new(name_or_path));
        }
        if name_or_path == builtin::STRESS {
            return Self::stress(stress::DEFAULT_BODIES, 0);
        }
        match builtin::model(name_or_path) {
            Some(model) => Self::from_model(&model?, name_or_path),
            None => Err(unknown(name_or_path)),
        }
    }

    /// [`open`](Self::open), where a generated scene may be given how many bodies, and which seed,
    /// it is generated from. Ground and walls are not counted.
    ///
    /// # Errors
    /// [`SceneError`]; [`SceneError::NotGenerated`] where either is given for a scene that has no
    /// use for it, and [`SceneError::File`] for more bodies than [`MAX_BODIES`].
    pub fn open_with(name_or_path: &str, bodies: Option<u64>, seed: Option<u64>) -> Result<Self, SceneError> {
        let Some(option) = bodies.map(|_| "bodies").or(seed.map(|_| "seed")) else { return Self::open(name_or_path) };
        // What is more than there can be is refused with all that is too many.
        let bodies = bodies.map(|bodies| usize::try_from(bodies).unwrap_or(usize::MAX));
        if name_or_path == builtin::STRESS {
            return Self::stress(bodies.unwrap_or(stress::DEFAULT_BODIES), seed.unwrap_or(0));
        }
        let refused = |option| Err(SceneError::NotGenerated { option, name: name_or_path.to_owned() });
        match contact_scenes::named(name_or_path) {
            None => refused(option),
            Some(scene) if bodies.is_some() && scene.bodies.is_none() => refused("bodies"),
            Some(scene) if seed.is_some() && !scene.is_seeded => refused("seed"),
            Some(scene) => {
                check_count(scene.name, bodies.unwrap_or(0))?;
                Self::from_model(&scene.model(bodies, seed), scene.name)
            }
        }
    }

    /// Reads a `.json`, `.ron`, `.gltf`, `.glb` or `.urdf` file.
    ///
    /// # Errors
    /// [`SceneError`], whose message names file, body and field.
    pub fn load(path: &Path) -> Result<Self, SceneError> {
        Self::load_with(path, InertiaRepairs::Refused)
    }

    /// As [`load`](Self::load), where the moments of inertia of a glTF file's bodies or a robot's
    /// links that break the triangle inequality may be repaired. A notice says of each body what
    /// was done.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn load_with(path: &Path, repairs: InertiaRepairs) -> Result<Self, SceneError> {
        let file = path.to_string_lossy();
        if MeshFormat::of_path(path) == Some(MeshFormat::Gltf) {
            return Self::of_gltf(GltfBodies::open(path, repairs)?, &file);
        }
        if is_urdf(path) {
            let robot = Robot::open(path, repairs)?;
            return Ok(Self { files: vec![path.to_owned()], ..Self::of_robot(robot, &file)? });
        }
        let mut scene = Self::from_model(&load_model(path)?, &file)?;
        scene.files.insert(0, path.to_owned());
        Ok(scene)
    }

    /// Reads a scene from JSON text; `file` is what messages call it, and where files of meshes are
    /// looked for beside.
    ///
    /// # Errors
    /// [`SceneError`], whose message names file, body and field.
    pub fn from_json(text: &str, file: &str) -> Result<Self, SceneError> {
        Self::from_model(&parse(text, Format::Json, file)?, file)
    }

    /// Reads a scene from RON text; `file` is what messages call it, and where files of meshes are
    /// looked for beside.
    ///
    /// # Errors
    /// [`SceneError`], whose message names file, body and field.
    pub fn from_ron(text: &str, file: &str) -> Result<Self, SceneError> {
        Self::from_model(&parse(text, Format::Ron, file)?, file)
    }

    /// Reads a robot in URDF text; `file` is what messages call it.
    ///
    /// Links are at the poses they have while no joint is moved, in the frame of the root, with
    /// gravity along -z; those that fixed joints connect are one body. What is not simulated is in
    /// the [`notices`](Self::notices).
    ///
    /// ```
    /// use tumble_scene::Scene;
    ///
    /// let robot = r#"<robot name="brick"> <link name="base"> <inertial>
    ///     <mass value="2"/> <inertia ixx="0.02" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.04"/>
    /// </inertial> </link> </robot>"#;
    /// assert_eq!(Scene::from_urdf(robot, "brick.urdf")?.body_count(), 1);
    /// let error = Scene::from_urdf(&robot.replace("0.04", "0.06"), "brick.urdf").unwrap_err();
    /// let field = "brick.urdf: link \"base\", field inertial.inertia: ";
    /// assert!(error.to_string().starts_with(field));
    /// # Ok::<(), tumble_scene::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// [`SceneError`], whose message names file, link and field.
    pub fn from_urdf(text: &str, file: &str) -> Result<Self, SceneError> {
        Self::of_robot(Robot::from_text(text, file, InertiaRepairs::Refused)?, file)
    }

    fn of_robot(mut robot: Robot, file: &str) -> Result<Self, SceneError> {
        let (name, notices) = (robot.name.take(), std::mem::take(&mut robot.notices));
        let file_joints =
            FileJoints { joints: std::mem::take(&mut robot.joints), gears: std::mem::take(&mut robot.gears) };
        let (bodies, names) = robot.into_bodies(file)?;
        let bodies = bodies.into_iter().map(SceneBody::from).collect();
        Ok(Self {
            origin: file.to_owned(),
            name,
            description: None,
            source: None,
            settings: Settings::default().with_gravity(Robot::GRAVITY),
            steps: DEFAULT_STEPS,
            notices,
            left_out: Vec::new(),
            files: Vec::new(),
            bodies: Bodies::Listed { bodies, joints: SceneJoints::default(), file_joints, names },
        })
    }

    /// Reads a scene from the bytes of a `.gltf` or `.glb` file; `file` is what messages call it,
    /// and buffers are looked for beside it.
    ///
    /// # Errors
    /// [`SceneError`], whose message names file, node and field.
    pub fn from_gltf(bytes: &[u8], file: &str) -> Result<Self, SceneError> {
        let directory = Path::new(file).parent();
        Self::of_gltf(GltfBodies::from_bytes(bytes, directory, file, InertiaRepairs::Refused)?, file)
    }

    /// The generated scene: mixed tumbling shapes on a grid, falling, the same bits on every
    /// platform for the same count and seed (SplitMix64 and plain arithmetic).
    ///
    /// # Errors
    /// [`SceneError::File`] for more bodies than [`MAX_BODIES`].
    pub fn stress(bodies: usize, seed: u64) -> Result<Self, SceneError> {
        check_count(builtin::STRESS, bodies)?;
        Ok(Self {
            origin: builtin::STRESS.to_owned(),
            name: Some(builtin::STRESS.to_owned()),
            description: Some(stress::ABOUT.to_owned()),
            source: None,
            settings: Settings::default(),
            steps: stress::STEPS,
            notices: Vec::new(),
            left_out: Vec::new(),
            files: Vec::new(),
            bodies: Bodies::Stress { count: bodies, seed },
        })
    }

    /// How many bodies.
    #[must_use]
    pub fn body_count(&self) -> usize {
        match &self.bodies {
            Bodies::Listed { bodies, .. } => bodies.len(),
            Bodies::Stress { count, .. } => *count,
        }
    }

    /// What every body looks like, in its own frame, by index.
    ///
    /// # Errors
    /// As [`spawn`](Self::spawn).
    pub fn appearance(&self) -> Result<Vec<Appearance>, SceneError> {
        match &self.bodies {
            Bodies::Listed { bodies, .. } => Ok(bodies.iter().map(|body| body.appearance.clone()).collect()),
            Bodies::Stress { count, seed } => stress_bodies(*count, *seed).map(|body| Ok(body?.appearance)).collect(),
        }
    }

    /// What the bodies with these indices look like, which increase.
    ///
    /// # Errors
    /// As [`spawn`](Self::spawn).
    pub fn appearance_of(&self, chosen: &[usize]) -> Result<Vec<Appearance>, SceneError> {
        match &self.bodies {
            Bodies::Listed { bodies, .. } => {
                Ok(chosen.iter().filter_map(|&index| bodies.get(index)).map(|body| body.appearance.clone()).collect())
            }
            // Most of a million bodies are made for nothing; but none of them is kept.
            Bodies::Stress { count, seed } => stress_bodies(*count, *seed)
                .enumerate()
                .filter(|(index, _)| chosen.binary_search(index).is_ok())
                .map(|(_, body)| Ok(body?.appearance))
                .collect(),
        }
    }

    /// Whether the body of this index is dynamic; the others are fixed or kinematic.
    #[must_use]
    pub fn is_free(&self, index: usize) -> bool {
        match &self.bodies {
            Bodies::Listed { bodies, .. } => bodies.get(index).is_some_and(|body| body.body.properties().is_some()),
            Bodies::Stress { .. } => true,
        }
    }

    /// Spawns the bodies, with their index as [`BodyId`](tumble::BodyId), and the springs, joints
    /// and gears between them, and gives their names.
    ///
    /// # Errors
    /// [`SceneError::File`] if the generated scene made an impossible body, which its tests
    /// deny.
    pub fn spawn(self, world: &mut World) -> Result<BodyNames, SceneError> {
        match self.bodies {
            Bodies::Listed { bodies, joints, file_joints, names } => {
                let entities = SceneBody::spawn_all(&bodies, world);
                let mut named = joints.spawn(&entities, world).map_err(|error| invalid(&self.origin, None, error))?;
                named.extend(file_joints.spawn(&entities, world));
                Ok(BodyNames { given: Some(names), joints: named })
            }
            Bodies::Stress { count, seed } => {
                for body in stress_bodies(count, seed) {
                    body?.body.spawn(world);
                }
                Ok(BodyNames { given: None, joints: Vec::new() })
            }
        }
    }

    /// A scene of bodies that are at fault or not, with the engine's settings. Refused if there is
    /// none without a fault.
    fn of_gltf(scene: GltfBodies, file: &str) -> Result<Self, SceneError> {
        let (mut bodies, mut names) = (Vec::with_capacity(scene.bodies.len()), Vec::with_capacity(scene.bodies.len()));
        let (mut left_out, mut notices) = (Vec::new(), scene.notices);
        let mut indices = Vec::with_capacity(scene.bodies.len());
        for GltfBody { name, body } in scene.bodies {
            indices.push(body.is_ok().then_some(bodies.len()));
            match body {
                Ok(mut body) => {
                    // Ids are indices, also where a body before it is missing.
                    body.body = body.body.with_id(Some(BodyId(bodies.len() as u64)));
                    bodies.push(SceneBody::from(body));
                    names.push(name);
                }
                Err(error) if error.scope == Scope::Body => {
                    notices.push(one_line(&format!("body {name:?} is left out: {error}")));
                    left_out.push(invalid(file, None, error));
                }
                Err(error) => return Err(invalid(file, None, error)),
            }
        }
        if bodies.is_empty() && !left_out.is_empty() {
            return Err(left_out.remove(0));
        }
        let kept = |joint: ImportedJoint| match joint.bodies.map(|body| indices.get(body).copied().flatten()) {
            [Some(a), Some(b)] => Some(ImportedJoint { bodies: [a, b], ..joint }),
            _ => None,
        };
        let joints = scene.joints.into_iter().filter_map(kept).collect();
        let file_joints = FileJoints { joints, gears: Vec::new() };
        Ok(Self {
            origin: file.to_owned(),
            name: scene.name,
            description: None,
            source: None,
            settings: Settings::default(),
            steps: DEFAULT_STEPS,
            notices,
            left_out,
            files: scene.files,
            bodies: Bodies::Listed { bodies, joints: SceneJoints::default(), file_joints, names },
        })
    }

    /// What a glTF file says of the colliders and triggers of its bodies, each with the index of
    /// its body.
    pub fn colliders(&self) -> impl Iterator<Item = (usize, &ImportedCollider)> {
        let bodies = match &self.bodies {
            Bodies::Listed { bodies, .. } => bodies.as_slice(),
            Bodies::Stress { .. } => &[],
        };
        bodies.iter().enumerate().flat_map(|(index, body)| body.pieces.iter().map(move |collider| (index, collider)))
    }

    /// The bodies, joints and names of a scene that lists them.
    pub(crate) fn into_bodies(self) -> (Vec<SceneBody>, SceneJoints, FileJoints, Vec<String>) {
        match self.bodies {
            Bodies::Listed { bodies, joints, file_joints, names } => (bodies, joints, file_joints, names),
            Bodies::Stress { .. } => Default::default(),
        }
    }

    pub(crate) fn from_model(model: &SceneModel, file: &str) -> Result<Self, SceneError> {
        let (settings, steps) = settings(model).map_err(|error| invalid(file, None, error))?;
        let mut bodies = Vec::with_capacity(model.bodies.len());
        let by_name = convert::indices(&model.bodies);
        let others = Others { by_name: &by_name, model: &|index| model.bodies.get(index) };
        for (index, body) in model.bodies.iter().enumerate() {
            match convert::body(body, index, others) {
                Ok(body) => bodies.push(body),
                Err(problems) => {
                    let place = Some((index, Some(convert::name(body, index))));
                    let first = problems.into_iter().next();
                    return Err(invalid(
                        file,
                        place,
                        first.unwrap_or_else(|| FieldError::new("body", "is impossible")),
                    ));
                }
            }
        }
        let names: Vec<String> =
            model.bodies.iter().enumerate().map(|(index, body)| convert::name(body, index)).collect();
        if let Some((index, error)) = duplicates(&names).into_iter().next() {
            return Err(invalid(file, Some((index, names.get(index).cloned())), error));
        }
        let joints = convert::gears::joints_and_gears(model, &names).map_err(|error| invalid(file, None, error))?;
        Ok(Self {
            origin: file.to_owned(),
            name: model.name.clone(),
            description: model.description.clone(),
            source: model.source.clone(),
            settings,
            steps,
            notices: model.notices.clone(),
            left_out: Vec::new(),
            files: model.files.clone(),
            bodies: Bodies::Listed { bodies, joints, file_joints: FileJoints::default(), names },
        })
    }
}

/// Refuses more bodies of a generated scene than any scene has.
fn check_count(scene: &str, bodies: usize) -> Result<(), SceneError> {
    if bodies <= MAX_BODIES {
        return Ok(());
    }
    Err(invalid(scene, None, FieldError::new("bodies", format!("at most {MAX_BODIES}, not {bodies}"))))
}

/// Whether there are files to open; a browser has none, and what reads them is left out there.
const HAS_FILES: bool = !cfg!(all(target_family = "wasm", target_os = "unknown"));

/// What `open` takes for a path.
pub(crate) fn is_path(name: &str) -> bool {
    let path = Path::new(name);
    HAS_FILES && (path.extension().is_some() || name.contains(std::path::is_separator))
}

/// Whether a path ends in `.urdf`.
pub(crate) fn is_urdf(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("urdf"))
}

pub(crate) fn unknown(name: &str) -> SceneError {
    let known = builtin_names().collect::<Vec<_>>().join(", ");
    SceneError::UnknownName { name: one_line(name), known, nearest: nearest_builtin(name) }
}

pub(crate) fn load_model(path: &Path) -> Result<SceneModel, SceneError> {
    let file = path.to_string_lossy();
    let format = Format::of_path(path).ok_or_else(|| SceneError::UnknownFormat { file: one_line(&file) })?;
    parse(&read_text(path)?, format, &file)
}

/// The bodies of the generated scene.
pub(crate) fn stress_bodies(count: usize, seed: u64) -> impl Iterator<Item = Result<SceneBody, SceneError>> {
    let impossible = |index: usize, error: &BodyError| {
        let place = Some((index, Some(convert::numbered(index as u64))));
        invalid(builtin::STRESS, place, FieldError::new(error.field(), error))
    };
    let bodies = StressBodies::new(count, seed).enumerate();
    bodies.map(move |(index, body)| body.map_err(|error| impossible(index, &error)))
}

/// Every body whose name an earlier one has, with the complaint.
pub(crate) fn duplicates(names: &[String]) -> Vec<(usize, FieldError)> {
    let mut first = HashMap::with_capacity(names.len());
    let mut found = Vec::new();
    for (index, name) in names.iter().enumerate() {
        if let Some(earlier) = first.insert(name, index) {
            found.push((index, FieldError::new("name", format!("{name:?} is also the name of bodies[{earlier}]"))));
        }
    }
    found
}
