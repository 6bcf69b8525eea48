//! Joints of the files of others.

use hecs::{Entity, World};
use tumble_import::ImportedJoint;

use crate::bodies::joint_options::JointOptions;

/// Spawns joints between bodies, which they find by their index, and gives their names and
/// entities.
pub(crate) fn spawn_joints(joints: &[ImportedJoint], bodies: &[Entity], world: &mut World) -> Vec<(String, Entity)> {
    let mut spawned = Vec::with_capacity(joints.len());
    for joint in joints {
        let [Some(a), Some(b)] = joint.bodies.map(|index| bodies.get(index)) else { continue };
        let options = JointOptions {
            limits: joint.limits,
            drives: joint.drives.clone(),
            friction: joint.friction,
            breakable: None,
        };
        spawned.push((joint.name.clone(), options.spawn(joint.between([*a, *b]), world)));
    }
    spawned
}
