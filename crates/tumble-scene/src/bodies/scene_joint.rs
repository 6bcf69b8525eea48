//! A joint of a scene.

use hecs::{Entity, World};
use tumble::math::Vec3;
use tumble::{Axes, Joint, JointError};

use crate::bodies::joint_options::JointOptions;

/// A checked joint between two bodies of a scene, by their indices.
#[derive(Clone, Debug)]
pub(crate) struct SceneJoint {
    pub(crate) name: Option<String>,
    pub(crate) bodies: [usize; 2],
    /// The constructor of its kind.
    pub(crate) kind: fn(Entity, Entity) -> Joint,
    /// Point of the world \[m\].
    pub(crate) at: Vec3,
    /// Where the frame of the second body is, if elsewhere \[m\].
    pub(crate) to: Option<Vec3>,
    pub(crate) axis: Vec3,
    pub(crate) contacts: bool,
    pub(crate) options: JointOptions,
}

impl SceneJoint {
    /// The axes that its kind leaves free.
    pub(crate) fn free(&self) -> Axes {
        (self.kind)(Entity::DANGLING, Entity::DANGLING).free
    }

    /// Spawns the joint between bodies as they are.
    pub(crate) fn spawn(&self, bodies: &[Entity], world: &mut World) -> Result<Option<Entity>, JointError> {
        let [Some(a), Some(b)] = self.bodies.map(|index| bodies.get(index)) else { return Ok(None) };
        let joint = (self.kind)(*a, *b);
        let mut joint = if self.contacts { joint.with_contacts() } else { joint }.at(world, self.at, self.axis)?;
        if let Some(to) = self.to {
            joint.frames[1] = joint.at(world, to, self.axis)?.frames[1];
        }
        Ok(Some(self.options.spawn(joint, world)))
    }
}
