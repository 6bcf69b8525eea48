//! The command line.

use std::error::Error;

use crate::LEVELS;

/// What the command line asks for.
#[derive(Default)]
pub(crate) struct Options {
    pub(crate) autopilot: bool,
    pub(crate) level: usize,
    pub(crate) seed: u64,
    pub(crate) screenshot: Option<String>,
    pub(crate) at: f64,
}

impl Options {
    pub(crate) fn parse(mut words: impl Iterator<Item = String>) -> Result<Self, Box<dyn Error>> {
        let mut options = Self { level: 1, ..Self::default() };
        while let Some(word) = words.next() {
            let mut value = || words.next().ok_or(format!("{word} needs a value"));
            match word.as_str() {
                "--autopilot" => options.autopilot = true,
                "--level" => options.level = value()?.parse::<usize>()?.clamp(1, LEVELS.len()) - 1,
                "--start" => options.seed = value()?.parse()?,
                "--screenshot" => options.screenshot = Some(value()?),
                "--at" => options.at = value()?.parse()?,
                _ => return Err(format!("{word}: try --autopilot, --level, --start, --screenshot or --at").into()),
            }
        }
        Ok(options)
    }
}
