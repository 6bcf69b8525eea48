//! Collision filters as the groups of the engine's colliders.

use std::collections::HashMap;
use std::sync::Arc;

use super::material::CollisionFilter;
use crate::ColliderRole;
use crate::scene_body::SceneBody;

/// As many filters as the engine's groups have bits.
const MOST_FILTERS: usize = u32::BITS as usize;

/// Gives each collider the groups of its filter; what cannot be is told.
///
/// Each different filter of the file is a group of its own, which touches the groups whose filters and it agree on, so that names of systems, of which a
/// collider may have several, mean what they do in the file.
pub(super) fn assign<'a>(bodies: impl Iterator<Item = &'a mut SceneBody>) -> Option<String> {
    let mut bodies: Vec<&mut SceneBody> = bodies.filter(|body| body.collider.is_some()).collect();
    let mut filters: Vec<Arc<CollisionFilter>> = Vec::new();
    let mut of_bodies = Vec::with_capacity(bodies.len());
    // Most bodies have a filter of the file's, which is compared to the others once.
    let mut known: HashMap<*const CollisionFilter, usize> = HashMap::new();
    for body in &bodies {
        let solid = body.pieces.iter().find(|piece| piece.role == ColliderRole::Solid);
        let filter = solid.and_then(|piece| piece.filter.as_ref());
        let at = filter.map_or(std::ptr::null(), Arc::as_ptr);
        let filter = filter.cloned().unwrap_or_default();
        let find = || filters.iter().position(|known| *known == filter).unwrap_or(filters.len());
        of_bodies.push(*known.entry(at).or_insert_with(find));
        if of_bodies.last() == Some(&filters.len()) {
            if filters.len() == MOST_FILTERS {
                return Some(format!("more than {MOST_FILTERS} different collision filters: they count for nothing"));
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
    for (body, group) in bodies.iter_mut().zip(of_bodies) {
        let Some(filter) = filters.get(group) else { continue };
        body.collider = body.collider.take().map(|collider| collider.with_groups(1 << group, touched(filter)));
    }
    None
}
