//! What it costs to make bodies: one entity at a time, many at once, and, as the yardstick, the
//! same components pushed to plain `Vec`s.
//!
//! All but `build` begin with bodies that are checked and computed, and with an empty world; making
//! the bodies of a scene from their shapes is `build`. `cargo bench --bench spawn -- boxes/copies`.

mod setup;

use std::cell::LazyCell;

use criterion::measurement::WallTime;
use criterion::{BatchSize, BenchmarkGroup, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use hecs::{Entity, World};
use tumble::math::Vec3;
use tumble::{
    Body, Inertia, InverseInertia, Mass, Momentum, Pose, RigidBody, Rng, Shape, Velocity, Wrench, spawn_bodies,
};
use tumble_benches::{mixed_body, tumbling_box};

const SIZES: [usize; 4] = [1_000, 10_000, 100_000, 1_000_000];
/// Different bodies; a million would be half a gigabyte.
const DIFFERENT: u64 = 1000;

/// The components of a box.
type Components = (Pose, Momentum, Mass, Inertia, Wrench, Velocity, InverseInertia);

#[allow(clippy::expect_used, reason = "a box has these components")]
fn components(body: &Body) -> Components {
    let mut world = World::new();
    let entity = body.spawn(&mut world);
    let all = world.query_one_mut::<(&Pose, &Momentum, &Mass, &Inertia, &Wrench, &Velocity, &InverseInertia)>(entity);
    let (pose, momentum, mass, inertia, wrench, velocity, inverse) = all.expect("a box");
    (*pose, *momentum, *mass, *inertia, *wrench, *velocity, *inverse)
}

/// As many of the bodies, over and over.
fn repeated(bodies: &[Body], size: usize) -> impl Iterator<Item = &Body> {
    bodies.iter().cycle().take(size)
}

fn one_by_one<'b>(world: &mut World, bodies: impl Iterator<Item = &'b Body>) -> Vec<Entity> {
    bodies.map(|body| body.spawn(world)).collect()
}

/// Measures filling an empty world; dropping it is not measured.
fn bench<O>(group: &mut BenchmarkGroup<'_, WallTime>, name: &str, size: usize, mut fill: impl FnMut(&mut World) -> O) {
    group.bench_function(BenchmarkId::new(name, size), |bencher| {
        bencher.iter_batched_ref(World::new, &mut fill, BatchSize::PerIteration);
    });
}

fn boxes(criterion: &mut Criterion) {
    let bodies: LazyCell<Vec<Body>> = LazyCell::new(|| {
        let mut rng = Rng::new(0xb0);
        (0..DIFFERENT).map(|_| tumbling_box(&mut rng)).collect()
    });
    let equal = LazyCell::new(|| components(&bodies[0]));
    let mut group = criterion.benchmark_group("boxes");
    for size in SIZES {
        group.throughput(Throughput::Elements(size as u64));
        bench(&mut group, "one by one", size, |world| one_by_one(world, repeated(&bodies, size)));
        bench(&mut group, "spawn_bodies", size, |world| spawn_bodies(world, repeated(&bodies, size)));
        bench(&mut group, "copies", size, |world| {
            let (pose, momentum, ..) = *equal;
            bodies[0].spawn_copies(world, (0..size).map(|_| (pose, momentum)))
        });
        bench(&mut group, "hecs spawn_batch", size, |world| {
            let equal = *equal;
            world.spawn_batch((0..size).map(|_| equal)).count()
        });
        bench(&mut group, "plain Vecs", size, |_| fill_vectors(*equal, size));
    }
}

/// Seven columns without a world.
fn fill_vectors(body: Components, size: usize) -> impl Sized {
    let (pose, momentum, mass, inertia, wrench, velocity, inverse) = body;
    (
        vec![pose; size],
        vec![momentum; size],
        vec![mass; size],
        vec![inertia; size],
        vec![wrench; size],
        vec![velocity; size],
        vec![inverse; size],
    )
}

fn mixed(criterion: &mut Criterion) {
    let bodies: LazyCell<Vec<Body>> = LazyCell::new(|| (0..DIFFERENT).map(mixed_body).collect());
    let mut group = criterion.benchmark_group("mixed");
    for size in SIZES {
        group.throughput(Throughput::Elements(size as u64));
        bench(&mut group, "one by one", size, |world| one_by_one(world, repeated(&bodies, size)));
        bench(&mut group, "spawn_bodies", size, |world| spawn_bodies(world, repeated(&bodies, size)));
    }
}

fn build(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("build");
    group.throughput(Throughput::Elements(1));
    group.bench_function("box", |bencher| {
        bencher.iter(|| {
            RigidBody::new(Shape::cuboid([0.1, 0.2, 0.3]))
                .without_collider()
                .density(1000.0)
                .angular_velocity(Vec3::X)
                .build()
        });
    });
}

criterion_group! {
    name = benches;
    config = setup::criterion();
    targets = boxes, mixed, build
}
criterion_main!(benches);
