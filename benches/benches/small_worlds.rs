//! Worlds so small that what counts is what a step costs besides its bodies: none to a hundred
//! boxes, called as a game calls it, from a thread that is not one of rayon's.
//!
//! `step` is one step; `step_many` is 120, divided by 120 in the throughput. `compounds in each
//! other` is a step of two bodies of ten or forty balls, all in each other; an element is a pair of
//! balls.
//! `cargo bench --bench small_worlds -- step/`.

mod setup;

use criterion::{BatchSize, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use tumble::{Settings, Simulation};
use tumble_benches::{OnDemand, compounds_in_each_other, tumbling_boxes};

const STEPS: u32 = 120;

fn small_worlds(criterion: &mut Criterion) {
    for (name, steps) in [("step", 1), ("step_many", STEPS)] {
        let mut group = criterion.benchmark_group(name);
        for size in [0, 1, 2, 8, 10, 16, 100] {
            let Ok(mut simulation) = Simulation::new(Settings::default()) else { return };
            let mut world = OnDemand::new(|| tumbling_boxes(size));
            // The throughput of an empty world is in steps.
            group.throughput(Throughput::Elements(size.max(1) as u64 * u64::from(steps)));
            group.bench_function(BenchmarkId::from_parameter(size), |bencher| {
                let world = world.get();
                bencher.iter(|| match steps {
                    1 => simulation.step(world),
                    _ => simulation.step_many(world, steps),
                });
            });
        }
    }
}

/// A search through all pairs for each pair would cost sixteen times as much a pair with four times
/// as many balls.
fn compounds(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("compounds in each other");
    for balls in [10, 40] {
        let Ok(mut simulation) = Simulation::new(Settings::default()) else { return };
        group.throughput(Throughput::Elements((balls * balls) as u64));
        group.bench_function(BenchmarkId::from_parameter(balls), |bencher| {
            // They part in a few steps.
            let made = || compounds_in_each_other(balls);
            bencher.iter_batched_ref(made, |world| simulation.step(world), BatchSize::PerIteration);
        });
    }
}

criterion_group! {
    name = benches;
    config = setup::criterion();
    targets = small_worlds, compounds
}
criterion_main!(benches);
