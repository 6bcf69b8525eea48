//! What each integrator costs: 10 000 boxes under gravity on one thread, with one and with eight substeps a step.
//!
//! Substeps that nothing couples run in registers, so that seven eighths of what eight of them cost above one is a substep without
//! memory. The throughput is in bodies stepped a second; `--features f64` measures double precision.
//!
//! `cargo bench --bench integrators -- moser-veselov`.

mod setup;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use tumble::{Integrator, Settings, Simulation};
use tumble_benches::{pool, tumbling_boxes};

const BODIES: usize = 10_000;

fn integrators(criterion: &mut Criterion) {
    let one_thread = pool(1);
    let mut world = tumbling_boxes(BODIES);
    for integrator in Integrator::ALL {
        let mut group = criterion.benchmark_group(integrator.name());
        group.throughput(Throughput::Elements(BODIES as u64));
        for substeps in [1, 8] {
            let settings = Settings::default().with_substeps(substeps).with_integrator(integrator);
            let Ok(mut simulation) = Simulation::new(settings) else { return };
            group.bench_function(BenchmarkId::new("substeps", substeps), |bencher| {
                one_thread.install(|| bencher.iter(|| simulation.step(&mut world)));
            });
        }
    }
}

criterion_group! {
    name = benches;
    config = setup::criterion();
    targets = integrators
}
criterion_main!(benches);
