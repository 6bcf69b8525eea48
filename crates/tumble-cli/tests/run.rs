//! `tumble run` does what its options say, and its files are the contract.
//!
//! Scripts and notebooks read these files. It would fail if a key, a column or a rule for steps
//! changed.

use crate::support;

use support::Place;

const SCENE: &str = r#"{ "gravity": [0, -9.81, 0], "dt": 0.01, "steps": 100, "integrator": "runge-kutta4",
  "bodies": [
    { "name": "brick", "shape": { "cuboid": { "half_extents": [0.1, 0.05, 0.03] } }, "mass": 2.0,
      "orientation": [0, 0, 0.6, 0.8], "linear_velocity": [1, 2, 3], "angular_velocity": [1, 5, 0.1],
      "forces": [ { "damping": { "linear": 0.1, "angular": 0.2 } } ] },
    { "shape": { "cone": { "radius": 1, "half_height": 0.5 } }, "density": 10, "gravity_scale": 0.5 },
    { "name": "floor", "fixed": true, "position": [0, -1, 0] },
    { "name": "belt", "kinematic": true, "linear_velocity": [0, 1, 0] } ] }"#;

const SAME_IN_RON: &str = r#"Scene( gravity: (0, -9.81, 0), dt: 0.01, steps: 100, integrator: "runge-kutta4",
  bodies: [
    ( name: "brick", shape: cuboid(half_extents: (0.1, 0.05, 0.03)), mass: 2.0,
      orientation: (0, 0, 0.6, 0.8), linear_velocity: [1, 2, 3], angular_velocity: (1, 5, 0.1),
      forces: [ damping(linear: 0.1, angular: 0.2) ] ),
    ( shape: cone(radius: 1, half_height: 0.5), density: 10, gravity_scale: 0.5 ),
    ( name: "floor", fixed: true, position: (0, -1, 0) ),
    ( name: "belt", kinematic: true, linear_velocity: (0, 1, 0) ), ] )"#;

#[test]
fn json_and_ron_give_the_same_hash() {
    let place = Place::new();
    place.write("scene.json", SCENE);
    place.write("scene.ron", SAME_IN_RON);
    assert_eq!(place.hash(&["run", "scene.json"]), place.hash(&["run", "scene.ron"]));
}

#[test]
fn the_number_of_threads_does_not_change_a_bit() {
    let place = Place::new();
    let hash = |threads: &str| place.hash(&["run", "--bodies", "5000", "--steps", "60", "--threads", threads]);
    let one = hash("1");
    assert_eq!(one, hash("2"));
    assert_eq!(one, hash("7"));
}

#[test]
fn a_seed_makes_another_scene_and_the_default_seed_is_zero() {
    let place = Place::new();
    let hash = |seed: &[&str]| place.hash(&[&["run", "stress", "--bodies", "50", "--steps", "5"], seed].concat());
    assert_eq!(hash(&[]), hash(&["--seed", "0"]));
    assert_ne!(hash(&[]), hash(&["--seed", "1"]));
}

#[test]
fn the_summary_has_exactly_the_keys_in_order() {
    let place = Place::new();
    place.write("scene.json", SCENE);
    place.succeed(&["run", "scene.json", "--report", "report", "--threads", "2", "--substeps", "3"]);
    let text = place.read("report/summary.json");
    let keys: Vec<&str> =
        text.lines().filter_map(|line| line.strip_prefix("  \"").and_then(|rest| rest.split('"').next())).collect();
    assert_eq!(
        keys,
        [
            "bodies",
            "worlds",
            "steps",
            "dt",
            "substeps",
            "integrator",
            "precision",
            "threads",
            "simd",
            "wall_seconds",
            "step_seconds",
            "body_steps_per_second",
            "energy",
            "linear_momentum",
            "angular_momentum",
            "state_hash",
        ]
    );
    let summary = place.summary();
    assert_eq!(summary["bodies"], 4);
    assert_eq!(summary["worlds"], 1);
    assert_eq!(summary["steps"], 100);
    assert_eq!(summary["dt"], 0.01);
    assert_eq!(summary["substeps"], 3);
    assert_eq!(summary["integrator"], "runge-kutta4");
    assert_eq!(summary["threads"], 2);
    assert_eq!(summary["precision"], tumble::math::PRECISION);
    let rate = 400.0 / summary["step_seconds"].as_f64().unwrap();
    assert!((summary["body_steps_per_second"].as_f64().unwrap() / rate - 1.0).abs() < 1e-12);
    let hash = summary["state_hash"].as_str().unwrap();
    assert!(hash.len() == 16 && hash.bytes().all(|byte| byte.is_ascii_hexdigit()));
    for (quantity, parts) in [("energy", 1), ("linear_momentum", 3), ("angular_momentum", 3)] {
        let keys: Vec<&String> = summary[quantity].as_object().unwrap().keys().collect();
        assert_eq!(keys.len(), 3, "{keys:?}");
        assert!(summary[quantity]["max_relative_drift"].as_f64().unwrap() >= 0.0);
        for end in ["initial", "final"] {
            let value = &summary[quantity][end];
            assert_eq!(value.as_array().map_or(1, Vec::len), parts);
            assert!(value.is_number() || value.as_array().unwrap().iter().all(serde_json::Value::is_number));
        }
    }
    assert_eq!(place.entries(), ["report", "scene.json"]);
}

/// The last row of the report's ledger, by column.
fn last_of_ledger(place: &Place) -> (Vec<String>, std::collections::HashMap<String, f64>) {
    let mut reader = csv::Reader::from_path(place.path("report/ledger.csv")).unwrap();
    let columns: Vec<String> = reader.headers().unwrap().iter().map(str::to_owned).collect();
    let last = reader.records().last().unwrap().unwrap();
    let numbers = columns.iter().cloned().zip(last.iter().map(|number| number.parse().unwrap())).collect();
    (columns, numbers)
}

#[test]
fn the_ledger_has_a_column_for_each_kind_of_force_that_worked() {
    let place = Place::new();
    let common = "step time linear_kinetic rotational_kinetic potential force_potential energy px py pz lx ly lz";
    let works = "work_gravity work_applied work_damping work_contacts work_joints work_sleep work_integrator";
    place.write("scene.json", SCENE);
    place.succeed(&["run", "scene.json", "--report", "report"]);
    assert_eq!(last_of_ledger(&place).0.join(" "), format!("{common} {works}"));
    place.succeed(&["run", "satellite", "--report", "report"]);
    let (columns, last) = last_of_ledger(&place);
    let forces = "work_thruster work_point_gravity work_angular_velocity_servo";
    assert_eq!(columns.join(" "), format!("{common} {works} {forces}"));
    let sum = |names: &str| names.split(' ').map(|name| last[name]).sum::<f64>();
    // Both are sums of the same few numbers of a few joules in double precision.
    assert!((sum("linear_kinetic rotational_kinetic potential force_potential") - last["energy"]).abs() < 1e-12);
    // Where a force without potential acts the drift of energy is what it did; the integrator's own
    // part is in the works too.
    let drift = place.summary()["energy"]["max_relative_drift"].as_f64().unwrap();
    assert!(drift > 0.1, "{drift}");
    let (energy, potential) = (place.read("report/energy.svg"), ">potential of forces<");
    assert!(energy.contains(potential) && !energy.contains(">potential<"), "its gravity is none");
    place.succeed(&["run", "scene.json", "--report", "report"]);
    assert!(!place.read("report/energy.svg").contains(potential));
    // Long runs have no works, but the potential.
    place.succeed(&["run", "satellite", "--steps", "1000001", "--report", "report", "--quiet"]);
    assert_eq!(last_of_ledger(&place).0.join(" "), common);
}

/// A motor of 2 N m brings a wheel of `m r^2/2` = 0.225 kg m^2 to 10 rad/s in 1.125 s.
#[test]
fn the_ledger_has_the_work_of_joints() {
    let place = Place::new();
    place.write(
        "wheel.json",
        r#"{ "gravity": [0, 0, 0], "steps": 120, "bodies": [ { "name": "base", "fixed": true },
            { "name": "wheel", "shape": { "cylinder": { "radius": 0.3, "half_height": 0.1 } }, "mass": 5 } ],
          "joints": [ { "between": ["base", "wheel"], "hinge": { "at": [0, 0, 0], "axis": [0, 1, 0] },
            "drives": [ { "axes": ["angular_x"], "velocity": 10, "max_force": 2 } ] } ] }"#,
    );
    place.succeed(&["run", "wheel.json", "--report", "report"]);
    let last = last_of_ledger(&place).1;
    let energy = 0.5 * 0.225 * 100.0;
    // Sums of single precision's momenta, of 2 N m s.
    assert!((last["work_joints"] - energy).abs() < 1e-4, "{}", last["work_joints"]);
    assert!((last["rotational_kinetic"] - energy).abs() < 1e-4, "{}", last["rotational_kinetic"]);
}

#[test]
fn the_drift_of_energy_counts_the_potentials_of_forces() {
    let place = Place::new();
    place.succeed(&["run", "raft", "--report", "report"]);
    let drift = place.summary()["energy"]["max_relative_drift"].as_f64().unwrap();
    // Springs and water take up as much as there is; left out, the drift would be near one.
    assert!(drift < 0.01, "{drift}");
}

#[test]
fn the_record_has_the_columns_and_starts_with_the_scene() {
    let place = Place::new();
    place.write("scene.json", SCENE);
    place.succeed(&["run", "scene.json", "--record", "out.csv", "--every", "30", "--quiet"]);
    let text = place.read("out.csv");
    assert_eq!(text.lines().next(), Some("step,time,body,px,py,pz,qx,qy,qz,qw,vx,vy,vz,wx,wy,wz"));
    let record = place.record("out.csv");
    let steps: Vec<&str> = record.iter().step_by(4).map(|line| &line[0]).collect();
    assert_eq!(steps, ["0", "30", "60", "90"]);
    let bodies: Vec<&str> = record.iter().take(4).map(|line| &line[2]).collect();
    assert_eq!(bodies, ["brick", "body-1", "floor", "belt"]);
    let brick: Vec<tumble::math::Real> = record[0].iter().skip(3).map(|field| field.parse().unwrap()).collect();
    assert_eq!(brick[..3], [0.0, 0.0, 0.0]);
    // Velocities went through momentum and back: a few roundings of f32.
    for (velocity, given) in brick[7..].iter().zip([1.0, 2.0, 3.0, 1.0, 5.0, 0.1]) {
        assert!((velocity - given).abs() < 5e-6, "{velocity} is not {given}");
    }
    // The record is at the centre of mass, half a half height below the middle of the cone.
    assert_eq!(record[1][4].parse(), Ok(-0.25));
    // A kinematic body is where it was prescribed to be: 0.9 s at 1 m/s.
    let belt: f64 = record.last().unwrap()[4].parse().unwrap();
    // Ninety additions of 0.01 in f32.
    assert!((belt - 0.9).abs() < 1e-5, "{belt}");
    assert_eq!(place.entries(), ["out.csv", "scene.json"]);
}

#[test]
fn a_record_of_the_last_step_is_the_hashed_state() {
    // Two runs, one recording: writing must not disturb the simulation.
    let place = Place::new();
    let stress = ["run", "--bodies", "20", "--steps", "10"];
    let plain = place.hash(&stress);
    let recorded = place.hash(&[&stress[..], &["--record", "out.csv"]].concat());
    assert_eq!(plain, recorded);
    assert_eq!(place.record("out.csv").len(), 11 * 20);
}

#[test]
fn quiet_prints_nothing() {
    let output = Place::new().run(&["run", "mujoco-box", "--quiet"]);
    assert_eq!(output.status.code(), Some(0));
    assert!(output.stdout.is_empty() && output.stderr.is_empty());
}

#[test]
fn a_pipe_gets_the_table_and_no_progress_bar() {
    let output = Place::new().run(&["run", "--bodies", "100", "--steps", "10"]);
    assert!(output.stderr.is_empty(), "{}", support::stderr(&output));
    let table = String::from_utf8(output.stdout).unwrap();
    for row in [
        "bodies ",
        "steps ",
        "simulated time ",
        "wall time ",
        "accumulate_forces ",
        "integrate ",
        "update_derived ",
        "body-steps per second ",
        "kinetic energy ",
        "potential energy ",
        "momentum ",
        "ang. mom. ",
        "largest drift",
        "state hash ",
    ] {
        assert!(table.contains(row), "{row} is not in\n{table}");
    }
    assert!(!table.contains('\u{1b}'));
}

/// Of bodies that came into sensors and left them, in scenes that have sensors.
#[test]
fn the_table_counts_the_events_of_sensors() {
    let table = |scene: &str| {
        let output = Place::new().run(&["run", scene]);
        String::from_utf8(output.stdout).unwrap()
    };
    let counted = table("firing-range");
    let row = counted.lines().find_map(|line| line.strip_prefix("sensor events ")).unwrap();
    let counts: Vec<u32> = row.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    // Two passages of the shot, one of the miss, and four parcels, none of which stays.
    assert!(counts[0] >= 7 && counts[1] == counts[0], "{row}");
    assert!(!table("mujoco-box").contains("sensor events"));
}

#[test]
fn no_arguments_say_in_words_what_the_stress_scene_did() {
    let place = Place::new();
    let words = place.succeed(&[]);
    for part in ["10 000 boxes", "for 10 s", &place.hash(&["run", "stress"]), "-p tumble-view -- wall", "scenes"] {
        assert!(words.contains(part), "{part}: {words}");
    }
    assert!(words.lines().count() <= 24 && words.lines().all(|line| line.len() <= 100), "{words}");
}

/// The drift is that of what nothing changes: not of the energy where bodies touch, nor of momentum
/// under gravity.
#[test]
fn the_table_has_drifts_of_what_is_kept() {
    let drifts = |scene: &str| -> Vec<String> {
        let table = Place::new().succeed(&["run", scene, "--steps", "20"]);
        // Of a label, and start, end and drift.
        let with_drift = |line: &&str| {
            line.split_whitespace().filter(|word| word.contains('e') && word.parse::<f64>().is_ok()).count() == 3
        };
        table.lines().filter(with_drift).map(|line| line.split(" [").next().unwrap().to_owned()).collect()
    };
    assert_eq!(drifts("t-handle"), ["energy", "momentum", "ang. mom."]);
    assert_eq!(drifts("stress"), ["energy"]);
    assert_eq!(drifts("pyramid"), [""; 0]);
}

#[test]
fn scenes_are_listed_and_run_by_name_or_file() {
    let place = Place::new();
    let list = place.succeed(&["scenes"]);
    assert_eq!(list.lines().count(), tumble_scene::builtin_names().count());
    assert!(list.contains("\npyramid          A square pyramid"), "{list}");
    assert_eq!(place.hash(&["cradle", "--steps", "5"]), place.hash(&["run", "cradle", "--steps", "5"]));
    place.refused(&["piramid"], "did you mean \"pyramid\"?");
    place.refused(&["run", "zzz"], "no scene is called \"zzz\"; the built-in scenes are arm");
}

/// Every file that a command of the README names is in the clone, and the command is done.
#[test]
fn files_of_the_readme_are_there() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let readme = std::fs::read_to_string(root.join("README.md")).unwrap();
    let commands = readme.lines().filter_map(|line| line.strip_prefix("cargo run --release -- "));
    let mut files = 0;
    for command in commands {
        let place = Place::new();
        let words: Vec<_> = command.split('#').next().unwrap().split_whitespace().collect();
        let Some(file) = words.iter().position(|word| word.contains('/') && !word.contains('\'')) else { continue };
        files += 1;
        let path = root.join(words[file]);
        let mut arguments = words;
        arguments[file] = path.to_str().unwrap();
        let code = place.run(&arguments).status.code();
        // An impossible inertia is what `inspect` shows there.
        assert_eq!(code, Some(if arguments[0] == "inspect" { 2 } else { 0 }), "{command}");
    }
    assert_eq!(files, 3);
}

#[test]
fn durations_are_rounded_to_whole_steps() {
    let place = Place::new();
    for (duration, dt, steps) in [("1", "0.01", 100), ("0.104", "0.01", 10), ("0.106", "0.01", 11), ("0", "0.5", 0)] {
        place.succeed(&["run", "mujoco-box", "--duration", duration, "--dt", dt, "--report", "report", "--quiet"]);
        assert_eq!(place.summary()["steps"], steps, "{duration} s");
    }
}

#[test]
fn no_steps_and_no_bodies_give_finite_numbers() {
    let place = Place::new();
    place.write("empty.json", "{}");
    for arguments in [["run", "empty.json", "--steps", "5"], ["run", "iss", "--steps", "0"]] {
        place.succeed(&[&arguments[..], &["--report", "report", "--record", "out.csv"]].concat());
        assert!(!place.read("report/summary.json").contains("null"));
        assert_eq!(place.summary()["body_steps_per_second"], 0.0);
    }
    assert_eq!(place.record("out.csv").len(), 1);
}

#[test]
fn every_integrator_can_be_asked_for() {
    let place = Place::new();
    let mut hashes: Vec<String> = tumble::Integrator::ALL
        .iter()
        .map(|integrator| place.hash(&["run", "mujoco-box", "--integrator", integrator.name()]))
        .collect();
    hashes.sort();
    hashes.dedup();
    assert_eq!(hashes.len(), tumble::Integrator::ALL.len());
}

#[test]
fn a_name_without_extension_is_a_built_in_even_if_a_file_has_it() {
    let place = Place::new();
    place.write("iss", "not a scene");
    place.succeed(&["run", "iss", "--steps", "1"]);
    // With a slash it is the file, which has no extension that names a format.
    assert_eq!(place.run(&["run", "./iss", "--steps", "1"]).status.code(), Some(2));
}

#[test]
fn a_body_that_leaves_the_numbers_is_named() {
    let place = Place::new();
    // 1e9 m/s2, 1e18 times over, for 1e6 s: 1e39 m, beyond f32 at once. The limits of a scene keep
    // f64 within its range.
    let scene = r#"{ "gravity": [0, 1e9, 0], "dt": 1e6, "steps": 1000, "bodies": [
        { "mass": 1, "gravity_scale": 0 }, { "name": "runaway", "mass": 1, "gravity_scale": 1e18 } ] }"#;
    place.write("scene.json", scene);
    let output = place.run(&["run", "scene.json", "--record", "out.csv", "--report", "report"]);
    if tumble::math::PRECISION == "f64" {
        assert_eq!(output.status.code(), Some(0), "{}", support::stderr(&output));
        assert!(!place.read("report/summary.json").contains("null"));
        return;
    }
    assert_eq!(output.status.code(), Some(1), "{}", support::stderr(&output));
    assert!(support::stderr(&output).contains("\"runaway\" (bodies[1])"), "{}", support::stderr(&output));
    assert_eq!(place.record("out.csv").len() % 2, 0);
    assert_eq!(place.entries(), ["out.csv", "scene.json"]);
}

#[test]
fn an_instruction_set_that_is_not_there_is_refused() {
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_tumble"))
        .args(["run", "t-handle", "--steps", "1", "--quiet"])
        .env("TUMBLE_SIMD", "abacus")
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("TUMBLE_SIMD=abacus"));
}
