//! Bodies that touch, as tests of contacts need them.

use hecs::{Entity, World};
use tumble::math::Quat;
use tumble::prelude::*;
use tumble::{Collider, Material};

/// A body with a collider.
pub fn spawn(world: &mut World, body: RigidBody, collider: Collider) -> Entity {
    body.build().expect("a possible body").spawn_with(world, (collider,))
}

/// Infinite ground below the origin, turned about it.
pub fn ground(world: &mut World, material: Material, orientation: Quat) -> Entity {
    spawn(
        world,
        RigidBody::new(Shape::Point).fixed().orientation(orientation),
        surfaced(Collider::half_space(), material),
    )
}

/// A collider of a material.
pub fn surfaced(collider: Collider, material: Material) -> Collider {
    collider.with_material(material).expect("a possible material")
}

/// The collider that a shape has.
pub fn collider(shape: &Shape) -> Collider {
    Collider::new(shape).expect("a shape that can be touched")
}

/// With half the length of its edges \[m\].
pub fn cube(half: f64) -> Shape {
    Shape::cuboid([half, half, half])
}

/// Where a body is.
pub fn pose(world: &World, entity: Entity) -> Pose {
    *world.get::<&Pose>(entity).expect("a body")
}

/// How a body moves.
pub fn velocity(world: &World, entity: Entity) -> Velocity {
    *world.get::<&Velocity>(entity).expect("a body")
}
