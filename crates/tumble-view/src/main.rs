//! A window that shows a scene of rigid bodies, and pictures and animations of one.
//!
//! Exit codes: 0 all well, 1 no window or a failure while running, 2 bad input or usage.

#![cfg_attr(
    feature = "f64",
    allow(
        clippy::useless_conversion,
        clippy::unnecessary_cast,
        reason = "Real is f64 in this build; the same line converts from f32 in the other"
    )
)]

mod animation;
mod arrows;
mod balls;
mod bodies;
mod camera;
mod clock;
mod colliders;
mod convert;
mod failure;
mod framing;
mod gallery;
mod glyphs;
mod gpu;
mod hand;
mod layers;
mod lines;
mod open_window;
mod options;
mod overlay;
mod page;
mod palette;
mod pick;
mod picture;
mod playback;
mod readout;
mod sliders;
mod sunlight;
mod timing;
mod trails;
mod tuning;
mod viewport;
mod window;

use std::io::Write as _;
use std::process::ExitCode;

use clap::Parser as _;
use tumble_import::{printable, printable_lines};

use crate::failure::Failure;
use crate::options::Options;

const BAD_USAGE: u8 = 2;

fn main() -> ExitCode {
    std::panic::set_hook(Box::new(|panic| print(&format_args!("{panic}\n"))));
    let parsed = if page::IS_THERE { Ok(Options::of_page()) } else { Options::try_parse() };
    let options = match parsed {
        Ok(options) => options,
        Err(error) if error.use_stderr() => {
            print(&error.render());
            return ExitCode::from(BAD_USAGE);
        }
        // Help and version, which are this program's own words.
        Err(error) => error.exit(),
    };
    match run(&options) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            say(&failure);
            ExitCode::from(failure.exit_code())
        }
    }
}

/// Writes to standard error with what a terminal would obey escaped, but for ends of lines.
fn print(text: &impl std::fmt::Display) {
    drop(write!(std::io::stderr().lock(), "{}", printable_lines(&text.to_string())));
}

/// Writes a line to standard error; if even that is closed, the exit code has to do.
fn say(message: &impl std::fmt::Display) {
    print(&format_args!("tumble-view: {}\n", printable(&message.to_string())));
}

/// Everything that can be found wrong without a window is, before there is one.
fn run(options: &Options) -> Result<(), Failure> {
    let scene = options.scene()?;
    for notice in &scene.notices {
        say(&format_args!("note: {notice}"));
    }
    let pace = options.speed.unwrap_or_else(|| playback::pace(&scene));
    let task = options.task(scene.settings.dt, pace)?;
    let viewport = viewport::Viewport::new(scene, &options.view)?;
    open_window::open(viewport, task.open()?, pace, options)
}
