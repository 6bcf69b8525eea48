//! What rests on what, from the top down.

use std::ops::Range;

use crate::storage::body_index::Slot;

/// Slots that rest on others, each after all that rest on it.
#[derive(Clone, Default)]
pub(super) struct LoadOrder {
    /// The upper and the lower slot of each contact; no slots where it bears nothing.
    pairs: Vec<[Slot; 2]>,
    /// Where the supports of each slot begin among `by_upper`.
    begins: Vec<u32>,
    /// The number of a contact, and the lower slot.
    by_upper: Vec<(u32, Slot)>,
    /// By slot: how many contacts hand it loads that have not done so.
    waiting: Vec<u32>,
    /// Slots that rest on something.
    order: Vec<Slot>,
    /// How many of these come before any that bear each other in a ring, and all below them.
    before_rings: usize,
}

impl LoadOrder {
    /// Orders contacts by the upper slot, keeping their order, and slots from the top down; all is
    /// kept where the pairs are those of the call before.
    pub(super) fn sort(&mut self, pairs: impl Iterator<Item = [Slot; 2]> + Clone, slots: usize) {
        if self.begins.len() == slots + 2 && pairs.clone().eq(self.pairs.iter().copied()) {
            return;
        }
        self.pairs.clear();
        self.pairs.extend(pairs);
        self.sort_by_upper(slots);
        let Self { begins, by_upper, waiting, order, before_rings, .. } = self;
        let supports_of = |slot: Slot| &by_upper[range_of(begins, slot)];
        waiting.clear();
        waiting.resize(slots, 0);
        by_upper.iter().for_each(|(_, lower)| waiting[lower.index()] += 1);
        let bears_on = |slot: Slot| !range_of(begins, slot).is_empty();
        order.clear();
        order.extend((0..slots as u32).map(Slot).filter(|slot| bears_on(*slot) && waiting[slot.index()] == 0));
        *before_rings = usize::MAX;
        let (mut next, mut first_left) = (0, 0);
        loop {
            // Of bodies that bear each other in a ring the one with the lowest slot begins.
            if next == order.len() {
                *before_rings = next.min(*before_rings);
                let mut left = (first_left..slots as u32).map(Slot);
                let Some(slot) = left.find(|slot| bears_on(*slot) && waiting[slot.index()] > 0) else { break };
                (waiting[slot.index()], first_left) = (0, slot.0 + 1);
                order.push(slot);
            }
            let slot = order[next];
            next += 1;
            for (_, lower) in supports_of(slot) {
                let waiting = &mut waiting[lower.index()];
                if *waiting == 1 && bears_on(*lower) {
                    order.push(*lower);
                }
                *waiting = waiting.saturating_sub(1);
            }
        }
    }

    /// The slots that rest on something, from the top down.
    pub(super) fn slots(&self) -> &[Slot] {
        &self.order
    }

    /// Those of which all that rest on them come before.
    pub(super) fn slots_before_rings(&self) -> &[Slot] {
        &self.order[..self.before_rings.min(self.order.len())]
    }

    /// The numbers of the contacts that bear a slot, and the slots below.
    pub(super) fn supports_of(&self, slot: Slot) -> &[(u32, Slot)] {
        &self.by_upper[range_of(&self.begins, slot)]
    }

    /// By contact, the upper and the lower slot.
    pub(super) fn pairs(&self) -> &[[Slot; 2]] {
        &self.pairs
    }

    fn sort_by_upper(&mut self, slots: usize) {
        let Self { pairs, begins, by_upper, .. } = self;
        let pairs = || {
            let all = pairs.iter().enumerate().filter(|(_, [upper, _])| *upper != Slot::NONE);
            all.map(|(index, [upper, lower])| (upper.index(), (index as u32, *lower)))
        };
        begins.clear();
        begins.resize(slots + 2, 0);
        let mut count = 0;
        for (upper, _) in pairs() {
            begins[upper + 2] += 1;
            count += 1;
        }
        for slot in 2..begins.len() {
            begins[slot] += begins[slot - 1];
        }
        by_upper.clear();
        by_upper.resize(count, (0, Slot(0)));
        for (upper, support) in pairs() {
            let place = &mut begins[upper + 1];
            by_upper[*place as usize] = support;
            *place += 1;
        }
    }
}

/// Where the supports of a slot are among those ordered by the upper body.
fn range_of(begins: &[u32], slot: Slot) -> Range<usize> {
    begins[slot.index()] as usize..begins[slot.index() + 1] as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sorted(pairs: &[[u32; 2]], slots: usize) -> LoadOrder {
        let mut order = LoadOrder::default();
        order.sort(pairs.iter().map(|pair| pair.map(Slot)), slots);
        order
    }

    #[test]
    fn slots_come_after_all_that_rest_on_them() {
        // 4 on 2 and 3, these on 1, and 1 on 0, which rests on nothing.
        let order = sorted(&[[1, 0], [2, 1], [4, 2], [3, 1], [4, 3]], 5);
        assert_eq!(order.slots(), [4, 2, 3, 1].map(Slot));
        assert_eq!(order.slots_before_rings(), order.slots());
        assert_eq!(order.supports_of(Slot(4)), [(2, Slot(2)), (4, Slot(3))]);
        assert!(order.supports_of(Slot(0)).is_empty());
    }

    #[test]
    fn what_is_in_a_ring_and_below_it_comes_last() {
        // 5 on 4; 3, 2 and 1 in a ring, of which 1 rests on 0 as well.
        let order = sorted(&[[5, 4], [3, 2], [2, 1], [1, 3], [1, 0]], 6);
        assert_eq!(order.slots(), [5, 1, 3, 2].map(Slot));
        assert_eq!(order.slots_before_rings(), [Slot(5)]);
    }
}
