//! No output takes the place of an input, nor, without `--force`, of a file that this program did
//! not write; what a run leaves is whole or nothing.
//!
//! A slip of a name costs a scene or somebody's table. It would fail if one output of one command
//! forgot to look, if a report were half there after a full disk, or if what a killed run left
//! stayed for ever.

use crate::support;

use std::process::Output;

use support::{Place, stderr};

const SCENE: &str = r#"{ "bodies": [ { "name": "a", "mass": 1, "shape": { "mesh": { "file": "part.glb" } } } ] }"#;

/// An animation of this program, which is a good mesh too: a file that only its use tells from an
/// output.
fn place_with_scene() -> Place {
    let place = Place::new();
    place.write("box.json", r#"{ "bodies": [ { "mass": 1, "shape": { "cuboid": { "half_extents": [1, 1, 1] } } } ] }"#);
    place.succeed(&["run", "box.json", "--steps", "1", "--quiet", "--record", "part.glb"]);
    place.write("scene.json", SCENE);
    place
}

/// Every output of every command, with the name that is put into the place of `{}`.
const OUTPUTS: [(&[&str], &str); 7] = [
    (&["run", "scene.json", "--steps", "1", "--quiet", "--record", "{}.csv"], "{}.csv"),
    (&["run", "scene.json", "--steps", "1", "--quiet", "--record", "{}.glb"], "{}.glb"),
    (&["run", "scene.json", "--steps", "1", "--quiet", "--report", "{}"], "{}/summary.json"),
    (&["run", "scene.json", "--steps", "1", "--quiet", "--report", "{}"], "{}/report.html"),
    (&["run", "scene.json", "--steps", "1", "--quiet", "--report", "{}"], "{}/ledger.csv"),
    (&["inspect", "scene.json", "--draw", "{}.svg"], "{}.svg"),
    (
        &["sweep", "scene.json", "--quiet", "--steps", "1", "--worlds", "2", "--out", "s.csv", "--plot", "{}.svg"],
        "{}.svg",
    ),
];

fn run(place: &Place, arguments: &[&str], name: &str, more: &[&str]) -> Output {
    let arguments: Vec<String> = arguments.iter().map(|argument| argument.replace("{}", name)).collect();
    place.run(&[&arguments.iter().map(String::as_str).collect::<Vec<_>>()[..], more].concat())
}

#[test]
fn a_foreign_file_is_replaced_by_force_only_and_our_own_always() {
    for (arguments, output) in OUTPUTS {
        let place = place_with_scene();
        let file = output.replace("{}", "out");
        // As any of the formats could begin, but of somebody else.
        for foreign in [
            "time,x\n0,1\n",
            "<svg xmlns=\"http://www.w3.org/2000/svg\"/>",
            "{ \"bodies\": 3 }",
            "glTF\u{2}",
            "<!DOCTYPE html>",
        ] {
            if let Some(parent) = place.path(&file).parent() {
                std::fs::create_dir_all(parent).unwrap();
            }
            place.write(&file, foreign);
            let refused = run(&place, arguments, "out", &[]);
            assert_eq!(refused.status.code(), Some(2), "{arguments:?}: {}", stderr(&refused));
            assert!(stderr(&refused).contains("--force replaces it"), "{}", stderr(&refused));
            assert_eq!(place.read(&file), foreign);
        }
        for more in [&["--force"][..], &[], &[]] {
            let done = run(&place, arguments, "out", more);
            assert_eq!(done.status.code(), Some(0), "{arguments:?}: {}", stderr(&done));
        }
        assert!(std::fs::metadata(place.path(&file)).unwrap().len() > 100, "{file}");
    }
}

/// By its name, by another spelling of it, and by both kinds of links; the scene's own file and
/// what it names.
#[cfg(unix)]
#[test]
fn an_input_is_never_replaced() {
    for input in ["scene.json", "part.glb"] {
        for (arguments, output) in OUTPUTS {
            let file = output.replace("{}", "link");
            for hard in [false, true] {
                let place = place_with_scene();
                let before = std::fs::read(place.path(input)).unwrap();
                std::fs::create_dir_all(place.path(&file).parent().unwrap()).unwrap();
                if hard {
                    std::fs::hard_link(place.path(input), place.path(&file)).unwrap();
                } else {
                    std::os::unix::fs::symlink(place.path(input), place.path(&file)).unwrap();
                }
                let refused = run(&place, arguments, "link", &["--force"]);
                assert_eq!(refused.status.code(), Some(2), "{arguments:?}: {}", stderr(&refused));
                assert!(stderr(&refused).contains("it cannot be"), "{}", stderr(&refused));
                assert_eq!(std::fs::read(place.path(input)).unwrap(), before);
                assert_eq!(std::fs::read(place.path(&file)).unwrap(), before);
            }
        }
    }
    let place = place_with_scene();
    place.refused(&["run", "scene.json", "--record", "./part.glb", "--force"], "is a file of the scene");
    place.refused(
        &["run", "scene.json", "--report", "report", "--record", "report/ledger.csv"],
        "is a file of the report",
    );
}

#[test]
fn a_drawing_has_its_ending() {
    let place = place_with_scene();
    let before = place.read("scene.json");
    for name in ["scene.json", "drawing", "drawing.svg.txt", "part.glb"] {
        place.refused(&["inspect", "scene.json", "--draw", name, "--force"], "the name of a drawing ends in .svg");
    }
    assert_eq!(place.read("scene.json"), before);
}

/// What a run that was killed left of a record, also where it was killed within the first line.
#[test]
fn a_torn_record_of_ours_is_replaced() {
    let place = Place::new();
    for torn in ["", "step,ti", "step,time,body,px,py,pz,qx,qy,qz,qw,vx,vy,vz,wx,wy,wz\n0,0.0,bo"] {
        place.write("run.partial.csv", torn);
        place.succeed(&["run", "mujoco-box", "--steps", "1", "--quiet", "--record", "run.csv"]);
        assert_eq!(place.entries(), ["run.csv"]);
    }
    place.write("run.partial.csv", "step,time of somebody else\n");
    place.refused(&["run", "mujoco-box", "--steps", "1", "--record", "run.csv"], "--force replaces it");
}

/// The page is the largest file of a report: with less room than it takes, the others would fit.
#[cfg(unix)]
#[test]
fn a_full_disk_leaves_nothing_of_a_report() {
    let whole = Place::new();
    whole.succeed(&["run", "t-handle", "--steps", "20", "--quiet", "--report", "report"]);
    let size = |name: &str| std::fs::metadata(whole.path("report").join(name)).unwrap().len();
    let page = size("report.html");
    for other in ["summary.json", "ledger.csv", "energy.svg", "drift.svg"] {
        // Units are of 512 bytes at least, so half of the page is enough for it in either unit.
        assert!(4 * size(other) < page, "{other}");
    }
    let units = u32::try_from(page / 2048).unwrap();
    let arguments = "run t-handle --steps 20 --quiet --report report --record out.csv";
    Place::new().fills_the_disk(units, arguments, "report/report.html: writing failed");
}

/// Killed, so that nothing of it could tidy up.
#[cfg(unix)]
#[test]
fn the_next_run_removes_what_a_killed_one_left() {
    use rustix::process::{Pid, Signal, kill_process};
    let place = Place::new();
    let run = ["run", "--bodies", "10", "--steps", "1000000000", "--quiet", "--report", "report"];
    let hidden = || -> Vec<String> {
        let entries = std::fs::read_dir(place.path("report")).into_iter().flatten();
        let names = entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned());
        names.filter(|name| name.ends_with(".part")).collect()
    };
    let mut first = place.command(&run).spawn().unwrap();
    support::wait_for("unfinished files", || hidden().len() == 5);
    kill_process(Pid::from_child(&first), Signal::KILL).unwrap();
    first.wait().unwrap();
    assert_eq!(hidden().len(), 5);
    // One that is still writing keeps its own, and loses none to the next.
    let mut second = place.command(&run).spawn().unwrap();
    let of_second = format!(".{}-", second.id());
    support::wait_for("files of the second", || hidden().iter().filter(|name| name.contains(&of_second)).count() == 5);
    assert_eq!(hidden().len(), 5);
    place.succeed(&["run", "mujoco-box", "--steps", "2", "--quiet", "--report", "report"]);
    assert_eq!(hidden().len(), 5);
    kill_process(Pid::from_child(&second), Signal::KILL).unwrap();
    second.wait().unwrap();
    place.succeed(&["run", "mujoco-box", "--steps", "2", "--quiet", "--report", "report"]);
    assert!(hidden().is_empty(), "{:?}", hidden());
}

/// Names that a spreadsheet would compute, in every table that has names; the rule gives each of
/// them back.
#[test]
fn names_in_tables_are_no_formulas_and_are_read_back() {
    let place = Place::new();
    let names =
        ["=1+1", "+1", "-1+cmd|' /C calc'!A0", "@SUM(A1)", "'quoted", "''twice", "=a,b\"c", "\u{ff1d}1", "-5", "plain"];
    let bodies: Vec<_> = names.iter().map(|name| serde_json::json!({ "name": name, "mass": 1 })).collect();
    place.write("scene.json", serde_json::json!({ "bodies": bodies }).to_string());
    place.succeed(&["run", "scene.json", "--steps", "0", "--quiet", "--record", "run.csv"]);
    let unescaped = |cell: &str| cell.strip_prefix('\'').unwrap_or(cell).to_owned();
    let begins_a_formula = |cell: &str| cell.starts_with(['=', '+', '-', '@', '\t', '\r', '\u{ff1d}']);
    let record = place.record("run.csv");
    let cells: Vec<&str> = record.iter().map(|row| &row[2]).collect();
    assert!(!cells.iter().any(|cell| begins_a_formula(cell)), "{cells:?}");
    assert_eq!(cells.iter().map(|cell| unescaped(cell)).collect::<Vec<_>>(), names);
    let mut sweep = vec!["sweep", "scene.json", "--quiet", "--steps", "1", "--worlds", "2", "--out", "sweep.csv"];
    let named: Vec<String> = names.iter().map(|name| format!("--body={name}")).collect();
    sweep.extend(named.iter().map(String::as_str));
    sweep.extend(["--plot", "plot.svg", "--y", "=1+1.py"]);
    place.succeed(&sweep);
    let text = place.read("sweep.csv");
    let (_, table) = text.split_once('\n').unwrap();
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    let columns = reader.headers().unwrap().clone();
    assert!(!columns.iter().any(begins_a_formula), "{columns:?}");
    for name in names {
        assert!(columns.iter().any(|column| unescaped(column) == format!("{name}.px")), "{name}: {columns:?}");
    }
    // It is gone on with, and drawn by the name as the table has it.
    place.succeed(&sweep);
    assert_eq!(place.read("sweep.csv"), text);
}
