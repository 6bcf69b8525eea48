/// Indices of two objects, the lower first.
pub(super) type Pair = (u32, u32);

/// Pairs in order, of which some are found anew.
#[derive(Clone, Debug, Default)]
pub(super) struct PairList {
    pairs: Vec<Pair>,
    /// Those found anew, in any order.
    found: Vec<Pair>,
    /// Where to put what is sorted or merged.
    spare: Vec<Pair>,
    /// Of the pairs with a lower number than this one.
    counts: Vec<u32>,
}

impl PairList {
    pub(super) fn pairs(&self) -> &[Pair] {
        &self.pairs
    }

    pub(super) fn clear(&mut self) {
        self.pairs.clear();
    }

    /// Where pairs that are found are added. None may be in the list, but those that [`replace`](Self::replace) leaves out.
    pub(super) fn found(&mut self) -> &mut Vec<Pair> {
        &mut self.found
    }

    /// Adds the pairs found, of `count` objects, to those of the list that are `kept`.
    pub(super) fn replace(&mut self, count: usize, kept: impl Fn(Pair) -> bool) {
        self.sort_found(count);
        self.spare.clear();
        let mut found = self.found.drain(..).peekable();
        for pair in self.pairs.drain(..).filter(|pair| kept(*pair)) {
            while let Some(new) = found.next_if(|new| *new < pair) {
                self.spare.push(new);
            }
            self.spare.push(pair);
        }
        self.spare.extend(found);
        std::mem::swap(&mut self.pairs, &mut self.spare);
    }

    /// The pairs found are the list.
    pub(super) fn replace_all(&mut self, count: usize) {
        self.sort_found(count);
        self.pairs.clear();
        std::mem::swap(&mut self.pairs, &mut self.found);
    }

    fn sort_found(&mut self, count: usize) {
        if self.found.len() < count / 4 {
            self.found.sort_unstable();
            return;
        }
        // Of two passes that keep the order of what is equal, the last decides first.
        distribute(&self.found, &mut self.spare, &mut self.counts, count, |pair| pair.1);
        distribute(&self.spare, &mut self.found, &mut self.counts, count, |pair| pair.0);
    }
}

/// Puts the pairs in the order of a number of theirs below `count`, and those where it is the same in the order they come in.
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
    to.clear();
    to.resize(from.len(), (0, 0));
    for pair in from {
        let place = &mut counts[number(pair) as usize];
        to[*place as usize] = *pair;
        *place += 1;
    }
}
