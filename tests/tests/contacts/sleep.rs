//! Promise: with [`Sleep`] bodies at rest are left out of the steps and stay where they are; they
//! wake when anything that holds them, touches them or acts on them changes, whoever changed it;
//! waking and falling asleep makes no energy.
//!
//! Why: an engine that forgets to wake a body leaves it hanging in the air, one that takes a
//! sleeping body for a wall loses momentum, and one that wakes too much never rests.

use hecs::{Entity, World};
use tumble::prelude::*;
use tumble::{BodyOrder, Work};
use tumble_tests::touching::{collider, spawn, surfaced};
use tumble_tests::{Draw, cases, dvec3, quat, real, run, vec3};

use crate::sleep_changes::column;

pub(crate) fn sleeping() -> Settings {
    Settings::default().with_sleep(Sleep::default())
}

pub(crate) fn asleep(simulation: &Simulation) -> usize {
    simulation.sleeping_bodies().count()
}

pub(crate) fn position(world: &World, body: Entity) -> Vec3 {
    world.get::<&Pose>(body).unwrap().position
}

/// A shape of about a size \[m\] that comes to rest on ground.
fn shape(draw: &mut Draw, size: f64) -> Shape {
    let mut half = || 0.5 * size * draw.between(0.4, 1.0);
    let (a, b, c) = (half(), half(), half());
    match draw.between(0.0, 4.0) as u32 {
        0 | 1 => Shape::cuboid([a, b, c]),
        2 => Shape::Capsule { radius: a, half_height: b },
        _ => Shape::cylinder(a, b),
    }
}

/// Bodies over ground, each with an identity, at about a size \[m\].
pub(crate) fn heap(draw: &mut Draw, size: f64, count: u64) -> (World, Vec<Entity>) {
    let mut world = World::new();
    let surface = Material { rolling_resistance: real(0.05 * size), ..Material::default() };
    let floor = RigidBody::new(Shape::Point).fixed().id(BodyId(0));
    spawn(&mut world, floor, surfaced(Collider::half_space(), surface));
    let bodies = (1..=count).map(|id| {
        let place = draw.vector(0.8 * size) + glam::DVec3::Y * size * (1.0 + 1.5 * id as f64);
        let shape = shape(draw, size);
        let body = RigidBody::new(shape.clone()).density(draw.log_between(100.0, 8000.0)).id(BodyId(id));
        let body = body.position(vec3(place)).orientation(quat(draw.orientation()));
        spawn(&mut world, body, surfaced(collider(&shape), surface))
    });
    let bodies = bodies.collect();
    (world, bodies)
}

/// Steps until all of `count` bodies sleep, at most for `most` seconds; returns the seconds.
fn until_all_sleep(simulation: &mut Simulation, world: &mut World, count: usize, most: f64) -> Option<f64> {
    let begin = simulation.time();
    while simulation.time() - begin < most {
        simulation.step(world);
        if asleep(simulation) == count {
            return Some(simulation.time() - begin);
        }
    }
    None
}

/// Whether a body spins upright on a point: it may do so for as long as it likes.
fn spins(world: &World, simulation: &Simulation, body: Entity) -> bool {
    let angular = dvec3(world.get::<&Velocity>(body).unwrap().angular);
    let touching = simulation.contacts().filter(|contact| contact.bodies.contains(&body));
    angular.x.hypot(angular.z) < 1e-3 * angular.y.abs() && touching.map(|it| it.points().len()).sum::<usize>() == 1
}

/// Heaps of three to eight bodies from a centimetre to ten metres, at 30 to 240 steps a second.
#[test]
fn heaps_fall_asleep_where_they_lie() {
    for case in 0..u64::from(cases(24)) {
        let mut draw = Draw::new(0x51EE, case);
        let size = draw.log_between(0.01, 10.0);
        let rate = draw.log_between(60.0, 240.0);
        let count = 3 + draw.between(0.0, 6.0) as u64;
        let (mut world, bodies) = heap(&mut draw, size, count);
        let settings = sleeping().with_dt(real(1.0 / rate));
        let mut simulation = Simulation::new(settings).unwrap();
        let slept = until_all_sleep(&mut simulation, &mut world, bodies.len(), 10.0 + 10.0 * size.sqrt());
        let spinning = bodies.iter().filter(|body| spins(&world, &simulation, **body)).count();
        assert!(
            slept.is_some() || asleep(&simulation) + spinning == bodies.len(),
            "case {case}, {size} m at {rate}/s: {} of {count} sleep",
            asleep(&simulation)
        );
        if slept.is_none() {
            continue;
        }
        let there: Vec<Pose> = bodies.iter().map(|body| *world.get::<&Pose>(*body).unwrap()).collect();
        simulation.step_many(&mut world, 60);
        for (body, pose) in bodies.iter().zip(&there) {
            assert_eq!(*world.get::<&Pose>(*body).unwrap(), *pose, "case {case}");
            assert_eq!(*world.get::<&Momentum>(*body).unwrap(), Momentum::default(), "case {case}");
        }
        // Without sleep they stay there too: nothing was caught in its fall.
        simulation.set_settings(settings.with_sleep(None)).unwrap();
        run(&mut simulation, &mut world, (rate as u32).max(1));
        for (body, pose) in bodies.iter().zip(&there) {
            let moved = (dvec3(position(&world, *body)) - dvec3(pose.position)).length();
            assert!(moved < 0.02 * size, "case {case}, {size} m at {rate}/s: {moved} m");
        }
    }
}

/// To wake and fall asleep again and again leaves a heap where it is, and makes no energy.
#[test]
fn waking_makes_no_energy() {
    for case in 0..u64::from(cases(8)) {
        let mut draw = Draw::new(0x51EF, case);
        let size = draw.log_between(0.05, 5.0);
        let (mut world, bodies) = heap(&mut draw, size, 6);
        let mut simulation = Simulation::new(sleeping()).unwrap();
        if until_all_sleep(&mut simulation, &mut world, bodies.len(), 30.0).is_none() {
            assert!(bodies.iter().any(|body| spins(&world, &simulation, *body)), "case {case}");
            continue;
        }
        let energy = |world: &World, simulation: &Simulation| {
            tumble::Totals::of(world, simulation.settings(), &BodyOrder::of(world)).energy()
        };
        let scale: f64 =
            world.query::<(&Mass, &Momentum)>().iter().map(|(mass, _)| mass.kilograms()).map(f64::from).sum();
        let mut last = energy(&world, &simulation);
        for _ in 0..6 {
            simulation.wake_all();
            simulation.step(&mut world);
            assert_eq!(asleep(&simulation), 0);
            until_all_sleep(&mut simulation, &mut world, bodies.len(), 10.0).unwrap();
            let now = energy(&world, &simulation);
            // Settling of contacts that begin again, in weights by lengths.
            assert!(now - last < 2e-4 * scale * 9.81 * size, "case {case}: {:e}", (now - last) / (scale * 9.81 * size));
            last = now;
        }
    }
}

/// A block that is shot at a row of sleeping ones on ice pushes them as if they were awake: in that
/// step momentum is kept, and what is hit moves.
#[test]
fn what_is_struck_wakes_within_the_step() {
    for case in 0..u64::from(cases(40)) {
        let mut draw = Draw::new(0x51F0, case);
        let size = draw.log_between(0.02, 20.0);
        let speed = draw.log_between(0.5, 100.0) * size;
        let ice = Material::default().with_friction(0.0).with_restitution(real(draw.between(0.0, 1.0)));
        let mut world = World::new();
        spawn(&mut world, RigidBody::new(Shape::Point).fixed(), surfaced(Collider::half_space(), ice));
        let shape = Shape::cuboid([0.5 * size; 3]);
        let put = |world: &mut World, x: f64, speed: f64| {
            let body = RigidBody::new(shape.clone()).mass(2.0).position(vec3(glam::DVec3::new(x, 0.5, 0.0) * size));
            let body = body.linear_velocity(vec3(glam::DVec3::X * speed));
            spawn(world, body, surfaced(collider(&shape), ice))
        };
        let row: Vec<_> = (0..3_u8).map(|i| put(&mut world, f64::from(i), 0.0)).collect();
        let mut simulation = Simulation::new(sleeping().with_restitution_threshold(0.0)).unwrap();
        simulation.step_many(&mut world, 60);
        assert_eq!(asleep(&simulation), 3);
        let shot = put(&mut world, -1.5 - draw.between(0.0, 3.0), speed);
        let along = |world: &World| -> f64 {
            let all = row.iter().chain([&shot]);
            all.map(|body| f64::from(world.get::<&Momentum>(*body).unwrap().linear.x)).sum()
        };
        let before = along(&world);
        let mut steps = 0;
        while asleep(&simulation) == 3 && steps < 600 {
            simulation.step(&mut world);
            steps += 1;
        }
        simulation.step_many(&mut world, 2);
        assert!((along(&world) / before - 1.0).abs() < 1e-4, "case {case}: {} of {before}", along(&world));
        let last = f64::from(world.get::<&Momentum>(row[2]).unwrap().linear.x);
        assert!(last > 0.02 * before, "case {case}, {size} m at {speed} m/s: the last has {last} of {before}");
    }
}

/// What moves by itself wakes what it comes to before it is in it, and lets nothing on it sleep.
#[test]
fn what_is_moved_by_itself_wakes() {
    for size in [0.05_f64, 0.5, 5.0] {
        let mut it = column(real(size));
        let piston = RigidBody::new(Shape::cuboid([0.5 * size; 3])).kinematic();
        let piston = piston.position(vec3(glam::DVec3::new(-8.0, 0.6, 0.0) * size));
        let speed = 10.0 * size;
        let piston = piston.linear_velocity(vec3(glam::DVec3::X * speed)).build().unwrap().spawn(&mut it.world);
        let mut deepest = 0.0_f64;
        for _ in 0..45 {
            it.simulation.step(&mut it.world);
            let apart = f64::from(position(&it.world, it.blocks[0]).x - position(&it.world, piston).x);
            deepest = deepest.max(size - apart);
        }
        assert!(deepest < 1e-2 * size, "{size} m: {deepest}");
        assert!(it.simulation.is_asleep(it.apart) && !it.simulation.is_asleep(it.blocks[0]), "{size} m");
    }
    let mut world = World::new();
    let plate = RigidBody::new(Shape::cuboid([2.0, 0.5, 2.0])).kinematic().linear_velocity(Vec3::X * 0.01);
    let plate = plate.build().unwrap().spawn(&mut world);
    let rider = RigidBody::new(Shape::cuboid([0.5; 3])).mass(2.0).position(Vec3::Y).build().unwrap().spawn(&mut world);
    let mut simulation = Simulation::new(sleeping()).unwrap();
    simulation.step_many(&mut world, 120);
    assert!(!simulation.is_asleep(rider));
    world.get::<&mut Velocity>(plate).unwrap().linear = Vec3::ZERO;
    simulation.step_many(&mut world, 60);
    assert!(simulation.is_asleep(rider));
    world.get::<&mut Velocity>(plate).unwrap().linear = Vec3::Y;
    simulation.step(&mut world);
    assert!(!simulation.is_asleep(rider));
}

/// A belt that runs, a thruster, a spring, free motion: nothing of that rests.
#[test]
fn what_is_driven_does_not_sleep() {
    let belt = Material { surface_velocity: Vec3::X * 0.01, ..Material::default() };
    let mut world = World::new();
    let block = RigidBody::new(Shape::cuboid([0.5; 3])).mass(2.0);
    spawn(&mut world, RigidBody::new(Shape::Point).fixed(), surfaced(Collider::half_space(), belt));
    let on_belt = block.clone().position(Vec3::Y * 0.5).build().unwrap().spawn(&mut world);
    let adrift = block.clone().gravity_scale(0.0).position(Vec3::Y * 50.0).linear_velocity(Vec3::X * 0.01);
    let adrift = adrift.build().unwrap().spawn(&mut world);
    let still = block.clone().gravity_scale(0.0).position(Vec3::Y * 60.0).build().unwrap().spawn(&mut world);
    let pulled = block.clone().gravity_scale(0.0).position(Vec3::Y * 70.0).build().unwrap().spawn(&mut world);
    world.spawn((Spring::between(still, pulled),));
    let mut simulation = Simulation::new(sleeping()).unwrap();
    simulation.step_many(&mut world, 120);
    for (body, name) in [(on_belt, "on a belt"), (adrift, "adrift"), (pulled, "on a spring"), (still, "on a spring")] {
        assert!(!simulation.is_asleep(body), "{name}");
    }
    let lone = block.gravity_scale(0.0).position(Vec3::Y * 80.0).build().unwrap().spawn(&mut world);
    simulation.step_many(&mut world, 60);
    assert!(simulation.is_asleep(lone), "without motion and force");
}

/// What hangs on joints sleeps as a whole, carries what it carried, and wakes with its joints.
#[test]
fn mechanisms_sleep_as_a_whole() {
    let mut world = World::new();
    let at = |i: u8| Vec3::Y * (5.0 - 0.4 * Real::from(i));
    let mut last = RigidBody::new(Shape::cuboid([0.1; 3])).fixed().position(at(0)).build().unwrap().spawn(&mut world);
    let mut joints = Vec::new();
    for i in 1..=5 {
        let link = RigidBody::new(Shape::cuboid([0.05, 0.15, 0.05])).mass(1.0).position(at(i));
        let link = link.build().unwrap().spawn(&mut world);
        let joint = Joint::ball(last, link).at_point(&world, (at(i) + at(i - 1)) * 0.5).unwrap();
        joints.push(world.spawn((joint, JointLoad::default())));
        last = link;
    }
    let load = |world: &World| world.get::<&JointLoad>(joints[0]).unwrap().force.y.abs();
    let mut simulation = Simulation::new(sleeping()).unwrap();
    for _ in 0..2 {
        simulation.step_many(&mut world, 90);
        assert_eq!(asleep(&simulation), 5);
        assert!((load(&world) - 5.0 * 9.81).abs() < 1e-2, "{}", load(&world));
    }
    // Another frame of one joint, and then one joint less.
    let softer = Limits::default();
    world.insert_one(joints[4], softer).unwrap();
    simulation.step(&mut world);
    assert_eq!(asleep(&simulation), 0);
    simulation.step_many(&mut world, 90);
    assert_eq!(asleep(&simulation), 5);
    world.despawn(joints[2]).unwrap();
    simulation.step(&mut world);
    assert_eq!(asleep(&simulation), 0);
    assert!((load(&world) - 2.0 * 9.81).abs() < 0.5, "{}", load(&world));
}

/// To fall asleep, to sleep and to wake is no event; contacts stay known, and sensors keep sensing.
#[test]
fn contacts_and_sensors_know_who_sleeps() {
    let mut world = World::new();
    spawn_ground(&mut world);
    RigidBody::new(Shape::cuboid([3.0; 3])).fixed().sensor().build().unwrap().spawn(&mut world);
    let block = RigidBody::new(Shape::cuboid([0.5; 3])).mass(2.0);
    let mut put =
        |level: u8| block.clone().position(Vec3::Y * (0.5 + Real::from(level))).build().unwrap().spawn(&mut world);
    let blocks: Vec<_> = (0..4).map(&mut put).collect();
    let mut simulation = Simulation::new(sleeping()).unwrap();
    simulation.step_many(&mut world, 20);
    let (mut contacts, mut sensors) = (0, 0);
    let mut count = |simulation: &Simulation| {
        contacts += simulation.contact_events().count();
        sensors += simulation.sensor_events().count();
    };
    for step in 0..120 {
        if step == 60 {
            assert_eq!(asleep(&simulation), 4);
            simulation.wake(blocks[0]);
        }
        simulation.step(&mut world);
        count(&simulation);
    }
    assert_eq!((contacts, sensors, asleep(&simulation)), (0, 0, 4));
    assert_eq!((simulation.contacts().count(), simulation.sensed().count()), (4, 4));
    let substep = simulation.settings().contact_substep();
    let lowest = simulation.contacts().next().unwrap();
    let force: Real = lowest.points().iter().map(|point| point.impulse).sum::<Real>() / substep;
    assert!((force - 8.0 * 9.81).abs() < 0.1, "{force} N");
    world.despawn(blocks[1]).unwrap();
    simulation.step(&mut world);
    let ended = simulation.contact_events().filter(|event| matches!(event, ContactEvent::End(_))).count();
    assert_eq!((ended, simulation.sensor_events().count()), (2, 1));
}

/// The works of all add up to what the kinetic energy is, also of what fell asleep.
#[test]
fn the_ledger_adds_up() {
    let (mut world, bodies) = heap(&mut Draw::new(0x51F4, 0), 0.5, 6);
    let mut simulation = Simulation::new(sleeping()).unwrap();
    Ledger::attach(&mut world, &simulation);
    until_all_sleep(&mut simulation, &mut world, bodies.len(), 30.0).unwrap();
    let mut given_up = 0.0;
    for body in &bodies {
        let work = *world.get::<&Work>(*body).unwrap();
        assert!(work.total().abs() < 1e-3 * work.gravity.abs(), "{work:?}");
        let mass = f64::from(world.get::<&Mass>(*body).unwrap().kilograms());
        assert!(work.sleep <= 0.0 && work.sleep > -mass * 0.05 * 0.05, "{work:?}");
        given_up += work.sleep;
    }
    assert!(given_up < 0.0);
}

/// Anything is spawned, despawned, moved, pushed, joined and taken apart at random, and in the end
/// nothing sleeps that would move if it were awake.
#[test]
fn nothing_sleeps_that_would_move() {
    for case in 0..u64::from(cases(16)) {
        let mut draw = Draw::new(0x51F5, case);
        let size = draw.log_between(0.05, 3.0);
        let (mut world, mut bodies) = heap(&mut draw, size, 6);
        let mut joints: Vec<Entity> = Vec::new();
        let mut simulation = Simulation::new(sleeping()).unwrap();
        for _ in 0..24 {
            simulation.step_many(&mut world, draw.between(1.0, 60.0) as u32);
            let which = draw.between(0.0, bodies.len() as f64) as usize;
            let body = bodies[which];
            match draw.between(0.0, 8.0) as u32 {
                0 => {
                    let shape = shape(&mut draw, size);
                    let place = draw.vector(size) + glam::DVec3::Y * 6.0 * size;
                    bodies.push(spawn(
                        &mut world,
                        RigidBody::new(shape.clone()).density(900.0).position(vec3(place)),
                        collider(&shape),
                    ));
                }
                1 if bodies.len() > 3 => {
                    world.despawn(body).unwrap();
                    bodies.swap_remove(which);
                }
                2 => {
                    let push =
                        draw.vector(3.0 * size.sqrt()) * f64::from(world.get::<&Mass>(body).unwrap().kilograms());
                    world.get::<&mut Momentum>(body).unwrap().apply_impulse(vec3(push));
                }
                3 => world.get::<&mut Pose>(body).unwrap().position.y += real(size),
                4 => {
                    let other = bodies[(which + 1) % bodies.len()];
                    let middle = (position(&world, body) + position(&world, other)) * 0.5;
                    if let Ok(joint) = Joint::ball(body, other).at_point(&world, middle) {
                        joints.push(world.spawn((joint,)));
                    }
                }
                5 if !joints.is_empty() => world.despawn(joints.swap_remove(0)).unwrap(),
                6 => {
                    let smaller = shape(&mut draw, 0.8 * size);
                    world.insert_one(body, collider(&smaller)).unwrap();
                }
                _ => simulation.wake(body),
            }
        }
        simulation.step_many(&mut world, 240);
        let slept: Vec<(Entity, Pose)> =
            simulation.sleeping_bodies().map(|body| (body, *world.get::<&Pose>(body).unwrap())).collect();
        simulation.set_settings(simulation.settings().with_sleep(None)).unwrap();
        // Half a second in which what is not held falls by more than a metre.
        simulation.step_many(&mut world, 30);
        for (body, pose) in slept {
            let moved = (dvec3(position(&world, body)) - dvec3(pose.position)).length();
            assert!(moved < 0.02 * size + 0.01, "case {case}, {size} m: {moved} m");
        }
    }
}

/// A body without collider and joint is known by its entity.
#[test]
fn what_is_locked_alone_sleeps_by_its_name() {
    let mut world = World::new();
    let body = RigidBody::new(Shape::sphere(0.5)).without_collider().mass(1.0).gravity_scale(0.0).build().unwrap();
    let body = body.spawn_with(&mut world, (LockedAxes(Axes::LINEAR),));
    let mut simulation = Simulation::new(sleeping()).unwrap();
    simulation.step_many(&mut world, 60);
    assert!(simulation.is_asleep(body));
    assert_eq!(simulation.sleeping_bodies().collect::<Vec<_>>(), [body]);
}

/// What is let go at rest falls, however short the time of sleep.
#[test]
fn nothing_sleeps_in_the_air() {
    for time in [1e-6, 0.01, 0.1] {
        let mut world = World::new();
        spawn_ground(&mut world);
        let ball = RigidBody::new(Shape::sphere(0.5)).mass(1.0).position(Vec3::Y * 5.0);
        let ball = ball.build().unwrap().spawn(&mut world);
        let settings = Settings::default().with_sleep(Sleep { time, ..Sleep::default() });
        let mut simulation = Simulation::new(settings).unwrap();
        simulation.step_many(&mut world, 30);
        assert!(position(&world, ball).y < 4.0, "{time} s: {}", position(&world, ball));
    }
}

#[test]
fn senseless_settings_are_refused() {
    for (sleep, field) in [
        (Sleep { speed: -1.0, ..Sleep::default() }, "sleep.speed"),
        (Sleep { speed: Real::NAN, ..Sleep::default() }, "sleep.speed"),
        (Sleep { time: 0.0, ..Sleep::default() }, "sleep.time"),
        (Sleep { time: Real::INFINITY, ..Sleep::default() }, "sleep.time"),
    ] {
        assert_eq!(Settings::default().with_sleep(sleep).validate().unwrap_err().field(), field);
    }
}
