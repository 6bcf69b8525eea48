//! Runs force components on systems whose motion is known, prints how far each is off, and draws
//! it.
//!
//! ```text
//! cargo run --release --example forces --features f64
//!     --out DIR        where the pictures go (target/forces)
//! ```
//!
//! In single precision rounding hides what most of the tables show.

mod energy;
mod kepler;
mod spring;

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use tumble_record::Plot;

/// Text for the terminal, and pictures with the names of their files.
type Findings = (String, Vec<(&'static str, Plot)>);

/// What any of this can fail with.
type Failure = Box<dyn std::error::Error>;

fn main() -> ExitCode {
    match directory(std::env::args().skip(1)).and_then(|out| run(&out)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("forces: {error}");
            ExitCode::FAILURE
        }
    }
}

fn directory(mut arguments: impl Iterator<Item = String>) -> Result<PathBuf, Failure> {
    match (arguments.next().as_deref(), arguments.next()) {
        (None, _) => Ok(PathBuf::from("target/forces")),
        (Some("--out"), Some(directory)) => Ok(directory.into()),
        (Some("--out"), None) => Err("--out needs a directory".into()),
        (Some(other), _) => Err(format!("there is no option {other}; there is --out DIR").into()),
    }
}

fn run(out: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(out).map_err(|error| format!("{}: {error}", out.display()))?;
    say(&format!("Numbers of the simulation: {}; moser-veselov\n", tumble::math::PRECISION))?;
    for find in [kepler::find, spring::find, energy::find] {
        let (text, pictures) = find()?;
        say(&text)?;
        for (name, plot) in pictures {
            let path = out.join(format!("{name}-{}.svg", tumble::math::PRECISION));
            std::fs::write(&path, plot.to_svg()).map_err(|error| format!("{}: {error}", path.display()))?;
            say(&format!("wrote {}\n", path.display()))?;
        }
    }
    Ok(())
}

/// To standard output, which may be closed.
fn say(text: &str) -> Result<(), Failure> {
    writeln!(std::io::stdout(), "{text}").map_err(|error| format!("standard output: {error}").into())
}
