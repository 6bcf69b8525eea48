//! The typed errors of collider construction.

use tumble_collide::HeightFieldError;
use tumble_math::{HullError, MeshError};

use crate::components::Pose;
use crate::math::Real;

/// Why a collider cannot be one.
///
/// ```
/// use tumble::{Amount, Collider, ColliderError, Part, Shape};
///
/// let error = Collider::new(&Shape::cone(0.5, -1.0)).unwrap_err();
/// assert_eq!(error, ColliderError::Length { field: "half_height", value: -1.0 });
/// let wheel = Part::new(Shape::cylinder(0.0, 0.1), Amount::Mass(1.0));
/// let error = Collider::new(&Shape::compound([wheel])).unwrap_err();
/// assert_eq!(error.to_string(), "parts[0]: radius must be a positive number, got 0");
/// ```
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ColliderError {
    /// A shape without a surface.
    #[error("a {shape} cannot be a collider: it has no surface")]
    Shape {
        /// The shape's name.
        shape: &'static str,
    },
    /// A length of the shape is not a positive normal number in the build's precision.
    #[error("{field} must be a positive number, got {value}")]
    Length {
        /// The name of the shape's parameter, or `"extent"` for the whole of a hull or a surface.
        field: &'static str,
        /// What was given.
        value: f64,
    },
    /// A length of the shape is not from 1e-9 to 1e9 m.
    #[error("{field} must be from 1e-9 to 1e9 m, got {value:e}")]
    Size {
        /// As of [`Length`](Self::Length).
        field: &'static str,
        /// What was given.
        value: f64,
    },
    /// A part of a compound cannot be a collider.
    #[error("parts[{part}]: {error}")]
    Part {
        /// Its index, from 0.
        part: usize,
        /// Why.
        error: Box<ColliderError>,
    },
    /// Where a shape, or a part of a compound, is in its frame is not finite, further than 1e9 m,
    /// or not turned by a unit quaternion.
    #[error("{offset:?} is no place for a collider")]
    Offset {
        /// What was given.
        offset: Pose,
    },
    /// Points have no convex hull.
    #[error(transparent)]
    Hull(#[from] HullError),
    /// Triangles are no surface.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// Heights are no ground.
    #[error(transparent)]
    HeightField(#[from] HeightFieldError),
    /// A coefficient of the material is out of its range.
    #[error("{field} must be from 0 to {most}, got {value}")]
    Material {
        /// Its name.
        field: &'static str,
        /// What was given.
        value: Real,
        /// The most it may be.
        most: Real,
    },
}

tumble_math::debug_as_display!(ColliderError);
