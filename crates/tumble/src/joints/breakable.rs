//! Joints that break.

use crate::math::Real;

/// What a joint stands: a component of the entity of a [`Joint`](crate::Joint).
///
/// ```
/// use tumble::{Breakable, Joint, JointEvent, prelude::*};
///
/// let mut world = tumble::hecs::World::new();
/// let hook = RigidBody::new(Shape::Point).fixed().build()?.spawn(&mut world);
/// let weight = RigidBody::new(Shape::sphere(0.1)).mass(2.0).position(Vec3::Y * -1.0).build()?;
/// let weight = weight.spawn(&mut world);
/// let joint = Joint::ball(hook, weight).at_point(&world, Vec3::ZERO)?;
/// let joint = world.spawn((joint, Breakable::at_force(15.0)));
///
/// let mut simulation = Simulation::new(Settings::default())?;
/// simulation.step(&mut world);
/// assert!(world.get::<&Breakable>(joint)?.is_broken); // two kilograms weigh 19.6 N
/// assert_eq!(simulation.joint_events().collect::<Vec<_>>(), [JointEvent::Broke(joint)]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias = "break force")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Breakable {
    /// The greatest force \[N\], by the mean over a step.
    pub max_force: Real,
    /// The greatest torque [N m] about the second body's anchor, by the mean over a step.
    pub max_torque: Real,
    /// Set by the step where there was more. A broken joint does nothing until this is taken back.
    /// It is state: snapshots and hashes have it.
    pub is_broken: bool,
}

impl Breakable {
    /// Breaks at a force \[N\], at no torque.
    pub const fn at_force(max_force: Real) -> Self {
        Self { max_force, max_torque: Real::INFINITY, is_broken: false }
    }
}
