use hecs::{Without, World};
use tumble_math::rotate_exactly;

use crate::components::{Momentum, Pose, PreviousPose, Velocity};
use crate::math::Real;

/// Bodies that have a [`Velocity`] and no [`Momentum`].
type Kinematic<'a> = Without<(&'a mut Pose, &'a Velocity, Option<&'a mut PreviousPose>), &'a Momentum>;

/// Moves the kinematic bodies for `steps` times `dt` along their velocity: straight, and turning exactly as a constant angular velocity does.
pub(crate) fn move_kinematic_bodies(world: &mut World, dt: Real, steps: u32) {
    crate::scope::scope!("tumble::move_kinematic_bodies");
    for (pose, velocity, previous) in world.query_mut::<Kinematic<'_>>() {
        let mut before = *pose;
        for _ in 0..steps {
            before = *pose;
            drift(pose, velocity, dt);
        }
        if let Some(previous) = previous {
            *previous = PreviousPose(before);
        }
    }
}

/// Moves a body along a velocity for `dt` \[s\].
pub(crate) fn drift(pose: &mut Pose, velocity: &Velocity, dt: Real) {
    pose.position += velocity.linear * dt;
    pose.orientation = rotate_exactly(pose.orientation.into(), velocity.angular.into(), dt).into();
}
