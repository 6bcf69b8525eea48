//! Why a shape has no mass properties.

use std::fmt;

use thiserror::Error;

use crate::mass_error::MassError;

/// Why a shape has no mass properties: what is wrong, and in a compound where.
///
/// Displays as one line that begins with the place:
/// `parts[2].radius must be a length from 1e-90 to 1e90 m, it is -1.0`.
///
/// ```
/// use tumble_math::{Amount, Part, Shape};
/// let wheel = Part::new(Shape::cylinder(-0.3, 0.1), Amount::Mass(5.0));
/// let error = Shape::compound([wheel]).own_mass_properties().unwrap_err();
/// assert_eq!(error.path(), "parts[0].radius");
/// ```
#[derive(Clone, PartialEq)]
#[non_exhaustive]
pub struct ShapeError {
    /// In a compound, the indices that lead to the part; empty otherwise.
    pub part: Vec<usize>,
    /// What is wrong there.
    pub reason: ShapeErrorReason,
}

/// What is wrong with a shape.
///
/// ```
/// use tumble_math::{Amount, Shape, ShapeErrorReason};
/// let error = Shape::Point.mass_properties(Amount::Density(1.0)).unwrap_err();
/// assert!(matches!(error.reason, ShapeErrorReason::NoVolume { .. }));
/// ```
#[derive(Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ShapeErrorReason {
    /// A length is zero, negative, not finite, or outside
    /// [`Shape::LENGTHS`](crate::Shape::LENGTHS).
    #[error("must be a length from 1e-90 to 1e90 m, it is {value:?}")]
    Length {
        /// Name of the parameter, as in [`Shape`](crate::Shape).
        name: &'static str,
        /// Its value (of a vector, the first component at fault) \[m\].
        value: f64,
    },
    /// The inside of a hollow solid is not smaller than the outside.
    #[error("must be smaller than the outer radius {outer:?}, it is {inner:?}")]
    Inner {
        /// Inner radius \[m\].
        inner: f64,
        /// Outer radius \[m\].
        outer: f64,
    },
    /// A density is zero, negative or not finite.
    #[error("must be positive and finite, it is {value:?}")]
    Density {
        /// The density [kg/m^3].
        value: f64,
    },
    /// A density was given to a shape without volume, such as a point or a thin shell. Give its
    /// mass.
    #[error("has no meaning for a {shape}: it has no volume, give a mass")]
    NoVolume {
        /// What the shape is.
        shape: &'static str,
    },
    /// The mass, given or computed from the density, is not possible.
    #[error(transparent)]
    Mass(MassError),
    /// A part's position or orientation is not possible.
    #[error(transparent)]
    Pose(MassError),
    /// The corners of a tetrahedron lie in a plane.
    #[error("lie in one plane")]
    Flat,
    /// A compound has no parts.
    #[error("of a compound must not be empty")]
    NoParts,
    /// Compounds are nested deeper than [`Shape::MAX_DEPTH`](crate::Shape::MAX_DEPTH).
    #[error("are nested more than 32 deep")]
    TooDeep,
    /// Only a compound has masses of its own.
    #[error("must be given: only a compound knows its own")]
    NoOwnMass,
}

crate::debug_as_display!(ShapeErrorReason);

impl ShapeError {
    pub(crate) fn here(reason: ShapeErrorReason) -> Self {
        Self { part: Vec::new(), reason }
    }

    /// The same error seen from the compound in which the part has this index.
    pub(crate) fn in_part(mut self, index: usize) -> Self {
        self.part.insert(0, index);
        self
    }

    /// Name of the field at fault: `radius`, `half_height`, `half_extents`, `radii`, `mass`,
    /// `density`, `position`, `orientation`, `parts`, …
    #[must_use]
    pub fn field(&self) -> &'static str {
        match &self.reason {
            ShapeErrorReason::Length { name, .. } => name,
            ShapeErrorReason::Inner { .. } => "inner",
            ShapeErrorReason::Density { .. } | ShapeErrorReason::NoVolume { .. } => "density",
            ShapeErrorReason::Mass(_) | ShapeErrorReason::NoOwnMass => "mass",
            ShapeErrorReason::Pose(MassError::Orientation { .. }) => "orientation",
            ShapeErrorReason::Pose(_) => "position",
            ShapeErrorReason::Flat => "corners",
            ShapeErrorReason::NoParts | ShapeErrorReason::TooDeep => "parts",
        }
    }

    /// Where the field is, from the shape the error came from: `radius`, or
    /// `parts[2].parts[0].radius`.
    #[must_use]
    pub fn path(&self) -> String {
        let mut path = String::new();
        for index in &self.part {
            path.push_str(&format!("parts[{index}]."));
        }
        path + self.field()
    }
}

impl fmt::Display for ShapeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.reason {
            // These messages name the field themselves.
            ShapeErrorReason::Mass(_) | ShapeErrorReason::Pose(_) => {
                for index in &self.part {
                    write!(f, "parts[{index}].")?;
                }
                write!(f, "{}", self.reason)
            }
            reason => write!(f, "{} {reason}", self.path()),
        }
    }
}

crate::debug_as_display!(ShapeError);

impl std::error::Error for ShapeError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match &self.reason {
            ShapeErrorReason::Mass(source) | ShapeErrorReason::Pose(source) => Some(source),
            _ => None,
        }
    }
}
