//! What happens to joints.

use hecs::Entity;

/// What happened to a joint in a step: see
/// [`Simulation::joint_events`](crate::Simulation::joint_events).
///
/// ```
/// use tumble::{Joint, JointEvent, prelude::*};
///
/// let mut world = tumble::hecs::World::new();
/// let hook = RigidBody::new(Shape::Point).fixed().build()?.spawn(&mut world);
/// let lamp = RigidBody::new(Shape::sphere(0.1)).mass(2.0).build()?.spawn(&mut world);
/// let joint = world.spawn((Joint::ball(hook, lamp),));
/// let mut simulation = Simulation::new(Settings::default())?;
/// simulation.step(&mut world);
/// assert_eq!(simulation.joint_events().count(), 0);
///
/// world.despawn(lamp)?;
/// simulation.step(&mut world);
/// assert_eq!(simulation.joint_events().collect::<Vec<_>>(), [JointEvent::EndIsGone(joint)]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum JointEvent {
    /// A joint carried more than its [`Breakable`](crate::Breakable) stands.
    Broke(Entity),
    /// A body of a joint is not in the world any more, or is no body.
    EndIsGone(Entity),
}
