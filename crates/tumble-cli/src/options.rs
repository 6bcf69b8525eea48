//! The command line.

use std::ffi::OsString;
use std::num::NonZeroU64;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueHint};
use clap_complete::Shell;
use tumble::math::Real;
use tumble::{Integrator, Settings};
use tumble_scene::{MAX_BODIES, TIME_STEPS, parse_count, parse_seconds, step_count, time_step};

use crate::scenes;
use crate::sweep::options::{MergeOptions, SweepOptions};

/// Threads that can be asked for.
const MAX_THREADS: u64 = 1024;

/// Simulates rigid bodies.
///
/// Without arguments: moves 10 000 tumbling shapes, says how that went and what to try next.
/// `tumble wall` is `tumble run wall`; `tumble scenes` lists the built-in scenes.
#[derive(Debug, Parser)]
#[command(name = "tumble", version, after_help = format!("{}\n\n{EXIT_CODES}", scenes::named()))]
pub(crate) struct Options {
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
}

const EXIT_CODES: &str = "Exit codes: 0 all well, 1 a failure while running, 2 bad input or usage, 130 interrupted";

const COMPLETIONS: &str = "\
bash:  tumble completions bash > ~/.local/share/bash-completion/completions/tumble
zsh:   tumble completions zsh > _tumble, in a folder of $fpath
fish:  tumble completions fish > ~/.config/fish/completions/tumble.fish";

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Run a scene and report what happened
    #[command(after_help = format!("{}\n\n{EXIT_CODES}", scenes::named()))]
    Run(RunOptions),
    /// Show a scene in a window, which is the program tumble-view
    #[command(disable_help_flag = true)]
    View(ViewOptions),
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
    /// Time scenes here and in Rapier, in one run on this machine (feature `compare`)
    #[command(after_help = EXIT_CODES)]
    Compare(CompareOptions),
    /// List the built-in scenes
    Scenes,
    /// Write a script by which a shell completes commands and options
    #[command(after_help = COMPLETIONS)]
    Completions {
        /// The shell
        shell: Shell,
    },
    /// Write the page for `man`: of the program, or of one of its commands
    #[command(after_help = "To read it: tumble man run | man -l -")]
    Man {
        /// The command [default: the program]
        command: Option<String>,
    },
}

#[derive(Debug, Default, Args)]
pub(crate) struct RunOptions {
    /// A .json, .ron, .gltf, .glb or .urdf file, or the name of a built-in scene [default: stress]
    ///
    /// What has an extension or a slash is a file.
    #[arg(value_name = "SCENE", value_hint = ValueHint::FilePath)]
    pub(crate) scene: Option<String>,
    #[command(flatten)]
    pub(crate) stepping: StepOptions,
    /// Bodies of a generated scene [default: 10000 of stress, see docs/scenes.md for others]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = bodies)]
    pub(crate) bodies: Option<u64>,
    /// Seed of a generated scene [default: 0]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub(crate) seed: Option<u64>,
    /// Write the states of all bodies to a .csv, .parquet or .glb file
    #[arg(long, value_name = "FILE")]
    pub(crate) record: Option<PathBuf>,
    /// Record every K-th step [default: 1]
    #[arg(long, value_name = "K", allow_negative_numbers = true, requires = "record", value_parser = every)]
    pub(crate) every: Option<NonZeroU64>,
    /// Write report.html, summary.json, ledger.csv, energy.svg and drift.svg into a directory,
    /// which is made if need be
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub(crate) report: Option<PathBuf>,
    /// Open the report's page in a browser at the end
    #[arg(long, requires = "report")]
    pub(crate) open: bool,
    /// Print one JSON object instead of the table; docs/program.md has its keys
    #[arg(long, conflicts_with = "quiet")]
    pub(crate) json: bool,
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

#[derive(Debug, Args)]
pub(crate) struct ViewOptions {
    /// A scene and options of tumble-view; `tumble view --help` lists those
    #[arg(value_name = "ARGUMENTS", allow_hyphen_values = true, trailing_var_arg = true)]
    pub(crate) arguments: Vec<OsString>,
}

/// What to compare.
#[derive(Debug, Args)]
#[cfg_attr(not(feature = "compare"), allow(dead_code, reason = "read by the comparison, which this build has not"))]
pub(crate) struct CompareOptions {
    /// Scenes of balls, boxes, capsules and cylinders without joints, or `worlds`, which is many
    /// small ones at once [default: stress pyramid spheres worlds]
    #[arg(value_name = "SCENE", value_hint = ValueHint::FilePath)]
    pub(crate) scenes: Vec<String>,
    /// Threads of both [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=MAX_THREADS))]
    pub(crate) threads: Option<u64>,
}

/// How long to run, and how.
#[derive(Debug, Default, Args)]
pub(crate) struct StepOptions {
    /// Steps to run, such as 600 or 1e6, instead of the scene's
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = steps, conflicts_with = "duration")]
    pub(crate) steps: Option<u64>,
    /// Simulated time to run, such as 2.5, 500ms, 2s or 5min, rounded to whole steps
    #[arg(long, value_name = "S", allow_negative_numbers = true, value_parser = duration)]
    pub(crate) duration: Option<f64>,
    /// Time step in seconds, such as 1/60, 0.01 or 5ms, instead of the scene's
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
    #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
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
    step_count(parse_count(text)?)
}

fn bodies(text: &str) -> Result<u64, String> {
    count_up_to(text, MAX_BODIES as u64)
}

pub(crate) fn every(text: &str) -> Result<NonZeroU64, String> {
    NonZeroU64::new(parse_count(text)?).ok_or_else(|| "must be 1 or more".to_owned())
}

/// A whole number from 1 to the largest.
pub(crate) fn count_up_to(text: &str, largest: u64) -> Result<u64, String> {
    match parse_count(text)? {
        count if (1..=largest).contains(&count) => Ok(count),
        count => Err(format!("must be from 1 to {largest}, not {count}")),
    }
}

fn dt(text: &str) -> Result<Real, String> {
    time_step(parse_seconds(text)?)
}

fn duration(text: &str) -> Result<f64, String> {
    let seconds = parse_seconds(text)?;
    // The longest run of the longest steps.
    let longest = TIME_STEPS.end() * tumble_scene::MAX_STEPS as f64;
    if (0.0..=longest).contains(&seconds) {
        Ok(seconds)
    } else {
        Err(format!("must be from 0 to {longest:e} seconds, not {seconds}"))
    }
}

fn density(text: &str) -> Result<f64, String> {
    let density: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    if density.is_finite() && density > 0.0 { Ok(density) } else { Err("must be positive and finite".to_owned()) }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;

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
    fn sensible_values_are_taken() {
        let options =
            run(&["iss", "--duration", "2.5", "--dt", "0.25", "--threads", "1024", "--integrator", "runge-kutta4"]);
        let options = options.unwrap();
        let stepping = options.stepping;
        assert_eq!((stepping.duration, stepping.dt), (Some(2.5), Some(0.25)));
        assert_eq!(stepping.integrator, Some(Integrator::RungeKutta4));
    }

    #[test]
    fn times_have_units_and_counts_have_exponents() {
        let options = run(&["spheres", "--dt", "1/60", "--steps", "1e6", "--bodies", "2e3"]).unwrap();
        // The default of scenes, to the bit.
        assert_eq!(options.stepping.dt, Some(Settings::default().dt));
        assert_eq!((options.stepping.steps, options.bodies), (Some(1_000_000), Some(2000)));
        for (text, seconds) in [("2s", 2.0), ("500ms", 0.5), ("2min", 120.0)] {
            assert_eq!(run(&["iss", "--duration", text]).unwrap().stepping.duration, Some(seconds));
        }
        let refusal = run(&["--dt", "soon"]).unwrap_err().to_string();
        assert!(refusal.contains("'soon'") && refusal.contains("1/60"), "{refusal}");
    }
}
