//! What bodies at rest cost a step: boxes in stacks of five, asleep, and the same awake.
//!
//! `cargo bench --bench sleep`.

#![allow(clippy::unwrap_used, reason = "a bench without what it measures is to fail")]

mod setup;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use hecs::World;
use tumble::prelude::*;
use tumble_benches::{OnDemand, label, pools};

fn stacks(count: u32) -> World {
    let mut world = World::new();
    spawn_ground(&mut world);
    let block = RigidBody::new(Shape::cuboid([0.5; 3])).density(1000.0);
    let side = f64::from(count / 5).sqrt().ceil() as u32;
    for i in 0..count {
        let (stack, level) = (i / 5, i % 5);
        let place = [1.5 * (stack % side) as Real, 0.5 + level as Real, 1.5 * (stack / side) as Real];
        block.clone().position(Vec3::from(place)).build().unwrap().spawn(&mut world);
    }
    world
}

/// A second later: asleep where they may sleep.
fn rested(count: u32, sleep: Option<Sleep>) -> (World, Simulation) {
    let mut world = stacks(count);
    let mut simulation = Simulation::new(Settings::default().with_sleep(sleep)).unwrap();
    simulation.step_many(&mut world, 60);
    assert_eq!(simulation.sleeping_bodies().count(), if sleep.is_some() { count as usize } else { 0 });
    (world, simulation)
}

fn rest(c: &mut Criterion) {
    let mut group = c.benchmark_group("sleep");
    for (name, count, sleep) in [
        ("asleep", 10_000, Some(Sleep::default())),
        ("asleep", 100_000, Some(Sleep::default())),
        ("awake", 10_000, None),
    ] {
        for pool in pools() {
            let mut at_rest = OnDemand::new(|| pool.install(|| rested(count, sleep)));
            group.throughput(Throughput::Elements(u64::from(count)));
            let id = BenchmarkId::new(format!("{name}, {count}"), label(&pool));
            group.bench_function(id, |b| {
                let (world, simulation) = at_rest.get();
                b.iter(|| pool.install(|| simulation.step(world)));
            });
        }
    }
    group.finish();
}

criterion_group! { name = benches; config = setup::criterion(); targets = rest }
criterion_main!(benches);
