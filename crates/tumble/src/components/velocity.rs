use crate::math::Vec3;

/// Velocity of the centre of mass [m/s] and angular velocity [rad/s], both in the world frame.
///
/// On a body with [`Momentum`](crate::Momentum) it is derived by [`update_derived`](crate::update_derived); change the momentum,
/// not this. A body with a velocity and no momentum is *kinematic*: it moves as told, whatever pushes it.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
#[repr(C)]
pub struct Velocity {
    /// `v = P/M` [m/s].
    pub linear: Vec3,
    /// `w = I^-1 L` [rad/s].
    pub angular: Vec3,
}

impl Velocity {
    /// Velocity [m/s] of the body's material at a point: `v + w x (point - center)`, all in the world frame.
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
