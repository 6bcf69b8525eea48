//! Counts the instructions of a body-step and compares them with those on record: unlike times,
//! they are the same on a busy machine and on a quiet one.
//!
//! `cargo run --release --example count_instructions`, with `--features tumble-benches/f64` for
//! double precision, runs boxes under each integrator, one body alone, bodies with a ledger, bodies
//! that pull at each other, bodies that touch each other and hills, chains of joints, ragdolls and
//! queries under valgrind, with each instruction set that valgrind knows, and fails where a
//! body-step, a joint's substep or a ray has over 3 % more instructions than in
//! `benches/instruction_counts.csv`. `-- scalar avx2` is for these instruction sets alone, as
//! `.ci/run` has it. `-- --record` writes what it finds there; that file says with which compiler,
//! since another one makes other code, and `.ci/run` then compares nothing.
//!
//! `-- --serial` says which part of a step's instructions threads do not share, and how many times
//! a step they meet (`serial.rs`).
//!
//! To see where instructions are:
//! `valgrind --tool=callgrind target/release/examples/count_instructions step moser-veselov 30`.

mod scenes;
mod serial;

use std::fmt::Write;
use std::process::{Command, ExitCode};

use rayon::prelude::*;
use tumble::Integrator;
use tumble::math::PRECISION;

use crate::scenes::{BODIES, COUPLED, SHORT};

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
        ["--record"] => record(&measure(&PATHS)?).map(|()| ExitCode::SUCCESS),
        ["--serial"] => serial::print().map(|()| ExitCode::SUCCESS),
        ["step", scene, steps] => scenes::step(scene, steps.parse()?, 1).map(|()| ExitCode::SUCCESS),
        ["step", scene, steps, threads] => {
            scenes::step(scene, steps.parse()?, threads.parse()?).map(|()| ExitCode::SUCCESS)
        }
        [] => compare(&measure(&PATHS)?),
        paths if paths.iter().all(|path| PATHS.contains(path)) => compare(&measure(paths)?),
        _ => Err("takes instruction sets, --record, --serial, or step SCENE STEPS [THREADS]".into()),
    }
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

/// Of all scenes, as many at a time as there are processors.
fn measure(paths: &[&str]) -> Result<Vec<Count>, Failure> {
    let free = Integrator::ALL.map(|integrator| (integrator.name(), BODIES, SHORT));
    let scenes: Vec<_> = free.into_iter().chain(COUPLED).collect();
    let paths: Vec<_> = PATHS.into_iter().filter(|path| paths.contains(path)).collect();
    let runs: Vec<_> = scenes.iter().flat_map(|scene| paths.iter().map(move |path| (*scene, *path))).collect();
    let count = |((scene, bodies, short), path)| -> Result<Option<Count>, Failure> {
        let (Some(long), Some(short)) = (run(scene, path, short + COUNTED)?, run(scene, path, short)?) else {
            println!("{path} does not run here");
            return Ok(None);
        };
        Ok(Some(Count { scene, path, instructions: (long - short) / f64::from(COUNTED * bodies) }))
    };
    let counts: Result<Vec<_>, _> = runs.into_par_iter().with_max_len(1).map(count).collect();
    Ok(counts?.into_iter().flatten().collect())
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
