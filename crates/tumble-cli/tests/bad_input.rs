//! Bad input ends with exit code 2, one line that names file, body and field, and no file written.
//!
//! A user with a scene of a thousand bodies must learn which number is wrong. It would fail if a
//! check were missing, came after the first step, or lost the place on its way to the message.

use crate::support::{Place, stderr};

/// Runs the file with both outputs asked for, and checks the whole of the promise.
fn refused(file: &str, contents: &[u8], wanted: &[&str]) {
    let place = Place::new();
    place.write(file, contents);
    let output = place.run(&["run", file, "--record", "record.csv", "--report", "made/report"]);
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{wanted:?}: {message}");
    assert_eq!(message.lines().count(), 1, "{message}");
    assert!(message.starts_with(&format!("tumble: {file}: ")), "{message}");
    for part in wanted {
        assert!(message.contains(part), "{part:?} is not in {message}");
    }
    assert!(output.stdout.is_empty());
    assert_eq!(place.entries(), [file], "something was written");
}

/// The fields of a second body, after a good first one.
fn body(fields: &str, field: &str, value: &str) {
    let scene = format!(r#"{{ "bodies": [ {{ "mass": 1 }}, {{ "name": "brick", {fields} }} ] }}"#);
    let place = format!("body \"brick\" (bodies[1]), field {field}: ");
    refused("scene.json", scene.as_bytes(), &[&place, value]);
}

const CUBE: &str = r#""shape": { "cuboid": { "half_extents": [1, 1, 1] } }"#;

#[test]
fn unknown_keys() {
    body(r#""mass": 1, "colour": "red""#, "colour", "unknown field `colour`");
    body(r#""mass": 1, "shape": { "sphere": { "radius": 1, "height": 2 } }"#, "shape.sphere.height", "`height`");
    body(r#""mass": 1, "shape": { "teapot": {} }"#, "shape", "`teapot`");
    body(r#""mass": 1, "forces": [ { "breeze": 1 } ]"#, "forces[0]", "`breeze`");
    body(r#""mass": 1, "forces": [ { "magnus": { "spin": 1 } } ]"#, "forces[0].magnus.spin", "`spin`");
    let hull = r#""mass": 1, "forces": [ { "buoyancy": { "hull": { "sphere": { "radius": 1, "mass": 2 } } } } ]"#;
    body(hull, "forces[0].buoyancy.hull.sphere.mass", "`mass`");
    refused("scene.json", br#"{ "gravitas": 1 }"#, &["field gravitas: ", "unknown field"]);
    refused("scene.ron", b"(bodies: [(name: \"brick\", mass: 1, hue: 3)])", &["(bodies[0]), field hue: ", "\"brick\""]);
}

#[test]
fn wrong_types() {
    body(r#""mass": "heavy""#, "mass", "\"heavy\"");
    body(r#""mass": 1, "position": [1, 2]"#, "position", "3 values");
    body(r#""mass": 1, "position": [1, 2, 3, 4]"#, "position", "more than 3 values");
    body(r#""mass": 1, "position": [1, "two", 3]"#, "position[1]", "\"two\"");
    body(r#""mass": 1, "fixed": 1"#, "fixed", "`1`");
    refused("scene.json", br#"{ "steps": -1 }"#, &["field steps: ", "-1"]);
    refused("scene.json", br#"{ "steps": 1.5 }"#, &["field steps: ", "1.5"]);
    refused("scene.json", br#"{ "bodies": {} }"#, &["field bodies: "]);
}

#[test]
fn missing_and_doubled_mass() {
    body(CUBE, "mass", "missing");
    body(r#""density": 1"#, "density", "needs a shape");
    body(&format!(r#"{CUBE}, "mass": 1, "density": 2"#), "density", "mass is given too");
    body(r#""shape": { "compound": { "parts": [ { "shape": "point" } ] } }"#, "shape.parts[0].mass", "missing");
    body(r#""shape": { "compound": { "parts": [] } }"#, "shape.parts", "");
    body(r#""shape": { "hollow_sphere": { "radius": 1 } }, "density": 1"#, "density", "no volume");
}

#[test]
fn masses_that_are_no_masses() {
    for (mass, value) in [("0", "0"), ("-2", "-2"), ("NaN", "NaN"), ("1e999", "1e999"), ("1e300", "1e300")] {
        body(&format!(r#"{CUBE}, "mass": {mass}"#), "mass", value);
    }
    body(&format!(r#"{CUBE}, "density": -5"#), "density", "-5");
    let scene = b"(bodies: [(name: \"brick\", mass: inf)])";
    refused("scene.ron", scene, &["body \"brick\" (bodies[0]), field mass: ", "inf"]);
}

#[test]
fn absurd_numbers() {
    body(r#""mass": 1, "position": [0, 1e30, 0]"#, "position", "1e30");
    body(r#""mass": 1, "position": [0, 1e16, 0]"#, "position", "must be within 1e15 along each axis");
    body(r#""mass": 1, "linear_velocity": [0, 0, 1e10]"#, "linear_velocity", "must be within 1e9 along each axis");
    body(
        r#""mass": 1, "shape": { "sphere": { "radius": 1 } }, "angular_velocity": [-1e10, 0, 0]"#,
        "angular_velocity",
        "within 1e9",
    );
    body(r#""mass": 1, "linear_velocity": [0, -1e19, 0]"#, "linear_velocity", "-1e19");
    body(r#""mass": 1, "angular_velocity": [1e99, 0, 0]"#, "angular_velocity", "1e99");
    body(r#""mass": 1, "gravity_scale": 1e40"#, "gravity_scale", "1e40");
    body(r#""mass": 1, "shape": { "sphere": { "radius": 0 } }"#, "shape.radius", "0");
    body(r#""mass": 1, "shape": { "sphere": { "radius": -3 } }"#, "shape.radius", "-3");
    body(r#""mass": 1, "forces": [ { "damping": { "linear": -1 } } ]"#, "forces[0].damping.linear", "-1");
    for dt in ["0", "-0.1", "1e300", "1e-300", "10000000", "1e-10"] {
        refused("scene.json", format!(r#"{{ "dt": {dt} }}"#).as_bytes(), &["field dt: ", &format!("not {dt}")]);
    }
    refused("scene.json", br#"{ "gravity": [0, 1e40, 0] }"#, &["field gravity: ", "1e40"]);
    refused("scene.json", br#"{ "gravity": [0, 1e10, 0] }"#, &["field gravity: ", "within 1e9 m/s^2", "10000000000"]);
    // The one at fault is named, whatever else is set.
    let many = br#"{ "gravity": [0, 1e10, 0], "substeps": 2, "contact_substeps": 8, "restitution_threshold": 0 }"#;
    refused("scene.json", many, &["field gravity: "]);
    refused("scene.json", br#"{ "dt": 1e-8, "contact_substeps": 100 }"#, &["field dt: ", "divided", "e-10"]);
    refused("scene.json", br#"{ "dt": 1e-8, "substeps": 4000000000 }"#, &["field substeps: ", "4000000000"]);
    refused("scene.json", br#"{ "restitution_threshold": 1e10 }"#, &["field restitution_threshold: ", "1e9 m/s"]);
    refused("scene.json", br#"{ "steps": 2000000000000 }"#, &["field steps: ", "2000000000000"]);
    refused("scene.json", br#"{ "substeps": 0 }"#, &["field substeps: ", "0"]);
    refused("scene.json", br#"{ "integrator": "euler" }"#, &["field integrator: ", "\"euler\"", "moser-veselov"]);
    refused("scene.ron", b"(gravity: (0, NaN, 0))", &["field gravity: ", "NaN"]);
}

#[test]
fn impossible_inertia() {
    let inertia = |inertia: &str, field: &str, value: &str| {
        body(&format!(r#""mass": 1, "inertia": {{ {inertia} }}"#), field, value);
    };
    inertia(r#""principal": [0, 1, 1]"#, "inertia.principal", "must be positive");
    inertia(r#""principal": [-1, 1, 1]"#, "inertia.principal", "-1");
    inertia(r#""principal": [1, 1, 3]"#, "inertia.principal", "triangle inequality");
    inertia(r#""tensor": [[1, 0.5, 0], [0, 1, 0], [0, 0, 1]]"#, "inertia.tensor", "0.5");
    inertia(r#""tensor": [[1, 0, 0], [0, 1, 0], [0, 0, 3]]"#, "inertia.tensor", "triangle inequality");
    inertia(r#""tensor": [[1, 2, 0], [2, 1, 0], [0, 0, 1]]"#, "inertia.tensor", "-1");
    inertia(r#""principal": [1, 1, 1], "axes": [0, 0, 0, 2]"#, "inertia.axes", "length is 2");
    inertia(r#""principal": [1, 1, 1], "tensor": [[1,0,0],[0,1,0],[0,0,1]]"#, "inertia.tensor", "principal");
    inertia(r#""axes": [0, 0, 0, 1]"#, "inertia", "needs principal or tensor");
    inertia("", "inertia", "needs principal or tensor");
    body(r#""mass": 1, "angular_velocity": [1, 0, 0]"#, "angular_velocity", "inertia");
}

#[test]
fn quaternions_that_are_no_rotations() {
    body(r#""mass": 1, "orientation": [0, 0, 0, 0]"#, "orientation", "length is 0");
    body(r#""mass": 1, "orientation": [0, 0, 0, 1.01]"#, "orientation", "length is 1.01");
    let part = r#"{ "shape": "point", "mass": 1, "orientation": [1, 1, 0, 0] }"#;
    let compound = format!(r#""shape": {{ "compound": {{ "parts": [ {part} ] }} }}"#);
    body(&compound, "shape.parts[0].orientation", "1.41");
}

#[test]
fn names() {
    let twice = br#"{ "bodies": [ { "name": "a", "mass": 1 }, { "mass": 1 }, { "name": "a", "mass": 1 } ] }"#;
    refused("scene.json", twice, &["body \"a\" (bodies[2]), field name: ", "bodies[0]"]);
    let made = br#"{ "bodies": [ { "name": "body-1", "mass": 1 }, { "mass": 1 } ] }"#;
    refused("scene.json", made, &["(bodies[1]), field name: "]);
    refused("scene.json", br#"{ "bodies": [ { "name": "", "mass": 1 } ] }"#, &["(bodies[0]), field name: ", "empty"]);
    refused("scene.json", br#"{ "bodies": [ { "name": "a\u001b", "mass": 1 } ] }"#, &["field name: ", "control"]);
}

#[test]
fn motion_that_contradicts_itself() {
    body(r#""fixed": true, "kinematic": true"#, "kinematic", "not both");
    body(r#""fixed": true, "linear_velocity": [1, 0, 0]"#, "linear_velocity", "does not move");
}

/// One force of the second body, at the path that the message is to name.
fn force(force: &str, field: &str, value: &str) {
    body(
        &format!(r#"{CUBE}, "mass": 1, "forces": [ {{ "gravity_scale": 0 }}, {{ {force} }} ]"#),
        &format!("forces[1].{field}"),
        value,
    );
}

#[test]
fn impossible_forces() {
    force(r#""drag": {}"#, "drag", "needs linear or angular");
    force(r#""drag": { "linear": -1 }"#, "drag.linear", "-1");
    force(r#""drag": { "angular": [1, 2] }"#, "drag.angular", "3 values");
    force(r#""drag": { "linear": "much" }"#, "drag.linear", "a number or a list of 3 values");
    force(r#""wind": [0, 1e30, 0]"#, "wind", "1e30");
    force(r#""thruster": { "force": [1, 0, 1e99] }"#, "thruster.force", "1e99");
    force(r#""thruster": { "point": [1, 0, 0] }"#, "thruster", "`force`");
    force(r#""constant_wrench": { "frame": "body" }"#, "constant_wrench", "needs force or torque");
    force(r#""constant_wrench": { "force": [1, 0, 0], "frame": "moon" }"#, "constant_wrench.frame", "`moon`");
    force(r#""spring_to_point": { "anchor": [0, 0, 0], "stiffness": -3 }"#, "spring_to_point.stiffness", "-3");
    force(
        r#""spring_to_point": { "anchor": [0, 0, 0], "stiffness": 3, "damping": -4 }"#,
        "spring_to_point.damping",
        "-4",
    );
    force(
        r#""spring_to_point": { "anchor": [0, 0, 0], "stiffness": 3, "rest_length": -5 }"#,
        "spring_to_point.rest_length",
        "-5",
    );
    force(r#""spring": { "to": "nobody", "stiffness": 1 }"#, "spring.to", "no body is called \"nobody\"");
    force(r#""spring": { "to": "brick", "stiffness": 1 }"#, "spring.to", "is the body itself");
    force(r#""spring": { "to": "body-0", "stiffness": -1 }"#, "spring.stiffness", "-1");
    force(r#""point_gravity": { "mu": 1e400 }"#, "point_gravity.mu", "1e400");
    force(r#""gravity_mass": { "softening": -1 }"#, "gravity_mass.softening", "-1");
    force(r#""buoyancy": { "density": -1 }"#, "buoyancy.density", "-1");
    force(r#""buoyancy": { "hull": { "sphere": { "radius": 0 } } }"#, "buoyancy.hull.sphere.radius", "0");
    force(
        r#""buoyancy": { "hull": { "cuboid": { "half_extents": [1, -2, 3] } } }"#,
        "buoyancy.hull.cuboid.half_extents",
        "-2",
    );
    force(
        r#""angular_velocity_servo": { "target": [0, 0, 0], "max_torque": -1 }"#,
        "angular_velocity_servo.max_torque",
        "-1",
    );
    force(r#""gravity_scale": 1"#, "gravity_scale", "given twice");
    if tumble::math::PRECISION == "f32" {
        force(r#""buoyancy": { "hull": { "sphere": { "radius": 1e18 } } }"#, "buoyancy.hull", "too much");
        force(r#""point_gravity": { "mu": 1e39 }"#, "point_gravity.mu", "1e39 is not a finite number of f32");
    }
}

#[test]
fn forces_that_do_not_go_with_their_body() {
    body(r#""mass": 1, "forces": [ { "buoyancy": {} } ]"#, "forces[0].buoyancy.hull", "the body is a point");
    body(r#""fixed": true, "forces": [ { "gravity_mass": {} } ]"#, "forces[0].gravity_mass.mu", "no mass");
    body(r#""fixed": true, "forces": [ { "magnus": { "coefficient": 1 } } ]"#, "forces[0].magnus", "the body is fixed");
    let spring = r#""kinematic": true, "forces": [ { "spring": { "to": "body-0", "stiffness": 1 } } ]"#;
    body(spring, "forces[0].spring", "the body is kinematic");
    let twice = r#"{ "magnus": { "coefficient": 1 } }"#;
    body(&format!(r#""mass": 1, "forces": [ {twice}, {twice} ]"#), "forces[1].magnus", "given twice");
    body(
        r#""mass": 1, "gravity_scale": 1, "forces": [ { "gravity_scale": 1 } ]"#,
        "forces[0].gravity_scale",
        "given twice",
    );
    let nozzle = r#"{ "thruster": { "force": [1e18, 0, 0], "throttle": 1e30 } }"#;
    if tumble::math::PRECISION == "f32" {
        body(&format!(r#""mass": 1, "forces": [ {nozzle} ]"#), "forces", "too strong");
    }
}

#[test]
fn files_that_are_no_scenes() {
    refused("scene.json", b"", &["EOF"]);
    refused("scene.json", b"[]", &["scene"]);
    refused("scene.json", b"{ \"bodies\": [ {", &["EOF"]);
    refused("scene.json", b"{} trailing", &["trailing", "line 1"]);
    refused("scene.json", b"{ \"name\": \"\xff\" }", &["UTF-8", "offset 11"]);
    refused("scene.ron", b"(", &[""]);
    refused("scene.txt", b"{}", &[".json, .ron, .gltf"]);
    refused("scene.json", "[".repeat(200_000).as_bytes(), &[""]);
    let deep = r#"{ "bodies": [ { "shape": "#.to_owned() + &r#"{"compound":{"parts":[{"shape":"#.repeat(5000);
    refused("scene.json", deep.as_bytes(), &["recursion limit"]);
    refused("scene.ron", "(bodies:".repeat(100_000).as_bytes(), &[""]);
}

#[test]
fn paths_that_cannot_be_read() {
    let place = Place::new();
    std::fs::create_dir(place.path("directory.json")).unwrap();
    for (path, reason) in [("missing.json", ""), ("directory.json", "directory"), ("no/such.ron", "")] {
        let message = place.refused(&["run", path, "--record", "record.csv"], reason);
        assert!(message.starts_with(&format!("tumble: {path}: cannot be read: ")), "{message}");
    }
}

#[cfg(unix)]
#[test]
fn a_pipe_is_refused_and_not_waited_for() {
    let place = Place::new();
    let kind = rustix::fs::FileType::Fifo;
    let mode = rustix::fs::Mode::from_raw_mode(0o600);
    rustix::fs::mknodat(rustix::fs::CWD, place.path("pipe.json"), kind, mode, 0).unwrap();
    place.refused(&["run", "pipe.json"], "not a regular file");
}

#[test]
fn a_file_beyond_the_limit_is_not_read() {
    let place = Place::new();
    // Sparse: it takes no space, and reading it would show as a complaint about its zeros.
    let file = std::fs::File::create(place.path("large.json")).unwrap();
    file.set_len(tumble_import::MAX_FILE_BYTES + 1).unwrap();
    place.refused(&["run", "large.json"], "larger than 268435456 bytes");
}

#[test]
fn names_of_no_scene_list_those_there_are() {
    let message = Place::new().refused(&["run", "nope"], "\"nope\"");
    for name in tumble_scene::builtin_names() {
        assert!(message.contains(name), "{message}");
    }
}

#[test]
fn options_of_the_stress_scene_go_with_no_other() {
    for arguments in [["run", "iss", "--bodies", "5"], ["run", "iss", "--seed", "5"]] {
        Place::new().refused(&arguments, arguments[2]);
    }
}

#[test]
fn options_that_make_no_sense() {
    let place = Place::new();
    for arguments in [
        &["run", "iss", "--steps", "1e300"][..],
        &["run", "iss", "--dt", "0"],
        &["run", "iss", "--dt", "NaN"],
        &["run", "iss", "--steps", "1", "--duration", "1"],
        &["run", "iss", "--dt", "1e-12", "--duration", "1e6"],
        &["run", "iss", "--threads", "0"],
        &["run", "iss", "--threads", "1000000"],
        &["run", "--bodies", "1000000000000"],
        &["run", "iss", "--every", "2"],
        &["run", "iss", "--record", "record.txt"],
        &["run", "iss", "--record", "record"],
        &["run", "iss", "--record", "no/such/directory/record.csv"],
        &["fly"],
        &["inspect"],
    ] {
        let output = place.run(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(!stderr(&output).is_empty() && output.stdout.is_empty(), "{arguments:?}");
    }
    assert!(place.entries().is_empty());
}

#[test]
fn records_that_cannot_be() {
    let place = Place::new();
    place.refused(
        &["run", "iss", "--record", "a.txt"],
        "a.txt: the name of a record ends in one of .csv, .parquet, .glb",
    );
    if cfg!(not(feature = "parquet")) {
        place.refused(&["run", "iss", "--record", "a.parquet"], "a.parquet: this program was built without Parquet");
    }
    let long = ["run", "--bodies", "1000", "--steps", "1000000", "--every", "5", "--record", "a.glb"];
    place.refused(
        &long,
        "a.glb: 1000 bodies in 200001 frames are 5.2 GiB, a .glb holds 4: record fewer steps (--every)",
    );
}

#[test]
fn outputs_that_cannot_be_written() {
    let place = Place::new();
    place.write("file", "kept");
    std::fs::create_dir(place.path("directory.csv")).unwrap();
    for arguments in [
        ["run", "iss", "--report", "file", "--quiet", "--quiet"],
        ["run", "iss", "--report", "file/below", "--record", "record.csv"],
        ["run", "iss", "--report", "new/report", "--record", "directory.csv"],
        ["run", "iss", "--report", "new/report", "--record", "missing/record.csv"],
    ] {
        let arguments = if arguments[5] == "--quiet" { &arguments[..5] } else { &arguments[..] };
        place.refused(arguments, "cannot be written");
    }
    assert_eq!(place.read("file"), "kept");
}

#[test]
fn a_report_or_a_record_does_not_replace_its_scene() {
    let place = Place::new();
    place.write("summary.json", "{}");
    place.refused(&["run", "./summary.json", "--report", "."], "is the scene itself");
    #[cfg(unix)]
    for link in ["run.glb", "run.partial.csv"] {
        std::os::unix::fs::symlink("summary.json", place.path(link)).unwrap();
        let record = link.replace(".partial", "");
        place.refused(&["run", "summary.json", "--record", &record], "is the scene itself");
    }
    assert_eq!(place.read("summary.json"), "{}");
}
