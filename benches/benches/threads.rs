//! What a further thread brings: a step of the default integrator over boxes, on one, two and four threads.
//!
//! More threads than the machine has cores show what it costs to ask for too many. `cargo bench --bench threads -- /100000`.

mod setup;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use tumble::{Settings, Simulation};
use tumble_benches::{label, pool, tumbling_boxes};

fn threads(criterion: &mut Criterion) {
    let pools = [1, 2, 4].map(pool);
    let mut group = criterion.benchmark_group("threads");
    for size in [1_000, 10_000, 100_000, 1_000_000] {
        let mut world = tumbling_boxes(size);
        group.throughput(Throughput::Elements(size as u64));
        for pool in &pools {
            let Ok(mut simulation) = Simulation::new(Settings::default()) else { return };
            group.bench_function(BenchmarkId::new(label(pool), size), |bencher| {
                pool.install(|| bencher.iter(|| simulation.step(&mut world)));
            });
        }
    }
}

criterion_group! {
    name = benches;
    config = setup::criterion();
    targets = threads
}
criterion_main!(benches);
