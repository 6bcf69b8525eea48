//! The command line.

use std::error::Error;

use crate::LEVELS;

/// What `--help` prints.
pub(crate) const HELP: &str = "\
Dock with a tumbling satellite.

Usage: docking [OPTIONS]

Options:
      --autopilot               Begin with the autopilot on
      --level N                 1 drifts, 2 tumbles, 3 flips over now and then [default: 2]
      --start N                 Another attitude and place to start from [default: 0]
      --screenshot FILE         Fly the autopilot to a time at once, write a .png file and end
      --at SECONDS              That time [default: 0]
  -h, --help                    Print this

Keys:
  W S, A D, E Q                 Push forward and back, left and right, up and down
  arrows, Z C                   Pitch and yaw, roll
  X                             Brake: stop drifting past the satellite
  H, M                          Hold the attitude, match the tumble of the satellite
  P                             The autopilot, on or off
  1 2 3                         The level
  N, Backspace                  Another start, the same start again
  K, L                          Keep this moment, go back to it
  Escape                        Quit

The latches catch within 0.25 m, 0.3 m/s, 10 degrees and 4.6 degrees a second. A way to win: M; turn
until the ring is in the middle of the dial; X; push until the cross is too; X; W for a second.
";

/// What the command line asks for.
#[derive(Debug, Default)]
pub(crate) struct Options {
    pub(crate) autopilot: bool,
    pub(crate) level: usize,
    pub(crate) seed: u64,
    pub(crate) screenshot: Option<String>,
    pub(crate) at: f64,
}

impl Options {
    /// Those of this process, which ends where they make no sense.
    pub(crate) fn of_process() -> Self {
        if std::env::args().skip(1).any(|word| ["-h", "--help"].contains(&word.as_str())) {
            print!("{HELP}");
            std::process::exit(0);
        }
        Self::parse(std::env::args().skip(1)).unwrap_or_else(|error| {
            eprintln!("docking: {error}");
            std::process::exit(2)
        })
    }

    pub(crate) fn parse(mut words: impl Iterator<Item = String>) -> Result<Self, Box<dyn Error>> {
        let mut options = Self { level: 1, ..Self::default() };
        while let Some(word) = words.next() {
            let mut value = || words.next().ok_or(format!("{word} needs a value"));
            match word.as_str() {
                "--autopilot" => options.autopilot = true,
                "--level" => options.level = level(&value()?)?,
                "--start" => options.seed = number(&word, &value()?)?,
                "--screenshot" => options.screenshot = Some(picture(value()?)?),
                "--at" => options.at = moment(&value()?)?,
                _ => {
                    return Err(
                        format!("{word}: try --autopilot, --level, --start, --screenshot, --at or --help").into()
                    );
                }
            }
        }
        Ok(options)
    }
}

fn number<T: std::str::FromStr>(option: &str, value: &str) -> Result<T, String> {
    value.parse().map_err(|_| format!("{option} {value}: that is no number for it"))
}

/// The name of a file that pictures are written to.
fn picture(file: String) -> Result<String, String> {
    if file.ends_with(".png") { Ok(file) } else { Err(format!("--screenshot {file}: only .png files are written")) }
}

/// A time that a flight gets to \[s\].
fn moment(value: &str) -> Result<f64, String> {
    let time: f64 = number("--at", value)?;
    let flown = (0.0..=LONGEST).contains(&time).then_some(time);
    flown.ok_or(format!("--at {value}: from 0 to {LONGEST} seconds"))
}

/// More than any tank lasts \[s\].
const LONGEST: f64 = 3600.0;

/// Counted from zero, where the player counts from one.
fn level(value: &str) -> Result<usize, String> {
    let level: usize = number("--level", value)?;
    let index = level.checked_sub(1).filter(|index| *index < LEVELS.len());
    index.ok_or(format!("--level {value}: there are 1 to {}", LEVELS.len()))
}
