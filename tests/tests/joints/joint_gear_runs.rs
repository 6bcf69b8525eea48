//! Promise: trains of wheels, racks and gears between joints of random mechanisms give the same
//! bits for any number of threads, order of spawning bodies, joints and gears, many steps at once,
//! phase by phase, in a batch or alone; and go on to the bit from any step that they are rewound to
//! or restored at from a file, in the same world or in one that was spawned in another order.
//!
//! Why: a gear couples rows of two joints and up to four bodies, so its place in the matrix must
//! not follow the order of spawning. It fails if gears are solved in the order of their entities,
//! or if a turn of a wheel is remembered anywhere that a snapshot does not have.

use glam::DVec3;
use hecs::{Entity, World};
use tumble::math::{Real, Vec3};
use tumble::{
    Axes, Batch, BodyId, Drive, Drives, Gear, Joint, JointLoad, Limit, Limits, RigidBody, Rollback, Settings, Shape,
    Simulation, Snapshot, Trial,
};
use tumble_benches::pool;
use tumble_tests::{Draw, hash, run};

use crate::mechanisms::{Class, Options, add_options, mechanism};

fn settings() -> Settings {
    Settings::default().with_dt(1.0 / 64.0).with_contact_substeps(4)
}

fn simulation() -> Simulation {
    Simulation::new(settings()).unwrap()
}

/// Numbers from 0, in another order if there is a seed.
fn order(count: usize, seed: Option<u64>, salt: u64) -> Vec<usize> {
    let Some(seed) = seed else { return (0..count).collect() };
    let mut draw = Draw::new(0x61, 100 * seed + salt);
    let mut all: Vec<(u64, usize)> = (0..count).map(|i| (draw.between(0.0, 1e9) as u64, i)).collect();
    all.sort_unstable();
    all.into_iter().map(|(_, i)| i).collect()
}

/// Four wheels with ratios of teeth and one that is none, which a rack turns as it falls, and two
/// of limited angles with a motor. Returns all joints.
fn clockwork(world: &mut World, seed: Option<u64>, is_geared: bool) -> Vec<Entity> {
    const RATIOS: [f64; 5] = [-2.0, 3.0 / 7.0, std::f64::consts::PI, 0.0, 0.73];
    let plate = RigidBody::new(Shape::Point).id(BodyId(1)).fixed().build().unwrap().spawn(world);
    let mut joints = vec![Entity::DANGLING; 7];
    for number in order(7, seed, 0) {
        let (at, id) = (Vec3::X * number as Real, BodyId(2 + number as u64));
        let wheel = RigidBody::new(Shape::cylinder(0.2, 0.05))
            .without_collider()
            .mass(1.0 + number as Real)
            .id(id)
            .position(at);
        let wheel = wheel.build().unwrap().spawn(world);
        let is_rack = number == 6;
        let kind = if is_rack { Joint::slider } else { Joint::hinge };
        joints[number] = world.spawn((kind(plate, wheel).at(world, at, Vec3::Y).unwrap(), JointLoad::default()));
    }
    let motor = Drive::velocity(Axes::ANGULAR_X, 3.0).with_max_force(4.0);
    world.insert_one(joints[4], Drives::from(motor)).unwrap();
    for number in [4, 5] {
        world.insert_one(joints[number], Limits::along(Axes::ANGULAR_X, Limit::new(-1.4, 1.1))).unwrap();
    }
    for number in order(6, seed, 1).into_iter().filter(|number| is_geared && *number != 3) {
        let gear = match number {
            5 => Gear { offset: -0.2, ..Gear::new(joints[1], joints[6], 0.15) },
            number => Gear::new(joints[number], joints[number + 1], RATIOS[number] as Real),
        };
        world.spawn((gear,));
    }
    joints
}

/// The clockwork, and two random mechanisms with limits, drives and friction and with gears between
/// any of their axes, of which one flies.
fn scene(seed: Option<u64>, is_geared: bool) -> (World, Vec<Entity>) {
    let mut world = World::new();
    let mut all = clockwork(&mut world, seed, is_geared);
    for number in 0..2 {
        let origin = DVec3::Y * 30.0 * (number + 1) as f64;
        let first_id = 1000 * (number + 1);
        let class = Class { bodies: 8, first_id, loops: 0.2, is_fixed: number == 0, origin, ..Class::PLAIN };
        let mut draw = Draw::new(0x60, number);
        let plan = mechanism(class, &mut draw);
        let of_bodies = order(plan.bodies.len(), seed, 10 + number);
        let (_, joints) = plan.spawn(&mut world, &of_bodies, &order(plan.joints.len(), seed, 20 + number));
        add_options(&mut world, &joints, Options { has_springs: true, breaks: false, size: 0.5, mass: 5.0 }, number);
        let mut gears = Vec::new();
        for _ in 0..6 {
            let ends = [0, 1].map(|_| joints[(draw.between(0.0, 0.999) * joints.len() as f64) as usize]);
            let axes = [0, 1].map(|_| Axes::EACH[(draw.between(0.0, 5.999)) as usize]);
            let ratio = draw.between(-2.0, 2.0);
            let teeth = if draw.often(0.5) { (ratio * 12.0).round() / 12.0 } else { ratio };
            gears.push(Gear { axes, ..Gear::new(ends[0], ends[1], teeth as Real) });
            gears.push(Gear::new(ends[0], ends[1], ratio as Real));
        }
        for gear in order(gears.len(), seed, 30 + number).into_iter().filter(|_| is_geared) {
            world.spawn((gears[gear],));
        }
        all.extend(joints);
    }
    (world, all)
}

fn hash_after(mut world: World, steps: u32) -> u64 {
    run(&mut simulation(), &mut world, steps);
    hash(&world)
}

fn reference(steps: u32) -> u64 {
    hash_after(scene(None, true).0, steps)
}

#[test]
fn neither_threads_nor_the_order_of_spawning_matter() {
    let expected = reference(90);
    for threads in [1, 2, 4] {
        assert_eq!(pool(threads).install(|| reference(90)), expected, "{threads} threads");
    }
    for seed in 0..6 {
        assert_eq!(hash_after(scene(Some(seed), true).0, 90), expected, "{seed}");
    }
    assert_ne!(reference(89), expected);
    assert_ne!(hash_after(scene(None, false).0, 90), expected, "gears do nothing");
}

#[test]
fn neither_a_batch_nor_how_steps_are_run_matters() {
    let expected = reference(90);
    let (mut world, mut simulation) = (scene(None, true).0, simulation());
    simulation.step_many(&mut world, 40);
    for _ in 0..50 {
        let mut step = simulation.begin_step(&mut world);
        while step.run_phase().is_some() {}
    }
    assert_eq!(hash(&world), expected);
    let trial = |number: u64| Trial::new(settings(), scene((number > 0).then_some(number), true).0).unwrap();
    let mut batch: Batch = (0..3).map(trial).collect();
    pool(2).install(|| (0..90).for_each(|_| batch.step_many(1)));
    assert_eq!(batch.map(|_, trial| trial.state_hash()), [expected; 3]);
}

/// A world, its joints, and its simulation.
struct Run {
    world: World,
    joints: Vec<Entity>,
    simulation: Simulation,
}

impl Run {
    fn new(seed: Option<u64>) -> Self {
        let (world, joints) = scene(seed, true);
        Self { world, joints, simulation: simulation() }
    }

    /// The hash and the loads after a step.
    fn step(&mut self) -> (u64, Vec<JointLoad>) {
        self.simulation.step(&mut self.world);
        let loads = self.joints.iter().map(|joint| *self.world.get::<&JointLoad>(*joint).unwrap());
        (hash(&self.world), loads.collect())
    }
}

#[test]
fn rewinds_are_exact() {
    const STEPS: u64 = 100;
    let (mut it, mut draw) = (Run::new(None), Draw::new(0x62, 0));
    let mut rollback = Rollback::new(STEPS as usize);
    let (mut moments, mut rewinds) = (Vec::new(), 0);
    while it.simulation.steps() < STEPS {
        let step = it.simulation.steps() as usize;
        rollback.save(&it.world, &it.simulation).unwrap();
        let moment = it.step();
        match moments.get(step) {
            Some(known) => assert_eq!(moment, *known, "step {step}"),
            None => moments.push(moment),
        }
        if rewinds < 12 && draw.often(0.2) {
            rewinds += 1;
            let to = draw.between(0.0, it.simulation.steps() as f64) as u64;
            rollback.rewind_to_step(to, &mut it.world, &mut it.simulation).unwrap();
        }
    }
    assert_eq!(rewinds, 12);
    // The first wheel went round, so what is rewound has passed half a turn.
    let of_first = moments.iter().map(|(_, loads)| loads[0].values[3]);
    assert!(of_first.clone().fold(0.0, Real::max) > 3.0 && of_first.fold(0.0, Real::min) < -3.0);
}

#[test]
fn files_continue_in_other_worlds() {
    for at in [1, 40] {
        let mut first = Run::new(None);
        (0..at).for_each(|_| drop(first.step()));
        let file = first.simulation.snapshot(&first.world).unwrap().to_bytes();
        for seed in [None, Some(3), Some(4)] {
            let mut other = Run::new(seed);
            let read = Snapshot::from_bytes(&file).unwrap();
            other.simulation.restore(&read, &mut other.world).unwrap();
            let mut same = Run::new(None);
            same.simulation.restore(&read, &mut same.world).unwrap();
            for step in 0..40 {
                assert_eq!(other.step(), same.step(), "from {at} with {seed:?}, step {step}");
            }
            if seed.is_none() {
                (0..40).for_each(|_| drop(first.step()));
            }
            assert_eq!(hash(&other.world), hash(&first.world), "from {at} with {seed:?}");
        }
    }
}
