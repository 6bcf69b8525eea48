//! What it costs to take and to restore a snapshot of 10 000 bodies, beside a plain copy of as many
//! bytes: of one kind, and of every kind.
//!
//! `capture` and `copy to new memory` allocate, the others do not. `cargo bench --bench snapshots`;
//! the throughput is in bodies a second.

#![allow(clippy::expect_used, reason = "a bench without what it measures is to fail")]

use std::hint::black_box;
use std::time::Duration;

use criterion::measurement::WallTime;
use criterion::{Bencher, BenchmarkGroup, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use hecs::World;
use tumble::{BodyId, BodyOrder, Settings, Simulation, Snapshot, update_derived};
use tumble_benches::{OnDemand, mixed_bodies, mixed_body};

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

/// Bodies as after a step, not as after spawning, and a snapshot of them.
struct Saved {
    world: World,
    snapshot: Snapshot,
    bytes: Vec<u8>,
    /// The snapshot as read from the bytes.
    loaded: Snapshot,
}

impl Saved {
    fn new(mut world: World) -> Self {
        Simulation::new(Settings::default()).expect("possible settings").step(&mut world);
        assert_eq!(world.query::<&BodyId>().iter().count(), BODIES as usize);
        let snapshot = Snapshot::capture(&world).expect("every body has an identity of its own");
        let bytes = snapshot.to_bytes();
        let loaded = Snapshot::from_bytes(&bytes).expect("the bytes of a snapshot");
        Self { world, snapshot, bytes, loaded }
    }

    /// A hundredth of the bodies have moved to other archetypes since.
    fn moved(world: World) -> Self {
        let mut saved = Self::new(world);
        for (i, &entity) in BodyOrder::of(&saved.world).entities().iter().enumerate() {
            if i % 100 == 0 {
                let _ = saved.world.insert_one(entity, ());
            }
        }
        saved
    }
}

fn bench_copies(group: &mut BenchmarkGroup<'_, WallTime>, name: &str, made: fn() -> World) {
    let mut copied = OnDemand::new(|| {
        let bytes = vec![1_u8; Saved::new(made()).snapshot.memory()];
        (bytes.clone(), bytes)
    });
    group.bench_function(BenchmarkId::new("copy", name), |bencher| {
        let (bytes, buffer) = copied.get();
        bencher.iter(|| buffer.copy_from_slice(black_box(bytes)));
    });
    group.bench_function(BenchmarkId::new("copy to new memory", name), |bencher| {
        let (bytes, _) = copied.get();
        bencher.iter(|| black_box(&*bytes).clone());
    });
}

fn bench_snapshots(group: &mut BenchmarkGroup<'_, WallTime>, name: &str, made: fn() -> World) {
    let mut saved = OnDemand::new(|| Saved::new(made()));
    let mut bench = |what: &str, run: fn(&mut Bencher<'_>, &mut Saved)| {
        group.bench_function(BenchmarkId::new(what, name), |bencher| run(bencher, saved.get()));
    };
    bench("capture", |bencher, saved| bencher.iter(|| Snapshot::capture(&saved.world)));
    bench("recapture", |bencher, saved| bencher.iter(|| saved.snapshot.recapture(&saved.world)));
    bench("restore", |bencher, saved| bencher.iter(|| saved.snapshot.restore(&mut saved.world)));
    bench("restore and derive", |bencher, saved| {
        bencher.iter(|| {
            let spawned_since = saved.snapshot.restore(&mut saved.world);
            update_derived(&mut saved.world);
            spawned_since
        });
    });
    bench("state hash", |bencher, saved| bencher.iter(|| saved.snapshot.state_hash()));
    bench("to bytes", |bencher, saved| bencher.iter(|| saved.snapshot.to_bytes()));
    bench("from bytes", |bencher, saved| bencher.iter(|| Snapshot::from_bytes(&saved.bytes)));
    bench("restore, loaded", |bencher, saved| bencher.iter(|| saved.loaded.restore(&mut saved.world)));
    let mut moved = OnDemand::new(|| Saved::moved(made()));
    group.bench_function(BenchmarkId::new("restore, moved", name), |bencher| {
        let saved = moved.get();
        bencher.iter(|| saved.snapshot.restore(&mut saved.world));
    });
}

fn snapshots(criterion: &mut Criterion) {
    type Scene = (&'static str, fn() -> World);
    let scenes: [Scene; 2] = [("one kind", spheres), ("every kind", || mixed_bodies(BODIES as usize))];
    for (name, made) in scenes {
        let mut group = criterion.benchmark_group("snapshots");
        group.throughput(Throughput::Elements(BODIES));
        bench_copies(&mut group, name, made);
        bench_snapshots(&mut group, name, made);
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
