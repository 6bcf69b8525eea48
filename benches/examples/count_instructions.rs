//! Counts the instructions of a body-step and compares them with those on record: unlike times,
//! they are the same on a busy machine and on a quiet one.
//!
//! `cargo run --release -p tumble-benches --example count_instructions`, with `--features f64` for
//! double precision, runs boxes under each integrator, bodies that pull at each other, bodies that
//! touch, chains of joints and queries under valgrind, with each instruction set that valgrind
//! knows, and fails where a body-step, a joint's substep or a ray has over 3 % more instructions
//! than in `benches/instruction_counts.csv`. `-- --record`
//! writes what it finds there; that file says with which compiler, since another one makes other
//! code. A minute; not among the checks of every change.
//!
//! To see where instructions are:
//! `valgrind --tool=callgrind target/release/examples/count_instructions step moser-veselov 30`.

use std::fmt::Write;
use std::process::{Command, ExitCode};

use tumble::math::{PRECISION, Vec3};
use tumble::{Batch, Integrator, QueryFilter, Settings, Simulation, Trial, simd_name};
use tumble_benches::{
    HillBodies, HillGround, JointKind, attracting_points, chain, eight_boxes, falling_balls, hills, net_of_springs,
    pyramid, rays_through_boxes, scattered_boxes, tumbling_boxes,
};

/// Of free bodies: whole tiles, in whole chunks.
const BODIES: u32 = 4096;
/// Where bodies act on each other: a name, how many they are, and after how many steps counting
/// begins.
const COUPLED: [(&str, u32, u32); 13] = [
    ("springs", 1024, 5),
    ("attraction", 256, 5),
    ("pyramid", 204, 5),
    ("balls", 1000, 90),
    ("worlds", WORLDS * 8, 60),
    ("chain", JOINTS * SUBSTEPS, 5),
    ("hinges", JOINTS * SUBSTEPS, 5),
    ("hill-boxes", ON_HILLS, 60),
    ("hill-balls", ON_HILLS, 60),
    ("hill-capsules", ON_HILLS, 60),
    ("mesh-hills", ON_HILLS, 60),
    ("rays", RAYS, 1),
    ("unmoved", UNMOVED, 1),
];
/// Bodies on hills: of a height field, or all kinds on a mesh.
const ON_HILLS: u32 = 100;
/// Rays of a hundred metres among ten thousand boxes.
const RAYS: u32 = 256;
/// Bodies of which queries find out that none has moved.
const UNMOVED: u32 = 10_000;
/// In a chain.
const JOINTS: u32 = 100;
/// In a step: with joints, what is counted is per joint and substep.
const SUBSTEPS: u32 = 4;
/// Of eight boxes.
const WORLDS: u32 = 16;
/// Steps of free bodies before counting begins.
const SHORT: u32 = 5;
/// Steps that are counted: runs of two lengths, so that making the world is not.
const COUNTED: u32 = 10;
/// How many times the instructions on record a body-step may have.
const ALLOWED: f64 = 1.03;
/// What valgrind can run; it does not know AVX-512.
const PATHS: [&str; 3] = ["scalar", "baseline", "avx2"];
const RECORD: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/instruction_counts.csv");
const COLUMNS: &str = "precision,scene,path,instructions_per_body_step";

type Failure = Box<dyn std::error::Error + Send + Sync>;

fn main() -> Result<ExitCode, Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>().as_slice() {
        [] => compare(&measure()?),
        ["--record"] => record(&measure()?).map(|()| ExitCode::SUCCESS),
        ["step", scene, steps] => step(scene, steps.parse()?).map(|()| ExitCode::SUCCESS),
        _ => Err("takes nothing, --record, or step SCENE STEPS".into()),
    }
}

/// Steps a scene on this thread alone, and says with which vector code.
fn step(scene: &str, steps: u32) -> Result<(), Failure> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build()?;
    pool.install(|| match scene {
        "worlds" => step_worlds(steps),
        "rays" | "unmoved" => ask(scene == "rays", steps),
        _ => step_world(scene, steps),
    })?;
    println!("{}", simd_name());
    Ok(())
}

fn step_world(scene: &str, steps: u32) -> Result<(), Failure> {
    let settings = Settings::default();
    let count = COUPLED.iter().find(|(name, ..)| *name == scene).map_or(BODIES, |(_, count, _)| *count);
    let (mut world, settings) = match scene {
        "springs" => (net_of_springs(count.isqrt() as usize), settings),
        "attraction" => (attracting_points(count as usize), settings.with_gravity(Vec3::ZERO).with_dt(1e-3)),
        "pyramid" => (pyramid(8), settings),
        "balls" => (falling_balls(count as usize), settings),
        "hill-boxes" => (hills(count as usize, HillBodies::Boxes, HillGround::HeightField), settings),
        "hill-balls" => (hills(count as usize, HillBodies::Balls, HillGround::HeightField), settings),
        "hill-capsules" => (hills(count as usize, HillBodies::Capsules, HillGround::HeightField), settings),
        "mesh-hills" => (hills(count as usize, HillBodies::Mixed, HillGround::Mesh), settings),
        "chain" => (chain(JOINTS as usize, JointKind::Ball), settings.with_contact_substeps(SUBSTEPS)),
        "hinges" => (chain(JOINTS as usize, JointKind::Hinge), settings.with_contact_substeps(SUBSTEPS)),
        integrator => (tumbling_boxes(count as usize), settings.with_integrator(integrator.parse()?)),
    };
    let mut simulation = Simulation::new(settings)?;
    (0..steps).for_each(|_| simulation.step(&mut world));
    Ok(())
}

fn step_worlds(steps: u32) -> Result<(), Failure> {
    let made = |index: u32| Trial::new(Settings::default(), eight_boxes(index.into()));
    (0..WORLDS).map(made).collect::<Result<Batch, _>>()?.step_many(steps);
    Ok(())
}

/// Brings queries up to date, and casts rays in them or not.
fn ask(is_cast: bool, times: u32) -> Result<(), Failure> {
    let simulation = Simulation::new(Settings::default())?;
    let world = scattered_boxes(UNMOVED as usize);
    let rays = rays_through_boxes(RAYS as usize);
    let mut queries = simulation.queries(&world);
    for _ in 0..times {
        if is_cast {
            std::hint::black_box(queries.cast_rays(&rays, &QueryFilter::ALL));
        } else {
            queries = simulation.queries(&world);
        }
    }
    Ok(())
}

/// Instructions of a body-step.
struct Count {
    scene: &'static str,
    path: &'static str,
    instructions: f64,
}

impl Count {
    /// How a line of the record begins that has this count.
    fn key(&self) -> String {
        format!("{PRECISION},{},{}", self.scene, self.path)
    }
}

fn measure() -> Result<Vec<Count>, Failure> {
    let mut counts = Vec::new();
    let free = Integrator::ALL.map(|integrator| (integrator.name(), BODIES, SHORT));
    for (scene, bodies, short) in free.into_iter().chain(COUPLED) {
        for path in PATHS {
            let (Some(long), Some(short)) = (run(scene, path, short + COUNTED)?, run(scene, path, short)?) else {
                println!("{path} does not run here");
                continue;
            };
            counts.push(Count { scene, path, instructions: (long - short) / f64::from(COUNTED * bodies) });
        }
    }
    Ok(counts)
}

/// The instructions of a whole run; `None` where it ran with other vector code than asked for.
fn run(scene: &str, path: &str, steps: u32) -> Result<Option<f64>, Failure> {
    let output = Command::new("valgrind")
        .args(["--tool=cachegrind", "--cache-sim=no", "--cachegrind-out-file=/dev/null"])
        .arg(std::env::current_exe()?)
        .args(["step", scene, &steps.to_string()])
        .env("TUMBLE_SIMD", path)
        .output()
        .map_err(|error| format!("valgrind is needed: {error}"))?;
    let report = String::from_utf8_lossy(&output.stderr);
    if !output.status.success() {
        return Err(format!("valgrind failed:\n{report}").into());
    }
    if String::from_utf8_lossy(&output.stdout).trim() != path {
        return Ok(None);
    }
    // "==123== I   refs:      12,345,678"
    let refs = report.lines().find(|line| line.contains("refs:")).ok_or("valgrind reports no instructions")?;
    let digits: String = refs.rsplit(':').next().unwrap_or_default().chars().filter(char::is_ascii_digit).collect();
    Ok(Some(digits.parse()?))
}

/// What made the program and what counts.
fn versions() -> Result<String, Failure> {
    let version = |program: &str| -> Result<String, Failure> {
        let output = Command::new(program).arg("--version").output()?;
        Ok(String::from_utf8_lossy(&output.stdout).trim().to_owned())
    };
    Ok(format!("# {PRECISION}: {}, {}", version("rustc")?, version("valgrind")?))
}

/// Replaces what is on record of this precision.
fn record(counts: &[Count]) -> Result<(), Failure> {
    let old = std::fs::read_to_string(RECORD).unwrap_or_default();
    let others = |start: &str| {
        let of_this = [format!("# {PRECISION}:"), format!("{PRECISION},")];
        let kept = |line: &&str| line.starts_with(start) && !of_this.iter().any(|own| line.starts_with(own));
        old.lines().filter(kept).fold(String::new(), |all, line| all + line + "\n")
    };
    let mut new = format!("{}{}\n{COLUMNS}\n", others("# "), versions()?);
    for count in counts {
        writeln!(new, "{},{:.1}", count.key(), count.instructions)?;
    }
    new += &others("f");
    print!("{new}");
    Ok(std::fs::write(RECORD, new)?)
}

/// Fails where a count is on record and is exceeded, and where one is not on record.
fn compare(counts: &[Count]) -> Result<ExitCode, Failure> {
    let record = std::fs::read_to_string(RECORD).map_err(|error| format!("{RECORD}: {error}"))?;
    let versions = versions()?;
    if !record.lines().any(|line| line == versions) {
        println!("not what the record was made with, so that counts may differ for no fault of the code:\n{versions}");
    }
    let mut exceeded = 0;
    for count in counts {
        let key = count.key();
        let Some(recorded) = record.lines().find_map(|line| line.strip_prefix(&key)?.strip_prefix(',')) else {
            println!("{key}: {:.1}, not on record", count.instructions);
            exceeded += 1;
            continue;
        };
        let ratio = count.instructions / recorded.parse::<f64>()?;
        let verdict = if ratio > ALLOWED { "MORE" } else { "ok" };
        exceeded += usize::from(ratio > ALLOWED);
        println!("{key}: {:.1}, on record {recorded}: {:+.1} % {verdict}", count.instructions, 100.0 * (ratio - 1.0));
    }
    Ok(if exceeded == 0 && !counts.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
