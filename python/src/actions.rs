//! Forces that a program applies to bodies.

use hecs::{Entity, World};
use tumble::math::{Real, Vec3};
use tumble::{ConstantWrench, Frame, Momentum, Pose, Wrench};

/// The largest component of a force \[N\] or torque [N m], as in scene files.
const MAX_FORCE: Real = 1e18;

/// Forces \[N\] and torques [N m] of one body; what is `None` stays.
#[derive(Clone, Copy, Default)]
pub(crate) struct Load {
    pub(crate) force: Option<Vec3>,
    pub(crate) torque: Option<Vec3>,
    /// Where the force acts \[m\], world frame; at the centre of mass if nowhere.
    pub(crate) point: Option<Vec3>,
}

impl Load {
    /// Whether it is within what the engine takes.
    pub(crate) fn is_in_range(&self) -> bool {
        let small = |vector: Option<Vec3>| vector.is_none_or(|vector| vector.abs().max_element() <= MAX_FORCE);
        small(self.force) && small(self.torque)
    }

    /// Adds it to what acts in the next step.
    pub(crate) fn push(&self, world: &mut World, body: Entity) {
        let center = world.get::<&Pose>(body).map(|pose| pose.position).unwrap_or_default();
        let Ok(mut wrench) = world.get::<&mut Wrench>(body) else { return };
        if let Some(force) = self.force {
            wrench.add_force_at(force, self.point.unwrap_or(center), center);
        }
        wrench.add_torque(self.torque.unwrap_or_default());
    }

    /// Lets it act until it is set to another. Bodies that forces do not move have none.
    pub(crate) fn hold(&self, world: &mut World, body: Entity, frame: Frame) {
        if !world.satisfies::<&Momentum>(body) {
            return;
        }
        let has_wrench = world.satisfies::<&ConstantWrench>(body);
        let mut wrench = world.get::<&ConstantWrench>(body).map(|wrench| *wrench).unwrap_or_default();
        wrench.force = self.force.unwrap_or(wrench.force);
        wrench.torque = self.torque.unwrap_or(wrench.torque);
        wrench.frame = frame;
        if !has_wrench {
            // The body is there: it has momentum.
            drop(world.insert_one(body, wrench));
        } else if let Ok(mut held) = world.get::<&mut ConstantWrench>(body) {
            *held = wrench;
        }
    }
}
