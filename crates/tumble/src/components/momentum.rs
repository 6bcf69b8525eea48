//! Linear and angular momentum of a body, with impulses at its centre of mass or at a point.

use crate::math::Vec3;

/// Linear momentum [kg m/s] and angular momentum about the centre of mass [kg m^2/s], both in the
/// world frame.
///
/// Momentum, not velocity, is the state: without forces it does not change, to the bit. A body
/// without it is not moved by forces.
///
/// ```
/// # use tumble::{Momentum, math::Vec3};
/// let mut momentum = Momentum::default();
/// momentum.apply_impulse(Vec3::X * 3.0);
/// momentum.apply_angular_impulse(Vec3::Y);
/// assert_eq!((momentum.linear, momentum.angular), (Vec3::X * 3.0, Vec3::Y));
/// ```
#[doc(alias("impulse", "kick"))]
#[derive(Clone, Copy, Debug, PartialEq, Default)]
#[repr(C)]
pub struct Momentum {
    /// `P = M v` [kg m/s].
    pub linear: Vec3,
    /// `L = I w` [kg m^2/s].
    pub angular: Vec3,
}

impl Momentum {
    /// Adds an impulse [N s] through the centre of mass.
    #[doc(alias("add_impulse", "apply_linear_impulse"))]
    #[inline]
    pub fn apply_impulse(&mut self, impulse: Vec3) {
        self.linear += impulse;
    }

    /// Adds an impulse [N s] at a point, both in the world frame; `center` is the centre of mass,
    /// the pose's position.
    ///
    /// ```
    /// # use tumble::{Momentum, math::Vec3};
    /// let mut momentum = Momentum::default();
    /// momentum.apply_impulse_at(Vec3::Y, Vec3::new(2.0, 0.0, 0.0), Vec3::ZERO);
    /// assert_eq!((momentum.linear, momentum.angular), (Vec3::Y, Vec3::Z * 2.0));
    /// ```
    #[doc(alias = "apply_impulse_at_point")]
    #[inline]
    pub fn apply_impulse_at(&mut self, impulse: Vec3, point: Vec3, center: Vec3) {
        self.linear += impulse;
        self.angular += (point - center).cross(impulse);
    }

    /// Adds an angular impulse [N m s] in the world frame.
    #[doc(alias = "apply_torque_impulse")]
    #[inline]
    pub fn apply_angular_impulse(&mut self, impulse: Vec3) {
        self.angular += impulse;
    }
}
