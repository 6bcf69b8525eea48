//! The command line.

use std::path::PathBuf;
use std::str::FromStr;

use clap::{Args, Parser};
use tumble::glam::DVec2;
use tumble::math::Real;
use tumble::{Integrator, Settings};
use tumble_scene::{MAX_BODIES, Scene, parse_seconds, steps_of_duration, time_step};

use crate::camera::{Camera, DISTANCES, Up};
use crate::failure::Failure;
use crate::layers::{LAYERS, Layers};
use crate::overlay::KEYS;
use crate::page;
use crate::picture::Output;

/// Edges of a picture \[points\]: graphics cards have textures of twice this.
const EDGES: std::ops::RangeInclusive<u32> = 64..=4096;
/// The most pictures of an animation, and the most bytes of them: all are held until their common
/// colours are chosen.
const MAX_FRAMES: f64 = 2000.0;
const MAX_BYTES: f64 = 1.5e9;

/// Keys of the window, and exit codes.
fn after_help() -> String {
    let mut help = "Keys of the window:\n".to_owned();
    let layers = LAYERS.iter().map(|info| (info.letter.to_string(), format!("show {}", info.title)));
    let others = KEYS.iter().map(|(key, what)| ((*key).to_owned(), (*what).to_owned()));
    for (key, what) in others.chain(layers) {
        help.push_str(&format!("  {key:<12}{what}\n"));
    }
    help + "\nExit codes: 0 all well, 1 no window or a failure while running, 2 bad input or usage"
}

/// Shows a scene of rigid bodies in a window, or makes a picture or an animation of it.
#[derive(Clone, Debug, Parser)]
#[command(
    name = "tumble-view",
    version,
    after_help = after_help()
)]
pub(crate) struct Options {
    /// A .json, .ron, .gltf, .glb or .urdf file, or the name of a built-in scene
    ///
    /// What has an extension or a slash is a file.
    #[arg(value_name = "SCENE", default_value = "stress")]
    pub(crate) scene: String,
    /// Bodies of a generated scene [default: 10000 of stress, see docs/scenes.md for others]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u64).range(1..=MAX_BODIES as u64))]
    bodies: Option<u64>,
    /// Seed of a generated scene [default: 0]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    seed: Option<u64>,
    /// Time step in seconds, such as 1/60, 0.01 or 5ms, instead of the scene's
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = dt)]
    dt: Option<Real>,
    /// Equal parts that each step is divided into
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..=i64::from(Settings::MAX_SUBSTEPS)))]
    substeps: Option<u32>,
    /// semi-implicit-euler, runge-kutta4 or moser-veselov
    #[arg(long, value_name = "NAME", value_parser = str::parse::<Integrator>)]
    integrator: Option<Integrator>,
    #[command(flatten)]
    pub(crate) view: ViewOptions,
    /// Write a picture to a .png file instead of showing the scene
    #[arg(long, value_name = "FILE", conflicts_with_all = ["animation", "paused"])]
    screenshot: Option<PathBuf>,
    /// The moment of the picture in simulated seconds
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = seconds, requires = "screenshot", default_value = "0")]
    at: f64,
    /// Write an animation to a .gif file instead of showing the scene
    #[arg(long, value_name = "FILE", conflicts_with = "paused")]
    animation: Option<PathBuf>,
    /// Where the animation begins in simulated seconds
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = seconds, requires = "animation", default_value = "0")]
    from: f64,
    /// How long the animation is, in simulated seconds
    #[arg(long = "for", value_name = "S", allow_negative_numbers = true, value_parser = seconds, requires = "animation", default_value = "4")]
    duration: f64,
    /// Pictures of the animation for a second of watching it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=50), requires = "animation", default_value = "20")]
    fps: u16,
    /// Simulated seconds to a second of the window or the animation [default: 1, or what shows the
    /// scene in half a minute]
    #[arg(long, value_name = "X", allow_negative_numbers = true, value_parser = speed)]
    pub(crate) speed: Option<f64>,
    /// Do not begin to run before space is pressed
    #[arg(long)]
    pub(crate) paused: bool,
}

/// What is seen, and from where.
#[derive(Clone, Debug, Args)]
pub(crate) struct ViewOptions {
    /// Width and height of the window or picture
    #[arg(long, value_name = "WxH", default_value = "1280x720")]
    pub(crate) size: Size,
    /// What to show, with commas: momentum, angular-momentum, angular-velocity, axes, ellipsoids,
    /// forces, springs, contacts, colliders, trails, names, grid, water, ledger, settings, times,
    /// legend; or none
    #[arg(long, value_name = "LIST")]
    pub(crate) show: Option<Layers>,
    /// The body to show the figures of, by its name
    #[arg(long, value_name = "NAME")]
    pub(crate) pick: Option<String>,
    /// Keep the body of --pick in the middle
    #[arg(long, requires = "pick")]
    pub(crate) follow: bool,
    /// Degrees about the axis that points up and above the horizon, and, if given, the distance in
    /// parts of the one from which all is seen
    #[arg(long, value_name = "YAW,PITCH[,DISTANCE]", allow_hyphen_values = true)]
    pub(crate) camera: Option<Angles>,
    /// The axis that points up [default: against gravity, or around what orbits]
    #[arg(long, value_name = "AXIS")]
    pub(crate) up: Option<Up>,
}

/// What is to be made of the scene, and the files for it: by their paths first, open then.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Task<File> {
    Window,
    Screenshot { file: File, at: f64 },
    Animation { file: File, from: f64, frames: u32, fps: u16 },
}

impl Task<PathBuf> {
    pub(crate) fn open(self) -> Result<Task<Output>, Failure> {
        Ok(match self {
            Self::Window => Task::Window,
            Self::Screenshot { file, at } => Task::Screenshot { file: Output::create(file)?, at },
            Self::Animation { file, from, frames, fps } => {
                Task::Animation { file: Output::create(file)?, from, frames, fps }
            }
        })
    }
}

impl Options {
    /// Those of a page, which has no command line: a parser of one would be a part of what it
    /// loads.
    pub(crate) fn of_page() -> Self {
        let size = Size { width: 1280, height: 720 };
        let view =
            ViewOptions { size, show: page::SHOWN.parse().ok(), pick: None, follow: false, camera: None, up: None };
        Self {
            scene: page::SCENE.to_owned(),
            bodies: None,
            seed: None,
            dt: None,
            substeps: None,
            integrator: None,
            view,
            screenshot: None,
            at: 0.0,
            animation: None,
            from: 0.0,
            duration: 4.0,
            fps: 20,
            speed: None,
            paused: false,
        }
    }

    /// The scene with the options applied.
    pub(crate) fn scene(&self) -> Result<Scene, Failure> {
        let mut scene = Scene::open_with(&self.scene, self.bodies, self.seed)?;
        let settings = &mut scene.settings;
        settings.dt = self.dt.unwrap_or(settings.dt);
        settings.substeps = self.substeps.unwrap_or(settings.substeps);
        settings.integrator = self.integrator.unwrap_or(settings.integrator);
        Ok(scene)
    }

    /// What to do, with its files and times checked against the scene's step, and the simulated
    /// seconds in one of watching.
    pub(crate) fn task(&self, dt: Real, pace: f64) -> Result<Task<PathBuf>, Failure> {
        let check = |option: &str, seconds: f64| {
            let steps = steps_of_duration(seconds, dt);
            steps.map(drop).map_err(|problem| Failure::Input(format!("{option} {problem}")))
        };
        if let Some(file) = &self.screenshot {
            ends_in(file, "png", "--screenshot")?;
            check("--at", self.at)?;
            return Ok(Task::Screenshot { file: file.clone(), at: self.at });
        }
        let Some(file) = &self.animation else { return Ok(Task::Window) };
        ends_in(file, "gif", "--animation")?;
        check("--from", self.from)?;
        check("--for", self.duration)?;
        check("--for", self.from + self.duration)?;
        let frames = frame_count(self.duration / pace, self.fps, self.view.size)?;
        Ok(Task::Animation { file: file.clone(), from: self.from, frames, fps: self.fps })
    }
}

/// Pictures of an animation of this many seconds, if that is not too many.
fn frame_count(seconds: f64, fps: u16, size: Size) -> Result<u32, Failure> {
    let frames = (seconds * f64::from(fps)).round().max(1.0);
    let bytes = 3.0 * f64::from(size.width) * f64::from(size.height) * frames;
    if frames > MAX_FRAMES {
        Err(Failure::Input(format!(
            "--for: {frames} pictures are more than {MAX_FRAMES}, the most an animation may have"
        )))
    } else if bytes > MAX_BYTES {
        Err(Failure::Input(format!(
            "--for: {frames} pictures of this --size are more than fit into {MAX_BYTES:e} bytes"
        )))
    } else {
        Ok(frames as u32)
    }
}

fn ends_in(file: &std::path::Path, ending: &str, option: &str) -> Result<(), Failure> {
    if file.extension().is_some_and(|found| found.eq_ignore_ascii_case(ending)) {
        Ok(())
    } else {
        Err(Failure::Input(format!("{option}: {} does not end in .{ending}", file.display())))
    }
}

/// Width and height in points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Size {
    pub(crate) width: u32,
    pub(crate) height: u32,
}

impl Size {
    pub(crate) fn points(self) -> DVec2 {
        DVec2::new(f64::from(self.width), f64::from(self.height))
    }
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let edge = |text: &str| text.parse().ok().filter(|edge| EDGES.contains(edge));
        let size = text.split_once('x').and_then(|(width, height)| Some((edge(width)?, edge(height)?)));
        let (width, height) = size.ok_or_else(|| {
            format!("is to be width x height such as 1280x720, each from {} to {}", EDGES.start(), EDGES.end())
        })?;
        Ok(Self { width, height })
    }
}

/// Where the camera is to stand. Angles in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Angles {
    yaw: f64,
    pitch: f64,
    /// In parts of the distance from which all is seen.
    distance: f64,
}

impl Angles {
    pub(crate) fn apply(self, camera: &mut Camera) {
        (camera.yaw, camera.pitch) = (0.0, 0.0);
        camera.turn(self.yaw.to_radians(), self.pitch.to_radians());
        camera.distance *= self.distance;
    }
}

impl FromStr for Angles {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let numbers: Vec<f64> =
            text.split(',').map(str::parse).collect::<Result<_, _>>().map_err(|_| "is to be numbers".to_owned())?;
        let (yaw, pitch, distance) = match numbers[..] {
            [yaw, pitch] => (yaw, pitch, 1.0),
            [yaw, pitch, distance] => (yaw, pitch, distance),
            _ => return Err("is to be two or three numbers".to_owned()),
        };
        if !yaw.is_finite() || !(-90.0..=90.0).contains(&pitch) {
            return Err("angles are to be finite, and the second from -90 to 90 degrees".to_owned());
        }
        if !DISTANCES.contains(&distance) {
            let (nearest, farthest) = (DISTANCES.start(), DISTANCES.end());
            return Err(format!("the distance is to be from {nearest:e} to {farthest:e}, not {distance}"));
        }
        Ok(Self { yaw, pitch, distance })
    }
}

fn dt(text: &str) -> Result<Real, String> {
    time_step(parse_seconds(text)?)
}

fn seconds(text: &str) -> Result<f64, String> {
    let seconds = parse_seconds(text)?;
    if seconds >= 0.0 { Ok(seconds) } else { Err("must be a time from 0 on".to_owned()) }
}

fn speed(text: &str) -> Result<f64, String> {
    let speed = number(text)?;
    if speed.is_finite() && speed > 0.0 { Ok(speed) } else { Err("must be positive and finite".to_owned()) }
}

fn number(text: &str) -> Result<f64, String> {
    text.parse().map_err(|_| "not a number".to_owned())
}

#[cfg(test)]
pub(crate) mod tests {
    use clap::CommandFactory as _;

    use super::*;

    pub(crate) fn options(arguments: &[&str]) -> Result<Options, clap::Error> {
        Options::try_parse_from(["tumble-view"].iter().chain(arguments))
    }

    #[test]
    fn the_definition_is_consistent() {
        Options::command().debug_assert();
    }

    #[test]
    fn options_of_the_page_are_those_of_its_scene_and_what_it_shows() {
        let read = options(&[page::SCENE, "--show", page::SHOWN]).unwrap();
        assert!(read.view.show.is_some());
        assert_eq!(format!("{:?}", Options::of_page()), format!("{read:?}"));
    }

    #[test]
    fn the_help_names_the_keys() {
        let help = Options::command().render_help().to_string();
        for line in ["Shift drag  grab and throw", "O           shoot a ball", "U           show water"] {
            assert!(help.contains(line), "{line}: {help}");
        }
    }

    #[test]
    fn absurd_values_are_refused() {
        for bad in [
            ["--size", "1280"],
            ["--size", "0x720"],
            ["--size", "99999x99999"],
            ["--camera", "10"],
            ["--camera", "10,100"],
            ["--camera", "10,20,0"],
            ["--camera", "nan,20"],
            ["--show", "everything"],
            ["--up", "w"],
            ["--dt", "0"],
            ["--dt", "nan"],
            ["--speed", "-1"],
            ["--bodies", "0"],
            ["--integrator", "euler"],
        ] {
            let error = options(&bad).unwrap_err();
            assert_eq!(error.exit_code(), 2, "{bad:?}");
            assert!(error.to_string().contains(bad[0]), "{bad:?}: {error}");
        }
        assert!(options(&["--at", "1"]).is_err());
        assert!(options(&["--screenshot", "a.png", "--at", "-1"]).is_err());
        assert!(options(&["--screenshot", "a.png", "--animation", "a.gif"]).is_err());
        assert!(options(&["--animation", "a.gif", "--fps", "0"]).is_err());
    }

    #[test]
    fn tasks_are_checked() {
        let task = |arguments: &[&str]| options(arguments).unwrap().task(0.01, 1.0);
        assert_eq!(task(&[]).unwrap(), Task::Window);
        let picture = task(&["--screenshot", "a.PNG", "--at", "2.5"]).unwrap();
        assert_eq!(picture, Task::Screenshot { file: "a.PNG".into(), at: 2.5 });
        let error = task(&["--screenshot", "a.jpg"]).unwrap_err().to_string();
        assert_eq!(error, "--screenshot: a.jpg does not end in .png");
        // More steps than there may be.
        assert!(task(&["--screenshot", "a.png", "--at", "1e300"]).is_err());
        let (small, large) = (Size { width: 320, height: 180 }, Size { width: 3200, height: 1800 });
        assert_eq!(frame_count(4.0, 20, small).unwrap(), 80);
        assert!(frame_count(1000.0, 20, small).is_err() && frame_count(10.0, 20, large).is_err());
    }

    #[test]
    fn a_camera_is_placed_in_degrees() {
        let mut camera = Camera { up: Up::Y, yaw: 0.0, pitch: 0.0, distance: 10.0, target: Default::default() };
        "90,-30,0.5".parse::<Angles>().unwrap().apply(&mut camera);
        assert!((camera.yaw - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
        assert!((camera.pitch + std::f64::consts::FRAC_PI_6).abs() < 1e-12);
        assert_eq!(camera.distance, 5.0);
    }
}
