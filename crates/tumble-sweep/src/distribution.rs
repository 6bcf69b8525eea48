//! How the values of a varied field are spread.

use std::f64::consts::TAU;
use std::fmt;
use std::str::FromStr;

use tumble::Rng;

use crate::distribution_error::DistributionError;

/// What the values of a field are drawn from in a [`Sweep`](crate::Sweep).
///
/// Read and written as `LO..HI`, `normal(MEAN,SD)`, `choice(A,B,..)`, `grid(LO,HI,N)` or
/// `list(A,B,..)`.
///
/// ```
/// use tumble_sweep::Distribution;
///
/// let heights: Distribution = "grid(0, 1, 5)".parse()?;
/// assert_eq!(heights, Distribution::Grid { low: 0.0, high: 1.0, count: 5 });
/// assert_eq!(heights.to_string(), "grid(0,1,5)");
/// # Ok::<(), tumble_sweep::DistributionError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Distribution {
    /// Any number from `low` to `high`, equally likely.
    Uniform {
        /// The smallest.
        low: f64,
        /// The largest.
        high: f64,
    },
    /// The normal distribution.
    Normal {
        /// Its centre.
        mean: f64,
        /// Its standard deviation.
        deviation: f64,
    },
    /// `count` values from `low` to `high` at equal distances, both ends among them; one after the
    /// other, not at random.
    Grid {
        /// The first value.
        low: f64,
        /// The last value.
        high: f64,
        /// How many.
        count: u64,
    },
    /// Any of these values, equally likely.
    Choice(Vec<f64>),
    /// These values, one after the other.
    List(Vec<f64>),
}

/// Most values of a choice or a list.
const MAX_VALUES: usize = 10_000;

impl Distribution {
    /// Why nothing finite can be drawn, if that is so.
    pub(crate) fn check(&self) -> Result<(), String> {
        match *self {
            Self::Choice(ref values) | Self::List(ref values) => check_values(values),
            Self::Uniform { low, high } => check_ends(low, high),
            Self::Normal { mean, deviation } if !(mean.is_finite() && deviation.is_finite()) => {
                Err(format!("{mean} and {deviation} must be finite"))
            }
            Self::Normal { deviation, .. } if deviation < 0.0 => {
                Err(format!("a standard deviation is not negative, as {deviation} is"))
            }
            Self::Normal { .. } => Ok(()),
            Self::Grid { count: 0, .. } => Err("a grid has 1 value or more".to_owned()),
            Self::Grid { low, high, count: 1 } if low != high => Err("one value has no two ends".to_owned()),
            // Past this, not every step has a number of its own.
            Self::Grid { count, .. } if count > 1 << 53 => Err(format!("{count} values are too many")),
            Self::Grid { low, high, .. } => check_ends(low, high),
        }
    }

    /// The value that comes of a sequence of chance; `step` is the step of a grid, which is left to
    /// no chance.
    pub(crate) fn draw(&self, mut rng: Rng, step: u64) -> f64 {
        match *self {
            Self::Choice(ref values) => {
                let index = (values.len() as f64 * rng.unit()) as usize;
                values.get(index.min(values.len().saturating_sub(1))).copied().unwrap_or_default()
            }
            Self::List(ref values) => {
                usize::try_from(step).ok().and_then(|step| values.get(step)).copied().unwrap_or_default()
            }
            Self::Uniform { low, high } => (low + (high - low) * rng.unit()).min(high),
            Self::Normal { mean, deviation } => mean + deviation * standard_normal(&mut rng),
            Self::Grid { low, high, count } => {
                let (width, parts) = (high - low, count.saturating_sub(1).max(1) as f64);
                let (product, step_size) = (width * step as f64, width / parts);
                if step + 1 == count && count > 1 {
                    high
                } else if self.is_whole() {
                    // Both the step's size and its multiples are whole, so nothing is rounded.
                    low + step_size * step as f64
                } else if product.is_finite() {
                    // One rounding less than a fraction of the width would have.
                    low + product / parts
                } else {
                    low + width * (step as f64 / parts)
                }
            }
        }
    }

    /// Values that show whether a field can take what is drawn: the ends, or the mean.
    pub(crate) fn samples(&self) -> Vec<f64> {
        match *self {
            Self::Uniform { low, high } | Self::Grid { low, high, .. } => vec![low, high],
            Self::Normal { mean, .. } => vec![mean],
            Self::Choice(ref values) | Self::List(ref values) => {
                let end = |pick: fn(f64, f64) -> f64| values.iter().copied().reduce(pick);
                end(f64::min).into_iter().chain(end(f64::max)).collect()
            }
        }
    }

    /// Steps of a grid or a list; one for what is drawn at random.
    pub(crate) fn steps(&self) -> u64 {
        match self {
            Self::Grid { count, .. } => *count,
            Self::List(values) => values.len() as u64,
            Self::Uniform { .. } | Self::Normal { .. } | Self::Choice(_) => 1,
        }
    }

    /// Whether its values come one after the other.
    pub(crate) fn is_stepped(&self) -> bool {
        matches!(self, Self::Grid { .. } | Self::List(_))
    }

    /// Whether all values are whole numbers.
    pub(crate) fn is_whole(&self) -> bool {
        match *self {
            Self::Grid { low, high, count } => {
                let whole = |value: f64| value.fract() == 0.0;
                whole(low) && whole(high) && (count == 1 || (high - low) % (count - 1) as f64 == 0.0)
            }
            Self::Choice(ref values) | Self::List(ref values) => values.iter().all(|value| value.fract() == 0.0),
            Self::Uniform { .. } | Self::Normal { .. } => false,
        }
    }
}

fn check_values(values: &[f64]) -> Result<(), String> {
    match values.iter().find(|value| !value.is_finite()) {
        Some(value) => Err(format!("{value} must be finite")),
        None if values.is_empty() => Err("there is no value".to_owned()),
        None if values.len() > MAX_VALUES => Err(format!("{} values are more than {MAX_VALUES}", values.len())),
        None => Ok(()),
    }
}

/// The distance between the ends must be finite too.
fn check_ends(low: f64, high: f64) -> Result<(), String> {
    if !(low.is_finite() && high.is_finite()) {
        Err(format!("{low} and {high} must be finite"))
    } else if low > high {
        Err(format!("{low} is more than {high}"))
    } else if !(high - low).is_finite() {
        Err("it is too wide".to_owned())
    } else {
        Ok(())
    }
}

/// By G. E. P. Box and M. E. Muller (1958). The functions are libm's, whose bits are the same on
/// every machine.
fn standard_normal(rng: &mut Rng) -> f64 {
    // In (0, 1], whose logarithm is finite.
    let first = 1.0 - rng.unit();
    (-2.0 * libm::log(first)).sqrt() * libm::cos(TAU * rng.unit())
}

impl FromStr for Distribution {
    type Err = DistributionError;

    fn from_str(text: &str) -> Result<Self, DistributionError> {
        let text = text.trim();
        let distribution = if let Some(arguments) = arguments(text, "normal") {
            let [mean, deviation] = numbers(text, arguments)?;
            Self::Normal { mean, deviation }
        } else if let Some(arguments) = arguments(text, "grid") {
            let (ends, count) = arguments.rsplit_once(',').ok_or_else(|| form(text))?;
            let [low, high] = numbers(text, ends)?;
            let count = count.trim();
            let refused = |_| DistributionError::Count { text: text.to_owned(), count: count.to_owned() };
            Self::Grid { low, high, count: count.parse().map_err(refused)? }
        } else if let Some(arguments) = arguments(text, "choice") {
            Self::Choice(values(text, arguments)?)
        } else if let Some(arguments) = arguments(text, "list") {
            Self::List(values(text, arguments)?)
        } else {
            let (low, high) = text.split_once("..").ok_or_else(|| form(text))?;
            // Three dots may be meant as two: then `.5` is not what was meant.
            if high.starts_with('.') {
                return Err(form(text));
            }
            Self::Uniform { low: number(text, low)?, high: number(text, high)? }
        };
        match distribution.check() {
            Ok(()) => Ok(distribution),
            Err(problem) => Err(DistributionError::Values { text: text.to_owned(), problem }),
        }
    }
}

impl fmt::Display for Distribution {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Uniform { low, high } => write!(f, "{low}..{high}"),
            Self::Normal { mean, deviation } => write!(f, "normal({mean},{deviation})"),
            Self::Grid { low, high, count } => write!(f, "grid({low},{high},{count})"),
            Self::Choice(values) => write!(f, "choice({})", joined(values)),
            Self::List(values) => write!(f, "list({})", joined(values)),
        }
    }
}

fn joined(values: &[f64]) -> String {
    values.iter().map(ToString::to_string).collect::<Vec<_>>().join(",")
}

fn values(text: &str, arguments: &str) -> Result<Vec<f64>, DistributionError> {
    arguments.split(',').map(|value| number(text, value)).collect()
}

fn arguments<'a>(text: &'a str, name: &str) -> Option<&'a str> {
    text.strip_prefix(name)?.trim_start().strip_prefix('(')?.strip_suffix(')')
}

fn form(text: &str) -> DistributionError {
    DistributionError::Form { text: text.to_owned() }
}

fn numbers(text: &str, arguments: &str) -> Result<[f64; 2], DistributionError> {
    let (first, second) = arguments.split_once(',').ok_or_else(|| form(text))?;
    Ok([number(text, first)?, number(text, second)?])
}

fn number(text: &str, number: &str) -> Result<f64, DistributionError> {
    let number = number.trim();
    match number.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(DistributionError::Number { text: text.to_owned(), number: number.to_owned() }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn draws(distribution: &str, count: u64) -> Vec<f64> {
        let distribution: Distribution = distribution.parse().unwrap();
        let steps = distribution.steps();
        (0..count).map(|index| distribution.draw(Rng::stream(5, index), index % steps)).collect()
    }

    fn mean(values: &[f64]) -> f64 {
        values.iter().sum::<f64>() / values.len() as f64
    }

    #[test]
    fn uniform_values_fill_their_range() {
        let values = draws("-1..3", 10_000);
        assert!(values.iter().all(|value| (-1.0..=3.0).contains(value)));
        // Standard deviations of the estimates over 10 000 values: 0.0115 for the mean, 0.0107 for
        // the variance of 4/3; five of them.
        let mean = mean(&values);
        let variance = values.iter().map(|value| (value - mean) * (value - mean)).sum::<f64>() / 10_000.0;
        assert!((mean - 1.0).abs() < 0.058, "{mean}");
        assert!((variance - 4.0 / 3.0).abs() < 0.06, "{variance}");
        assert_eq!(draws("2..2", 3), [2.0; 3]);
    }

    #[test]
    fn normal_values_have_their_moments() {
        let values = draws("normal(3,2)", 10_000);
        let mean = mean(&values);
        let moment = |power: i32| values.iter().map(|value| ((value - mean) / 2.0).powi(power)).sum::<f64>() / 10_000.0;
        // Standard deviations over 10 000 values: 0.02 for the mean, 0.0141, 0.0245 and 0.098 for
        // the scaled moments 1, 0 and 3; five of them.
        assert!((mean - 3.0).abs() < 0.1, "{mean}");
        assert!((moment(2) - 1.0).abs() < 0.071, "{}", moment(2));
        assert!(moment(3).abs() < 0.123, "{}", moment(3));
        assert!((moment(4) - 3.0).abs() < 0.49, "{}", moment(4));
    }

    #[test]
    fn a_grid_has_both_ends_and_equal_distances() {
        assert_eq!(draws("grid(-1,1,5)", 6), [-1.0, -0.5, 0.0, 0.5, 1.0, -1.0]);
        assert_eq!(draws("grid(0.1,0.7,3)", 3)[2], 0.7);
        assert_eq!(draws("grid(4,4,1)", 2), [4.0, 4.0]);
        let whole = |text: &str| text.parse::<Distribution>().unwrap().is_whole();
        assert!(whole("grid(1,9,5)") && whole("grid(3,3,1)"));
        assert!(!whole("grid(1,9,4)") && !whole("1..9") && !whole("normal(1,1)") && !whole("grid(0.5,1.5,2)"));
    }

    #[test]
    fn a_list_has_its_values_in_order_and_a_choice_all_of_them() {
        assert_eq!(draws("list(5,-1,2)", 4), [5.0, -1.0, 2.0, 5.0]);
        let values = draws("choice(1,4,10)", 10_000);
        for value in [1.0, 4.0, 10.0] {
            // A third of them, and five standard deviations of 47.
            let count = values.iter().filter(|drawn| **drawn == value).count();
            assert!(count.abs_diff(3333) < 236, "{value}: {count}");
        }
        assert!(values.iter().all(|value| [1.0, 4.0, 10.0].contains(value)));
        let samples = |text: &str| text.parse::<Distribution>().unwrap().samples();
        assert_eq!(samples("list(5,-1,2)"), [-1.0, 5.0]);
        let whole = |text: &str| text.parse::<Distribution>().unwrap().is_whole();
        assert!(whole("list(1,3)") && whole("choice(2,8)") && !whole("list(1,2.5)"));
    }

    #[test]
    fn a_grid_of_whole_numbers_has_no_others() {
        for (low, high) in [(1_u64, 50), (1, 1000), (0, 49), (1, 99)] {
            let count = high - low + 1;
            let wanted: Vec<f64> = (low..=high).map(|value| value as f64).collect();
            assert_eq!(draws(&format!("grid({low},{high},{count})"), count), wanted);
        }
        // Products past 2^53, where a rounded one would be off by one.
        let values = draws("grid(1,9000000000000001,1000001)", 1_000_001);
        assert!(values.iter().zip(0_u64..).all(|(value, step)| *value as u64 == 1 + 9_000_000_000 * step));
        // Halves are exact too; a product that overflows is not made.
        assert_eq!(draws("grid(0,49,99)", 99)[57], 28.5);
        assert_eq!(draws("grid(0.5,49.5,50)", 50)[27], 27.5);
        assert!(draws("grid(0,1.5e308,4)", 4).iter().chain(&draws("grid(0.5,1.5e308,4)", 4)).all(|v| v.is_finite()));
    }

    /// Computed apart from this code, in Python. The bits are for ever: a recorded sweep is worth
    /// nothing if they change.
    #[test]
    fn draws_are_pinned() {
        let bits = |text: &str| draws(text, 3)[2].to_bits();
        assert_eq!(bits("-1..3"), 0x3fc4_87b8_7f36_6980);
        assert_eq!(bits("normal(3,2)"), 0x4011_ad79_3348_1347);
    }

    /// What can be written in Rust only.
    #[test]
    fn what_cannot_be_drawn_from_is_refused() {
        let (nan, far) = (f64::NAN, f64::INFINITY);
        for bad in [
            Distribution::Uniform { low: nan, high: 1.0 },
            Distribution::Uniform { low: 0.0, high: far },
            Distribution::Normal { mean: far, deviation: 1.0 },
            Distribution::Normal { mean: 0.0, deviation: nan },
            Distribution::Grid { low: 0.0, high: 1.0, count: 0 },
            Distribution::Grid { low: nan, high: nan, count: 1 },
            Distribution::Grid { low: 0.0, high: 1.0, count: u64::MAX },
            Distribution::List(Vec::new()),
            Distribution::Choice(vec![1.0, nan]),
            Distribution::List(vec![1.0; MAX_VALUES + 1]),
        ] {
            assert!(bad.check().is_err(), "{bad:?}");
        }
    }

    #[test]
    fn what_is_written_reads_back() {
        for text in [
            "0.1..1e300",
            "normal(-3.5,0)",
            "grid(1,2,3)",
            "-5..-1",
            " 1 .. 2 ",
            "normal( 1 , 2 )",
            "list(1, 2.5,-3)",
            "choice(7)",
        ] {
            let distribution: Distribution = text.parse().unwrap();
            assert_eq!(distribution.to_string().parse(), Ok(distribution));
        }
        let bad = [
            "",
            "1",
            "1..",
            "..",
            "..2",
            "a..b",
            "2..1",
            "nan..1",
            "0..inf",
            "-1e308..1.5e308",
            "normal(1)",
            "normal(1,-1)",
            "normal(1,nan)",
            "normal(1,2,3)",
            "grid(1,2)",
            "grid(1,2,0)",
            "grid(1,2,1)",
            "grid(1,2,2.5)",
            "grid(2,1,3)",
            "grid(1,2,-3)",
            "grid(1,2,99999999999999999999)",
            "cauchy(0,1)",
            "list()",
            "choice(1,,2)",
            "list(1,inf)",
            "1..2..3",
            "0...5",
            "0....5",
        ];
        for bad in bad {
            assert!(bad.parse::<Distribution>().is_err(), "{bad:?}");
        }
    }
}
