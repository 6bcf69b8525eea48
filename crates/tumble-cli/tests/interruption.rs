//! However a run is cut short, what it leaves behind is whole.
//!
//! A long run is the one that gets interrupted. It would fail if Ctrl-C killed the program before
//! the record was renamed into place, or if a reader that went away made it panic.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking, in its helper functions too")]
#![cfg(unix)]

mod support;

use std::io::Read;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process};
use support::{Place, stderr, wait_for};

/// More bytes than the rows of a hundred bodies at two times have, of some 160 each.
const TWO_FRAMES: u64 = 60_000;

/// Waits until the run has surely recorded more than the start.
fn wait_for_rows(place: &Place) {
    let record = place.path("out.partial.csv");
    wait_for("a record", || std::fs::metadata(&record).is_ok_and(|file| file.len() > TWO_FRAMES));
}

fn signal(child: &Child, signal: Signal) {
    kill_process(Pid::from_child(child), signal).unwrap();
}

fn interrupted_by(how: Signal) {
    let place = Place::new();
    let arguments = [
        "run",
        "--bodies",
        "100",
        "--steps",
        "1000000000",
        "--record",
        "out.csv",
        "--every",
        "100",
        "--report",
        "report",
    ];
    let child = place.command(&arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    wait_for_rows(&place);
    signal(&child, how);
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{}", stderr(&output));
    assert!(String::from_utf8_lossy(&output.stdout).contains("interrupted, of 1000000000"));
    assert_eq!(place.entries(), ["out.csv", "report"]);
    let record = place.record("out.csv");
    assert!(record.len() >= 200 && record.len().is_multiple_of(100), "{}", record.len());
    assert!(record.iter().all(|line| line.len() == 16));
    let page = place.read("report/report.html");
    assert!(page.contains("(interrupted, of 1\u{202f}000\u{202f}000\u{202f}000)") && page.ends_with("</html>\n"));
    let steps = place.summary()["steps"].as_u64().unwrap();
    assert!((1..1_000_000_000).contains(&steps));
}

#[test]
fn ctrl_c_leaves_a_readable_record_and_report() {
    interrupted_by(Signal::INT);
}

#[test]
fn so_does_a_request_to_terminate() {
    interrupted_by(Signal::TERM);
}

/// A world that would take a month; before it one that is done at once, whose row is to be kept.
#[test]
fn ctrl_c_ends_a_sweep_within_its_worlds_and_keeps_those_that_are_done() {
    let place = Place::new();
    let vary = ["--vary", "steps=grid(1,10000000000,2)", "--threads", "1", "--out", "sweep.csv"];
    let arguments = [&["sweep", "ragdoll"][..], &vary].concat();
    let child = place.command(&arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    wait_for("a sweep's file", || std::fs::metadata(place.path("sweep.csv")).is_ok_and(|file| file.len() > 0));
    // Well into the second world: many steps at once, which once were 20 seconds.
    std::thread::sleep(Duration::from_secs(2));
    let asked = Instant::now();
    signal(&child, Signal::INT);
    let output = child.wait_with_output().unwrap();
    let waited = asked.elapsed();
    assert_eq!(output.status.code(), Some(130), "{}", stderr(&output));
    assert!(waited < Duration::from_secs(3), "{waited:?}");
    assert!(String::from_utf8_lossy(&output.stdout).contains("1 of 2"));
    let file = place.read("sweep.csv");
    let rows: Vec<&str> = file.lines().skip(2).collect();
    assert!(rows.len() == 1 && rows[0].starts_with("0,1.0,ok,1,"), "{rows:?}");
}

#[test]
fn a_reader_that_goes_away_is_no_failure() {
    let place = Place::new();
    for arguments in [&["run", "mujoco-box"][..], &["inspect", "stress", "--json"]] {
        let mut child = place.command(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let mut message = String::new();
        child.stderr.take().unwrap().read_to_string(&mut message).unwrap();
        assert_eq!((child.wait().unwrap().code(), message.as_str()), (Some(0), ""), "{arguments:?}");
    }
}

/// `/dev/full` is a disk without space.
#[cfg(target_os = "linux")]
#[test]
fn a_full_standard_output_is_a_failure_while_running() {
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let output = Place::new().command(&["run", "mujoco-box"]).stdout(full).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr(&output).contains("standard output"), "{}", stderr(&output));
}

#[test]
fn a_record_that_cannot_grow_is_a_failure_while_running_and_leaves_nothing() {
    for name in ["out.csv", "out.glb"] {
        let arguments = format!("run --bodies 1000 --steps 50 --record {name} --report report");
        Place::new().fills_the_disk(200, &arguments, &format!("{name}: writing failed"));
    }
}
