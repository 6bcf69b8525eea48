//! Broad phase: incremental search for overlapping pairs with fat AABBs and two BVHs.

pub(crate) mod aabb8;
pub(crate) mod bvh;
pub(crate) mod bvh_build;
mod fat_aabb;
mod pair_list;
mod proxy;

pub use proxy::Proxy;

use bvh::Bvh8;
use bvh_build::NONE;
use fat_aabb::FatAabbs;
use pair_list::{Pair, PairList, merge};

use crate::aabb::Aabb;
use crate::scalar::Scalar;

/// The tree is rebuilt when its leaves have become longer than when it was made by this factor.
/// Between 1.15 and 1.3 the number makes no difference to speak of; at 1.05 the tree is rebuilt too
/// often, and a tree that is never rebuilt takes half as long again where balls mix.
const MAX_LOOSENESS: f64 = 1.2;

/// Where more than one leaf in this number is dirty, all get other boxes: they then leave them
/// together, and rarely.
const MANY: usize = 8;

/// Finds which of many objects are near each other, in time that grows as their number does.
///
/// Every object is in a box that is somewhat larger than itself. As long as nothing leaves its box
/// the pairs are those of the last time, and to see that is all it costs. What leaves gets another
/// box, and its neighbours are looked for in a tree.
///
/// ```
/// use tumble_collide::{Aabb, BroadPhase, Proxy};
/// use tumble_math::lane::Vec3;
///
/// let unit = |x: f64| Some(Aabb::about(Vec3::new(x, 0.0, 0.0), Vec3::splat(0.5)));
/// let proxies =
///     [unit(3.2), unit(0.0), unit(2.5), unit(0.9)].map(|aabb| Proxy { aabb, moves: true });
/// let mut broad_phase = BroadPhase::default();
/// assert_eq!(broad_phase.update(&proxies, |_, _| true), [(0, 2), (1, 3)]);
/// ```
#[derive(Clone, Debug, Default)]
pub struct BroadPhase<R> {
    kinds: Vec<Kind>,
    fat_aabb: FatAabbs<R>,
    /// Of each object, its leaf in the tree of what moves; [`NONE`] for what is in the other one,
    /// or in none.
    leaves: Vec<u32>,
    moving: Bvh8<R>,
    /// What has never left its box since the beginning and is not moved by anything.
    still: Bvh8<R>,
    most_looseness: R,
    /// The objects that are no longer in their boxes.
    left: Vec<u32>,
    /// Of each leaf, whether one of its objects has left.
    dirty: Vec<bool>,
    /// The same of each object: whether it is in such a leaf.
    dirty_objects: Vec<bool>,
    near: PairList,
    /// Pairs of what has no end with what has one.
    endless: Vec<Pair>,
    /// All pairs, where there is something without an end.
    all: Vec<Pair>,
    stack: Vec<(u32, u32)>,
    met: Vec<u32>,
}

/// What it takes to be another object altogether.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Kind {
    endless: bool,
    moves: bool,
}

impl Kind {
    fn of<R>(proxy: &Proxy<R>) -> Self {
        Self { endless: proxy.aabb.is_none(), moves: proxy.moves }
    }
}

/// How much is looked for.
#[derive(Clone, Copy, PartialEq)]
enum Search {
    /// The neighbours of what is in dirty leaves.
    Dirty,
    /// All pairs.
    All,
}

impl<R: Scalar> BroadPhase<R> {
    /// The indices of those objects that may touch, the lower first, in order: all that
    /// [are near](Proxy::is_near) each other and `wanted`, and some more that are wanted and nearly
    /// so.
    ///
    /// Which are more depends on where the objects were before. What must not depend on that asks
    /// each pair whether it [is near](Proxy::is_near). Whether a pair is `wanted` is asked when it
    /// is found and then taken as known: call [`reset`](Self::reset) when the answers are others.
    /// Objects may move, or be replaced by others of the same index, as they like.
    pub fn update(&mut self, proxies: &[Proxy<R>], wanted: impl Fn(u32, u32) -> bool) -> &[(u32, u32)] {
        self.update_within(proxies, usize::MAX, wanted).unwrap_or_default()
    }

    /// The same, unless more than `most` pairs of objects that have an end are found: then there is
    /// no list, and nothing is known any longer. So a crowd takes no memory with the square of its
    /// number; [`for_each_pair`](Self::for_each_pair) goes through its pairs.
    ///
    /// ```
    /// # use tumble_collide::{Aabb, BroadPhase, Proxy};
    /// # use tumble_math::lane::Vec3;
    /// let unit = Proxy { aabb: Some(Aabb::about(Vec3::zero(), Vec3::splat(0.5))), moves: true };
    /// let mut broad_phase = BroadPhase::<f64>::default();
    /// assert_eq!(broad_phase.update_within(&[unit; 100], 1000, |_, _| true), None);
    /// let mut count = 0;
    /// broad_phase.for_each_pair(&[unit; 100], |_, _| true, |_, _| count += 1);
    /// assert_eq!(count, 4950);
    /// ```
    pub fn update_within(
        &mut self,
        proxies: &[Proxy<R>],
        most: usize,
        wanted: impl Fn(u32, u32) -> bool,
    ) -> Option<&[(u32, u32)]> {
        self.fat_aabb.advance();
        let known = self.kinds.len() == proxies.len();
        if !known || !self.kinds.iter().zip(proxies).all(|(kind, proxy)| *kind == Kind::of(proxy)) {
            self.begin(proxies, &wanted);
            let is_complete = self.search(Search::All, most, &wanted);
            return self.kept(is_complete);
        }
        self.left.clear();
        self.fat_aabb.find_left(proxies, &mut self.left);
        let is_complete = if self.left.is_empty() {
            self.near.pairs().len() <= most
        } else {
            let search = self.follow(proxies);
            self.search(search, most, &wanted)
        };
        self.kept(is_complete)
    }

    /// The pairs, or none, and then nothing is known.
    fn kept(&mut self, is_complete: bool) -> Option<&[(u32, u32)]> {
        if !is_complete {
            self.reset();
        }
        is_complete.then(|| self.pairs())
    }

    /// Calls `then` with the pairs that [`update`](Self::update) would list, in any order, and
    /// keeps nothing of them.
    pub fn for_each_pair(
        &mut self,
        proxies: &[Proxy<R>],
        wanted: impl Fn(u32, u32) -> bool,
        mut then: impl FnMut(u32, u32),
    ) {
        self.fat_aabb.advance();
        self.begin(proxies, &wanted);
        for leaf in 0..self.moving.leaves() {
            self.search_leaf(leaf, Search::All);
            let Self { kinds, near, .. } = self;
            near.found().retain(|pair| is_wanted(kinds, pair, &wanted));
            near.found().pairs().iter().for_each(|pair| then(pair.0, pair.1));
            near.found().clear();
        }
        self.endless.iter().for_each(|pair| then(pair.0, pair.1));
        self.reset();
    }

    /// Shows the objects with an end of which the box that they were given in the last search meets
    /// another; that box holds theirs. Those without an end, and those nowhere, are not shown.
    ///
    /// ```
    /// use tumble_collide::{Aabb, BroadPhase, Proxy};
    /// use tumble_math::lane::Vec3;
    ///
    /// let unit = |x: f64| Aabb::about(Vec3::new(x, 0.0, 0.0), Vec3::splat(0.5));
    /// let proxies = [3.0, 0.0, 9.0].map(|x| Proxy { aabb: Some(unit(x)), moves: x > 0.0 });
    /// let mut broad_phase = BroadPhase::default();
    /// broad_phase.update(&proxies, |_, _| true);
    /// let mut met = Vec::new();
    /// broad_phase
    ///     .meeting(&Aabb::about(Vec3::zero(), Vec3::splat(4.0)), &mut |object| met.push(object));
    /// met.sort_unstable();
    /// assert_eq!(met, [0, 1]);
    /// ```
    pub fn meeting(&self, aabb: &Aabb<R>, visit: &mut impl FnMut(u32)) {
        self.moving.meeting(aabb, visit);
        self.still.meeting(aabb, visit);
    }

    /// What [`update`](Self::update) found the last time.
    pub fn pairs(&self) -> &[(u32, u32)] {
        if self.endless.is_empty() { self.near.pairs() } else { &self.all }
    }

    /// Forgets everything.
    pub fn reset(&mut self) {
        self.kinds.clear();
        self.near.clear();
        self.endless.clear();
        self.all.clear();
    }

    /// Takes in objects of which nothing is known.
    fn begin(&mut self, proxies: &[Proxy<R>], wanted: &impl Fn(u32, u32) -> bool) {
        self.kinds.clear();
        self.kinds.extend(proxies.iter().map(Kind::of));
        self.fat_aabb.begin(proxies);
        self.leaves.clear();
        self.leaves.extend(self.kinds.iter().map(|kind| if kind.moves && !kind.endless { 0 } else { NONE }));
        self.build_still();
        self.build_moving();
        self.pair_endless(wanted);
    }

    fn pair_endless(&mut self, wanted: &impl Fn(u32, u32) -> bool) {
        self.endless.clear();
        for (ground, kind) in (0..).zip(&self.kinds).filter(|(_, kind)| kind.endless) {
            for (object, other) in (0..).zip(&self.kinds).filter(|(_, other)| !other.endless) {
                let pair = (object.min(ground), object.max(ground));
                if (kind.moves || other.moves) && wanted(pair.0, pair.1) {
                    self.endless.push(pair);
                }
            }
        }
        self.endless.sort_unstable();
    }

    fn build_still(&mut self) {
        let objects = (0..).zip(self.kinds.iter().zip(&self.leaves));
        let still = objects.filter(|(_, (kind, leaf))| !kind.endless && **leaf == NONE).map(|(object, _)| object);
        self.still.build(still, self.fat_aabb.boxes());
    }

    fn build_moving(&mut self) {
        let objects = (0..).zip(&self.leaves).filter(|(_, leaf)| **leaf != NONE).map(|(object, _)| object);
        self.moving.build(objects, self.fat_aabb.boxes());
        for leaf in 0..self.moving.leaves() {
            for object in self.moving.objects(leaf).iter().filter(|object| **object != NONE) {
                self.leaves[*object as usize] = leaf as u32;
            }
        }
        self.most_looseness = self.moving.looseness() * R::splat(MAX_LOOSENESS);
    }

    /// Gives another box to those that left theirs, and to some that will soon; says whose
    /// neighbours are to be looked for.
    fn follow(&mut self, proxies: &[Proxy<R>]) -> Search {
        if self.left.iter().any(|object| self.leaves[*object as usize] == NONE) {
            // From now on they are among those that move.
            self.left.iter().for_each(|object| self.leaves[*object as usize] = 0);
            self.build_still();
            return self.renew(proxies);
        }
        let leaves = self.moving.leaves();
        self.dirty.clear();
        self.dirty.resize(leaves, false);
        self.left.iter().for_each(|object| self.dirty[self.leaves[*object as usize] as usize] = true);
        let all = self.dirty.iter().filter(|dirty| **dirty).count() * MANY > leaves;
        if all {
            self.renew_boxes(proxies);
            (0..leaves).for_each(|leaf| self.moving.load(leaf, self.fat_aabb.boxes()));
        } else {
            self.renew_dirty(proxies);
        }
        self.moving.refit();
        if self.moving.looseness() > self.most_looseness {
            return self.renew(proxies);
        }
        if all { Search::All } else { Search::Dirty }
    }

    /// Gives another box to all in dirty leaves.
    fn renew_dirty(&mut self, proxies: &[Proxy<R>]) {
        self.dirty_objects.clear();
        self.dirty_objects.resize(proxies.len(), false);
        for leaf in (0..self.dirty.len()).filter(|leaf| self.dirty[*leaf]) {
            for object in self.moving.objects(leaf).iter().filter(|object| **object != NONE) {
                self.fat_aabb.renew(*object, &proxies[*object as usize]);
                self.dirty_objects[*object as usize] = true;
            }
            self.moving.load(leaf, self.fat_aabb.boxes());
        }
    }

    /// Gives another box to all that move, and rearranges them.
    fn renew(&mut self, proxies: &[Proxy<R>]) -> Search {
        self.renew_boxes(proxies);
        self.build_moving();
        Search::All
    }

    fn renew_boxes(&mut self, proxies: &[Proxy<R>]) {
        for (object, (leaf, proxy)) in (0..).zip(self.leaves.iter().zip(proxies)) {
            if *leaf != NONE {
                self.fat_aabb.renew(object, proxy);
            }
        }
    }

    /// Whether there are no more than `most` pairs of objects with an end.
    fn search(&mut self, search: Search, most: usize, wanted: &impl Fn(u32, u32) -> bool) -> bool {
        let all = search == Search::All;
        let mut check_at = most;
        for leaf in 0..self.moving.leaves() {
            if !all && !self.dirty[leaf] {
                continue;
            }
            self.search_leaf(leaf, search);
            if self.near.found().len() > check_at {
                let Self { kinds, near, .. } = self;
                near.found().retain(|pair| is_wanted(kinds, pair, wanted));
                if near.found().len() > most {
                    return false;
                }
                // Each time at least as many are found as are gone through again.
                check_at = most.saturating_add(near.found().len());
            }
        }
        let Self { kinds, near, .. } = self;
        near.found().retain(|pair| is_wanted(kinds, pair, wanted));
        if all {
            near.replace_all(kinds.len());
        } else {
            near.replace(&self.dirty_objects);
        }
        self.merge_endless();
        self.near.pairs().len() <= most
    }

    /// Adds the pairs of a leaf's objects to those found.
    fn search_leaf(&mut self, leaf: usize, search: Search) {
        let Self { moving, still, dirty, near, stack, met, .. } = self;
        let (found, all) = (near.found(), search == Search::All);
        let around = moving.leaf(leaf).union();
        met.clear();
        moving.find(&around, if all { leaf } else { 0 }, stack, met);
        for other in met.iter().map(|other| *other as usize) {
            // Of two leaves that both look for each other the first one does.
            if other == leaf {
                moving.pairs_within(leaf, found);
            } else if all || other > leaf || !dirty[other] {
                moving.pairs_between((leaf, &around), (moving, other), found);
            }
        }
        met.clear();
        still.find(&around, 0, stack, met);
        for other in &*met {
            moving.pairs_between((leaf, &around), (still, *other as usize), found);
        }
    }

    fn merge_endless(&mut self) {
        if self.endless.is_empty() {
            return;
        }
        merge(self.near.pairs(), &self.endless, &mut self.all);
    }
}

/// Whether one of two objects can be moved, and the caller wants the pair.
fn is_wanted(kinds: &[Kind], (first, second): Pair, wanted: &impl Fn(u32, u32) -> bool) -> bool {
    (kinds[first as usize].moves || kinds[second as usize].moves) && wanted(first, second)
}
