//! The `tumble` program: runs scenes of rigid bodies, sweeps over their fields, and inspects their
//! mass properties.
//!
//! Exit codes: 0 all well, 1 a failure while running, 2 bad input or usage, 130 interrupted (with
//! what was recorded until then finished and readable).

#[cfg(feature = "compare")]
mod compare;
mod ending;
mod failure;
mod first_run;
mod generated;
mod history;
mod inspect;
mod interrupt;
mod interval;
mod options;
mod outputs;
mod print;
mod progress;
mod replacing;
mod resolution;
mod run;
mod run_json;
mod scenes;
mod shorthand;
mod sweep;
mod table;
mod view;

use std::process::ExitCode;

use clap::Parser as _;

use crate::failure::Failure;
use crate::options::{Command, Options, RunOptions};
use crate::run::OutputForm;

const BAD_USAGE: u8 = 2;

#[cfg(not(feature = "compare"))]
const NO_RAPIER: &str = "this program was built without Rapier. From a clone of the repository, \
                         `cargo run --release --features compare -- compare` has it";

fn main() -> ExitCode {
    print::escape_panics();
    let options = match Options::try_parse_from(shorthand::with_command(std::env::args_os())) {
        Ok(options) => options,
        Err(error) if error.use_stderr() => {
            print::usage(error);
            return ExitCode::from(BAD_USAGE);
        }
        // Help and version, which are this program's own words.
        Err(error) => error.exit(),
    };
    let done = match options.command {
        None => run::run(&RunOptions::default(), OutputForm::Words),
        Some(Command::Run(options)) => run::run(&options, OutputForm::of(&options)),
        Some(Command::View(options)) => view::view(&options),
        Some(Command::Sweep(options)) => sweep::command::sweep(&options),
        Some(Command::Merge(options)) => sweep::merge::merge(&options),
        Some(Command::Inspect(options)) => inspect::inspect(&options),
        #[cfg(feature = "compare")]
        Some(Command::Compare(options)) => compare::compare(&options),
        #[cfg(not(feature = "compare"))]
        Some(Command::Compare(_)) => Err(Failure::Input(NO_RAPIER.to_owned())),
        Some(Command::Scenes) => scenes::scenes(),
        Some(Command::Completions { shell }) => generated::completions(shell),
        Some(Command::Man { command }) => generated::man(command.as_deref()),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            if !matches!(failure, Failure::Interrupted | Failure::Window(_)) {
                print::error(&failure);
            }
            ExitCode::from(failure.exit_code())
        }
    }
}
