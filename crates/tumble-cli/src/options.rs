//! The command line.

use std::ffi::OsString;
use std::num::NonZeroU64;
use std::path::PathBuf;

use clap::{Args, CommandFactory as _, Parser, Subcommand};
use tumble::math::Real;
use tumble::{Integrator, Settings};
use tumble_scene::{MAX_BODIES, TIME_STEPS, step_count, time_step};

use crate::sweep::options::{MergeOptions, SweepOptions};

/// Threads that can be asked for.
const MAX_THREADS: u64 = 1024;

/// Simulates rigid bodies.
///
/// Without arguments: moves 10 000 tumbling shapes, says how that went and what to try next.
/// `tumble wall` is `tumble run wall`; `tumble scenes` lists the built-in scenes.
#[derive(Debug, Parser)]
#[command(version, after_help = EXIT_CODES)]
pub(crate) struct Options {
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
}

const EXIT_CODES: &str = "Exit codes: 0 all well, 1 a failure while running, 2 bad input or usage, 130 interrupted";

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Run a scene and report what happened
    #[command(after_help = EXIT_CODES)]
    Run(RunOptions),
    /// Run many worlds of one scene whose fields differ, at random or over a grid
    #[command(after_help = EXIT_CODES)]
    Sweep(SweepOptions),
    /// Put the shards of a sweep together
    #[command(after_help = "Exit codes: 0 all well, 1 a failure while writing, 2 bad input or usage")]
    Merge(MergeOptions),
    /// Show the mass properties and joints of a scene, a robot or a mesh, and what is wrong with
    /// them
    #[command(after_help = "Exit codes: 0 all well, 2 bad input or a body or joint with problems")]
    Inspect(InspectOptions),
    /// List the built-in scenes
    Scenes,
}

/// The arguments with `run` before a first one that is a built-in scene, nearly one, or a file.
pub(crate) fn with_command(arguments: impl Iterator<Item = OsString>) -> Vec<OsString> {
    let mut arguments: Vec<_> = arguments.collect();
    let is_scene = |name: &str| {
        let is_command = Options::command().get_subcommands().any(|command| command.get_name() == name);
        let is_file = name.contains(['.', '/', std::path::MAIN_SEPARATOR]);
        !is_command && !name.starts_with('-') && (is_file || tumble_scene::nearest_builtin(name).is_some())
    };
    if arguments.get(1).and_then(|first| first.to_str()).is_some_and(is_scene) {
        arguments.insert(1, "run".into());
    }
    arguments
}

#[derive(Debug, Default, Args)]
pub(crate) struct RunOptions {
    /// A .json, .ron, .gltf, .glb or .urdf file, or the name of a built-in scene [default: stress]
    ///
    /// What has an extension or a slash is a file.
    #[arg(value_name = "SCENE")]
    pub(crate) scene: Option<String>,
    #[command(flatten)]
    pub(crate) stepping: StepOptions,
    /// Bodies of a generated scene [default: 10000 of stress, see docs/scenes.md for others]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u64).range(1..=MAX_BODIES as u64))]
    pub(crate) bodies: Option<u64>,
    /// Seed of a generated scene [default: 0]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub(crate) seed: Option<u64>,
    /// Write the states of all bodies to a .csv, .parquet or .glb file
    #[arg(long, value_name = "FILE")]
    pub(crate) record: Option<PathBuf>,
    /// Record every K-th step [default: 1]
    #[arg(long, value_name = "K", allow_negative_numbers = true, requires = "record")]
    pub(crate) every: Option<NonZeroU64>,
    /// Write report.html, summary.json, ledger.csv, energy.svg and drift.svg into a directory,
    /// which is made if need be
    #[arg(long, value_name = "DIR")]
    pub(crate) report: Option<PathBuf>,
    /// Take the nearest possible inertia for bodies of a .gltf, .glb or .urdf file whose own is
    /// impossible, and say so of each
    #[arg(long)]
    pub(crate) repair: bool,
    /// Replace files that this program did not write
    #[arg(long)]
    pub(crate) force: bool,
    /// Print nothing unless something goes wrong
    #[arg(long)]
    pub(crate) quiet: bool,
}

/// How long to run, and how.
#[derive(Debug, Default, Args)]
pub(crate) struct StepOptions {
    /// Steps to run, instead of the scene's
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = steps, conflicts_with = "duration")]
    pub(crate) steps: Option<u64>,
    /// Simulated time to run in seconds, rounded to whole steps
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = duration)]
    pub(crate) duration: Option<f64>,
    /// Time step in seconds, instead of the scene's
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = dt)]
    pub(crate) dt: Option<Real>,
    /// Equal parts that each step is divided into
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..=i64::from(Settings::MAX_SUBSTEPS)))]
    pub(crate) substeps: Option<u32>,
    /// semi-implicit-euler, runge-kutta4 or moser-veselov
    #[arg(long, value_name = "NAME", value_parser = str::parse::<Integrator>)]
    pub(crate) integrator: Option<Integrator>,
    /// Threads [default: one for each core]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u64).range(1..=MAX_THREADS))]
    pub(crate) threads: Option<u64>,
}

#[derive(Debug, Args)]
pub(crate) struct InspectOptions {
    /// A scene (.json, .ron, .gltf, .glb), a robot (.urdf), a mesh (.obj, .stl, .gltf, .glb), or
    /// the name of a built-in scene
    #[arg(value_name = "FILE")]
    pub(crate) file: String,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Density of a mesh in kg/m^3 [default: 1]
    #[arg(long, value_name = "D", allow_negative_numbers = true, value_parser = density)]
    pub(crate) density: Option<f64>,
    /// Repair a mesh where there is no doubt how, or take the nearest possible inertia of a .gltf,
    /// .glb or .urdf file's bodies, and say what was done
    #[arg(long)]
    pub(crate) repair: bool,
    /// Draw a body to an .svg file
    #[arg(long, value_name = "FILE")]
    pub(crate) draw: Option<PathBuf>,
    /// Replace a file that this program did not write
    #[arg(long, requires = "draw")]
    pub(crate) force: bool,
    /// The body to show and draw, by its name [default: show all, draw the first]
    #[arg(long, value_name = "NAME")]
    pub(crate) body: Option<String>,
}

fn steps(text: &str) -> Result<u64, String> {
    step_count(text.parse().map_err(|error| format!("{error}"))?)
}

fn dt(text: &str) -> Result<Real, String> {
    time_step(number(text)?)
}

fn duration(text: &str) -> Result<f64, String> {
    let seconds = number(text)?;
    // The longest run of the longest steps.
    let longest = TIME_STEPS.end() * tumble_scene::MAX_STEPS as f64;
    if (0.0..=longest).contains(&seconds) {
        Ok(seconds)
    } else {
        Err(format!("must be from 0 to {longest:e} seconds, not {seconds}"))
    }
}

fn density(text: &str) -> Result<f64, String> {
    let density = number(text)?;
    if density.is_finite() && density > 0.0 { Ok(density) } else { Err("must be positive and finite".to_owned()) }
}

fn number(text: &str) -> Result<f64, String> {
    text.parse().map_err(|_| "not a number".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(arguments: &[&str]) -> Result<RunOptions, clap::Error> {
        let all = ["tumble", "run"].iter().chain(arguments);
        Options::try_parse_from(all).map(|options| match options.command {
            Some(Command::Run(options)) => options,
            other => panic!("not run: {other:?}"),
        })
    }

    #[test]
    fn the_definition_is_consistent() {
        Options::command().debug_assert();
    }

    #[test]
    fn absurd_values_are_refused() {
        for bad in [
            ["--dt", "0"],
            ["--dt", "-0.1"],
            ["--dt", "nan"],
            ["--dt", "inf"],
            ["--dt", "1e300"],
            ["--dt", "1e-300"],
            ["--steps", "1e300"],
            ["--steps", "-1"],
            ["--steps", "99999999999999999999"],
            ["--steps", "1000000000001"],
            ["--duration", "nan"],
            ["--duration", "-1"],
            ["--duration", "1e300"],
            ["--substeps", "0"],
            ["--substeps", "1000001"],
            ["--threads", "0"],
            ["--threads", "1025"],
            ["--bodies", "0"],
            ["--bodies", "1000000000000"],
            ["--seed", "-1"],
            ["--integrator", "euler"],
        ] {
            let error = run(&bad).unwrap_err();
            assert_eq!(error.exit_code(), 2, "{bad:?}");
            assert!(error.to_string().contains(bad[0]), "{bad:?}: {error}");
        }
        assert!(run(&["--steps", "1", "--duration", "1"]).is_err());
        assert!(run(&["--every", "2"]).is_err());
        assert!(run(&["--every", "0", "--record", "a.csv"]).is_err());
    }

    #[test]
    fn scenes_and_files_are_run_without_the_word() {
        let with_command = |arguments: &[&str]| -> Vec<String> {
            let all = ["tumble"].iter().chain(arguments).map(OsString::from);
            super::with_command(all).into_iter().skip(1).map(|argument| argument.into_string().unwrap()).collect()
        };
        assert_eq!(with_command(&["wall", "--steps", "3"]), ["run", "wall", "--steps", "3"]);
        assert_eq!(with_command(&["piramid"]), ["run", "piramid"]);
        assert_eq!(with_command(&["my.json"]), ["run", "my.json"]);
        for unchanged in
            [&["run", "wall"][..], &["inspect", "iss"], &["--help"], &["scenes"], &["nothing-like-it"], &[]]
        {
            assert_eq!(with_command(unchanged), unchanged);
        }
    }

    #[test]
    fn sensible_values_are_taken() {
        let options =
            run(&["iss", "--duration", "2.5", "--dt", "0.25", "--threads", "1024", "--integrator", "runge-kutta4"]);
        let options = options.unwrap();
        let stepping = options.stepping;
        assert_eq!((stepping.duration, stepping.dt), (Some(2.5), Some(0.25)));
        assert_eq!(stepping.integrator, Some(Integrator::RungeKutta4));
    }
}
