//! Why triangles are no mesh, or no solid.

use glam::DVec3;
use thiserror::Error;

use super::defect::MeshDefect;
use crate::inertia_error::listed;

/// Why a [`TriangleMesh`](crate::TriangleMesh) or a [`SolidMesh`](crate::SolidMesh) cannot be made.
///
/// ```
/// use tumble_math::{MeshError, TriangleMesh};
/// assert_eq!(TriangleMesh::new(vec![], vec![]).unwrap_err(), MeshError::NoTriangles);
/// ```
#[derive(Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum MeshError {
    /// There is no triangle.
    #[error("a mesh needs at least one triangle")]
    NoTriangles,
    /// There are more vertices or triangles than [`TriangleMesh::MAX`](crate::TriangleMesh::MAX).
    #[error("a mesh of {count} {what} is too large: at most 2^30 are counted")]
    TooLarge {
        /// `"vertices"` or `"triangles"`.
        what: &'static str,
        /// How many there are.
        count: usize,
    },
    /// A vertex is not finite or further out than
    /// [`MassProperties::REACH`](crate::MassProperties::REACH).
    #[error("vertex {vertex} at {} is not finite or beyond 1e90 m", listed(*.position))]
    Position {
        /// Index of the vertex, from 0.
        vertex: usize,
        /// Its position \[m\].
        position: DVec3,
    },
    /// A triangle names a vertex that is not there.
    #[error("triangle {triangle} names vertex {index}, but there are only {vertices}, counted from 0")]
    Index {
        /// Index of the triangle, from 0.
        triangle: usize,
        /// The vertex it names.
        index: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// All vertices in use lie within less than 1e-90 m, so that no volume can be held.
    #[error("the mesh is only {extent:?} m in size, it must be at least 1e-90 m")]
    Extent {
        /// The longest side of its box \[m\].
        extent: f64,
    },
    /// The surface bounds no solid, or not without repairs that were not asked for.
    #[error("{}", in_a_row(.defects))]
    NotSolid {
        /// Everything that stands against it.
        defects: Vec<MeshDefect>,
    },
    /// The parts are closed and wound well, but what they bound together has no volume, or is no
    /// distribution of mass: cavities as large as what they are in, or a surface that crosses
    /// itself.
    #[error("the mesh bounds no solid: it crosses itself, its volume comes out as {volume:?} m^3")]
    NoVolume {
        /// The signed volume [m^3].
        volume: f64,
    },
}

crate::debug_as_display!(MeshError);

/// `3 open edges, 1 part inside out`.
fn in_a_row(defects: &[MeshDefect]) -> String {
    let each: Vec<String> = defects.iter().map(ToString::to_string).collect();
    format!("the mesh bounds no solid: {}", each.join(", "))
}
