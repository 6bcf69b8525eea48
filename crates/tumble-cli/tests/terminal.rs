//! Nothing that a terminal would obey comes out of the program, whatever is in a file, its name, an
//! option or the environment.
//!
//! A name with an escape sequence can write the clipboard of who looks at the file. It would fail
//! if one string of one format reached standard output or error on a way of its own: every string,
//! key and word of sample files is made hostile by itself, and each file is given to every command
//! that takes it.

use std::path::Path;
use std::process::Output;

use crate::support::Place;
use serde_json::{Value, json};

/// Writes the clipboard, colours, rings, turns letters round, forges lines; C1 and invisible
/// letters too.
const HOSTILE: &str = "\u{1b}]52;c;cm0=\u{7}\u{1b}[31m\r\u{8}\u{7f}\u{9b}2J\u{90}\u{202e}\u{2066}\u{200f}\u{2028}\u{feff}\u{e0041}\ntumble: forged";

/// Whether a terminal would obey it, by the Unicode tables' general categories Cc, Zl, Zp and those
/// of Cf that hide or reorder.
fn is_obeyed(letter: char) -> bool {
    let code = letter as u32;
    let control = code < 0x20 || (0x7f..0xa0).contains(&code);
    let format = [0xad, 0x61c, 0x180e, 0x200b, 0x200e, 0x200f, 0xfeff].contains(&code);
    let ranges = [0x2028..=0x202e, 0x2060..=0x206f, 0xfff9..=0xfffb, 0xe0000..=0xe0fff];
    control || format || ranges.iter().any(|range| range.contains(&code))
}

fn assert_tame(output: &Output, what: &str) {
    for (stream, bytes) in [("stdout", &output.stdout), ("stderr", &output.stderr)] {
        let text = std::str::from_utf8(bytes).unwrap_or("\u{9b} is no text");
        let bad = text.chars().find(|letter| *letter != '\n' && is_obeyed(*letter));
        assert_eq!(bad, None, "{what}: {stream}: {text:?}");
        let forged = text.lines().any(|line| line.starts_with("tumble: forged"));
        assert!(!forged, "{what}: {stream}: a line is forged: {text:?}");
    }
    assert!(output.status.code().is_some_and(|code| code <= 2), "{what}: {:?}", output.status);
}

/// Every command that takes a scene, on this file.
fn all_commands(place: &Place, file: &str, what: &str) {
    let commands: [&[&str]; 5] = [
        &["inspect", file],
        &["inspect", file, "--json"],
        &["run", file, "--steps", "1"],
        &["run", file, "--steps", "1", "--record", "record.csv", "--report", "report"],
        &["sweep", file, "--out", "sweep.csv", "--worlds", "1", "--steps", "1", "--vary", "bodies.0.mass=1..2"],
    ];
    for arguments in commands {
        assert_tame(&place.run(arguments), &format!("{what}: {arguments:?}"));
        for name in ["record.csv", "sweep.csv"] {
            drop(std::fs::remove_file(place.path(name)));
        }
    }
}

/// All copies of a document with one string or key made hostile, and one with all of them.
fn hostile_copies(document: &Value) -> Vec<Value> {
    let mut copies = Vec::new();
    let mut at = 0;
    loop {
        let (mut copy, mut left) = (document.clone(), at);
        if !make_hostile(&mut copy, &mut left) {
            break;
        }
        copies.push(copy);
        at += 1;
    }
    let mut all = document.clone();
    make_all_hostile(&mut all);
    copies.push(all);
    copies
}

/// Makes the string or key hostile at this index; false if there is none.
fn make_hostile(value: &mut Value, left: &mut usize) -> bool {
    match value {
        // Data of a buffer are tested as a whole elsewhere, not letter by letter.
        Value::String(text) if !text.starts_with("data:") => {
            let here = *left == 0;
            *left = left.wrapping_sub(1);
            if here {
                text.push_str(HOSTILE);
            }
            here
        }
        Value::Array(values) => values.iter_mut().any(|value| make_hostile(value, left)),
        Value::Object(map) => {
            for key in map.keys().cloned().collect::<Vec<_>>() {
                if *left == 0 {
                    let value = map.remove(&key).unwrap();
                    map.insert(format!("{key}{HOSTILE}"), value);
                    return true;
                }
                *left -= 1;
                if make_hostile(map.get_mut(&key).unwrap(), left) {
                    return true;
                }
            }
            false
        }
        _ => false,
    }
}

fn make_all_hostile(value: &mut Value) {
    match value {
        Value::String(text) if !text.starts_with("data:") => text.push_str(HOSTILE),
        Value::Array(values) => values.iter_mut().for_each(make_all_hostile),
        Value::Object(map) => map.values_mut().for_each(make_all_hostile),
        _ => {}
    }
}

/// A scene with everything that has a name, and a mistake or none.
fn scene() -> Value {
    json!({
        "name": "scene", "description": "for people", "source": "hand", "integrator": "moser-veselov",
        "bodies": [
            { "name": "ground", "shape": { "half_space": {} }, "fixed": true, "collider": {} },
            { "name": "a", "mass": 1, "shape": { "cuboid": { "half_extents": [1, 1, 1] } },
              "forces": [ { "spring": { "to": "b", "stiffness": 1 } }, { "constant_wrench": { "force": [1, 0, 0], "frame": "body" } } ] },
            { "name": "b", "mass": 1, "shape": { "compound": { "parts": [ { "shape": "point", "mass": 1 } ] } } },
            { "name": "part", "mass": 1, "shape": { "mesh": { "file": "missing.obj" } } },
        ]
    })
}

#[test]
fn names_and_keys_of_scenes() {
    let place = Place::new();
    let whole = scene();
    let mut readable = whole.clone();
    readable["bodies"].as_array_mut().unwrap().truncate(3);
    readable["bodies"][2].as_object_mut().unwrap().remove("mass");
    let mut broken = readable.clone();
    broken["bodies"][1]["mass"] = json!(-1);
    for (kind, document) in [("whole", whole), ("readable", readable), ("broken", broken)] {
        for (at, copy) in hostile_copies(&document).iter().enumerate() {
            place.write("scene.json", serde_json::to_string(copy).unwrap());
            all_commands(&place, "scene.json", &format!("{kind} {at}"));
        }
    }
}

#[test]
fn names_and_keys_of_gltf() {
    let place = Place::new();
    let samples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tumble-scene/tests/gltf_scenes");
    for sample in ["everything.gltf", "omi.gltf"] {
        let document = serde_json::from_str(&std::fs::read_to_string(samples.join(sample)).unwrap()).unwrap();
        // Each string alone would be a minute: a copy with all strings, and every seventh of the
        // others.
        let copies = hostile_copies(&document);
        for (at, copy) in copies.iter().enumerate().filter(|(at, _)| at % 7 == 0 || at + 1 == copies.len()) {
            place.write("scene.gltf", serde_json::to_string(copy).unwrap());
            all_commands(&place, "scene.gltf", &format!("{sample} {at}"));
        }
    }
}

/// Control characters as XML can have them, and as it cannot.
#[test]
fn words_of_robots_surfaces_and_ron() {
    let place = Place::new();
    let robot = r#"<robot name="two">
        <link name="base"><inertial><mass value="2"/><inertia ixx="0.02" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.04"/></inertial>
            <collision><geometry><mesh filename="part.stl"/></geometry></collision></link>
        <link name="tip"><inertial><mass value="0"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
        <joint name="wrist" type="revolute"><parent link="base"/><child link="tip"/></joint> </robot>"#;
    let surface = "o part\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\nl 1 2\n";
    let solid = "solid part\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid part\n";
    let ron = r#"(name: "scene", bodies: [(name: "a", mass: 1, shape: mesh(file: "missing.obj"))])"#;
    let escaped = "\u{9b}2J&#x9b;31m&#xa;tumble: forged&#x202e;\u{feff}\u{e0041}&#x7f;";
    for (file, text) in [("two.urdf", robot), ("part.obj", surface), ("part.stl", solid), ("scene.ron", ron)] {
        let is_word = |at: &usize| {
            let (before, after) = text.split_at(*at);
            before.ends_with(|letter: char| letter.is_alphanumeric())
                && !after.starts_with(|letter: char| letter.is_alphanumeric())
        };
        for at in (1..text.len()).filter(is_word) {
            let (before, after) = text.split_at(at);
            for hostile in [HOSTILE, escaped] {
                place.write(file, format!("{before}{hostile}{after}"));
                for command in ["inspect", "run"] {
                    let output = place.run(&[command, file]);
                    assert_tame(&output, &format!("{command} {file} at {at}"));
                }
            }
        }
    }
}

/// Arguments, names of files that are there and that are not, directories, and the environment.
#[test]
fn command_lines_and_names_of_files() {
    let place = Place::new();
    let named = |name: &str| format!("{}{name}", HOSTILE.replace('/', ""));
    let (scene, part, broken) = (named("scene.json"), named("part.obj"), named("broken.json"));
    place.write(&scene, r#"{ "bodies": [ { "name": "a", "mass": 1 } ] }"#);
    place.write(&part, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    place.write(&broken, r#"{ "bodies": [ { "name": "a", "mass": -1 } ] }"#);
    let (csv, svg, sub) = (named(".csv"), named(".svg"), named("/no/where.csv"));
    let (option, vary, missing) = (named("--such"), format!("bodies.{HOSTILE}.mass=1..2"), named("missing.json"));
    let sweep = ["sweep", &scene, "--steps", "1", "--out"];
    let commands: Vec<Vec<&str>> = vec![
        vec![HOSTILE],
        vec!["run", &option],
        vec!["run", HOSTILE],
        vec!["run", &missing],
        vec!["run", &broken],
        vec!["run", "iss", "--steps", HOSTILE],
        vec!["run", "iss", "--integrator", HOSTILE],
        vec!["run", &scene, "--steps", "1", "--record", &csv],
        vec!["run", &scene, "--steps", "1", "--record", HOSTILE],
        vec!["run", &scene, "--steps", "1", "--record", &sub],
        vec!["run", &scene, "--steps", "1", "--report", HOSTILE],
        vec!["run", &scene, "--steps", "1", "--report", &part],
        vec!["inspect", &scene, "--body", HOSTILE],
        vec!["inspect", &scene, "--draw", &svg],
        vec!["inspect", &scene, "--draw", &sub],
        vec!["inspect", &part],
        vec!["inspect", &part, "--repair", "--json"],
        vec!["inspect", "iss", "--density", HOSTILE],
        vec!["inspect", &broken],
        [&sweep[..], &[&csv, "--vary", "bodies.0.mass=1..2", "--worlds", "2"]].concat(),
        [&sweep[..], &[&csv, "--vary", "bodies.0.mass=1..3", "--worlds", "2"]].concat(),
        [&sweep[..], &["a.csv", "--vary", &vary, "--worlds", "2"]].concat(),
        [&sweep[..], &["a.csv", "--vary", HOSTILE]].concat(),
        [&sweep[..], &["a.csv", "--worlds", "1", "--body", HOSTILE]].concat(),
        [&sweep[..], &["a.csv", "--worlds", "1", "--plot", &svg, "--x", HOSTILE]].concat(),
        [&sweep[..], &["a.csv", "--worlds", "1", "--shard", HOSTILE]].concat(),
        vec!["merge", &csv, &csv],
        vec!["merge", "b.csv", &csv],
        vec!["merge", "b.csv", &missing, &scene],
        vec!["merge", HOSTILE, &csv],
    ];
    for arguments in commands {
        assert_tame(&place.run(&arguments), &format!("{arguments:?}"));
    }
    let output = place.command(&["run", "iss", "--steps", "1"]).env("TUMBLE_SIMD", HOSTILE).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert_tame(&output, "TUMBLE_SIMD");
    for first in [
        format!("# tumble sweep {{\"{HOSTILE}\": 1}}\nworld\n"),
        format!("# tumble sweep {}\nworld{HOSTILE}\n", HOSTILE.replace('\n', "")),
    ] {
        place.write("sweep.csv", first);
        assert_tame(&place.run(&["merge", "b.csv", "sweep.csv"]), "the identity of a sweep");
    }
}

/// JSON has the same name in it, in other letters.
#[test]
fn json_reads_back_to_the_same_name() {
    let place = Place::new();
    place.write("scene.json", serde_json::to_string(&json!({ "bodies": [ { "name": HOSTILE, "mass": 1 } ] })).unwrap());
    let output = place.run(&["inspect", "scene.json", "--json"]);
    assert_tame(&output, "--json");
    let audit: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(audit["bodies"][0]["name"], HOSTILE);
}

/// One place writes to each stream, so that a new message cannot forget to be escaped.
#[test]
fn nothing_else_writes_to_a_stream() {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let writers = ["tumble-cli/src/print.rs", "tumble-view/src/main.rs"];
    let members = [
        "tumble-math",
        "tumble-collide",
        "tumble",
        "tumble-import",
        "tumble-scene",
        "tumble-record",
        "tumble-sweep",
        "tumble-vehicle",
        "tumble-character",
        "tumble-cli",
        "tumble-view",
    ];
    let mut open = members.map(|name| crates.join(name).join("src")).to_vec();
    let mut seen = 0;
    while let Some(path) = open.pop() {
        if path.is_dir() {
            open.extend(std::fs::read_dir(&path).unwrap().map(|entry| entry.unwrap().path()));
            continue;
        }
        if path.extension().is_none_or(|ending| ending != "rs") || writers.iter().any(|writer| path.ends_with(writer)) {
            continue;
        }
        seen += 1;
        let text = std::fs::read_to_string(&path).unwrap();
        let code = text.split("#[cfg(test)]").next().unwrap();
        for (number, line) in code.lines().enumerate().filter(|(_, line)| !line.trim_start().starts_with("//")) {
            let line = line.replace("stderr().is_terminal()", "").replace("use_stderr()", "");
            for writer in ["print!(", "println!(", "stdout()", "stderr()", "dbg!("] {
                assert!(!line.contains(writer), "{}:{}: {writer}", path.display(), number + 1);
            }
        }
    }
    assert!(seen > 100, "{seen} files");
}
