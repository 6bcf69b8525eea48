//! Promise: a sweep's file has the same bytes for any number of threads, any shards, and however
//! often it was killed; a row is what a run of that world alone gives; what cannot be swept is
//! refused with nothing written.
//!
//! Why: a Monte-Carlo study is spread over machines and days. It would fail if a value depended on
//! another world's, if rows were written as they finish, if a killed sweep restarted or went on in
//! another sweep's file, or if all worlds were held in memory.

use crate::support;

use std::fs;

use support::{Place, stderr};

const SCENE: &str = r#"{ "gravity": [0, -2, 0], "dt": 0.01, "steps": 50, "bodies": [
    { "name": "brick", "shape": { "cuboid": { "half_extents": [0.1, 0.2, 0.3] } }, "mass": 2, "angular_velocity": [1, 2, 3] },
    { "name": "stone", "mass": 1, "linear_velocity": [1, 0, 0] } ] }"#;

/// A number of each kind: at random, over a grid, of the scene and of a body.
const VARY: [&str; 6] = [
    "--vary",
    "bodies.brick.angular_velocity.1=-5..5",
    "--vary",
    "gravity.1=grid(-10,0,3)",
    "--vary",
    "bodies[1].mass=normal(1,0.1)",
];

fn place() -> Place {
    let place = Place::new();
    place.write("scene.json", SCENE);
    place
}

/// `tumble sweep scene.json` with the fields above and more.
fn sweep<'a>(out: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let mut all = vec!["sweep", "scene.json", "--seed", "7", "--quiet", "--out", out];
    all.extend(VARY);
    all.extend(more);
    all
}

/// Of the file of 23 worlds, by one thread.
fn reference(place: &Place) -> String {
    place.succeed(&sweep("reference.csv", &["--worlds", "23", "--threads", "1"]));
    place.read("reference.csv")
}

/// The file as records, after the line of its identity.
fn rows(text: &str) -> Vec<csv::StringRecord> {
    let reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(text.as_bytes());
    reader.into_records().map(Result::unwrap).collect()
}

#[test]
fn threads_and_shards_do_not_matter() {
    let place = place();
    let whole = reference(&place);
    assert_eq!(rows(&whole).len(), 23);
    for threads in ["2", "4"] {
        place.succeed(&sweep("threads.csv", &["--worlds", "23", "--threads", threads]));
        assert_eq!(place.read("threads.csv"), whole, "{threads} threads");
        fs::remove_file(place.path("threads.csv")).unwrap();
    }
    // The last one has more shards than worlds, so that some are empty.
    for count in [1, 2, 3, 7, 30] {
        let names: Vec<String> = (1..=count).map(|index| format!("{count}-{index}.csv")).collect();
        for (index, name) in (1..).zip(&names) {
            let (shard, threads) = (format!("{index}/{count}"), (index % 3 + 1).to_string());
            place.succeed(&sweep(name, &["--worlds", "23", "--shard", &shard, "--threads", &threads]));
        }
        let mut merge = vec!["merge", "merged.csv"];
        merge.extend(names.iter().rev().map(String::as_str));
        place.succeed(&merge);
        assert_eq!(place.read("merged.csv"), whole, "{count} shards");
    }
}

/// The world of a row, written down as a scene and run.
#[test]
fn a_row_is_what_a_run_of_its_world_gives() {
    let place = place();
    let whole = reference(&place);
    for row in rows(&whole).iter().step_by(5) {
        let (spin, gravity, mass) = (&row[1], &row[2], &row[3]);
        let scene = SCENE
            .replace("\"gravity\": [0, -2, 0]", &format!("\"gravity\": [0, {gravity}, 0]"))
            .replace("[1, 2, 3] }", &format!("[1, {spin}, 3] }}"))
            .replace("\"mass\": 1,", &format!("\"mass\": {mass},"));
        place.write("world.json", scene);
        place.succeed(&["run", "world.json", "--quiet", "--report", "report", "--record", "end.csv", "--every", "50"]);
        let summary = place.summary();
        assert_eq!(row.get(row.len() - 1), summary["state_hash"].as_str());
        assert_eq!(row[row.len() - 3].parse::<f64>().unwrap(), summary["energy"]["final"].as_f64().unwrap());
        let record = place.record("end.csv");
        let brick = record.iter().find(|line| &line[0] == "50" && &line[2] == "brick").unwrap();
        let number = |text: &str| text.parse::<f64>().unwrap();
        // World, three fields, outcome, steps and time stand before the state.
        let state: Vec<f64> = row.iter().skip(7).take(13).map(number).collect();
        assert_eq!(state, brick.iter().skip(3).map(number).collect::<Vec<f64>>());
        assert_eq!((&row[4], &row[5]), ("ok", "50"));
    }
}

#[test]
fn values_depend_on_seed_field_and_world_only() {
    let place = place();
    let whole = rows(&reference(&place));
    let column =
        |rows: &[csv::StringRecord], at: usize| -> Vec<String> { rows.iter().map(|row| row[at].to_owned()).collect() };
    place.succeed(&sweep("more.csv", &["--worlds", "40"]));
    let more = rows(&place.read("more.csv"));
    assert_eq!(whole, more[..23], "the number of worlds changes the first ones");
    let mut other_seed = sweep("other.csv", &["--worlds", "23"]);
    other_seed[3] = "8";
    place.succeed(&other_seed);
    let other = rows(&place.read("other.csv"));
    for at in [1, 3] {
        assert!(column(&whole, at).iter().zip(column(&other, at)).all(|(a, b)| *a != b), "column {at}");
    }
    // The grid's value changes from world to world and starts over.
    assert_eq!(column(&whole, 2)[..4], ["-10.0", "-5.0", "0.0", "-10.0"]);
    let one = |field: &str, out: &str| {
        place.succeed(&["sweep", "scene.json", "--worlds", "5", "--quiet", "--out", out, "--vary", field]);
        column(&rows(&place.read(out)), 1)
    };
    let (first, second) = (one("gravity.0=0..1", "x.csv"), one("gravity.2=0..1", "z.csv"));
    assert_eq!(first, second, "the field's place decides, not its name");
    let two = ["--vary", "gravity.0=0..1", "--vary", "gravity.2=0..1"];
    place.succeed(&[&["sweep", "scene.json", "--worlds", "5", "--quiet", "--out", "two.csv"], &two[..]].concat());
    let two = rows(&place.read("two.csv"));
    assert_eq!(column(&two, 1), first);
    assert!(column(&two, 1).iter().zip(column(&two, 2)).all(|(a, b)| *a != b));
}

#[test]
fn grids_make_all_combinations() {
    let place = place();
    let vary = ["--vary", "gravity.0=grid(0,1,2)", "--vary", "substeps=grid(1,3,3)"];
    let mut arguments =
        vec!["sweep", "scene.json", "--quiet", "--out", "grid.csv", "--body", "stone", "--body", "brick"];
    arguments.extend(vary);
    place.succeed(&arguments);
    let rows = rows(&place.read("grid.csv"));
    let pairs: Vec<(&str, &str)> = rows.iter().map(|row| (&row[1], &row[2])).collect();
    assert_eq!(pairs, [("0.0", "1.0"), ("0.0", "2.0"), ("0.0", "3.0"), ("1.0", "1.0"), ("1.0", "2.0"), ("1.0", "3.0")]);
    let text = place.read("grid.csv");
    let titles = text.lines().nth(1).unwrap();
    assert!(titles.contains(",time,stone.px,") && titles.contains(",stone.wz,brick.px,"), "{titles}");
}

/// Whatever of the file was written when the program was killed, the next run ends with the same
/// bytes.
#[test]
fn a_sweep_goes_on_wherever_it_was_cut() {
    let place = place();
    let whole = reference(&place).into_bytes();
    let arguments = sweep("cut.csv", &["--worlds", "23", "--threads", "1"]);
    // Through the two first lines and some rows, and at the end; 97 has no factor in common with a
    // row's length.
    let lengths = (0..whole.len()).step_by(97).chain(whole.len() - 3..=whole.len());
    for length in lengths {
        place.write("cut.csv", &whole[..length]);
        place.succeed(&arguments);
        assert!(fs::read(place.path("cut.csv")).unwrap() == whole, "cut at byte {length}");
    }
}

/// Rows that are there are taken as they are: changing a digit of one shows that it is not computed
/// again.
#[test]
fn finished_worlds_are_not_run_again() {
    let place = place();
    let whole = reference(&place);
    let lines: Vec<&str> = whole.split_inclusive('\n').collect();
    let marked = lines[4].replacen(",ok,50,", ",ok,51,", 1);
    assert_ne!(marked, lines[4]);
    let begun = [&lines[..4].concat(), marked.as_str(), lines[5]].concat();
    place.write("begun.csv", &begun);
    place.succeed(&sweep("begun.csv", &["--worlds", "23"]));
    let ended = place.read("begun.csv");
    assert_eq!(ended, [&begun, &lines[6..].concat()].map(String::as_str).concat());
}

#[cfg(unix)]
mod killed {
    use super::*;
    use rustix::process::{Pid, Signal, kill_process};
    use std::process::{Child, Stdio};
    use std::time::{Duration, Instant};
    use support::{PATIENCE, wait_for};

    const LONG: [&str; 4] = ["--worlds", "60", "--steps", "40000"];

    fn lines(place: &Place, name: &str) -> usize {
        fs::read_to_string(place.path(name)).map_or(0, |text| text.lines().count())
    }

    /// Starts a sweep and sends the signal when five worlds are in its file.
    fn begun(place: &Place, signal: Signal) -> Child {
        let arguments = sweep("killed.csv", &LONG);
        let child = place.command(&arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        wait_for("five worlds", || lines(place, "killed.csv") >= 7);
        kill_process(Pid::from_child(&child), signal).unwrap();
        child
    }

    fn resumed(place: &Place) {
        let kept = place.read("killed.csv");
        assert!((7..62).contains(&kept.lines().count()), "{} lines", kept.lines().count());
        place.succeed(&sweep("killed.csv", &LONG));
        place.succeed(&sweep("whole.csv", &LONG));
        assert!(place.read("killed.csv") == place.read("whole.csv"));
        let whole_rows = kept.rfind('\n').unwrap();
        assert_eq!(kept[..whole_rows], place.read("whole.csv")[..whole_rows]);
    }

    #[test]
    fn a_killed_sweep_loses_no_finished_world() {
        let place = place();
        begun(&place, Signal::KILL).wait().unwrap();
        resumed(&place);
    }

    #[test]
    fn ctrl_c_ends_with_whole_rows() {
        let place = place();
        let output = begun(&place, Signal::INT).wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(130), "{}", stderr(&output));
        assert!(place.read("killed.csv").ends_with('\n'));
        resumed(&place);
    }

    /// Two programs in one file would mix their rows.
    #[test]
    fn a_file_that_is_being_written_is_refused() {
        let place = place();
        let arguments = sweep("busy.csv", &["--worlds", "1000", "--steps", "1000000"]);
        let mut child = place.command(&arguments).spawn().unwrap();
        wait_for("the first two lines", || lines(&place, "busy.csv") >= 2);
        let mut second = place.command(&arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let started = Instant::now();
        while second.try_wait().unwrap().is_none() && started.elapsed() < PATIENCE {
            std::thread::sleep(Duration::from_millis(2));
        }
        // One that is not refused would not end by itself.
        second.kill().unwrap();
        child.kill().unwrap();
        child.wait().unwrap();
        let output = second.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).contains("busy.csv: another tumble is writing to it"), "{}", stderr(&output));
    }
}

/// The peak of what the program has in memory [bytes], asked for again and again until it ends.
#[cfg(target_os = "linux")]
fn peak_memory(place: &Place, arguments: &[&str]) -> u64 {
    let mut child = place.command(arguments).spawn().unwrap();
    let mut peak = 0;
    while child.try_wait().unwrap().is_none() {
        let status = fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kilobytes = line.and_then(|line| line.trim().strip_suffix(" kB")?.parse::<u64>().ok());
        peak = peak.max(1024 * kilobytes.unwrap_or(0));
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    assert!(child.wait().unwrap().success() && peak > 0);
    peak
}

/// A world of these takes about 13 KB, so 40 000 of them kept would be 500 MB; results that wait
/// for their turn are 8192 rows at most, 4 MB.
#[cfg(target_os = "linux")]
#[test]
fn many_worlds_do_not_need_much_memory() {
    let place = place();
    let peak = peak_memory(&place, &sweep("many.csv", &["--worlds", "40000", "--steps", "2", "--threads", "2"]));
    assert_eq!(place.read("many.csv").lines().count(), 40_002);
    assert!(peak < 64 << 20, "{peak} bytes");
}

#[test]
fn the_file_of_another_sweep_is_refused_and_stays() {
    let place = place();
    let whole = reference(&place);
    place.write("other.json", SCENE.replace("\"mass\": 2", "\"mass\": 3"));
    let with = |more: &[&str]| -> Vec<String> { sweep("reference.csv", more).into_iter().map(str::to_owned).collect() };
    let base = || with(&["--worlds", "23"]);
    let replaced = |at: usize, with: &str| {
        let mut arguments = base();
        arguments[at] = with.to_owned();
        arguments
    };
    let cases = [
        (replaced(3, "8"), "seed: 7 is not 8"),
        (with(&["--worlds", "24"]), "worlds: 23 is not 24"),
        (replaced(8, "bodies.brick.angular_velocity.1=-5..6"), "vary: "),
        (replaced(1, "other.json"), "scene: "),
        (with(&["--worlds", "23", "--steps", "50"]), "steps: none is not 50"),
        (with(&["--worlds", "23", "--duration", "0.5"]), "duration: none is not 0.5"),
        (with(&["--worlds", "23", "--dt", "0.25"]), "dt: none is not 0.25"),
        (with(&["--worlds", "23", "--substeps", "2"]), "substeps: none is not 2"),
        (with(&["--worlds", "23", "--integrator", "runge-kutta4"]), "integrator: none is not"),
        (with(&["--worlds", "23", "--body", "stone"]), "bodies: none is not"),
        (with(&["--worlds", "23", "--shard", "1/2"]), "shard: none is not"),
    ];
    for (arguments, difference) in cases {
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        let wanted = format!("tumble: reference.csv: is the file of another sweep: {difference}");
        let message = place.refused(&arguments, &wanted);
        assert!(message.starts_with(&wanted), "{message}");
        assert_eq!(place.read("reference.csv"), whole);
    }
}

#[test]
fn damaged_and_foreign_files_are_refused_and_stay() {
    let place = place();
    let whole = reference(&place);
    let line = |number: usize| whole.split_inclusive('\n').nth(number - 1).unwrap();
    let cases = [
        ("a,b\n1,2\n".to_owned(), "is not the file of a sweep"),
        ("x".repeat(5000), "is not the file of a sweep"),
        (whole.replace("\"format\":1", "\"format\":2"), "it is of format 2"),
        (whole.replace(line(5), ""), "line 5 is damaged: it is not that of world 2"),
        (whole.replace(line(5), &line(5).replacen(',', "", 1)), "line 5 is damaged"),
        (whole.replace(line(5), &line(5).replace(",ok,", ",ok,,")), "line 5 is damaged: it has not 23 fields"),
        (format!("{whole}23,extra\n"), "there are only 23 worlds"),
    ];
    for (contents, wanted) in cases {
        place.write("damaged.csv", &contents);
        let message = place.refused(&sweep("damaged.csv", &["--worlds", "23"]), wanted);
        assert!(message.starts_with("tumble: damaged.csv: "), "{wanted:?}: {message}");
        assert_eq!(place.read("damaged.csv"), contents);
    }
}

#[test]
fn bad_input_names_the_field_and_writes_nothing() {
    let cases: [(&[&str], &str); 22] = [
        (&["--vary", "bodies.brick.masss=1..2"], "bodies.brick.masss: the body has no such number"),
        (&["--vary", "bodies.wall.mass=1..2"], "bodies.wall.mass: no body is called \"wall\""),
        (&["--vary", "bodies.2.mass=1..2"], "bodies.2.mass: there are 2 bodies"),
        (&["--vary", "gravity.3=1..2"], "gravity.3: the scene has no such number"),
        (&["--vary", "gravity=1..2"], "gravity: the scene has no such number"),
        (
            &["--vary", "bodies.0.mass=-1..2"],
            "body \"brick\" (bodies[0]), field mass: must be positive and finite, not -1",
        ),
        (&["--vary", "bodies.0.shape.half_extents.1=0..1"], "body \"brick\" (bodies[0]), field shape.half_extents"),
        (&["--vary", "bodies.0.mass=1..1e300"], "body \"brick\" (bodies[0]), field mass: "),
        (&["--vary", "dt=0..1"], "field dt: "),
        (&["--vary", "dt=1e-9..1"], "field dt: dt, divided by the substeps, must be from 1e-9 to 1e9 seconds"),
        (&["--vary", "gravity.0=0..1e10"], "field gravity: must be within 1e9 m/s^2"),
        (
            &["--vary", "restitution_threshold=0..1e10"],
            "field restitution_threshold: the restitution threshold must be",
        ),
        (&["--vary", "bodies.1.angular_velocity.0=1..2"], "body \"stone\" (bodies[1]), field angular_velocity"),
        (&["--vary", "bodies.0.mass=2..1"], "bodies.0.mass: 2..1: 2 is more than 1"),
        (&["--vary", "bodies.0.mass=1..x"], "bodies.0.mass: 1..x: \"x\" is not a finite number"),
        (&["--vary", "bodies.0.mass"], "is not FIELD=DISTRIBUTION"),
        (&["--vary", "steps=1..9"], "steps: takes whole numbers"),
        (&["--vary", "dt=0.1..0.2", "--dt", "0.1"], "dt: an option sets it already"),
        (&["--vary", "bodies.0.mass=1..2", "--vary", "bodies.brick.mass=1..2"], "bodies.brick.mass: is varied twice"),
        (&["--body", "wall"], "--body \"wall\": the scene has no body of that name"),
        (&["--shard", "3/2"], "--shard"),
        (&["--plot", "a.svg", "--y", "brick.pw"], "--y \"brick.pw\": there is no such column; there are world, "),
    ];
    let place = place();
    for (more, wanted) in cases {
        let mut arguments = vec!["sweep", "scene.json", "--worlds", "5", "--out", "out.csv"];
        arguments.extend(more);
        place.refused(&arguments, wanted);
    }
    for (arguments, wanted) in [
        (&["sweep", "scene.json", "--out", "out.csv"][..], "--worlds N is missing"),
        (&["sweep", "stress", "--worlds", "2", "--out", "out.csv"], "stress scene cannot be swept"),
        (&["sweep", "gone.json", "--worlds", "2", "--out", "out.csv"], "gone.json: cannot be read"),
        (&["sweep", "scene.json", "--worlds", "2", "--out", "scene.json"], "ends in .csv"),
        (&["sweep", "scene.json", "--worlds", "2", "--out", "gone/out.csv"], "gone/out.csv: "),
        (&["sweep", "scene.json", "--worlds", "0", "--out", "out.csv"], "--worlds"),
        (&["sweep", "scene.json", "--worlds", "2", "--out", "out.csv", "--plot", "a.png"], "ends in .svg"),
        (&["sweep", "scene.json", "--worlds", "2", "--out", "out.csv", "--y", "hash"], "--plot"),
    ] {
        place.refused(arguments, wanted);
    }
}

/// What only some worlds are is no reason to end the sweep: their rows say so.
#[test]
fn impossible_and_infinite_worlds_are_rows() {
    let place = place();
    place.succeed(&[
        "sweep",
        "scene.json",
        "--quiet",
        "--worlds",
        "50",
        "--out",
        "mass.csv",
        "--vary",
        "bodies.1.mass=normal(1,1)",
    ]);
    let records = rows(&place.read("mass.csv"));
    let impossible: Vec<_> = records.iter().filter(|row| &row[2] == "impossible").collect();
    // A normal number is below minus one standard deviation in 16 of 100 cases.
    assert!((1..20).contains(&impossible.len()), "{}", impossible.len());
    assert!(records.iter().all(|row| (row[1].parse::<f64>().unwrap() <= 0.0) == (&row[2] == "impossible")));
    assert!(impossible.iter().all(|row| row.iter().skip(3).all(str::is_empty)));

    // Half g t^2, 1e9 times over, is 8e38 m after these steps, more than single precision can hold.
    let far = SCENE.replace("0.01", "1000000").replace(r#""mass": 1"#, r#""mass": 1, "gravity_scale": 1e9"#);
    place.write("far.json", far);
    let vary = "gravity.0=grid(0,1e9,2)";
    place.succeed(&["sweep", "far.json", "--steps", "40000", "--out", "far.csv", "--vary", vary]);
    let records = rows(&place.read("far.csv"));
    let outcomes: Vec<&str> = records.iter().map(|row| &row[2]).collect();
    if cfg!(feature = "f64") {
        assert_eq!(outcomes, ["ok", "ok"]);
    } else {
        assert_eq!(outcomes, ["ok", "not-finite"]);
        assert!(records[1].iter().skip(3).all(str::is_empty));
    }
}

#[test]
fn merge_takes_all_shards_of_one_sweep_and_nothing_else() {
    let place = place();
    for shard in ["1/3", "2/3", "3/3"] {
        let name = format!("{}.csv", &shard[..1]);
        place.succeed(&sweep(&name, &["--worlds", "10", "--shard", shard]));
    }
    let mut other = sweep("other.csv", &["--worlds", "10", "--shard", "2/3"]);
    other[3] = "8";
    place.succeed(&other);
    place.succeed(&sweep("half.csv", &["--worlds", "10", "--shard", "1/2"]));
    place.succeed(&sweep("whole.csv", &["--worlds", "10"]));
    let second = place.read("2.csv");
    let cut: String = second.split_inclusive('\n').take(4).collect();
    place.write("unfinished.csv", &cut);
    place.write("torn.csv", &second[..second.len() - 5]);
    for (arguments, wanted) in [
        (&["1.csv", "2.csv"][..], "shard 3/3 is missing"),
        (&["1.csv", "3.csv"], "shard 2/3 is missing"),
        (&["2.csv", "3.csv"], "shard 1/3 is missing"),
        (&["1.csv", "2.csv", "2.csv", "3.csv"], "2.csv: is shard 2/3, which is there twice"),
        (&["1.csv", "other.csv", "3.csv"], "other.csv: is of another sweep than 1.csv: seed: 8 is not 7"),
        (&["1.csv", "half.csv", "3.csv"], "and others are of"),
        (&["1.csv", "whole.csv"], "whole.csv: is a whole sweep already"),
        (&["1.csv", "unfinished.csv", "3.csv"], "unfinished.csv: has 2 of its 3 worlds"),
        (&["1.csv", "torn.csv", "3.csv"], "torn.csv: has 2 of its 3 worlds"),
        (&["1.csv", "scene.json", "3.csv"], "scene.json: is not the file of a sweep"),
        (&["1.csv", "gone.csv", "3.csv"], "gone.csv: "),
    ] {
        let mut all = vec!["merge", "out.csv"];
        all.extend(arguments);
        place.refused(&all, wanted);
    }
    place.refused(&["merge", "2.csv", "1.csv", "2.csv", "3.csv"], "2.csv: is a shard itself");
    assert_eq!(place.read("2.csv"), second);
}

#[test]
fn a_plot_has_a_dot_for_every_world() {
    let place = place();
    let dots = |name: &str| place.read(name).matches("<circle").count();
    place.succeed(&sweep("a.csv", &["--worlds", "40", "--plot", "a.svg", "--y", "brick.py"]));
    assert_eq!(dots("a.svg"), 40);
    let svg = place.read("a.svg");
    assert!(svg.contains(">bodies.brick.angular_velocity.1<") && svg.contains(">brick.py<"), "{svg}");
    // Of a finished sweep, another picture; and one of shards, which is the same as that of the
    // whole.
    place.succeed(&sweep("a.csv", &["--worlds", "40", "--plot", "b.svg", "--x", "bodies[1].mass", "--y", "energy"]));
    assert_eq!(dots("b.svg"), 40);
    for shard in ["1/2", "2/2"] {
        place.succeed(&sweep(&format!("s{}.csv", &shard[..1]), &["--worlds", "40", "--shard", shard]));
    }
    place.succeed(&["merge", "m.csv", "s1.csv", "s2.csv", "--plot", "m.svg", "--y", "brick.py"]);
    assert_eq!(dots("m.svg"), 40);
}

#[test]
fn a_report_says_what_was_done() {
    let place = place();
    let whole = reference(&place);
    let begun: String = whole.split_inclusive('\n').take(12).collect();
    place.write("reference.csv", begun);
    let mut arguments = sweep("reference.csv", &["--worlds", "23"]);
    arguments.retain(|argument| *argument != "--quiet");
    let text = place.succeed(&arguments);
    for wanted in ["23 of 23", "finished before      10", "reference.csv"] {
        assert!(text.contains(wanted), "{wanted:?} is not in {text}");
    }
}
