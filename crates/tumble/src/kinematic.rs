use hecs::{Without, World};
use tumble_math::rotate_exactly;

use crate::components::{Momentum, Pose, PreviousPose, Velocity};
use crate::math::Real;

/// Moves the bodies that have a [`Velocity`] and no [`Momentum`] for `dt` along it: straight, and turning exactly as a constant
/// angular velocity does.
pub(crate) fn move_kinematic_bodies(world: &mut World, dt: Real) {
    type Kinematic<'a> = (&'a mut Pose, &'a Velocity, Option<&'a mut PreviousPose>);
    for (pose, velocity, previous) in world.query_mut::<Without<Kinematic<'_>, &Momentum>>() {
        if let Some(previous) = previous {
            *previous = PreviousPose(*pose);
        }
        pose.position += velocity.linear * dt;
        pose.orientation = rotate_exactly(pose.orientation.into(), velocity.angular.into(), dt).into();
    }
}
