//! What the ledger costs: a step that no ledger is attached to, one whose work is booked, and one whose ledger was taken away again.
//!
//! The first and the last are to cost the same; `cargo bench --bench ledger`.

mod setup;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use hecs::World;
use tumble::{Integrator, Ledger, Settings, Simulation};
use tumble_benches::tumbling_boxes;

const BODIES: usize = 10_000;

/// What is done about a ledger before the steps that are measured.
type Prepare = fn(&mut World, &Simulation);

const PREPARATIONS: [(&str, Prepare); 3] = [
    ("off", |_, _| {}),
    ("attached", |world, simulation| drop(Ledger::attach(world, simulation))),
    ("detached", |world, simulation| Ledger::attach(world, simulation).detach(world)),
];

fn ledger(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("ledger");
    group.throughput(Throughput::Elements(BODIES as u64));
    for integrator in Integrator::ALL {
        for (name, prepare) in PREPARATIONS {
            let Ok(mut simulation) = Simulation::new(Settings::default().with_integrator(integrator)) else { return };
            let mut world = tumbling_boxes(BODIES);
            prepare(&mut world, &simulation);
            group.bench_function(BenchmarkId::new(integrator.name(), name), |bencher| {
                bencher.iter(|| simulation.step(&mut world));
            });
        }
    }
}

criterion_group! {
    name = benches;
    config = setup::criterion();
    targets = ledger
}
criterion_main!(benches);
