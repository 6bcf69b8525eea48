//! What questions about a world cost.
//!
//! - `rays`: of a hundred metres, one by one, among boxes of a metre of which a cube of a hundred
//!   metres has ten thousand;
//! - `many rays`: a hundred thousand of them in one call, on one thread and on more;
//! - `casts`, `overlaps`, `nearest`: a ball of half a metre along ten metres, and where it is;
//! - `up to date`: for each body, where none has moved, and where all have.
//!
//! `cargo bench --bench queries -- rays`.

#![allow(clippy::unwrap_used, reason = "a bench without what it measures is to fail")]

mod setup;

use std::cell::LazyCell;
use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use tumble::math::Vec3;
use tumble::{Collider, Pose, QueryFilter, Ray, Settings, Shape, Simulation};
use tumble_benches::{OnDemand, label, pools, rays_through_boxes, scattered_boxes};

const ALL: QueryFilter<'static> = QueryFilter::ALL;
const RAYS: usize = 1000;
const MANY: usize = 100_000;

fn questions(c: &mut Criterion) {
    let mut group = c.benchmark_group("queries");
    let simulation = Simulation::new(Settings::default()).unwrap();
    let rays = LazyCell::new(|| rays_through_boxes(RAYS));
    let ball = LazyCell::new(|| Collider::new(&Shape::sphere(0.5)).unwrap());
    group.throughput(Throughput::Elements(RAYS as u64));
    for count in [100, 10_000, 100_000] {
        let world = LazyCell::new(|| scattered_boxes(count));
        let queries = LazyCell::new(|| simulation.queries(&world));
        group.bench_function(BenchmarkId::new("rays", count), |b| {
            let (rays, queries) = (&*rays, &*queries);
            b.iter(|| rays.iter().filter(|ray| queries.cast_ray(black_box(ray), &ALL).is_some()).count());
        });
    }
    let world = LazyCell::new(|| scattered_boxes(10_000));
    let queries = LazyCell::new(|| simulation.queries(&world));
    let place = |ray: &Ray| Pose { position: ray.origin, ..Pose::default() };
    let places: LazyCell<Vec<Pose>, _> = LazyCell::new(|| rays.iter().map(place).collect());
    group.bench_function("casts", |b| {
        let (rays, ball, places, queries) = (&*rays, &*ball, &*places, &*queries);
        let way = |i: usize| rays[i].direction.normalize_or(Vec3::X) * 10.0;
        b.iter(|| (0..RAYS).filter(|i| queries.cast_shape(ball, &places[*i], way(*i), &ALL).is_some()).count());
    });
    group.bench_function("overlaps", |b| {
        let (ball, places, queries) = (&*ball, &*places, &*queries);
        b.iter(|| places.iter().map(|at| queries.overlapping(ball, at, &ALL).len()).sum::<usize>());
    });
    group.bench_function("nearest", |b| {
        let (rays, queries) = (&*rays, &*queries);
        b.iter(|| rays.iter().filter(|ray| queries.nearest(ray.origin, 10.0, &ALL).is_some()).count());
    });
    group.finish();
}

fn many_rays(c: &mut Criterion) {
    let mut group = c.benchmark_group("queries/many rays");
    let simulation = Simulation::new(Settings::default()).unwrap();
    let world = LazyCell::new(|| scattered_boxes(10_000));
    let queries = LazyCell::new(|| simulation.queries(&world));
    let rays = LazyCell::new(|| rays_through_boxes(MANY));
    group.throughput(Throughput::Elements(MANY as u64));
    for pool in pools() {
        group.bench_function(label(&pool), |b| {
            let (rays, queries) = (&*rays, &*queries);
            b.iter(|| pool.install(|| queries.cast_rays(black_box(rays), &ALL)));
        });
    }
    group.finish();
}

fn up_to_date(c: &mut Criterion) {
    let mut group = c.benchmark_group("queries/up to date");
    for count in [1000, 100_000] {
        let simulation = Simulation::new(Settings::default()).unwrap();
        let mut world = OnDemand::new(|| scattered_boxes(count));
        group.throughput(Throughput::Elements(count as u64));
        group.bench_function(BenchmarkId::new("none has moved", count), |b| {
            let world = &*world.get();
            b.iter(|| simulation.queries(world).is_blocked(&Ray::new(Vec3::ZERO, -Vec3::X), &ALL));
        });
        group.bench_function(BenchmarkId::new("all have moved", count), |b| {
            let world = world.get();
            b.iter(|| {
                world.query_mut::<&mut Pose>().into_iter().for_each(|pose| pose.position.y += 1e-3);
                simulation.queries(world).is_blocked(&Ray::new(Vec3::ZERO, -Vec3::X), &ALL)
            });
        });
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = setup::criterion();
    targets = questions, many_rays, up_to_date
}
criterion_main!(benches);
