//! `tumble compare`: the same scenes here and in Rapier, on this machine, in one run.

mod rapier_world;

use std::time::Instant;

use hecs::World;
use rayon::ThreadPool;
use tumble::math::{PRECISION, dvec3};
use tumble::{Batch, Momentum, Pose, Simulation, Trial, simd_name};
use tumble_scene::Scene;

use crate::compare::rapier_world::RapierWorld;
use crate::failure::Failure;
use crate::options::CompareOptions;
use crate::{interrupt, print, run};

/// Blocks of each engine, of which the median counts.
const ROUNDS: usize = 9;
/// What a block of the slower engine takes about \[s\].
const BLOCK: f64 = 0.1;
/// Steps of a block at most.
const MAX_STEPS: u32 = 60;
/// Free bodies, boxes at rest, falling balls, and many worlds of eight balls.
const SCENES: [&str; 4] = ["stress", "pyramid", "spheres", WORLDS];
const WORLDS: &str = "worlds";
const WORLDS_OF: (&str, u64) = ("spheres", 8);
const WORLD_COUNT: usize = 512;

/// A row of the table.
struct Row {
    name: String,
    bodies: usize,
    /// Medians of a step \[s\], ours first.
    seconds: [f64; 2],
    /// Mean heights of the bodies that move, in the end \[m\].
    heights: [f64; 2],
}

/// Steps scenes in both engines and prints what a step takes.
pub(crate) fn compare(options: &CompareOptions) -> Result<(), Failure> {
    interrupt::watch()?;
    let scenes: Vec<&str> = match options.scenes.as_slice() {
        [] => SCENES.to_vec(),
        named => named.iter().map(String::as_str).collect(),
    };
    let pool = run::pool_of(options.threads)?;
    let threads = pool.current_num_threads();
    print::output(&format!(
        "{}, {threads} {}\ntumble {} in {PRECISION} with {}; Rapier 0.36 in f32, parallel, eight lanes, no sleep\n\n\
         {:<14} {:>7} {:>12} {:>12} {:>9} {:>22}\n{:<14} {:>7} {:>12} {:>12} {:>9} {:>22}\n",
        machine(),
        if threads == 1 { "thread" } else { "threads" },
        env!("CARGO_PKG_VERSION"),
        simd_name(),
        "scene",
        "bodies",
        "tumble",
        "Rapier",
        "Rapier /",
        "mean heights",
        "",
        "",
        "[ms/step]",
        "[ms/step]",
        "tumble",
        "in the end [m]",
    ))?;
    for name in scenes {
        let row = if name == WORLDS { worlds(&pool) } else { one_world(name, &pool) }?;
        print::output(&row.to_line())?;
    }
    print::output(&format!(
        "\nMedians of {ROUNDS} blocks of steps, the two engines one after the other. What runs beside them counts for both.\n"
    ))
}

impl Row {
    fn to_line(&self) -> String {
        let [ours, theirs] = self.seconds.map(|seconds| 1e3 * seconds);
        let heights = self.heights.map(|height| format!("{height:.2}")).join(", ");
        let (name, bodies, ratio) = (&self.name, self.bodies, theirs / ours);
        format!("{name:<14} {bodies:>7} {ours:>12.4} {theirs:>12.4} {ratio:>9.1} {heights:>22}\n")
    }
}

/// One world of a scene.
fn one_world(name: &str, pool: &ThreadPool) -> Result<Row, Failure> {
    let (mut world, mut simulation, mut theirs) = both(name, None)?;
    let bodies = world.query::<&Momentum>().iter().count();
    let seconds = contest(
        |steps| pool.install(|| simulation.step_many(&mut world, steps)),
        |steps| pool.install(|| (0..steps).for_each(|_| theirs.step())),
    )?;
    let heights = [mean_height(&world), theirs.mean_height()];
    Ok(Row { name: name.to_owned(), bodies, seconds, heights })
}

/// Many small worlds at once: a batch here, and Rapier's worlds each on one thread.
fn worlds(pool: &ThreadPool) -> Result<Row, Failure> {
    let (name, bodies) = WORLDS_OF;
    let (mut trials, mut theirs) = (Vec::new(), Vec::new());
    for _ in 0..WORLD_COUNT {
        let (world, simulation, rapier) = both(name, Some(bodies))?;
        let trial = Trial::new(*simulation.settings(), world).map_err(|error| Failure::Input(error.to_string()))?;
        trials.push(trial);
        theirs.push(rapier);
    }
    let mut batch: Batch = trials.into_iter().collect();
    let alone = (0..pool.current_num_threads()).map(|_| run::pool_of(Some(1))).collect::<Result<Vec<_>, _>>()?;
    let seconds = contest(
        |steps| pool.install(|| batch.step_many(steps)),
        |steps| in_parts(&mut theirs, &alone, |world| (0..steps).for_each(|_| world.step())),
    )?;
    let heights = [
        mean(batch.trials().iter().map(|trial| mean_height(&trial.world))),
        mean(theirs.iter().map(RapierWorld::mean_height)),
    ];
    Ok(Row { name: format!("{WORLD_COUNT} x {name}"), bodies: WORLD_COUNT * bodies as usize, seconds, heights })
}

/// A scene in both engines.
fn both(name: &str, bodies: Option<u64>) -> Result<(World, Simulation, RapierWorld), Failure> {
    let scene = Scene::open_with(name, bodies, None)?;
    let simulation = Simulation::new(scene.settings).map_err(|error| Failure::Input(error.to_string()))?;
    let (appearance, mut world) = (scene.appearance()?, World::new());
    scene.spawn(&mut world)?;
    let theirs = RapierWorld::of(&world, &appearance, simulation.settings());
    let theirs = theirs.map_err(|error| Failure::Input(format!("{name}: {error}")))?;
    Ok((world, simulation, theirs))
}

/// The medians of what a step takes over the same steps \[s\], ours first.
fn contest(mut ours: impl FnMut(u32), mut theirs: impl FnMut(u32)) -> Result<[f64; 2], Failure> {
    // Caches of both are warm after the first steps, which also tell how long a block is to be.
    let first = [timed(4, &mut ours), timed(4, &mut theirs)];
    let steps = (BLOCK / first[0].max(first[1]).max(1e-9)).clamp(1.0, f64::from(MAX_STEPS)) as u32;
    let mut times = [Vec::new(), Vec::new()];
    for _ in 0..ROUNDS {
        if interrupt::asked() {
            return Err(Failure::Interrupted);
        }
        times[0].push(timed(steps, &mut ours));
        times[1].push(timed(steps, &mut theirs));
    }
    Ok(times.map(median))
}

/// What a step takes over a block \[s\].
fn timed(steps: u32, step: &mut impl FnMut(u32)) -> f64 {
    let begin = Instant::now();
    step(steps);
    begin.elapsed().as_secs_f64() / f64::from(steps)
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times.get(times.len() / 2).copied().unwrap_or(f64::NAN)
}

fn mean_height(world: &World) -> f64 {
    let mut bodies = world.query::<&Pose>().with::<&Momentum>();
    mean(bodies.iter().map(|pose| dvec3(pose.position).y))
}

/// Zero of nothing.
fn mean(numbers: impl Iterator<Item = f64>) -> f64 {
    let (count, sum) = numbers.fold((0_u32, 0.0), |(count, sum), number| (count + 1, sum + number));
    sum / f64::from(count.max(1))
}

/// Gives each pool a part of the worlds: steps of Rapier that wait for each other in one pool of
/// several threads wait for ever.
fn in_parts(worlds: &mut [RapierWorld], pools: &[ThreadPool], work: impl Fn(&mut RapierWorld) + Sync) {
    let part = worlds.len().div_ceil(pools.len().max(1)).max(1);
    let work = &work;
    std::thread::scope(|scope| {
        for (worlds, pool) in worlds.chunks_mut(part).zip(pools) {
            scope.spawn(move || pool.install(|| worlds.iter_mut().for_each(work)));
        }
    });
}

/// What the machine says that it is.
fn machine() -> String {
    let listed = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let named = listed.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':'));
    let named = named.map(|(_, name)| name.trim().to_owned());
    let windows = || std::env::var("PROCESSOR_IDENTIFIER").ok();
    let other = || format!("{} {}", std::env::consts::OS, std::env::consts::ARCH);
    named.or_else(windows).unwrap_or_else(other)
}
