//! Shards of a sweep: parsing of `I/N`, and the range of worlds in each shard.

use std::fmt;
use std::ops::Range;
use std::str::FromStr;

/// One of several equal parts of a sweep, written `I/N` with `I` from 1 to `N`.
///
/// ```
/// use tumble_sweep::Shard;
///
/// let second: Shard = "2/3".parse()?;
/// assert_eq!((second.index(), second.count()), (2, 3));
/// assert_eq!(second.range(10), 3..6);
/// # Ok::<(), tumble_sweep::ShardError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Shard {
    index: u64,
    count: u64,
}

impl Shard {
    /// The most shards.
    pub const MAX: u64 = 1_000_000;

    /// Which one, from 1.
    #[must_use]
    pub fn index(self) -> u64 {
        self.index
    }

    /// Of how many.
    #[must_use]
    pub fn count(self) -> u64 {
        self.count
    }

    /// The worlds of this shard: those of all shards follow each other, and differ in number by one
    /// at most.
    #[must_use]
    pub fn range(self, worlds: u64) -> Range<u64> {
        let end = |index: u64| (u128::from(worlds) * u128::from(index) / u128::from(self.count)) as u64;
        end(self.index - 1)..end(self.index)
    }
}

/// A text is no [`Shard`].
///
/// ```
/// use tumble_sweep::Shard;
///
/// let error = "3/2".parse::<Shard>().unwrap_err();
/// assert_eq!(error.to_string(), "\"3/2\" is not I/N with I from 1 to N, at most 1000000");
/// ```
#[derive(Clone, PartialEq, Eq, thiserror::Error)]
#[error("{text:?} is not I/N with I from 1 to N, at most {}", Shard::MAX)]
pub struct ShardError {
    text: String,
}

tumble_math::debug_as_display!(ShardError);

impl FromStr for Shard {
    type Err = ShardError;

    fn from_str(text: &str) -> Result<Self, ShardError> {
        let parts = text.split_once('/').and_then(|(index, count)| Some((index.parse().ok()?, count.parse().ok()?)));
        match parts {
            Some((index, count)) if (1..=count).contains(&index) && count <= Self::MAX => Ok(Self { index, count }),
            _ => Err(ShardError { text: text.to_owned() }),
        }
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_make_up_the_whole() {
        for worlds in [0, 1, 2, 7, 100, 1_000_000_000_000] {
            for count in [1, 2, 3, 7, 13] {
                let mut next = 0;
                for index in 1..=count {
                    let range = Shard { index, count }.range(worlds);
                    assert_eq!(range.start, next);
                    assert!((range.end - range.start).abs_diff(worlds / count) <= 1);
                    next = range.end;
                }
                assert_eq!(next, worlds);
            }
        }
    }

    #[test]
    fn what_is_no_shard_is_refused() {
        for bad in ["", "1", "0/2", "3/2", "1/0", "-1/2", "1/2/3", "a/b", "1/1000001"] {
            assert!(bad.parse::<Shard>().is_err(), "{bad:?}");
        }
    }
}
