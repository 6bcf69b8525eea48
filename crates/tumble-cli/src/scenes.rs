//! `tumble scenes`.

use crate::failure::Failure;
use crate::print;

/// Lists the built-in scenes, a line each.
pub(crate) fn scenes() -> Result<(), Failure> {
    let lines = tumble_scene::builtin_scenes().map(|(name, about)| format!("{name:<16} {about}\n"));
    print::output(&lines.collect::<String>())
}
