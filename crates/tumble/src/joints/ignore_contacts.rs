//! Pairs of bodies that pass through each other.

use hecs::{Entity, World};

/// Two bodies whose colliders do not touch each other, though their groups would have it: a
/// component of an entity of its own, as a [`Joint`](crate::Joint) is, to be spawned and despawned
/// at any time.
///
/// Sensors still sense. A body that is gone, or one and the same twice, is no pair. For rules that
/// depend on where and how bodies meet there are
/// [contact hooks](crate::Simulation::set_contact_hook).
///
/// ```
/// use tumble::{IgnoreContacts, prelude::*};
///
/// let mut world = hecs::World::new();
/// let ground = spawn_ground(&mut world);
/// let ball = RigidBody::new(Shape::sphere(0.5)).mass(1.0).position(Vec3::Y).build()?;
/// let ball = ball.spawn(&mut world);
/// world.spawn((IgnoreContacts::between(ground, ball),));
///
/// let mut simulation = Simulation::new(Settings::default())?;
/// simulation.step_many(&mut world, 60);
/// assert!(world.get::<&Pose>(ball)?.position.y < -3.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias("collision filter", "ignore collision"))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IgnoreContacts {
    /// The two.
    pub bodies: [Entity; 2],
}

impl IgnoreContacts {
    /// Of these two bodies.
    #[must_use]
    pub fn between(first: Entity, second: Entity) -> Self {
        Self { bodies: [first, second] }
    }

    /// All of a world between two different bodies that are there.
    pub(crate) fn list(world: &World, found: &mut Vec<[Entity; 2]>) {
        found.clear();
        let is_pair = |[a, b]: &[Entity; 2]| a != b && world.contains(*a) && world.contains(*b);
        found.extend(world.query::<&Self>().iter().map(|it| it.bodies).filter(is_pair));
    }
}
