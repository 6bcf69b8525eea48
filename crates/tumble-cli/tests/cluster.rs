//! Promise: the job files for clusters do what they say: their shards, merged, are the bytes of the
//! sweep on one machine.
//!
//! Why: what is copied from a manual at night must work. It fails if an option is renamed, a shard
//! is counted from zero, or quoting breaks a field.
//!
//! GNU parallel is run where it is installed. Slurm and Kubernetes are not there to be run; what
//! they would start is, with the variables that they set.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking, in its helper functions too")]
#![cfg(unix)]

mod support;

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use support::{Place, stderr};

/// The sweep of the files for Slurm and Kubernetes, with as many worlds as a test has time for.
const SWEEP: [&str; 9] =
    ["sweep", "t-handle", "--worlds", "30", "--seed", "7", "--vary", "bodies.0.angular_velocity.1=0..5", "--quiet"];

fn job_file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/cluster").join(name)
}

/// The program's directory before all others, so that scripts find it.
fn path() -> OsString {
    let program = Path::new(env!("CARGO_BIN_EXE_tumble")).parent().unwrap().to_owned();
    let others = std::env::var_os("PATH").unwrap_or_default();
    std::env::join_paths(std::iter::once(program).chain(std::env::split_paths(&others))).unwrap()
}

fn script(place: &Place, shell: &str) -> Command {
    let mut command = Command::new(shell);
    command.current_dir(place.path("")).env("PATH", path());
    command
}

fn succeed(mut command: Command) {
    let output = command.output().unwrap();
    assert!(output.status.success(), "{command:?}: {}", stderr(&output));
}

/// What the shards of a place make together is what one machine gives.
fn check(place: &Place, shards: usize, more: &[&str]) {
    let names: Vec<String> = (1..=shards).map(|shard| format!("shard-{shard}.csv")).collect();
    let mut merge = vec!["merge", "merged.csv"];
    merge.extend(names.iter().map(String::as_str));
    place.succeed(&merge);
    place.succeed(&[&SWEEP[..], more, &["--out", "whole.csv"]].concat());
    assert!(place.read("merged.csv") == place.read("whole.csv"));
    assert_eq!(place.read("whole.csv").lines().count(), 32);
}

const ALSO: [&str; 2] = ["--vary", "gravity.1=normal(-9.81,0.01)"];

#[test]
fn gnu_parallel() {
    let version = Command::new("parallel").arg("--version").output();
    if !version.is_ok_and(|output| String::from_utf8_lossy(&output.stdout).starts_with("GNU parallel")) {
        assert!(std::env::var_os("TUMBLE_PARALLEL").is_none(), "GNU parallel is required and not there");
        println!("GNU parallel is not installed: its job file is not tested here");
        return;
    }
    let place = Place::new();
    let mut command = script(&place, "sh");
    command.arg(job_file("parallel.sh")).args(["4", "merged.csv"]).args(&SWEEP[1..8]).args(ALSO);
    succeed(command);
    let merged = place.read("merged.csv");
    check(&place, 4, &ALSO);
    assert!(place.read("merged.csv") == merged, "the script did not merge");
}

#[test]
fn a_plot_is_not_for_shards() {
    let place = Place::new();
    let mut command = script(&place, "sh");
    command.arg(job_file("parallel.sh")).args(["4", "merged.csv"]).args(&SWEEP[1..8]).args(["--plot", "a.svg"]);
    let output = command.output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("--plot is not for shards"), "{}", stderr(&output));
    assert!(place.entries().is_empty(), "{:?}", place.entries());
}

#[test]
fn slurm() {
    let place = Place::new();
    let job = fs::read_to_string(job_file("slurm.sh")).unwrap();
    assert!(job.contains("#SBATCH --array=1-"), "shards are counted from one");
    // `srun` starts what follows it.
    let job = job
        .replace("srun --cpus-per-task=\"$SLURM_CPUS_PER_TASK\" tumble", "tumble")
        .replace("--worlds 100000", "--worlds 30");
    place.write("slurm.sh", job);
    // The third alone first, as one that is submitted again: of an array of one, and still the
    // third of 16.
    for (task, count) in std::iter::once((3, 1)).chain((1..=16).filter(|task| *task != 3).map(|task| (task, 16))) {
        let mut command = script(&place, "bash");
        command.arg("slurm.sh").env("SLURM_ARRAY_TASK_ID", task.to_string());
        command.env("SLURM_ARRAY_TASK_COUNT", count.to_string());
        command.env("SLURM_CPUS_PER_TASK", "2");
        succeed(command);
    }
    assert!(place.read("shard-3.csv").contains("\"shard\":\"3/16\""));
    check(&place, 16, &ALSO);
}

#[test]
fn kubernetes() {
    let place = Place::new();
    let job = fs::read_to_string(job_file("kubernetes.yaml")).unwrap();
    let begin = "          args:\n            - |\n";
    let block = &job[job.find(begin).unwrap() + begin.len()..];
    let lines = block.lines().take_while(|line| line.starts_with("              "));
    let script_text: String = lines.map(|line| format!("{}\n", &line[14..])).collect();
    let script_text = script_text.replace("--worlds 100000", "--worlds 30");
    for index in ["1", "0"] {
        let mut command = script(&place, "sh");
        command.args(["-euc", &script_text]).env("JOB_COMPLETION_INDEX", index).env("SHARDS", "2");
        succeed(command);
    }
    check(&place, 2, &ALSO);
}
