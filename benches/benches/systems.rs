//! Each system of the step alone: bodies of every kind, 100 to a million of them, on one and on two
//! threads. `integrate` is with the default integrator; the others are in `step.rs`.

mod setup;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use hecs::World;
use tumble::{Settings, accumulate_forces, integrate, update_derived};
use tumble_benches::{OnDemand, SIZES, label, mixed_bodies, pools};

/// A system as the benches call it.
type System = fn(&mut World, &Settings);

fn systems(criterion: &mut Criterion) {
    let pools = pools();
    let settings = Settings::default();
    let systems: [(&str, System); 3] = [
        ("accumulate_forces", |world, settings| accumulate_forces(world, settings.gravity)),
        ("integrate", integrate),
        ("update_derived", |world, _| update_derived(world)),
    ];
    for size in SIZES {
        let mut world = OnDemand::new(|| mixed_bodies(size));
        for (name, system) in systems {
            let mut group = criterion.benchmark_group(name);
            group.throughput(Throughput::Elements(size as u64));
            for pool in &pools {
                group.bench_function(BenchmarkId::new(label(pool), size), |bencher| {
                    let world = world.get();
                    pool.install(|| bencher.iter(|| system(world, &settings)));
                });
            }
        }
    }
}

criterion_group! {
    name = benches;
    config = setup::criterion();
    targets = systems
}
criterion_main!(benches);
