//! Promise: what a body touches, and how, goes with the body when others are despawned or spawned
//! before it in the order of bodies.
//!
//! Why: groups, materials and sensors are kept by slot, and slots move up when a body goes.

use hecs::World;
use tumble::prelude::*;
use tumble_tests::touching::{collider, cube, spawn, surfaced};

/// Ice slides on, rubber stops, a ghost falls through: also when the first body is gone.
#[test]
fn surfaces_and_groups_stay_with_their_bodies() {
    for despawned_after in [0, 5] {
        let mut world = World::new();
        let ice = Material::default().with_friction(0.0);
        spawn(&mut world, RigidBody::new(Shape::Point).fixed().id(BodyId(9)), surfaced(Collider::half_space(), ice));
        let shape = cube(0.5);
        let mut put = |id: u64, collider: Collider| {
            let at = Vec3::new(0.0, 0.5, 3.0 * id as Real);
            let body = RigidBody::new(shape.clone()).mass(1.0).id(BodyId(id)).position(at);
            spawn(&mut world, body.linear_velocity(Vec3::X), collider)
        };
        let first = put(1, surfaced(collider(&shape), ice));
        let slides = put(2, surfaced(collider(&shape), ice));
        let stops = put(3, surfaced(collider(&shape), Material::default().with_friction(2.0)));
        let ghost = put(4, collider(&shape).with_groups(0, 0));
        let sensor = put(5, collider(&shape).sensor());
        let solid = put(6, surfaced(collider(&shape), ice));
        let mut simulation = Simulation::new(Settings::default()).unwrap();
        simulation.step_many(&mut world, despawned_after);
        world.despawn(first).unwrap();
        simulation.step_many(&mut world, 60);
        let speed = |body| world.get::<&Velocity>(body).unwrap().linear.x;
        let height = |body| world.get::<&Pose>(body).unwrap().position.y;
        assert!(speed(slides) > 0.99 && speed(solid) > 0.99 && speed(stops) < 0.01, "after {despawned_after} steps");
        assert!(height(slides) > 0.4 && height(solid) > 0.4, "after {despawned_after} steps");
        assert!(height(ghost) < -1.0 && height(sensor) < -1.0, "after {despawned_after} steps");
    }
}

/// A body without a collider that comes first in the order.
#[test]
fn bodies_without_colliders_come_first() {
    let mut world = World::new();
    spawn_ground(&mut world);
    let shape = cube(0.5);
    for id in 10..14 {
        let body =
            RigidBody::new(shape.clone()).mass(1.0).id(BodyId(id)).position(Vec3::new(2.0 * id as Real, 0.5, 0.0));
        spawn(&mut world, body, collider(&shape));
    }
    let mut simulation = Simulation::new(Settings::default()).unwrap();
    simulation.step(&mut world);
    let point = RigidBody::new(Shape::sphere(0.5)).without_collider().mass(1.0).id(BodyId(1));
    point.build().unwrap().spawn_with(&mut world, (LockedAxes(Axes::LINEAR_X),));
    simulation.step_many(&mut world, 10);
    assert_eq!(simulation.contacts().count(), 4);
}
