//! A torque-limited servo that drives a body to a target angular velocity.

use tumble_math::lane::{Lane, Vec3 as LaneVec3};

use crate::forces::components::Frame;
use crate::forces::components::constant_wrench::to_world;
use crate::forces::simd_force_law::{SimdBody, SimdForceLaw, SimdWrench};
use crate::math::{Real, Vec3};

/// Turns the body up to a wanted angular velocity, in one step where the torque suffices:
/// `torque = I (wanted - w)/dt`, up to a limit.
///
/// What other engines leave to the caller (Unity's `AddTorque(inertia * difference / dt)`) with a
/// limit: a reaction wheel. Against a limit the angular velocity changes at the rate
/// `max_torque/I`, and the last of it may take one step more. It does work, and has no potential.
/// Under `RungeKutta4`, whose stages are within the step, each step leaves 0.375 of the difference.
///
/// ```
/// # use tumble::prelude::*;
/// # let mut world = hecs::World::new();
/// let craft = RigidBody::new(Shape::cuboid([0.1, 0.2, 0.3])).mass(2.0).build()?.spawn(&mut world);
/// let spin =
///     AngularVelocityServo { target: Vec3::Y * 3.0, frame: Frame::World, max_torque: 100.0 };
/// world.insert_one(craft, spin)?;
/// Simulation::new(Settings::default())?.step_many(&mut world, 2);
/// assert!((world.get::<&Velocity>(craft)?.angular - Vec3::Y * 3.0).length() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AngularVelocityServo {
    /// Wanted angular velocity [rad/s].
    pub target: Vec3,
    /// Which axes it is given along.
    pub frame: Frame,
    /// The most torque [N m]; infinite for no limit.
    pub max_torque: Real,
}

impl SimdForceLaw<5> for AngularVelocityServo {
    fn numbers(&self) -> [Real; 5] {
        [self.target.x, self.target.y, self.target.z, self.frame.number(), self.max_torque]
    }

    #[inline(always)]
    fn wrench<L: Lane>([x, y, z, frame, max_torque]: [L; 5], body: &SimdBody<L>) -> SimdWrench<L> {
        let one = L::splat(1.0);
        let target = to_world(frame, LaneVec3::new(x, y, z), body);
        let missing = body.apply_inertia(target - body.angular_velocity);
        let torque = missing * (one / body.response_time());
        // `min` takes the one where nothing is missing and the quotient is none.
        let share = (max_torque / torque.dot(torque).sqrt()).min(one);
        SimdWrench::torque(torque * share)
    }
}
