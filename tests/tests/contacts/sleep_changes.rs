//! Promise: whatever changes of sleeping bodies, of what holds them and of what joins them wakes
//! their island, and no other; nobody has to say that it changed.
//!
//! Why: a body that sleeps on in the air after its support is gone is what users of engines with
//! sleep meet first.

use hecs::{Entity, World};
use tumble::prelude::*;
use tumble::{CenterOfMass, IgnoreContacts};
use tumble_tests::touching::{collider, spawn, surfaced};
use tumble_tests::{Draw, cases, real};

use crate::sleep::{asleep, position, sleeping};

/// A column of three that sleeps and one block apart, of a size \[m\].
pub(crate) struct Column {
    pub(crate) world: World,
    pub(crate) simulation: Simulation,
    floor: Entity,
    pub(crate) blocks: Vec<Entity>,
    pub(crate) apart: Entity,
    size: Real,
}

pub(crate) fn column(size: Real) -> Column {
    let mut column = awake_column(size);
    column.simulation.step_many(&mut column.world, 90);
    assert_eq!(asleep(&column.simulation), 4, "{size} m");
    column
}

/// The same before its first step.
fn awake_column(size: Real) -> Column {
    let mut world = World::new();
    let floor = spawn_ground(&mut world);
    let half = f64::from(size) * 0.5;
    let block = RigidBody::new(Shape::cuboid([half; 3])).density(500.0);
    let at = |x: Real, level: Real| Vec3::new(x, 0.5 + level, 0.0) * size;
    let mut put = |place: Vec3| block.clone().position(place).build().unwrap().spawn(&mut world);
    let blocks = (0..3_u8).map(|level| put(at(0.0, Real::from(level)))).collect();
    let apart = put(at(10.0, 0.0));
    let simulation = Simulation::new(sleeping()).unwrap();
    Column { world, simulation, floor, blocks, apart, size }
}

/// What is done between two steps, and how many of the four sleep after the next.
type Change = (&'static str, usize, fn(&mut Column));

const CHANGES: [Change; 24] = [
    ("nothing", 4, |_| ()),
    ("a momentum", 1, |it| {
        let mass = it.world.get::<&Mass>(it.blocks[1]).unwrap().kilograms();
        it.world.get::<&mut Momentum>(it.blocks[1]).unwrap().apply_impulse(Vec3::X * mass * 0.1);
    }),
    ("a force", 1, |it| it.world.get::<&mut Wrench>(it.blocks[2]).unwrap().add_force(Vec3::Y)),
    ("another place", 1, |it| it.world.get::<&mut Pose>(it.blocks[0]).unwrap().position.x += it.size * 0.01),
    ("another mass", 1, |it| *it.world.get::<&mut Mass>(it.blocks[0]).unwrap() = Mass::new(1.0).unwrap()),
    ("another scale of gravity", 1, |it| it.world.insert_one(it.blocks[2], GravityScale(-1.0)).unwrap()),
    ("a force component", 1, |it| it.world.insert_one(it.blocks[2], ConstantWrench::default()).unwrap()),
    ("another collider", 1, |it| {
        let ball = collider(&Shape::sphere(f64::from(it.size) * 0.4));
        it.world.insert_one(it.blocks[0], ball).unwrap();
    }),
    ("no floor", 0, |it| it.world.despawn(it.floor).unwrap()),
    ("the floor elsewhere", 0, |it| it.world.get::<&mut Pose>(it.floor).unwrap().position.y -= it.size),
    ("without the lowest", 1, |it| it.world.despawn(it.blocks[0]).unwrap()),
    ("without a collider", 1, |it| drop(it.world.remove_one::<Collider>(it.blocks[0]).unwrap())),
    ("another gravity", 0, |it| {
        let settings = it.simulation.settings().with_gravity(Vec3::Y);
        it.simulation.set_settings(settings).unwrap();
    }),
    ("a joint", 0, |it| {
        let joint = Joint::fixed(it.blocks[2], it.apart).at_point(&it.world, Vec3::ZERO).unwrap();
        it.world.spawn((joint,));
    }),
    ("wake", 1, |it| it.simulation.wake(it.blocks[1])),
    ("a floor that is a sensor", 0, |it| it.world.insert_one(it.floor, Collider::half_space().sensor()).unwrap()),
    ("a floor of other groups", 0, |it| {
        it.world.insert_one(it.floor, Collider::half_space().with_groups(0, 0)).unwrap();
    }),
    ("a floor with another middle", 0, |it| it.world.insert_one(it.floor, CenterOfMass(Vec3::Y * it.size)).unwrap()),
    ("a belt", 0, |it| {
        let belt = Material { surface_velocity: Vec3::X, ..Material::default() };
        it.world.insert_one(it.floor, surfaced(Collider::half_space(), belt)).unwrap();
    }),
    ("a pair that ignores each other", 1, |it| {
        it.world.spawn((IgnoreContacts::between(it.floor, it.blocks[0]),));
    }),
    ("a wall within the lowest", 1, |it| {
        let wall = RigidBody::new(Shape::cuboid([f64::from(it.size) * 0.5; 3])).fixed();
        wall.position(Vec3::new(0.9, 0.5, 0.0) * it.size).build().unwrap().spawn(&mut it.world);
    }),
    ("locked axes", 1, |it| it.world.insert_one(it.blocks[1], LockedAxes::ROTATIONS).unwrap()),
    ("a floor that may fall", 0, |it| {
        it.world.insert(it.floor, (Momentum::default(), Mass::new(1.0).unwrap(), Wrench::default())).unwrap();
    }),
    ("a block that is fixed", 1, |it| {
        it.world.remove_one::<Momentum>(it.blocks[0]).unwrap();
    }),
];

/// Between steps anything may change, and nobody has to say so.
#[test]
fn what_changes_wakes_its_island_and_no_other() {
    for (name, expected, change) in CHANGES {
        for size in [0.02, 0.5, 20.0] {
            let mut it = column(size);
            change(&mut it);
            it.simulation.step(&mut it.world);
            assert_eq!(asleep(&it.simulation), expected, "{name}, {size} m");
        }
    }
}

/// Nor just before they fall asleep: then they are still from the change on.
#[test]
fn what_changes_keeps_its_island_awake() {
    for size in [0.02, 0.5, 20.0] {
        let mut it = awake_column(size);
        let mut last = 0;
        while asleep(&it.simulation) < 4 {
            it.simulation.step(&mut it.world);
            last += 1;
        }
        for (name, expected, change) in CHANGES {
            for before in [last - 3, last - 2, last - 1] {
                let mut it = awake_column(size);
                it.simulation.step_many(&mut it.world, before);
                assert!(asleep(&it.simulation) < 4, "{size} m");
                change(&mut it);
                it.simulation.step_many(&mut it.world, 4);
                assert_eq!(asleep(&it.simulation), expected, "{name} after {before} steps, {size} m");
            }
        }
    }
}

/// A ball that hangs asleep on an anchor, alone in the air.
fn hanging() -> (World, Simulation, [Entity; 3]) {
    let mut world = World::new();
    let anchor = RigidBody::new(Shape::sphere(0.1)).fixed().position(Vec3::Y * 5.0).build().unwrap().spawn(&mut world);
    let ball = RigidBody::new(Shape::sphere(0.3)).mass(2.0).position(Vec3::Y * 4.0).build().unwrap().spawn(&mut world);
    let joint = Joint::ball(anchor, ball).at_point(&world, Vec3::Y * 5.0).unwrap();
    let joint = world.spawn((joint,));
    let mut simulation = Simulation::new(sleeping()).unwrap();
    simulation.step_many(&mut world, 60);
    assert!(simulation.is_asleep(ball));
    (world, simulation, [anchor, ball, joint])
}

/// What holds a body through a joint counts as what it lies on.
#[test]
fn what_hangs_wakes_with_its_anchor() {
    type Act = (&'static str, fn(&mut World, [Entity; 3]));
    let acts: [Act; 5] = [
        ("elsewhere", |world, [anchor, ..]| world.get::<&mut Pose>(anchor).unwrap().position.x += 0.5),
        ("moves", |world, [anchor, ..]| {
            world.insert_one(anchor, Velocity { linear: Vec3::X, angular: Vec3::ZERO }).unwrap();
        }),
        ("gone", |world, [anchor, ..]| world.despawn(anchor).unwrap()),
        ("no joint", |world, [_, _, joint]| world.despawn(joint).unwrap()),
        ("may fall", |world, [anchor, ..]| {
            world.insert(anchor, (Momentum::default(), Mass::new(1.0).unwrap(), Wrench::default())).unwrap();
        }),
    ];
    for (name, act) in acts {
        let (mut world, mut simulation, all) = hanging();
        act(&mut world, all);
        simulation.step(&mut world);
        assert!(!simulation.is_asleep(all[1]), "{name}");
    }
    // On an anchor that creeps nothing sleeps.
    let (mut world, mut simulation, [anchor, ball, _]) = hanging();
    world.insert_one(anchor, Velocity { linear: Vec3::X * 0.03, angular: Vec3::ZERO }).unwrap();
    simulation.step_many(&mut world, 180);
    let behind = position(&world, anchor).x - position(&world, ball).x;
    assert!(!simulation.is_asleep(ball) && behind.abs() < 0.05, "{behind} m");
}

/// A body of this size \[m\] that hangs on an anchor by a joint.
fn hung(size: Real, joint: usize, settings: Settings) -> (World, Simulation, [Entity; 2]) {
    let (mut world, half) = (World::new(), f64::from(size) * 0.5);
    let top = Vec3::Y * size * 2.0;
    let anchor = RigidBody::new(Shape::Point).fixed().position(top).build().unwrap().spawn(&mut world);
    let body = RigidBody::new(Shape::cuboid([half; 3])).density(500.0).build().unwrap().spawn(&mut world);
    let made = [Joint::fixed, Joint::ball, Joint::hinge, Joint::free, Joint::slider][joint](anchor, body);
    let made = made.at(&world, top, if joint == 4 { Vec3::Y } else { Vec3::X }).unwrap();
    let made = world.spawn((made,));
    match joint {
        3 => world.insert_one(made, Limits::rope(size)).unwrap(),
        4 => world.insert_one(made, Drives::from(Drive::position(Axes::LINEAR_X, 0.0))).unwrap(),
        _ => {}
    }
    let mut simulation = Simulation::new(settings).unwrap();
    simulation.step_many(&mut world, 120);
    (world, simulation, [anchor, body])
}

/// Joints bring bodies to where they belong without a velocity: on their way they are not still.
#[test]
fn what_a_joint_draws_is_not_still() {
    for (joint, size) in [0.05, 0.5, 5.0].into_iter().flat_map(|size| (0..5).map(move |joint| (joint, size))) {
        for gap in [0.3, 3.0, 40.0] {
            let [without, with] = [sleeping().with_sleep(None), sleeping()].map(|settings| {
                let (mut world, mut simulation, [anchor, body]) = hung(size, joint, settings);
                world.get::<&mut Pose>(anchor).unwrap().position.y += gap * size;
                simulation.step_many(&mut world, 1800);
                position(&world, body)
            });
            assert!((with - without).length() < 0.02 * size, "joint {joint}, {size} m, {gap}: {with} and {without}");
        }
    }
}

/// Nor is what comes out of something else.
#[test]
fn what_is_pushed_out_is_not_still() {
    for case in 0..u64::from(cases(60)) {
        let mut draw = Draw::new(73, case);
        let size = draw.log_between(0.02, 10.0);
        let shape = if draw.often(0.5) { Shape::sphere(0.5 * size) } else { Shape::cuboid([0.5 * size; 3]) };
        let (deep, per_second) = (size * draw.log_between(0.02, 20.0), draw.log_between(30.0, 240.0));
        let time = draw.log_between(0.05, 1.0);
        let surface = Material { rolling_resistance: real(0.05 * size), ..Material::default() };
        let [without, with] = [false, true].map(|sleeps| {
            let mut world = World::new();
            spawn(&mut world, RigidBody::new(Shape::Point).fixed(), surfaced(Collider::half_space(), surface));
            let body = RigidBody::new(shape.clone()).density(500.0).position(Vec3::Y * real(0.5 * size - deep));
            let body = spawn(&mut world, body, surfaced(collider(&shape), surface));
            let sleep = Sleep { time: real(time), ..Sleep::default() };
            let settings = Settings::default().with_dt(real(1.0 / per_second));
            let settings = settings.with_sleep(sleeps.then_some(sleep));
            let mut simulation = Simulation::new(settings).unwrap();
            simulation.step_many(&mut world, ((10.0 + deep) * per_second) as u32);
            position(&world, body).y
        });
        let off = f64::from((with - without).abs());
        assert!(off < 0.01 * size, "case {case}: {size} m, {deep} m deep: at {with} m, without sleep {without} m");
    }
}

/// Held up by a system of the caller's it does not sleep, or it would hang there without.
#[test]
fn what_a_system_holds_up_falls_without() {
    let mut world = World::new();
    let ball = RigidBody::new(Shape::sphere(0.5)).mass(1.0).position(Vec3::Y * 5.0).build().unwrap().spawn(&mut world);
    let mut simulation = Simulation::new(sleeping()).unwrap();
    for _ in 0..60 {
        let mut step = simulation.begin_step(&mut world);
        while let Some(phase) = step.run_phase() {
            if phase == tumble::StepPhase::AccumulateForces {
                step.world().get::<&mut Wrench>(ball).unwrap().force = Vec3::ZERO;
            }
        }
    }
    assert_eq!(position(&world, ball).y, 5.0);
    simulation.step_many(&mut world, 30);
    assert!(position(&world, ball).y < 4.0);
}
