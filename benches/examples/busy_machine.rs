//! How long frames take while other programs keep every core busy: steps from the main thread, with
//! the pool that rayon has by default, beside as many busy loops as there are cores.
//!
//! `cargo run --release -p tumble-benches --example busy_machine`; `-- 0` for none beside it.
//! Prints the median of the steps, the one in a hundred and the longest in milliseconds, and, on
//! Linux, how often in a step the thread that calls it waited for another.

use std::error::Error;
use std::hint::black_box;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Instant;

use hecs::World;
use tumble::Rng;
use tumble::math::Vec3;
use tumble::prelude::*;

const STEPS: usize = 600;

/// Cylinders, cones and hulls that fall on a heap.
fn heap(count: u32) -> Result<World, Box<dyn Error>> {
    let mut world = World::new();
    RigidBody::new(Shape::Point).fixed().build()?.spawn_with(&mut world, (Collider::half_space(),));
    let mut rng = Rng::new(1);
    for i in 0..count {
        let shape = match i % 3 {
            0 => Shape::cylinder(0.2, 0.2),
            1 => Shape::cone(0.2, 0.2),
            _ => Shape::ellipsoid([0.2, 0.15, 0.1]),
        };
        let collider = Collider::new(&shape)?;
        let place = rng.vector(-0.6, 0.6) + Vec3::Y * (1.0 + 0.05 * i as Real);
        RigidBody::new(shape).mass(1.0).position(place).build()?.spawn_with(&mut world, (collider,));
    }
    Ok(world)
}

/// Bodies that attract each other.
fn cluster(count: u32) -> Result<World, Box<dyn Error>> {
    let (mut world, mut rng) = (World::new(), Rng::new(2));
    for _ in 0..count {
        let body = RigidBody::new(Shape::sphere(0.1)).mass(1.0).position(rng.vector(-50.0, 50.0));
        body.build()?.spawn_with(&mut world, (GravityMass::of_kilograms(1e9),));
    }
    Ok(world)
}

/// How often this thread has waited since it began, where the system tells.
fn waits() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/thread-self/status").ok()?;
    status.lines().find_map(|line| line.strip_prefix("voluntary_ctxt_switches:")?.trim().parse().ok())
}

fn main() -> Result<(), Box<dyn Error>> {
    let cores = thread::available_parallelism()?.get();
    let beside = std::env::args().nth(1).map_or(Ok(cores), |count| count.parse())?;
    let stop = Arc::new(AtomicBool::new(false));
    let loops: Vec<_> = (0..beside)
        .map(|_| {
            let stop = stop.clone();
            thread::spawn(move || {
                while !stop.load(Ordering::Relaxed) {
                    black_box((0..1000).fold(0_u64, |sum, i| sum ^ black_box(i)));
                }
            })
        })
        .collect();
    println!(
        "{beside} busy loops beside it; of {STEPS} steps the median, the 99th of 100 and the longest [ms], and waits a step"
    );
    let scenes = [
        ("heap of 40", heap(40)?),
        ("40 that attract", cluster(40)?),
        ("pyramid of 55", tumble_benches::pyramid(5)),
        ("heap of 400", heap(400)?),
        ("pyramid of 2870", tumble_benches::pyramid(20)),
    ];
    for (name, mut world) in scenes {
        let mut simulation = Simulation::new(Settings::default())?;
        let before = waits();
        let mut times: Vec<f64> = (0..STEPS)
            .map(|_| {
                let begun = Instant::now();
                simulation.step(&mut world);
                begun.elapsed().as_secs_f64() * 1e3
            })
            .collect();
        let waits = waits().zip(before).map_or(f64::NAN, |(now, before)| (now - before) / STEPS as f64);
        times.sort_by(f64::total_cmp);
        let [median, late, longest] = [times[STEPS / 2], times[STEPS * 99 / 100], times[STEPS - 1]];
        println!("{name:16} {median:8.3} {late:8.3} {longest:8.3} {waits:8.2}");
    }
    stop.store(true, Ordering::Relaxed);
    loops.into_iter().for_each(|it| drop(it.join()));
    Ok(())
}
