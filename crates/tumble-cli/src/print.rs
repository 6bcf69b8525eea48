//! Standard output and error, the only place that writes to them: what a terminal would obey is
//! escaped, and a closed pipe is no failure.

use std::fmt::Display;
use std::io::{self, ErrorKind, Write};

use clap::error::ContextValue;
use tumble_import::{printable, printable_lines};

use crate::failure::Failure;

/// Writes the text to standard output. If nobody reads any more (`tumble .. | head`) that is fine.
pub(crate) fn output(text: &str) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(printable_lines(text).as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::Running(format!("standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Writes one line to standard error; if even that is closed, the exit code has to do.
pub(crate) fn error(message: &impl Display) {
    drop(writeln!(io::stderr().lock(), "tumble: {}", printable(&message.to_string())));
}

/// Writes to standard error what a scene leaves out, a line each.
pub(crate) fn notices(notices: &[String]) {
    for notice in notices {
        drop(writeln!(io::stderr().lock(), "tumble: note: {}", printable(notice)));
    }
}

/// Writes what is wrong with the command line, which quotes it, to standard error.
pub(crate) fn usage(mut error: clap::Error) {
    let quoted: Vec<_> = error
        .context()
        .filter_map(|(kind, value)| match value {
            ContextValue::String(text) => Some((kind, ContextValue::String(printable(text)))),
            ContextValue::Strings(texts) => {
                Some((kind, ContextValue::Strings(texts.iter().map(|text| printable(text)).collect())))
            }
            _ => None,
        })
        .collect();
    for (kind, value) in quoted {
        error.insert(kind, value);
    }
    drop(write!(io::stderr().lock(), "{}", printable_lines(&error.render().to_string())));
}

/// A panic may quote anything too.
pub(crate) fn escape_panics() {
    std::panic::set_hook(Box::new(|panic| {
        let backtrace = std::backtrace::Backtrace::capture();
        let told = match backtrace.status() {
            std::backtrace::BacktraceStatus::Captured => format!("{panic}\n{backtrace}"),
            _ => panic.to_string(),
        };
        drop(writeln!(io::stderr().lock(), "{}", printable_lines(&told)));
    }));
}
