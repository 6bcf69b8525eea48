//! The arguments of benches that print tables of their own, read as criterion reads those of the
//! others.

/// Options of criterion that a value follows, which is not a filter.
const WITH_VALUE: [&str; 18] = [
    "--baseline",
    "--baseline-lenient",
    "--color",
    "--colour",
    "--confidence-level",
    "--format",
    "--load-baseline",
    "--measurement-time",
    "--noise-threshold",
    "--nresamples",
    "--output-format",
    "--plotting-backend",
    "--profile-time",
    "--sample-size",
    "--save-baseline",
    "--significance-level",
    "--warm-up-time",
    "-b",
];

/// What a bench is asked for.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Arguments {
    /// Parts of the names of what is to be run; none for everything.
    pub filters: Vec<String>,
    /// Whether names are to be printed and nothing is to be run.
    pub is_list: bool,
    /// Whether it is only tested that it runs: one short pass.
    pub is_test: bool,
}

impl Arguments {
    /// Those of this program.
    pub fn of_program() -> Self {
        Self::read(std::env::args().skip(1))
    }

    fn read(arguments: impl IntoIterator<Item = String>) -> Self {
        let (mut all, mut read) = (arguments.into_iter(), Self::default());
        while let Some(argument) = all.next() {
            match argument.as_str() {
                "--list" => read.is_list = true,
                "--test" => read.is_test = true,
                option if WITH_VALUE.contains(&option) => drop(all.next()),
                option if option.starts_with('-') => {}
                _ => read.filters.push(argument),
            }
        }
        read
    }

    /// Whether what has this name is to be run or listed: it has one of the filters in it, or there
    /// are none.
    #[must_use]
    pub fn select(&self, name: &str) -> bool {
        self.filters.is_empty() || self.filters.iter().any(|filter| name.contains(filter.as_str()))
    }

    /// Whether a filter is this word, so that what is long is run only where it is asked for.
    #[must_use]
    pub fn name(&self, word: &str) -> bool {
        self.filters.iter().any(|filter| filter == word)
    }

    /// Prints which of these names are selected, as criterion does.
    pub fn print_list(&self, names: &[&str]) {
        for name in names.iter().filter(|name| self.select(name)) {
            println!("{name}: benchmark");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Arguments;

    fn read(line: &str) -> Arguments {
        Arguments::read(line.split_whitespace().map(str::to_owned))
    }

    #[test]
    fn values_of_options_are_no_filters() {
        let read = read("--bench --measurement-time 10 pyramid --sample-size 50 --test");
        assert_eq!(read, Arguments { filters: vec!["pyramid".to_owned()], is_list: false, is_test: true });
    }

    #[test]
    fn a_filter_selects_by_part_of_a_name() {
        assert!(read("--bench").select("piles/pyramid"));
        assert!(read("pyra").select("piles/pyramid"));
        assert!(read("balls pyra").select("piles/pyramid"));
        assert!(!read("target").select("piles/pyramid"));
        assert!(read("stands").name("stands") && !read("stand").name("stands") && !read("").name("stands"));
    }
}
