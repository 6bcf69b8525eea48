//! Triangles over shared vertices.

use glam::{DAffine3, DVec3};

use super::audit::MeshAudit;
use super::defect::MeshRepair;
use super::mesh_error::MeshError;
use super::solid_mesh::SolidMesh;
use crate::mass_properties::check_position;

/// A surface of triangles over shared vertices \[m\]: finite, its indices in range, and nothing
/// more. It may have holes.
///
/// Seen from outside, corners run counter-clockwise. What is right and wrong with the surface says
/// [`audit`](Self::audit); a body is made of it by [`solid`](Self::solid), or by
/// [`repaired`](Self::repaired).
///
/// ```
/// use tumble_math::{Amount, TriangleMesh};
/// use glam::DVec3;
///
/// let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
/// let mesh = TriangleMesh::new(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// let properties = mesh.solid()?.mass_properties(Amount::Density(600.0))?;
/// assert!((properties.mass() - 100.0).abs() < 1e-12);
/// assert!((properties.center_of_mass() - DVec3::splat(0.25)).length() < 1e-15);
///
/// let open = TriangleMesh::new(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2]])?;
/// assert_eq!(open.solid().unwrap_err().to_string(), "the mesh bounds no solid: 3 open edges");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct TriangleMesh {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
}

impl TriangleMesh {
    /// Most vertices, and most triangles, of a mesh: their sides are to be counted in 32 bits.
    pub const MAX: usize = 1 << 30;

    /// How many times a triangle is compared with a line before the question which part is inside
    /// which is given up, about ten seconds' work. A mesh of one part needs none, parts beside or
    /// in one another some dozens each.
    pub const MAX_CROSSINGS: usize = 1 << 31;

    /// Vertices closer than this times the longest side of the mesh's box count as near-duplicates.
    /// It is far above the rounding of double precision, so that transforming one side of a seam
    /// and not the other does not tear it, and far below that of single precision (6e-8), so that
    /// vertices which a file of single precision tells apart stay apart.
    pub const NEAR: f64 = 1e-9;

    /// From vertices \[m\] and, for each triangle, the indices of its corners.
    ///
    /// # Errors
    /// [`MeshError`] names the vertex that is not finite or too far out, or the triangle with an
    /// index out of range, by its index.
    pub fn new(positions: impl Into<Vec<DVec3>>, triangles: impl Into<Vec<[u32; 3]>>) -> Result<Self, MeshError> {
        let (positions, triangles) = (positions.into(), triangles.into());
        if triangles.is_empty() {
            return Err(MeshError::NoTriangles);
        }
        for (what, count) in [("vertices", positions.len()), ("triangles", triangles.len())] {
            if count > Self::MAX {
                return Err(MeshError::TooLarge { what, count });
            }
        }
        if let Some((vertex, &position)) = positions.iter().enumerate().find(|(_, p)| check_position(**p).is_err()) {
            return Err(MeshError::Position { vertex, position });
        }
        let vertices = positions.len();
        for (triangle, corners) in triangles.iter().enumerate() {
            if let Some(&index) = corners.iter().find(|index| **index as usize >= vertices) {
                return Err(MeshError::Index { triangle, index, vertices });
            }
        }
        Ok(Self { positions, triangles })
    }

    /// The vertices \[m\].
    #[must_use]
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    /// The corners of each triangle, as indices of vertices.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The mesh moved, turned and scaled. A mirror image is wound the other way, so that outside
    /// stays outside.
    ///
    /// # Errors
    /// [`MeshError::Position`] names the vertex that ends up too far out, or nowhere.
    pub fn transformed(&self, transform: &DAffine3) -> Result<Self, MeshError> {
        let matrix = transform.matrix3;
        let largest = matrix.to_cols_array().iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        let mirrors = (matrix * (1.0 / largest)).determinant() < 0.0;
        let positions: Vec<DVec3> = self.positions.iter().map(|p| transform.transform_point3(*p)).collect();
        let triangles: Vec<[u32; 3]> = if mirrors {
            self.triangles.iter().map(|[a, b, c]| [*a, *c, *b]).collect()
        } else {
            self.triangles.clone()
        };
        Self::new(positions, triangles)
    }

    /// All triangles of several meshes as one. No vertices are shared between them.
    ///
    /// # Errors
    /// [`MeshError::NoTriangles`] if there is no mesh, [`MeshError::TooLarge`] if there are too
    /// many vertices.
    pub fn merged(meshes: impl IntoIterator<Item = Self>) -> Result<Self, MeshError> {
        let (mut positions, mut triangles) = (Vec::new(), Vec::new());
        for mesh in meshes {
            let count = positions.len();
            // Checked before a vertex index can leave 32 bits.
            if count > Self::MAX {
                return Err(MeshError::TooLarge { what: "vertices", count });
            }
            let first = count as u32;
            positions.extend(mesh.positions);
            triangles.extend(mesh.triangles.iter().map(|corners| corners.map(|corner| corner + first)));
        }
        Self::new(positions, triangles)
    }

    /// Counts everything that is to be known of the surface before it is trusted.
    ///
    /// Takes about a second for a million triangles; the time grows as `n log n`.
    #[must_use]
    pub fn audit(&self) -> MeshAudit {
        MeshAudit::of(self)
    }

    /// The solid inside the surface.
    ///
    /// Vertices at exactly the same place are taken for one, as files without shared vertices (STL)
    /// need, and triangles of no area are passed over. Everything else must be right already: each
    /// edge with two triangles that run along it in opposite directions, solids wound outwards,
    /// cavities inwards.
    ///
    /// Whether the surface crosses itself is not looked for.
    ///
    /// # Errors
    /// [`MeshError::NotSolid`] with everything that is wrong.
    pub fn solid(&self) -> Result<SolidMesh, MeshError> {
        SolidMesh::strictly(self)
    }

    /// The solid inside the surface, after such repairs as leave no doubt what was meant, and what
    /// was repaired:
    ///
    /// - triangles with two corners at one place and duplicates are left out;
    /// - where the surface has open edges, and welding vertices closer than [`NEAR`](Self::NEAR)
    ///   closes all of them, they are welded, each to one that stays where it is, so nothing moves
    ///   further than that;
    /// - triangles wound against their neighbours are turned round;
    /// - parts are turned so that solids, at even depth of nesting, have positive volume and
    ///   cavities, at odd depth, negative. A part inside another that is wound outwards like it is
    ///   taken for a cavity: that its matter should count twice is the other thing it could mean,
    ///   and less likely.
    ///
    /// No triangle is ever added: holes stay holes.
    ///
    /// # Errors
    /// [`MeshError::NotSolid`] with what cannot be repaired.
    pub fn repaired(&self) -> Result<(SolidMesh, Vec<MeshRepair>), MeshError> {
        SolidMesh::with_repairs(self)
    }
}
