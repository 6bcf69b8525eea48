//! Collision filters as the groups of the engine's colliders, and triggers as sensors with theirs.

use std::collections::HashMap;
use std::sync::Arc;

use tumble::Collider;

use crate::bodies::imported_body::ImportedBody;
use crate::bodies::imported_collider::{ColliderRole, ImportedCollider};
use crate::gltf::CollisionFilter;
use crate::gltf::collider::{of_piece, of_pieces};

/// As many filters as the engine's groups have bits.
const MAX_FILTERS: usize = u32::BITS as usize;

/// Groups of the filters of a file: each different one is a group of its own, which touches the
/// groups whose filters and it agree on. So names of systems, of which a collider may have several,
/// mean what they do in the file.
#[derive(Default)]
struct FilterGroups {
    filters: Vec<Arc<CollisionFilter>>,
    // Most colliders have a filter of the file's, which is compared to the others once.
    known: HashMap<*const CollisionFilter, usize>,
}

impl FilterGroups {
    /// `None` where there are more filters than groups.
    fn of<'a>(pieces: impl Iterator<Item = &'a ImportedCollider>) -> Option<Self> {
        let Self { mut filters, mut known } = Self::default();
        for piece in pieces {
            let filter = piece.filter.clone().unwrap_or_default();
            let find = || filters.iter().position(|known| *known == filter).unwrap_or(filters.len());
            if *known.entry(address(piece)).or_insert_with(find) == filters.len() {
                if filters.len() == MAX_FILTERS {
                    return None;
                }
                filters.push(filter);
            }
        }
        let all_agree = filters.iter().all(|filter| filters.iter().all(|other| filter.collides_with(other)));
        Some(if all_agree { Self::default() } else { Self { filters, known } })
    }

    /// Membership and filter of a piece; `None` where all touch all.
    fn of_piece(&self, piece: &ImportedCollider) -> Option<(u32, u32)> {
        let group = *self.known.get(&address(piece))?;
        let filter = self.filters.get(group)?;
        let agree = self.filters.iter().map(|other| u32::from(filter.collides_with(other)));
        Some((1 << group, agree.enumerate().fold(0, |bits, (group, agree)| bits | agree << group)))
    }
}

fn address(piece: &ImportedCollider) -> *const CollisionFilter {
    piece.filter.as_ref().map_or(std::ptr::null(), Arc::as_ptr)
}

/// Gives each collider the groups of its filter, and bodies with triggers sensors; what is
/// impossible is reported.
pub(crate) fn assign<'a>(bodies: impl Iterator<Item = &'a mut ImportedBody>) -> Option<String> {
    let mut bodies: Vec<&mut ImportedBody> = bodies
        .filter(|body| body.collider.is_some() || of_role(body, ColliderRole::Trigger).next().is_some())
        .collect();
    let touching = bodies.iter().flat_map(|body| {
        let of_piece = |piece: &&ImportedCollider| body.collider.is_some() || piece.role == ColliderRole::Trigger;
        body.pieces.iter().filter(of_piece)
    });
    let groups = FilterGroups::of(touching);
    let too_many = groups.is_none();
    let groups = groups.unwrap_or_default();
    for body in &mut bodies {
        let solid: Vec<&ImportedCollider> = of_role(body, ColliderRole::Solid).collect();
        let mut collider = body.collider.clone();
        if let Some((membership, filter)) = solid.first().and_then(|piece| groups.of_piece(piece)) {
            let several = solid.windows(2).any(|pair| pair[0].filter != pair[1].filter);
            let of_parts = if several { of_pieces(&solid, |piece| groups.of_piece(piece)).ok() } else { None };
            collider = of_parts.or(collider.map(|it| it.with_groups(membership, filter)));
        }
        let triggers: Vec<&ImportedCollider> = of_role(body, ColliderRole::Trigger).collect();
        body.collider = with_sensors(collider, &triggers, |piece| groups.of_piece(piece));
    }
    too_many.then(|| format!("more than {MAX_FILTERS} different collision filters: they count for nothing"))
}

fn of_role(body: &ImportedBody, role: ColliderRole) -> impl Iterator<Item = &ImportedCollider> {
    body.pieces.iter().filter(move |piece| piece.role == role)
}

/// A collider with the triggers of its body as sensors.
fn with_sensors(
    solid: Option<Collider>,
    triggers: &[&ImportedCollider],
    groups: impl Fn(&ImportedCollider) -> Option<(u32, u32)>,
) -> Option<Collider> {
    let sensors: Vec<Collider> =
        triggers.iter().filter_map(|piece| Some(of_piece(piece, groups(piece))?.ok()?.sensor())).collect();
    if sensors.is_empty() {
        return solid;
    }
    Collider::compound(solid.clone().into_iter().chain(sensors)).ok().or(solid)
}
