//! Varied scene fields with their distribution, parsed from `FIELD=LO..HI` and similar forms.

use std::fmt;
use std::str::FromStr;

use crate::distribution::Distribution;
use crate::distribution_error::DistributionError;

/// Numeric fields of a scene that one draw changes, written `FIELD=LO..HI`, `FIELD,FIELD=LO..HI` or
/// `FIELD,FIELD*-1=LO..HI` and the like.
///
/// ```
/// use tumble_sweep::SweepParameter;
///
/// let mirrored: SweepParameter = "bodies.0.position.0, bodies.1.position.0*-1 = 1..2".parse()?;
/// assert_eq!(mirrored.fields[1], ("bodies.1.position.0".to_owned(), -1.0));
/// assert_eq!(mirrored.to_string(), "bodies.0.position.0,bodies.1.position.0*-1=1..2");
/// # Ok::<(), tumble_sweep::ParameterError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SweepParameter {
    /// The paths of the fields, see [`Sweep`](crate::Sweep), and by what each multiplies.
    pub fields: Vec<(String, f64)>,
    /// What the values are drawn from.
    pub distribution: Distribution,
}

/// Why a text is no [`SweepParameter`]. `Display` is a sentence that names the field.
///
/// ```
/// use tumble_sweep::SweepParameter;
///
/// let error = "dt=2..1".parse::<SweepParameter>().unwrap_err();
/// assert_eq!(error.to_string(), "dt: 2..1: 2 is more than 1");
/// ```
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ParameterError {
    /// It has no equals sign.
    #[error("{text:?} is not FIELD=DISTRIBUTION")]
    Form {
        /// All of it.
        text: String,
    },
    /// What follows the equals sign is no distribution.
    #[error("{fields}: {error}")]
    Distribution {
        /// What is before it.
        fields: String,
        /// What is wrong with the distribution.
        error: DistributionError,
    },
    /// A field is multiplied by what is not finite.
    #[error("{field}: {factor} is no finite factor")]
    Factor {
        /// Its path.
        field: String,
        /// By what.
        factor: f64,
    },
}

tumble_math::debug_as_display!(ParameterError);

/// What a path begins with. A name of a body may have a comma in it, which parts no fields.
const ROOTS: [&str; 9] =
    ["bodies", "joints", "gravity", "dt", "steps", "substeps", "contact_substeps", "restitution_threshold", "sleep"];

impl FromStr for SweepParameter {
    type Err = ParameterError;

    fn from_str(text: &str) -> Result<Self, ParameterError> {
        // A name of a body may have an equals sign in it, a distribution has none.
        let (fields, distribution) =
            text.rsplit_once('=').ok_or_else(|| ParameterError::Form { text: text.to_owned() })?;
        let refused = |error| ParameterError::Distribution { fields: fields.trim().to_owned(), error };
        let distribution = distribution.parse().map_err(refused)?;
        let fields = apart(fields).into_iter().map(field).collect::<Result<_, _>>()?;
        Ok(Self { fields, distribution })
    }
}

/// The fields of a list.
fn apart(fields: &str) -> Vec<&str> {
    let begins_field = |rest: &str| {
        let rest = rest.trim_start();
        ROOTS.iter().any(|root| {
            rest.strip_prefix(root)
                .is_some_and(|after| after.is_empty() || after.starts_with(['.', '[', ',', '*', ' ']))
        })
    };
    let commas = fields.match_indices(',').map(|(at, _)| at).filter(|at| begins_field(&fields[at + 1..]));
    let (mut apart, mut from) = (Vec::new(), 0);
    for comma in commas {
        apart.push(&fields[from..comma]);
        from = comma + 1;
    }
    apart.push(&fields[from..]);
    apart
}

/// A field and its factor, which stands last.
fn field(text: &str) -> Result<(String, f64), ParameterError> {
    let text = text.trim();
    let factor = |(field, factor): (&str, &str)| Some((field.trim().to_owned(), factor.trim().parse::<f64>().ok()?));
    match text.rsplit_once('*').and_then(factor) {
        Some((field, factor)) if !factor.is_finite() => Err(ParameterError::Factor { field, factor }),
        Some(found) => Ok(found),
        None => Ok((text.to_owned(), 1.0)),
    }
}

impl fmt::Display for SweepParameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let written = |(field, factor): &(String, f64)| {
            if *factor == 1.0 { field.clone() } else { format!("{field}*{factor}") }
        };
        let fields: Vec<_> = self.fields.iter().map(written).collect();
        write!(f, "{}={}", fields.join(","), self.distribution)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_draw_may_change_several_fields() {
        for (text, fields) in [
            ("dt=1..2", &[("dt", 1.0)][..]),
            ("bodies.a.mass,bodies.b.mass=1..2", &[("bodies.a.mass", 1.0), ("bodies.b.mass", 1.0)]),
            ("bodies.0.position.0, gravity[1] * -2.5 =1..2", &[("bodies.0.position.0", 1.0), ("gravity[1]", -2.5)]),
            // Names of bodies with commas, stars and equals signs.
            ("bodies.a,b=c.mass=1..2", &[("bodies.a,b=c.mass", 1.0)]),
            ("bodies.a*2.mass*3=1..2", &[("bodies.a*2.mass", 3.0)]),
            ("bodies.a,dtx.mass=1..2", &[("bodies.a,dtx.mass", 1.0)]),
        ] {
            let parameter: SweepParameter = text.parse().unwrap();
            let found: Vec<_> = parameter.fields.iter().map(|(field, factor)| (field.as_str(), *factor)).collect();
            assert_eq!(found, fields, "{text}");
            assert_eq!(parameter.to_string().parse(), Ok(parameter));
        }
        assert!("dt*inf=1..2".parse::<SweepParameter>().is_err());
    }
}
