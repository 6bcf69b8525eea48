use hecs::{Without, World};
use tumble_math::rotate_exactly;

use crate::components::{Momentum, Pose, PreviousPose, Velocity};
use crate::math::Real;

/// Moves the bodies that have a [`Velocity`] and no [`Momentum`] for `steps` times `dt` along it: straight, and turning exactly as a constant
/// angular velocity does.
pub(crate) fn move_kinematic_bodies(world: &mut World, dt: Real, steps: u32) {
    crate::scope::scope!("tumble::move_kinematic_bodies");
    type Kinematic<'a> = (&'a mut Pose, &'a Velocity, Option<&'a mut PreviousPose>);
    for (pose, velocity, previous) in world.query_mut::<Without<Kinematic<'_>, &Momentum>>() {
        let mut before = *pose;
        for _ in 0..steps {
            before = *pose;
            pose.position += velocity.linear * dt;
            pose.orientation = rotate_exactly(pose.orientation.into(), velocity.angular.into(), dt).into();
        }
        if let Some(previous) = previous {
            *previous = PreviousPose(before);
        }
    }
}
