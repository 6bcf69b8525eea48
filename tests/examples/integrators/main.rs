//! Runs the three integrators on bodies whose motion is known exactly, prints how far each is off
//! and what it costs, and draws it.
//!
//! ```text
//! cargo run --release --example integrators                    in single precision
//! cargo run --release --example integrators --features f64     the same in double precision
//!                      work and precision, and ten minutes beside eight other engines
//!     --out DIR        where the pictures go (target/integrators)
//!     --precision      only work and precision
//!     --peers          only the comparison with other engines
//! ```

mod cost;
mod peers;
mod pictures;
mod precision;

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

use tumble_record::Plot;

/// What was asked for.
struct Options {
    out: PathBuf,
    precision: bool,
    peers: bool,
}

impl Options {
    fn parse(mut arguments: impl Iterator<Item = String>) -> Result<Self, String> {
        let mut options = Self { out: PathBuf::from("target/integrators"), precision: true, peers: true };
        while let Some(argument) = arguments.next() {
            match argument.as_str() {
                "--out" => options.out = arguments.next().ok_or("--out needs a directory")?.into(),
                "--precision" => options.peers = false,
                "--peers" => options.precision = false,
                other => {
                    return Err(format!("there is no option {other}; there are --out DIR, --precision and --peers"));
                }
            }
        }
        Ok(options)
    }
}

/// A picture and the name of its file.
type Picture = (String, Plot);

fn main() -> ExitCode {
    match Options::parse(std::env::args().skip(1)).and_then(|options| run(&options)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("integrators: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(options: &Options) -> Result<(), String> {
    let mut pictures = Vec::new();
    say(&format!("Numbers of the simulation: {}; vector code: {}\n", tumble::math::PRECISION, tumble::simd_name()))?;
    if options.precision {
        let rows = precision::measure();
        say(&precision::table(&rows))?;
        pictures.extend(precision::draw(&rows));
        pictures.extend(pictures::draw());
    }
    if options.peers {
        say(&peers::tables())?;
    }
    for (name, plot) in pictures {
        write(&options.out.join(format!("{name}-{}.svg", tumble::math::PRECISION)), &plot)?;
    }
    Ok(())
}

fn write(path: &std::path::Path, plot: &Plot) -> Result<(), String> {
    let directory = path.parent().unwrap_or(path);
    std::fs::create_dir_all(directory).map_err(|error| format!("{}: {error}", directory.display()))?;
    std::fs::write(path, plot.to_svg()).map_err(|error| format!("{}: {error}", path.display()))?;
    say(&format!("wrote {}\n", path.display()))
}

/// To standard output, which may be closed.
fn say(text: &str) -> Result<(), String> {
    std::io::stdout().write_all(text.as_bytes()).map_err(|error| format!("standard output: {error}"))
}

/// Adds a line to a text.
fn line(text: &mut String, line: std::fmt::Arguments<'_>) {
    // Writing to a string cannot fail.
    let _ = text.write_fmt(line);
    text.push('\n');
}
