//! The engine's collider of a body, made of the pieces that its file has.

use glam::{DQuat, DVec3};
use tumble::{Collider, Shape};

use super::geometry::Geometry;
use crate::{ColliderRole, SceneCollider};

/// What a body touches others with, if the engine can. `shape` is that of its solid pieces together. What is lost goes to `notices`.
pub(super) fn collider(pieces: &[SceneCollider], shape: Option<&Shape>, notices: &mut Vec<String>) -> Option<Collider> {
    let solid: Vec<&SceneCollider> = pieces.iter().filter(|piece| piece.role == ColliderRole::Solid).collect();
    let first = solid.first()?;
    let made = if is_ground(pieces) {
        Ok(Collider::half_space())
    } else if solid.iter().any(|piece| matches!(piece.geometry, Geometry::Plane { .. })) {
        notices.push("has a plane that touches nothing: only an endless one that nothing carries does".to_owned());
        if solid.len() == 1 {
            return None;
        }
        shape.map(Collider::new)?
    } else if solid.iter().any(|piece| is_replaced(piece)) {
        notices.push("has an open or mended mesh, which touches nothing".to_owned());
        return None;
    } else {
        shape.map(Collider::new)?
    };
    let material = first.material.to_engine();
    match made.and_then(|collider| collider.with_material(material)) {
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

/// Whether mass and inertia are those of something else than the surface.
fn is_replaced(piece: &SceneCollider) -> bool {
    match (&piece.surface, &piece.shape, &piece.geometry) {
        (Some(surface), Some(Shape::Mesh(solid)), Geometry::Mesh { convex_hull: false, .. }) => {
            solid.mesh() != surface.as_ref()
        }
        _ => false,
    }
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

/// What of materials and filters counts for nothing.
fn tell_of_surfaces(solid: &[&SceneCollider], notices: &mut Vec<String>) {
    if solid.iter().zip(solid.iter().skip(1)).any(|(one, other)| one.material != other.material) {
        notices.push("has colliders of several materials: the first one's is that of all".to_owned());
    }
    if solid.iter().any(|piece| piece.material.restitution > 1.0) {
        notices.push("has a restitution of more than 1, taken for 1".to_owned());
    }
    if solid.iter().any(|piece| piece.filter.is_some()) {
        notices.push("has a collision filter that is read and not kept: it collides with all".to_owned());
    }
    if solid.iter().any(|piece| matches!(piece.geometry, Geometry::Plane { double_sided: true, .. })) {
        notices.push("has a plane of two sides: what is below it is pushed up".to_owned());
    }
}
