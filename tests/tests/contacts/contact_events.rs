//! Promise: every event of contacts is reported exactly once, however steps fall into frames or
//! calls: those of `advance` and `step_many`, one after the other, are those of the same steps one
//! by one, in the same order; the closure of `advance_with` gets those of the step before it;
//! batches report the same.
//!
//! Why: at 20 frames a second a game that reads events after `advance` would miss two of three, and
//! at 120 hear every blow twice. It fails if a frame reports its last step only, if one without
//! a step reports again, or if a body that goes in the middle of a frame takes its events along.

use hecs::{Entity, World};
use proptest::prelude::*;
use tumble::math::{Real, Vec3};
use tumble::prelude::*;
use tumble::{Batch, Collider, ContactEvent, Material, Rng, Trial};
use tumble_tests::touching::{collider, cube, spawn, surfaced};

/// What is done before a step.
#[derive(Clone, Copy)]
enum Change {
    Despawn(usize),
    TakeCollider(usize),
    Spawn,
}

/// A scene of bodies that come and go while they bounce, all by its number.
struct Scene {
    world: World,
    bodies: Vec<Entity>,
    rng: Rng,
    changes: Vec<(u64, Change)>,
}

impl Scene {
    fn new(seed: u64, steps: u64) -> Self {
        let mut rng = Rng::new(seed);
        let count = 5 + (rng.next_u64() % 40) as usize;
        let last = rng.next_u64().is_multiple_of(8);
        let changes = (0..count + 5)
            .map(|i| {
                let step = rng.next_u64() % steps;
                let kind = match rng.next_u64() % 4 {
                    0 => Change::Despawn(i),
                    1 => Change::TakeCollider(i),
                    _ => Change::Spawn,
                };
                // In some scenes everything goes, so that nothing is left to touch.
                (step, if last { Change::Despawn(i) } else { kind })
            })
            .collect();
        let mut this = Self { world: World::new(), bodies: Vec::new(), rng, changes };
        if !seed.is_multiple_of(3) {
            let bouncy = surfaced(Collider::half_space(), Material::new(0.3, 0.9));
            let ground = spawn(&mut this.world, RigidBody::new(Shape::Point).fixed(), bouncy);
            this.bodies.push(ground);
        }
        (0..count).for_each(|_| this.spawn());
        this
    }

    fn spawn(&mut self) {
        let rng = &mut self.rng;
        let ball = |x: f64| {
            let ball = Shape::sphere(0.12);
            tumble::Part::new(ball, tumble::Amount::Density(500.0)).at([x, 0.0, 0.0])
        };
        let shape = match rng.next_u64() % 4 {
            0 => Shape::sphere(0.2),
            1 => cube(0.15),
            2 => Shape::cylinder(0.15, 0.1),
            _ => Shape::compound([ball(-0.15), ball(0.15)]),
        };
        let body = RigidBody::new(shape.clone())
            .position(Vec3::Y * 1.5 + rng.vector(-1.0, 1.0))
            .orientation(rng.orientation())
            .linear_velocity(rng.vector(-4.0, 4.0));
        let body = if matches!(shape, Shape::Compound(_)) { body } else { body.mass(1.0) };
        // Some have an identity, some go by their entity.
        let body = if rng.next_u64().is_multiple_of(2) { body.id(BodyId(rng.next_u64())) } else { body };
        let bouncy = surfaced(collider(&shape), Material::new(0.2, rng.range(0.0, 1.0)));
        self.bodies.push(spawn(&mut self.world, body, bouncy));
    }

    fn before_step(&mut self, step: u64) {
        for i in 0..self.changes.len() {
            match self.changes[i] {
                (at, Change::Despawn(body)) if at == step => {
                    let _ = self.bodies.get(body).map(|body| self.world.despawn(*body));
                }
                (at, Change::TakeCollider(body)) if at == step => {
                    let _ = self.bodies.get(body).map(|body| self.world.remove_one::<Collider>(*body));
                }
                (at, Change::Spawn) if at == step => self.spawn(),
                _ => {}
            }
        }
    }
}

fn settings(seed: u64) -> Settings {
    Settings::default().with_substeps(1 + (seed % 5 / 4) as u32 * 2)
}

fn reported(simulation: &Simulation) -> Vec<ContactEvent> {
    simulation.contact_events().collect()
}

/// The events of each step.
fn step_by_step(seed: u64, steps: u64) -> Vec<Vec<ContactEvent>> {
    let mut scene = Scene::new(seed, steps);
    let mut simulation = Simulation::new(settings(seed)).unwrap();
    (0..steps)
        .map(|step| {
            scene.before_step(step);
            simulation.step(&mut scene.world);
            reported(&simulation)
        })
        .collect()
}

const STEPS: u64 = 150;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn frames_report_what_their_steps_report(seed in any::<u64>(), fastest in 0.005..0.25_f64) {
        let alone = step_by_step(seed, STEPS);
        prop_assume!(alone.iter().flatten().count() > 3);
        let mut scene = Scene::new(seed, STEPS);
        let mut simulation = Simulation::new(settings(seed)).unwrap();
        let (mut frames, mut times) = (Vec::new(), Rng::new(seed ^ 1));
        while simulation.steps() + u64::from(Simulation::MAX_STEPS_PER_FRAME) < STEPS {
            let frame = 0.005 + times.unit() * (fastest - 0.005);
            let before = simulation.steps();
            let mut world = std::mem::take(&mut scene.world);
            let mut in_closure = Vec::new();
            simulation.advance_with(&mut world, frame, |world, simulation| {
                in_closure.push((simulation.steps(), reported(simulation)));
                std::mem::swap(world, &mut scene.world);
                scene.before_step(simulation.steps());
                std::mem::swap(world, &mut scene.world);
            });
            scene.world = world;
            for (step, events) in in_closure {
                // Before the first step there was none.
                let last = step.checked_sub(1).map_or(Vec::new(), |last| alone[last as usize].clone());
                prop_assert_eq!(events, last);
            }
            let steps = before as usize..simulation.steps() as usize;
            prop_assert_eq!(reported(&simulation), alone[steps].concat());
            frames.extend(reported(&simulation));
        }
        prop_assert_eq!(frames, alone[..simulation.steps() as usize].concat());
        // A frame of no time has no events, nor has a world that was put back.
        simulation.advance(&mut scene.world, 0.0);
        prop_assert_eq!(reported(&simulation), []);
    }

    #[test]
    fn many_steps_report_what_each_reports(seed in any::<u64>(), most in 1_u64..40) {
        let alone = step_by_step(seed, STEPS);
        let mut scene = Scene::new(seed, STEPS);
        let mut simulation = Simulation::new(settings(seed)).unwrap();
        let mut counts = Rng::new(seed ^ 2);
        while simulation.steps() < STEPS {
            let step = simulation.steps();
            scene.before_step(step);
            let changed = scene.changes.iter().map(|(at, _)| *at).filter(|at| *at > step).min().unwrap_or(STEPS);
            let end = changed.min(step + 1 + counts.next_u64() % most).min(STEPS);
            simulation.step_many(&mut scene.world, (end - step) as u32);
            prop_assert_eq!(reported(&simulation), alone[step as usize..end as usize].concat());
        }
        simulation.step_many(&mut scene.world, 0);
        prop_assert_eq!(reported(&simulation), []);
    }

    #[test]
    fn batches_report_what_each_world_reports(seed in any::<u64>(), count in 2_u32..60) {
        let worlds: Vec<u64> = (0..20).map(|i| seed.wrapping_add(i * 5)).collect();
        let trial = |seed: &u64| Trial::new(settings(*seed), Scene::new(*seed, STEPS).world).unwrap();
        let mut batch: Batch = worlds.iter().map(trial).collect();
        batch.step_many(count);
        for (seed, together) in worlds.iter().zip(batch.trials()) {
            let mut alone = trial(seed);
            let mut events = Vec::new();
            for _ in 0..count {
                alone.step_many(1);
                events.extend(reported(&alone.simulation));
            }
            prop_assert_eq!(reported(&together.simulation), events);
        }
    }
}

/// A ball that bounces off within a frame has hit and left in it, in this order.
#[test]
fn a_blow_within_a_frame_is_reported_whole() {
    let mut world = World::new();
    let bouncy = Material::new(0.0, 1.0);
    let ground = spawn(&mut world, RigidBody::new(Shape::Point).fixed(), surfaced(Collider::half_space(), bouncy));
    let shape = Shape::sphere(0.5);
    let start = RigidBody::new(shape.clone()).mass(1.0).position(Vec3::Y * 1.0).linear_velocity(Vec3::Y * -12.0);
    let ball = spawn(&mut world, start, surfaced(collider(&shape), bouncy));
    let mut simulation = Simulation::new(Settings::default()).unwrap();
    simulation.advance(&mut world, 8.0 / 60.0 + 1e-6);
    let reported: Vec<_> =
        reported(&simulation).iter().map(|it| (matches!(it, ContactEvent::Begin(..)), it.bodies())).collect();
    assert_eq!(reported, [(true, [ground, ball]), (false, [ground, ball])]);
    assert!(world.get::<&Velocity>(ball).unwrap().linear.y > 10.0 as Real);
}

/// What was reported is not reported again of a state that was put back.
#[test]
fn a_restored_simulation_reports_nothing() {
    let mut world = World::new();
    let ground = RigidBody::new(Shape::Point).fixed().id(BodyId(0));
    spawn(&mut world, ground, Collider::half_space());
    let shape = cube(0.5);
    let bodies = RigidBody::new(shape.clone()).mass(1.0).position(Vec3::Y * 0.51).id(BodyId(1));
    spawn(&mut world, bodies, collider(&shape));
    let mut simulation = Simulation::new(Settings::default()).unwrap();
    let start = simulation.snapshot(&world).unwrap();
    simulation.advance(&mut world, 0.1);
    assert_eq!(reported(&simulation).len(), 1);
    let later = simulation.snapshot(&world).unwrap();
    for snapshot in [&later, &start] {
        simulation.advance(&mut world, 0.1);
        simulation.restore(snapshot, &mut world).unwrap();
        assert_eq!(reported(&simulation), []);
    }
    simulation.advance(&mut world, 0.1);
    assert_eq!(reported(&simulation).len(), 1);
}
