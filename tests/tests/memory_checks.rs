//! Promise: a small world in which all that the engine has is at work, free bodies of every kind,
//! springs, attraction and contacts of every law, takes a few steps with the same bits on one
//! thread and on two.
//!
//! Why: it is what the unsafe code is run with under Miri and the sanitizers, where a step takes
//! seconds: CONTRIBUTING.md has the commands. Numbers of bodies are such that tiles and blocks are
//! filled up at their ends.

use hecs::World;
use rayon::ThreadPoolBuilder;
use tumble::math::{Quat, Real, Vec3};
use tumble::prelude::*;
use tumble::{Rng, Snapshot};
use tumble_benches::mixed_moving_bodies;
use tumble_tests::hash;
use tumble_tests::touching::{collider, cube, ground, spawn};

/// An interpreter is slow.
const STEPS: u32 = 3;

/// A heap about the origin, and beside it what is free, with a spring and a mass here and there.
fn world() -> World {
    let mut world = mixed_moving_bodies(19);
    ground(&mut world, Material::new(0.5, 0.3), Quat::IDENTITY);
    let mut rng = Rng::new(4);
    let mut heap = Vec::new();
    for id in 100..121 {
        let shape = match id % 4 {
            0 => Shape::sphere(0.25),
            1 => cube(0.2),
            2 => Shape::cylinder(0.2, 0.1),
            _ => Shape::capsule(0.1, 0.1),
        };
        let place = Vec3::new((id % 3) as Real * 0.4, 0.2 + (id / 3 % 7) as Real * 0.35, 0.0);
        let body = RigidBody::new(shape.clone()).without_collider().mass(1.0).id(BodyId(id)).position(place);
        let body = body.linear_velocity(rng.vector(-1.0, 1.0)).angular_velocity(rng.vector(-3.0, 3.0));
        heap.push(spawn(&mut world, body, collider(&shape)));
    }
    for pair in heap.chunks(2).filter(|pair| pair.len() == 2) {
        world.spawn((Spring::between(pair[0], pair[1]).with_stiffness(50.0).with_damping(0.5),));
        world.insert_one(pair[0], GravityMass::new(0.1)).unwrap();
    }
    world
}

#[test]
fn a_small_world_of_everything() {
    let mut ends = Vec::new();
    for threads in [1, 2] {
        for integrator in Integrator::ALL {
            let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut world = world();
            let mut simulation = Simulation::new(Settings::default().with_integrator(integrator)).unwrap();
            let ledger = (integrator == Integrator::MoserVeselov).then(|| Ledger::attach(&mut world, &simulation));
            pool.install(|| simulation.step_many(&mut world, STEPS));
            assert!(simulation.contacts().count() > 10, "little touches");
            let snapshot = simulation.snapshot(&world).unwrap();
            pool.install(|| simulation.step(&mut world));
            let ahead = hash(&world);
            let read = Snapshot::from_bytes(&snapshot.to_bytes()).unwrap();
            simulation.restore(&read, &mut world).unwrap();
            pool.install(|| simulation.step(&mut world));
            assert_eq!(hash(&world), ahead);
            if let Some(mut ledger) = ledger {
                assert_eq!(ledger.record(&world, &simulation).totals.non_finite, None);
            }
            ends.push(ahead);
        }
    }
    let (one, two) = ends.split_at(Integrator::ALL.len());
    assert_eq!(one, two);
}
