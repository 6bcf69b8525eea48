//! Which part of a step's instructions threads do not share, and how many times a step they meet.
//!
//! Threads share what is below rayon's `join_context`. Callgrind's record of calls says how many
//! instructions of a step are not, and how many times the thread that steps divides work: that is
//! found with two threads, since what is divided depends on how many there are, and compared with
//! what a step of one thread takes.

use std::process::Command;

use crate::Failure;

/// Of the scenes of `scenes.rs`, those that a step of is worth sharing, with steps before counting.
const SCENES: [(&str, u32); 3] = [("large-pyramid", 5), ("pyramid", 5), ("balls", 90)];
const COUNTED: u32 = 5;

/// What callgrind found of the thread that steps, in a whole run.
#[derive(Clone, Copy, Default)]
struct Found {
    /// Instructions in steps.
    steps: f64,
    /// Of these, those in which work is divided.
    divided: f64,
    /// How many times work was divided that was not a part of other such work.
    meetings: f64,
}

/// Prints a line for each scene.
pub(crate) fn print() -> Result<(), Failure> {
    println!("| scene | instructions a step, AVX2 | not shared | meetings a step |\n|---|---|---|---|");
    for (scene, short) in SCENES {
        let of_step = |threads| -> Result<Found, Failure> {
            let (short, long) = (run(scene, short, threads)?, run(scene, short + COUNTED, threads)?);
            let mean = |of: fn(&Found) -> f64| (of(&long) - of(&short)) / f64::from(COUNTED);
            Ok(Found { steps: mean(|it| it.steps), divided: mean(|it| it.divided), meetings: mean(|it| it.meetings) })
        };
        let (alone, two) = (of_step(1)?, of_step(2)?);
        let (all, serial) = (alone.steps, two.steps - two.divided);
        println!("| {scene} | {all:.0} | {:.1} % | {:.1} |", 100.0 * serial / all, two.meetings);
    }
    Ok(())
}

fn run(scene: &str, steps: u32, threads: u32) -> Result<Found, Failure> {
    let record = std::env::temp_dir().join(format!("tumble-calls-{}-{steps}-{threads}", std::process::id()));
    let output = Command::new("valgrind")
        .args([
            "--tool=callgrind",
            "--compress-strings=no",
            "--compress-pos=no",
            "--separate-recs=2",
            "--separate-threads=yes",
        ])
        .arg(format!("--callgrind-out-file={}", record.display()))
        .arg(std::env::current_exe()?)
        .args(["step", scene, &steps.to_string(), &threads.to_string()])
        .env("TUMBLE_SIMD", "avx2")
        .output()
        .map_err(|error| format!("valgrind is needed: {error}"))?;
    if !output.status.success() {
        return Err(format!("valgrind failed:\n{}", String::from_utf8_lossy(&output.stderr)).into());
    }
    // A file for each thread, of which the first is the one that steps.
    let file = |thread: u32| format!("{}-{thread:02}", record.display());
    let text = std::fs::read_to_string(file(1))?;
    (1..=threads).try_for_each(|thread| std::fs::remove_file(file(thread)))?;
    read(&text)
}

/// Whether a call divides work that is not a part of other work: callgrind marks the names of
/// functions that are called from within themselves.
fn is_meeting(caller: &str, callee: &str) -> bool {
    let is_outermost = |name: &str| !name.ends_with("'2");
    let of_rayon = |name: &str| ["join_context", "StackJob"].iter().any(|part| name.contains(part));
    callee.contains("join_context") && [caller, callee].into_iter().all(is_outermost) && !of_rayon(caller)
}

fn read(text: &str) -> Result<Found, Failure> {
    let mut found = Found::default();
    let (mut caller, mut callee, mut calls) = ("", "", None);
    for line in text.lines() {
        if let Some(name) = line.strip_prefix("fn=") {
            caller = name;
        } else if let Some(name) = line.strip_prefix("cfn=") {
            callee = name;
        } else if let Some(call) = line.strip_prefix("calls=") {
            calls = call.split(' ').next().and_then(|number| number.parse::<f64>().ok());
        } else if let Some(times) = calls.take() {
            // The position of the call and what it cost.
            let cost: f64 = line.rsplit(' ').next().unwrap_or_default().parse()?;
            if callee.ends_with("Simulation::step") {
                found.steps += cost;
            }
            if is_meeting(caller, callee) {
                found.divided += cost;
                found.meetings += times;
            }
        }
    }
    Ok(found)
}
