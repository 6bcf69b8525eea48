//! Promise: a step of a small world takes place on the thread that calls it, alone: it needs no
//! other thread, neither to begin nor to end. And whether threads share a step changes no bit.
//!
//! Why: on a busy machine another thread may not run for milliseconds, and a step that waits for it
//! hitches. It fails if something small is handed to a pool.

use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use hecs::World;
use proptest::prelude::*;
use proptest::test_runner::TestRunner;
use tumble::math::{Quat, Real, Vec3};
use tumble::prelude::*;
use tumble::{Ledger, Rng};
use tumble_benches::pool;
use tumble_tests::touching::{collider, cube, ground, spawn};
use tumble_tests::{hash, run};

/// Bodies of all shapes in a heap, some with springs or joints, some that attract each other, by a
/// number.
fn heap(seed: u64, count: usize) -> World {
    let mut rng = Rng::new(seed);
    let mut world = World::new();
    ground(&mut world, Material::default(), Quat::IDENTITY);
    let kinds = rng.next_u64();
    let mut bodies = Vec::new();
    for i in 0..count {
        let shape = match (kinds >> (2 * (i % 8))) % 5 {
            0 => Shape::sphere(0.2),
            1 => Shape::cylinder(0.2, 0.2),
            2 => Shape::cone(0.2, 0.2),
            3 => Shape::ellipsoid([0.2, 0.15, 0.1]),
            _ => cube(0.2),
        };
        let place = rng.vector(-0.8, 0.8) + Vec3::Y * (1.0 + 0.04 * i as Real);
        let body = RigidBody::new(shape.clone()).mass(1.0).position(place).orientation(rng.orientation());
        bodies.push(spawn(&mut world, body, collider(&shape)));
    }
    for pair in bodies.windows(2).filter(|_| kinds & 1 << 40 != 0) {
        world.spawn((Spring::between(pair[0], pair[1]).with_stiffness(5.0).with_damping(1.0),));
    }
    for pair in bodies.chunks_exact(2).filter(|_| kinds & 1 << 42 != 0) {
        let joint = Joint::ball(pair[0], pair[1]).at_point(&world, Vec3::Y).unwrap();
        world.spawn((joint, JointLoad::default()));
    }
    if kinds & 1 << 41 != 0 {
        bodies.iter().for_each(|body| world.insert_one(*body, GravityMass::of_kilograms(1e9)).unwrap());
    }
    world
}

/// Calls `then` while all threads of the pool of this process wait for something else.
fn without_a_pool(then: impl FnOnce() + Send + 'static) {
    let (begun, wait_for_begin) = mpsc::channel();
    let mut releases = Vec::new();
    for _ in 0..rayon::current_num_threads() {
        let (release, wait) = mpsc::channel::<()>();
        let begun = begun.clone();
        rayon::spawn(move || {
            begun.send(()).unwrap();
            let _ = wait.recv();
        });
        releases.push(release);
    }
    releases.iter().for_each(|_| wait_for_begin.recv().unwrap());
    let (done, wait_for_end) = mpsc::channel();
    let steps = thread::spawn(move || {
        then();
        done.send(()).unwrap();
    });
    // Far longer than it takes: who waits for the pool waits for ever.
    let ended = wait_for_end.recv_timeout(Duration::from_secs(300));
    drop(releases);
    steps.join().unwrap();
    assert!(ended.is_ok(), "a small world waited for another thread");
}

#[test]
fn small_worlds_need_no_other_thread() {
    without_a_pool(|| {
        let mut cases = TestRunner::new(ProptestConfig::with_cases(16));
        cases
            .run(&(any::<u64>(), 1_usize..25, any::<bool>()), |(seed, count, booked)| {
                let mut world = heap(seed, count);
                let mut simulation = Simulation::new(Settings::default()).unwrap();
                if booked {
                    Ledger::attach(&mut world, &simulation);
                }
                run(&mut simulation, &mut world, 60);
                simulation.step_many(&mut world, 60);
                simulation.advance(&mut world, 0.1);
                Ok(())
            })
            .unwrap();
        // And many that nothing couples.
        let mut world = tumble_benches::mixed_bodies(3000);
        let mut simulation = Simulation::new(Settings::default()).unwrap();
        run(&mut simulation, &mut world, 5);
    });
}

/// Heaps above and below what is shared, from outside a pool and from within.
#[test]
fn who_takes_the_step_changes_no_bit() {
    for (seed, count) in [(1, 30), (2, 300), (3, 900)] {
        let ends = [None, Some(pool(1)), Some(pool(2)), Some(pool(3))].map(|pool| {
            let mut world = heap(seed, count);
            let mut simulation = Simulation::new(Settings::default()).unwrap();
            let mut steps = || run(&mut simulation, &mut world, 20);
            match pool {
                Some(pool) => pool.install(steps),
                None => steps(),
            }
            hash(&world)
        });
        assert!(ends.iter().all(|end| *end == ends[0]), "{count}: {ends:x?}");
    }
}
