//! The checkpoint schedule: about once a second, with a bounded share of the run time.

use std::time::{Duration, Instant};

/// The most that a killed program loses, where checkpoints are cheap.
const INTERVAL: Duration = Duration::from_secs(1);

/// Checkpoints take at most one part in this number of the time.
const SHARE: u32 = 10;

/// When checkpoints are made: the first at once, the others about once a second, more rarely where
/// they take long.
#[derive(Debug, Default)]
pub(crate) struct Pace {
    begun: Option<Instant>,
    due: Option<Instant>,
}

impl Pace {
    pub(crate) fn is_due(&self) -> bool {
        self.due.is_none_or(|due| Instant::now() >= due)
    }

    pub(crate) fn begin(&mut self) {
        self.begun = Some(Instant::now());
    }

    pub(crate) fn end(&mut self) {
        let now = Instant::now();
        let cost = self.begun.map_or(Duration::ZERO, |begun| now.duration_since(begun));
        self.due = Some(now + INTERVAL.max(cost * SHARE));
    }
}
