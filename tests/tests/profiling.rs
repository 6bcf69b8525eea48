//! Promise: with the feature `profiling` a profiler sees each phase of the step, and the worlds of
//! a batch, as often as they run.
//!
//! Why: one who looks for lost time in a game wants to see the engine beside the rest. It fails if
//! a scope is dropped with a rewrite of the step.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

use hecs::World;
use rayon::ThreadPoolBuilder;
use tracing::span::{Attributes, Id, Record};
use tracing::{Event, Metadata, Subscriber};
use tumble::math::Vec3;
use tumble::{
    BodyState, ForceLaw, Ledger, RigidBody, Settings, Shape, Simulation, Trial, Wrench, accumulate_forces, integrate,
    update_derived,
};

type Counts = BTreeMap<&'static str, u32>;

/// Counts how often a scope is begun.
#[derive(Clone, Default)]
struct Counter(Arc<Mutex<Counts>>);

impl Subscriber for Counter {
    fn enabled(&self, _: &Metadata<'_>) -> bool {
        true
    }

    fn new_span(&self, span: &Attributes<'_>) -> Id {
        *self.0.lock().unwrap().entry(span.metadata().name()).or_default() += 1;
        Id::from_u64(1)
    }

    fn record(&self, _: &Id, _: &Record<'_>) {}
    fn record_follows_from(&self, _: &Id, _: &Id) {}
    fn event(&self, _: &Event<'_>) {}
    fn enter(&self, _: &Id) {}
    fn exit(&self, _: &Id) {}
}

/// The scopes that a function begins; on this thread, for the subscriber is this thread's.
fn scopes(work: impl FnOnce()) -> Counts {
    let counter = Counter::default();
    tracing::subscriber::with_default(counter.clone(), work);
    let counts = counter.0.lock().unwrap().clone();
    counts
}

fn counts<const N: usize>(counts: [(&'static str, u32); N]) -> Counts {
    Counts::from(counts)
}

struct Still;

impl ForceLaw for Still {
    fn wrench(&self, _: &BodyState<'_>) -> Wrench {
        Wrench { force: Vec3::ZERO, torque: Vec3::ZERO }
    }
}

fn world() -> World {
    let mut world = World::new();
    RigidBody::new(Shape::sphere(1.0)).without_collider().mass(1.0).build().unwrap().spawn(&mut world);
    world
}

#[test]
fn every_phase_is_seen() {
    let pool = ThreadPoolBuilder::new().num_threads(1).use_current_thread().build().unwrap();
    let (mut bodies, mut simulation) = (world(), Simulation::new(Settings::default()).unwrap());
    pool.install(|| {
        // Where forces are constant, a chunk takes all its steps at once.
        let steps = scopes(|| simulation.step_many(&mut bodies, 5));
        assert_eq!(steps, counts([("tumble::step", 1), ("tumble::step_chunk", 1)]));

        let (accumulate, derive) = ("tumble::accumulate_forces", "tumble::update_derived");
        let settings = Settings::default();
        assert_eq!(scopes(|| accumulate_forces(&mut bodies, settings.gravity)), counts([(accumulate, 1)]));
        assert_eq!(scopes(|| integrate(&mut bodies, &settings)), counts([("tumble::integrate", 1)]));
        assert_eq!(scopes(|| update_derived(&mut bodies)), counts([(derive, 1)]));

        // Laws and a ledger make no difference.
        simulation.add_global_law(Still);
        let steps = scopes(|| simulation.step_many(&mut bodies, 3));
        assert_eq!(steps, counts([("tumble::step", 1), ("tumble::step_chunk", 1)]));
        // Kinematic bodies are moved in a pass of their own, where there are any.
        RigidBody::new(Shape::sphere(1.0)).without_collider().kinematic().build().unwrap().spawn(&mut bodies);
        Ledger::attach(&mut bodies, &simulation);
        let steps = scopes(|| simulation.step_many(&mut bodies, 3));
        let kinematic = ("tumble::move_kinematic_bodies", 1);
        assert_eq!(steps, counts([("tumble::step", 1), ("tumble::step_chunk", 1), kinematic]));

        let mut trial = Trial::new(settings, world()).unwrap();
        assert_eq!(scopes(|| trial.step_many(2)).get("tumble::trial"), Some(&1));
    });
}
