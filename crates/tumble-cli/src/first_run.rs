//! What the program says when it is run without arguments.

use std::fmt::{self, Display};

use clap::builder::styling::Style;
use tumble_record::Summary;

use crate::print::HEADING;

/// A run in plain words, and what to try next.
pub(crate) struct FirstRun<'a> {
    pub(crate) summary: &'a Summary,
    /// Simulated time \[s\].
    pub(crate) simulated: f64,
}

impl Display for FirstRun<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Summary { bodies, threads, step_seconds, energy, state_hash, .. } = self.summary;
        let rate = self.summary.body_steps_per_second / 1e6;
        let times = self.simulated / step_seconds.max(f64::MIN_POSITIVE);
        writeln!(f, "tumble simulates rigid bodies: what falls, spins, collides and hangs together.\n")?;
        let (bodies, s) = (thousands(*bodies), if *threads == 1 { "" } else { "s" });
        writeln!(
            f,
            "It has just let {bodies} boxes, balls and other shapes fall and tumble for {:.0} s.",
            self.simulated
        )?;
        writeln!(f, "That took {step_seconds:.2} s on {threads} thread{s}, {times:.0} times as fast as they fell:")?;
        writeln!(f, "{rate:.0} million steps of one body a second.")?;
        writeln!(f, "Their energy is what it was at the start, to {:.0e} of it.", energy.max_relative_drift)?;
        writeln!(f, "Every run of this command ends in the same bits, of which the hash is {state_hash}.\n")?;
        writeln!(f, "What to try next, from a clone of the repository:")?;
        for (command, what) in NEXT {
            writeln!(f, "  cargo run --release {command:<26} # {what}")?;
        }
        writeln!(f, "\nWithout cargo: tumble scenes, tumble run wall, tumble --help.")?;
        writeln!(f, "README.md has more; docs/embedding.md puts bodies into a game of your own.")
    }
}

/// The commands.
pub(crate) fn heading(line: &str) -> Option<(usize, Style)> {
    if !line.starts_with("  cargo") {
        return None;
    }
    Some((line.find('#')?, HEADING))
}

const NEXT: [(&str, &str); 6] = [
    ("-p tumble-view -- wall", "a window: a ball hits a wall of bricks"),
    ("-p docking", "a game: dock with a tumbling satellite"),
    ("-- scenes", "the built-in scenes"),
    ("-- wall", "one of them, in figures"),
    ("-- wall --report out", "the same as a page: out/report.html"),
    ("-- models/seesaw.json", "a scene file to change"),
];

/// A number with a space before its thousands.
fn thousands(number: u64) -> String {
    if number < 1000 { number.to_string() } else { format!("{} {:03}", thousands(number / 1000), number % 1000) }
}

#[cfg(test)]
mod tests {
    use super::thousands;

    #[test]
    fn thousands_are_apart() {
        assert_eq!([0, 999, 1000, 10_000, 1_002_003].map(thousands), ["0", "999", "1 000", "10 000", "1 002 003"]);
    }
}
