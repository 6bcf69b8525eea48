//! Counts the instructions of a body-step and compares them with those on record: unlike times, they are the same on a busy machine and on
//! a quiet one.
//!
//! `cargo run --release -p tumble-benches --example count_instructions`, with `--features f64` for double precision, runs each
//! integrator under valgrind with each instruction set that valgrind knows, and fails where a body-step has over 3 % more instructions than in
//! `benches/instruction_counts.csv`. `-- --record` writes what it finds there; that file says with which compiler, since another one
//! makes other code. Half a minute; not among the checks of every change.
//!
//! To see where instructions are: `valgrind --tool=callgrind target/release/examples/count_instructions step moser-veselov 30`.

use std::fmt::Write;
use std::process::{Command, ExitCode};

use tumble::math::PRECISION;
use tumble::{Integrator, Settings, Simulation, simd_name};
use tumble_benches::tumbling_boxes;

/// Whole tiles, in whole chunks.
const BODIES: u32 = 4096;
/// Runs of two lengths, so that making the world is not counted.
const SHORT: u32 = 5;
const LONG: u32 = 15;
/// How many times the instructions on record a body-step may have.
const ALLOWED: f64 = 1.03;
/// What valgrind can run; it does not know AVX-512.
const PATHS: [&str; 3] = ["scalar", "baseline", "avx2"];
const RECORD: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/instruction_counts.csv");
const COLUMNS: &str = "precision,integrator,path,instructions_per_body_step";

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<ExitCode, Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>().as_slice() {
        [] => compare(&measure()?),
        ["--record"] => record(&measure()?).map(|()| ExitCode::SUCCESS),
        ["step", integrator, steps] => step(integrator.parse()?, steps.parse()?).map(|()| ExitCode::SUCCESS),
        _ => Err("takes nothing, --record, or step INTEGRATOR STEPS".into()),
    }
}

/// Steps boxes on this thread alone, and says with which vector code.
fn step(integrator: Integrator, steps: u32) -> Result<(), Failure> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build()?;
    let mut world = tumbling_boxes(BODIES as usize);
    let mut simulation = Simulation::new(Settings::default().with_integrator(integrator))?;
    pool.install(|| (0..steps).for_each(|_| simulation.step(&mut world)));
    println!("{}", simd_name());
    Ok(())
}

/// Instructions of a body-step.
struct Count {
    integrator: &'static str,
    path: &'static str,
    instructions: f64,
}

impl Count {
    /// How a line of the record begins that has this count.
    fn key(&self) -> String {
        format!("{PRECISION},{},{}", self.integrator, self.path)
    }
}

fn measure() -> Result<Vec<Count>, Failure> {
    let mut counts = Vec::new();
    for integrator in Integrator::ALL.map(Integrator::name) {
        for path in PATHS {
            let (Some(long), Some(short)) = (run(integrator, path, LONG)?, run(integrator, path, SHORT)?) else {
                println!("{path} does not run here");
                continue;
            };
            let instructions = (long - short) / f64::from((LONG - SHORT) * BODIES);
            counts.push(Count { integrator, path, instructions });
        }
    }
    Ok(counts)
}

/// The instructions of a whole run; `None` where it ran with other vector code than asked for.
fn run(integrator: &str, path: &str, steps: u32) -> Result<Option<f64>, Failure> {
    let output = Command::new("valgrind")
        .args(["--tool=cachegrind", "--cache-sim=no", "--cachegrind-out-file=/dev/null"])
        .arg(std::env::current_exe()?)
        .args(["step", integrator, &steps.to_string()])
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
            println!("{key} is not on record");
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
