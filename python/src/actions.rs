//! Forces that a program applies to bodies.

use crate::state::MAX_POSITION;
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
    /// The argument that is beyond what the engine takes, and how far it may go.
    pub(crate) fn fault(&self) -> Option<(&'static str, Real)> {
        let limits = [
            ("forces", self.force, MAX_FORCE),
            ("torques", self.torque, MAX_FORCE),
            ("points", self.point, MAX_POSITION),
        ];
        let is_beyond = |vector: Option<Vec3>, limit| vector.is_some_and(|it| it.abs().max_element() > limit);
        limits.into_iter().find(|&(_, vector, limit)| is_beyond(vector, limit)).map(|(name, _, limit)| (name, limit))
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

    /// Whether what is held already, and stays, would act in another frame.
    pub(crate) fn turns_held(&self, world: &World, body: Entity, frame: Frame) -> bool {
        world.get::<&ConstantWrench>(body).is_ok_and(|held| {
            let stays = |given: Option<Vec3>, held: Vec3| given.is_none() && held != Vec3::ZERO;
            held.frame != frame && (stays(self.force, held.force) || stays(self.torque, held.torque))
        })
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
