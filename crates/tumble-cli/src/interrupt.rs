//! Ctrl-C: the first one asks the run to end, the second one ends the program.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::failure::Failure;

static ASKED: AtomicBool = AtomicBool::new(false);

/// From here on SIGINT, SIGTERM and SIGHUP (Ctrl-C on Windows) only set a mark.
pub(crate) fn watch() -> Result<(), Failure> {
    ctrlc::set_handler(|| {
        if ASKED.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    })
    .map_err(|error| Failure::Running(format!("cannot watch for Ctrl-C: {error}")))
}

/// Whether the user wants the run to end.
pub(crate) fn asked() -> bool {
    ASKED.load(Ordering::Relaxed)
}
