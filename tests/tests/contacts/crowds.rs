//! Promise: however many bodies are in one place, the pairs of each that count are limited, and
//! what is left out is reported: the contacts of n bodies are at most 128 n. Which are left out is
//! the same whatever order bodies were spawned in; and where no more than 64 are near one, nothing
//! is.
//!
//! Why: n bodies in one point would make n^2 contacts, gigabytes for two thousand. It fails if a
//! crowd's contacts grow with the square, or a heap loses contacts to the limit.

use std::collections::BTreeSet;

use hecs::World;
use proptest::prelude::*;
use tumble::math::{Quat, Real, Vec3};
use tumble::prelude::*;
use tumble::{Collider, Rng};
use tumble_tests::cases;
use tumble_tests::touching::{collider, ground, spawn};

/// Balls and boxes within a distance of the origin, in an order; and how many pairs their boxes
/// alone would make.
fn crowd(count: u64, spread: Real, order: impl Iterator<Item = u64>) -> World {
    let mut world = World::new();
    for id in order {
        let mut rng = Rng::stream(count, id);
        let shape = if spread > 0.0 && id % 3 == 0 { Shape::cuboid([0.2; 3]) } else { Shape::sphere(0.25) };
        let place = rng.vector(-spread, spread);
        let body = RigidBody::new(shape.clone()).mass(1.0).id(BodyId(id)).position(place);
        spawn(&mut world, body, collider(&shape));
    }
    world
}

/// Who meets whom, by identity, in the first step; and how many pairs were left out.
fn pairs(world: &mut World) -> (BTreeSet<[u64; 2]>, usize) {
    let mut simulation = Simulation::new(Settings::default().with_gravity(Vec3::ZERO)).unwrap();
    simulation.step(world);
    let id = |entity| world.get::<&BodyId>(entity).unwrap().0;
    (simulation.contacts().map(|contact| contact.bodies.map(id)).collect(), simulation.pairs_left_out())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(cases(12)))]

    #[test]
    fn contacts_of_crowds_are_limited(count in 2_u64..700, spread in prop_oneof![Just(0.0), 0.0..0.2_f64, 0.5..2.0_f64]) {
        let spread = spread as Real;
        let (found, left_out) = pairs(&mut crowd(count, spread, 0..count));
        prop_assert!(found.len() as u64 <= 128 * count);
        let all = count * (count - 1) / 2;
        if spread == 0.0 {
            prop_assert_eq!(found.len() as u64 + left_out as u64, all);
            // Of 66 the last two do without each other.
            prop_assert_eq!(left_out > 0, count > 65, "{} of {}", left_out, count);
            // Of equals the first count.
            prop_assert!((1..count.min(64)).all(|id| found.contains(&[0, id])));
        }
        let turned = pairs(&mut crowd(count, spread, (0..count).rev()));
        prop_assert!(turned == (found, left_out), "which are left out depends on the order of spawning");
    }
}

/// A plate under four hundred balls that do not crowd each other has all of them.
#[test]
fn a_large_body_has_all_its_neighbours() {
    let mut world = World::new();
    ground(&mut world, Material::default(), Quat::IDENTITY);
    let plate = Shape::cuboid([10.0, 0.5, 10.0]);
    spawn(&mut world, RigidBody::new(plate.clone()).mass(1e3).position(Vec3::Y * 0.5), collider(&plate));
    let ball = Shape::sphere(0.3);
    for i in 0..400 {
        let place = Vec3::new((i % 20) as Real - 9.5, 1.3, (i / 20) as Real - 9.5);
        spawn(&mut world, RigidBody::new(ball.clone()).mass(1.0).position(place), collider(&ball));
    }
    let mut simulation = Simulation::new(Settings::default()).unwrap();
    simulation.step(&mut world);
    assert_eq!((simulation.contacts().count(), simulation.pairs_left_out()), (401, 0));
}

/// Compounds of as many balls each in one place would have a contact for each pair of them.
#[test]
fn contacts_of_compounds_are_limited() {
    for (parts, expected) in [(8, 64), (32, 1024), (100, 1024)] {
        let ball = collider(&Shape::sphere(0.25));
        let compound = Collider::compound((0..parts).map(|_| ball.clone())).unwrap();
        let mut world = World::new();
        for id in 0..2 {
            let place = Vec3::X * (0.1 * id as Real);
            let body = RigidBody::new(Shape::sphere(0.25)).mass(1.0).id(BodyId(id)).position(place);
            spawn(&mut world, body, compound.clone());
        }
        let mut simulation = Simulation::new(Settings::default().with_gravity(Vec3::ZERO)).unwrap();
        simulation.step(&mut world);
        let found = simulation.contacts().count();
        assert_eq!((found, found + simulation.pairs_left_out()), (expected, parts * parts));
        // They part all the same.
        simulation.step_many(&mut world, 20);
        let places: Vec<Vec3> = world.query::<&Pose>().iter().map(|pose| pose.position).collect();
        assert!(places[0].distance(places[1]) > 0.105, "{places:?}");
    }
}
