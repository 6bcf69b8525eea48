//! The joints of a scene, and the gears between them.

use std::collections::BTreeMap;

use hecs::{Entity, World};
use tumble::Gear;
use tumble_import::FieldError;

use crate::bodies::scene_joint::SceneJoint;

/// Checked joints, and what ties their motions together.
#[derive(Clone, Debug, Default)]
pub(crate) struct SceneJoints {
    pub(crate) joints: Vec<SceneJoint>,
    pub(crate) gears: Vec<SceneGear>,
}

/// A checked gear between two joints, by their indices.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SceneGear {
    pub(crate) joints: [usize; 2],
    /// Whose entities are those of the two joints.
    pub(crate) gear: Gear,
}

impl SceneJoints {
    /// Spawns them between bodies as they are, and gives the joints that have a name.
    ///
    /// # Errors
    /// [`FieldError`] where a joint cannot be made.
    pub(crate) fn spawn(&self, bodies: &[Entity], world: &mut World) -> Result<Vec<(String, Entity)>, FieldError> {
        self.spawn_with(&BTreeMap::new(), bodies, world)
    }

    /// The same with other joints in the place of those with these indices.
    pub(crate) fn spawn_with(
        &self,
        others: &BTreeMap<usize, SceneJoint>,
        bodies: &[Entity],
        world: &mut World,
    ) -> Result<Vec<(String, Entity)>, FieldError> {
        let mut entities = Vec::with_capacity(self.joints.len());
        for (index, joint) in self.joints.iter().enumerate() {
            let joint = others.get(&index).unwrap_or(joint);
            let entity = joint.spawn(bodies, world);
            entities.push(entity.map_err(|error| FieldError::new(format!("joints[{index}]"), error))?);
        }
        for SceneGear { joints, gear } in &self.gears {
            spawn_gear(*gear, *joints, &entities, world);
        }
        let named = self.joints.iter().zip(entities);
        Ok(named.filter_map(|(joint, entity)| Some((joint.name.clone()?, entity?))).collect())
    }
}

/// Spawns a gear between two of these joints, if both are there.
pub(crate) fn spawn_gear(gear: Gear, joints: [usize; 2], entities: &[Option<Entity>], world: &mut World) {
    if let [Some(first), Some(second)] = joints.map(|index| entities.get(index).copied().flatten()) {
        world.spawn((Gear { joints: [first, second], ..gear },));
    }
}
