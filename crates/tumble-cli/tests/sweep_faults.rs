//! Promise: no file of somebody else is replaced, nothing half-made stays, Ctrl-C is answered, and
//! what draws nothing is refused.
//!
//! Why: days of work are in these files. It would fail if a merge replaced the file that a sweep is
//! writing, if a full disk or a killed program left crumbs, or if a step of many substeps made the
//! program deaf.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking, in its helper functions too")]
#![cfg(unix)]

mod support;

use std::process::Stdio;
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process};
use support::{PATIENCE, Place, wait_for};

const SWEEP: [&str; 5] = ["sweep", "t-handle", "--quiet", "--steps", "3"];

fn sweep<'a>(more: &[&'a str]) -> Vec<&'a str> {
    [&SWEEP[..], more].concat()
}

#[test]
fn a_merge_replaces_a_file_of_its_own_sweep_only() {
    let place = Place::new();
    place.succeed(&sweep(&["--worlds", "4", "--shard", "1/2", "--out", "1.csv"]));
    place.succeed(&sweep(&["--worlds", "4", "--shard", "2/2", "--out", "2.csv"]));
    place.succeed(&sweep(&["--worlds", "5", "--out", "other.csv"]));
    place.write("foreign.csv", "a,b\n1,2\n");
    for (name, wanted) in [
        ("other.csv", "other.csv: is the file of another sweep: worlds: 5 is not 4"),
        ("foreign.csv", "foreign.csv: is not the file of a sweep"),
    ] {
        let before = place.read(name);
        place.refused(&["merge", name, "1.csv", "2.csv"], wanted);
        assert_eq!(place.read(name), before);
    }
    // The whole of the same sweep, begun elsewhere, and the lock that a running one has.
    place.succeed(&sweep(&["--worlds", "4", "--out", "whole.csv"]));
    let whole = place.read("whole.csv");
    let begun: String = whole.split_inclusive('\n').take(3).collect();
    place.write("whole.csv", &begun);
    let running = std::fs::File::open(place.path("whole.csv")).unwrap();
    running.lock().unwrap();
    place.refused(&["merge", "whole.csv", "1.csv", "2.csv"], "whole.csv: another tumble is writing to it");
    assert_eq!(place.read("whole.csv"), begun);
    drop(running);
    place.succeed(&["merge", "whole.csv", "1.csv", "2.csv"]);
    assert_eq!(place.read("whole.csv"), whole);
}

/// A step of 10 000 substeps is milliseconds; the million steps between two looks would be minutes.
#[test]
fn ctrl_c_is_answered_with_many_substeps() {
    let place = Place::new();
    let arguments =
        ["sweep", "t-handle", "--worlds", "2", "--steps", "1000000", "--substeps", "10000", "--out", "a.csv"];
    let mut child = place.command(&arguments).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    wait_for("a file", || place.path("a.csv").exists());
    std::thread::sleep(Duration::from_millis(500));
    kill_process(Pid::from_child(&child), Signal::INT).unwrap();
    let asked = Instant::now();
    // A tenth of a second in release, some seconds without optimisation on a busy machine.
    while asked.elapsed() < PATIENCE / 2 && child.try_wait().unwrap().is_none() {
        std::thread::sleep(Duration::from_millis(10));
    }
    let answered = child.try_wait().unwrap();
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(answered.and_then(|status| status.code()), Some(130));
}

#[test]
fn a_killed_sweep_leaves_no_unfinished_plot() {
    let place = Place::new();
    let arguments = sweep(&["--worlds", "100000000", "--out", "a.csv", "--plot", "a.svg"]);
    let mut child = place.command(&arguments).spawn().unwrap();
    wait_for("rows", || std::fs::metadata(place.path("a.csv")).is_ok_and(|file| file.len() > 4000));
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(place.entries(), ["a.csv"]);
}

#[test]
fn ctrl_c_ends_a_merge_with_nothing_left() {
    const WORLDS: usize = 1_000_000;
    let place = Place::new();
    place.succeed(&sweep(&["--worlds", "2", "--shard", "1/1", "--out", "s.csv"]));
    let small = place.read("s.csv").replace("\"worlds\":2", &format!("\"worlds\":{WORLDS}"));
    let mut big: String = small.split_inclusive('\n').take(2).collect();
    // As worlds that could not be: a value for what varies, the outcome, and nothing in the columns
    // after it.
    let columns = small.lines().nth(1).unwrap().split(',');
    let outcome = columns.clone().position(|column| column == "outcome").unwrap();
    let row = format!("{},impossible{}", ",0".repeat(outcome - 1), ",".repeat(columns.count() - 1 - outcome));
    for world in 0..WORLDS {
        big.push_str(&format!("{world}{row}\n"));
    }
    place.write("s.csv", big);
    let mut child = place.command(&["merge", "whole.csv", "s.csv"]).spawn().unwrap();
    wait_for("an unfinished file", || place.entries().iter().any(|name| name.ends_with(".part")));
    kill_process(Pid::from_child(&child), Signal::INT).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert_eq!(place.entries(), ["s.csv"]);
}

#[test]
fn a_full_disk_is_a_failure_while_running_and_leaves_nothing() {
    Place::new().fills_the_disk(0, "sweep t-handle --worlds 2 --out a.csv --quiet", "a.csv: ");
}

#[test]
fn what_draws_nothing_and_what_is_named_twice_is_refused() {
    let place = Place::new();
    let base = sweep(&["--worlds", "2", "--out", "a.csv", "--plot", "a.svg"]);
    for more in [["--y", "hash"], ["--y", "outcome"], ["--x", "hash"], ["--x", "outcome"]] {
        let wanted = format!("{} {:?}: is no number and cannot be drawn", more[0], more[1]);
        place.refused(&[&base[..], &more].concat(), &wanted);
    }
    place.write("scene.json", r#"{ "bodies": [ { "name": "stone", "mass": 1 } ] }"#);
    let twice = ["sweep", "scene.json", "--worlds", "2", "--out", "a.csv", "--body", "stone", "--body", "stone"];
    place.refused(&twice, "--body \"stone\": is named twice");
}

#[test]
fn a_long_label_stays_in_the_picture() {
    let place = Place::new();
    let name = "n".repeat(200);
    place.write("scene.json", format!(r#"{{ "bodies": [ {{ "name": "{name}", "mass": 1 }} ] }}"#));
    let (x, y) = (format!("bodies.{name}.mass=1..2"), format!("{name}.py"));
    let arguments = [
        "sweep",
        "scene.json",
        "--quiet",
        "--worlds",
        "3",
        "--steps",
        "3",
        "--out",
        "a.csv",
        "--vary",
        &x,
        "--plot",
        "a.svg",
        "--y",
        &y,
    ];
    place.succeed(&arguments);
    let svg = place.read("a.svg");
    let labels: Vec<&str> = svg.split("</text>").filter_map(|text| text.rsplit('>').next()).collect();
    let long: Vec<usize> =
        labels.iter().filter(|label| label.contains('…')).map(|label| label.chars().count()).collect();
    // 650 and 316 pixels are there, a character takes about 7.
    assert_eq!(long.len(), 2, "{labels:?}");
    assert!(long.iter().any(|&length| length <= 45) && long.iter().all(|&length| length <= 92), "{long:?}");
    assert!(labels.iter().any(|label| label.ends_with("n.mass")) && labels.iter().any(|label| label.ends_with("n.py")));
}
