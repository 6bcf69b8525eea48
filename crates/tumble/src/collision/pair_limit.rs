//! Limits on the pairs of a body and on the contacts of a pair, so that many bodies or parts in one
//! place take memory that goes with their number and not with its square.

use tumble_collide::{BroadPhase, Proxy};

use crate::collision::contact::ContactRecord;
use crate::collision::near_pairs::NearPair;
use crate::math::Real;
use crate::storage::body_index::Slot;

/// A body with more pairs than this is in a crowd. Around a ball there is room for twelve that
/// touch it, and for some sixty within twice its own size.
const MAX_PAIRS: usize = 64;

/// Most pairs of a body, on average, that are listed: where there are more, as in one place, they
/// are gone through without a list.
const MAX_LISTED: usize = 2 * MAX_PAIRS;
/// Where there are fewer bodies, as many as of these.
const FEW_BODIES: usize = 1024;

/// Most contacts between two bodies, of pairs of their parts.
const MAX_CONTACTS: usize = 1024;

/// Contacts of pairs of bodies, as one thread finds them.
#[derive(Clone, Default)]
pub(crate) struct FoundContacts {
    pub(crate) contacts: Vec<ContactRecord>,
    pub(crate) left_out: usize,
}

impl FoundContacts {
    pub(crate) fn clear(&mut self) {
        self.contacts.clear();
        self.left_out = 0;
    }

    /// Adds a contact of the pair of which the first is at `start`.
    pub(crate) fn push(&mut self, contact: ContactRecord, start: usize) {
        self.contacts.push(contact);
        if self.contacts.len() - start >= 2 * MAX_CONTACTS {
            self.keep_deepest(start);
        }
    }

    /// Leaves out all but the deepest contacts of the pair of which the first is at `start`; of
    /// equal ones those of the first parts stay.
    pub(crate) fn keep_deepest(&mut self, start: usize) {
        let of_pair = &mut self.contacts[start..];
        if of_pair.len() > MAX_CONTACTS {
            let least =
                |it: &ContactRecord| (0..it.count()).fold(Real::INFINITY, |least, j| least.min(it.separation(j)));
            let order = |a: &ContactRecord, b: &ContactRecord| {
                least(a).total_cmp(&least(b)).then_with(|| a.key().cmp(&b.key()))
            };
            of_pair.select_nth_unstable_by(MAX_CONTACTS, order);
            self.left_out += of_pair.len() - MAX_CONTACTS;
            self.contacts.truncate(start + MAX_CONTACTS);
        }
    }
}

/// How many pairs of bodies the broad phase may list.
pub(crate) fn most_listed(bodies: usize) -> usize {
    MAX_LISTED * bodies.max(FEW_BODIES)
}

/// Scratch memory of the pair limit.
#[derive(Clone, Default)]
pub(crate) struct PairLimit {
    /// By slot, how many pairs it is in.
    counts: Vec<u32>,
    /// Of pairs between two that are in a crowd, once for each of them: whose, how far apart, and
    /// with whom.
    crowded: Vec<(u32, Real, u32)>,
    /// Those that are kept, the lower slot first.
    kept: Vec<[u32; 2]>,
    pub(crate) left_out: usize,
}

impl PairLimit {
    /// Leaves out pairs of crowds.
    pub(crate) fn thin_out(&mut self, near: &mut [Vec<NearPair>], proxies: &[Proxy<Real>]) {
        let Self { counts, crowded, kept, left_out } = self;
        *left_out = 0;
        if near.iter().map(Vec::len).sum::<usize>() <= MAX_PAIRS {
            return;
        }
        counts.clear();
        counts.resize(proxies.len(), 0);
        let all = || near.iter().flatten().map(|(_, slots)| slots.map(|slot| slot.0));
        all().flatten().for_each(|slot| counts[slot as usize] += 1);
        // What has no end is ground: it takes no part in a crowd.
        let in_crowd = |slot: u32| counts[slot as usize] as usize > MAX_PAIRS && proxies[slot as usize].aabb.is_some();
        let are_crowded = |[a, b]: [u32; 2]| in_crowd(a) && in_crowd(b);
        crowded.clear();
        for [a, b] in all().filter(|slots| are_crowded(*slots)) {
            let apart = apart(&proxies[a as usize], &proxies[b as usize]);
            crowded.extend([(a, apart, b), (b, apart, a)]);
        }
        if crowded.is_empty() {
            return;
        }
        crowded.sort_unstable_by(|x, y| x.0.cmp(&y.0).then(x.1.total_cmp(&y.1)).then(x.2.cmp(&y.2)));
        kept.clear();
        for of_one in crowded.chunk_by(|x, y| x.0 == y.0) {
            kept.extend(of_one.iter().take(MAX_PAIRS).map(|&(a, _, b)| [a.min(b), a.max(b)]));
        }
        kept.sort_unstable();
        for part in near {
            let before = part.len();
            part.retain(|&(_, [Slot(a), Slot(b)])| {
                !are_crowded([a, b]) || kept.binary_search(&[a.min(b), a.max(b)]).is_ok()
            });
            *left_out += before - part.len();
        }
        // A crowd is an accident, and what it took is not kept for it.
        *crowded = Vec::new();
        *kept = Vec::new();
    }
}

/// The nearest of one in a crowd, in order: how far apart, and with whom.
type Nearest = Vec<(Real, u32)>;

/// Takes one in where it is among the nearest.
fn offer(nearest: &mut Nearest, apart: Real, other: u32) {
    let place = nearest.partition_point(|known| known.0.total_cmp(&apart).then(known.1.cmp(&other)).is_lt());
    if place < MAX_PAIRS {
        nearest.truncate(MAX_PAIRS - 1);
        nearest.insert(place, (apart, other));
    }
}

/// How far the boxes of two are apart along the axis where they are furthest \[m\], negative where
/// they overlap.
fn apart(a: &Proxy<Real>, b: &Proxy<Real>) -> Real {
    let (Some(a), Some(b)) = (&a.aabb, &b.aabb) else { return Real::NEG_INFINITY };
    let [p, q] = [b.low - a.high, a.low - b.high];
    p.x.max(q.x).max(p.y.max(q.y)).max(p.z.max(q.z))
}

impl PairLimit {
    /// The pairs that [`thin_out`](PairLimit::thin_out) leaves where all are too many for a list:
    /// goes through them once to count and once to choose.
    pub(crate) fn nearest_pairs(
        &mut self,
        proxies: &[Proxy<Real>],
        broad_phase: &mut BroadPhase<Real>,
        wanted: impl Fn(u32, u32) -> bool,
    ) -> Vec<[u32; 2]> {
        let are_near = |a: u32, b: u32| proxies[a as usize].is_near(&proxies[b as usize]);
        let counts = &mut self.counts;
        counts.clear();
        counts.resize(proxies.len(), 0);
        let mut all = 0;
        broad_phase.for_each_pair(proxies, &wanted, |a, b| {
            if are_near(a, b) {
                [a, b].into_iter().for_each(|slot| counts[slot as usize] += 1);
                all += 1;
            }
        });
        let counts = &self.counts;
        let in_crowd = |slot: u32| counts[slot as usize] as usize > MAX_PAIRS && proxies[slot as usize].aabb.is_some();
        let mut nearest: Vec<Nearest> = vec![Nearest::new(); proxies.len()];
        let mut kept = Vec::new();
        broad_phase.for_each_pair(proxies, &wanted, |a, b| {
            if !are_near(a, b) {
                return;
            }
            if in_crowd(a) && in_crowd(b) {
                let apart = apart(&proxies[a as usize], &proxies[b as usize]);
                offer(&mut nearest[a as usize], apart, b);
                offer(&mut nearest[b as usize], apart, a);
            } else {
                kept.push([a, b]);
            }
        });
        for (slot, nearest) in (0..).zip(&nearest) {
            kept.extend(nearest.iter().map(|&(_, other)| [slot.min(other), slot.max(other)]));
        }
        kept.sort_unstable();
        kept.dedup();
        self.left_out = all - kept.len();
        kept
    }
}
