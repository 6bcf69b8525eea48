//! Promise: a picture shows the scene: bodies are where the projection says, layers are seen when
//! they are asked for, time has passed, and the same command makes the same picture. What cannot be
//! used is refused in one line with exit code 2.
//!
//! Why: a window that shows things in the wrong place, or at the wrong time, is worse than none,
//! and no other test looks at pixels.
//!
//! Pictures need an X server and OpenGL, for which `xvfb-run` and Mesa's software renderer do.
//! Where they are not to be had, the tests say so and test nothing; with
//! `TUMBLE_VIEW_PICTURES=required` in the environment they fail, so that what breaks the window is
//! not taken for a machine without one.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helper functions too")]

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::BufReader;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};
use std::sync::{Mutex, PoisonError};

/// Two balls without gravity, of which the second goes up at half a metre a second.
const BALLS: &str = r#"{ "gravity": [0, 0, 0], "dt": 0.01, "bodies": [
    { "name": "left", "shape": { "sphere": { "radius": 0.2 } }, "mass": 1, "position": [-1, 0, 0] },
    { "name": "right", "shape": { "sphere": { "radius": 0.2 } }, "mass": 1, "position": [1, 0, 0], "linear_velocity": [0, 0.5, 0] } ] }"#;
const BLOCK: &str = r#"{ "gravity": [0, -9.81, 0], "dt": 0.01, "bodies": [
    { "name": "block", "shape": { "cuboid": { "half_extents": [0.2, 0.3, 0.4] } }, "mass": 1, "position": [0, 0, 0],
      "linear_velocity": [3, 6, 0], "angular_velocity": [1, 2, 3] } ] }"#;
/// A ball that is held from above; there is no gravity.
const HELD: &str = r#"{ "gravity": [0, 0, 0], "dt": 0.01, "bodies": [
    { "name": "ball", "shape": { "sphere": { "radius": 0.2 } }, "mass": 1, "position": [0, 0, 0],
      "forces": [ { "spring_to_point": { "anchor": [0.25, 0.4, 0], "stiffness": 1e-9 } } ] } ] }"#;
/// Two sides of a square, on the ground; its hull has the diagonal too.
const ANGLE: &str = r#"{ "gravity": [0, -9.81, 0], "dt": 0.01, "bodies": [
    { "name": "ground", "shape": { "half_space": {} }, "fixed": true, "collider": {} },
    { "name": "angle", "shape": { "mesh": { "file": "angle.obj" } }, "mass": 1, "collider": {} } ] }"#;
const ANGLE_MESH: &str = "v 0 0 0\nv 0 0 2\nv 1 0 2\nv 1 0 1\nv 2 0 1\nv 2 0 0\nv 0 1 0\nv 0 1 2\nv 1 1 2\nv 1 1 1\nv 2 1 1\nv 2 1 0
f 4 3 2 1\nf 6 5 4 1\nf 7 8 9 10\nf 7 10 11 12\nf 1 2 8 7\nf 2 3 9 8\nf 3 4 10 9\nf 4 5 11 10\nf 5 6 12 11\nf 6 1 7 12\n";
/// A plate above ground, by its height.
const PLATE: &str = r#"{ "gravity": [0, -9.81, 0], "dt": 0.01, "bodies": [
    { "name": "ground", "shape": { "half_space": {} }, "fixed": true, "collider": {} },
    { "name": "plate", "shape": { "cuboid": { "half_extents": [0.4, 0.01, 0.4] } }, "mass": 1, "position": [0, HEIGHT, 0] } ] }"#;
const SIZE: (u32, u32) = (640, 360);

/// Held while a screen is there.
static SCREEN: Mutex<()> = Mutex::new(());

/// A directory that is gone after the test, with the scene of the balls in it.
struct Place {
    directory: tempfile::TempDir,
}

impl Place {
    fn new() -> Self {
        let place = Self { directory: tempfile::tempdir().unwrap() };
        fs::write(place.path("balls.json"), BALLS).unwrap();
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.directory.path().join(name)
    }

    fn command(&self, program: &str, arguments: &[&str]) -> Command {
        let mut command = Command::new(program);
        command.args(arguments).current_dir(self.directory.path()).stdin(Stdio::null());
        command
    }

    /// Runs the program on a screen that no one sees; `None` where there can be none.
    fn on_screen(&self, arguments: &[&str]) -> Option<Output> {
        let program = env!("CARGO_BIN_EXE_tumble-view");
        let all: Vec<&str> = ["-a", program].into_iter().chain(arguments.iter().copied()).collect();
        // Several at a time may take each other's screen, and now and then one fails to clean up
        // after itself: neither is what is tested.
        let _alone = SCREEN.lock().unwrap_or_else(PoisonError::into_inner);
        for _ in 0..5 {
            let Ok(output) = self.command("xvfb-run", &all).output() else {
                skip("there is no xvfb-run");
                return None;
            };
            let said = String::from_utf8_lossy(&output.stderr);
            if said.contains("no window can be opened") {
                skip(&said);
                return None;
            }
            if !said.contains("xvfb-run: error") {
                return Some(output);
            }
        }
        panic!("xvfb-run fails again and again");
    }

    /// A picture of the balls from the front.
    fn picture(&self, arguments: &[&str]) -> Option<Picture> {
        let front = ["balls.json", "--screenshot", "a.png", "--camera", "0,0", "--up", "y", "--size", "640x360"];
        let all: Vec<&str> = front.iter().chain(arguments).copied().collect();
        let output = self.on_screen(&all)?;
        assert_eq!(output.status.code(), Some(0), "{all:?}: {}", String::from_utf8_lossy(&output.stderr));
        Some(Picture::read(self.path("a.png")))
    }

    /// Runs what must be refused, with or without a screen; what is said.
    fn refused(&self, arguments: &[&str]) -> String {
        let output = self.command(env!("CARGO_BIN_EXE_tumble-view"), arguments).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        said
    }
}

/// Says why nothing is tested, which may not be.
fn skip(why: &str) {
    assert!(std::env::var_os("TUMBLE_VIEW_PICTURES").is_none_or(|value| value != "required"), "required, but {why}");
    eprintln!("skipped: {why}");
}

/// Not to be printed: it has a million numbers.
#[derive(PartialEq)]
struct Picture {
    size: (u32, u32),
    bytes: Vec<u8>,
}

impl Picture {
    fn read(file: PathBuf) -> Self {
        let mut reader = png::Decoder::new(BufReader::new(File::open(file).unwrap())).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size()];
        let info = reader.next_frame(&mut bytes).unwrap();
        assert_eq!(info.color_type, png::ColorType::Rgb);
        Self { size: (info.width, info.height), bytes }
    }

    /// Middle and number of the pixels of a colour, from the upper left corner.
    fn patch(&self, is_of_it: impl Fn([f64; 3]) -> bool) -> ([f64; 2], f64) {
        let (mut sum, mut count) = ([0.0; 2], 0.0);
        for (index, color) in self.bytes.chunks_exact(3).enumerate() {
            if is_of_it([color[0], color[1], color[2]].map(f64::from)) {
                let (x, y) = (index % self.size.0 as usize, index / self.size.0 as usize);
                sum = [sum[0] + x as f64 + 0.5, sum[1] + y as f64 + 0.5];
                count += 1.0;
            }
        }
        (sum.map(|sum| sum / count), count)
    }
}

/// The colours of the first and the second body, in light and in shade, and of arrows of momentum.
fn orange([red, green, blue]: [f64; 3]) -> bool {
    red > 60.0 && red > 1.25 * green && green > 1.5 * blue
}

fn sky_blue([red, green, blue]: [f64; 3]) -> bool {
    blue > 70.0 && blue > 1.1 * green && green > 1.4 * red
}

fn yellow([red, green, blue]: [f64; 3]) -> bool {
    red > 150.0 && green > 0.82 * red && blue < 0.5 * red
}

/// Pixels to a metre at the distance of the balls. The camera sees 0.62 rad from top to bottom, and
/// stands where the ball that holds all balls, with a fifth of room, just fits in. That ball
/// reaches to the corners of the boxes around the balls.
fn pixels_per_metre() -> f64 {
    let radius = 1.0 + 0.2 * 3.0_f64.sqrt();
    let distance = 1.2 * radius / (0.5 * 0.62_f64).sin();
    f64::from(SIZE.1) / (2.0 * distance * (0.5 * 0.62_f64).tan())
}

#[test]
fn bodies_are_where_the_projection_says() {
    let Some(picture) = Place::new().picture(&["--show", "none"]) else { return };
    assert_eq!(picture.size, SIZE);
    let scale = pixels_per_metre();
    let expected_area = std::f64::consts::PI * (0.2 * scale).powi(2);
    let middle = [320.0, 180.0];
    for (([across, down], area), x) in [(picture.patch(orange), -1.0), (picture.patch(sky_blue), 1.0)] {
        // The outline of a ball aside of the middle is an ellipse whose middle is a little farther
        // out, by (r/d)^2 of the way; d is above 5 m.
        assert!((across - (middle[0] + x * scale)).abs() < 1.5, "{across} {x} {scale}");
        assert!((down - middle[1]).abs() < 1.0, "{down}");
        // The surface has 24 corners around, at most 2.3 % less of the disk; the edge's mixed
        // pixels may count or not: half a pixel of its radius.
        assert!((area / expected_area - 1.0).abs() < 0.08, "{area} {expected_area}");
    }
    // Nothing but the two is as bright as they are; here the mixed pixels of their edges all count.
    let (_, bright) = picture.patch(|color| color.iter().sum::<f64>() > 250.0);
    assert!(bright < 2.0 * 1.15 * expected_area, "{bright} {expected_area}");
}

#[test]
fn time_passes_and_does_so_between_steps_too() {
    let place = Place::new();
    let at = |time: &str| Some(place.picture(&["--show", "none", "--at", time])?.patch(sky_blue).0);
    let Some(start) = at("0") else { return };
    // The common centre of mass goes half as far as the ball, which the camera does not follow yet.
    for time in [0.4, 0.405] {
        let [across, down] = at(&time.to_string()).unwrap();
        let way = 0.5 * time * pixels_per_metre();
        assert!((start[1] - down - way).abs() < 0.3, "{time}: {start:?} {down} {way}");
        assert!((across - start[0]).abs() < 0.3, "{across}");
    }
}

#[test]
fn layers_are_seen_when_they_are_asked_for() {
    let place = Place::new();
    let Some(bare) = place.picture(&["--show", "none"]) else { return };
    let arrows = place.picture(&["--show", "momentum"]).unwrap();
    assert_eq!(bare.patch(yellow).1, 0.0);
    let ([across, down], count) = arrows.patch(yellow);
    // Up from the middle of the ball that moves; the other has none. Two points wide and some 1.7 *
    // 0.35 m long, in part dimmed by the ball.
    let scale = pixels_per_metre();
    assert!((across - (320.0 + scale)).abs() < 2.0 && down < 180.0 - 0.2 * scale, "{across} {down}");
    assert!(count > 30.0, "{count}");
    // There is no force: of this there is nothing but the title, which `none` leaves off.
    let nothing = place.picture(&["--show", "forces"]).unwrap();
    for layer in ["grid", "ledger", "legend", "names", "axes", "ellipsoids"] {
        assert!(place.picture(&["--show", layer]).unwrap() != nothing, "{layer}");
    }
    // Neither ball turns, hangs on a spring, or has anything to touch with.
    for layer in ["angular-velocity", "angular-momentum", "springs", "contacts", "colliders"] {
        assert!(place.picture(&["--show", layer]).unwrap() == nothing, "{layer}");
    }
}

/// A block that was thrown up and sideways, and spins, and one that lies: every layer has something
/// to show, and is looked for by its own colour.
#[test]
fn layers_have_their_colours() {
    let place = Place::new();
    for (file, text) in [("block.json", BLOCK), ("held.json", HELD), ("angle.json", ANGLE), ("angle.obj", ANGLE_MESH)] {
        fs::write(place.path(file), text).unwrap();
    }
    let draw = |scene: &str, layer: &str| {
        let fixed = [scene, "--screenshot", "a.png", "--at", "1", "--size", "640x360", "--show", layer];
        let output = place.on_screen(&fixed)?;
        assert_eq!(output.status.code(), Some(0), "{layer}: {}", String::from_utf8_lossy(&output.stderr));
        Some(Picture::read(place.path("a.png")))
    };
    let Some(bare) = draw("block.json", "none") else { return };
    let [lying, held] = ["angle.json", "held.json"].map(|scene| draw(scene, "none").unwrap());
    // As the engine's `DebugView` has them.
    let layers: [(&str, &[[f64; 3]]); 9] = [
        ("momentum", &[[0.98, 0.84, 0.30]]),
        ("angular-momentum", &[[0.90, 0.40, 0.85]]),
        ("angular-velocity", &[[0.35, 0.85, 0.85]]),
        ("axes", &[[0.94, 0.33, 0.31], [0.40, 0.80, 0.36], [0.33, 0.55, 0.96]]),
        ("ellipsoids", &[[0.60, 0.50, 0.85]]),
        ("forces", &[[0.98, 0.58, 0.24]]),
        ("springs", &[[0.76, 0.78, 0.80]]),
        ("contacts", &[[0.72, 0.98, 0.25]]),
        ("colliders", &[[0.30, 0.90, 0.62]]),
    ];
    for (layer, colors) in layers {
        let (scene, bare) = match layer {
            "contacts" | "colliders" => ("angle.json", &lying),
            "springs" => ("held.json", &held),
            _ => ("block.json", &bare),
        };
        let picture = draw(scene, layer).unwrap();
        for color in colors {
            // Bytes are rounded once or twice.
            let is_it = |seen: [f64; 3]| (0..3).all(|part| (seen[part] - 255.0 * color[part]).abs() <= 2.0);
            // Lines are two points wide, springs a little less, and tens of points long; in part
            // they are dimmed by the block, and at their edges mixed.
            let (seen, before) = (picture.patch(is_it).1, bare.patch(is_it).1);
            assert!(seen >= 40.0 && before == 0.0, "{layer}: {seen} {before}");
        }
    }
    // A trail has the body's colour. It is 1.6 points wide, and fades.
    let (with, without) = (draw("block.json", "trails").unwrap().patch(orange).1, bare.patch(orange).1);
    assert!(with >= without + 40.0, "{with} {without}");
}

/// A plate above the ground, from above.
fn picture_of_plate(place: &Place, height: f64, layers: &str) -> Option<Picture> {
    fs::write(place.path("plate.json"), PLATE.replace("HEIGHT", &height.to_string())).unwrap();
    let arguments = ["plate.json", "--screenshot", "a.png", "--show", layers, "--camera", "0,90", "--size", "1280x720"];
    let output = place.on_screen(&arguments)?;
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    Some(Picture::read(place.path("a.png")))
}

/// The right edge of a plate's shadow on the ground, from above: how far it is from where it should
/// be \[m\], and how many different brightnesses there are between shadow and light.
fn edge_of_shadow(place: &Place, height: f64) -> Option<(f64, usize)> {
    let picture = picture_of_plate(place, height, "shadows")?;
    let (wide, high) = (picture.size.0 as usize, picture.size.1 as usize);
    let row = &picture.bytes[3 * wide * (high / 2)..][..3 * wide];
    let grey: Vec<u32> = row.chunks_exact(3).map(|color| color.iter().map(|&part| u32::from(part)).sum()).collect();
    // The sun is 0.74 above to 0.61 to the left; the farthest shadow is that of the upper edge.
    let expected = 0.4 + 0.61 / 0.74 * (height + 0.01);
    // Pixels to a metre where the plate is, and on the ground, which is farther away.
    let at_plate = picture.patch(sky_blue).1.sqrt() / 0.8;
    let tangent = (0.5 * 0.62_f64).tan();
    let scale = high as f64 / (high as f64 / at_plate + 2.0 * tangent * height);
    let about = (0.5 * wide as f64 + expected * scale) as usize;
    let across = &grey[about - 12..about + 20];
    let (dark, lit) = (f64::from(across[0]), f64::from(across[across.len() - 1]));
    assert!(dark < 0.8 * lit, "{dark} {lit}");
    let part = |grey: u32| (f64::from(grey) - dark) / (lit - dark);
    let edge = about - 12 + across.iter().position(|&grey| part(grey) > 0.5).unwrap();
    let between: BTreeSet<u32> = across.iter().copied().filter(|&grey| (0.1..0.9).contains(&part(grey))).collect();
    Some(((edge as f64 - 0.5 * wide as f64) / scale - expected, between.len()))
}

/// Shadows are where the sun throws them, and have soft edges: softer, the farther what casts them.
#[test]
fn shadows_have_soft_edges() {
    let place = Place::new();
    let Some((off, levels)) = edge_of_shadow(&place, 0.6) else { return };
    let (off_near, levels_near) = edge_of_shadow(&place, 0.1).unwrap();
    // Three pixels.
    assert!(off.abs() < 0.01 && off_near.abs() < 0.01, "{off} {off_near}");
    // A point of a picture is the mean of two across: with hard edges there would be one.
    assert!(levels >= 5 && levels > levels_near, "{levels} {levels_near}");
    // Without them the same ground is brighter, on the right of the plate and nowhere else.
    let [with, without] = ["shadows", "none"].map(|layers| picture_of_plate(&place, 0.6, layers).unwrap());
    let wide = with.size.0 as usize;
    let pixels = without.bytes.chunks_exact(3).zip(with.bytes.chunks_exact(3)).enumerate();
    let darker = pixels.filter(|(_, (without, with))| without[1].saturating_sub(with[1]) > 15).map(|(at, _)| at % wide);
    let darker: Vec<usize> = darker.collect();
    assert!(darker.len() > 1000 && darker.iter().all(|x| 2 * x > wide), "{} {:?}", darker.len(), darker.iter().min());
}

/// Letters outside ASCII are written, and for those that the font lacks there is a mark.
#[test]
fn names_are_written_in_full() {
    let place = Place::new();
    let named = |name: &str| {
        fs::write(place.path("balls.json"), BALLS.replace("left", name)).unwrap();
        place.picture(&["--show", "names"])
    };
    let Some(umlaut) = named("Zürich") else { return };
    assert!(umlaut != named("Z rich").unwrap() && umlaut != named("Zurich").unwrap());
    let unknown = named("東京").unwrap();
    assert!(unknown == named("□□").unwrap() && unknown != named("  ").unwrap());
}

#[test]
fn the_same_command_makes_the_same_picture() {
    let place = Place::new();
    let all = "momentum,axes,trails,names,grid,ledger,legend";
    let make = || place.picture(&["--show", all, "--at", "1", "--pick", "right"]);
    let Some(first) = make() else { return };
    assert!(make().unwrap() == first, "twice the same");
    assert!(place.picture(&["--show", all, "--at", "1"]).unwrap() != first, "a picked body shows its figures");
}

/// Every built-in scene can be shown, with everything on, and is not just a background.
#[test]
fn built_in_scenes_are_shown() {
    let place = Place::new();
    let all = "momentum,angular-momentum,angular-velocity,axes,ellipsoids,forces,springs,contacts,colliders,trails,names,grid,ledger,legend";
    for scene in tumble_scene::builtin_names() {
        let arguments = [scene, "--screenshot", "b.png", "--size", "320x180", "--show", "none"];
        let Some(output) = place.on_screen(&arguments) else { return };
        assert_eq!(output.status.code(), Some(0), "{scene}: {}", String::from_utf8_lossy(&output.stderr));
        let (_, bright) = Picture::read(place.path("b.png")).patch(|color| color.iter().any(|&part| part > 90.0));
        // The least is the nine planets, each a dot of some ten pixels.
        assert!(bright >= 40.0, "{scene}: {bright}");
        let full = [scene, "--screenshot", "b.png", "--size", "320x180", "--show", all, "--at", "1"];
        let output = place.on_screen(&full).unwrap();
        assert_eq!(output.status.code(), Some(0), "{scene}: {}", String::from_utf8_lossy(&output.stderr));
    }
}

#[test]
fn an_animation_has_its_pictures_and_its_length() {
    let place = Place::new();
    let arguments =
        ["balls.json", "--animation", "a.gif", "--from", "0.2", "--for", "1", "--fps", "8", "--size", "160x90"];
    let Some(output) = place.on_screen(&arguments) else { return };
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let mut decoder = gif::DecodeOptions::new().read_info(File::open(place.path("a.gif")).unwrap()).unwrap();
    assert_eq!((decoder.width(), decoder.height()), (160, 90));
    let (mut frames, mut hundredths, mut areas) = (0, 0, Vec::new());
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        frames += 1;
        hundredths += frame.delay;
        areas.push(u32::from(frame.width) * u32::from(frame.height));
    }
    assert_eq!((frames, hundredths, areas[0]), (8, 100, 160 * 90));
    // The ball, its trail and the figures change; the rest is not stored again.
    assert!(areas[1..].iter().all(|&area| area < 160 * 90), "{areas:?}");
}

#[test]
fn what_cannot_be_used_is_refused_in_a_line() {
    let place = Place::new();
    let cases: [(&[&str], &str); 7] = [
        (&["nowhere"], "no scene is called \"nowhere\""),
        (&["gone.json"], "gone.json: cannot be read"),
        (&["t-handle", "--bodies", "3"], "--bodies goes with scenes that are generated from it"),
        (&["balls.json", "--pick", "middle"], "--pick: no body is called \"middle\""),
        (&["balls.json", "--screenshot", "a.bmp"], "--screenshot: a.bmp does not end in .png"),
        (&["balls.json", "--screenshot", "a.png", "--at", "1e300"], "--at "),
        (&["balls.json", "--animation", "a.gif", "--for", "1e5"], "--for: "),
    ];
    for (arguments, wanted) in cases {
        let said = place.refused(arguments);
        assert!(said.starts_with("tumble-view: ") && said.contains(wanted), "{wanted:?} is not in {said}");
        assert_eq!(said.lines().count(), 1, "{said}");
    }
    assert!(!place.path("a.png").exists());
}

/// Without a screen there is no window that could have run anything: the file is read before.
#[test]
fn what_cannot_be_written_is_refused_before_anything_runs() {
    let place = Place::new();
    fs::create_dir(place.path("there.png")).unwrap();
    for (option, file) in [("--screenshot", "gone/a.png"), ("--screenshot", "there.png"), ("--animation", "gone/a.gif")]
    {
        let mut command = place.command(env!("CARGO_BIN_EXE_tumble-view"), &["balls.json", option, file]);
        let output = command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!((output.status.code(), said.lines().count()), (Some(2), 1), "{said}");
        assert!(said.contains(&format!("{file}: cannot be written")), "{said}");
    }
}

#[test]
#[cfg(target_os = "linux")]
fn without_a_display_that_is_said_in_a_line() {
    let place = Place::new();
    let run = |display: Option<&str>| {
        let mut command = place.command(env!("CARGO_BIN_EXE_tumble-view"), &["balls.json"]);
        command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY");
        if let Some(display) = display {
            command.env("DISPLAY", display);
        }
        let output = command.output().unwrap();
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    // None at all, and one that is not there.
    for (display, wanted) in [(None, "there is no display"), (Some(":9876"), "no window can be opened")] {
        let (code, said) = run(display);
        assert_eq!((code, said.lines().count()), (Some(1), 1), "{said}");
        assert!(said.contains(wanted), "{said}");
    }
    // Nor is anything left of a picture that could not be drawn, and what was there before is as it
    // was.
    fs::write(place.path("a.png"), "before").unwrap();
    let mut command = place.command(env!("CARGO_BIN_EXE_tumble-view"), &["balls.json", "--screenshot", "a.png"]);
    assert_eq!(command.env("DISPLAY", ":9876").output().unwrap().status.code(), Some(1));
    assert_eq!(fs::read(place.path("a.png")).unwrap(), b"before");
    assert_eq!(fs::read_dir(place.directory.path()).unwrap().count(), 2);
}
