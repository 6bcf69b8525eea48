//! Batches: many small worlds, and how close they come to one world with as many bodies.
//!
//! `cargo bench --bench batch -- target` is the run that other engines were measured with: 4096
//! worlds of 8 free boxes, 120 steps, and beside it one world of 32 768. `-- scaling` goes from one
//! world to 65 536 and from one body to 100 in each, `-- setup` makes worlds. The throughput is in
//! body-steps a second, for `setup` in bodies a second.

use std::time::Duration;

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, BenchmarkId, Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use hecs::World;
use rayon::ThreadPool;
use tumble::{Batch, RigidBody, Rng, Settings, Shape, Trial};
use tumble_benches::{OnDemand, label, pools};

const STEPS: u32 = 120;

/// With more bodies than this a bench takes fewer steps, so that it ends.
const MANY_BODIES: usize = 1_000_000;
const STEPS_OF_MANY: u32 = 20;

/// A world of free boxes; the bodies are possible, so it is always one.
fn trial(bodies: usize, mut rng: Rng) -> Option<Trial> {
    let mut world = World::new();
    for _ in 0..bodies {
        let body = RigidBody::new(Shape::cuboid(rng.vector(0.1, 1.0)))
            .without_collider()
            .density(1000.0)
            .position(rng.vector(-50.0, 50.0))
            .linear_velocity(rng.vector(-3.0, 3.0))
            .angular_velocity(rng.vector(-5.0, 5.0));
        body.build().ok()?.spawn(&mut world);
    }
    Trial::new(Settings::default(), world).ok()
}

fn batch(worlds: usize, bodies: usize) -> Option<Batch> {
    Batch::from_seed(worlds, 1, |_, rng| trial(bodies, rng).ok_or(())).ok()
}

/// One batch on one and on two threads.
fn measure(group: &mut BenchmarkGroup<'_, WallTime>, pools: &[ThreadPool], worlds: usize, bodies: usize) {
    let mut made = OnDemand::new(|| batch(worlds, bodies));
    let steps = if worlds * bodies > MANY_BODIES { STEPS_OF_MANY } else { STEPS };
    group.throughput(Throughput::Elements((worlds * bodies) as u64 * u64::from(steps)));
    for pool in pools {
        let id = BenchmarkId::new(label(pool), format!("{worlds} worlds x {bodies}"));
        group.bench_function(id, |bencher| {
            let Some(batch) = made.get() else { return };
            pool.install(|| bencher.iter(|| batch.step_many(steps)));
        });
    }
}

fn target(criterion: &mut Criterion) {
    let pools = pools();
    let mut group = criterion.benchmark_group("target");
    group.sampling_mode(SamplingMode::Flat);
    for (worlds, bodies) in [(4096, 8), (1, 32_768)] {
        measure(&mut group, &pools, worlds, bodies);
    }
}

fn scaling(criterion: &mut Criterion) {
    let pools = pools();
    let mut group = criterion.benchmark_group("scaling");
    group.sampling_mode(SamplingMode::Flat);
    for bodies in [1, 10, 100] {
        for worlds in [1, 16, 256, 4096, 65_536] {
            measure(&mut group, &pools, worlds, bodies);
        }
    }
}

fn setup(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("setup");
    for bodies in [1, 8, 100] {
        let worlds = 1000;
        group.throughput(Throughput::Elements((worlds * bodies) as u64));
        for pool in &pools() {
            let id = BenchmarkId::new(label(pool), format!("{worlds} worlds x {bodies}"));
            group.bench_function(id, |bencher| pool.install(|| bencher.iter(|| batch(worlds, bodies))));
        }
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(2));
    targets = target, scaling, setup
}
criterion_main!(benches);
