//! Pairs of colliders that are near each other: the broad phase's candidates, tested and sorted by
//! the kind of their shapes.

use rayon::prelude::*;
use tumble_collide::{BroadPhase, Proxy};

use crate::collision::collider::Groups;
use crate::collision::collider_state::{ColliderState, ColliderStates};
use crate::collision::narrow_phase::{LaneKind, Pairs};
use crate::collision::pair_limit::{PairLimit, most_listed};
use crate::joints::joint_list::JointList;
use crate::math::Real;
use crate::storage::body_index::Slot;
use crate::threads::InParts;

/// The pairs of a substep.
#[derive(Clone, Default)]
pub(crate) struct NearPairs {
    pub(crate) limit: PairLimit,
    /// In parts that threads find, before they are sorted.
    found: Vec<Vec<NearPair>>,
    pub(crate) cuboids: Pairs,
    pub(crate) spheres: Pairs,
    /// Of shapes without lanes of their own.
    pub(crate) others: Vec<[Slot; 2]>,
}

/// A pair with the kind of its shapes.
pub(crate) type NearPair = (LaneKind, [Slot; 2]);

/// Candidates that one thread takes at a time.
const PART: usize = 1024;

impl NearPairs {
    /// Finds the pairs that may touch, and sorts them by the kind of their shapes. Where only one
    /// of two is dynamic, it is the second.
    pub(crate) fn find(
        &mut self,
        ColliderStates { states, proxies, .. }: &ColliderStates,
        groups: &[Groups],
        broad_phase: &mut BroadPhase<Real>,
        joints: &JointList,
    ) {
        let Self { found, limit, cuboids, spheres, others } = self;
        let wanted =
            |a: u32, b: u32| groups[a as usize].touch(groups[b as usize]) && !joints.keeps_apart([Slot(a), Slot(b)]);
        let mut parts = 1;
        if let Some(candidates) = broad_phase.update_within(proxies, most_listed(proxies.len()), wanted) {
            parts = candidates.len().div_ceil(PART);
            found.resize_with(parts.max(found.len()), Vec::new);
            candidates.par_chunks(PART).zip(&mut *found).by_at_least(2).for_each(|(candidates, near)| {
                near.clear();
                near.extend(candidates.iter().filter_map(|&(first, second)| {
                    // Which others are candidates depends on what was before; the contacts must
                    // not.
                    let is_near = proxies[first as usize].is_near(&proxies[second as usize]);
                    is_near.then(|| near_pair(states, proxies, (first, second)))
                }));
            });
            limit.thin_out(&mut found[..parts], proxies);
        } else {
            found.resize_with(found.len().max(1), Vec::new);
            found[0].clear();
            let kept = limit.nearest_pairs(proxies, broad_phase, wanted);
            found[0].extend(kept.into_iter().map(|[a, b]| near_pair(states, proxies, (a, b))));
        }
        cuboids.clear();
        spheres.clear();
        others.clear();
        for &(kind, slots) in found[..parts].iter().flatten() {
            match kind {
                LaneKind::Cuboid => cuboids.push(slots),
                LaneKind::Sphere => spheres.push(slots),
                LaneKind::Other => others.push(slots),
            }
        }
    }
}

/// A pair with the kind of its shapes. Where only one of two is dynamic, it is the second.
fn near_pair(states: &[ColliderState], proxies: &[Proxy<Real>], (first, second): (u32, u32)) -> NearPair {
    let [p, q] = [&proxies[first as usize], &proxies[second as usize]];
    let slots = if p.moves && !q.moves { [second, first] } else { [first, second] };
    (LaneKind::both(states[first as usize].kind, states[second as usize].kind), slots.map(Slot))
}
