//! A varied scene field with its distribution, parsed from `FIELD=LO..HI` and similar forms.

use std::fmt;
use std::str::FromStr;

use crate::sweep::distribution::Distribution;

/// A numeric field of a scene and what its values are drawn from, written `FIELD=LO..HI` and the
/// like.
///
/// ```
/// use tumble_scene::SweepParameter;
///
/// let vary: SweepParameter = "bodies.brick.mass=normal(2,0.1)".parse()?;
/// assert_eq!((vary.field.as_str(), vary.to_string().as_str()), ("bodies.brick.mass", "bodies.brick.mass=normal(2,0.1)"));
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SweepParameter {
    /// The path of the field; see [`Sweep`](crate::Sweep).
    pub field: String,
    /// What its values are drawn from.
    pub distribution: Distribution,
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
