//! Linear and angular velocity: derived for dynamic bodies, prescribed for kinematic ones.

use crate::math::Vec3;

/// Velocity of the centre of mass [m/s] and angular velocity [rad/s], both in the world frame.
///
/// On a body with [`Momentum`](crate::Momentum) it is derived by
/// [`update_derived`](crate::update_derived); change the momentum, not this. A body with a velocity
/// and no momentum is *kinematic*: it moves at its velocity, whatever pushes it.
///
/// ```
/// # use tumble::prelude::*;
/// # let mut world = hecs::World::new();
/// // A wheel that rolls along x: the point on the ground stands still.
/// let wheel = RigidBody::new(Shape::cylinder(0.5, 0.1)).mass(10.0).linear_velocity(Vec3::X);
/// let wheel = wheel.angular_velocity(Vec3::Z * -2.0).build()?.spawn(&mut world);
/// let (pose, velocity) = (world.get::<&Pose>(wheel)?, world.get::<&Velocity>(wheel)?);
/// assert!(velocity.at_point(pose.position - Vec3::Y * 0.5, pose.position).length() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias("LinearVelocity", "AngularVelocity", "linvel", "angvel"))]
#[derive(Clone, Copy, Debug, PartialEq, Default)]
#[repr(C)]
pub struct Velocity {
    /// `v = P/M` [m/s].
    pub linear: Vec3,
    /// `w = I^-1 L` [rad/s].
    pub angular: Vec3,
}

impl Velocity {
    /// Velocity [m/s] of the body's material at a point: `v + w x (point - center)`, all in the
    /// world frame.
    ///
    /// ```
    /// # use tumble::{Velocity, math::Vec3};
    /// let spinning = Velocity { linear: Vec3::X, angular: Vec3::Z * 3.0 };
    /// assert_eq!(spinning.at_point(Vec3::new(0.0, 2.0, 0.0), Vec3::ZERO), Vec3::X * -5.0);
    /// ```
    #[inline]
    pub fn at_point(&self, point: Vec3, center: Vec3) -> Vec3 {
        self.linear + self.angular.cross(point - center)
    }
}
