//! Promise: the time series of a sweep are the states that a run of each world alone records, in
//! one file with the same bytes for any number of threads and wherever the sweep was cut; glTF and
//! URDF files are swept as scenes are.
//!
//! It would fail if a step was missed or came twice, if the series and the rows of a killed sweep
//! were of different worlds, or if the file of something else was cut.

use crate::support::Place;

const SCENE: &str = r#"{ "dt": 0.01, "steps": 25, "bodies": [
    { "name": "a", "shape": { "cuboid": { "half_extents": [0.1, 0.2, 0.3] } }, "mass": 2, "angular_velocity": [1, 2, 3] },
    { "name": "b, c", "mass": 1, "linear_velocity": [1, 0, 0] } ] }"#;

fn place() -> Place {
    let place = Place::new();
    place.write("scene.json", SCENE);
    place
}

fn sweep<'a>(out: &'a str, series: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let mut all = vec!["sweep", "scene.json", "--quiet", "--out", out, "--series", series];
    all.extend(["--vary", "bodies.a.linear_velocity.0=1..2", "--worlds", "7", "--body", "b, c", "--body", "a"]);
    all.extend(more);
    all
}

/// Without the two first lines.
fn lines(text: &str) -> Vec<&str> {
    text.lines().skip(2).collect()
}

fn number(text: &str) -> f64 {
    text.parse().unwrap()
}

#[test]
fn series_are_what_runs_record() {
    let place = place();
    place.succeed(&sweep("out.csv", "series.csv", &["--every", "10"]));
    let text = place.read("series.csv");
    assert_eq!(text.lines().nth(1), Some("world,step,time,body,px,py,pz,qx,qy,qz,qw,vx,vy,vz,wx,wy,wz"));
    // Steps 0, 10, 20 and the last, 25, of two bodies in seven worlds.
    let all = lines(&text);
    assert_eq!(all.len(), 4 * 2 * 7);
    let rows = place.read("out.csv");
    for (world, row) in lines(&rows).into_iter().enumerate() {
        let speed = row.split(',').nth(1).unwrap();
        place.write(
            "one.json",
            SCENE.replace(r#""mass": 2,"#, &format!(r#""mass": 2, "linear_velocity": [{speed}, 0, 0],"#)),
        );
        place.succeed(&["run", "one.json", "--record", "one.csv", "--quiet"]);
        let record = place.read("one.csv");
        let recorded: Vec<csv::StringRecord> =
            csv::Reader::from_reader(record.as_bytes()).into_records().map(Result::unwrap).collect();
        let series = csv::ReaderBuilder::new()
            .has_headers(false)
            .from_reader(all[8 * world..8 * (world + 1)].join("\n").as_bytes())
            .into_records()
            .map(Result::unwrap)
            .collect::<Vec<_>>();
        let expected = [0, 10, 20, 25].into_iter().flat_map(|step| [("b, c", step), ("a", step)]);
        for (line, (name, step)) in series.iter().zip(expected) {
            assert_eq!(number(&line[0]), world as f64);
            let found = recorded.iter().find(|record| record[0] == step.to_string() && &record[2] == name).unwrap();
            assert_eq!(&line[3], name);
            for column in [0, 1].into_iter().chain(3..16) {
                assert_eq!(number(&line[column + 1]), number(&found[column]), "{line:?} {found:?}");
            }
        }
    }
}

#[test]
fn series_have_the_same_bytes_wherever_the_sweep_was_cut() {
    let place = place();
    let arguments = |out, series| sweep(out, series, &["--threads", "2"]);
    place.succeed(&sweep("whole.csv", "whole-series.csv", &["--threads", "1"]));
    let (rows, series) = (place.read("whole.csv"), place.read("whole-series.csv"));
    let ends: Vec<usize> = rows.match_indices('\n').map(|(at, _)| at + 1).collect();
    // After each row, with the series of the same world and a part of the next one there.
    for (world, end) in ends.iter().skip(1).enumerate() {
        let first_of_next = series.lines().take(2 + 52 * world).map(|line| line.len() + 1).sum::<usize>();
        for more in [0, 1, 100, 3000] {
            place.write("cut.csv", &rows[..*end]);
            place.write("cut-series.csv", &series[..(first_of_next + more).min(series.len())]);
            place.succeed(&arguments("cut.csv", "cut-series.csv"));
            assert!(place.read("cut.csv") == rows && place.read("cut-series.csv") == series, "{world} {more}");
        }
    }
    // A condition ends the series with the world.
    place.succeed(&sweep("until.csv", "until-series.csv", &["--until", "b, c.px>0.0999"]));
    let text = place.read("until-series.csv");
    assert_eq!(lines(&text).len(), 7 * 11 * 2);
}

#[test]
fn what_is_no_series_of_the_sweep_is_refused_and_stays() {
    let place = place();
    place.write("mine.csv", "a,b\n1,2\n");
    place.refused(&sweep("out.csv", "mine.csv", &[]), "mine.csv: is there already and is not the series of this sweep");
    assert_eq!(place.read("mine.csv"), "a,b\n1,2\n");
    place.refused(&sweep("out.csv", "out.csv", &[]), "out.csv: is --out already");
    place.refused(&sweep("out.csv", "series.txt", &[]), "the name of a time series ends in .csv");
    let every = ["sweep", "scene.json", "--out", "out.csv", "--worlds", "1", "--every", "2"];
    place.refused(&every, "--series <FILE>");
    place.succeed(&sweep("out.csv", "series.csv", &[]));
    place.refused(
        &sweep("out.csv", "series.csv", &["--every", "5"]),
        "is the file of another sweep: series: 1 is not 5",
    );
    place.refused(&sweep("out.csv", "other.csv", &[]), "other.csv: is not there, and the sweep has worlds already");
    // Of six worlds of whose rows five are there.
    let (rows, series) = (place.read("out.csv"), place.read("series.csv"));
    let of_rows = rows.split_inclusive('\n').take(2 + 5).collect::<String>();
    let without =
        |world: &str| series.split_inclusive('\n').filter(|line| !line.starts_with(world)).collect::<String>();
    let torn = series.split_inclusive('\n').take(2 + 52 * 4).collect::<String>() + "4,0,";
    for (damaged, problem) in [
        (without("2,"), "line 107 is damaged: it is not that of world 2"),
        (without("4,"), "line 211 is damaged: it is not that of world 4"),
        (series.replacen("\n3,", "\nx,", 1), "line 159 is damaged: it is not that of world 3"),
        (torn, "line 211 is damaged: it is not that of world 4"),
    ] {
        place.write("cut.csv", &of_rows);
        place.write("damaged.csv", &damaged);
        place.refused(&sweep("cut.csv", "damaged.csv", &[]), problem);
        assert!(place.read("damaged.csv") == damaged && place.read("cut.csv") == of_rows);
    }
    let held = std::fs::File::open(place.path("series.csv")).unwrap();
    held.lock().unwrap();
    place.refused(&sweep("out.csv", "series.csv", &[]), "series.csv: another tumble is writing to it");
    drop(held);
    // An old series may be written over by a sweep that begins.
    place.succeed(&sweep("new.csv", "series.csv", &["--every", "25"]));
    assert_eq!(lines(&place.read("series.csv")).len(), 7 * 2 * 2);
}

/// It has a line too, so that a series is known to be whole.
#[test]
fn an_impossible_world_has_an_empty_line() {
    let place = place();
    let masses = ["--vary", "bodies.a.mass=normal(1,1)", "--worlds", "50", "--steps", "0"];
    let files = ["sweep", "scene.json", "--quiet", "--out", "out.csv", "--series", "series.csv"];
    place.succeed(&[&files[..], &masses].concat());
    let (rows, series) = (place.read("out.csv"), place.read("series.csv"));
    let (rows, series) = (lines(&rows), lines(&series));
    assert_eq!((rows.len(), series.len()), (50, 50));
    let mut impossible = 0;
    for (world, (row, line)) in rows.iter().zip(&series).enumerate() {
        if row.contains(",impossible,") {
            impossible += 1;
            assert_eq!(*line, format!("{world},,,,,,,,,,,,,,,,"));
        } else {
            assert!(line.starts_with(&format!("{world},0,0.0,a,0.0")), "{line}");
        }
    }
    assert!((1..50).contains(&impossible), "{impossible}");
}

/// A robot and a glTF file from the repository's own models.
#[test]
fn files_of_others_are_swept() {
    let place = Place::new();
    for file in ["robot.urdf", "crates.gltf"] {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models").join(file);
        std::fs::copy(path, place.path(file)).unwrap();
    }
    let robot =
        ["sweep", "robot.urdf", "--out", "robot.csv", "--vary", "joints.elbow.position=grid(-1,1,3)", "--steps", "1"];
    place.refused(&robot, "link \"forearm\"");
    let observe = ["--repair", "--body", "forearm", "--quiet"];
    place.succeed(&[&robot[..], &observe].concat());
    let text = place.read("robot.csv");
    let title = |name: &str| text.lines().nth(1).unwrap().split(',').position(|it| it == name).unwrap();
    let column = |name: &str| {
        lines(&text).iter().map(|row| number(row.split(',').nth(title(name)).unwrap())).collect::<Vec<_>>()
    };
    // About y from z towards x: the centre of the forearm is 0.15 from the elbow at 0.45.
    for (world, angle) in [-1.0_f64, 0.0, 1.0].into_iter().enumerate() {
        assert!((column("forearm.px")[world] - 0.15 * angle.sin()).abs() < 3e-3, "{text}");
        assert!((column("forearm.pz")[world] - (0.45 + 0.15 * angle.cos())).abs() < 3e-3, "{text}");
    }
    place.succeed(&[
        "sweep",
        "crates.gltf",
        "--out",
        "crates.csv",
        "--vary",
        "bodies.ball.linear_velocity.0=list(7,8)",
        "--steps",
        "5",
        "--quiet",
    ]);
    place.refused(
        &["sweep", "crates.gltf", "--out", "c.csv", "--vary", "bodies.ball.density=1..2", "--worlds", "1"],
        "of a body of such a file only mass",
    );
    place.write("scene.json", SCENE);
    let repair = ["sweep", "scene.json", "--out", "d.csv", "--worlds", "1", "--repair"];
    place.refused(&repair, "--repair goes with a mesh, or a .gltf, .glb or .urdf file");
}
