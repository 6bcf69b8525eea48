//! Collision filters as the groups of the engine's colliders.

use std::collections::HashMap;
use std::sync::Arc;

use crate::bodies::imported_body::ImportedBody;
use crate::bodies::imported_collider::{ColliderRole, ImportedCollider};
use crate::gltf::CollisionFilter;
use crate::gltf::collider::of_pieces;

/// As many filters as the engine's groups have bits.
const MAX_FILTERS: usize = u32::BITS as usize;

/// Gives each collider the groups of its filter; what is impossible is reported.
///
/// Each different filter of the file is a group of its own, which touches the groups whose filters
/// and it agree on, so that names of systems, of which a collider may have several, mean what they
/// do in the file.
pub(crate) fn assign<'a>(bodies: impl Iterator<Item = &'a mut ImportedBody>) -> Option<String> {
    let mut bodies: Vec<&mut ImportedBody> = bodies.filter(|body| body.collider.is_some()).collect();
    let mut filters: Vec<Arc<CollisionFilter>> = Vec::new();
    // Most colliders have a filter of the file's, which is compared to the others once.
    let mut known: HashMap<*const CollisionFilter, usize> = HashMap::new();
    for piece in bodies.iter().flat_map(|body| solid(body)) {
        let at = piece.filter.as_ref().map_or(std::ptr::null(), Arc::as_ptr);
        let filter = piece.filter.clone().unwrap_or_default();
        let find = || filters.iter().position(|known| *known == filter).unwrap_or(filters.len());
        if *known.entry(at).or_insert_with(find) == filters.len() {
            if filters.len() == MAX_FILTERS {
                return Some(format!("more than {MAX_FILTERS} different collision filters: they count for nothing"));
            }
            filters.push(filter);
        }
    }
    let touched = |filter: &Arc<CollisionFilter>| -> u32 {
        let agree = filters.iter().map(|other| u32::from(filter.collides_with(other)));
        agree.enumerate().fold(0, |bits, (group, agree)| bits | agree << group)
    };
    if filters.iter().all(|filter| filters.iter().all(|other| filter.collides_with(other))) {
        return None;
    }
    let groups = |piece: &ImportedCollider| {
        let group = *known.get(&piece.filter.as_ref().map_or(std::ptr::null(), Arc::as_ptr))?;
        Some((1 << group, touched(filters.get(group)?)))
    };
    for body in &mut bodies {
        let solid: Vec<&ImportedCollider> = solid(body).collect();
        let Some((membership, filter)) = solid.first().and_then(|piece| groups(piece)) else { continue };
        let several = solid.windows(2).any(|pair| pair[0].filter != pair[1].filter);
        let of_parts = if several { of_pieces(&solid, groups).ok() } else { None };
        body.collider = of_parts.or(body.collider.take().map(|it| it.with_groups(membership, filter)));
    }
    None
}

/// What of a body touches others.
fn solid(body: &ImportedBody) -> impl Iterator<Item = &ImportedCollider> {
    body.pieces.iter().filter(|piece| piece.role == ColliderRole::Solid)
}
