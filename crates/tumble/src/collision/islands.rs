//! Islands: disjoint sets of dynamic bodies connected by contacts.

use crate::storage::body_index::Slot;

/// Bodies that contacts between moving ones connect: disjoint sets of slots.
#[derive(Clone, Debug, Default)]
pub(crate) struct Islands {
    /// A slot of the same island, lower than the slot itself or the same.
    parents: Vec<Slot>,
}

impl Islands {
    /// Joins the bodies of contacts, but not through non-dynamic bodies.
    pub(crate) fn join(
        &mut self,
        slots: usize,
        pairs: impl Iterator<Item = [Slot; 2]>,
        is_dynamic: impl Fn(Slot) -> bool,
    ) {
        self.parents.clear();
        self.parents.extend((0..slots as u32).map(Slot));
        for [a, b] in pairs.filter(|pair| pair.iter().all(|slot| is_dynamic(*slot))) {
            let (a, b) = (self.root(a), self.root(b));
            self.parents[a.max(b).index()] = a.min(b);
        }
    }

    /// The lowest slot of an island.
    pub(crate) fn root(&mut self, mut slot: Slot) -> Slot {
        while self.parents[slot.index()] != slot {
            let above = self.parents[self.parents[slot.index()].index()];
            self.parents[slot.index()] = above;
            slot = above;
        }
        slot
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn islands_are_joined_by_moving_bodies_only() {
        let mut islands = Islands::default();
        let pairs = [[0, 3], [3, 5], [6, 4], [1, 2], [2, 6]].map(|pair: [u32; 2]| pair.map(Slot));
        islands.join(7, pairs.into_iter(), |slot| slot != Slot(2));
        let roots: Vec<_> = (0..7).map(|slot| islands.root(Slot(slot)).0).collect();
        assert_eq!(roots, [0, 1, 2, 0, 4, 0, 4]);
        islands.join(0, std::iter::empty(), |_| true);
    }
}
