//! Friction of a joint.

use crate::joints::axes::Axes;
use crate::math::Real;

/// Dry friction of a joint: a component of the entity of a [`Joint`](crate::Joint).
///
/// ```
/// use tumble::{Axes, Joint, JointFriction, prelude::*};
///
/// let mut world = tumble::hecs::World::new();
/// let base = RigidBody::new(Shape::Point).fixed().build()?.spawn(&mut world);
/// let disc = RigidBody::new(Shape::cylinder(0.5, 0.05)).mass(8.0).angular_velocity(Vec3::Y * 2.0);
/// let disc = disc.build()?.spawn(&mut world);
/// let hinge = Joint::hinge(base, disc).at(&world, Vec3::ZERO, Vec3::Y)?;
/// world.spawn((hinge, JointFriction::along(Axes::ANGULAR_X, 0.5)));
///
/// // It stops after inertia times speed over torque: 1 kg m^2 * 2 rad/s / 0.5 N m = 4 s.
/// let mut simulation = Simulation::new(Settings::default())?;
/// simulation.step_many(&mut world, 239);
/// assert!(world.get::<&Velocity>(disc)?.angular.y > 0.0);
/// simulation.step_many(&mut world, 2);
/// assert!(world.get::<&Velocity>(disc)?.angular.y.abs() < 1e-5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct JointFriction {
    /// The greatest force \[N\] along each axis of translation, then torque [N m] about each of
    /// rotation. Along locked axes it does nothing.
    pub max: [Real; 6],
}

impl JointFriction {
    /// The same force \[N\] or torque [N m] along or about each of these axes.
    pub fn along(axes: Axes, max: Real) -> Self {
        Self { max: std::array::from_fn(|axis| if axes.has(axis) { max } else { 0.0 }) }
    }

    /// The same along these axes only.
    pub(crate) fn along_only(self, axes: Axes) -> Self {
        Self { max: std::array::from_fn(|axis| if axes.has(axis) { self.max[axis] } else { 0.0 }) }
    }

    /// Whether its numbers can be reckoned with.
    pub(crate) fn is_in_range(&self) -> bool {
        self.max.iter().all(|max| *max >= 0.0)
    }
}
