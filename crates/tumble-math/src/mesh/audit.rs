//! What there is to be known of a surface before it is trusted.

use glam::DVec3;

use super::defect::MeshDefect;
use super::mesh_analysis::Anatomy;
use super::moments::{signed_volume, surface_area};
use super::triangle_mesh::TriangleMesh;

/// Counts of what is in a mesh and of what is wrong with it, all of it, not only the first.
///
/// Edges, parts, volume and area are those of the surface after vertices at exactly the same place
/// have been taken for one, and without the triangles that are degenerate or duplicates. If welding
/// near-duplicates closes all its open edges, they are [`cracks`](Self::cracks), and everything
/// else is counted as it is once they are welded.
///
/// Not looked for: whether the surface crosses itself.
///
/// ```
/// use tumble_math::{MeshDefect, TriangleMesh};
/// use glam::DVec3;
///
/// // A tetrahedron with one triangle the wrong way round.
/// let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
/// let mesh = TriangleMesh::new(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 3, 2]])?;
/// let audit = mesh.audit();
/// assert_eq!((audit.parts, audit.open_edges, audit.reversed_edges), (1, 0, 3));
/// assert_eq!(audit.problems(), [MeshDefect::ReversedEdges { edges: 3 }]);
/// assert!(mesh.solid().is_err());
/// assert!((mesh.repaired()?.0.volume() - 1.0 / 6.0).abs() < 1e-16);
/// # Ok::<(), tumble_math::MeshError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct MeshAudit {
    /// Vertices, as given.
    pub vertices: usize,
    /// Triangles, as given.
    pub triangles: usize,
    /// Vertices at exactly the place of an earlier one.
    pub duplicate_vertices: usize,
    /// Further vertices within [`TriangleMesh::NEAR`] times the longest side of the box of an
    /// earlier one.
    pub near_duplicates: usize,
    /// Vertices that no triangle uses.
    pub unused_vertices: usize,
    /// Triangles with two corners at one place.
    pub degenerate_triangles: usize,
    /// Triangles with three different corners on one line, within rounding.
    pub collinear_triangles: usize,
    /// Triangles with the same three corners as an earlier one, whichever way round.
    pub duplicate_triangles: usize,
    /// Edges with one triangle, if no welding closes them all.
    pub open_edges: usize,
    /// Edges with one triangle, if welding near-duplicates closes them all.
    pub cracks: usize,
    /// Edges with more than two triangles.
    pub overfull_edges: usize,
    /// Edges along which their two triangles run the same way.
    pub reversed_edges: usize,
    /// What hangs together through edges.
    pub parts: usize,
    /// Parts that have one side only.
    pub one_sided_parts: usize,
    /// Closed parts without volume, within rounding.
    pub flat_parts: usize,
    /// Closed parts wound consistently but the wrong way: solids inwards, cavities outwards.
    pub inside_out_parts: usize,
    /// Closed parts at odd depth of nesting; `None` if there are too many crossings to tell.
    pub cavities: Option<usize>,
    /// Volume as wound [m^3]: negative if inside out. Of an open surface, that of the cone to the
    /// middle of its box.
    pub volume: f64,
    /// Area [m^2].
    pub area: f64,
    /// Lowest and highest coordinates of the vertices in use \[m\].
    pub extents: (DVec3, DVec3),
}

impl MeshAudit {
    pub(crate) fn of(mesh: &TriangleMesh) -> Self {
        Self::from_anatomy(mesh, &Anatomy::of(mesh))
    }

    pub(crate) fn from_anatomy(mesh: &TriangleMesh, anatomy: &Anatomy) -> Self {
        let (edges, surface, frame) = (&anatomy.edges, &anatomy.surface, &anatomy.frame);
        let parts = &anatomy.parts.parts;
        let corners = || surface.triangles.iter().map(|corners| corners.map(|c| mesh.positions()[c as usize]));
        let (area, collinear) = surface_area(corners(), frame);
        let closed = |wanted: &dyn Fn(usize) -> bool| (0..parts.len()).filter(|part| wanted(*part)).count();
        let is_inside_out = |part: usize| {
            parts[part].is_solid()
                && parts[part].reversed == 0
                && anatomy.depths.is_some()
                && anatomy.is_inside_out(part)
        };
        let unit = frame.unit;
        Self {
            vertices: mesh.positions().len(),
            triangles: mesh.triangles().len(),
            duplicate_vertices: anatomy.coincident,
            near_duplicates: anatomy.nearby,
            unused_vertices: anatomy.unused,
            degenerate_triangles: surface.degenerate,
            collinear_triangles: collinear,
            duplicate_triangles: surface.duplicates,
            open_edges: edges.open,
            cracks: anatomy.cracks.unwrap_or(0),
            overfull_edges: edges.overfull,
            reversed_edges: edges.reversed,
            parts: parts.len(),
            one_sided_parts: closed(&|part| !parts[part].two_sided),
            flat_parts: closed(&|part| {
                parts[part].closed && parts[part].two_sided && parts[part].volume.is_lost_in_rounding()
            }),
            inside_out_parts: closed(&is_inside_out),
            cavities: anatomy.depths.as_ref().map(|depths| depths.iter().filter(|depth| **depth % 2 == 1).count()),
            volume: signed_volume(corners(), frame).value * unit * unit * unit,
            area: area * unit * unit,
            extents: (frame.low, frame.high),
        }
    }

    /// Everything that is wrong, in the order in which it is repaired; empty for a mesh that is
    /// solid as it is. Vertices at exactly the same place, near-duplicates that tear nothing, and
    /// unused vertices are not problems.
    #[must_use]
    pub fn problems(&self) -> Vec<MeshDefect> {
        let (edges, parts) = (self.open_edges, self.inside_out_parts);
        let each = [
            (self.degenerate_triangles, MeshDefect::DegenerateTriangles { triangles: self.degenerate_triangles }),
            (self.collinear_triangles, MeshDefect::CollinearTriangles { triangles: self.collinear_triangles }),
            (self.duplicate_triangles, MeshDefect::DuplicateTriangles { triangles: self.duplicate_triangles }),
            (self.cracks, MeshDefect::Cracks { edges: self.cracks, vertices: self.near_duplicates }),
            (edges, MeshDefect::OpenEdges { edges }),
            (self.overfull_edges, MeshDefect::OverfullEdges { edges: self.overfull_edges }),
            (self.reversed_edges, MeshDefect::ReversedEdges { edges: self.reversed_edges }),
            (self.one_sided_parts, MeshDefect::OneSidedParts { parts: self.one_sided_parts }),
            (self.flat_parts, MeshDefect::FlatParts { parts: self.flat_parts }),
            (parts, MeshDefect::InsideOutParts { parts }),
            (usize::from(self.cavities.is_none()), MeshDefect::TooManyCrossings),
        ];
        each.into_iter().filter(|(count, _)| *count > 0).map(|(_, defect)| defect).collect()
    }
}
