//! The pile scenes that other engines' drivers run, step by step as they time them: `piles [pyramid|balls|worlds] [THREADS]` prints the milliseconds of a
//! step, and whether what should stand stands.

#![allow(clippy::unwrap_used, reason = "a program of its own")]

use std::time::Instant;

use hecs::World;
use rayon::ThreadPoolBuilder;
use tumble::{Batch, BodyId, Momentum, Pose, Settings, Simulation, Trial};
use tumble_benches::{eight_boxes, falling_balls, pyramid};

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let threads: usize = arguments.get(2).map_or(1, |n| n.parse().unwrap());
    let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| match arguments.get(1).map(String::as_str) {
        Some("balls") => balls(),
        Some("worlds") => worlds(),
        _ => boxes(),
    });
}

fn positions(world: &World) -> Vec<[f64; 3]> {
    let mut found: Vec<_> = world
        .query::<(&BodyId, &Pose, &Momentum)>()
        .iter()
        .map(|(id, pose, _)| (*id, pose.position.to_array().map(f64::from)))
        .collect();
    found.sort_by_key(|(id, _)| *id);
    found.into_iter().map(|(_, at)| at).collect()
}

fn boxes() {
    let mut world = pyramid(20);
    let start = positions(&world);
    let mut simulation = Simulation::new(Settings::default()).unwrap();
    let mut seconds = 0.0;
    for step in 0..300 {
        let begin = Instant::now();
        simulation.step(&mut world);
        if (60..240).contains(&step) {
            seconds += begin.elapsed().as_secs_f64();
        }
    }
    let end = positions(&world);
    let moved = start.iter().zip(&end).map(|(a, b)| {
        let d = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
        d.iter().map(|x| x * x).sum::<f64>().sqrt()
    });
    let drop = start[start.len() - 1][1] - end[end.len() - 1][1];
    let most = moved.fold(0.0, f64::max);
    println!("pyramid: {:.3} ms a step, top drop {drop:.4} m, most moved {most:.4} m", seconds / 180.0 * 1e3);
}

fn balls() {
    let mut world = falling_balls(5000);
    let mut simulation = Simulation::new(Settings::default()).unwrap();
    let begin = Instant::now();
    (0..300).for_each(|_| simulation.step(&mut world));
    let seconds = begin.elapsed().as_secs_f64();
    let end = positions(&world);
    let (mut deepest, mut wall, mut height): (f64, f64, f64) = (0.0, 0.0, 0.0);
    for (i, a) in end.iter().enumerate() {
        wall = wall.max(0.5 - a[1]).max(a[0].abs() - 9.5).max(a[2].abs() - 9.5);
        height += a[1] / end.len() as f64;
        for b in &end[i + 1..] {
            let d = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
            deepest = deepest.max(1.0 - d.iter().map(|x| x * x).sum::<f64>().sqrt());
        }
    }
    println!(
        "balls: {:.3} ms a step, deepest {deepest:.4} m, into walls {wall:.4} m, mean height {height:.3} m",
        seconds / 300.0 * 1e3
    );
}

fn worlds() {
    let worlds = 4096;
    let made = (0..worlds).map(|index| Trial::new(Settings::default(), eight_boxes(index)).unwrap());
    let mut batch: Batch = made.collect();
    let begin = Instant::now();
    batch.step_many(120);
    let seconds = begin.elapsed().as_secs_f64();
    let lowest = batch.map(|_, trial| positions(&trial.world).iter().map(|at| at[1]).fold(f64::MAX, f64::min));
    let lowest = lowest.into_iter().fold(f64::MAX, f64::min);
    let rate = (worlds * 8 * 120) as f64 / seconds;
    println!("worlds: {:.3} million body-steps a second, lowest centre {lowest:.4} m", rate * 1e-6);
}
