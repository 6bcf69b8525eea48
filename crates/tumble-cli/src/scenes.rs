//! `tumble scenes`, and the scenes in the help.

use clap::builder::styling::Style;

use crate::failure::Failure;
use crate::print::{self, HEADING};

/// Columns of the list of names in the help.
const COLUMNS: usize = 90;

/// Lists the built-in scenes, a line each.
pub(crate) fn scenes() -> Result<(), Failure> {
    let lines = tumble_scene::builtin_scenes().map(|(name, about)| format!("{name:<16} {about}\n"));
    print::output_with(&lines.collect::<String>(), name)
}

fn name(line: &str) -> Option<(usize, Style)> {
    Some((line.find(' ')?, HEADING))
}

/// The names, for the end of a help.
pub(crate) fn named() -> String {
    let mut lines = vec![String::from(" ")];
    for name in tumble_scene::builtin_names() {
        match lines.last_mut() {
            Some(line) if line.len() + name.len() < COLUMNS => {
                line.push(' ');
                line.push_str(name);
            }
            _ => lines.push(format!("  {name}")),
        }
    }
    format!("Built-in scenes (`tumble scenes` says what each shows):\n{}", lines.join("\n"))
}
