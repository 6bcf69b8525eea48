//! Promise: sensors tell what is in them: after each step those bodies that queries find there,
//! each coming and going once, however steps fall into frames; what passes through one within a
//! step comes in and leaves in it; and nothing moves otherwise for it.
//!
//! Why: a trigger that is missed at a hundred metres a second, or that fires twice, is a door that
//! stays shut. It fails if a pair is left out by the search, if something comes twice or in
//! another order, or if a sensor pushes.

use std::collections::BTreeSet;

use hecs::{Entity, World};
use tumble::math::{Quat, Vec3};
use tumble::prelude::*;
use tumble::{Batch, QueryFilter, SensorEvent, Trial};
use tumble_tests::touching::collider;
use tumble_tests::{Draw, quat, real, vec3};

fn shape(draw: &mut Draw) -> Shape {
    let [a, b, c] = [(); 3].map(|()| draw.log_between(0.05, 1.0));
    match draw.between(0.0, 5.0) as u32 {
        0 => Shape::sphere(a),
        1 => Shape::cuboid([a, b, c]),
        2 => Shape::Capsule { radius: a, half_height: b },
        3 => Shape::Cylinder { radius: a, half_height: b },
        _ => Shape::ellipsoid([a, b, c]),
    }
}

/// A body of any kind about the origin: solid, a sensor, or with a part that is one.
fn spawn_any(world: &mut World, draw: &mut Draw, id: u64) -> Entity {
    let shape = shape(draw);
    let mut body = RigidBody::new(shape.clone()).density(500.0).id(BodyId(id));
    let speed = draw.log_between(0.1, 60.0);
    body = body.position(vec3(draw.vector(3.0))).orientation(quat(draw.orientation()));
    body = match draw.between(0.0, 5.0) as u32 {
        0 => body.fixed(),
        1 => body.kinematic().linear_velocity(vec3(draw.direction() * 2.0)).angular_velocity(vec3(draw.vector(3.0))),
        _ => body.linear_velocity(vec3(draw.direction() * speed)).angular_velocity(vec3(draw.vector(20.0))),
    };
    let collider = match draw.between(0.0, 4.0) as u32 {
        0 => collider(&shape).sensor(),
        1 => {
            let place = Pose { position: vec3(draw.vector(0.5)), ..Pose::default() };
            let whisker = collider(&Shape::sphere(draw.log_between(0.05, 1.5))).with_offset(place).unwrap().sensor();
            Collider::compound([collider(&shape), whisker]).unwrap()
        }
        _ => collider(&shape),
    };
    let groups = if draw.often(0.2) { (2, !1) } else { (1, !0) };
    body.build().unwrap().spawn_with(world, (collider.with_groups(groups.0, groups.1),))
}

fn world_of(case: u64) -> World {
    let mut draw = Draw::new(2310, case);
    let mut world = World::new();
    for id in 0..draw.between(2.0, 40.0) as u64 {
        spawn_any(&mut world, &mut draw, id);
    }
    world
}

fn settings(case: u64) -> Settings {
    Settings::default().with_gravity(Vec3::ZERO).with_substeps(1 + (case % 2) as u32)
}

/// What queries say to be in sensors, in order.
fn by_queries(simulation: &Simulation, world: &World) -> Vec<(Entity, u32, Entity)> {
    let queries = simulation.queries(world);
    let mut all = Vec::new();
    let is_fixed = |entity: Entity| !world.satisfies::<&Velocity>(entity);
    for entity in tumble::BodyOrder::of(world).entities() {
        let (pose, whole) = (*world.get::<&Pose>(*entity).unwrap(), world.get::<&Collider>(*entity).unwrap());
        let mut frame = pose;
        if let Ok(center) = world.get::<&CenterOfMass>(*entity) {
            frame.position -= frame.orientation * center.0;
        }
        // The sensor alone, at its place.
        let (part, sensor) = match whole.is_sensor() {
            true => (0, (*whole).clone()),
            false => match world.get::<&Whisker>(*entity) {
                Ok(whisker) => (1, whisker.0.clone()),
                Err(_) => continue,
            },
        };
        let groups = whole.groups();
        let filter = QueryFilter::new().with_groups(groups.0, groups.1).without(*entity);
        let found = queries.overlapping(&sensor, &frame, &filter);
        let found: BTreeSet<_> =
            found.iter().map(|hit| (world.get::<&BodyId>(hit.entity).unwrap().0, hit.entity)).collect();
        let both_fixed = |other: Entity| is_fixed(*entity) && is_fixed(other);
        all.extend(found.into_iter().filter(|(_, other)| !both_fixed(*other)).map(|(_, other)| (*entity, part, other)));
    }
    all
}

/// The part of a compound that is a sensor, by itself.
struct Whisker(Collider);

/// As [`world_of`], with what the sensors are.
fn world_with_whiskers(case: u64) -> World {
    let mut draw = Draw::new(2311, case);
    let mut world = World::new();
    for id in 0..draw.between(2.0, 40.0) as u64 {
        let entity = spawn_any(&mut world, &mut draw, id);
        if draw.often(0.4) {
            let place = Pose { position: vec3(draw.vector(0.5)), orientation: quat(draw.orientation()) };
            let own = (*world.get::<&Collider>(entity).unwrap()).clone();
            if own.is_sensor() || own.materials().count() > 1 {
                continue;
            }
            let groups = own.groups();
            let whisker =
                collider(&shape(&mut draw)).with_offset(place).unwrap().sensor().with_groups(groups.0, groups.1);
            let both = Collider::compound([own, whisker.clone()]).unwrap();
            world.insert(entity, (both, Whisker(whisker))).unwrap();
        }
    }
    // Of other compounds it is not known what the sensor is.
    let unknown = |(entity, collider): (Entity, &Collider)| (collider.materials().count() > 1, entity);
    let all: Vec<_> = world.query::<(Entity, &Collider)>().iter().map(unknown).collect();
    for (_, entity) in all.into_iter().filter(|(is_compound, _)| *is_compound) {
        if !world.satisfies::<&Whisker>(entity) {
            world.despawn(entity).unwrap();
        }
    }
    world
}

/// After every step what is in sensors is what queries find there, and the events are the changes.
#[test]
fn what_is_in_sensors_is_what_queries_find_there() {
    let (mut inside, mut changes, mut passages) = (0, 0, 0);
    for case in 0..80 {
        let mut world = world_with_whiskers(case);
        let mut simulation = Simulation::new(settings(2 * case)).unwrap();
        let mut before: Vec<(Entity, u32, Entity)> = Vec::new();
        for step in 0..90 {
            simulation.step(&mut world);
            let now: Vec<_> = simulation.sensed().map(|it| (it.sensor, it.part, it.body)).collect();
            assert_eq!(now, by_queries(&simulation, &world), "case {case}, step {step}");
            // Events lead from what was to what is; what passes through comes twice.
            let mut replayed: BTreeSet<_> = before.iter().copied().collect();
            for event in simulation.sensor_events() {
                let key = (event.sensor, event.part, event.body);
                let is_new = if event.begins { replayed.insert(key) } else { replayed.remove(&key) };
                assert!(is_new, "case {case}, step {step}: {event:?} comes twice");
                changes += 1;
            }
            assert_eq!(replayed, now.iter().copied().collect(), "case {case}, step {step}");
            let begun = simulation.sensor_events().filter(|event| event.begins).count();
            let stayed = now.iter().filter(|key| !before.contains(key)).count();
            passages += begun - stayed;
            inside += now.len();
            before = now;
        }
    }
    assert!(inside > 1000 && changes > 300 && passages > 10, "{inside} {changes} {passages}");
}

/// Bullets of all kinds through thin plates, balls and rods, still and moving: each comes in and
/// leaves once, at any speed and step; those that pass beside do neither.
#[test]
fn what_passes_through_comes_in_and_leaves() {
    for case in 0..3000 {
        let mut draw = Draw::new(2312, case);
        let mut world = World::new();
        let thin = draw.log_between(0.001, 0.1);
        let plate = match draw.between(0.0, 3.0) as u32 {
            0 => Shape::cuboid([1.0, thin, 1.0]),
            1 => Shape::Cylinder { radius: 1.0, half_height: thin },
            _ => Shape::sphere(1.0),
        };
        let drift = vec3(draw.vector(3.0));
        let gate = RigidBody::new(plate.clone()).kinematic().linear_velocity(drift);
        let gate = gate.build().unwrap().spawn_with(&mut world, (collider(&plate).sensor(),));
        let speed = draw.log_between(1.0, 1000.0);
        let size = draw.log_between(0.01, 0.1);
        let bullet = match draw.between(0.0, 3.0) as u32 {
            0 => Shape::sphere(size),
            1 => Shape::cuboid([size, 0.5 * size, 2.0 * size]),
            _ => Shape::Capsule { radius: 0.3 * size, half_height: size },
        };
        let misses = draw.often(0.3);
        let across = draw.between(-0.4, 0.4) + if misses { 1.6 } else { 0.0 };
        let from = Vec3::new(real(across), real(draw.between(3.0, 9.0)), real(draw.between(-0.4, 0.4)));
        let body = RigidBody::new(bullet.clone())
            .mass(0.1)
            .position(from)
            .orientation(quat(draw.orientation()))
            .angular_velocity(vec3(draw.vector(10.0)))
            .linear_velocity(drift - Vec3::Y * real(speed));
        let body = body.build().unwrap().spawn_with(&mut world, (collider(&bullet),));
        let dt = real(1.0 / draw.log_between(20.0, 240.0));
        let settings = Settings::default().with_gravity(Vec3::ZERO).with_dt(dt);
        let mut simulation = Simulation::new(settings).unwrap();
        let mut events = Vec::new();
        while f64::from(simulation.steps() as f32) * f64::from(dt) * speed < 20.0 {
            simulation.step(&mut world);
            events.extend(simulation.sensor_events());
        }
        let comes = SensorEvent { sensor: gate, part: 0, body, begins: true };
        let expected = if misses { vec![] } else { vec![comes, SensorEvent { begins: false, ..comes }] };
        assert_eq!(events, expected, "case {case}: {speed} m/s, {plate:?}, {bullet:?}");
    }
}

/// An arm that turns about z by up to ten turns in a step passes what is within its angles, each
/// time, and nothing else: not what is on the short way between two ends that the long way joins.
#[test]
fn what_turns_through_comes_in_and_leaves() {
    let (mut passed, mut missed) = (0, 0);
    for case in 0..400 {
        let mut draw = Draw::new(2314, case);
        let mut world = World::new();
        let size = draw.log_between(0.05, 20.0);
        let (thin, radius, at) = (0.01 * size, draw.log_between(0.01, 0.05) * size, draw.between(0.4, 0.8) * size);
        let arm = Shape::cuboid([0.5 * size, thin, thin]);
        let place = Pose { position: Vec3::X * real(0.5 * size), ..Pose::default() };
        let turn = draw.log_between(0.3, 60.0);
        let settings = Settings::default().with_gravity(Vec3::ZERO).with_dt(1.0 / real(draw.log_between(30.0, 240.0)));
        let body = RigidBody::new(Shape::sphere(0.1 * size));
        let body = if draw.often(0.5) { body.kinematic() } else { body.mass(1.0) };
        let way = if draw.often(0.5) { 1.0 } else { -1.0 };
        let start = draw.between(-3.0, 3.0);
        let body = body
            .orientation(Quat::from_rotation_z(real(start)))
            .angular_velocity(Vec3::Z * real(way * turn / f64::from(settings.dt)));
        let body = body.build().unwrap().spawn_with(&mut world, (collider(&arm).with_offset(place).unwrap(),));
        let angle = draw.between(-3.0, 3.0);
        let there = glam::DVec3::new(angle.cos(), angle.sin(), 0.0) * at;
        let gate = Shape::sphere(radius);
        let fixed = RigidBody::new(gate.clone()).fixed().position(vec3(there)).build().unwrap();
        fixed.spawn_with(&mut world, (collider(&gate).sensor(),));
        let mut simulation = Simulation::new(settings).unwrap();
        // Half the angle that the arm takes up, seen from the gate, and rounding.
        let near = 2.0 * (radius + 2.0 * thin) / at + 1e-3 * turn;
        for step in 0..20 {
            let arm_at = |world: &World| {
                let turned = world.get::<&Pose>(body).unwrap().orientation * Vec3::X;
                f64::from(turned.y).atan2(f64::from(turned.x))
            };
            let before = arm_at(&world);
            simulation.step(&mut world);
            // How far ahead of the arm the gate is.
            let ahead = |arm: f64| (way * (angle - arm)).rem_euclid(std::f64::consts::TAU);
            let is_clear = |arm: f64| ahead(arm) > near && ahead(arm) < std::f64::consts::TAU - near;
            if !(is_clear(before) && is_clear(arm_at(&world))) {
                continue;
            }
            let is_passed = ahead(before) < turn;
            let events: Vec<_> = simulation.sensor_events().map(|event| event.begins).collect();
            let expected: &[bool] = if is_passed { &[true, false] } else { &[] };
            assert_eq!(events, expected, "case {case}, step {step}: {turn} rad");
            *(if is_passed { &mut passed } else { &mut missed }) += 1;
        }
    }
    assert!(passed > 1000 && missed > 500, "{passed} passed, {missed} missed");
}

/// However steps fall into frames, and in a batch, the same events in the same order.
#[test]
fn every_event_comes_once_however_frames_fall() {
    for case in 0..12 {
        let one_by_one = {
            let (mut world, mut simulation) = (world_of(case), Simulation::new(settings(case)).unwrap());
            let mut events = Vec::new();
            for _ in 0..60 {
                simulation.step(&mut world);
                events.extend(simulation.sensor_events());
            }
            events
        };
        let (mut world, mut simulation) = (world_of(case), Simulation::new(settings(case)).unwrap());
        simulation.step_many(&mut world, 60);
        assert_eq!(simulation.sensor_events().collect::<Vec<_>>(), one_by_one, "case {case}");
        let (mut world, mut simulation) = (world_of(case), Simulation::new(settings(case)).unwrap());
        let (mut draw, mut events) = (Draw::new(2313, case), Vec::new());
        while simulation.steps() < 60 {
            let left = f64::from((60 - simulation.steps()) as u32) / 60.0;
            simulation.advance(&mut world, draw.between(0.0, 0.08).min(left + 1e-6));
            events.extend(simulation.sensor_events());
        }
        assert_eq!(events, one_by_one, "case {case}");
        let trials = (0..3).map(|_| Trial::new(settings(case), world_of(case)).unwrap());
        let mut batch: Batch = trials.collect();
        batch.step_many(60);
        for trial in batch.trials() {
            assert_eq!(trial.simulation.sensor_events().collect::<Vec<_>>(), one_by_one, "case {case}");
        }
    }
}

/// A run that goes back to a snapshot reports what it reported.
#[test]
fn after_a_restore_the_same_is_reported() {
    for case in 0..12 {
        let (mut world, mut simulation) = (world_of(case), Simulation::new(settings(case)).unwrap());
        simulation.step_many(&mut world, 20);
        let snapshot = simulation.snapshot(&world).unwrap();
        let there: Vec<_> = simulation.sensed().collect();
        let mut run = |simulation: &mut Simulation| {
            simulation.step_many(&mut world, 30);
            (simulation.sensor_events().collect::<Vec<_>>(), simulation.sensed().collect::<Vec<_>>())
        };
        let expected = run(&mut simulation);
        let mut world = world_of(case);
        simulation.restore(&snapshot, &mut world).unwrap();
        assert_eq!(simulation.sensor_events().count(), 0);
        simulation.step_many(&mut world, 30);
        let again = (simulation.sensor_events().collect::<Vec<_>>(), simulation.sensed().collect::<Vec<_>>());
        assert_eq!(again, expected, "case {case}, {there:?} inside");
        // And so does another that has taken no step.
        let (mut world, mut fresh) = (world_of(case), Simulation::new(settings(case)).unwrap());
        fresh.restore(&snapshot, &mut world).unwrap();
        fresh.step_many(&mut world, 30);
        assert_eq!(fresh.sensor_events().collect::<Vec<_>>(), expected.0, "case {case}");
    }
}

/// With nothing near a sensor when a world is restored, and something put there later.
#[test]
fn what_comes_long_after_a_restore_comes_in() {
    for case in 0..40 {
        let mut draw = Draw::new(2325, case);
        let (shape, mut world) = (shape(&mut draw), World::new());
        let has_sensor = draw.often(0.7);
        let spawn_sensor = |world: &mut World| {
            let sensor = collider(&Shape::sphere(0.5)).sensor();
            let body = RigidBody::new(Shape::Point).fixed().build().unwrap();
            body.spawn_with(world, (sensor,))
        };
        if has_sensor {
            spawn_sensor(&mut world);
        }
        let body = RigidBody::new(shape.clone()).mass(1.0).position(Vec3::X * 50.0).id(BodyId(7)).gravity_scale(0.0);
        let body = body.build().unwrap().spawn_with(&mut world, (collider(&shape),));
        let mut simulation = Simulation::new(Settings::default()).unwrap();
        simulation.step(&mut world);
        let snapshot = simulation.snapshot(&world).unwrap();
        simulation.restore(&snapshot, &mut world).unwrap();
        for _ in 0..1 + draw.between(0.0, 5.0) as u32 {
            simulation.step(&mut world);
        }
        world.get::<&mut Pose>(body).unwrap().position = Vec3::ZERO;
        if !has_sensor {
            spawn_sensor(&mut world);
        }
        simulation.step(&mut world);
        let events: Vec<_> = simulation.sensor_events().map(|event| (event.body, event.begins)).collect();
        assert_eq!(events, [(body, true)], "case {case}, with a sensor before: {has_sensor}");
    }
}

/// Bodies move to the bit as they would without the sensors, on any number of threads.
#[test]
fn sensors_move_nothing() {
    for case in 0..12 {
        let run = |is_sensing: bool, threads: usize| {
            let mut world = world_of(case);
            if !is_sensing {
                let sensors: Vec<Entity> = world
                    .query::<(Entity, &Collider)>()
                    .iter()
                    .filter(|(_, it)| it.is_sensor())
                    .map(|(entity, _)| entity)
                    .collect();
                for entity in sensors {
                    world.remove_one::<Collider>(entity).unwrap();
                }
            }
            let mut simulation = Simulation::new(settings(case)).unwrap();
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| simulation.step_many(&mut world, 60));
            let events: Vec<_> = simulation.sensor_events().collect();
            (tumble::state_hash(&world, &tumble::BodyOrder::of(&world)), events)
        };
        let (hash, events) = run(true, 1);
        assert_eq!(run(false, 1).0, hash, "case {case}");
        assert_eq!(run(true, 2), (hash, events.clone()), "case {case}");
        assert_eq!(run(true, 4), (hash, events), "case {case}");
    }
}

/// What is despawned in a sensor leaves it, and so does what loses its collider, or the sensor
/// goes.
#[test]
fn what_is_gone_has_left() {
    for which in 0..5 {
        let mut world = World::new();
        let water = collider(&Shape::cuboid([2.0, 2.0, 2.0])).sensor();
        let water = RigidBody::new(Shape::Point).fixed().build().unwrap().spawn_with(&mut world, (water,));
        let ball = RigidBody::new(Shape::sphere(0.1)).mass(1.0).build().unwrap();
        let ball = ball.spawn_with(&mut world, (collider(&Shape::sphere(0.1)),));
        let mut simulation = Simulation::new(Settings::default().with_gravity(Vec3::ZERO)).unwrap();
        simulation.step(&mut world);
        let comes = SensorEvent { sensor: water, part: 0, body: ball, begins: true };
        assert_eq!(simulation.sensor_events().collect::<Vec<_>>(), [comes]);
        match which {
            0 => world.despawn(ball).unwrap(),
            1 => world.despawn(water).unwrap(),
            2 => drop(world.remove_one::<Collider>(ball).unwrap()),
            3 => *world.get::<&mut Collider>(water).unwrap() = collider(&Shape::sphere(0.01)),
            _ => world.get::<&mut Pose>(ball).unwrap().position.x = 5.0,
        }
        simulation.step(&mut world);
        let leaves = SensorEvent { begins: false, ..comes };
        assert_eq!(simulation.sensor_events().collect::<Vec<_>>(), [leaves], "{which}");
        assert_eq!(simulation.sensed().count(), 0);
        simulation.step(&mut world);
        assert_eq!(simulation.sensor_events().count(), 0);
    }
}
