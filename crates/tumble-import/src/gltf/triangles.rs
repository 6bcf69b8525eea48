//! Meshes of a document, as triangles in double precision.

use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;

use glam::DAffine3;
use tumble::{MeshError, TriangleMesh};

use crate::error::FieldError;
use crate::gltf::MeshSource;
use crate::gltf::buffers::Buffers;
use crate::gltf::document::{Document, Mesh, Node, Primitive};
use crate::gltf::solid::Solid;
use crate::gltf::tree::{Tree, local};

/// Most vertices, triangles and nodes together of all the meshes that a scene's colliders are made
/// of. A mesh that colliders of one size share counts once.
pub(crate) const MAX_TRIANGLES: usize = 10_000_000;

/// What there are at most as many of.
pub(crate) const OF_COLLIDERS: &str = "vertices, triangles and nodes of all colliders";

/// A mesh or node, whether its hull is wanted, and the bits of its scale.
pub(crate) type SolidKey = (MeshSource, bool, [u64; 3]);

/// Reads meshes, as long as there is room for them.
pub(crate) struct Triangles<'a> {
    document: &'a Document,
    buffers: Buffers<'a>,
    room: usize,
    /// Of each mesh the surfaces of its primitives, in its own frame, and how often they were
    /// placed.
    decoded: HashMap<usize, (Arc<Vec<TriangleMesh>>, usize)>,
    /// What has been made of meshes, for all colliders that want the same.
    pub(crate) solids: HashMap<SolidKey, Result<Solid, FieldError>>,
    /// What was passed over, a line each.
    pub(crate) notices: BTreeSet<String>,
}

impl<'a> Triangles<'a> {
    pub(crate) fn new(document: &'a Document, buffers: Buffers<'a>) -> Self {
        Self {
            document,
            buffers,
            room: MAX_TRIANGLES,
            decoded: HashMap::new(),
            solids: HashMap::new(),
            notices: BTreeSet::new(),
        }
    }

    /// The triangles of a collider, transformed by `scale`.
    pub(crate) fn read(&mut self, source: MeshSource, scale: &DAffine3) -> Result<TriangleMesh, FieldError> {
        let mut parts = Vec::new();
        match source {
            MeshSource::Mesh(mesh) => self.mesh(mesh, scale, &mut parts)?,
            MeshSource::Node(node) => self.nodes(node, scale, &mut parts)?,
        }
        merged(parts)
    }

    /// The triangles of all meshes of the scene, in the world's frame.
    pub(crate) fn of_scene(&mut self, tree: &Tree) -> Result<TriangleMesh, FieldError> {
        let mut parts = Vec::new();
        for (index, (node, place)) in self.document.nodes.iter().zip(&tree.places).enumerate() {
            if let (Some(mesh), Some(place)) = (node.mesh, place) {
                self.note_skin(index, node);
                let read = self.mesh(mesh, &place.transform, &mut parts);
                read.map_err(|error| error.inside(&format!("nodes[{index}].mesh")))?;
            }
        }
        merged(parts)
    }

    /// The meshes of a node and of all below it, in the node's frame.
    fn nodes(&mut self, root: usize, scale: &DAffine3, parts: &mut Vec<TriangleMesh>) -> Result<(), FieldError> {
        let mut open = vec![(root, *scale)];
        while let Some((index, transform)) = open.pop() {
            let Some(node) = self.document.nodes.get(index) else { continue };
            self.take(1)?;
            self.note_skin(index, node);
            if let Some(mesh) = node.mesh {
                self.mesh(mesh, &transform, parts).map_err(|error| error.inside(&format!("nodes[{index}].mesh")))?;
            }
            for &child in &node.children {
                if let Some(node) = self.document.nodes.get(child) {
                    open.push((child, transform * local(node, child)?.0));
                }
            }
        }
        Ok(())
    }

    fn note_skin(&mut self, index: usize, node: &Node) {
        if node.skin.is_some() {
            self.notices.insert(format!("nodes[{index}].skin: skins are not read, the mesh is taken at rest"));
        }
    }

    /// How many vertices, triangles and nodes have been worked on.
    #[cfg(test)]
    pub(crate) fn work(&self) -> usize {
        MAX_TRIANGLES - self.room
    }

    /// Takes up room.
    pub(crate) fn take(&mut self, amount: usize) -> Result<(), FieldError> {
        let full = || FieldError::exceeding("", OF_COLLIDERS, MAX_TRIANGLES as u64);
        self.room = self.room.checked_sub(amount).ok_or_else(full)?;
        Ok(())
    }

    /// The surfaces of a mesh where a node puts them.
    fn mesh(&mut self, index: usize, transform: &DAffine3, parts: &mut Vec<TriangleMesh>) -> Result<(), FieldError> {
        let (surfaces, placed) = match self.decoded.get(&index) {
            Some((surfaces, placed)) => (surfaces.clone(), *placed),
            None => (Arc::new(self.decode(index)?), 0),
        };
        self.decoded.insert(index, (surfaces.clone(), placed + 1));
        for surface in surfaces.iter() {
            if placed > 0 {
                // The first copy was paid for where it was read.
                self.take(surface.positions().len() + surface.triangles().len())?;
            }
            let moved = surface.transformed(transform);
            parts.push(moved.map_err(|error| FieldError::new(format!("meshes[{index}]"), error))?);
        }
        Ok(())
    }

    /// The surfaces of a mesh in its own frame.
    fn decode(&mut self, index: usize) -> Result<Vec<TriangleMesh>, FieldError> {
        let document = self.document;
        let missing = || FieldError::new("", format!("there is no meshes[{index}]"));
        let mesh: &Mesh = document.meshes.get(index).ok_or_else(missing)?;
        if !mesh.weights.is_empty() {
            self.notices.insert(format!(
                "meshes[{index}].weights: morph targets are not read, the collider is the mesh without them"
            ));
        }
        let mut surfaces = Vec::new();
        for (number, primitive) in mesh.primitives.iter().enumerate() {
            let place = format!("meshes[{index}].primitives[{number}]");
            match self.primitive(primitive, &place).map_err(|error| error.inside(&place))? {
                Some(surface) => surfaces.push(surface),
                None => {
                    self.notices.insert(format!("{place}: points and lines are no surface"));
                }
            }
        }
        Ok(surfaces)
    }

    fn primitive(&mut self, primitive: &Primitive, place: &str) -> Result<Option<TriangleMesh>, FieldError> {
        let mode = primitive.mode.unwrap_or(4);
        if !(4..=6).contains(&mode) {
            return Ok(None);
        }
        if primitive.extensions.contains_key("KHR_draco_mesh_compression") {
            return Err(FieldError::new(
                "extensions",
                "KHR_draco_mesh_compression is not read: export without compression",
            ));
        }
        if let Some(extension) = primitive.extensions.keys().next() {
            self.notices.insert(format!("{place}.extensions: {extension} is not read"));
        }
        let missing = || FieldError::new("attributes.POSITION", "is missing");
        let accessor = primitive.attributes.position.ok_or_else(missing)?;
        let positions = self.buffers.positions(accessor, self.room)?;
        self.take(positions.len())?;
        let corners = match primitive.indices {
            Some(accessor) => self.buffers.indices(accessor, 3 * self.room)?,
            None => (0..u32::try_from(positions.len()).unwrap_or(u32::MAX)).collect(),
        };
        let triangles = triangles(&corners, mode);
        self.take(triangles.len())?;
        TriangleMesh::new(positions, triangles).map(Some).map_err(|error: MeshError| FieldError::new("", error))
    }
}

fn merged(parts: Vec<TriangleMesh>) -> Result<TriangleMesh, FieldError> {
    if parts.is_empty() {
        return Err(FieldError::new("", "has no triangles"));
    }
    TriangleMesh::merged(parts).map_err(|error| FieldError::new("", error))
}

/// Corners in threes: a list (mode 4), a strip (5) or a fan (6).
fn triangles(corners: &[u32], mode: u64) -> Vec<[u32; 3]> {
    match mode {
        5 => {
            let turned = |(index, corners): (usize, &[u32])| match *corners {
                // Every other triangle of a strip runs the other way round.
                [a, b, c] if index % 2 == 1 => [a, c, b],
                [a, b, c] => [a, b, c],
                _ => [0; 3],
            };
            corners.windows(3).enumerate().map(turned).collect()
        }
        6 => match corners {
            [center, rim @ ..] => rim.windows(2).map(|edge| [*center, edge[0], edge[1]]).collect(),
            [] => Vec::new(),
        },
        _ => corners.as_chunks::<3>().0.to_vec(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_keep_their_sense() {
        assert_eq!(triangles(&[0, 1, 2, 3, 4], 4), [[0, 1, 2]]);
        assert_eq!(triangles(&[0, 1, 2, 3, 4], 5), [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
        assert_eq!(triangles(&[0, 1, 2, 3], 6), [[0, 1, 2], [0, 2, 3]]);
        assert!(triangles(&[], 6).is_empty() && triangles(&[1], 5).is_empty());
    }
}
