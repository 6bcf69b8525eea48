//! The engine's collider of a body, made of the pieces that its file has.

use std::collections::HashMap;
use std::ptr;
use std::sync::Arc;

use glam::{DQuat, DVec3};
use tumble::{Collider, ColliderError, Pose, Shape, SolidMesh, TriangleMesh};

use crate::bodies::imported_collider::{ColliderRole, ImportedCollider};
use crate::checked::{real_quaternion, real_vector};
use crate::gltf::Geometry;

/// What a body touches others with, if the engine can. `shape` is that of its solid pieces
/// together. What is lost goes to `notices`.
pub(crate) fn collider(
    pieces: &[ImportedCollider],
    shape: Option<&Shape>,
    is_moved: bool,
    known: &mut Colliders,
    notices: &mut Vec<String>,
) -> Option<Collider> {
    tell_of_triggers(pieces, notices);
    let solid: Vec<&ImportedCollider> = pieces.iter().filter(|piece| piece.role == ColliderRole::Solid).collect();
    let first = solid.first()?;
    let made = match (solid.as_slice(), surface(first)) {
        _ if is_ground(pieces) && !is_moved => Ok(Collider::half_space()),
        ([_], Some(surface)) if !is_moved => shared(known, &solid, is_moved, || of_surface(first, surface)),
        _ => {
            tell_of_solids(&solid, is_moved, notices);
            if differ(&solid) {
                of_pieces(&solid, |_| None)
            } else {
                let shape = shape?;
                shared(known, &solid, is_moved, || Collider::new(shape))
            }
        }
    };
    let made = match made {
        Ok(collider) if !differ(&solid) => collider.with_material(first.material.to_engine()),
        made => made,
    };
    match made {
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
pub(crate) type Colliders = HashMap<(bool, Vec<PieceKey>), (Result<Collider, ColliderError>, Vec<ImportedCollider>)>;

/// A mesh by where it lies in memory, any other shape by its figures, and the bits of its place in
/// the body.
pub(crate) type PieceKey = (*const SolidMesh, *const TriangleMesh, String, [u64; 7]);

#[cfg(test)]
thread_local! {
    /// How many colliders of meshes have been made.
    pub(crate) static MADE: std::cell::Cell<usize> = const { std::cell::Cell::new(0) };
}

/// Makes the hull or the tree of a mesh once for all bodies that have it in the same place.
fn shared(
    known: &mut Colliders,
    pieces: &[&ImportedCollider],
    is_moved: bool,
    make: impl FnOnce() -> Result<Collider, ColliderError>,
) -> Result<Collider, ColliderError> {
    if !pieces.iter().any(|piece| matches!(piece.shape, Some(Shape::Mesh(_))) || piece.surface.is_some()) {
        return make();
    }
    let key = |piece: &&ImportedCollider| -> PieceKey {
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

/// Whether pieces have materials or filters of their own.
fn differ(solid: &[&ImportedCollider]) -> bool {
    solid.windows(2).any(|pair| pair[0].material != pair[1].material || pair[0].filter != pair[1].filter)
}

/// Each solid piece with its own material, and with the groups that are given for it.
pub(crate) fn of_pieces(
    solid: &[&ImportedCollider],
    groups: impl Fn(&ImportedCollider) -> Option<(u32, u32)>,
) -> Result<Collider, ColliderError> {
    let parts: Result<Vec<Collider>, ColliderError> =
        solid.iter().filter_map(|piece| of_piece(piece, groups(piece))).collect();
    Collider::compound(parts?)
}

/// A piece as a collider of its own; `None` if it has no volume.
pub(crate) fn of_piece(
    piece: &ImportedCollider,
    groups: Option<(u32, u32)>,
) -> Option<Result<Collider, ColliderError>> {
    let (membership, filter) = groups.unwrap_or((u32::MAX, u32::MAX));
    let at = Pose { position: real_vector(piece.position), orientation: real_quaternion(piece.orientation) };
    let part = Collider::new(piece.shape.as_ref()?).and_then(|it| it.with_offset(at));
    Some(part.and_then(|it| it.with_groups(membership, filter).with_material(piece.material.to_engine())))
}

/// Whether the only piece is an endless plane in the body's own frame.
pub(crate) fn is_ground(pieces: &[ImportedCollider]) -> bool {
    let is_plane = |piece: &ImportedCollider| {
        piece.role == ColliderRole::Solid
            && matches!(piece.geometry, Geometry::Plane { size_x: None, size_z: None, .. })
            && (piece.position, piece.orientation) == (DVec3::ZERO, DQuat::IDENTITY)
    };
    matches!(pieces, [only] if is_plane(only))
}

/// The triangles of a piece that is meant as they are.
fn surface(piece: &ImportedCollider) -> Option<&TriangleMesh> {
    let is_hull = matches!(piece.geometry, Geometry::Mesh { convex_hull: true, .. });
    piece.surface.as_deref().filter(|_| !is_hull)
}

fn of_surface(piece: &ImportedCollider, surface: &TriangleMesh) -> Result<Collider, ColliderError> {
    let orientation = real_quaternion(piece.orientation);
    let offset = Pose { position: real_vector(piece.position), orientation };
    Collider::mesh(surface.positions().iter().copied(), surface.triangles())?.with_offset(offset)
}

/// What of the pieces is otherwise than the file has it.
fn tell_of_solids(solid: &[&ImportedCollider], is_moved: bool, notices: &mut Vec<String>) {
    let is_plane = |piece: &&ImportedCollider| matches!(piece.geometry, Geometry::Plane { .. });
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

/// What of the triggers is otherwise than the file has it.
fn tell_of_triggers(pieces: &[ImportedCollider], notices: &mut Vec<String>) {
    let mut triggers = pieces.iter().filter(|piece| piece.role == ColliderRole::Trigger);
    if triggers.clone().any(|piece| piece.shape.is_none()) {
        notices.push("has a trigger without a volume, which senses nothing".to_owned());
    }
    if triggers.any(|piece| piece.shape.is_some() && surface(piece).is_some()) {
        notices.push("has a mesh as a trigger, which senses as its convex hull".to_owned());
    }
}

/// What of materials and filters counts for nothing.
fn tell_of_surfaces(solid: &[&ImportedCollider], notices: &mut Vec<String>) {
    if solid.iter().any(|piece| piece.material.restitution > 1.0) {
        notices.push("has a restitution of more than 1, taken for 1".to_owned());
    }
    if solid.iter().any(|piece| matches!(piece.geometry, Geometry::Plane { double_sided: true, .. })) {
        notices.push("has a plane of two sides, of which one touches".to_owned());
    }
}
