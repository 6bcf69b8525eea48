//! Promise: a world of bodies with every force component, springs between them, attraction among
//! them and laws of the caller's gives the same bits for any number of threads, order of spawning
//! bodies and springs, layout of archetypes, instruction set, step by step or many at once, whole
//! or system by system, in a batch or alone, and after a snapshot was restored. The bits are
//! pinned.
//!
//! Why: what couples bodies sums over others, and a sum in memory's order or by whichever thread is
//! first is the classical way to lose determinism. It fails if a sum follows rows, entities or
//! threads, or if the state that forces between bodies keep from step to step goes stale.

use crate::changing_archetypes::run_changing_archetypes;
use hecs::{Entity, World};
use tumble::math::PRECISION;
use tumble::{
    Batch, BodyOrder, Integrator, Settings, Simulation, Snapshot, Spring, Totals, Trial, accumulate_forces,
    integrate_under_laws, simd_name, update_derived,
};
use tumble_benches::pool;
use tumble_tests::{hash, run};

use crate::coupled::{BODIES, Honey, Kinds, Tide, plain_scene, scene, shuffled, spawn, springs};

fn settings(integrator: Integrator) -> Settings {
    Settings::default().with_dt(1.0 / 128.0).with_integrator(integrator).with_substeps(2)
}

fn under_laws(mut simulation: Simulation) -> Simulation {
    simulation.add_global_law(Tide);
    simulation.add_simd_law::<Honey, 1>();
    simulation
}

fn simulation(integrator: Integrator) -> Simulation {
    under_laws(Simulation::new(settings(integrator)).unwrap())
}

fn hash_after(mut world: World, integrator: Integrator, steps: u32) -> u64 {
    let mut simulation = simulation(integrator);
    run(&mut simulation, &mut world, steps);
    let totals = Totals::of(&world, simulation.settings(), &BodyOrder::of(&world));
    // A world of numbers that are none would be the same however it came about.
    assert!(totals.non_finite.is_none() && totals.energy().abs() < 1e12, "{integrator}: {totals:?}");
    hash(&world)
}

#[test]
fn threads_do_not_matter() {
    for integrator in Integrator::ALL {
        let [one, two, four] =
            [1, 2, 4].map(|threads| pool(threads).install(|| hash_after(plain_scene(Kinds::All), integrator, 40)));
        assert_eq!(one, two, "{integrator}");
        assert_eq!(one, four, "{integrator}");
        assert_ne!(one, hash_after(plain_scene(Kinds::All), integrator, 39));
    }
}

/// Bodies and springs in any order, and rows that were filled by others.
#[test]
fn the_order_of_spawning_does_not_matter() {
    for integrator in Integrator::ALL {
        let reference = hash_after(plain_scene(Kinds::All), integrator, 40);
        for seed in 0..3 {
            let ids = shuffled((0..BODIES).collect(), seed);
            let world = scene(&ids, &shuffled(springs(), 100 + seed), Kinds::All);
            assert_eq!(hash_after(world, integrator, 40), reference, "{integrator}, {seed}");
        }
        // Bodies and springs that come and go beside it, in the same tiles and the same parts.
        let mut world = plain_scene(Kinds::All);
        let passing: Vec<Entity> = (0..50).map(|i| spawn(&mut world, BODIES + 1 + 2 * i)).collect();
        let far = world.spawn((Spring::between(passing[0], passing[1]).with_stiffness(3.0),));
        let mut simulation = simulation(integrator);
        // What passes must not attract: odd identities have no mass.
        run(&mut simulation, &mut world, 20);
        world.despawn(far).unwrap();
        passing.into_iter().for_each(|body| world.despawn(body).unwrap());
        run(&mut simulation, &mut world, 20);
        assert_eq!(hash(&world), reference, "{integrator}: passing bodies");
    }
}

/// Archetypes change while it runs: what is kept from step to step must not remember where things
/// lay.
#[test]
fn archetypes_do_not_matter() {
    for integrator in Integrator::ALL {
        let mut world = plain_scene(Kinds::All);
        let mut simulation = simulation(integrator);
        run_changing_archetypes(&mut simulation, &mut world, 40);
        assert_eq!(hash(&world), hash_after(plain_scene(Kinds::All), integrator, 40), "{integrator}");
    }
}

#[test]
fn many_steps_at_once_are_single_steps() {
    for integrator in Integrator::ALL {
        for kinds in [Kinds::NoKinematic, Kinds::All] {
            let mut at_once = plain_scene(kinds);
            let mut simulation = simulation(integrator);
            simulation.step_many(&mut at_once, 13);
            simulation.step_many(&mut at_once, 27);
            let kinematic = kinds == Kinds::All;
            assert_eq!(
                hash(&at_once),
                hash_after(plain_scene(kinds), integrator, 40),
                "{integrator}, kinematic: {kinematic}"
            );
        }
    }
}

#[test]
fn the_systems_one_by_one_are_the_step() {
    for integrator in Integrator::ALL {
        let settings = settings(integrator);
        let mut simulation = simulation(integrator);
        let (mut together, mut apart) = (plain_scene(Kinds::NoKinematic), plain_scene(Kinds::NoKinematic));
        for _ in 0..40 {
            accumulate_forces(&mut apart, settings.gravity);
            integrate_under_laws(&mut apart, &settings, simulation.laws(), simulation.time());
            update_derived(&mut apart);
            simulation.step(&mut together);
        }
        assert_eq!(hash(&together), hash(&apart), "{integrator}");
    }
}

/// In a batch with others of other settings, on two threads, a world gets the bits that it gets
/// alone.
#[test]
fn a_batch_does_not_matter() {
    let trial = |integrator| {
        let mut trial = Trial::new(settings(integrator), plain_scene(Kinds::All)).unwrap();
        trial.simulation = under_laws(trial.simulation);
        trial
    };
    let mut batch: Batch = Integrator::ALL.into_iter().chain(Integrator::ALL).map(trial).collect();
    pool(2).install(|| (0..40).for_each(|_| batch.step_many(1)));
    let hashes = batch.map(|_, trial| trial.state_hash());
    let alone = Integrator::ALL.map(|integrator| hash_after(plain_scene(Kinds::All), integrator, 40));
    assert_eq!(hashes, [alone, alone].concat());
}

/// Back to a snapshot, and on from there in the same world, in one of its own with another
/// simulation, and in one spawned in another order.
#[test]
fn a_restored_world_goes_on_as_before() {
    for integrator in Integrator::ALL {
        let mut world = plain_scene(Kinds::All);
        let mut simulation = simulation(integrator);
        run(&mut simulation, &mut world, 15);
        let (snapshot, clock) = (Snapshot::capture(&world).unwrap(), simulation.clock());
        run(&mut simulation, &mut world, 25);
        let reference = hash(&world);
        snapshot.restore(&mut world).unwrap();
        simulation.set_clock(clock);
        run(&mut simulation, &mut world, 25);
        assert_eq!(hash(&world), reference, "{integrator}");
        let ids = shuffled((0..BODIES).collect(), 5);
        let mut other = scene(&ids, &shuffled(springs(), 6), Kinds::All);
        snapshot.restore(&mut other).unwrap();
        let mut simulation = self::simulation(integrator);
        simulation.set_clock(clock);
        run(&mut simulation, &mut other, 25);
        assert_eq!(hash(&other), reference, "{integrator}: another world");
    }
}

/// A new hash is a new arithmetic; see `determinism.rs`.
#[test]
fn the_bits_are_pinned() {
    let pinned = match PRECISION {
        "f32" => [0x778c_b99a_925c_7c11_u64, 0x26df_5e3c_885b_e463, 0x7d12_5754_4c6d_9cf8],
        _ => [0x6959_d760_0708_9d28, 0x4f2b_3716_f4db_3184, 0x8258_b8bf_94c4_fe4b],
    };
    println!("\nran on {}", simd_name());
    let found = Integrator::ALL.map(|integrator| hash_after(plain_scene(Kinds::NoKinematic), integrator, 200));
    assert_eq!(found, pinned, "in hexadecimal: {found:#018x?}");
}
