//! Worlds of one scene that differ in some of its numbers.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use hecs::World;
use tumble::{Settings, SettingsError, Trial};
use tumble_import::FieldError;

use crate::alike::find;
use crate::bodies::scene_body::SceneBody;
use crate::bodies::scene_joint::SceneJoint;
use crate::bodies::scene_joints::SceneJoints;
use crate::convert;
use crate::convert::forces::Others;
use crate::error::{SceneError, invalid};
use crate::fields::field_path::{FieldPath, Owner};
use crate::fields::file_scene::FileScene;
use crate::fields::scene_template::{RunLength, RunOverrides, SceneTemplate};
use crate::limits::steps_of_duration;
use crate::model::joint_model::JointModel;
use crate::model::scene_model::{BodyModel, SceneModel};
use crate::scene::settings::settings;

/// A scene with fields that differ from world to world.
///
/// What does not differ is made once, so that making a world costs little.
///
/// ```
/// use tumble_scene::{RunOverrides, SceneTemplate};
///
/// let scene = SceneTemplate::open("t-handle", RunOverrides::default())?;
/// let gravity = scene.field("gravity.1")?;
/// let scene = scene.varied(vec![gravity]);
/// for gravity in [-10.0, 0.0] {
///     let world = scene.build(&[gravity])?;
///     assert_eq!(world.trial.simulation.settings().gravity.y, gravity as tumble::math::Real);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct VariedScene {
    origin: String,
    overrides: RunOverrides,
    /// The scene without its bodies.
    head: SceneModel,
    bodies: Vec<SceneBody>,
    joints: SceneJoints,
    of_file: Option<FileScene>,
    /// The bodies in which something varies, and those with a spring whose length that changes.
    varied_bodies: BTreeMap<usize, BodyModel>,
    /// The other bodies to which springs of those lead.
    neighbours: BTreeMap<usize, BodyModel>,
    /// Indices of all bodies, where there are springs.
    by_name: HashMap<String, usize>,
    /// The joints in which something varies.
    varied_joints: BTreeMap<usize, JointModel>,
    /// Indices of the bodies of those.
    joint_ends: HashMap<String, usize>,
    fields: Vec<FieldPath>,
}

/// A world of a [`VariedScene`] at its start.
///
/// ```
/// use tumble_scene::{RunOverrides, SceneTemplate};
///
/// let mut world =
///     SceneTemplate::open("t-handle", RunOverrides::default())?.varied(Vec::new()).build(&[])?;
/// world.trial.step_many(10);
/// assert!(world.steps > 10); // as many as the scene says
/// # Ok::<(), tumble_scene::SceneError>(())
/// ```
pub struct VariedWorld {
    /// The world and its simulation.
    pub trial: Trial,
    /// How many steps it is to be run.
    pub steps: u64,
}

impl VariedScene {
    pub(crate) fn new(template: SceneTemplate, fields: Vec<FieldPath>) -> Self {
        let SceneTemplate { origin, overrides, model, bodies, joints, of_file, .. } = template;
        let by_name = convert::indices(&model.bodies);
        let (varied_bodies, neighbours) = varied_bodies(&fields, &model.bodies, &by_name);
        let (varied_joints, joint_ends) = varied_joints(&fields, &model.joints, &joints.joints);
        let head = model.head();
        Self {
            origin,
            overrides,
            head,
            bodies,
            joints,
            of_file,
            varied_bodies,
            neighbours,
            by_name,
            varied_joints,
            joint_ends,
            fields,
        }
    }

    /// What differs between worlds.
    #[must_use]
    pub fn fields(&self) -> &[FieldPath] {
        &self.fields
    }

    /// Makes the world in which the varied fields have these values.
    ///
    /// # Errors
    /// [`SceneError`] where no body, or no simulation, can have them.
    pub fn build(&self, values: &[f64]) -> Result<VariedWorld, SceneError> {
        let file = &self.origin;
        let mut head = self.head.clone();
        let (mut varied_bodies, mut varied_joints) = (self.varied_bodies.clone(), self.varied_joints.clone());
        for (field, &value) in self.fields.iter().zip(values) {
            let set = match field.owner() {
                Owner::Body(index) => {
                    varied_bodies.get_mut(&index).map_or(Ok(()), |body| field.set_in_body(body, value))
                }
                Owner::Joint(index) => {
                    varied_joints.get_mut(&index).map_or(Ok(()), |joint| field.set_in_joint(joint, value))
                }
                Owner::Scene => field.set_in_scene(&mut head, value),
            };
            set.map_err(|error| invalid(file, None, error))?;
        }
        let (settings, steps) = settings(&head).map_err(|error| invalid(file, None, error))?;
        let steps = self.steps(&settings, steps).map_err(|error| invalid(file, None, error))?;
        let world = match &self.of_file {
            Some(of_file) => of_file
                .world(&self.bodies, &varied_bodies, &varied_joints)
                .map_err(|error| invalid(file, None, error))?,
            None => self.world(&varied_bodies, &varied_joints)?,
        };
        let refused = |error: SettingsError| invalid(file, None, FieldError::new(error.field(), error));
        let trial = Trial::new(settings, world).map_err(refused)?;
        Ok(VariedWorld { trial, steps })
    }

    fn world(
        &self,
        varied_bodies: &BTreeMap<usize, BodyModel>,
        varied_joints: &BTreeMap<usize, JointModel>,
    ) -> Result<World, SceneError> {
        let file = &self.origin;
        let model_of = |index: usize| varied_bodies.get(&index).or_else(|| self.neighbours.get(&index));
        let others = Others { by_name: &self.by_name, model: &model_of };
        let mut remade = BTreeMap::new();
        for (&index, model) in varied_bodies {
            let body = convert::body(model, index, others);
            remade.insert(index, body.map_err(|problems| impossible(file, index, model, problems))?);
        }
        let mut remade_joints = BTreeMap::new();
        for (&index, model) in varied_joints {
            let joint = convert::joints::joint(model, &|name| find("body", name, &self.joint_ends));
            let inside = |error: FieldError| invalid(file, None, error.inside(&format!("joints[{index}]")));
            remade_joints.insert(index, joint.map_err(inside)?);
        }
        let mut world = World::new();
        let bodies = self.bodies.iter().enumerate().map(|(index, body)| remade.get(&index).unwrap_or(body));
        let bodies = SceneBody::spawn_all(bodies, &mut world);
        let spawned = self.joints.spawn_with(&remade_joints, &bodies, &mut world);
        spawned.map_err(|error| invalid(file, None, error))?;
        Ok(world)
    }

    fn steps(&self, settings: &Settings, of_scene: u64) -> Result<u64, FieldError> {
        match self.overrides.length {
            Some(RunLength::Duration(seconds)) => {
                steps_of_duration(seconds, settings.dt).map_err(|problem| FieldError::new("dt", problem))
            }
            Some(RunLength::Steps(_)) | None => Ok(of_scene),
        }
    }
}

/// Models of the bodies to be made for every world, and of those that are reported then.
fn varied_bodies(
    fields: &[FieldPath],
    bodies: &[BodyModel],
    by_name: &HashMap<String, usize>,
) -> (BTreeMap<usize, BodyModel>, BTreeMap<usize, BodyModel>) {
    let varied: BTreeSet<usize> = fields
        .iter()
        .filter_map(|field| if let Owner::Body(index) = field.owner() { Some(index) } else { None })
        .collect();
    let is_remade = |(index, body): &(usize, &BodyModel)| {
        varied.contains(index) || convert::springs_by_distance(body, by_name).any(|to| varied.contains(&to))
    };
    let remade: BTreeMap<_, _> =
        bodies.iter().enumerate().filter(is_remade).map(|(index, body)| (index, body.clone())).collect();
    let leads_to = remade.values().flat_map(|body| convert::springs_by_distance(body, by_name));
    let seen = leads_to.filter(|to| !remade.contains_key(to));
    let neighbours = seen.filter_map(|to| Some((to, bodies.get(to)?.clone()))).collect();
    (remade, neighbours)
}

/// Models of the joints to be made for every world, and the indices of their bodies by name.
fn varied_joints(
    fields: &[FieldPath],
    models: &[JointModel],
    joints: &[SceneJoint],
) -> (BTreeMap<usize, JointModel>, HashMap<String, usize>) {
    let (mut varied, mut ends) = (BTreeMap::new(), HashMap::new());
    for field in fields {
        let Owner::Joint(index) = field.owner() else { continue };
        let Some(model) = models.get(index) else { continue };
        // Joints of a file of others find their bodies by index.
        if let Some(joint) = joints.get(index) {
            let names = model.between.iter().flat_map(|between| between.0.iter().cloned());
            ends.extend(names.zip(joint.bodies));
        }
        varied.insert(index, model.clone());
    }
    (varied, ends)
}

fn impossible(file: &str, index: usize, model: &BodyModel, problems: Vec<FieldError>) -> SceneError {
    let first = problems.into_iter().next();
    let place = Some((index, Some(convert::name(model, index))));
    invalid(file, place, first.unwrap_or_else(|| FieldError::new("body", "is impossible")))
}
