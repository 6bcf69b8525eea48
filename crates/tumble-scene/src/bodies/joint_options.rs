//! What a joint has beside its frames.

use hecs::{Entity, EntityBuilder, World};
use tumble::{Breakable, Drives, Joint, JointFriction, JointLoad, Limits};

/// Limits, drives, friction and breaking of a joint, each if there is one.
#[derive(Clone, Debug, Default)]
pub(crate) struct JointOptions {
    pub(crate) limits: Option<Limits>,
    pub(crate) drives: Option<Drives>,
    pub(crate) friction: Option<JointFriction>,
    pub(crate) breakable: Option<Breakable>,
}

impl JointOptions {
    /// Spawns a joint with them and with its load.
    pub(crate) fn spawn(&self, joint: Joint, world: &mut World) -> Entity {
        let mut entity = EntityBuilder::new();
        entity.add(joint).add(JointLoad::default());
        if let Some(limits) = self.limits {
            entity.add(limits);
        }
        if let Some(drives) = &self.drives {
            entity.add(drives.clone());
        }
        if let Some(friction) = self.friction {
            entity.add(friction);
        }
        if let Some(breakable) = self.breakable {
            entity.add(breakable);
        }
        world.spawn(entity.build())
    }
}
