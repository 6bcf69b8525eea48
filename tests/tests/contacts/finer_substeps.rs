//! Promise: an island that takes shorter substeps than others is the same to the bit whatever
//! stands beside it, in whichever order bodies were spawned, alone and in a batch, on one thread
//! and several, and after it was put back to a snapshot, in memory and through bytes. Impulses are
//! read as those of a substep of the settings, and works add up.
//!
//! Why: such islands are taken out of the others' rows and put back, and how short their substeps
//! are is kept from step to step. It fails if a row, an impulse, a force, an account or that state
//! is lost on the way.

use hecs::{Entity, World};
use tumble::math::{Quat, Real, Vec3};
use tumble::prelude::*;
use tumble::{Batch, Collider, ContactEvent, Material, Snapshot, Trial, Work};
use tumble_tests::touching::{collider, surfaced};
use tumble_tests::{hash, run};

/// The bodies of a tower of small cubes that leans on nothing, of a larger one that stands apart,
/// of a box that slides beside them, and of balls that come down on both towers later.
const BODIES: u64 = 36;

fn body(id: u64) -> (RigidBody, Shape) {
    let level = (id % 16) as u8;
    let (edge, x) = if id < 16 { (0.02, 0.0) } else { (0.2, 2.0) };
    let cube = Shape::cuboid([0.5 * edge; 3]);
    let place = |x: f64, y: f64| Vec3::new(x as Real, y as Real, 0.0);
    if id < 32 {
        let body = RigidBody::new(cube.clone()).density(700.0).position(place(x, edge * (f64::from(level) + 0.5)));
        // Forces that a substep has its part of.
        let body = if level == 15 { body.damping(Damping { linear: 0.3, angular: 0.2 }) } else { body };
        return (body, cube);
    }
    if id == 32 {
        let shape = Shape::cuboid([0.2, 0.1, 0.2]);
        let turned = Quat::from_rotation_y(0.3);
        let body = RigidBody::new(shape.clone()).density(500.0).position(place(5.0, 0.11)).orientation(turned);
        return (body.linear_velocity(Vec3::new(3.0, 0.0, 1.0)).angular_velocity(Vec3::Y * 4.0), shape);
    }
    let (radius, x, y) = if id.is_multiple_of(2) { (0.01, 0.003, 0.5) } else { (0.1, 2.05, 4.5) };
    let shape = Shape::sphere(radius);
    let body = RigidBody::new(shape.clone()).density(300.0).position(place(x, y + (id - 33) as f64 * 0.1));
    (body, shape)
}

fn spawn(world: &mut World, id: u64) -> Entity {
    let (body, shape) = body(id);
    let surface = Material::new(0.6, if id > 32 { 0.4 } else { 0.0 });
    body.id(BodyId(id)).build().unwrap().spawn_with(world, (surfaced(collider(&shape), surface),))
}

/// Ground, and the bodies of these identities in this order.
fn scene(ids: impl IntoIterator<Item = u64>) -> World {
    let mut world = World::new();
    let ground = RigidBody::new(Shape::Point).fixed().id(BodyId(1000)).build().unwrap();
    ground.spawn_with(&mut world, (surfaced(Collider::half_space(), Material::default()),));
    ids.into_iter().for_each(|id| _ = spawn(&mut world, id));
    world
}

fn simulation() -> Simulation {
    Simulation::new(Settings::default()).unwrap()
}

fn of_id(world: &World, id: u64) -> (Pose, Momentum) {
    let mut query = world.query::<(&BodyId, &Pose, &Momentum)>();
    query.iter().find(|(found, ..)| found.0 == id).map(|(_, pose, momentum)| (*pose, *momentum)).unwrap()
}

fn hashes(simulation: &mut Simulation, world: &mut World, steps: u32) -> Vec<u64> {
    let step = |_| {
        simulation.step(world);
        hash(world)
    };
    (0..steps).map(step).collect()
}

/// Each island by itself, and all together.
#[test]
fn islands_do_not_know_of_each_other() {
    let islands: [Vec<u64>; 3] = [
        (0..16).chain((33..BODIES).filter(|id| id % 2 == 0)).collect(),
        (16..32).chain((33..BODIES).filter(|id| id % 2 == 1)).collect(),
        vec![32],
    ];
    let mut together = scene(0..BODIES);
    run(&mut simulation(), &mut together, 150);
    for ids in islands {
        let mut alone = scene(ids.iter().copied());
        run(&mut simulation(), &mut alone, 150);
        for id in ids {
            assert_eq!(of_id(&alone, id), of_id(&together, id), "body {id}");
        }
    }
}

/// Spawned in another order, on one thread or two, in a batch with others.
#[test]
fn the_bits_are_the_same_everywhere() {
    let mut world = scene(0..BODIES);
    let expected = hashes(&mut simulation(), &mut world, 120);
    let mut shuffled = scene((0..BODIES).map(|i| (i * 7 + 3) % BODIES));
    assert_eq!(hashes(&mut simulation(), &mut shuffled, 120), expected);
    for threads in [1, 2] {
        let pool = tumble_benches::pool(threads);
        let found = pool.install(|| hashes(&mut simulation(), &mut scene(0..BODIES), 120));
        assert_eq!(found, expected, "{threads} threads");
        let trial = |index: u64| {
            let world = if index.is_multiple_of(3) { scene(0..BODIES) } else { scene(index % 16..20 + index % 13) };
            Trial::new(Settings::default(), world).unwrap()
        };
        let mut batch: Batch = (0..40).map(trial).collect();
        pool.install(|| batch.step_many(120));
        for (index, found) in batch.trials().iter().enumerate() {
            let mut alone = trial(index as u64);
            alone.simulation.step_many(&mut alone.world, 120);
            assert_eq!(hash(&found.world), hash(&alone.world), "world {index} on {threads} threads");
        }
    }
}

/// While balls fall on the towers, so that islands take shorter substeps than what stands in them
/// needs.
#[test]
fn snapshots_hold_how_short_the_substeps_are() {
    let (mut world, mut simulation) = (scene(0..BODIES), simulation());
    for _ in 0..12 {
        run(&mut simulation, &mut world, 10);
        let snapshot = simulation.snapshot(&world).unwrap();
        let read = Snapshot::from_bytes(&snapshot.to_bytes()).unwrap();
        let expected = hashes(&mut simulation, &mut world, 10);
        for snapshot in [&snapshot, &read] {
            let mut other = scene((0..BODIES).rev());
            let mut fresh = Simulation::new(Settings::default()).unwrap();
            fresh.restore(snapshot, &mut other).unwrap();
            assert_eq!(hashes(&mut fresh, &mut other, 10), expected);
        }
    }
}

/// What holds a tower of sixteen up is its weight, read as those of a substep of the settings
/// however short those of the tower are; and a pair begins to touch once.
#[test]
fn impulses_are_those_of_a_substep_of_the_settings() {
    for (first, edge) in [(0, 0.02), (16, 0.2)] {
        let mut world = scene(first..first + 16);
        let mut simulation = simulation();
        let mut begun = 0;
        for _ in 0..240 {
            simulation.step(&mut world);
            begun += simulation.contact_events().filter(|event| matches!(event, ContactEvent::Begin(..))).count();
        }
        assert_eq!(begun, 16, "edge {edge}");
        let h = f64::from(simulation.settings().contact_substep());
        let cube = 700.0 * edge * edge * edge * 9.81;
        let mut loads: Vec<f64> =
            simulation.contacts().map(|contact| f64::from(contact.impulse().y).abs() / h / cube).collect();
        loads.sort_by(f64::total_cmp);
        for (k, load) in loads.iter().enumerate() {
            let expected = (k + 1) as f64;
            assert!((load - expected).abs() < 0.02 * expected, "edge {edge}: {loads:?}");
        }
        assert_eq!(loads.len(), 16);
    }
}

/// A box slides at half a millimetre a second ten metres from the origin: in a substep it goes by
/// less than the grid of its position.
#[test]
fn slow_motion_is_not_lost_in_short_substeps() {
    let mut world = World::new();
    let smooth = Material::new(0.0, 0.0);
    let ground = RigidBody::new(Shape::Point).fixed().build().unwrap();
    ground.spawn_with(&mut world, (surfaced(Collider::half_space(), smooth),));
    let shape = Shape::cuboid([0.1; 3]);
    let start = RigidBody::new(shape.clone()).mass(1.0).position(Vec3::new(10.0, 0.1, 10.0));
    let start = start.linear_velocity(Vec3::new(5e-4, 0.0, -5e-4)).build().unwrap();
    let body = start.spawn_with(&mut world, (surfaced(collider(&shape), smooth),));
    let mut simulation = Simulation::new(Settings::default().with_contact_substeps(256)).unwrap();
    run(&mut simulation, &mut world, 600);
    let Vec3 { x, z, .. } = world.get::<&Pose>(body).unwrap().position;
    for way in [x - 10.0, 10.0 - z] {
        // Rounded to a grid of a micrometre six hundred times.
        assert!((f64::from(way) - 5e-3).abs() < 6e-4, "{way} m");
    }
}

/// Of a tower that topples under a constant push: the sum of works is the change of kinetic energy.
#[test]
fn works_of_finer_islands_add_up() {
    let mut world = scene(0..BODIES);
    let pushed =
        world.query::<(Entity, &BodyId)>().iter().find(|(_, id)| id.0 == 14).map(|(entity, _)| entity).unwrap();
    world.insert_one(pushed, ConstantWrench { force: Vec3::X * 0.02, ..ConstantWrench::default() }).unwrap();
    let mut simulation = simulation();
    Ledger::attach(&mut world, &simulation);
    run(&mut simulation, &mut world, 90);
    let settings = *simulation.settings();
    let mut most: f64 = 0.0;
    for (entity, work) in world.query::<(Entity, &Work)>().iter() {
        let kinetic = tumble::Totals::of_body(world.entity(entity).unwrap(), &settings).kinetic();
        let id = world.get::<&BodyId>(entity).unwrap().0;
        let start = if id == 32 { continue } else { 0.0 };
        assert!((work.total() - (kinetic - start)).abs() < 1e-6 * (kinetic + work.gravity.abs()) + 1e-12, "{work:?}");
        most = most.max(work.of("ConstantWrench").unwrap_or(0.0));
    }
    let way = f64::from(of_id(&world, 14).0.position.x);
    assert!((most - 0.02 * way).abs() < 1e-3 * most && most > 0.0, "{most} J over {way} m");
}
