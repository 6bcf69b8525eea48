//! `tumble view`: the window, which is a program of its own.

use std::ffi::{OsStr, OsString};
use std::io::ErrorKind;
use std::path::PathBuf;
use std::process::Command;

use crate::failure::Failure;
use crate::options::ViewOptions;

const PROGRAM: &str = "tumble-view";

/// Starts `tumble-view` with the same arguments and waits for its end, which is this one's too.
pub(crate) fn view(options: &ViewOptions) -> Result<(), Failure> {
    let program = beside().map_or_else(|| OsString::from(PROGRAM), OsString::from);
    match Command::new(&program).args(&options.arguments).status() {
        Ok(status) if status.success() => Ok(()),
        // It has said why.
        Ok(status) => Err(Failure::Window(status.code().and_then(|code| u8::try_from(code).ok()).unwrap_or(1))),
        Err(error) if error.kind() == ErrorKind::NotFound => Err(Failure::Input(missing(&options.arguments))),
        Err(error) => Err(Failure::Running(format!("{}: cannot be started: {error}", program.display()))),
    }
}

/// The program in the folder of this one.
fn beside() -> Option<PathBuf> {
    let path = std::env::current_exe().ok()?.with_file_name(format!("{PROGRAM}{}", std::env::consts::EXE_SUFFIX));
    path.is_file().then_some(path)
}

fn missing(arguments: &[OsString]) -> String {
    let arguments: Vec<_> = arguments.iter().map(|argument| OsStr::to_string_lossy(argument)).collect();
    format!(
        "the window is the program {PROGRAM}, which is neither beside this one nor in the PATH. From a clone of the \
         repository, `cargo run --release -p {PROGRAM} -- {}` opens it, and \
         `cargo install --locked --path crates/{PROGRAM}` installs it",
        arguments.join(" ")
    )
}
