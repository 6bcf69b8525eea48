//! Joints of the files of others.

use hecs::{Entity, EntityBuilder, World};
use tumble::JointLoad;
use tumble_import::ImportedJoint;

/// Spawns joints between bodies, which they find by their index, and gives their names and
/// entities.
pub(crate) fn spawn_joints(joints: &[ImportedJoint], bodies: &[Entity], world: &mut World) -> Vec<(String, Entity)> {
    let mut spawned = Vec::with_capacity(joints.len());
    for joint in joints {
        let [Some(a), Some(b)] = joint.bodies.map(|index| bodies.get(index)) else { continue };
        let mut entity = EntityBuilder::new();
        entity.add_bundle((joint.between([*a, *b]), JointLoad::default()));
        if let Some(limits) = joint.limits {
            entity.add(limits);
        }
        if let Some(drives) = joint.drives.clone() {
            entity.add(drives);
        }
        if let Some(friction) = joint.friction {
            entity.add(friction);
        }
        spawned.push((joint.name.clone(), world.spawn(entity.build())));
    }
    spawned
}
