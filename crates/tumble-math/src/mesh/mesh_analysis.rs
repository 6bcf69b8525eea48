//! Everything about a mesh that its audit counts and its repair changes.

use super::connected_components::Parts;
use super::edges::Edges;
use super::local_frame::LocalFrame;
use super::nesting;
use super::surface::Surface;
use super::triangle_mesh::TriangleMesh;
use super::vertex_weld::{first_at_same_place, first_nearby};

/// A mesh taken apart.
#[derive(Clone, Debug)]
pub(crate) struct Anatomy {
    pub(crate) frame: LocalFrame,
    /// Vertices that no triangle uses.
    pub(crate) unused: usize,
    /// Vertices at exactly the place of an earlier one.
    pub(crate) coincident: usize,
    /// Further vertices that nearly are.
    pub(crate) nearby: usize,
    pub(crate) surface: Surface,
    pub(crate) edges: Edges,
    pub(crate) parts: Parts,
    /// How many parts each part lies in; `None` where it would have taken too long.
    pub(crate) depths: Option<Vec<u32>>,
    /// Open edges before near-duplicates were welded to close them; `None` if they were not.
    pub(crate) cracks: Option<usize>,
}

impl Anatomy {
    /// With near-duplicates welded where that closes all open edges and makes none overfull.
    pub(crate) fn of(mesh: &TriangleMesh) -> Self {
        let (positions, triangles) = (mesh.positions(), mesh.triangles());
        let mut used = vec![false; positions.len()];
        for &corner in triangles.iter().flatten() {
            used[corner as usize] = true;
        }
        let unused = used.iter().filter(|used| !**used).count();
        let frame = LocalFrame::around(positions.iter().zip(&used).filter(|(_, used)| **used).map(|(p, _)| *p));

        let same = first_at_same_place(positions);
        for &corner in triangles.iter().flatten() {
            used[same[corner as usize] as usize] = true;
        }
        let near = first_nearby(positions, &same, &used, TriangleMesh::NEAR * frame.extent());
        let coincident = same.iter().zip(0..).filter(|(first, vertex)| **first != *vertex).count();
        let nearby = same.iter().zip(&near).zip(0..).filter(|((same, near), v)| **same == *v && **near != *v).count();

        let mut surface = Surface::welded(triangles, &same);
        let mut edges = Edges::of(&surface.triangles);
        let mut cracks = None;
        if edges.open > 0 && nearby > 0 {
            let welded = Surface::welded(triangles, &near);
            let closed = Edges::of(&welded.triangles);
            if closed.open == 0 && closed.overfull == 0 && !welded.triangles.is_empty() {
                cracks = Some(edges.open);
                (surface, edges) = (welded, closed);
            }
        }
        let parts = Parts::of(positions, &surface.triangles, &edges, &frame);
        let depths = nesting::depths(positions, &surface.triangles, &parts, &frame, TriangleMesh::MAX_CROSSINGS);
        Self { frame, unused, coincident, nearby, surface, edges, parts, depths, cracks }
    }

    /// Whether the part is to be turned round as a whole: by the sign of its volume and how deep it
    /// lies.
    pub(crate) fn is_inside_out(&self, part: usize) -> bool {
        let depth = self.depths.as_ref().map_or(0, |depths| depths[part]);
        (self.parts.parts[part].volume.value < 0.0) != (depth % 2 == 1)
    }
}
