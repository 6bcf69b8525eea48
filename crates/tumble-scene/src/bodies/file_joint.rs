//! Joints of the files of others.

use hecs::{Entity, World};
use tumble_import::{ImportedGear, ImportedJoint};

use crate::bodies::joint_options::JointOptions;
use crate::bodies::scene_joints::spawn_gear;

/// The joints of a file of others, and what ties their motions together.
#[derive(Clone, Debug, Default)]
pub(crate) struct FileJoints {
    pub(crate) joints: Vec<ImportedJoint>,
    pub(crate) gears: Vec<ImportedGear>,
}

impl FileJoints {
    /// Spawns joints between bodies, which they find by their index, and the gears between them.
    /// Gives the joints' names and entities.
    pub(crate) fn spawn(&self, bodies: &[Entity], world: &mut World) -> Vec<(String, Entity)> {
        let mut entities = Vec::with_capacity(self.joints.len());
        for joint in &self.joints {
            let ends = joint.bodies.map(|index| bodies.get(index).copied());
            entities.push(match ends {
                [Some(a), Some(b)] => Some(options(joint).spawn(joint.between([a, b]), world)),
                _ => None,
            });
        }
        for gear in &self.gears {
            spawn_gear(gear.between([Entity::DANGLING; 2]), gear.joints, &entities, world);
        }
        let named = self.joints.iter().zip(entities);
        named.filter_map(|(joint, entity)| Some((joint.name.clone(), entity?))).collect()
    }
}

fn options(joint: &ImportedJoint) -> JointOptions {
    JointOptions { limits: joint.limits, drives: joint.drives.clone(), friction: joint.friction, breakable: None }
}
