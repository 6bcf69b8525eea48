//! Promise: the same bodies give the same bits, whatever the number of threads, the order they were
//! spawned in, what was despawned between, how archetypes split them, how many there are beside,
//! and whether the systems run together or one by one. The bits are pinned: they are the same on
//! every machine and change only when the arithmetic is changed on purpose.
//!
//! Why: replays, lock-step networking and regression hunts need it. It fails if a body's result
//! depends on its neighbours in a chunk, a reduction follows memory order, a platform's mathematics
//! library or a fused multiply-add gets in, or threads share state.

use hecs::World;
use tumble::math::{PRECISION, Real, Vec3};
use tumble::{
    BodyId, BodyOrder, BodyState, ForceLaw, GravityMass, Integrator, InverseInertia, Momentum, Pose, PreviousPose,
    Settings, Simulation, SpringToPoint, Totals, Velocity, Wrench, accumulate_forces, integrate, simd_name,
    update_derived,
};
use tumble_benches::{mixed_bodies, mixed_body, mixed_moving_bodies, pool, tumbling_boxes};
use tumble_tests::{hash, run};

fn settings(integrator: Integrator) -> Settings {
    Settings::default().with_dt(1.0 / 128.0).with_integrator(integrator)
}

/// Steps in a pool of its own; the hash of the end.
fn hash_after(world: &mut World, settings: Settings, steps: u32) -> u64 {
    let mut simulation = Simulation::new(settings).unwrap();
    run(&mut simulation, world, steps);
    hash(world)
}

/// Several chunks in each of many archetypes, on one thread, two, and more than there are
/// processors.
#[test]
fn the_number_of_threads_does_not_matter() {
    for integrator in Integrator::ALL {
        let hashes = [1, 2, 4].map(|threads| {
            let mut world = mixed_bodies(20_000);
            let mut boxes = tumbling_boxes(5_000);
            let hash = pool(threads).install(|| hash_after(&mut world, settings(integrator), 20));
            (hash, pool(threads).install(|| hash_after(&mut boxes, settings(integrator), 20)))
        });
        assert_eq!(hashes[0], hashes[1], "{integrator}");
        assert_eq!(hashes[0], hashes[2], "{integrator}");
    }
}

const BODIES: u64 = 1500;

fn reference(integrator: Integrator) -> u64 {
    hash_after(&mut mixed_bodies(BODIES as usize), settings(integrator), 50)
}

#[test]
fn the_order_of_spawning_does_not_matter() {
    for integrator in Integrator::ALL {
        let mut backwards = World::new();
        for id in (0..BODIES).rev() {
            mixed_body(id).spawn(&mut backwards);
        }
        assert_eq!(hash_after(&mut backwards, settings(integrator), 50), reference(integrator), "{integrator}");
    }
}

/// Others come and go, before and during the run; hecs fills their rows with the last ones of the
/// archetype.
#[test]
fn despawned_bodies_leave_no_trace() {
    for integrator in Integrator::ALL {
        let mut world = World::new();
        let mut passing = Vec::new();
        for id in 0..BODIES {
            passing.push(mixed_body(BODIES + id).spawn(&mut world));
            mixed_body(id).spawn(&mut world);
        }
        let mut simulation = Simulation::new(settings(integrator)).unwrap();
        for step in 0..50 {
            for _ in 0..passing.len().div_ceil(50 - step) {
                world.despawn(passing.swap_remove(passing.len() / 2)).unwrap();
            }
            simulation.step(&mut world);
        }
        assert!(passing.is_empty());
        assert_eq!(hash(&world), reference(integrator), "{integrator}");
    }
}

/// Components of the caller split the bodies into other archetypes, also while they run.
#[test]
fn archetypes_do_not_matter() {
    struct Red;
    struct Armour(#[expect(dead_code, reason = "only its presence counts")] [u64; 9]);
    for integrator in Integrator::ALL {
        let mut world = mixed_bodies(BODIES as usize);
        let mut simulation = Simulation::new(settings(integrator)).unwrap();
        for step in 0..50 {
            for (i, &entity) in BodyOrder::of(&world).entities().iter().enumerate() {
                if (i * 7 + step) % 50 == 0 {
                    world.insert_one(entity, Red).unwrap();
                } else if (i * 11 + step) % 60 == 0 {
                    world.insert_one(entity, Armour([1; 9])).unwrap();
                } else if (i + step) % 40 == 0 {
                    let _ = world.remove_one::<Red>(entity);
                }
            }
            simulation.step(&mut world);
        }
        assert_eq!(hash(&world), reference(integrator), "{integrator}");
    }
}

/// A body in a crowd moves as it does alone, wherever in a chunk it is.
#[test]
fn neighbours_do_not_matter() {
    for integrator in Integrator::ALL {
        let mut crowd = mixed_bodies(BODIES as usize);
        hash_after(&mut crowd, settings(integrator), 50);
        let order = BodyOrder::of(&crowd);
        for id in (0..BODIES).step_by(37) {
            let mut alone = World::new();
            let entity = mixed_body(id).spawn(&mut alone);
            hash_after(&mut alone, settings(integrator), 50);
            let in_crowd = order.entities()[id as usize];
            assert_eq!(*crowd.get::<&BodyId>(in_crowd).unwrap(), BodyId(id));
            let same = *alone.get::<&tumble::Pose>(entity).unwrap() == *crowd.get::<&tumble::Pose>(in_crowd).unwrap();
            assert!(same, "{integrator}, body {id}");
            let momentum = |world: &World, entity| world.get::<&Momentum>(entity).map(|momentum| *momentum).ok();
            assert_eq!(momentum(&alone, entity), momentum(&crowd, in_crowd), "{integrator}, body {id}");
        }
    }
}

/// Full chunks, a body less and a body more.
#[test]
fn the_size_of_the_world_does_not_matter() {
    let boxes = |count: usize| {
        let mut world = tumbling_boxes(count);
        hash_after(&mut world, settings(Integrator::default()), 10);
        let first: Vec<_> = world.query_mut::<&tumble::Pose>().into_iter().take(1000).copied().collect();
        first
    };
    let few = boxes(1000);
    for count in [1023, 1024, 1025, 2048, 2049, 4097] {
        assert_eq!(boxes(count), few, "{count} bodies");
    }
    // What is left of whole tiles, in tiles of every width.
    for count in 1..=70 {
        assert_eq!(boxes(count), few[..count], "{count} bodies");
    }
}

/// The same for bodies of other kinds, whose columns are filled up too: turned axes, damping,
/// scaled gravity, points.
#[test]
fn the_size_of_a_kind_does_not_matter() {
    for integrator in Integrator::ALL {
        for kind in [1, 2, 9, 10] {
            let states = |count: u64| {
                let mut world = World::new();
                for i in 0..count {
                    let body = mixed_body(16 * i + kind).spawn(&mut world);
                    world.insert_one(body, PreviousPose(Pose::default())).unwrap();
                }
                hash_after(&mut world, settings(integrator), 5);
                let order = BodyOrder::of(&world);
                let one = |&body| (*world.get::<&Pose>(body).unwrap(), everything_else(&world, body));
                order.entities().iter().map(one).collect::<Vec<_>>()
            };
            let many = states(64);
            for count in 1..40 {
                assert_eq!(states(count), many[..count as usize], "{integrator}, kind {kind}, {count} bodies");
            }
        }
    }
}

/// Slows a body down, more as time goes on.
struct Brake;

impl ForceLaw for Brake {
    fn wrench(&self, state: &BodyState<'_>) -> Wrench {
        Wrench { force: state.linear_velocity * (state.time as Real * -0.1), ..Wrench::default() }
    }
}

#[derive(Clone, Copy)]
enum How {
    AtOnce,
    OneByOne,
}

/// `step_many(n)` is n calls of `step`: on bodies with and without laws, wrenches that act in the
/// first step, previous poses, and kinematic bodies.
#[test]
fn many_steps_at_once_are_single_steps() {
    for integrator in Integrator::ALL {
        let run = |how: How| {
            let mut world = mixed_bodies(1500);
            for (i, entity) in BodyOrder::of(&world).entities().iter().enumerate() {
                if i % 5 == 0 {
                    world.insert_one(*entity, Brake).unwrap();
                }
                if i % 2 == 0 {
                    world.insert_one(*entity, PreviousPose(Pose::default())).unwrap();
                }
            }
            let mut simulation = Simulation::new(settings(integrator).with_substeps(2)).unwrap();
            simulation.add_law::<Brake>();
            for steps in [7, 12] {
                for wrench in world.query_mut::<&mut Wrench>() {
                    wrench.add_force(Vec3::new(30.0, 2.0, 0.0));
                    wrench.add_torque(Vec3::new(0.0, 0.1, 0.01));
                }
                match how {
                    How::AtOnce => simulation.step_many(&mut world, steps),
                    How::OneByOne => (0..steps).for_each(|_| simulation.step(&mut world)),
                }
            }
            let order = BodyOrder::of(&world);
            let rest: Vec<_> = order.entities().iter().map(|&body| everything_else(&world, body)).collect();
            (hash(&world), simulation.time(), simulation.steps(), rest)
        };
        assert_eq!(run(How::AtOnce), run(How::OneByOne), "{integrator}");
    }
}

type Rest = (Option<PreviousPose>, Option<Velocity>, Option<InverseInertia>, Option<Wrench>);

/// What is not in the hash.
fn everything_else(world: &World, body: hecs::Entity) -> Rest {
    let body = world.entity(body).unwrap();
    (
        body.get::<&PreviousPose>().map(|pose| *pose),
        body.get::<&Velocity>().map(|velocity| *velocity),
        body.get::<&InverseInertia>().map(|inertia| *inertia),
        body.get::<&Wrench>().map(|wrench| *wrench),
    )
}

/// `step` is `accumulate_forces`, `integrate` and `update_derived`, on bodies that forces move, one
/// after the other over the whole world.
#[test]
fn the_systems_one_by_one_are_the_step() {
    for integrator in Integrator::ALL {
        let settings = settings(integrator).with_substeps(2);
        // Kinematic bodies are moved by the step alone.
        let dynamic = || mixed_moving_bodies(BODIES as usize);
        let (mut together, mut apart) = (dynamic(), dynamic());
        let mut simulation = Simulation::new(settings).unwrap();
        for _ in 0..50 {
            simulation.step(&mut together);
            accumulate_forces(&mut apart, settings.gravity);
            integrate(&mut apart, &settings);
            update_derived(&mut apart);
        }
        assert_eq!(hash(&together), hash(&apart), "{integrator}");
        let velocities =
            |world: &mut World| -> Vec<Velocity> { world.query_mut::<&Velocity>().into_iter().copied().collect() };
        assert_eq!(velocities(&mut together), velocities(&mut apart), "{integrator}");
    }
}

/// Under forces that stay the same, such as gravity, a step of n substeps is n steps of that
/// length.
#[test]
fn substeps_are_shorter_steps() {
    for integrator in Integrator::ALL {
        for substeps in [2, 3, 7] {
            let dt: Real = 1.0 / 60.0;
            let dynamic = || mixed_moving_bodies(500);
            let coarse = settings(integrator).with_dt(dt).with_substeps(substeps);
            let fine = settings(integrator).with_dt(dt / substeps as Real);
            let hashes = (hash_after(&mut dynamic(), coarse, 20), hash_after(&mut dynamic(), fine, 20 * substeps));
            assert_eq!(hashes.0, hashes.1, "{integrator}, {substeps} substeps");
        }
    }
}

/// Sums over bodies are taken in their order, in blocks, so they have the same bits too, on any
/// number of threads; and they are those of the bodies one by one.
#[test]
fn totals_do_not_depend_on_threads_or_the_order_of_spawning() {
    // Three blocks and a part of one; some with a component more, so that neighbours in order lie
    // in different archetypes.
    let count = 3500;
    let world_of = |ids: &mut dyn Iterator<Item = u64>| {
        let mut world = World::new();
        for id in ids {
            let entity = mixed_body(id).spawn(&mut world);
            if id.is_multiple_of(5) {
                let anchor = Vec3::new(1.0, id as Real * 1e-3, -1.0);
                world.insert_one(entity, SpringToPoint { anchor, stiffness: 3.0, ..SpringToPoint::default() }).unwrap();
            }
            if id.is_multiple_of(7) {
                world.insert_one(entity, GravityMass::new(1e-3 * id as Real)).unwrap();
            }
        }
        world
    };
    let (forwards, backwards) = (world_of(&mut (0..count)), world_of(&mut (0..count).rev()));
    let settings = Settings::default();
    let order = BodyOrder::of(&forwards);
    let alone = Totals::of(&forwards, &settings, &order);
    for threads in [1, 2, 7] {
        for world in [&forwards, &backwards] {
            let totals = pool(threads).install(|| Totals::of(world, &settings, &BodyOrder::of(world)));
            assert_eq!(totals, alone, "{threads} threads");
        }
    }
    let mut sums = [0.0_f64; 4];
    let mut sizes = [0.0_f64; 4];
    for entity in order.entities() {
        let body = Totals::of_body(forwards.entity(*entity).unwrap(), &settings);
        let numbers = [body.linear_kinetic, body.rotational_kinetic, body.potential, body.angular_momentum.y];
        for (i, number) in numbers.into_iter().enumerate() {
            sums[i] += number;
            sizes[i] += number.abs();
        }
    }
    let numbers = [alone.linear_kinetic, alone.rotational_kinetic, alone.potential, alone.angular_momentum.y];
    for i in 0..4 {
        // A rounding for each addition.
        assert!((sums[i] - numbers[i]).abs() <= count as f64 * f64::EPSILON * sizes[i] && sizes[i] > 0.0, "{i}");
    }
}

/// One bit of one body changes the hash.
#[test]
fn the_hash_sees_a_single_bit() {
    let world = mixed_bodies(100);
    let before = hash(&world);
    let entity = BodyOrder::of(&world).entities()[57];
    let x = world.get::<&tumble::Pose>(entity).unwrap().position.x;
    world.get::<&mut tumble::Pose>(entity).unwrap().position.x = Real::from_bits(x.to_bits() ^ 1);
    assert_ne!(hash(&world), before);
    world.get::<&mut tumble::Pose>(entity).unwrap().position.x = x;
    assert_eq!(hash(&world), before);
}

/// A body that has gone wrong makes the hash another one, but the same one in every instruction set
/// and tile: a NaN has no sign.
#[test]
fn a_nan_has_one_hash() {
    let hashes = [Real::NAN, -Real::NAN, Real::from_bits(Real::NAN.to_bits() | 1)].map(|nan| {
        let mut world = tumbling_boxes(3);
        world.query_mut::<&mut Pose>().into_iter().next().unwrap().position.x = nan;
        hash(&world)
    });
    assert_eq!(hashes, [hashes[0]; 3]);
    assert_ne!(hashes[0], hash(&tumbling_boxes(3)));
}

/// 2000 bodies of every kind after 1000 steps.
///
/// A new hash is a new arithmetic: every recorded run of every user changes with it. Where that is
/// meant, put the printed number here and say so in the changelog.
#[test]
fn the_bits_are_pinned() {
    let pinned = match PRECISION {
        "f32" => [
            (Integrator::SemiImplicitEuler, 0x3dfb_2099_2a23_8f88_u64),
            (Integrator::RungeKutta4, 0x2c7d_8c7c_a8a2_08ea),
            (Integrator::MoserVeselov, 0x549f_3006_89e2_df1b),
        ],
        _ => [
            (Integrator::SemiImplicitEuler, 0xf348_153e_7d2d_ed93),
            (Integrator::RungeKutta4, 0x2357_723b_af0d_4bf3),
            (Integrator::MoserVeselov, 0x0204_387f_d417_4a04),
        ],
    };
    let found =
        pinned.map(|(integrator, _)| (integrator, hash_after(&mut mixed_bodies(2000), settings(integrator), 1000)));
    println!("\nran on {}", simd_name());
    for (integrator, hash) in found {
        println!("{PRECISION} {integrator}: {hash:#018x}");
    }
    assert_eq!(found, pinned, "in hexadecimal: {found:#018x?}");
}

/// A push that depends on velocity for some of the bodies that it acts on.
struct Breeze {
    strength: Real,
    drags: bool,
}

impl ForceLaw for Breeze {
    fn wrench(&self, state: &BodyState<'_>) -> Wrench {
        let drag = if self.drags { state.linear_velocity * -0.2 } else { Vec3::ZERO };
        Wrench { force: state.position * -self.strength + drag, torque: state.angular_velocity * -1e-3 }
    }

    fn depends_on_velocity(&self) -> bool {
        self.drags
    }
}

/// A law on every body, which grows with time.
struct Tide;

impl ForceLaw for Tide {
    fn wrench(&self, state: &BodyState<'_>) -> Wrench {
        Wrench { force: Vec3::new(state.time as Real * state.mass, 0.0, 0.0), torque: Vec3::ZERO }
    }

    fn depends_on_velocity(&self) -> bool {
        false
    }
}

/// The bodies with these identities after 100 steps under two laws: the hash of all, and the state
/// of each.
fn under_laws(ids: impl Iterator<Item = u64>, integrator: Integrator) -> (u64, Vec<(Pose, Momentum)>) {
    let mut world = World::new();
    // Without those that forces do not move.
    for id in ids.filter(|id| id % 16 < 14) {
        let body = mixed_body(id).spawn(&mut world);
        if id % 3 != 0 {
            world.insert_one(body, Breeze { strength: 0.5 + (id % 7) as Real, drags: id % 5 == 1 }).unwrap();
        }
    }
    let mut simulation = Simulation::new(settings(integrator).with_substeps(2)).unwrap();
    simulation.add_law::<Breeze>();
    simulation.add_global_law(Tide);
    simulation.step_many(&mut world, 100);
    let order = BodyOrder::of(&world);
    let state = |&body| (*world.get::<&Pose>(body).unwrap(), *world.get::<&Momentum>(body).unwrap());
    (hash(&world), order.entities().iter().map(state).collect())
}

/// Under laws a body moves in a crowd as it does alone, also where the law of its neighbour in a
/// tile depends on velocity and its own does not.
#[test]
fn neighbours_do_not_matter_under_laws() {
    for integrator in Integrator::ALL {
        let (_, crowd) = under_laws(0..700, integrator);
        let alone = (0..700).flat_map(|id| under_laws(id..id + 1, integrator).1);
        assert!(crowd.iter().copied().eq(alone), "{integrator}");
    }
}

/// The same under force laws: with as many bodies of each kind as leave tiles of every width to
/// fill up.
#[test]
fn the_bits_under_laws_are_pinned() {
    let pinned = match PRECISION {
        "f32" => [0x00a3_518b_c8ed_4701_u64, 0xa1ab_32c5_1b8a_444e, 0x265a_b259_78f4_088b],
        _ => [0x9c72_2948_6dcd_1a32, 0xc022_32c0_6a51_d93a, 0x7555_dfcc_77d4_c538],
    };
    let found = Integrator::ALL.map(|integrator| under_laws(0..700, integrator).0);
    assert_eq!(found, pinned, "in hexadecimal: {found:#018x?}");
}

/// The scene that is hashed, before any step: if this differs, it is the making of bodies that
/// changed, not the stepping.
#[test]
fn the_start_is_pinned() {
    let pinned = if PRECISION == "f32" { 0xf8d2_a96f_b8b7_899d } else { 0xc185_b6e3_a4fb_1f55 };
    let found = hash(&mixed_bodies(2000));
    assert_eq!(found, pinned, "{found:#018x}");
}
