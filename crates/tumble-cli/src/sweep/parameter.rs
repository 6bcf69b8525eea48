//! A varied scene field with its distribution, parsed from `FIELD=LO..HI` and similar forms.

use std::fmt;
use std::str::FromStr;

use crate::sweep::distribution::Distribution;

/// A numeric field of a scene and what its values are drawn from, written `FIELD=LO..HI` and the
/// like.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SweepParameter {
    /// The path of the field; see [`Sweep`](crate::sweep::Sweep).
    pub(crate) field: String,
    /// What its values are drawn from.
    pub(crate) distribution: Distribution,
}

impl FromStr for SweepParameter {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        // A name of a body may have an equals sign in it, a distribution has none.
        let (field, distribution) =
            text.rsplit_once('=').ok_or_else(|| format!("{text:?} is not FIELD=DISTRIBUTION"))?;
        let field = field.trim().to_owned();
        let distribution = distribution.parse().map_err(|problem| format!("{field}: {problem}"))?;
        Ok(Self { field, distribution })
    }
}

impl fmt::Display for SweepParameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", self.field, self.distribution)
    }
}
