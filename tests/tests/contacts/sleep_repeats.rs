//! Promise: who sleeps, and every bit of the state, is the same after a rewind, in another world,
//! with any number of threads, and in a batch.
//!
//! Why: sleep is state of the simulation beside the bodies; what a snapshot forgets of it shows a
//! second later.

use hecs::{Entity, World};
use tumble::prelude::*;
use tumble::{Batch, BodyOrder, Trial, state_hash};
use tumble_tests::touching::{collider, spawn};
use tumble_tests::{Draw, cases, run, vec3};

use crate::sleep::{asleep, heap, sleeping};

fn hash(world: &World) -> u64 {
    state_hash(world, &BodyOrder::of(world))
}

/// Who sleeps, and the state, after this many steps of a heap that is disturbed on the way.
fn disturbed(world: &mut World, simulation: &mut Simulation, steps: std::ops::Range<u32>) {
    for step in steps {
        if step % 70 == 69 {
            let order = BodyOrder::of(world);
            let body = order.entities()[1 + (step as usize / 70) % (order.entities().len() - 1)];
            if let Ok(mut momentum) = world.get::<&mut Momentum>(body) {
                momentum.apply_impulse(Vec3::new(0.3, 0.0, 0.1) * world.get::<&Mass>(body).unwrap().kilograms());
            }
        }
        simulation.step(world);
    }
}

#[test]
fn rewinds_are_exact() {
    for case in 0..u64::from(cases(6)) {
        let mut draw = Draw::new(0x51F1, case);
        let size = draw.log_between(0.05, 2.0);
        let make = |draw: &mut Draw| heap(draw, size, 7).0;
        let mut again = Draw::new(0x51F2, case);
        let mut world = make(&mut again);
        let mut simulation = Simulation::new(sleeping()).unwrap();
        let mut files = Vec::new();
        for step in 0..300 {
            if step % 23 == 0 {
                files.push((step, simulation.snapshot(&world).unwrap().to_bytes(), asleep(&simulation)));
            }
            disturbed(&mut world, &mut simulation, step..step + 1);
        }
        let there = (hash(&world), simulation.sleeping_bodies().count());
        assert!(files.iter().any(|(.., asleep)| *asleep > 0), "case {case}: none slept");
        for (step, file, asleep_then) in files {
            let mut other = make(&mut Draw::new(0x51F2, case));
            let mut fresh = Simulation::new(sleeping()).unwrap();
            let snapshot = Snapshot::from_bytes(&file).unwrap();
            fresh.restore(&snapshot, &mut other).unwrap();
            assert_eq!(fresh.snapshot(&other).unwrap().to_bytes(), file, "case {case}, step {step}");
            disturbed(&mut other, &mut fresh, step..300);
            assert_eq!((hash(&other), asleep(&fresh)), there, "case {case}, step {step}, {asleep_then} asleep");
        }
    }
}

/// A box that another mass or scale of gravity has woken falls asleep in the same step, also where
/// the first step after it was taken back.
#[test]
fn what_weighs_otherwise_falls_asleep_at_the_same_time_after_a_rewind() {
    let changes: [fn(&mut World, Entity); 2] = [
        |world, body| *world.get::<&mut Mass>(body).unwrap() = Mass::new(2.0).unwrap(),
        |world, body| world.insert_one(body, GravityScale(0.7)).unwrap(),
    ];
    for change in changes {
        let mut world = World::new();
        spawn_ground(&mut world);
        let body = RigidBody::new(Shape::cuboid([0.5; 3])).mass(1.0).position(Vec3::Y * 0.5).id(BodyId(1));
        let body = body.build().unwrap().spawn(&mut world);
        let mut simulation = Simulation::new(sleeping()).unwrap();
        run(&mut simulation, &mut world, 90);
        assert_eq!(asleep(&simulation), 1);
        change(&mut world, body);
        simulation.step(&mut world);
        let snapshot = simulation.snapshot(&world).unwrap();
        let mut asleep_by_step = || -> Vec<usize> {
            let mut step = || {
                simulation.step(&mut world);
                asleep(&simulation)
            };
            let by_step = (0..90).map(|_| step()).collect();
            simulation.restore(&snapshot, &mut world).unwrap();
            by_step
        };
        let first = asleep_by_step();
        assert_eq!((first[0], first[89]), (0, 1));
        assert_eq!(asleep_by_step(), first);
    }
}

/// A heap that something passes, after it has fallen asleep.
fn passed(case: u64, has_sensor: bool) -> World {
    let mut draw = Draw::new(0x51F7, case);
    let size = draw.log_between(0.02, 2.0);
    let (mut world, _) = heap(&mut draw, size, 5);
    let (shape, way) = (Shape::sphere(0.3 * size), glam::DVec3::X * size * draw.log_between(0.3, 3.0));
    let place = glam::DVec3::new(0.0, draw.between(0.4, 3.0), draw.between(-2.0, 2.0)) * size;
    let passer = RigidBody::new(shape.clone()).kinematic().id(BodyId(100)).position(vec3(place - way * 11.5));
    spawn(&mut world, passer.linear_velocity(vec3(way)), collider(&shape));
    if has_sensor {
        let sensor = RigidBody::new(Shape::Point).fixed().position(vec3(glam::DVec3::Y * 1e5));
        spawn(&mut world, sensor, collider(&Shape::sphere(1.0)).sensor());
    }
    world
}

/// What passes wakes the same bodies in the same step after a rewind, and with a sensor far away:
/// it depends on how near it comes, not on where the search for pairs had bodies before.
#[test]
fn what_passes_wakes_the_same_bodies() {
    let (mut wakes, mut stays) = (0, 0);
    for case in 0..u64::from(cases(40)) {
        let (mut world, mut simulation) = (passed(case, false), Simulation::new(sleeping()).unwrap());
        let (mut other, mut beside) = (passed(case, true), Simulation::new(sleeping()).unwrap());
        simulation.step_many(&mut world, 590);
        beside.step_many(&mut other, 590);
        let mut rewound: Vec<(World, Simulation)> = Vec::new();
        let before = asleep(&simulation);
        let mut least = before;
        for step in 590..790 {
            if step % 25 == 0 {
                let mut again = (passed(case, false), Simulation::new(sleeping()).unwrap());
                again.1.restore(&simulation.snapshot(&world).unwrap(), &mut again.0).unwrap();
                rewound.push(again);
            }
            simulation.step(&mut world);
            let there = (asleep(&simulation), hash(&world));
            for (number, (world, simulation)) in rewound.iter_mut().enumerate() {
                simulation.step(world);
                assert_eq!((asleep(simulation), hash(world)), there, "case {case}, step {step}, rewind {number}");
            }
            beside.step(&mut other);
            assert_eq!(asleep(&beside), there.0, "case {case}, step {step}, with a sensor");
            least = least.min(there.0);
        }
        wakes += u32::from(least < before);
        stays += u32::from(before > 0 && least == before);
    }
    let few = cases(5);
    assert!(wakes > few && stays > few, "{wakes} heaps woke, {stays} did not");
}

/// In a simulation without sleep they are awake.
#[test]
fn who_slept_is_awake_where_nothing_sleeps() {
    let (mut world, bodies) = heap(&mut Draw::new(0x51F6, 0), 0.5, 4);
    let mut simulation = Simulation::new(sleeping()).unwrap();
    simulation.step_many(&mut world, 600);
    assert_eq!(asleep(&simulation), bodies.len());
    let snapshot = simulation.snapshot(&world).unwrap();
    let mut other = Simulation::new(Settings::default()).unwrap();
    other.restore(&snapshot, &mut world).unwrap();
    other.set_settings(Settings::default().with_gravity(Vec3::Y)).unwrap();
    other.step_many(&mut world, 60);
    assert_eq!(asleep(&other), 0);
    for body in bodies {
        let speed = world.get::<&Velocity>(body).unwrap().linear.y;
        assert!((speed - 1.0).abs() < 0.1, "{speed} m/s");
    }
}

#[test]
fn neither_threads_nor_order_nor_a_batch_matter() {
    let draw = || Draw::new(0x51F3, 1);
    let after = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let (mut world, _) = heap(&mut draw(), 0.5, 40);
            let mut simulation = Simulation::new(sleeping()).unwrap();
            disturbed(&mut world, &mut simulation, 0..400);
            (hash(&world), asleep(&simulation))
        })
    };
    let one = after(1);
    assert!(one.1 > 0, "none sleeps");
    assert_eq!([after(2), after(4)], [one; 2]);
    let (mut world, _) = heap(&mut draw(), 0.5, 40);
    let mut simulation = Simulation::new(sleeping()).unwrap();
    simulation.step_many(&mut world, 400);
    let alone = (hash(&world), asleep(&simulation));
    let mut batch = Batch::new();
    for _ in 0..3 {
        batch.push(Trial::new(sleeping(), heap(&mut draw(), 0.5, 40).0).unwrap());
    }
    batch.step_many(400);
    for trial in batch.trials() {
        assert_eq!((hash(&trial.world), asleep(&trial.simulation)), alone);
    }
}
