//! The mass properties and forces of a scene's bodies, their joints, and what is wrong with them.

pub(crate) mod collider;
pub(crate) mod joint;
pub(crate) mod mesh;

use std::path::{Path, PathBuf};

use serde::Serialize;
use tumble::{MassProperties, MeshAudit};
use tumble_import::gltf::{GltfBodies, GltfBody};
use tumble_import::{Appearance, FieldError, InertiaRepairs, MeshFormat, Robot, RobotLink};

use crate::audit::collider::AuditedCollider;
use crate::audit::joint::AuditedJoint;
use crate::audit::mesh::{MeshOptions, MeshRepairs};
use crate::bodies::force::Force;
use crate::bodies::scene_body::SceneBody;
use crate::builtin::stress::DEFAULT_BODIES;
use crate::convert::forces::Others;
use crate::error::{SceneError, invalid};
use crate::model::scene_model::SceneModel;
use crate::scene::settings::settings;
use crate::scene::{duplicates, is_path, is_urdf, load_model, stress_bodies, unknown};
use crate::values::axes::named_axes;
use crate::{builtin, convert};

/// Each body of a scene as `tumble inspect` shows it.
///
/// Unlike [`Scene::open`](crate::Scene::open) it does not stop at the first impossible body.
///
/// ```
/// use tumble_scene::Audit;
///
/// let audit = Audit::from_json(r#"{ "bodies": [ { "mass": -1 }, { "mass": 1 } ] }"#, "two.json")?;
/// assert_eq!(audit.bodies[0].problems, ["mass: must be positive and finite, not -1"]);
/// assert!(audit.bodies[1].problems.is_empty());
/// # Ok::<(), tumble_scene::SceneError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Audit {
    /// In the order of the scene.
    pub bodies: Vec<AuditedBody>,
    /// The joints, in the order of the file.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub joints: Vec<AuditedJoint>,
    /// As [`Scene::notices`](crate::Scene::notices).
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub notices: Vec<String>,
    /// As [`Scene::files`](crate::Scene::files).
    #[serde(skip)]
    pub files: Vec<PathBuf>,
}

/// The mass properties of one body in its own frame, and its forces.
///
/// `None` (`null` in JSON) is what a body does not have: all of it if something is wrong with it,
/// and the mass and what follows from it if it is fixed or kinematic and was given none.
///
/// ```
/// use tumble_scene::Audit;
///
/// let text = r#"{ "bodies": [ { "shape": { "sphere": { "radius": 0.5 } }, "mass": 10 } ] }"#;
/// let ball = &Audit::from_json(text, "ball.json")?.bodies[0];
/// assert_eq!((ball.mass, ball.principal), (Some(10.0), Some([1.0; 3])));
/// # Ok::<(), tumble_scene::SceneError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AuditedBody {
    /// Its name, given or made from its index.
    pub name: String,
    /// Mass \[kg\].
    pub mass: Option<f64>,
    /// Centre of mass in the body's frame \[m\].
    pub center_of_mass: Option<[f64; 3]>,
    /// Inertia tensor about the centre of mass, axes of the body's frame, row by row \[kg m^2\].
    pub tensor: Option<[[f64; 3]; 3]>,
    /// Principal moments \[kg m^2\]; zeros for a point mass.
    pub principal: Option<[f64; 3]>,
    /// Quaternion `x, y, z, w` that takes principal-frame to body-frame coordinates.
    pub axes: Option<[f64; 4]>,
    /// Volume of a mesh [m^3].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub volume: Option<f64>,
    /// What was counted in a mesh.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mesh: Option<MeshAudit>,
    /// Its forces, with every default filled in.
    pub forces: Vec<Force>,
    /// What it touches others with, with every default filled in.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub collider: Option<AuditedCollider>,
    /// The axes of the world that it is locked along and about, such as `linear_z`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub locked_axes: Vec<&'static str>,
    /// Everything wrong with the body, each as `field: problem`.
    pub problems: Vec<String>,
    /// What it looks like in its own frame, and which axis of that is up.
    #[serde(skip)]
    pub appearance: Option<(Appearance, Up)>,
}

/// The axis of a body's frame that points up in pictures.
///
/// ```
/// use tumble_scene::{Audit, Up};
///
/// let audit = Audit::open("t-handle")?;
/// assert!(matches!(audit.bodies[0].appearance, Some((_, Up::Y))));
/// # Ok::<(), tumble_scene::SceneError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Up {
    /// As in scenes and glTF.
    Y,
    /// As in robots and files of machine parts.
    Z,
}

impl Audit {
    /// Audits a file or a built-in scene; names as in [`Scene::open`](crate::Scene::open).
    ///
    /// # Errors
    /// [`SceneError`] if the text is not a scene, or a setting or a gear of the scene is wrong.
    pub fn open(name_or_path: &str) -> Result<Self, SceneError> {
        Self::open_with(name_or_path, MeshOptions::default())
    }

    /// As [`open`](Self::open), with a density for a mesh and a word on its repairs, which are
    /// those of [inertias](InertiaRepairs) too.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub fn open_with(name_or_path: &str, options: MeshOptions) -> Result<Self, SceneError> {
        let path = Path::new(name_or_path);
        let repairs = match options.repairs {
            MeshRepairs::Refused => InertiaRepairs::Refused,
            MeshRepairs::Made => InertiaRepairs::Made,
        };
        match MeshFormat::of_path(path) {
            Some(MeshFormat::Gltf) => {
                let scene = GltfBodies::open(path, repairs)?;
                // Without physics it is a file of triangles like any other.
                if !scene.bodies.is_empty() {
                    return Ok(Self::of_gltf(scene));
                }
                let mut audit = mesh::of_file(path, MeshFormat::Gltf, options)?;
                audit.notices.extend(scene.notices);
                return Ok(audit);
            }
            Some(format) => return mesh::of_file(path, format, options),
            None => {}
        }
        if is_path(name_or_path) && is_urdf(path) {
            let robot = Robot::open(path, repairs)?;
            return Ok(Self { files: vec![path.to_owned()], ..Self::of_robot(robot) });
        }
        if is_path(name_or_path) {
            let mut audit = Self::of_model(&load_model(path)?, name_or_path)?;
            audit.files.insert(0, path.to_owned());
            return Ok(audit);
        }
        if name_or_path == builtin::STRESS {
            return stress();
        }
        match builtin::model(name_or_path) {
            Some(model) => Self::of_model(&model?, name_or_path),
            None => Err(unknown(name_or_path)),
        }
    }

    /// Audits a scene in JSON text; `file` is what messages call it.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub fn from_json(text: &str, file: &str) -> Result<Self, SceneError> {
        Self::of_model(&crate::model::parse::parse(text, crate::Format::Json, file)?, file)
    }

    /// Audits the links of a robot in URDF text; `file` is what messages call it.
    ///
    /// # Errors
    /// [`SceneError`] if the text is not a robot at all.
    pub fn from_urdf(text: &str, file: &str) -> Result<Self, SceneError> {
        Ok(Self::of_robot(Robot::from_text(text, file, InertiaRepairs::Refused)?))
    }

    fn of_robot(robot: Robot) -> Self {
        let audited = |link: RobotLink| match link.body {
            Ok(body) => AuditedBody::of(link.name, &body.into(), Up::Z),
            Err(problems) => AuditedBody::impossible(link.name, &problems),
        };
        let names: Vec<String> = robot.links.iter().map(|link| link.name.clone()).collect();
        let joints = AuditedJoint::all(&robot.joints, &robot.gears, &names);
        let bodies = robot.links.into_iter().map(audited).collect();
        Self { bodies, joints, notices: robot.notices, files: Vec::new() }
    }

    /// Whether anything is wrong with any body or joint.
    #[must_use]
    pub fn has_problems(&self) -> bool {
        let of_bodies = self.bodies.iter().map(|body| &body.problems);
        of_bodies.chain(self.joints.iter().map(|joint| &joint.problems)).any(|problems| !problems.is_empty())
    }

    fn of_gltf(scene: GltfBodies) -> Self {
        let audited = |GltfBody { name, body }: GltfBody| match body {
            Ok(body) => AuditedBody::of(name, &body.into(), Up::Y),
            Err(error) => AuditedBody::impossible(name, &[error]),
        };
        let names: Vec<String> = scene.bodies.iter().map(|body| body.name.clone()).collect();
        let joints = AuditedJoint::all(&scene.joints, &[], &names);
        let bodies = scene.bodies.into_iter().map(audited).collect();
        Self { bodies, joints, notices: scene.notices, files: scene.files }
    }

    fn of_model(model: &SceneModel, file: &str) -> Result<Self, SceneError> {
        settings(model).map_err(|error| invalid(file, None, error))?;
        let mut names = Vec::with_capacity(model.bodies.len());
        let mut bodies = Vec::with_capacity(model.bodies.len());
        let by_name = convert::indices(&model.bodies);
        let others = Others { by_name: &by_name, model: &|index| model.bodies.get(index) };
        for (index, body) in model.bodies.iter().enumerate() {
            let name = convert::name(body, index);
            names.push(name.clone());
            bodies.push(match convert::body(body, index, others) {
                Ok(body) => {
                    let audited = AuditedBody::of(name, &body, Up::Y);
                    AuditedBody { forces: body.forces, ..audited }
                }
                Err(problems) => AuditedBody::impossible(name, &problems),
            });
        }
        for (index, error) in duplicates(&names) {
            if let Some(body) = bodies.get_mut(index) {
                body.problems.push(error.to_string());
            }
        }
        let joints = AuditedJoint::of_scene(model, &names).map_err(|error| invalid(file, None, error))?;
        Ok(Self { bodies, joints, notices: model.notices.clone(), files: model.files.clone() })
    }
}

fn stress() -> Result<Audit, SceneError> {
    let bodies = stress_bodies(DEFAULT_BODIES, 0)
        .enumerate()
        .map(|(index, body)| Ok(AuditedBody::of(convert::numbered(index as u64), &body?, Up::Y)));
    let bodies = bodies.collect::<Result<_, SceneError>>()?;
    Ok(Audit { bodies, joints: Vec::new(), notices: Vec::new(), files: Vec::new() })
}

impl AuditedBody {
    fn of(name: String, body: &SceneBody, up: Up) -> Self {
        let audited = match body.body.properties() {
            Some(properties) => Self::of_properties(name, properties),
            None => Self::impossible(name, &[]),
        };
        let collider = body.collider.as_ref().map(AuditedCollider::of);
        let locked = named_axes().filter(|(_, axis)| body.locked_axes.contains(*axis));
        let locked_axes = locked.map(|(name, _)| name).collect();
        Self { appearance: Some((body.appearance.clone(), up)), collider, locked_axes, ..audited }
    }

    pub(crate) fn of_properties(name: String, properties: &MassProperties) -> Self {
        let mut audited = Self::impossible(name, &[]);
        let rows = properties.tensor_about_center().transpose();
        audited.mass = Some(properties.mass());
        audited.center_of_mass = Some(properties.center_of_mass().to_array());
        audited.tensor = Some(rows.to_cols_array_2d());
        let (moments, axes) = match properties.inertia() {
            Ok(inertia) => {
                let principal = inertia.principal();
                (principal.moments.to_array(), principal.axes.to_array())
            }
            // A point mass, which alone of all bodies without inertia is let through.
            Err(_) => ([0.0; 3], [0.0, 0.0, 0.0, 1.0]),
        };
        audited.principal = Some(moments);
        audited.axes = Some(axes);
        audited
    }

    pub(crate) fn impossible(name: String, problems: &[FieldError]) -> Self {
        Self {
            name,
            mass: None,
            center_of_mass: None,
            tensor: None,
            principal: None,
            axes: None,
            volume: None,
            mesh: None,
            appearance: None,
            forces: Vec::new(),
            collider: None,
            locked_axes: Vec::new(),
            problems: problems.iter().map(ToString::to_string).collect(),
        }
    }
}
