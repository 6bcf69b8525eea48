//! Ground in one call.

use hecs::{Entity, World};

use crate::collision::collider::Collider;
use crate::components::Pose;

/// Spawns infinite ground: everything below the plane y = 0, with the default
/// [`Material`](crate::Material). Its entity has a [`Pose`], which raises and tilts it, and a
/// [`Collider`]. [`RigidBody::ground`](crate::RigidBody::ground) is ground with another material.
///
/// ```
/// use tumble::prelude::*;
///
/// let mut world = hecs::World::new();
/// spawn_ground(&mut world);
/// let ball = RigidBody::new(Shape::sphere(0.5)).mass(1.0).position(Vec3::Y * 2.0).build()?;
/// let ball = ball.spawn(&mut world);
/// Simulation::new(Settings::default())?.step_many(&mut world, 120);
/// assert!((world.get::<&Pose>(ball)?.position.y - 0.5).abs() < 1e-3); // it lies on the ground
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias("ground", "floor", "plane", "half space"))]
pub fn spawn_ground(world: &mut World) -> Entity {
    world.spawn((Pose::default(), Collider::half_space()))
}
