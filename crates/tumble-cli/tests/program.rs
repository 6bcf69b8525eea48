//! What the program says of itself and of mistakes in its command line, and what it gives to other
//! programs: JSON, completions, a page for `man`, a page for the browser, a scene for the window.
//!
//! It would fail if a slip of the finger got no answer that helps, if a script could not read a
//! run, or if a file or a pipe got the colours of a terminal.

use crate::support::{Place, stderr, wait_for};
use serde_json::Value;

const TOP: &str = r#"{ "dt": 0.1, "steps": 3, "gravity": [0, 0, 0],
  // It turns too fast for its steps.
  "bodies": [ { "name": "top", "shape": { "sphere": { "radius": 1 } }, "mass": 1, /* rad/s */ "angular_velocity": [0, 100, 0] } ] }"#;

#[test]
fn slips_of_the_finger_are_answered() {
    let place = Place::new();
    for (arguments, wanted) in [
        (&["inspct", "iss"][..], "a similar subcommand exists: 'inspect'"),
        (&["scene"], "'scenes'"),
        (&["veiw", "wall"], "'view'"),
        (&["run", "iss", "--stpes", "3"], "a similar argument exists: '--steps'"),
        (&["sweep", "iss", "--wrolds", "3"], "a similar argument exists: '--worlds'"),
        (&["piramid"], "did you mean \"pyramid\"?"),
        (&["nothing-like-it"], "`tumble scenes` lists the built-in scenes"),
        (&["completions", "bsh"], "a similar value exists: 'bash'"),
        (&["man", "rn"], "there is no command \"rn\"; there are run, view, sweep"),
        (&["run", "iss", "--dt", "soon"], "write seconds, as 0.01, 1e-3 or 1/60, or a unit with them, as 500ms"),
        (&["run", "iss", "--steps", "few"], "write a whole number, as 600, 10_000 or 1e6"),
        (&["run", "iss", "--open"], "--report <DIR>"),
        (&["run", "iss", "--json", "--quiet"], "cannot be used with"),
    ] {
        place.refused(arguments, wanted);
    }
}

#[test]
fn the_help_names_every_scene() {
    let place = Place::new();
    for arguments in [&["--help"][..], &["run", "--help"]] {
        let help = place.succeed(arguments);
        let named = help.split_once("Built-in scenes").unwrap().1;
        for scene in tumble_scene::builtin_names() {
            assert!(named.split_whitespace().any(|word| word == scene), "{arguments:?}: {scene}");
        }
        assert!(named.lines().all(|line| line.len() <= 100), "{named}");
    }
}

#[test]
fn fractions_and_exponents_give_the_same_bits_as_digits() {
    let place = Place::new();
    let hash = |options: &[&str]| place.hash(&[&["stress", "--bodies", "2e1"], options].concat());
    let plain = place.hash(&["run", "stress", "--bodies", "20", "--steps", "120"]);
    for options in [&["--dt", "1/60", "--steps", "1.2e2"][..], &["--duration", "2s"], &["--duration", "2000 ms"]] {
        assert_eq!(plain, hash(options), "{options:?}");
    }
}

#[test]
fn a_run_in_json_says_what_the_table_says() {
    let place = Place::new();
    place.write("scene.json", TOP);
    let output = place.succeed(&["run", "scene.json", "--json", "--report", "out"]);
    let run: Value = serde_json::from_str(&output).unwrap();
    let summary: Value = serde_json::from_str(&place.read("out/summary.json")).unwrap();
    for (key, value) in summary.as_object().unwrap() {
        assert_eq!(&run[key], value, "{key}");
    }
    assert_eq!((&run["scene"], &run["steps_asked"]), (&"scene.json".into(), &3.into()));
    assert!((run["simulated_seconds"].as_f64().unwrap() - 0.3).abs() < 1e-6);
    // Half of 0.4 kg m^2 times the square of 100 rad/s.
    assert!((run["kinetic_energy"]["final"].as_f64().unwrap() - 2000.0).abs() < 1.0);
    assert_eq!((&run["potential_energy"]["initial"], &run["energy_is_kept"]), (&0.0.into(), &true.into()));
    assert_eq!((&run["momentum_is_kept"], &run["sensor_events"]["begins"]), (&true.into(), &0.into()));
    assert!(run["system_seconds"]["integrate"].is_f64());
    assert_eq!((&run["record"], &run["report"]), (&Value::Null, &"out/report.html".into()));
    assert_eq!(run["state_hash"].as_str().unwrap(), place.hash(&["run", "scene.json"]));
}

#[test]
fn completions_and_pages_have_commands_and_options() {
    let place = Place::new();
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let script = place.succeed(&["completions", shell]);
        assert!(script.contains("inspect") && script.contains("substeps"), "{shell}");
    }
    let page = place.succeed(&["man"]);
    assert!(page.contains(".TH tumble 1") && page.contains("tumble\\-inspect(1)"), "{page}");
    let page = place.succeed(&["man", "run"]);
    assert!(page.contains(".TH tumble-run 1") && page.contains("\\-\\-substeps"), "{page}");
}

#[test]
fn a_step_that_is_too_long_is_warned_of_once() {
    let place = Place::new();
    place.write("scene.json", TOP);
    let output = place.run(&["run", "scene.json"]);
    let said = stderr(&output);
    assert_eq!((output.status.code(), said.lines().count()), (Some(0), 1), "{said}");
    assert!(said.starts_with("tumble: warning: body \"top\" turns by 1.59 turns in a step of 0.100 s"), "{said}");
    for would_do in [&["--dt", "1/64"][..], &["--substeps", "7"], &["--quiet"]] {
        assert_eq!(stderr(&place.run(&[&["run", "scene.json"], would_do].concat())), "", "{would_do:?}");
    }
}

#[test]
fn only_terminals_get_colours() {
    let place = Place::new();
    place.write("bad.json", r#"{ "bodies": [ { "mass": -1 } ] }"#);
    let escapes = |arguments: &[&str], variable: &str| {
        let output = place.command(arguments).env_remove("NO_COLOR").env(variable, "1").output().unwrap();
        [&output.stdout, &output.stderr].map(|stream| stream.contains(&0x1b))
    };
    for (arguments, streams) in [
        (&["scenes"][..], [true, false]),
        (&["run", "iss", "--steps", "1"], [true, false]),
        (&["inspect", "bad.json"], [true, true]),
        (&["run", "bad.json"], [false, true]),
        (&["nothing-like-it"], [false, true]),
    ] {
        assert_eq!(escapes(arguments, "CLICOLOR_FORCE"), streams, "{arguments:?}");
        assert_eq!(escapes(arguments, "NO_COLOR"), [false; 2], "{arguments:?}");
        assert_eq!(escapes(arguments, "NOTHING"), [false; 2], "{arguments:?}");
    }
    // Of what programs read nothing stands out even then.
    assert_eq!(escapes(&["inspect", "iss", "--json"], "CLICOLOR_FORCE"), [false; 2]);
    assert_eq!(escapes(&["run", "iss", "--steps", "1", "--json"], "CLICOLOR_FORCE"), [false; 2]);
}

/// A program for the shell, in the folder `bin`.
#[cfg(unix)]
fn script(place: &Place, name: &str, text: &str) {
    use std::os::unix::fs::PermissionsExt as _;
    std::fs::create_dir_all(place.path("bin")).unwrap();
    let path = format!("bin/{name}");
    place.write(&path, format!("#!/bin/sh\n{text}\n"));
    std::fs::set_permissions(place.path(&path), std::fs::Permissions::from_mode(0o755)).unwrap();
}

#[cfg(target_os = "linux")]
#[test]
fn a_report_is_opened_or_said_to_be_there() {
    let place = Place::new();
    script(&place, "xdg-open", "echo \"$1\" > opened.partial; mv opened.partial opened");
    let path = format!("{}:/usr/bin:/bin", place.path("bin").display());
    let arguments = ["run", "iss", "--steps", "2", "--report", "out", "--open"];
    let output = place.command(&arguments).env("PATH", path).output().unwrap();
    assert_eq!((output.status.code(), stderr(&output).as_str()), (Some(0), ""));
    assert!(String::from_utf8_lossy(&output.stdout).contains("out/report.html"));
    wait_for("the browser", || place.path("opened").exists());
    assert!(place.read("opened").trim_end().ends_with("out/report.html"));
    let output = place.command(&arguments).env("PATH", place.path("out")).output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert!(
        stderr(&output).contains("out/report.html is written, but no browser could be started"),
        "{}",
        stderr(&output)
    );
}

/// From a folder of its own: beside the tests' program there may be a window.
#[cfg(unix)]
#[test]
fn the_window_is_a_program_beside_this_one_or_in_the_path() {
    let place = Place::new();
    std::fs::create_dir(place.path("alone")).unwrap();
    std::fs::copy(env!("CARGO_BIN_EXE_tumble"), place.path("alone/tumble")).unwrap();
    let view = |path: &str| {
        let mut command = std::process::Command::new(place.path("alone/tumble"));
        command.args(["view", "wall", "--speed", "0.5", "--help"]).env("PATH", path).current_dir(place.path("alone"));
        command.output().unwrap()
    };
    let output = view("/nowhere");
    assert_eq!(output.status.code(), Some(2));
    let said = stderr(&output);
    assert!(said.contains("`cargo run --release -p tumble-view -- wall --speed 0.5 --help`"), "{said}");
    script(&place, "tumble-view", "echo \"window: $@\"; exit 7");
    let output = view(&format!("{}:/bin", place.path("bin").display()));
    assert_eq!((output.status.code(), stderr(&output).as_str()), (Some(7), ""));
    assert_eq!(String::from_utf8_lossy(&output.stdout), "window: wall --speed 0.5 --help\n");
    std::fs::rename(place.path("bin/tumble-view"), place.path("alone/tumble-view")).unwrap();
    assert_eq!(view("/nowhere").status.code(), Some(7));
}
