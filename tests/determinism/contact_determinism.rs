//! Promise: a pile of all that can touch gives the same bits for any number of threads, order of
//! spawning, layout of archetypes, whatever comes and goes beside it, step by step or many at once,
//! in a batch or alone, and on every instruction set. The bits are pinned.
//!
//! Why: contacts are solved one after the other, so their order is in the result. It fails if
//! pairs, colours or impulses follow rows, entities, threads or the width of a tile, or if what is
//! kept from step to step to find pairs faster decides which are found.

use crate::changing_archetypes::run_changing_archetypes;
use hecs::{Entity, World};
use tumble::math::{PRECISION, Vec3};
use tumble::prelude::*;
use tumble::{Batch, BodyOrder, Collider, ConstantWrench, Totals, Trial, simd_name};
use tumble_benches::pool;
use tumble_tests::{hash, run};

use crate::pile::{plain_scene, scene, settings, shuffled};

/// Steps after which the pile has fallen and the paddle stirs it.
const STEPS: u32 = 120;

/// The hash of the pile after 200 steps, in single and double precision. A new hash is a new
/// arithmetic, of contacts or of what finds them; see `determinism.rs`.
const PINNED: [u64; 2] = [0x4677_163c_edff_7d47, 0xa214_450c_326b_04db];
/// The same of eight boxes that fall on each other, which neither bounce nor resist rolling, after
/// 90 steps.
const PINNED_BOXES: [u64; 2] = [0xa912_2bd1_b77d_32ec, 0x5b49_d0fa_f785_6f1f];

fn hash_after(mut world: World, steps: u32) -> u64 {
    let mut simulation = Simulation::new(settings()).unwrap();
    run(&mut simulation, &mut world, steps);
    let totals = Totals::of(&world, simulation.settings(), &BodyOrder::of(&world));
    // A world of numbers that are none would be the same however it came about, and so would one
    // without contacts.
    assert!(totals.non_finite.is_none() && totals.energy().abs() < 1e6, "{totals:?}");
    assert!(simulation.contacts().filter(tumble::Contact::touches).count() > 60);
    hash(&world)
}

#[test]
fn threads_do_not_matter() {
    let [one, two, four] = [1, 2, 4].map(|threads| pool(threads).install(|| hash_after(plain_scene(), STEPS)));
    assert_eq!([one, one], [two, four]);
    assert_ne!(one, hash_after(plain_scene(), STEPS - 1));
}

/// Many piles beside each other, so that there is work for several threads.
#[test]
fn threads_do_not_matter_to_many_bodies() {
    let piles = || {
        let mut world = tumble_benches::falling_balls(2000);
        for (i, shape) in [Shape::sphere(0.3), Shape::cuboid([0.2, 0.3, 0.4])].iter().enumerate() {
            for j in 0..200_u32 {
                let [x, z] = [j % 20, j / 20].map(|k| 0.9 * (k as u8 as tumble::math::Real));
                let at = Vec3::new(x - 9.0, 3.0 + i as u8 as tumble::math::Real, z - 4.5);
                let id = BodyId(1_000_000 + u64::from(j) * 2 + i as u64);
                let body = RigidBody::new(shape.clone()).density(500.0).position(at).id(id).build().unwrap();
                body.spawn_with(&mut world, (Collider::new(shape).unwrap(),));
            }
        }
        world
    };
    let [one, two, four] = [1, 2, 4].map(|threads| pool(threads).install(|| hash_after(piles(), 40)));
    assert_eq!([one, one], [two, four]);
}

/// More bodies than one thread takes at a time, each with a force of its own: in one archetype in
/// the order of their identities, and in two, in an order that moving from one to the other has
/// made.
#[test]
fn rows_do_not_matter_to_many_bodies() {
    struct Blue;
    let balls = || {
        let mut world = tumble_benches::falling_balls(2000);
        let bodies: Vec<(Entity, BodyId)> =
            world.query::<(Entity, &BodyId)>().with::<&Momentum>().iter().map(|(entity, id)| (entity, *id)).collect();
        for (entity, id) in &bodies {
            let east = 0.01 * ((id.0 % 100) as u8 as tumble::math::Real);
            world.insert_one(*entity, ConstantWrench { force: Vec3::X * east, ..ConstantWrench::default() }).unwrap();
        }
        (world, bodies)
    };
    let reference = hash_after(balls().0, 40);
    for threads in [1, 2] {
        let (mut world, bodies) = balls();
        for (i, (entity, _)) in bodies.iter().enumerate() {
            if i % 3 == 1 || (900..1600).contains(&i) {
                world.insert_one(*entity, Blue).unwrap();
            }
        }
        assert_eq!(pool(threads).install(|| hash_after(world, 40)), reference, "{threads} threads");
    }
}

/// Bodies in any order, and rows that were filled by others.
#[test]
fn the_order_of_spawning_does_not_matter() {
    let reference = hash_after(plain_scene(), STEPS);
    for seed in 0..3 {
        assert_eq!(hash_after(scene(&shuffled(seed)), STEPS), reference, "{seed}");
    }
    // Bodies come and go beside it, before and between its own in the order of identities, and
    // touch each other.
    let mut world = plain_scene();
    let shape = Shape::cuboid([0.5, 0.5, 0.5]);
    let passing = |id: u64, height: tumble::math::Real| {
        let at = Vec3::new(100.0, height, 0.0);
        RigidBody::new(shape.clone()).mass(1.0).position(at).id(BodyId(id)).build().unwrap()
    };
    let collider = Collider::new(&shape).unwrap();
    let mut simulation = Simulation::new(settings()).unwrap();
    let gone = [(1000, 0.5), (1001, 1.4), (1002, 2.3)]
        .map(|(id, y)| passing(id, y).spawn_with(&mut world, (collider.clone(),)));
    run(&mut simulation, &mut world, STEPS / 2);
    gone.into_iter().for_each(|body| world.despawn(body).unwrap());
    run(&mut simulation, &mut world, STEPS - STEPS / 2);
    assert_eq!(hash(&world), reference, "passing bodies");
}

/// Archetypes change while it runs: what is kept from step to step must not remember where things
/// lay.
#[test]
fn archetypes_do_not_matter() {
    let mut world = plain_scene();
    let mut simulation = Simulation::new(settings()).unwrap();
    run_changing_archetypes(&mut simulation, &mut world, STEPS);
    assert_eq!(hash(&world), hash_after(plain_scene(), STEPS));
}

#[test]
fn many_steps_at_once_are_single_steps() {
    let mut world = plain_scene();
    let mut simulation = Simulation::new(settings()).unwrap();
    simulation.step_many(&mut world, 50);
    simulation.step_many(&mut world, STEPS - 50);
    assert_eq!(hash(&world), hash_after(plain_scene(), STEPS));
}

/// In a batch with others, on two threads, a world gets the bits that it gets alone.
#[test]
fn a_batch_does_not_matter() {
    let trial = |seed| Trial::new(settings(), if seed == 0 { plain_scene() } else { scene(&shuffled(seed)) }).unwrap();
    let mut batch: Batch = (0..4).map(trial).collect();
    pool(2).install(|| batch.step_many(STEPS));
    let alone = hash_after(plain_scene(), STEPS);
    assert_eq!(batch.map(|_, trial| trial.state_hash()), [alone; 4]);
}

#[test]
fn the_bits_are_pinned() {
    let pinned = PINNED[usize::from(PRECISION == "f64")];
    println!("\nran on {}", simd_name());
    let found = hash_after(plain_scene(), 200);
    assert_eq!(found, pinned, "in hexadecimal: {found:#018x}");
    let mut boxes = tumble_benches::eight_boxes(0);
    let mut simulation = Simulation::new(Settings::default()).unwrap();
    run(&mut simulation, &mut boxes, 90);
    assert!(simulation.contacts().filter(tumble::Contact::touches).count() >= 8);
    let (found, pinned) = (hash(&boxes), PINNED_BOXES[usize::from(PRECISION == "f64")]);
    assert_eq!(found, pinned, "boxes, in hexadecimal: {found:#018x}");
}
