//! What a text of a distribution lacks.

/// Why a text is no [`Distribution`](crate::Distribution). `Display` is a sentence that repeats the
/// text.
///
/// ```
/// use tumble_sweep::{Distribution, DistributionError};
///
/// let error = "normal(1,-1)".parse::<Distribution>().unwrap_err();
/// assert!(matches!(error, DistributionError::Values { .. }));
/// assert_eq!(error.to_string(), "normal(1,-1): a standard deviation is not negative, as -1 is");
/// ```
#[derive(Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DistributionError {
    /// It has none of the five forms.
    #[error("{text:?} is none of LO..HI, normal(MEAN,SD), choice(A,B,..), grid(LO,HI,N) and list(A,B,..)")]
    Form {
        /// All of it.
        text: String,
    },
    /// One of its numbers is none.
    #[error("{text}: {number:?} is not a finite number")]
    Number {
        /// All of it.
        text: String,
        /// What stands for the number.
        number: String,
    },
    /// How many values a grid has is no whole number.
    #[error("{text}: {count:?} is not a number of values")]
    Count {
        /// All of it.
        text: String,
        /// What stands for the number.
        count: String,
    },
    /// Nothing finite can be drawn from it.
    #[error("{text}: {problem}")]
    Values {
        /// All of it.
        text: String,
        /// Why not.
        problem: String,
    },
}

tumble_math::debug_as_display!(DistributionError);
