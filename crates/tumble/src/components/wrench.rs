//! The force and torque accumulators of a body.

use crate::math::Vec3;

/// Sum of the forces \[N\] and of their torques about the centre of mass [N m] that act during the
/// next step, in the world frame.
///
/// D'Alembert's accumulators: however many forces act, the body moves as under these two. The step
/// that consumes the wrench zeroes it, so a force that is to last is added before every step.
///
/// ```
/// # use tumble::prelude::*;
/// # let mut world = hecs::World::new();
/// let crate_ =
///     RigidBody::new(Shape::cuboid([0.5, 0.5, 0.5])).mass(20.0).build()?.spawn(&mut world);
/// world.get::<&mut Wrench>(crate_)?.add_force(Vec3::X * 100.0); // in the next step
/// Simulation::new(Settings::default())?.step(&mut world);
/// assert_eq!(world.get::<&Wrench>(crate_)?.force, Vec3::ZERO);
/// assert!((world.get::<&Velocity>(crate_)?.linear.x - 5.0 / 60.0).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias("force", "torque", "ExternalForce"))]
#[derive(Clone, Copy, Debug, PartialEq, Default)]
#[repr(C)]
pub struct Wrench {
    /// Sum of forces \[N\].
    pub force: Vec3,
    /// Sum of torques about the centre of mass [N m].
    pub torque: Vec3,
}

impl Wrench {
    /// Adds a force \[N\] through the centre of mass.
    #[doc(alias = "apply_force")]
    #[inline]
    pub fn add_force(&mut self, force: Vec3) {
        self.force += force;
    }

    /// Adds a force \[N\] at a point, both in the world frame; `center` is the centre of mass, the
    /// pose's position.
    ///
    /// ```
    /// # use tumble::{Wrench, math::Vec3};
    /// let mut wrench = Wrench::default();
    /// wrench.add_force_at(Vec3::Y * 10.0, Vec3::new(0.5, 0.0, 0.0), Vec3::ZERO);
    /// assert_eq!((wrench.force, wrench.torque), (Vec3::Y * 10.0, Vec3::Z * 5.0));
    /// ```
    #[doc(alias("apply_force_at_point", "add_force_at_point"))]
    #[inline]
    pub fn add_force_at(&mut self, force: Vec3, point: Vec3, center: Vec3) {
        self.force += force;
        self.torque += (point - center).cross(force);
    }

    /// Adds another wrench.
    #[inline]
    pub(crate) fn add(&mut self, other: Self) {
        self.force += other.force;
        self.torque += other.torque;
    }

    /// Adds a torque [N m] in the world frame.
    #[doc(alias = "apply_torque")]
    #[inline]
    pub fn add_torque(&mut self, torque: Vec3) {
        self.torque += torque;
    }
}

/// Whether wrenches are set to zero when the bodies have been integrated.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Wrenches {
    /// They are zero.
    Consumed,
    /// They act in the next substep too.
    Kept,
}
