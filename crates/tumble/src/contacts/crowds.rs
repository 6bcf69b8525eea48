//! A limit on the pairs of a body, so that many bodies in one place take time and memory that go with their number and not with its square.

use tumble_collide::Proxy;

use super::narrow::Kind;
use super::touching::Contacts;
use crate::math::Real;
use crate::simulation::Simulation;

/// A body with more pairs than this is in a crowd. Around a ball there is room for twelve that touch it, and for some sixty within twice its own size.
const MOST_PAIRS: usize = 64;

/// What the limit is found out with.
#[derive(Clone, Default)]
pub(super) struct Crowds {
    /// By slot, how many pairs it is in.
    counts: Vec<u32>,
    /// Of pairs between two that are in a crowd, once for each of them: whose, how far apart, and with whom.
    crowded: Vec<(u32, Real, u32)>,
    /// Those that are kept, the lower slot first.
    kept: Vec<[u32; 2]>,
    left_out: usize,
}

impl Simulation {
    /// How many pairs of bodies that are near each other were left out of the last step, or of its last substep: usually none.
    ///
    /// A body that is near more than 64 others is in a crowd. Between two in a crowd a pair counts if it is one of the 64 of either that overlap deepest or are nearest, by the boxes around them; of equal
    /// ones those with the body that comes first in the order of [`BodyOrder`](crate::BodyOrder). So what is large may touch any number of small ones, and ground without end all there is.
    ///
    /// ```
    /// use tumble::{Collider, prelude::*};
    ///
    /// let mut world = hecs::World::new();
    /// let shape = Shape::sphere(0.5);
    /// for _ in 0..200 {
    ///     let collider = Collider::new(&shape)?;
    ///     RigidBody::new(shape.clone()).mass(1.0).build()?.spawn_with(&mut world, (collider,));
    /// }
    /// let mut simulation = Simulation::new(Settings::default())?;
    /// simulation.step(&mut world);
    /// assert!(simulation.contacts().count() <= 200 * 64);
    /// assert_eq!(simulation.contacts().count() + simulation.pairs_left_out(), 200 * 199 / 2);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn pairs_left_out(&self) -> usize {
        self.touching().map_or(0, |contacts| contacts.crowds.left_out)
    }
}

impl Crowds {
    /// Leaves out pairs of crowds.
    pub(super) fn thin_out(&mut self, near: &mut [Vec<(Kind, [u32; 2])>], proxies: &[Proxy<Real>]) {
        let Self { counts, crowded, kept, left_out } = self;
        *left_out = 0;
        if near.iter().map(Vec::len).sum::<usize>() <= MOST_PAIRS {
            return;
        }
        counts.clear();
        counts.resize(proxies.len(), 0);
        let all = || near.iter().flatten().map(|(_, slots)| *slots);
        all().flatten().for_each(|slot| counts[slot as usize] += 1);
        // What has no end is ground: it takes no part in a crowd.
        let in_crowd =
            |slot: u32| counts[slot as usize] as usize > MOST_PAIRS && proxies[slot as usize].bounds.is_some();
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
            kept.extend(of_one.iter().take(MOST_PAIRS).map(|&(a, _, b)| [a.min(b), a.max(b)]));
        }
        kept.sort_unstable();
        for part in near {
            let before = part.len();
            part.retain(|&(_, [a, b])| !are_crowded([a, b]) || kept.binary_search(&[a.min(b), a.max(b)]).is_ok());
            *left_out += before - part.len();
        }
        // A crowd is an accident, and what it took is not kept for it.
        *crowded = Vec::new();
        *kept = Vec::new();
    }
}

/// How far the boxes of two are apart along the axis where they are furthest \[m\], negative where they overlap.
fn apart(a: &Proxy<Real>, b: &Proxy<Real>) -> Real {
    let (Some(a), Some(b)) = (&a.bounds, &b.bounds) else { return Real::NEG_INFINITY };
    let [p, q] = [b.low - a.high, a.low - b.high];
    p.x.max(q.x).max(p.y.max(q.y)).max(p.z.max(q.z))
}

impl Contacts {
    /// Leaves out what is too much of the pairs that were found near each other, in so many parts.
    pub(super) fn limit_near(&mut self, parts: usize) {
        let Self { crowds, near, proxies, .. } = self;
        crowds.thin_out(&mut near[..parts], proxies);
    }
}
