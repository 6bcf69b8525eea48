//! The engine's collider of a body, made of the pieces that its file has.

use std::collections::HashMap;
use std::ptr;
use std::sync::Arc;

use glam::{DQuat, DVec3};
use tumble::{Collider, ColliderError, Pose, Shape, SolidMesh, TriangleMesh};

use super::geometry::Geometry;
use crate::convert::{real_quaternion, real_vector};
use crate::{ColliderRole, SceneCollider};

/// What a body touches others with, if the engine can. `shape` is that of its solid pieces together. What is lost goes to `notices`.
pub(super) fn collider(
    pieces: &[SceneCollider],
    shape: Option<&Shape>,
    is_moved: bool,
    known: &mut Colliders,
    notices: &mut Vec<String>,
) -> Option<Collider> {
    let solid: Vec<&SceneCollider> = pieces.iter().filter(|piece| piece.role == ColliderRole::Solid).collect();
    let first = solid.first()?;
    let made = match (solid.as_slice(), surface(first)) {
        _ if is_ground(pieces) && !is_moved => Ok(Collider::half_space()),
        ([_], Some(surface)) if !is_moved => shared(known, &solid, is_moved, || of_surface(first, surface)),
        _ => {
            tell_of_solids(&solid, is_moved, notices);
            let shape = shape?;
            shared(known, &solid, is_moved, || Collider::new(shape))
        }
    };
    match made.and_then(|collider| collider.with_material(first.material.to_engine())) {
        Ok(collider) => {
            tell_of_surfaces(&solid, notices);
            Some(collider)
        }
        Err(error) => {
            notices.push(format!("touches nothing: {error}"));
            None
        }
    }
}

/// Colliders of meshes by what they are made of.
pub(super) type Colliders = HashMap<(bool, Vec<PieceKey>), (Result<Collider, ColliderError>, Vec<SceneCollider>)>;

/// A mesh by where it lies in memory, any other shape by its figures, and the bits of its place in the body.
pub(super) type PieceKey = (*const SolidMesh, *const TriangleMesh, String, [u64; 7]);

#[cfg(test)]
thread_local! {
    /// How many colliders of meshes have been made.
    pub(super) static MADE: std::cell::Cell<usize> = const { std::cell::Cell::new(0) };
}

/// Makes the hull or the tree of a mesh once for all bodies that have it in the same place.
fn shared(
    known: &mut Colliders,
    pieces: &[&SceneCollider],
    is_moved: bool,
    make: impl FnOnce() -> Result<Collider, ColliderError>,
) -> Result<Collider, ColliderError> {
    if !pieces.iter().any(|piece| matches!(piece.shape, Some(Shape::Mesh(_))) || piece.surface.is_some()) {
        return make();
    }
    let key = |piece: &&SceneCollider| -> PieceKey {
        let (solid, figures) = match &piece.shape {
            Some(Shape::Mesh(solid)) => (Arc::as_ptr(solid), String::new()),
            other => (ptr::null(), format!("{other:?}")),
        };
        let surface = piece.surface.as_ref().map_or(ptr::null(), Arc::as_ptr);
        let ([x, y, z], [a, b, c, d]) = (piece.position.to_array(), piece.orientation.to_array());
        (solid, surface, figures, [x, y, z, a, b, c, d].map(f64::to_bits))
    };
    #[cfg(test)]
    let make = || {
        MADE.with(|made| made.set(made.get() + 1));
        make()
    };
    // The pieces are kept, so that no other mesh comes to lie where one of them was.
    let keep = || (make(), pieces.iter().map(|piece| (*piece).clone()).collect());
    known.entry((is_moved, pieces.iter().map(key).collect())).or_insert_with(keep).0.clone()
}

/// Whether the only piece is an endless plane in the body's own frame.
pub(super) fn is_ground(pieces: &[SceneCollider]) -> bool {
    let is_plane = |piece: &SceneCollider| {
        piece.role == ColliderRole::Solid
            && matches!(piece.geometry, Geometry::Plane { size_x: None, size_z: None, .. })
            && (piece.position, piece.orientation) == (DVec3::ZERO, DQuat::IDENTITY)
    };
    matches!(pieces, [only] if is_plane(only))
}

/// The triangles of a piece that is meant as they are.
fn surface(piece: &SceneCollider) -> Option<&TriangleMesh> {
    let is_hull = matches!(piece.geometry, Geometry::Mesh { convex_hull: true, .. });
    piece.surface.as_deref().filter(|_| !is_hull)
}

fn of_surface(piece: &SceneCollider, surface: &TriangleMesh) -> Result<Collider, ColliderError> {
    let orientation = real_quaternion(piece.orientation);
    let offset = Pose { position: real_vector(piece.position), orientation };
    Collider::mesh(surface.positions().iter().copied(), surface.triangles())?.with_offset(offset)
}

/// What of the pieces is otherwise than the file has it.
fn tell_of_solids(solid: &[&SceneCollider], is_moved: bool, notices: &mut Vec<String>) {
    let is_plane = |piece: &&SceneCollider| matches!(piece.geometry, Geometry::Plane { .. });
    if solid.iter().any(is_plane) {
        notices.push(
            "has a plane that touches nothing: it is neither ground nor the only collider of a fixed body".to_owned(),
        );
    }
    if solid.iter().any(|piece| !is_plane(piece) && surface(piece).is_some()) {
        let why = if is_moved { "of a body that moves" } else { "among other colliders of a body" };
        notices.push(format!("has a mesh {why}, which touches as its convex hull"));
    }
}

/// What of materials and filters counts for nothing.
fn tell_of_surfaces(solid: &[&SceneCollider], notices: &mut Vec<String>) {
    if solid.windows(2).any(|pair| pair[0].material != pair[1].material) {
        notices.push("has colliders of several materials: the first one's is that of all".to_owned());
    }
    if solid.windows(2).any(|pair| pair[0].filter != pair[1].filter) {
        notices.push("has colliders of several collision filters: the first one's is that of all".to_owned());
    }
    if solid.iter().any(|piece| piece.material.restitution > 1.0) {
        notices.push("has a restitution of more than 1, taken for 1".to_owned());
    }
    if solid.iter().any(|piece| matches!(piece.geometry, Geometry::Plane { double_sided: true, .. })) {
        notices.push("has a plane of two sides, of which one touches".to_owned());
    }
}
