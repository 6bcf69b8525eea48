//! What a further thread brings: a step of the default integrator over boxes, on one, two and four
//! threads; and what each integrator costs on one and on two.
//!
//! More threads than the machine has cores show what it costs to ask for too many.
//! `cargo bench --bench threads -- /100000`.

mod setup;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use tumble::{Integrator, Settings, Simulation};
use tumble_benches::{OnDemand, label, pool, pools, tumbling_boxes};

fn threads(criterion: &mut Criterion) {
    let pools = [1, 2, 4].map(pool);
    let mut group = criterion.benchmark_group("threads");
    for size in [1_000, 10_000, 100_000, 1_000_000] {
        let mut world = OnDemand::new(|| tumbling_boxes(size));
        group.throughput(Throughput::Elements(size as u64));
        for pool in &pools {
            let Ok(mut simulation) = Simulation::new(Settings::default()) else { return };
            group.bench_function(BenchmarkId::new(label(pool), size), |bencher| {
                let world = world.get();
                pool.install(|| bencher.iter(|| simulation.step(world)));
            });
        }
    }
}

fn integrators(criterion: &mut Criterion) {
    let pools = pools();
    for integrator in Integrator::ALL {
        let mut group = criterion.benchmark_group(format!("threads, {integrator}"));
        for size in [10_000, 1_000_000] {
            let mut world = OnDemand::new(|| tumbling_boxes(size));
            group.throughput(Throughput::Elements(size as u64));
            for pool in &pools {
                let settings = Settings::default().with_integrator(integrator);
                let Ok(mut simulation) = Simulation::new(settings) else { return };
                group.bench_function(BenchmarkId::new(label(pool), size), |bencher| {
                    let world = world.get();
                    pool.install(|| bencher.iter(|| simulation.step(world)));
                });
            }
        }
    }
}

criterion_group! {
    name = benches;
    config = setup::criterion();
    targets = threads, integrators
}
criterion_main!(benches);
