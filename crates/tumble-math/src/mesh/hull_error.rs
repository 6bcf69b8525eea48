//! Why points have no convex hull with a volume.

use glam::DVec3;
use thiserror::Error;

use super::mesh_error::MeshError;
use crate::inertia_error::listed;

/// Why [`convex_hull`](crate::convex_hull) has no answer.
///
/// ```
/// use tumble_math::{HullError, convex_hull};
/// assert_eq!(convex_hull(&[glam::DVec3::ZERO]).unwrap_err(), HullError::TooFew { count: 1 });
/// ```
#[derive(Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum HullError {
    /// A hull with a volume needs four points at least.
    #[error("a convex hull needs at least four points, there are {count}")]
    TooFew {
        /// How many there are.
        count: usize,
    },
    /// A point is not finite or further out than
    /// [`MassProperties::REACH`](crate::MassProperties::REACH).
    #[error("point {point} at {} is not finite or beyond 1e90 m", listed(*.position))]
    Position {
        /// Index of the point, from 0.
        point: usize,
        /// Its position \[m\].
        position: DVec3,
    },
    /// All points lie in one plane, on one line or at one place, within 4e-12 of the longest side
    /// of their box.
    #[error("all {count} points lie in one plane, so their hull has no volume")]
    Flat {
        /// How many there are.
        count: usize,
    },
    /// The points lie so that finding their hull would take far longer than it takes for most, as
    /// those of a cylinder with many thousand corners do.
    #[error(
        "the convex hull of these {count} points takes too much work: leave out points that it does not need, such as most of a circle's"
    )]
    TooMuchWork {
        /// How many there are.
        count: usize,
    },
    /// There are more points than a mesh can have vertices.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

crate::debug_as_display!(HullError);
