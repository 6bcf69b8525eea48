//! A whole step with each integrator: bodies of every kind, 100 to a million of them, on one and on
//! two threads.
//!
//! `cargo bench --bench step -- moser-veselov/2` picks some by name. The throughput is in bodies a
//! second.

mod setup;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use tumble::{Integrator, Settings, Simulation};
use tumble_benches::{OnDemand, SIZES, label, mixed_bodies, pools};

fn step(criterion: &mut Criterion) {
    let pools = pools();
    for size in SIZES {
        let mut world = OnDemand::new(|| mixed_bodies(size));
        for integrator in Integrator::ALL {
            let mut group = criterion.benchmark_group(integrator.name());
            group.throughput(Throughput::Elements(size as u64));
            for pool in &pools {
                let Ok(mut simulation) = Simulation::new(Settings::default().with_integrator(integrator)) else {
                    return;
                };
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
    targets = step
}
criterion_main!(benches);
