//! Which part of a step's instructions threads do not share, and how many times a step they meet.
//!
//! A part of a step that threads share is entered through rayon's `bridge_producer_consumer` or
//! `join_context`; callgrind's record of calls says how many instructions are below them and how
//! many times they divided their work. A step of one thread has the share, one of two threads the
//! meetings, since what is divided depends on the threads that there are.

use std::process::Command;

use crate::Failure;

/// Of the scenes of `scenes.rs`, those that a step of is worth sharing, with steps before counting.
const SCENES: [(&str, u32); 3] = [("large-pyramid", 5), ("pyramid", 5), ("balls", 90)];
const COUNTED: u32 = 5;

/// What callgrind found in a whole run.
#[derive(Clone, Copy, Default)]
struct Found {
    instructions: f64,
    /// Below rayon's functions.
    shared: f64,
    /// How many times work was divided among threads that was not a part of other such work.
    meetings: f64,
}

/// Prints a line for each scene.
pub(crate) fn print() -> Result<(), Failure> {
    println!("| scene | instructions a step, AVX2 | not shared | meetings a step |\n|---|---|---|---|");
    for (scene, short) in SCENES {
        let of_steps = |threads| -> Result<[f64; 3], Failure> {
            let (short, long) = (run(scene, short, threads)?, run(scene, short + COUNTED, threads)?);
            let [a, b] = [short, long].map(|it| [it.instructions, it.shared, it.meetings]);
            Ok(std::array::from_fn(|i| (b[i] - a[i]) / f64::from(COUNTED)))
        };
        let ([all, shared, _], [.., meetings]) = (of_steps(1)?, of_steps(2)?);
        println!("| {scene} | {all:.0} | {:.1} % | {meetings:.1} |", 100.0 * (1.0 - shared / all));
    }
    Ok(())
}

fn run(scene: &str, steps: u32, threads: u32) -> Result<Found, Failure> {
    let record = std::env::temp_dir().join(format!("tumble-calls-{}-{steps}-{threads}", std::process::id()));
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--compress-strings=no", "--compress-pos=no", "--separate-recs=2"])
        .arg(format!("--callgrind-out-file={}", record.display()))
        .arg(std::env::current_exe()?)
        .args(["step", scene, &steps.to_string(), &threads.to_string()])
        .env("TUMBLE_SIMD", "avx2")
        .output()
        .map_err(|error| format!("valgrind is needed: {error}"))?;
    if !output.status.success() {
        return Err(format!("valgrind failed:\n{}", String::from_utf8_lossy(&output.stderr)).into());
    }
    let text = std::fs::read_to_string(&record)?;
    std::fs::remove_file(&record)?;
    read(&text)
}

/// Whether a function is rayon's way of dividing work, or of running a part of it.
fn divides(name: &str) -> bool {
    ["bridge_producer_consumer", "join_context", "StackJob"].iter().any(|part| name.contains(part))
}

/// Whether a call divides work that is not a part of other work: callgrind marks the names of
/// functions that are called from within themselves.
fn is_meeting(caller: &str, callee: &str) -> bool {
    let is_outermost = |name: &str| !name.ends_with("'2");
    let from_outside = caller.contains("bridge_producer_consumer") && is_outermost(caller) || !divides(caller);
    callee.contains("join_context") && is_outermost(callee) && from_outside
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
        } else if let Some(total) = line.strip_prefix("totals: ") {
            found.instructions = total.trim().parse()?;
        } else if let Some(times) = calls.take() {
            // The position of the call and what it cost.
            let cost: f64 = line.rsplit(' ').next().unwrap_or_default().parse()?;
            if divides(callee) && !divides(caller) {
                found.shared += cost;
            }
            if is_meeting(caller, callee) {
                found.meetings += times;
            }
        }
    }
    Ok(found)
}
