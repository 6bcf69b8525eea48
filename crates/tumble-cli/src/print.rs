//! Standard output and error, where a closed pipe is no failure.

use std::fmt::Display;
use std::io::{self, ErrorKind, Write};

use tumble_scene::printable;

use crate::failure::Failure;

/// Writes the text to standard output. If nobody reads any more (`tumble .. | head`) that is fine.
pub(crate) fn output(text: &str) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::Running(format!("standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Writes one line to standard error; if even that is closed, the exit code has to do.
pub(crate) fn error(message: &impl Display) {
    drop(writeln!(io::stderr().lock(), "tumble: {message}"));
}

/// Writes to standard error what a scene leaves out, a line each.
pub(crate) fn notices(notices: &[String]) {
    for notice in notices {
        drop(writeln!(io::stderr().lock(), "tumble: note: {}", printable(notice)));
    }
}
