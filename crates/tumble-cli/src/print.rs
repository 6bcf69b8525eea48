//! Standard output and error, the only place that writes to them: what a terminal would obey is
//! escaped, and a closed pipe is no failure. On a terminal headings and warnings stand out, unless
//! `NO_COLOR` is set.

use std::fmt::Display;
use std::io::{self, ErrorKind, Write};

use anstream::AutoStream;
use clap::builder::styling::{AnsiColor, Style};
use clap::error::{ContextKind, ContextValue, ErrorKind as UsageError};
use tumble_import::{printable, printable_lines};

use crate::failure::Failure;

pub(crate) const HEADING: Style = Style::new().bold();
pub(crate) const WARNING: Style = AnsiColor::Yellow.on_default().bold();
pub(crate) const ERROR: Style = AnsiColor::Red.on_default().bold();
const TIP: Style = AnsiColor::Green.on_default();

/// Writes the text to standard output. If nobody reads any more (`tumble .. | head`) that is fine.
pub(crate) fn output(text: &str) -> Result<(), Failure> {
    own(printable_lines(text).as_bytes())
}

/// Writes what has only this program's own words in it to standard output, as it is.
pub(crate) fn own(text: &[u8]) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    written(stdout.write_all(text).and_then(|()| stdout.flush()))
}

/// As [`output`], with the beginnings of lines in a style: `begins` says how many bytes, and which.
pub(crate) fn output_with(text: &str, begins: fn(&str) -> Option<(usize, Style)>) -> Result<(), Failure> {
    let mut stdout = AutoStream::auto(io::stdout().lock());
    written(stdout.write_all(styled(&printable_lines(text), begins).as_bytes()).and_then(|()| stdout.flush()))
}

fn written(result: io::Result<()>) -> Result<(), Failure> {
    match result {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Failure::Running(format!("standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Text that is escaped already.
fn styled(text: &str, begins: fn(&str) -> Option<(usize, Style)>) -> String {
    let line = |line: &str| match begins(line).and_then(|(length, style)| Some((line.split_at_checked(length)?, style)))
    {
        Some(((begin, rest), style)) => format!("{style}{begin}{style:#}{rest}"),
        None => line.to_owned(),
    };
    text.split('\n').map(line).collect::<Vec<_>>().join("\n")
}

/// Writes one line to standard error; if even that is closed, the exit code has to do.
pub(crate) fn error(message: &impl Display) {
    say("tumble:", ERROR, &message.to_string());
}

/// Writes one line on what is likely not meant to standard error.
pub(crate) fn warning(message: &impl Display) {
    say("tumble: warning:", WARNING, &message.to_string());
}

/// Writes to standard error what a scene leaves out, a line each.
pub(crate) fn notices(notices: &[String]) {
    for notice in notices {
        say("tumble: note:", HEADING, notice);
    }
}

fn say(begin: &str, style: Style, message: &str) {
    let mut stderr = AutoStream::auto(io::stderr().lock());
    drop(writeln!(stderr, "{style}{begin}{style:#} {}", printable(message)));
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
    if error.kind() == UsageError::InvalidSubcommand && error.get(ContextKind::SuggestedSubcommand).is_none() {
        let tips = ["`tumble --help` lists the commands", "`tumble scenes` lists the built-in scenes"];
        let tips = tips.map(Into::into).to_vec();
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(tips));
    }
    let begins = |line: &str| {
        let known = [("error:", ERROR), ("  tip:", TIP), ("Usage:", HEADING)];
        known.into_iter().find(|(begin, _)| line.starts_with(begin)).map(|(begin, style)| (begin.len(), style))
    };
    let mut stderr = AutoStream::auto(io::stderr().lock());
    drop(write!(stderr, "{}", styled(&printable_lines(&error.render().to_string()), begins)));
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
