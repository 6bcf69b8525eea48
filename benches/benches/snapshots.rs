//! What it costs to take and to restore a snapshot of 10 000 bodies, beside a plain copy of as many
//! bytes: of one kind, and of every kind.
//!
//! `capture` and `copy to new memory` allocate, the others do not. `cargo bench --bench snapshots`.

use std::hint::black_box;
use std::time::Duration;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use hecs::World;
use tumble::{BodyId, BodyOrder, Settings, Simulation, Snapshot, SnapshotError, update_derived};
use tumble_benches::{mixed_bodies, mixed_body};

const BODIES: u64 = 10_000;

/// Bodies of one kind: all in one archetype.
fn spheres() -> World {
    let mut world = World::new();
    for id in 0..BODIES {
        // The kinds of the mixed bodies repeat every 16.
        mixed_body(16 * id).spawn(&mut world);
    }
    world
}

fn bench_copies(criterion: &mut Criterion, name: &str, world: &World) -> Result<(), SnapshotError> {
    let mut group = criterion.benchmark_group("snapshots");
    let bytes = vec![1_u8; Snapshot::capture(world)?.memory()];
    let mut buffer = bytes.clone();
    group.bench_function(BenchmarkId::new("copy", name), |bencher| {
        bencher.iter(|| buffer.copy_from_slice(black_box(&bytes)));
    });
    group.bench_function(BenchmarkId::new("copy to new memory", name), |bencher| {
        bencher.iter(|| black_box(&bytes).clone());
    });
    Ok(())
}

fn bench_snapshots(criterion: &mut Criterion, name: &str, mut world: World) -> Result<(), SnapshotError> {
    bench_copies(criterion, name, &world)?;
    let mut group = criterion.benchmark_group("snapshots");
    let mut snapshot = Snapshot::capture(&world)?;
    group.bench_function(BenchmarkId::new("capture", name), |bencher| bencher.iter(|| Snapshot::capture(&world)));
    group.bench_function(BenchmarkId::new("recapture", name), |bencher| bencher.iter(|| snapshot.recapture(&world)));
    group.bench_function(BenchmarkId::new("restore", name), |bencher| bencher.iter(|| snapshot.restore(&mut world)));
    group.bench_function(BenchmarkId::new("restore and derive", name), |bencher| {
        bencher.iter(|| {
            let spawned_since = snapshot.restore(&mut world);
            update_derived(&mut world);
            spawned_since
        });
    });
    group.bench_function(BenchmarkId::new("state hash", name), |bencher| bencher.iter(|| snapshot.state_hash()));
    group.bench_function(BenchmarkId::new("to bytes", name), |bencher| bencher.iter(|| snapshot.to_bytes()));
    let bytes = snapshot.to_bytes();
    group.bench_function(BenchmarkId::new("from bytes", name), |bencher| {
        bencher.iter(|| Snapshot::from_bytes(&bytes));
    });
    let loaded = Snapshot::from_bytes(&bytes)?;
    group.bench_function(BenchmarkId::new("restore, loaded", name), |bencher| {
        bencher.iter(|| loaded.restore(&mut world));
    });
    // A hundredth of the bodies have moved to other archetypes.
    for (i, &entity) in BodyOrder::of(&world).entities().iter().enumerate() {
        if i % 100 == 0 {
            let _ = world.insert_one(entity, ());
        }
    }
    group.bench_function(BenchmarkId::new("restore, moved", name), |bencher| {
        bencher.iter(|| snapshot.restore(&mut world));
    });
    Ok(())
}

#[allow(clippy::expect_used, reason = "every body of these scenes has an identity of its own")]
fn snapshots(criterion: &mut Criterion) {
    for (name, mut world) in [("one kind", spheres()), ("every kind", mixed_bodies(BODIES as usize))] {
        // As after a step, not as after spawning.
        if let Ok(mut simulation) = Simulation::new(Settings::default()) {
            simulation.step(&mut world);
        }
        debug_assert!(world.query::<&BodyId>().iter().count() == BODIES as usize);
        bench_snapshots(criterion, name, world).expect("a snapshot");
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(30)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1));
    targets = snapshots
}
criterion_main!(benches);
