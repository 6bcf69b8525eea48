//! Promise: the work that is booked on a body has the same bits whatever its neighbours are, how
//! many threads step them, and with every instruction set: those of the body alone, whose numbers
//! go one by one.
//!
//! Why: books of two machines are compared. It fails if work is summed over the bodies of a tile,
//! if the kernel with books rounds otherwise in one width, if a law is shown another's state or an
//! earlier time, or if bodies that only fill up a tile are booked.

use glam::DVec3;
use hecs::{Entity, World};
use tumble::math::{Real, Vec3};
use tumble::{Amount, BodyId};
use tumble::{
    BodyOrder, Damping, Drag, GravityScale, Integrator, Ledger, Part, Pose, PreviousPose, RigidBody, Settings, Shape,
    Simulation, SpringToPoint, Wind, Work, Wrench,
};
use tumble_benches::pool;
use tumble_tests::{Draw, hash, quat, vec3};

use crate::coupled::{Honey, Tide};

/// All tiles of all widths, and what they leave over.
const BODIES: u64 = 16 + 8 + 4 + 3;
const STEPS: u32 = 6;

/// What the bodies have, and what acts on them: a law more than there are accounts shares the last.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
enum Kind {
    Plain,
    Damped,
    UnderComponents,
    UnderLaws,
}

const KINDS: [Kind; 4] = [Kind::Plain, Kind::Damped, Kind::UnderComponents, Kind::UnderLaws];

/// A body of a centimetre to a hundred metres and a gram to a ton, slow or of many turns a step.
fn spawn(world: &mut World, kind: Kind, id: u64) -> Entity {
    let mut draw = Draw::new(0xb00c, id);
    let size = draw.log_between(0.01, 100.0);
    let edges = DVec3::new(1.0, draw.log_between(0.1, 1.0), draw.log_between(0.1, 1.0)) * size;
    let mass = draw.log_between(1e-3, 1e3);
    let shape = if kind == Kind::Damped {
        // Principal axes that are not those of the frame.
        let part = Part::new(Shape::cuboid(edges), Amount::Mass(mass));
        Shape::compound([part, Part::new(Shape::sphere(0.1 * size), Amount::Mass(0.1 * mass)).at(vec3(edges * 0.4))])
    } else {
        Shape::cuboid(edges)
    };
    let body = RigidBody::new(shape).without_collider().id(BodyId(id));
    let body = if kind == Kind::Damped { body } else { body.mass(mass) };
    let body = body.position(vec3(draw.vector(100.0))).orientation(quat(draw.orientation()));
    let spin = draw.direction() * draw.log_between(0.01, 1000.0);
    let body = body.linear_velocity(vec3(draw.vector(10.0))).angular_velocity(vec3(spin));
    let body = body.build().unwrap().spawn(world);
    let number = draw.log_between(0.01, 2.0) as Real;
    match kind {
        Kind::Plain => {}
        Kind::Damped => {
            let damping = Damping { linear: number, angular: 0.5 * number };
            world.insert(body, (damping, GravityScale(0.3 * number), PreviousPose::default())).unwrap();
        }
        Kind::UnderComponents => {
            // In proportion to mass and size, so that no integrator explodes.
            let (heavy, large) = ((mass as Real) * number, (size * size) as Real);
            let drag = Drag { linear: Vec3::splat(1e-3 * heavy), angular: Vec3::splat(1e-7 * heavy * large) };
            let attachment = vec3(edges * 0.1);
            let spring = SpringToPoint { attachment, stiffness: heavy, ..SpringToPoint::default() };
            world.insert(body, (drag, spring, Wind(Vec3::X * number))).unwrap();
        }
        Kind::UnderLaws => world.insert_one(body, Honey(0.1 * mass as Real * number)).unwrap(),
    }
    body
}

fn simulation(kind: Kind, integrator: Integrator, substeps: u32) -> Simulation {
    let settings = Settings::default().with_integrator(integrator).with_substeps(substeps);
    let mut simulation = Simulation::new(settings).unwrap();
    if kind == Kind::UnderLaws {
        (0..8).for_each(|_| simulation.add_global_law(Tide));
        simulation.add_simd_law::<Honey, 1>();
    }
    simulation
}

/// Steps bodies that are pushed at the start: one by one, then several at once.
fn step(world: &mut World, simulation: &mut Simulation) {
    for (wrench, id) in world.query_mut::<(&mut Wrench, &BodyId)>() {
        let force = Vec3::new(1.0, -2.0, 3.0) * (1 + id.0 % 3) as Real;
        *wrench = Wrench { force, torque: force * 1e-3 };
    }
    (0..STEPS / 2).for_each(|_| simulation.step(world));
    simulation.step_many(world, STEPS / 2);
}

/// The bits of the work on a body, in order of the struct's fields.
fn bits(world: &World, body: Entity) -> Vec<u64> {
    let work = *world.get::<&Work>(body).unwrap();
    let single = [work.gravity, work.applied, work.damping, work.contacts, work.joints, work.sleep, work.integrator];
    single.into_iter().chain(work.forces).chain(work.laws).map(f64::to_bits).collect()
}

/// For each integrator, with one substep and with three.
fn for_each_case(then: impl Fn(Kind, Integrator, u32)) {
    for kind in KINDS {
        for integrator in Integrator::ALL {
            [1, 3].into_iter().for_each(|substeps| then(kind, integrator, substeps));
        }
    }
}

#[test]
fn the_bits_of_books_are_those_of_a_body_alone() {
    for_each_case(|kind, integrator, substeps| {
        let mut together = World::new();
        let bodies: Vec<_> = (0..BODIES).map(|id| spawn(&mut together, kind, id)).collect();
        let mut unbooked = World::new();
        for id in 0..BODIES {
            spawn(&mut unbooked, kind, id);
        }
        let mut stepped = simulation(kind, integrator, substeps);
        Ledger::attach(&mut together, &stepped);
        step(&mut together, &mut stepped);
        step(&mut unbooked, &mut simulation(kind, integrator, substeps));
        assert_eq!(hash(&together), hash(&unbooked), "{kind:?}, {integrator}: books changed the motion");
        for (id, &body) in bodies.iter().enumerate() {
            let mut world = World::new();
            let alone = spawn(&mut world, kind, id as u64);
            let mut simulation = simulation(kind, integrator, substeps);
            Ledger::attach(&mut world, &simulation);
            step(&mut world, &mut simulation);
            let case = format!("{kind:?}, {integrator}, {substeps} substeps, body {id}");
            assert_eq!(*world.get::<&Pose>(alone).unwrap(), *together.get::<&Pose>(body).unwrap(), "{case}");
            assert_eq!(bits(&world, alone), bits(&together, body), "{case}");
            let work = *world.get::<&Work>(alone).unwrap();
            let acts = [work.damping, work.of("Drag").unwrap(), work.laws[7]].map(|work| work != 0.0);
            assert_eq!(acts, [Kind::Damped, Kind::UnderComponents, Kind::UnderLaws].map(|of| kind == of), "{case}");
            assert!(work.gravity != 0.0 && work.applied != 0.0 && work.total().is_finite(), "{case}");
        }
    });
}

/// Enough bodies for several chunks.
#[test]
fn books_do_not_depend_on_threads() {
    for kind in KINDS {
        let run = |threads: usize| {
            let mut world = World::new();
            for id in 0..1500 {
                spawn(&mut world, kind, id);
            }
            let mut simulation = simulation(kind, Integrator::default(), 1);
            let mut ledger = Ledger::attach(&mut world, &simulation);
            pool(threads).install(|| step(&mut world, &mut simulation));
            let order = BodyOrder::of(&world);
            let works: Vec<_> = order.entities().iter().map(|&body| bits(&world, body)).collect();
            (works, ledger.record(&world, &simulation))
        };
        let one = run(1);
        assert!(run(2) == one && run(5) == one, "{kind:?}");
    }
}
