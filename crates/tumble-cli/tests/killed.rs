//! A run that is killed leaves a record that is readable up to its last checkpoint, under a name
//! that says what it is.
//!
//! A machine that is switched off, or a job over its limit, gives no time to finish. It would fail
//! if a record were readable only from its last byte on, as Parquet and glTF are by nature, or if
//! what is left were taken for the record of a whole run.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking, in its helper functions too")]
#![cfg(unix)]

mod support;

use std::io::Read as _;
use std::process::Stdio;

use rustix::process::{Pid, Signal, kill_process};
use support::{Place, stderr, wait_for};

const BODIES: usize = 100;

/// Starts a run that would take for ever, kills it when its record has been growing for some
/// checkpoints; the directory.
///
/// `frames` says how many frames can be read from the file now, if it can be read at all.
fn killed(name: &str, every: &str, steps: &str, frames: impl Fn(&Place) -> Option<u64>) -> Place {
    let place = Place::new();
    let bodies = BODIES.to_string();
    let run = ["run", "--bodies", &bodies, "--steps", steps, "--every", every, "--quiet", "--record", name];
    let mut child = place.command(&run).stderr(Stdio::piped()).spawn().unwrap();
    // The first checkpoint is made at once, another one second later.
    wait_for("two checkpoints", || frames(&place).is_some_and(|frames| frames > 1));
    kill_process(Pid::from_child(&child), Signal::KILL).unwrap();
    assert_eq!(child.wait().unwrap().code(), None, "the run was over before it was killed");
    let (stem, ending) = name.split_once('.').unwrap();
    assert_eq!(place.entries(), [format!("{stem}.partial.{ending}")]);
    place
}

/// The next run takes the place of what is left.
fn assert_replaced(place: &Place, name: &str) {
    place.succeed(&["run", "mujoco-box", "--steps", "2", "--quiet", "--record", name]);
    assert_eq!(place.entries(), [name]);
}

/// Lines that are whole, after the first.
fn whole_lines(place: &Place) -> Option<Vec<String>> {
    let text = std::fs::read_to_string(place.path("run.partial.csv")).ok()?;
    let (whole, _) = text.rsplit_once('\n')?;
    Some(whole.lines().skip(1).map(str::to_owned).collect())
}

#[test]
fn comma_separated_values_are_whole_lines_but_for_the_last() {
    let place = killed("run.csv", "1000", "1000000000", |place| Some((whole_lines(place)?.len() / BODIES) as u64));
    let lines = whole_lines(&place).unwrap();
    assert!(lines.len() >= BODIES);
    for (index, line) in lines.iter().enumerate() {
        let mut columns = line.split(',');
        assert_eq!(columns.next().unwrap().parse(), Ok(index / BODIES * 1000));
        assert_eq!(columns.clone().count(), 15);
        assert!(columns.skip(2).all(|number| number.parse::<f64>().is_ok_and(f64::is_finite)), "{line}");
    }
    assert_replaced(&place, "run.csv");
}

/// The document of an animation whose lengths and counts all agree, how many frames it has, and
/// where its buffer is in the file.
fn document(place: &Place) -> Option<(serde_json::Value, u64, usize)> {
    let mut file = std::fs::File::open(place.path("run.partial.glb")).ok()?;
    let mut header = [0; 20];
    file.read_exact(&mut header).ok()?;
    let word = |at: usize| u32::from_le_bytes([header[at], header[at + 1], header[at + 2], header[at + 3]]);
    let mut text = vec![0; word(12) as usize];
    file.read_exact(&mut text).ok()?;
    let json: serde_json::Value = serde_json::from_slice(&text).ok()?;
    let tracks = json["accessors"].as_array()?.get(..1 + 2 * BODIES)?;
    let frames = tracks.first()?["count"].as_u64()?;
    let whole = u64::from(word(8)) == file.metadata().ok()?.len();
    let agree = tracks.iter().all(|track| track["count"].as_u64() == Some(frames));
    (whole && agree).then_some((json, frames, 20 + text.len() + 8))
}

#[test]
fn an_animation_has_the_frames_that_it_says() {
    let place = killed("run.glb", "100000", "1000000000", |place| Some(document(place)?.1));
    let (json, frames, buffer_at) = document(&place).unwrap();
    let bytes = std::fs::read(place.path("run.partial.glb")).unwrap();
    let number = |value: &serde_json::Value| value.as_u64().unwrap_or(0) as usize;
    let tracks = &json["accessors"].as_array().unwrap()[1..=2 * BODIES];
    let rotations: Vec<_> = tracks.iter().filter(|track| track["type"] == "VEC4").collect();
    assert_eq!(rotations.len(), BODIES);
    // The last rotation of every body is one, which zeros are not.
    for track in rotations {
        let view = &json["bufferViews"][number(&track["bufferView"])];
        let track_at = buffer_at + number(&view["byteOffset"]) + number(&track["byteOffset"]);
        let parts = bytes[track_at + (frames as usize - 1) * 16..][..16].chunks_exact(4);
        let square: f32 = parts.map(|bytes| f32::from_le_bytes(bytes.try_into().unwrap()).powi(2)).sum();
        assert!((square - 1.0).abs() < 1e-6, "{square}");
    }
    assert_replaced(&place, "run.glb");
}

#[cfg(feature = "parquet")]
#[test]
fn a_table_has_the_rows_up_to_its_last_description() {
    use parquet::file::reader::{FileReader as _, SerializedFileReader};
    use parquet::record::RowAccessor as _;

    let open =
        |place: &Place| SerializedFileReader::new(std::fs::File::open(place.path("run.partial.parquet")).ok()?).ok();
    let frames = |place: &Place| Some(open(place)?.metadata().file_metadata().num_rows() as u64 / BODIES as u64);
    let place = killed("run.parquet", "1000", "1000000000", frames);
    if let Some(reader) = open(&place) {
        assert!(reader.num_row_groups() > 1);
        for (index, row) in reader.get_row_iter(None).unwrap().enumerate() {
            let row = row.unwrap();
            assert_eq!(row.get_ulong(0).unwrap() as usize, index / BODIES * 1000);
            assert_eq!(*row.get_string(2).unwrap(), format!("body-{}", index % BODIES));
        }
    }
    assert_replaced(&place, "run.parquet");
}

#[test]
fn two_runs_do_not_write_one_record() {
    let place = Place::new();
    let run = ["run", "--bodies", "10", "--steps", "1000000000", "--every", "10000", "--quiet", "--record", "run.csv"];
    let child = place.command(&run).stderr(Stdio::piped()).spawn().unwrap();
    wait_for("a record", || whole_lines(&place).is_some());
    place.refused(&["run", "mujoco-box", "--record", "run.csv"], "another program is writing");
    kill_process(Pid::from_child(&child), Signal::TERM).unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{}", stderr(&output));
    assert_eq!(place.entries(), ["run.csv"]);
}
