//! What a thousand characters cost a step, beside the step itself.
//!
//! - `hills`: on a height field of 100 m with stairs of boxes, each walking on for a second and
//!   then another way;
//! - `standing`: on the same, where they have come to rest;
//! - `tiles`: walking on a floor of 10 000 boxes.
//!
//! `cargo bench --bench characters`; the throughput is in characters a second. The step of the
//! engine is not in the time, but the update of the index of queries is.

#![allow(clippy::unwrap_used, reason = "a bench without what it measures is to fail")]

mod setup;

use std::time::{Duration, Instant};

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use hecs::World;
use tumble::prelude::*;
use tumble::{Collider, Rng};
use tumble_benches::{OnDemand, label, pools};
use tumble_character::{Character, CharacterInput, CharacterSettings, move_characters};

const COUNT: u64 = 1000;
const SIDE: usize = 101;

fn spawn_hills(world: &mut World) {
    let height = |k: usize| 0.6 * (0.3 * (k % SIDE) as f64).sin() * (0.25 * (k / SIDE) as f64).cos();
    let heights: Vec<f64> = (0..SIDE * SIDE).map(height).collect();
    world.spawn((Pose::default(), Collider::height_field(heights, SIDE, [1.0, 1.0]).unwrap()));
    let mut rng = Rng::new(1);
    for _ in 0..100 {
        let place = Vec3::new(rng.range(-45.0, 45.0), -0.5, rng.range(-45.0, 45.0));
        for step in 0..8_u8 {
            let center = place + Vec3::new(0.3, 0.18, 0.0) * Real::from(step);
            let body = RigidBody::new(Shape::cuboid([0.15, 0.6, 1.0])).fixed().position(center);
            body.build().unwrap().spawn(world);
        }
    }
}

fn spawn_tiles(world: &mut World) {
    for i in 0..10_000_u16 {
        let (x, z) = (Real::from(i % 100), Real::from(i / 100));
        let body = RigidBody::new(Shape::cuboid([0.5, 0.5, 0.5])).fixed();
        body.position(Vec3::new(x - 50.0, -0.5, z - 50.0)).build().unwrap().spawn(world);
    }
}

fn spawn_crowd(world: &mut World) {
    let mut rng = Rng::new(2);
    let character = Character::new(CharacterSettings::of_height(1.8)).unwrap();
    for i in 0..COUNT {
        let place = Vec3::new(rng.range(-45.0, 45.0), 1.5, rng.range(-45.0, 45.0));
        let entity = world.spawn(character.at(place));
        world.insert_one(entity, BodyId(i)).unwrap();
    }
}

fn steer(world: &mut World, step: u64) {
    for (id, input) in world.query_mut::<(&BodyId, &mut CharacterInput)>() {
        let mut rng = Rng::stream(id.0, step / 60);
        input.velocity = Vec3::new(rng.range(-4.0, 4.0), 0.0, rng.range(-4.0, 4.0));
    }
}

/// The time of `move_characters` in some steps.
fn time_steps(world: &mut World, simulation: &mut Simulation, count: u64, walks: bool) -> Duration {
    let mut total = Duration::ZERO;
    for _ in 0..count {
        if walks {
            steer(world, simulation.steps());
        }
        let begin = Instant::now();
        move_characters(world, simulation);
        total += begin.elapsed();
        simulation.step(world);
    }
    total
}

/// Two seconds after it was put on the ground.
fn settled_crowd(spawn: fn(&mut World), walks: bool) -> (World, Simulation) {
    let mut world = World::new();
    spawn(&mut world);
    spawn_crowd(&mut world);
    let mut simulation = Simulation::new(Settings::default()).unwrap();
    time_steps(&mut world, &mut simulation, 120, walks);
    (world, simulation)
}

fn crowds(c: &mut Criterion) {
    let mut group = c.benchmark_group("characters");
    group.throughput(Throughput::Elements(COUNT));
    type Scene = (&'static str, fn(&mut World), bool);
    let scenes: [Scene; 3] =
        [("hills", spawn_hills, true), ("standing", spawn_hills, false), ("tiles", spawn_tiles, true)];
    for (name, spawn, walks) in scenes {
        for pool in pools() {
            let mut crowd = OnDemand::new(|| pool.install(|| settled_crowd(spawn, walks)));
            group.bench_function(BenchmarkId::new(name, label(&pool)), |b| {
                let (world, simulation) = crowd.get();
                b.iter_custom(|count| pool.install(|| time_steps(world, simulation, count, walks)));
            });
        }
    }
    group.finish();
}

criterion_group! { name = benches; config = setup::criterion(); targets = crowds }
criterion_main!(benches);
