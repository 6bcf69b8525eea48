//! Bodies that touch, in the scenes that other engines were measured with: a pyramid of 2870 boxes
//! at rest, 5000 balls that fall into a box, and 4096 worlds in which eight boxes fall on the
//! ground; and without another engine boxes, balls and capsules on hills. On one thread and on two.
//!
//! `cargo bench --bench piles`, with `-- pyramid`, `balls`, `worlds` or `hills` for one of them, or
//! `growth` for what a body costs in a pyramid of 1015 boxes and in one of 29 370; `-- stands` has
//! the pyramid stand for 10 000 steps, and fails where it does not. With `--features peers` the
//! same scenes are run in Rapier in the same process, alternating every ten steps, with its default
//! of four solver iterations; with `peers-simd8` Rapier's solver has eight lanes. Printed are
//! milliseconds a step (of the pyramid the mean of steps 60 to 240, of the balls of all 300), how
//! many body-steps that is a second, and what became of the scene: how far the top sank and the box
//! that moved most went, how deep balls are in each other.
//!
//! Under `--features f64` tumble is in double precision and Rapier, a crate of single precision, is
//! not.

#[cfg(feature = "peers")]
mod rapier_world;
#[cfg(not(feature = "peers"))]
mod without_rapier;

#[cfg(feature = "peers")]
use rapier_world::Peer;
#[cfg(not(feature = "peers"))]
use without_rapier::Peer;

use std::ops::Range;
use std::time::{Duration, Instant};

use hecs::World;
use rayon::ThreadPool;
use tumble::math::PRECISION;
use tumble::{Batch, BodyId, Momentum, Pose, Settings, Simulation, Trial, simd_name};
use tumble_benches::{
    Arguments, HillBodies, HillGround, eight_boxes, falling_balls, hills, in_pools_of_one, pool as pool_of, pyramid,
};

type RunStatus<T> = Result<T, Box<dyn std::error::Error>>;

const PYRAMID: &str = "piles/pyramid";
const BALLS: &str = "piles/balls";
const WORLDS: &str = "piles/worlds";
const GROWTH: &str = "piles/growth";
/// Minutes, so only where it is asked for by its last word.
const STANDS: &str = "piles/stands";
const HILLS: &str = "piles/hills";
const SCENES: [&str; 6] = [PYRAMID, BALLS, WORLDS, HILLS, GROWTH, STANDS];

/// Steps of one engine before it is the other's turn.
const TURN: usize = 10;

fn main() -> RunStatus<()> {
    let arguments = Arguments::of_program();
    let asked = |name: &str| arguments.select(name);
    if arguments.is_list {
        arguments.print_list(&SCENES);
    }
    if arguments.is_list || !SCENES.into_iter().any(asked) {
        return Ok(());
    }
    // A test that it runs.
    let short = arguments.is_test;
    println!("tumble: {PRECISION}, {}\n", simd_name());
    for threads in [1, 2] {
        let pool = pool_of(threads);
        if asked(PYRAMID) {
            let (steps, measured) = if short { (2, 0..2) } else { (300, 60..240) };
            let made = || pyramid(if short { 4 } else { 20 });
            let pile = Pile { made: &made, steps, measured, outcome: &sunk };
            pile.run("pyramid", threads, &pool)?;
        }
        if asked(BALLS) {
            let steps = if short { 2 } else { 300 };
            let made = || falling_balls(if short { 400 } else { 5000 });
            Pile { made: &made, steps, measured: 0..steps, outcome: &overlap }.run("balls", threads, &pool)?;
        }
        if asked(WORLDS) {
            let (count, steps) = if short { (16, 2) } else { (4096, 120) };
            worlds(count, steps, threads, &pool)?;
        }
        if asked(HILLS) {
            on_hills(if short { 9 } else { 900 }, if short { 2 } else { 240 }, threads, &pool)?;
        }
        if arguments.name("stands") {
            stands(threads, &pool)?;
        }
        if asked(GROWTH) {
            growth(if short { [3, 4] } else { [14, 44] }, threads, &pool)?;
        }
    }
    Ok(())
}

/// Positions of the bodies that move, in order.
type Places = Vec<[f64; 3]>;

/// A scene in one world.
struct Pile<'a> {
    made: &'a dyn Fn() -> World,
    steps: usize,
    /// Which steps are timed.
    measured: Range<usize>,
    /// What became of it.
    outcome: &'a dyn Fn(&Places, &Places) -> String,
}

impl Pile<'_> {
    fn run(&self, name: &str, threads: usize, pool: &ThreadPool) -> RunStatus<()> {
        let mut world = (self.made)();
        let mut simulation = Simulation::new(Settings::default())?;
        let mut peer = Peer::new(&world, simulation.settings())?;
        let start = places(&world);
        let (mut ours, mut theirs) = (Duration::ZERO, Duration::ZERO);
        for turn in (0..self.steps).step_by(TURN) {
            let steps = turn..(turn + TURN).min(self.steps);
            ours += self.time(steps.clone(), || pool.install(|| simulation.step(&mut world)));
            if let Some(peer) = &mut peer {
                theirs += self.time(steps, || pool.install(|| peer.step()));
            }
        }
        let milliseconds = |time: Duration| time.as_secs_f64() * 1e3 / self.measured.len() as f64;
        let (ours, theirs) = (milliseconds(ours), milliseconds(theirs));
        let rate = start.len() as f64 * 1e-3 / ours;
        println!(
            "{name}, threads {threads}: tumble {ours:.2} ms a step, {rate:.2} million body-steps a second, {}",
            (self.outcome)(&start, &places(&world))
        );
        if let Some(peer) = &peer {
            let outcome = (self.outcome)(&start, &peer.places());
            println!(
                "{name}, threads {threads}: Rapier {theirs:.2} ms a step, {outcome}; {:.2} times ours",
                theirs / ours
            );
        }
        Ok(())
    }

    fn time(&self, steps: Range<usize>, mut step: impl FnMut()) -> Duration {
        let mut sum = Duration::ZERO;
        for number in steps {
            let start = Instant::now();
            step();
            if self.measured.contains(&number) {
                sum += start.elapsed();
            }
        }
        sum
    }
}

fn places(world: &World) -> Places {
    let mut bodies = world.query::<(&BodyId, &Pose, &Momentum)>();
    let mut found: Vec<_> = bodies.iter().map(|(id, pose, _)| (*id, pose.position.to_array().map(f64::from))).collect();
    found.sort_by_key(|(id, _)| *id);
    found.into_iter().map(|(_, place)| place).collect()
}

fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

/// How far the top sank, and the box that went furthest went.
fn settled(start: &Places, end: &Places) -> [f64; 2] {
    let most = start.iter().zip(end).map(|(a, b)| distance(a, b)).fold(0.0, f64::max);
    [start.last().zip(end.last()).map_or(0.0, |(a, b)| a[1] - b[1]), most]
}

fn sunk(start: &Places, end: &Places) -> String {
    let [sunk, most] = settled(start, end);
    format!("the top sank {sunk:.4} m, no box went further than {most:.4} m")
}

fn overlap(_: &Places, end: &Places) -> String {
    let (mut deepest, mut in_walls): (f64, f64) = (0.0, 0.0);
    for (i, a) in end.iter().enumerate() {
        in_walls = in_walls.max(0.5 - a[1]).max(a[0].abs() - 9.5).max(a[2].abs() - 9.5);
        deepest = end[i + 1..].iter().map(|b| 1.0 - distance(a, b)).fold(deepest, f64::max);
    }
    format!("balls are {deepest:.4} m deep in each other, {in_walls:.4} m in walls")
}

/// The pyramid over 10 000 steps, in which the top may sink by 15 mm and no box may go further than
/// 3 cm, as in the flat one of the tests.
fn stands(threads: usize, pool: &ThreadPool) -> RunStatus<()> {
    const STEPS: u32 = 10_000;
    let mut world = pyramid(20);
    let mut simulation = Simulation::new(Settings::default())?;
    let start = places(&world);
    pool.install(|| (0..STEPS).for_each(|_| simulation.step(&mut world)));
    let end = places(&world);
    println!("stands, threads {threads}: after {STEPS} steps {}", sunk(&start, &end));
    match settled(&start, &end) {
        [sunk, most] if sunk > 0.015 || most > 0.03 => {
            Err(format!("the top sank {sunk} m, a box went {most} m").into())
        }
        _ => Ok(()),
    }
}

/// What a body costs on hills of triangles, in the second half of the steps.
fn on_hills(count: usize, steps: u32, threads: usize, pool: &ThreadPool) -> RunStatus<()> {
    for (name, bodies, ground) in [
        ("boxes on a height field", HillBodies::Boxes, HillGround::HeightField),
        ("balls on a height field", HillBodies::Balls, HillGround::HeightField),
        ("capsules on a height field", HillBodies::Capsules, HillGround::HeightField),
        ("all kinds on a mesh", HillBodies::Mixed, HillGround::Mesh),
    ] {
        let mut world = hills(count, bodies, ground);
        let mut simulation = Simulation::new(Settings::default())?;
        pool.install(|| (0..steps / 2).for_each(|_| simulation.step(&mut world)));
        let start = Instant::now();
        pool.install(|| (0..steps / 2).for_each(|_| simulation.step(&mut world)));
        let each = start.elapsed().as_secs_f64() * 1e6 / (count as f64 * f64::from(steps / 2));
        let low = places(&world).iter().map(|place| place[1]).fold(f64::MAX, f64::min);
        println!(
            "hills, threads {threads}: {name}, {each:.2} us a body and step, the lowest centre is {low:.3} m high"
        );
    }
    Ok(())
}

/// What a body costs in a small pyramid and in a large one, interleaved.
fn growth(bases: [u32; 2], threads: usize, pool: &ThreadPool) -> RunStatus<()> {
    const STEPS: u32 = 30;
    let mut worlds = bases.map(pyramid);
    let mut simulations = [Simulation::new(Settings::default())?, Simulation::new(Settings::default())?];
    let bodies = bases.map(|base| base * (base + 1) * (2 * base + 1) / 6);
    let mut times = [Duration::ZERO; 2];
    // The first turn is there for the contacts to be made.
    for turn in 0..4 {
        for ((world, simulation), time) in worlds.iter_mut().zip(&mut simulations).zip(&mut times) {
            let start = Instant::now();
            pool.install(|| (0..STEPS).for_each(|_| simulation.step(world)));
            *time += if turn == 0 { Duration::ZERO } else { start.elapsed() };
        }
    }
    let [small, large] = [0, 1].map(|i| times[i].as_secs_f64() * 1e6 / (f64::from(bodies[i]) * f64::from(3 * STEPS)));
    let [few, many] = bodies;
    println!(
        "growth, threads {threads}: {small:.2} us a body and step of {few} boxes, {large:.2} of {many}; {:.2} times; \
         {:.2} and {:.2} million body-steps a second",
        large / small,
        1.0 / small,
        1.0 / large
    );
    Ok(())
}

/// Many small worlds.
fn worlds(count: u64, steps: u32, threads: usize, pool: &ThreadPool) -> RunStatus<()> {
    let made = |index: u64| Trial::new(Settings::default(), eight_boxes(index));
    let trials = (0..count).map(made).collect::<Result<Vec<_>, _>>()?;
    let peers = trials.iter().map(|trial| Peer::new(&trial.world, trial.simulation.settings()));
    let mut peers: Vec<Peer> = peers.collect::<RunStatus<Vec<_>>>()?.into_iter().flatten().collect();
    let mut batch: Batch = trials.into_iter().collect();
    let rate = |time: Duration| (count * 8) as f64 * f64::from(steps) * 1e-6 / time.as_secs_f64();

    let start = Instant::now();
    pool.install(|| batch.step_many(steps));
    let ours = rate(start.elapsed());
    let lowest = |places: Places| places.iter().map(|place| place[1]).fold(f64::MAX, f64::min);
    let low = batch.map(|_, trial| lowest(places(&trial.world))).into_iter().fold(f64::MAX, f64::min);
    println!(
        "worlds, threads {threads}: tumble {ours:.2} million body-steps a second, the lowest centre is {low:.3} m high"
    );
    if !peers.is_empty() {
        let start = Instant::now();
        in_pools_of_one(&mut peers, threads, |world| (0..steps).for_each(|_| world.step()));
        let theirs = rate(start.elapsed());
        println!("worlds, threads {threads}: Rapier {theirs:.2} million; ours is {:.2} times that", ours / theirs);
    }
    Ok(())
}
