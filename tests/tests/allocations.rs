//! Promise: once a world has been stepped, stepping it allocates nothing, on no thread: not with
//! many kinds of bodies, own force laws, force components, springs and attraction between bodies,
//! contacts, a ledger, one thread or two. Nor does it allocate to save a pile and to go back to it,
//! once a rollback is full.
//!
//! Why: an allocation in a game's frame is a hitch, and in a world of ten bodies it takes longer
//! than they do. It fails if a step collects archetypes, chunks or laws in something that grows.
//!
//! Steps are taken within a thread pool, as a game does that runs its frame there: handing a step
//! over from outside to a pool's threads may allocate, and so does the first step that a thread
//! takes of bodies that act on each other. There is one test in this file, because the whole
//! process is counted.

use std::sync::Barrier;

use alloc_tracker::{Allocator, Session};
use hecs::World;
use rayon::{ThreadPool, ThreadPoolBuilder};
use tumble::math::{Quat, Real, Vec3};
use tumble::{
    Axes, BodyOrder, BodyState, Drive, Drives, ForceLaw, Gear, Integrator, Joint, Ledger, Material, RigidBody,
    Rollback, Settings, Shape, Simulation, Wrench,
};
use tumble_benches::{mixed_bodies, net, tumbling_boxes};
use tumble_tests::{Draw, touching};

#[global_allocator]
static ALLOCATOR: Allocator<std::alloc::System> = Allocator::system();

/// Slows a body down.
struct Brake;

impl ForceLaw for Brake {
    fn wrench(&self, state: &BodyState<'_>) -> Wrench {
        Wrench { force: state.linear_velocity * -0.1, ..Wrench::default() }
    }
}

/// With a law on every third body.
fn braked_bodies() -> World {
    let mut world = mixed_bodies(3000);
    for entity in BodyOrder::moving(&world).entities().iter().step_by(3) {
        world.insert_one(*entity, Brake).unwrap();
    }
    world
}

#[path = "shared/coupled/mod.rs"]
mod coupled;
#[path = "shared/mechanisms/mod.rs"]
mod mechanisms;
use mechanisms::{Class, Options, add_options, mechanism};

/// Mechanisms with loops that fly apart, and one that hangs.
fn jointed_bodies() -> World {
    let mut world = World::new();
    for case in 0..40 {
        let class = Class { bodies: 15, loops: 0.2, is_fixed: case == 0, first_id: 100 * case, ..Class::PLAIN };
        let plan = mechanism(class, &mut Draw::new(0xA110C, case));
        let all = |count: usize| (0..count).collect::<Vec<_>>();
        let (_, joints) = plan.spawn(&mut world, &all(plan.bodies.len()), &all(plan.joints.len()));
        if case % 2 == 0 {
            let options = Options { has_springs: true, breaks: false, size: 0.5, mass: 5.0 };
            add_options(&mut world, &joints, options, case);
            world.spawn((Gear::new(joints[0], joints[1], -2.0),));
        }
    }
    world
}

/// A pyramid of 204 boxes, which stands: contacts neither come nor go.
fn pyramid() -> World {
    tumble_benches::pyramid(8)
}

/// Trunks on feet by hinges with servos: contacts that are solved with joints, and may bounce.
fn standing_robots() -> World {
    let mut world = World::new();
    let material = Material::new(0.6, 0.5);
    touching::ground(&mut world, material, Quat::IDENTITY);
    for number in 0..20 {
        let at = Vec3::X * (2.0 * number as Real);
        let [foot, trunk] = [([0.3, 0.05, 0.2], 0.5, 0.05), ([0.15, 0.4, 0.15], 58.0, 0.5)].map(|(half, mass, up)| {
            let shape = Shape::cuboid(half);
            let body = RigidBody::new(shape.clone()).mass(mass).position(at + Vec3::Y * up);
            touching::spawn(&mut world, body, touching::surfaced(touching::collider(&shape), material))
        });
        let hinge = Joint::hinge(foot, trunk).at(&world, at + Vec3::Y * 0.1, Vec3::Z).unwrap();
        let servo = Drive::position(Axes::ANGULAR_X, 0.0).with_stiffness(1e5, 1e4);
        world.spawn((hinge, Drives::from(servo)));
    }
    world
}

/// With everything that can act, in several parts of springs and of masses.
fn coupled_bodies() -> World {
    coupled::plain_scene(coupled::Kinds::All)
}

/// A thread's first theft makes it known to the others, once in its life; on a busy machine that
/// may be in a later step than the first.
fn wake(pool: &ThreadPool) {
    let all_at_work = Barrier::new(pool.current_num_threads());
    pool.install(|| {
        rayon::scope(|scope| {
            for _ in 0..pool.current_num_threads() {
                scope.spawn(|_| {
                    all_at_work.wait();
                });
            }
        });
    });
}

fn count_steps(session: &Session) {
    type Scene = fn() -> World;
    let scenes: [(&str, Scene); 16] = [
        ("empty", World::new),
        ("one", || tumbling_boxes(1)),
        ("boxes", || tumbling_boxes(20_000)),
        ("mixed", || mixed_bodies(20_000)),
        ("braked", braked_bodies),
        ("booked", || mixed_bodies(200)),
        ("coupled", coupled_bodies),
        ("coupled and booked", coupled_bodies),
        ("touching", pyramid),
        ("touching and booked", pyramid),
        ("asleep", pyramid),
        ("jointed", jointed_bodies),
        ("jointed and booked", jointed_bodies),
        ("net in passes", || net(40)),
        ("standing", standing_robots),
        ("standing and booked", standing_robots),
    ];
    for threads in [1, 2] {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        wake(&pool);
        for (name, scene) in scenes {
            for integrator in Integrator::ALL {
                let mut world = scene();
                let sleep = (name == "asleep").then_some(tumble::Sleep { time: 0.01, ..Default::default() });
                let settings = Settings::default().with_integrator(integrator).with_sleep(sleep);
                let mut simulation = Simulation::new(settings).unwrap();
                simulation.add_law::<Brake>();
                simulation.add_simd_law::<coupled::Honey, 1>();
                if name.ends_with("booked") {
                    // Elsewhere it would start threads of another pool, whose first theft counts.
                    pool.install(|| drop(Ledger::attach(&mut world, &simulation)));
                }
                let counted = session.operation(format!("{name}, {integrator}, {threads} threads"));
                pool.install(|| {
                    let settles = sleep.is_some() || name.starts_with("standing");
                    simulation.step_many(&mut world, if settles { 120 } else { 1 });
                    assert_eq!(simulation.sleeping_bodies().count() > 0, sleep.is_some());
                    let _counting = counted.measure_process();
                    for _ in 0..10 {
                        simulation.step(&mut world);
                    }
                    simulation.step_many(&mut world, 10);
                });
            }
        }
    }
}

fn count_rollback(session: &Session) {
    let counted = session.operation("rollback with contacts");
    ThreadPoolBuilder::new().num_threads(1).build().unwrap().install(|| {
        let (mut world, mut simulation) = (pyramid(), Simulation::new(Settings::default()).unwrap());
        simulation.step_many(&mut world, 10);
        let mut rollback = Rollback::new(4);
        let mut go_back = |saves: usize| {
            for _ in 0..saves {
                rollback.save(&world, &simulation).unwrap();
                simulation.step(&mut world);
            }
            rollback.rewind(saves - 1, &mut world, &mut simulation).unwrap();
        };
        (0..3).for_each(|_| go_back(4));
        {
            let _counting = counted.measure_process();
            (0..3).for_each(|_| go_back(4));
        }
        assert!(simulation.contacts().count() > 200);
    });
}

#[test]
fn a_step_allocates_nothing() {
    let session = Session::new();
    count_steps(&session);
    count_rollback(&session);
    for (name, counted) in session.to_report().operations() {
        assert_eq!(counted.total_allocations_count(), 0, "{name}: {counted}");
    }

    // The counting counts.
    let counted = session.operation("a box");
    {
        let _counting = counted.measure_process();
        drop(std::hint::black_box(Box::new(1)));
    }
    assert!(counted.total_bytes_allocated() > 0);
}
