//! Motion of kinematic bodies at constant linear and angular velocity.

use hecs::{Without, World};
use tumble_math::rotate_exactly;

use crate::components::{Momentum, Pose, PreviousPose, Velocity};
use crate::math::Real;

/// Bodies that have a [`Velocity`] and no [`Momentum`].
type Kinematic<'a> = Without<(&'a mut Pose, &'a Velocity, Option<&'a mut PreviousPose>), &'a Momentum>;

/// Moves the kinematic bodies for `steps` times `dt` along their velocity: straight, and turning
/// exactly as a constant angular velocity does.
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

/// Moves a kinematic body for one of the equal parts, of `h` \[s\] and with this number, of a step;
/// the previous pose is that before the first.
pub(crate) fn move_a_substep(
    pose: &mut Pose,
    velocity: &Velocity,
    previous: Option<&mut PreviousPose>,
    (h, substep): (Real, u32),
) {
    if let Some(previous) = previous.filter(|_| substep == 0) {
        *previous = PreviousPose(*pose);
    }
    drift(pose, velocity, h);
}

fn drift(pose: &mut Pose, velocity: &Velocity, dt: Real) {
    pose.position += velocity.linear * dt;
    pose.orientation = rotate_exactly(pose.orientation.into(), velocity.angular.into(), dt).into();
}
