//! A bar on a terminal, nothing anywhere else.

use std::io::IsTerminal as _;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

/// Ten times a second is smooth enough and costs nothing.
const REDRAW: Duration = Duration::from_millis(100);

/// Shows how much is done, how fast, and the time left.
pub(crate) struct Progress {
    bar: ProgressBar,
}

impl Progress {
    /// Shows steps.
    pub(crate) fn start(bodies: u64, steps: u64, quiet: bool) -> Self {
        let rate = move |state: &ProgressState, text: &mut dyn std::fmt::Write| {
            // A bar that cannot be drawn is no reason to stop.
            let _ = write!(text, "{:.2e}", state.per_sec() * bodies as f64);
        };
        let template = "{wide_bar} step {pos}/{len}  {rate} body-steps/s  {eta_precise} left";
        Self::drawn(steps, template, rate, quiet)
    }

    /// Shows worlds, from the first that is still to be run.
    pub(crate) fn start_worlds(finished: u64, worlds: u64, quiet: bool) -> Self {
        let rate = |state: &ProgressState, text: &mut dyn std::fmt::Write| {
            // A bar that cannot be drawn is no reason to stop.
            let _ = write!(text, "{:.2e}", state.per_sec());
        };
        let template = "{wide_bar} world {pos}/{len}  {rate} worlds/s  {eta_precise} left";
        let progress = Self::drawn(worlds, template, rate, quiet);
        progress.bar.set_position(finished);
        progress.bar.reset_eta();
        progress
    }

    fn drawn(
        length: u64,
        template: &str,
        rate: impl Fn(&ProgressState, &mut dyn std::fmt::Write) + Clone + Send + Sync + 'static,
        quiet: bool,
    ) -> Self {
        if quiet || !std::io::stderr().is_terminal() {
            return Self { bar: ProgressBar::hidden() };
        }
        let bar = ProgressBar::with_draw_target(Some(length), ProgressDrawTarget::stderr_with_hz(10));
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style.with_key("rate", rate));
        }
        bar.enable_steady_tick(REDRAW);
        Self { bar }
    }

    pub(crate) fn at(&self, done: u64) {
        self.bar.set_position(done);
    }

    /// Takes it off the terminal.
    pub(crate) fn end(&self) {
        self.bar.finish_and_clear();
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.end();
    }
}
