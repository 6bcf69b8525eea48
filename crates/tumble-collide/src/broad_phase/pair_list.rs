//! The sorted list of overlapping pairs, updated by counting sort and merge.

use super::aabb8::{LANES, Marks};

/// Indices of two objects, the lower first.
pub(super) type Pair = (u32, u32);

/// A list is short if it is shorter than the other by this factor: runs of the other are then long
/// enough to be worth looking for.
const FEW: usize = 8;

/// Pairs that were found, in any order.
#[derive(Clone, Debug, Default)]
pub(super) struct Found {
    /// The pairs, and then room for more.
    pairs: Vec<Pair>,
    count: usize,
}

impl Found {
    /// Adds the pairs of the marked lanes.
    #[inline]
    pub(super) fn add(&mut self, marks: &Marks, pair: impl Fn(usize) -> Pair) {
        if let Some(room) = self.pairs[self.count..].first_chunk_mut() {
            self.count += marks.select(room, pair);
        } else {
            let more = self.pairs.len().max(LANES);
            self.pairs.resize(self.pairs.len() + more, (0, 0));
            self.add(marks, pair);
        }
    }

    pub(super) fn len(&self) -> usize {
        self.count
    }

    pub(super) fn pairs(&self) -> &[Pair] {
        &self.pairs[..self.count]
    }

    pub(super) fn clear(&mut self) {
        self.count = 0;
    }

    /// Leaves out those that are not wanted.
    pub(super) fn retain(&mut self, wanted: impl Fn(Pair) -> bool) {
        let mut kept = 0;
        for place in 0..self.count {
            let pair = self.pairs[place];
            self.pairs[kept] = pair;
            kept += usize::from(wanted(pair));
        }
        self.count = kept;
    }
}

/// Pairs in order, of which some are found again.
#[derive(Clone, Debug, Default)]
pub(super) struct PairList {
    pairs: Vec<Pair>,
    /// Those found again, and then the same in order.
    found: Found,
    sorted: Vec<Pair>,
    /// Where to put what is sorted or merged.
    spare: Vec<Pair>,
    /// Of the pairs with a lower number than this one.
    counts: Vec<u32>,
}

impl PairList {
    pub(super) fn pairs(&self) -> &[Pair] {
        &self.pairs
    }

    /// Forgets the pairs, and those found too.
    pub(super) fn clear(&mut self) {
        self.pairs.clear();
        self.found.clear();
    }

    /// Where pairs that are found are added. None may be in the list, but those that
    /// [`replace`](Self::replace) leaves out.
    pub(super) fn found(&mut self) -> &mut Found {
        &mut self.found
    }

    /// Adds the pairs found to those of the list of which neither object is `dirty`.
    pub(super) fn replace(&mut self, dirty: &[bool]) {
        let mut kept = 0;
        for place in 0..self.pairs.len() {
            let pair = self.pairs[place];
            self.pairs[kept] = pair;
            kept += usize::from(!(dirty[pair.0 as usize] | dirty[pair.1 as usize]));
        }
        self.pairs.truncate(kept);
        self.sort_found(dirty.len());
        merge(&self.pairs, &self.sorted, &mut self.spare);
        std::mem::swap(&mut self.pairs, &mut self.spare);
    }

    /// The pairs found are the list.
    pub(super) fn replace_all(&mut self, count: usize) {
        self.sort_found(count);
        std::mem::swap(&mut self.pairs, &mut self.sorted);
    }

    fn sort_found(&mut self, count: usize) {
        let found = &self.found.pairs[..self.found.count];
        self.found.count = 0;
        if found.len() < count / 4 {
            self.sorted.clear();
            self.sorted.extend_from_slice(found);
            self.sorted.sort_unstable();
            return;
        }
        // Of two passes that keep the order of what is equal, the last decides first.
        distribute(found, &mut self.spare, &mut self.counts, count, |pair| pair.1);
        distribute(&self.spare, &mut self.sorted, &mut self.counts, count, |pair| pair.0);
    }
}

/// Puts the pairs in the order of a number of theirs below `count`, and those where it is the same
/// in the order they come in.
fn distribute(from: &[Pair], to: &mut Vec<Pair>, counts: &mut Vec<u32>, count: usize, number: impl Fn(&Pair) -> u32) {
    counts.clear();
    counts.resize(count, 0);
    for pair in from {
        counts[number(pair) as usize] += 1;
    }
    let mut before = 0;
    for count in counts.iter_mut() {
        before += std::mem::replace(count, before);
    }
    to.resize(from.len(), (0, 0));
    for pair in from {
        let place = &mut counts[number(pair) as usize];
        to[*place as usize] = *pair;
        *place += 1;
    }
}

/// Makes one ordered list of two that have nothing in common.
pub(super) fn merge(many: &[Pair], few: &[Pair], to: &mut Vec<Pair>) {
    if few.len() > many.len() / FEW {
        interleave(many, few, to);
        return;
    }
    to.clear();
    let mut rest = many;
    for pair in few {
        let before = rest.iter().take_while(|other| *other < pair).count();
        let (first, others) = rest.split_at(before);
        to.extend_from_slice(first);
        to.push(*pair);
        rest = others;
    }
    to.extend_from_slice(rest);
}

/// Takes the lower of the first two, again and again, without a branch on which it is: there is no
/// guessing that.
fn interleave(a: &[Pair], b: &[Pair], to: &mut Vec<Pair>) {
    to.resize(a.len() + b.len(), (0, 0));
    let (mut i, mut j) = (0, 0);
    for place in to.iter_mut() {
        let (first, second) = (key(a.get(i)), key(b.get(j)));
        let from_first = first < second;
        *place = pair(if from_first { first } else { second });
        i += usize::from(from_first);
        j += usize::from(!from_first);
    }
}

/// A pair as one number, which is in the same order; more than any where there is none.
#[inline]
fn key(pair: Option<&Pair>) -> u64 {
    pair.map_or(u64::MAX, |pair| u64::from(pair.0) << 32 | u64::from(pair.1))
}

#[inline]
fn pair(key: u64) -> Pair {
    ((key >> 32) as u32, key as u32)
}
