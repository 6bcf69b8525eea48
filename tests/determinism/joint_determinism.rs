//! Promise: a world of mechanisms, some of which touch others and the ground, gives the same bits
//! for any number of threads, order of spawning bodies and joints, layout of archetypes, many steps
//! at once, phase by phase, in a batch or alone, and after a snapshot was restored from a file; and
//! what inertia their loads ask for goes with the body. The bits are pinned.
//!
//! Why: a joint's impulses depend on all others of its mechanism, and an elimination in the order
//! of rows or entities would lose determinism. It fails if the matrix follows the order of
//! spawning, if two mechanisms get into each other's way, or if a snapshot lacks the loads.

use crate::changing_archetypes::run_changing_archetypes;
use hecs::{Entity, World};
use tumble::math::{PRECISION, Quat, Real, Vec3};
use tumble::{
    Axes, Batch, BodyId, Collider, Joint, JointSolver, LockedAxes, Material, RigidBody, Settings, Shape, Simulation,
    Snapshot, Trial, simd_name,
};
use tumble_benches::pool;
use tumble_tests::touching::ground;
use tumble_tests::{Draw, hash, run};

use crate::mechanisms::{Class, Options, add_options, mechanism, vector};

/// How joints are solved, and a scene for it: by a seed, in another order of spawning.
#[derive(Clone, Copy)]
struct Case {
    joints: JointSolver,
    scene: fn(Option<u64>) -> World,
}

const CASES: [Case; 2] =
    [Case { joints: JointSolver::Auto, scene }, Case { joints: JointSolver::Passes, scene: scene_in_passes }];

impl Case {
    fn settings(self) -> Settings {
        Settings::default().with_dt(1.0 / 64.0).with_substeps(2).with_contact_substeps(8).with_joint_solver(self.joints)
    }

    fn simulation(self) -> Simulation {
        Simulation::new(self.settings()).unwrap()
    }

    fn world(self) -> World {
        (self.scene)(None)
    }

    fn hash_after(self, steps: u32) -> u64 {
        self.hash_of(self.world(), steps)
    }

    fn hash_of(self, mut world: World, steps: u32) -> u64 {
        run(&mut self.simulation(), &mut world, steps);
        hash(&world)
    }
}

/// Numbers from 0 in another order.
fn shuffled(count: usize, seed: u64) -> Vec<usize> {
    let mut draw = Draw::new(0x5F, seed);
    let mut all: Vec<(u64, usize)> = (0..count).map(|i| ((draw.between(0.0, 1e9)) as u64, i)).collect();
    all.sort_unstable();
    all.into_iter().map(|(_, i)| i).collect()
}

/// Numbers from 0, with a seed in another order.
fn order(count: usize, seed: Option<u64>, salt: u64) -> Vec<usize> {
    seed.map_or_else(|| (0..count).collect(), |seed| shuffled(count, seed + salt))
}

/// A chain of light links with a heavy end, swung: its links have loads that raise their inertia.
fn chain(world: &mut World, reversed: bool) {
    let beam = RigidBody::new(Shape::Point).id(BodyId(1000)).fixed().build().unwrap().spawn(world);
    let (mut above, mut joints) = (beam, Vec::new());
    for i in 0..10 {
        let at = Vec3::Y * (-0.05 - 0.1 * i as Real) + Vec3::X * 20.0;
        let mass = if i == 9 { 2000.0 } else { 1.0 };
        let link = RigidBody::new(Shape::cuboid([0.01, 0.05, 0.01])).without_collider().mass(mass).id(BodyId(1001 + i));
        let link = link.position(at).linear_velocity(Vec3::X * i as Real).build().unwrap().spawn(world);
        joints.push(Joint::ball(above, link).at_point(world, at + Vec3::Y * 0.05).unwrap());
        above = link;
    }
    joints[0].frames[0].position = Vec3::X * 20.0;
    if reversed {
        joints.reverse();
    }
    for joint in joints {
        world.spawn((joint,));
    }
}

/// Boxes on ball joints, which fall on the ground.
fn falling_chain(world: &mut World) {
    ground(world, Material::default(), Quat::IDENTITY);
    let shape = Shape::cuboid([0.2, 0.1, 0.1]);
    let mut last: Option<Entity> = None;
    for i in 0..5 {
        let at = Vec3::new(i as Real * 0.5 - 20.0, 0.4 + 0.1 * i as Real, 0.0);
        let body = RigidBody::new(shape.clone()).mass(1.0).position(at).id(BodyId(2000 + i)).build().unwrap();
        let body = body.spawn_with(world, (Collider::new(&shape).unwrap(),));
        if let Some(last) = last.replace(body) {
            world.spawn((Joint::ball(last, body).at_point(world, at - Vec3::X * 0.25).unwrap(),));
        }
    }
}

/// The scene of plain joints, and a mechanism with limits, drives and friction.
fn scene(seed: Option<u64>) -> World {
    let mut world = plain_scene(seed);
    let origin = glam::DVec3::new(0.0, 30.0, 60.0);
    let class = Class { bodies: 14, first_id: 5000, loops: 0.2, is_fixed: true, origin, ..Class::PLAIN };
    let plan = mechanism(class, &mut Draw::new(0x5E, 2));
    let order = |count, salt| order(count, seed, salt);
    let (_, joints) = plan.spawn(&mut world, &order(plan.bodies.len(), 200), &order(plan.joints.len(), 300));
    add_options(&mut world, &joints, Options { has_springs: true, breaks: false, size: 0.5, mass: 5.0 }, 0);
    world
}

/// The scene of plain joints, of which chains are in passes, and balls, hinges and welds.
fn scene_in_passes(seed: Option<u64>) -> World {
    let mut world = plain_scene(seed);
    let class = Class { bodies: 40, first_id: 6000, loops: 0.4, origin: glam::DVec3::Y * 60.0, ..Class::PLAIN };
    let mut plan = mechanism(class, &mut Draw::new(0x5E, 3));
    plan.joints.iter_mut().for_each(|joint| joint.kind = [0, 1, 6][joint.kind % 3]);
    let order = |count, salt| order(count, seed, salt);
    plan.spawn(&mut world, &order(plan.bodies.len(), 400), &order(plan.joints.len(), 500));
    world
}

fn plain_scene(seed: Option<u64>) -> World {
    let mut world = World::new();
    let class = Class { bodies: 14, loops: 0.3, aspect: 10.0, origin: glam::DVec3::Y * 30.0, ..Class::PLAIN };
    let plan = mechanism(class, &mut Draw::new(0x5E, 1));
    let order = |count, salt| order(count, seed, salt);
    // Scenery without an id goes by its entity, so it comes first.
    falling_chain(&mut world);
    plan.spawn(&mut world, &order(plan.bodies.len(), 0), &order(plan.joints.len(), 100));
    chain(&mut world, seed.is_some());
    world
}

#[test]
fn threads_do_not_matter() {
    for case in CASES {
        let [one, two, four] = [1, 2, 4].map(|threads| pool(threads).install(|| case.hash_after(60)));
        assert_eq!([one, one], [two, four]);
        assert_ne!(one, case.hash_after(59));
    }
}

#[test]
fn the_order_of_spawning_does_not_matter() {
    for case in CASES {
        let reference = case.hash_after(60);
        for seed in 0..4 {
            assert_eq!(case.hash_of((case.scene)(Some(seed)), 60), reference, "{:?} {seed}", case.joints);
        }
    }
}

#[test]
fn archetypes_do_not_matter() {
    for case in CASES {
        let (mut world, mut simulation) = (case.world(), case.simulation());
        run_changing_archetypes(&mut simulation, &mut world, 60);
        assert_eq!(hash(&world), case.hash_after(60));
    }
}

#[test]
fn many_steps_and_phases_are_single_steps() {
    for case in CASES {
        let (mut world, mut simulation) = (case.world(), case.simulation());
        simulation.step_many(&mut world, 25);
        for _ in 0..35 {
            let mut step = simulation.begin_step(&mut world);
            while step.run_phase().is_some() {}
        }
        assert_eq!(hash(&world), case.hash_after(60));
    }
}

#[test]
fn a_batch_does_not_matter() {
    for case in CASES {
        let mut batch: Batch = (0..3).map(|_| Trial::new(case.settings(), case.world()).unwrap()).collect();
        pool(2).install(|| (0..60).for_each(|_| batch.step_many(1)));
        assert_eq!(batch.map(|_, trial| trial.state_hash()), [case.hash_after(60); 3]);
    }
}

/// Back to a snapshot in the same world, and on from a file in one that was spawned in another
/// order, with another simulation.
#[test]
fn a_restored_world_goes_on_as_before() {
    for case in CASES {
        let (mut world, mut simulation) = (case.world(), case.simulation());
        run(&mut simulation, &mut world, 25);
        let file = simulation.snapshot(&world).unwrap().to_bytes();
        run(&mut simulation, &mut world, 35);
        let reference = hash(&world);
        simulation.restore(&Snapshot::from_bytes(&file).unwrap(), &mut world).unwrap();
        run(&mut simulation, &mut world, 35);
        assert_eq!(hash(&world), reference);
        let (mut other, mut second) = ((case.scene)(Some(3)), case.simulation());
        second.restore(&Snapshot::from_bytes(&file).unwrap(), &mut other).unwrap();
        run(&mut second, &mut other, 35);
        assert_eq!(hash(&other), reference);
        // Without what the simulation knows beside the world, loads and impulses are missing.
        Snapshot::from_bytes(&file).unwrap().restore(&mut world).unwrap();
        run(&mut case.simulation(), &mut world, 35);
        assert_ne!(hash(&world), reference);
    }
}

/// Bodies that come and go change slots, and not what is kept of others.
#[test]
fn what_passes_does_not_matter() {
    for case in CASES {
        let (mut world, mut simulation) = (case.world(), case.simulation());
        let body = |id| {
            RigidBody::new(Shape::sphere(0.1)).without_collider().mass(1.0).id(BodyId(id)).position(Vec3::X * 500.0)
        };
        let [first, last] = [0, 9000].map(|id| body(id).build().unwrap().spawn(&mut world));
        let joint = world.spawn((Joint::ball(first, last).at_point(&world, vector(glam::DVec3::X * 499.0)).unwrap(),));
        run(&mut simulation, &mut world, 30);
        for entity in [first, last, joint] {
            world.despawn(entity).unwrap();
        }
        run(&mut simulation, &mut world, 30);
        assert_eq!(hash(&world), case.hash_after(60));
    }
}

/// A mechanism whose bodies have locked axes in many ways, some of them in other archetypes.
fn scene_of_locked(seed: Option<u64>) -> World {
    struct Marked;
    let mut world = World::new();
    let class = Class { bodies: 14, first_id: 7000, loops: 0.3, ..Class::PLAIN };
    let plan = mechanism(class, &mut Draw::new(0x5E, 4));
    let order = |count, salt| order(count, seed, salt);
    let (bodies, _) = plan.spawn(&mut world, &order(plan.bodies.len(), 600), &order(plan.joints.len(), 700));
    for (i, body) in bodies.into_iter().enumerate() {
        if i % 3 != 2 {
            let axes = [Axes::LINEAR_Z, Axes::ANGULAR_X | Axes::LINEAR_Y, Axes::ANGULAR][i % 3];
            world.insert_one(body, LockedAxes(axes)).unwrap();
        }
        if seed.is_some_and(|seed| (i as u64 + seed).is_multiple_of(2)) {
            world.insert_one(body, Marked).unwrap();
        }
    }
    world
}

/// Bodies with locked axes are held by rows of their mechanism, of which the matrix has an order.
#[test]
fn archetypes_and_the_order_of_bodies_with_locked_axes_do_not_matter() {
    let case = CASES[0];
    let reference = case.hash_of(scene_of_locked(None), 60);
    for seed in 0..6 {
        assert_eq!(case.hash_of(scene_of_locked(Some(seed)), 60), reference, "{seed}");
    }
}

/// A new hash is a new arithmetic; see `determinism.rs`.
#[test]
fn the_bits_are_pinned() {
    let [plain, all] = match PRECISION {
        "f32" => [0xcd6d_bfa9_c885_0609_u64, 0x745d_010d_9a84_0a72],
        _ => [0x96d4_d7a7_10b0_a14c, 0xc23c_4b05_d4ef_3f9b],
    };
    let passes = if PRECISION == "f32" { 0xd05b_2609_1b0b_c602_u64 } else { 0xe322_4b45_5bac_4200 };
    println!("\nran on {}", simd_name());
    let [auto, in_passes] = CASES;
    let found = auto.hash_of(plain_scene(None), 120);
    assert_eq!(found, plain, "in hexadecimal: {found:#018x}");
    let found = auto.hash_after(120);
    assert_eq!(found, all, "with options, in hexadecimal: {found:#018x}");
    let found = in_passes.hash_after(120);
    assert_eq!(found, passes, "in passes, in hexadecimal: {found:#018x}");
}
