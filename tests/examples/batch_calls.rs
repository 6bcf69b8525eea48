//! How fast a batch of one scene is stepped, several steps a call: the Rust side of
//! `python/benches/batch.py`, which measures the same from Python.
//!
//! `cargo run --release --example batch_calls -- SCENE WORLDS STEPS CALLS THREADS` prints the
//! median time of a call of STEPS steps \[s\].

use std::error::Error;
use std::time::Instant;

use hecs::World;
use rayon::ThreadPoolBuilder;
use tumble::{Batch, Trial};
use tumble_scene::Scene;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [scene, worlds, steps, calls, threads] = arguments.as_slice() else {
        return Err("SCENE WORLDS STEPS CALLS THREADS are needed".into());
    };
    let (scene, steps) = (Scene::open(scene)?, steps.parse()?);
    let worlds: usize = worlds.parse()?;
    let mut trials = Vec::with_capacity(worlds);
    for _ in 0..worlds {
        let mut world = World::new();
        scene.clone().spawn(&mut world)?;
        trials.push(Trial::new(scene.settings, world)?);
    }
    let mut batch: Batch = trials.into_iter().collect();
    let pool = ThreadPoolBuilder::new().num_threads(threads.parse()?).build()?;
    // What begins in the air comes to the ground first, as in Python.
    pool.install(|| batch.step_many(120));
    let mut times = Vec::new();
    for _ in 0..calls.parse::<u32>()?.max(1) {
        let begun = Instant::now();
        pool.install(|| batch.step_many(steps));
        times.push(begun.elapsed().as_secs_f64());
    }
    times.sort_by(f64::total_cmp);
    println!("{}", times[times.len() / 2]);
    Ok(())
}
