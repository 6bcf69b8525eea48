//! Promise: a step taken phase by phase has the bits, the events and the accounts of a whole step,
//! for bodies of every kind, whatever reads the world in between and however early the caller
//! stops, and while bodies go and states are restored between steps; what a system changes between
//! two phases acts, and what is out of range spoils only its own body; the hooks of a frame are
//! called before and after every step; and a caller's law is asked once at each stage for a body
//! without an account, constrained or free.
//!
//! Why: a caller's own schedule is worth nothing if contacts, their warm start, or kinematic bodies
//! only work in the closed step. It fails if a phase reads what another one left stale, if a phase
//! is run twice or never, or if the free motion of a constrained body is computed besides.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use hecs::{Entity, World};
use tumble::math::{Real, Vec3};
use tumble::prelude::*;
use tumble::{
    Collider, Contact, ContactEvent, ForceLaws, Snapshot, StepHooks, StepPhase, Work, accumulate_forces,
    integrate_under_laws, move_kinematic_bodies, remember_poses, update_derived,
};
use tumble_tests::touching::{collider, cube, ground, spawn};
use tumble_tests::{Draw, by_precision, hash, run};

/// A field that grows, and counts how often it is asked.
#[derive(Clone, Default)]
struct Field(Arc<AtomicU64>);

impl ForceLaw for Field {
    fn wrench(&self, state: &BodyState<'_>) -> Wrench {
        self.0.fetch_add(1, Ordering::Relaxed);
        Wrench { force: Vec3::X * (0.3 * state.mass * state.time as Real), torque: Vec3::ZERO }
    }
}

/// Bodies of many kinds, of sizes from a decimetre to metres, some of which touch something.
fn scene(case: u64) -> World {
    let (mut world, mut draw) = (World::new(), Draw::new(0x5C4E, case));
    if draw.often(0.8) {
        ground(&mut world, Material::default(), tumble::math::Quat::IDENTITY);
    }
    let mut bodies = Vec::new();
    for i in 0..24 {
        let size = draw.log_between(0.1, 1.0);
        let shape = if draw.often(0.5) { Shape::sphere(size) } else { cube(size) };
        let at = draw.vector(3.0).as_vec3() + glam::Vec3::Y * 3.0;
        let mut body =
            RigidBody::new(shape.clone()).without_collider().density(500.0).id(BodyId(i)).position(vector(at));
        body = body.angular_velocity(vector(draw.vector(3.0).as_vec3()));
        if draw.often(0.15) {
            body = body.kinematic();
        }
        let body = body.build().unwrap();
        let entity = if draw.often(0.7) {
            body.spawn_with(&mut world, (collider(&shape), PreviousPose::default()))
        } else {
            body.spawn_with(&mut world, (PreviousPose::default(),))
        };
        if draw.often(0.3) {
            world.insert_one(entity, Damping { linear: 0.2, angular: 0.1 }).unwrap();
        }
        bodies.push(entity);
    }
    if draw.often(0.5) {
        for pair in bodies.windows(2).step_by(5) {
            world.spawn((Spring::between(pair[0], pair[1]).with_stiffness(40.0).with_damping(1.0),));
        }
    }
    if draw.often(0.3) {
        bodies.iter().step_by(3).for_each(|body| world.insert_one(*body, GravityMass::new(50.0)).unwrap());
    }
    for body in bodies.iter().skip(1).step_by(4) {
        let locks = [LockedAxes::PLANE_XY, LockedAxes::ROTATIONS, LockedAxes(Axes::LINEAR_X)];
        world.insert_one(*body, locks[draw.between(0.0, 3.0) as usize]).unwrap();
    }
    world
}

fn vector(v: glam::Vec3) -> Vec3 {
    Vec3::new(v.x.into(), v.y.into(), v.z.into())
}

fn simulation(case: u64, field: &Field) -> Simulation {
    let settings = Settings::default()
        .with_substeps(1 + case as u32 % 3)
        .with_sleep((case % 4 == 1).then(Sleep::default))
        .with_integrator(Integrator::ALL[case as usize / 3 % Integrator::ALL.len()]);
    let mut simulation = Simulation::new(settings).unwrap();
    simulation.add_global_law(field.clone());
    simulation
}

fn works(world: &World) -> Vec<Option<Work>> {
    let mut works: Vec<_> = world.query::<(Entity, Option<&Work>)>().iter().map(|(id, it)| (id, it.copied())).collect();
    works.sort_by_key(|(id, _)| *id);
    works.into_iter().map(|(_, work)| work).collect()
}

/// Poses before the last step.
fn previous(world: &World) -> Vec<(Entity, PreviousPose)> {
    let mut poses: Vec<_> = world.query::<(Entity, &PreviousPose)>().iter().map(|(id, it)| (id, *it)).collect();
    poses.sort_by_key(|(id, _)| *id);
    poses
}

/// Also with a reader between the phases, and with a caller who leaves the rest to `drop`.
#[test]
fn phase_by_phase_is_the_step() {
    let mut touched = 0;
    for case in 0..60 {
        let fields = [Field::default(), Field::default()];
        let mut worlds = if case % 5 == 4 { [alone(case), alone(case)] } else { [scene(case), scene(case)] };
        let mut snapshots = [Snapshot::default(), Snapshot::default()];
        let mut simulations = fields.each_ref().map(|field| simulation(case, field));
        if case % 4 == 0 {
            for (world, simulation) in worlds.iter_mut().zip(&simulations) {
                Ledger::attach(world, simulation);
            }
        }
        for step in 0..40 {
            for (world, (simulation, snapshot)) in worlds.iter_mut().zip(simulations.iter_mut().zip(&mut snapshots)) {
                between_steps(step, world, simulation, snapshot);
            }
            simulations[0].step(&mut worlds[0]);
            let bodies = worlds[0].query::<&Pose>().iter().count();
            // A body with locked axes is known without a collider too.
            let is_known = |world: &World, body| world.satisfies::<hecs::Or<&Collider, &LockedAxes>>(body);
            let known = |world: &World, contact: &Contact| contact.bodies.iter().all(|body| is_known(world, *body));
            let before: Vec<_> = simulations[1].contacts().filter(|it| known(&worlds[1], it)).collect();
            let mut phases = simulations[1].begin_step(&mut worlds[1]);
            assert_eq!(phases.simulation().contacts().collect::<Vec<_>>(), before, "case {case}, step {step}");
            let mut left = if step % 3 == 2 { step % 7 } else { u32::MAX };
            while left > 0 && phases.run_phase().is_some() {
                left -= 1;
                let count = phases.world().query::<(&Pose, Option<&mut Momentum>)>().iter().count();
                assert_eq!(count, bodies);
            }
            drop(phases);
            let [a, b] = worlds.each_ref();
            assert_eq!(hash(a), hash(b), "case {case}, step {step}");
            assert_eq!(previous(a), previous(b), "case {case}, step {step}");
            assert_eq!(works(a), works(b), "case {case}, step {step}");
            let events: [Vec<ContactEvent>; 2] = simulations.each_ref().map(|it| it.contact_events().collect());
            touched += events[0].len();
            assert_eq!(events[0], events[1], "case {case}, step {step}");
            let contacts = simulations.each_ref().map(|it| it.contacts().collect::<Vec<_>>());
            assert_eq!(contacts[0], contacts[1], "case {case}, step {step}");
        }
        assert_eq!(simulations[0].clock(), simulations[1].clock());
        assert_eq!(fields[0].0.load(Ordering::Relaxed), fields[1].0.load(Ordering::Relaxed), "case {case}");
    }
    assert!(touched > 500, "{touched}");
}

/// A body is despawned, a state is kept, and come back to; the last collider goes.
fn between_steps(step: u32, world: &mut World, simulation: &mut Simulation, snapshot: &mut Snapshot) {
    let first = world.query::<(Entity, &BodyId)>().iter().min_by_key(|(_, id)| id.0).map(|(body, _)| body);
    match (step, first) {
        (20, Some(first)) => world.despawn(first).unwrap(),
        (25, _) => *snapshot = simulation.snapshot(world).unwrap(),
        (30, _) => assert!(simulation.restore(snapshot, world).unwrap().is_empty()),
        (35, _) => remove_colliders(world),
        _ => {}
    }
}

fn remove_colliders(world: &mut World) {
    let bodies: Vec<Entity> = world.query::<Entity>().with::<&Collider>().iter().collect();
    bodies.into_iter().for_each(|body| drop(world.remove_one::<Collider>(body).unwrap()));
}

/// Bodies of a scene that do not interact.
fn alone(case: u64) -> World {
    let mut world = scene(case);
    remove_colliders(&mut world);
    let bodies: Vec<Entity> = world.query::<Entity>().iter().collect();
    for body in bodies {
        world.remove_one::<GravityMass>(body).ok();
        world.remove_one::<LockedAxes>(body).ok();
        if world.get::<&Spring>(body).is_ok() {
            world.despawn(body).unwrap();
        }
    }
    world
}

/// Where no contact is kept from step to step, the free functions are enough.
#[test]
fn the_public_systems_are_the_step_of_bodies_alone() {
    for case in 0..12 {
        let (mut stepped, mut composed) = (alone(case), alone(case));
        let mut whole = simulation(case, &Field::default());
        let mut laws = ForceLaws::default();
        laws.add_global(Field::default());
        for step in 0..20 {
            let (settings, time) = (*whole.settings(), whole.time());
            whole.step(&mut stepped);
            remember_poses(&mut composed);
            accumulate_forces(&mut composed, settings.gravity);
            integrate_under_laws(&mut composed, &settings, &laws, time);
            move_kinematic_bodies(&mut composed, settings.dt);
            update_derived(&mut composed);
            assert_eq!(hash(&stepped), hash(&composed), "case {case}, step {step}");
            assert_eq!(previous(&stepped), previous(&composed), "case {case}, step {step}");
        }
    }
}

/// In order, with those of a substep as often as there are substeps.
#[test]
fn the_phases_are_the_documented_ones() {
    use StepPhase::*;
    let phases_of = |world: &mut World, simulation: &mut Simulation| {
        let mut step = simulation.begin_step(world);
        assert_eq!((step.next_phase(), step.substep()), (Some(RememberPoses), 0));
        let phases: Vec<_> = std::iter::from_fn(|| step.run_phase()).collect();
        assert_eq!((step.next_phase(), step.run_phase()), (None, None));
        phases
    };
    let mut simulation = Simulation::new(Settings::default().with_substeps(2)).unwrap();
    let mut world = World::new();
    let apart = phases_of(&mut world, &mut simulation);
    assert_eq!(apart, [RememberPoses, AccumulateForces, Integrate, MoveKinematic, UpdateDerived]);
    ground(&mut world, Material::default(), tumble::math::Quat::IDENTITY);
    let substep = [PairForcesBefore, FindContacts, SolveContacts, Integrate, MoveKinematic, PairForcesAfter];
    let expected: Vec<_> =
        [RememberPoses, AccumulateForces].into_iter().chain(substep).chain(substep).chain([UpdateDerived]).collect();
    assert_eq!(phases_of(&mut world, &mut simulation), expected);
    assert_eq!(simulation.steps(), 2);
}

/// A box on the ground that a system lifts with twice its weight, between two phases.
#[test]
fn a_system_between_two_phases_acts() {
    let (mut world, shape) = (World::new(), cube(0.5));
    ground(&mut world, Material::default(), tumble::math::Quat::IDENTITY);
    let body = spawn(&mut world, RigidBody::new(shape.clone()).mass(2.0).position(Vec3::Y * 0.5), collider(&shape));
    let mut simulation = Simulation::new(Settings::default().with_dt(0.01)).unwrap();
    run(&mut simulation, &mut world, 20);
    for _ in 0..10 {
        let mut step = simulation.begin_step(&mut world);
        while let Some(phase) = step.run_phase() {
            if phase == StepPhase::AccumulateForces {
                step.world().get::<&mut Wrench>(body).unwrap().add_force(Vec3::Y * (2.0 * 2.0 * 9.81));
            }
        }
    }
    let speed = f64::from(world.get::<&Velocity>(body).unwrap().linear.y);
    assert!((speed - 0.1 * 9.81).abs() < by_precision(1e-3, 1e-3), "{speed}");
}

/// Once in each step of the first-order integrator, of a body that lies and of one that falls.
#[test]
fn a_law_is_asked_once_for_each_body() {
    let (mut world, shape, field) = (World::new(), cube(0.5), Field::default());
    ground(&mut world, Material::default(), tumble::math::Quat::IDENTITY);
    for height in [0.5, 100.0] {
        let body = RigidBody::new(shape.clone()).mass(2.0).position(Vec3::Y * height);
        spawn(&mut world, body, collider(&shape));
    }
    let settings = Settings::default().with_integrator(Integrator::SemiImplicitEuler);
    let mut simulation = Simulation::new(settings).unwrap();
    simulation.add_global_law(field.clone());
    run(&mut simulation, &mut world, 10);
    assert!(simulation.contacts().count() == 1);
    assert_eq!(field.0.load(Ordering::Relaxed), 20);
}

/// Of a body that lies and of one that falls: a force that is added before the solver acts on both
/// in this step, and none is left for the next.
#[test]
fn a_wrench_lasts_one_step_in_contact_and_out_of_it() {
    for added_at in [StepPhase::FindContacts, StepPhase::SolveContacts, StepPhase::Integrate] {
        let (mut world, shape) = (World::new(), cube(0.5));
        ground(&mut world, Material::default(), tumble::math::Quat::IDENTITY);
        let bodies = [0.5, 100.0].map(|height| {
            let body = RigidBody::new(shape.clone()).mass(2.0).position(Vec3::Y * height);
            spawn(&mut world, body, collider(&shape))
        });
        let mut simulation = Simulation::new(Settings::default()).unwrap();
        run(&mut simulation, &mut world, 10);
        let mut step = simulation.begin_step(&mut world);
        while let Some(phase) = step.run_phase() {
            if phase == added_at {
                bodies.iter().for_each(|body| step.world().get::<&mut Wrench>(*body).unwrap().add_force(Vec3::X));
            }
        }
        drop(step);
        let left = bodies.map(|body| world.get::<&Wrench>(body).unwrap().force);
        let expected = if added_at == StepPhase::Integrate { Vec3::X } else { Vec3::ZERO };
        assert_eq!(left, [expected; 2], "{added_at:?}");
    }
}

/// Momenta, poses, masses and velocities without a number, set after contacts were found.
#[test]
fn numbers_out_of_range_between_phases_spoil_their_own_body_only() {
    for (case, bad) in [Real::NAN, Real::INFINITY, 1e30 as Real].into_iter().enumerate() {
        for what in 0..4 {
            let (mut world, shape) = (World::new(), cube(0.5));
            ground(&mut world, Material::default(), tumble::math::Quat::IDENTITY);
            let bodies: Vec<Entity> = (0..6)
                .map(|i| {
                    let at = Vec3::new((i % 3) as Real * 1.01, 0.5 + (i / 3) as Real, 0.0);
                    let body = RigidBody::new(shape.clone()).mass(2.0).position(at).id(BodyId(i));
                    let body = if i == 1 && what == 3 { body.kinematic() } else { body };
                    spawn(&mut world, body, collider(&shape))
                })
                .collect();
            let mut simulation = Simulation::new(Settings::default()).unwrap();
            run(&mut simulation, &mut world, 20);
            let mut step = simulation.begin_step(&mut world);
            while let Some(phase) = step.run_phase() {
                if phase == StepPhase::FindContacts {
                    match what {
                        0 => step.world().get::<&mut Momentum>(bodies[1]).unwrap().linear.x = bad,
                        1 => step.world().get::<&mut Momentum>(bodies[1]).unwrap().angular.z = bad,
                        2 => step.world().get::<&mut Pose>(bodies[1]).unwrap().position.y = bad,
                        _ => step.world().get::<&mut Velocity>(bodies[1]).unwrap().linear.y = bad,
                    }
                }
            }
            drop(step);
            run(&mut simulation, &mut world, 20);
            for (i, body) in bodies.iter().enumerate().filter(|(i, _)| *i != 1) {
                let pose = *world.get::<&Pose>(*body).unwrap();
                let moved = (pose.position - Vec3::new((i % 3) as Real * 1.01, pose.position.y, 0.0)).length();
                assert!(pose.position.is_finite() && moved < 2.0, "case {case}, {what}, body {i}: {pose:?}");
            }
        }
    }
}

#[derive(Default)]
struct Diary(Vec<(&'static str, u64, usize)>);

impl StepHooks for Diary {
    fn before_step(&mut self, _: &mut World, simulation: &Simulation) {
        self.0.push(("before", simulation.steps(), simulation.contact_events().count()));
    }

    fn after_step(&mut self, world: &mut World, simulation: &Simulation) {
        assert!(world.query_mut::<&Pose>().into_iter().count() == 2);
        self.0.push(("after", simulation.steps(), simulation.contact_events().count()));
    }
}

/// A ball that meets the ground: its event is that of one step, after it and before the next, and
/// the frame has it once.
#[test]
fn hooks_are_called_before_and_after_every_step() {
    let (mut world, shape) = (World::new(), Shape::sphere(0.5));
    ground(&mut world, Material::default(), tumble::math::Quat::IDENTITY);
    let ball = RigidBody::new(shape.clone()).mass(1.0).position(Vec3::Y * 0.65).linear_velocity(Vec3::Y * -10.0);
    spawn(&mut world, ball, collider(&shape));
    let mut simulation = Simulation::new(Settings::default().with_dt(0.01)).unwrap();
    let mut diary = Diary::default();
    simulation.advance_with_hooks(&mut world, 0.0501, &mut diary);
    let calls: Vec<_> = diary.0.iter().map(|(when, step, _)| (*when, *step)).collect();
    let expected: Vec<_> = (0..5).flat_map(|step| [("before", step), ("after", step + 1)]).collect();
    assert_eq!(calls, expected);
    let with_event: Vec<_> = (0..10).filter(|call| diary.0[*call].2 > 0).collect();
    assert!(with_event.len() == 2 && with_event[0] % 2 == 1 && with_event[1] == with_event[0] + 1, "{with_event:?}");
    assert_eq!(simulation.contact_events().count(), 1);
}
