//! What joints are worth beside their time, in tumble and in Rapier: how far they come apart, and
//! how much energy is lost, over ten seconds at 60 steps a second with four substeps.
//!
//! `cargo run --release -p tumble-benches --features peers --example joint_quality`, with the name
//! of a scene for that one alone. Tumble runs as it is, and with rigid joints in passes; Rapier
//! with its impulse joints and its default of four iterations, and with its multibody joints where
//! it can. An engine that has taken ten seconds for this is stopped; `simulated` says how far it
//! came.
//!
//! Then the engines alternate in blocks of steps, so that what else the machine does hits all, and
//! medians of three are printed. Both have one thread, and what is measured is its processor time,
//! which is not that of others; `-- threads` lets both take the threads that they want, and
//! measures the time that passes.
//!
//! `gap` is the largest distance between the two points that a joint holds together, `stretch` the
//! mean of these gaps over the length of a link, both at their worst step. `energy` is the change
//! over the run, of what is there above hanging straight down. Where that is not finite the other
//! two are of the time before.
//!
//! Under `--features f64` tumble is in double precision and Rapier, a crate of single precision, is
//! not.

#![cfg_attr(
    feature = "f64",
    allow(
        clippy::useless_conversion,
        reason = "Real is f64 in this build; the same line converts from f32 in the other"
    )
)]

use std::time::{Duration, Instant};

use hecs::{Entity, World};
use tumble::math::{PRECISION, Vec3, dvec3};
use tumble::{BodyOrder, Joint, JointSolver, Mass, Pose, Settings, Simulation, Totals, simd_name};
use tumble_benches::{JointKind, LINK, RapierJoints, RapierWorld, arm, bridge, chain, net, pendulums, pool, ragdolls};

type RunStatus<T> = Result<T, Box<dyn std::error::Error + Send + Sync>>;

const STEPS: u32 = 600;
/// How long an engine may take for these.
const PATIENCE: Duration = Duration::from_secs(10);
/// Blocks of steps of each engine that are timed, and how long they are at least: the system counts
/// processor time in pieces of some milliseconds.
const BLOCKS: usize = 3;
const BLOCK: Duration = Duration::from_millis(300);

/// A scene: how it is made, whether it only swings, so that its energy stays, and whether Rapier's
/// multibody joints can have it in this time, which is not so with loops or a thousand links.
struct Scene {
    name: &'static str,
    made: fn() -> World,
    swings: bool,
    has_multibody: bool,
}

const SCENES: [Scene; 10] = [
    Scene { name: "chain of 100 balls", made: || chain(100, JointKind::Ball), swings: true, has_multibody: true },
    Scene { name: "chain of 1000 balls", made: || chain(1_000, JointKind::Ball), swings: true, has_multibody: false },
    Scene { name: "chain of 10000 balls", made: || chain(10_000, JointKind::Ball), swings: true, has_multibody: false },
    Scene { name: "chain of 100 hinges", made: || chain(100, JointKind::Hinge), swings: true, has_multibody: true },
    Scene { name: "300 pendulums of 10 balls", made: || pendulums(300), swings: true, has_multibody: true },
    Scene {
        name: "bridge of 50 planks on balls",
        made: || bridge(50, JointKind::Ball),
        swings: false,
        has_multibody: false,
    },
    Scene {
        name: "bridge of 50 planks on hinges",
        made: || bridge(50, JointKind::Hinge),
        swings: false,
        has_multibody: false,
    },
    Scene { name: "net of 19800 balls", made: || net(100), swings: false, has_multibody: false },
    Scene { name: "heap of 160 ragdolls", made: || ragdolls(160), swings: false, has_multibody: false },
    Scene { name: "arm of 10 driven hinges", made: || arm(10), swings: false, has_multibody: true },
];

fn main() -> RunStatus<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let own_threads = arguments.iter().any(|argument| argument == "threads");
    let names: Vec<_> = arguments.iter().filter(|argument| *argument != "threads").collect();
    println!("tumble: {PRECISION}, {}; Rapier: f32\n", simd_name());
    println!("| scene | engine | a step \\[ms\\] | of ours | gap \\[mm\\] | stretch | energy | simulated |");
    println!("|---|---|---|---|---|---|---|---|");
    let alone = pool(1);
    for scene in SCENES.iter().filter(|scene| names.is_empty() || names.iter().any(|name| *name == scene.name)) {
        let start = Instant::now();
        if own_threads {
            scene.run(&|| start.elapsed())?;
        } else {
            alone.install(|| scene.run(&|| processor_time().unwrap_or_else(|| start.elapsed())))?;
        }
    }
    Ok(())
}

/// What this thread has had of a processor, where the system tells it.
fn processor_time() -> Option<Duration> {
    let statistics = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    statistics.split_whitespace().next()?.parse().ok().map(Duration::from_nanos)
}

/// Time since some moment.
type Clock<'a> = &'a dyn Fn() -> Duration;

/// An engine with a scene in it.
enum Engine {
    Tumble(Box<(World, Simulation)>),
    Rapier(Box<RapierWorld>),
}

impl Engine {
    fn step(&mut self) {
        match self {
            Self::Tumble(it) => it.1.step(&mut it.0),
            Self::Rapier(it) => it.step(),
        }
    }

    fn pose(&self, body: Entity) -> Option<Pose> {
        match self {
            Self::Tumble(it) => it.0.get::<&Pose>(body).ok().map(|pose| *pose),
            Self::Rapier(it) => it.pose(body),
        }
    }

    fn kinetic_energy(&self) -> f64 {
        match self {
            Self::Tumble(it) => {
                let totals = Totals::of(&it.0, it.1.settings(), &BodyOrder::of(&it.0));
                totals.linear_kinetic + totals.rotational_kinetic
            }
            Self::Rapier(it) => it.kinetic_energy(),
        }
    }
}

/// What an engine makes of a scene.
struct Run {
    name: &'static str,
    engine: Engine,
    steps: u32,
    largest_gap: f64,
    largest_mean: f64,
    energy_change: f64,
    /// Of a step in each block \[s\].
    times: Vec<f64>,
}

impl Run {
    fn new(name: &'static str, engine: Engine) -> Self {
        Self { name, engine, steps: 0, largest_gap: 0.0, largest_mean: 0.0, energy_change: 0.0, times: Vec::new() }
    }

    fn simulate(&mut self, start: &World, settings: &Settings, clock: Clock<'_>) {
        let mut taken = Duration::ZERO;
        while self.steps < STEPS && taken < PATIENCE {
            let begin = clock();
            self.engine.step();
            taken += clock() - begin;
            self.steps += 1;
            let mut query = start.query::<&Joint>();
            let gaps: Vec<f64> = query.iter().filter_map(|joint| self.gap(joint)).collect();
            let mean = gaps.iter().sum::<f64>() / gaps.len() as f64;
            self.largest_gap = gaps.into_iter().fold(self.largest_gap, f64::max);
            self.largest_mean = self.largest_mean.max(mean);
        }
        self.energy_change = self.energy_change(start, settings);
    }

    fn time_block(&mut self, clock: Clock<'_>) {
        let (begin, mut steps) = (clock(), 0);
        while clock() - begin < BLOCK {
            // Reading the clock takes longer than a step of a small scene may.
            (0..4).for_each(|_| self.engine.step());
            steps += 4;
        }
        self.times.push((clock() - begin).as_secs_f64() / f64::from(steps));
    }

    /// How far apart the points are that a joint holds together \[m\].
    fn gap(&self, joint: &Joint) -> Option<f64> {
        let [a, b] = joint.bodies.map(|body| self.engine.pose(body));
        let [first, second] = &joint.frames;
        // In double precision, so that a kilometre from the origin rounding is that of the state.
        let at = |pose: Pose, arm: Vec3| dvec3(pose.position) + dvec3(pose.orientation * arm);
        Some((at(b?, second.position) - at(a?, first.position)).length())
    }

    /// A step \[s\].
    fn median(&self) -> f64 {
        let mut times = self.times.clone();
        times.sort_by(f64::total_cmp);
        times[times.len() / 2]
    }

    /// By how much the energy has changed since all was at rest where a world has it \[J\].
    fn energy_change(&self, start: &World, settings: &Settings) -> f64 {
        let gravity = dvec3(settings.gravity);
        let mut query = start.query::<(Entity, &Mass, &Pose)>();
        let potential = query.iter().filter_map(|(body, mass, before)| {
            let moved = dvec3(self.engine.pose(body)?.position) - dvec3(before.position);
            Some(-f64::from(mass.kilograms()) * gravity.dot(moved))
        });
        self.engine.kinetic_energy() + potential.sum::<f64>()
    }
}

/// The potential energy above that of hanging straight down from where x and y are zero \[J\].
fn energy_to_fall(start: &World, settings: &Settings) -> f64 {
    let of_body = |(mass, pose): (&Mass, &Pose)| {
        let place = dvec3(pose.position);
        f64::from(mass.kilograms() * settings.gravity.length()) * (place.truncate().length() + place.y)
    };
    start.query::<(&Mass, &Pose)>().iter().map(of_body).sum()
}

impl Scene {
    fn run(&self, clock: Clock<'_>) -> RunStatus<()> {
        let start = (self.made)();
        let settings = Settings::default();
        let mut runs = Vec::new();
        for (name, solver) in [("tumble", JointSolver::Auto), ("tumble, passes", JointSolver::Passes)] {
            let simulation = Simulation::new(settings.with_joint_solver(solver))?;
            runs.push(Run::new(name, Engine::Tumble(Box::new(((self.made)(), simulation)))));
        }
        for (name, joints) in [("Rapier", RapierJoints::Impulse), ("Rapier multibody", RapierJoints::Multibody)] {
            if !self.has_multibody && joints == RapierJoints::Multibody {
                continue;
            }
            if let Some(peer) = RapierWorld::new(&start, &settings, joints) {
                runs.push(Run::new(name, Engine::Rapier(Box::new(peer))));
            }
        }
        runs.iter_mut().for_each(|run| run.simulate(&start, &settings, clock));
        for _ in 0..BLOCKS {
            runs.iter_mut().for_each(|run| run.time_block(clock));
        }
        let whole = energy_to_fall(&start, &settings);
        let ours = runs[0].median();
        for run in &runs {
            let lost = 100.0 * run.energy_change / whole;
            let energy = match lost.abs() {
                _ if !self.swings => "-".to_owned(),
                some if !some.is_finite() => "not finite".to_owned(),
                some if some < 1e3 => format!("{lost:+.2} %"),
                _ => format!("{lost:+.0e} %"),
            };
            let (scene, time, gap) = (self.name, run.median(), run.largest_gap * 1e3);
            let stretch = run.largest_mean / f64::from(LINK);
            let seconds = f64::from(run.steps) / 60.0;
            println!(
                "| {scene} | {} | {:.3} | {:.2} | {gap:.4} | {stretch:.2e} | {energy} | {seconds:.1} s |",
                run.name,
                time * 1e3,
                time / ours,
            );
        }
        Ok(())
    }
}
