//! Scenes of glTF and URDF files in which numbers vary: a model of what can, and worlds in which it
//! has other values.

mod body_change;
mod joint_model;
mod mechanism;

use std::collections::BTreeMap;

use glam::{DQuat, DVec3};
use hecs::World;
use tumble_import::FieldError;

use crate::bodies::file_joint::FileJoints;
use crate::bodies::scene_body::SceneBody;
use crate::fields::field_path::{FieldPath, Owner};
use crate::fields::file_scene::body_change::{body_model, center_frame, change_body, refusal};
use crate::fields::file_scene::joint_model::{change_joint, joint_model};
use crate::fields::file_scene::mechanism::Mechanisms;
use crate::model::joint_model::JointModel;
use crate::model::scene_model::{BodyModel, SceneModel};

/// A position and an orientation.
type Frame = (DVec3, DQuat);

/// Joints of a file of others, and the numbers that its bodies and joints have in it.
#[derive(Clone, Debug)]
pub(crate) struct FileScene {
    joints: FileJoints,
    mechanisms: Mechanisms,
    body_models: Vec<BodyModel>,
    joint_models: Vec<JointModel>,
}

impl FileScene {
    /// Reads the numbers from the bodies as they are spawned.
    pub(crate) fn new(bodies: &[SceneBody], names: &[String], joints: FileJoints) -> Self {
        let mut world = World::new();
        let entities = SceneBody::spawn_all(bodies, &mut world);
        let named = bodies.iter().zip(names).zip(&entities);
        let body_models = named.map(|((body, name), entity)| body_model(body, name, *entity, &world)).collect();
        let frame = |body: usize| entities.get(body).map(|entity| center_frame(&world, *entity));
        let frames = |[a, b]: [usize; 2]| Some([frame(a)?, frame(b)?]);
        let joint_models = joints.joints.iter().map(|joint| joint_model(joint, frames(joint.bodies))).collect();
        let mechanisms = Mechanisms::new(bodies.len(), joints.joints.iter().map(|joint| joint.bodies));
        Self { joints, mechanisms, body_models, joint_models }
    }

    /// What a path can lead to.
    pub(crate) fn fill(&self, model: &mut SceneModel) {
        model.bodies.clone_from(&self.body_models);
        model.joints.clone_from(&self.joint_models);
    }

    /// Refuses what such a file does not say of a body: its form and what follows from it.
    pub(crate) fn check(&self, field: &FieldPath) -> Result<(), FieldError> {
        let Owner::Body(index) = field.owner() else { return Ok(()) };
        let Some(model) = self.body_models.get(index) else { return Ok(()) };
        refusal(model, &field.segments()).map_or(Ok(()), |problem| Err(FieldError::new(field.text(), problem)))
    }

    /// The world in which these bodies and joints have other numbers.
    pub(crate) fn world(
        &self,
        bodies: &[SceneBody],
        varied_bodies: &BTreeMap<usize, BodyModel>,
        varied_joints: &BTreeMap<usize, JointModel>,
    ) -> Result<World, FieldError> {
        let mut joints = self.joints.clone();
        let mut world = World::new();
        let entities = SceneBody::spawn_all(bodies, &mut world);
        for (&index, model) in varied_joints {
            let (Some(joint), Some(was)) = (joints.joints.get_mut(index), self.joint_models.get(index)) else {
                continue;
            };
            let inside = |error: FieldError| error.inside(&format!("joints[{index}]"));
            change_joint(joint, was, model).map_err(inside)?;
            self.mechanisms.pose(index, joint, (was, model), &entities, &mut world).map_err(inside)?;
        }
        let mut placed = BTreeMap::new();
        for (&index, model) in varied_bodies {
            let (Some(body), Some(&entity)) = (bodies.get(index), entities.get(index)) else { continue };
            let Some(was) = self.body_models.get(index) else { continue };
            let inside = |error: FieldError| error.inside(&format!("bodies[{index}]"));
            if (model.position, model.orientation) != (was.position, was.orientation)
                && let Some(other) = placed.insert(self.mechanisms.of(index), index)
            {
                let problem = format!("is that of a mechanism whose place bodies[{other}] has already");
                return Err(inside(FieldError::new("position", problem)));
            }
            self.mechanisms.place(index, (was, model), &entities, &mut world).map_err(inside)?;
            change_body(body, (was, model), entity, &mut world).map_err(inside)?;
        }
        joints.spawn(&entities, &mut world);
        Ok(world)
    }
}
