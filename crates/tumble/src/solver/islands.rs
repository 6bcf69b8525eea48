//! Islands: disjoint sets of dynamic bodies connected by contacts.

/// Bodies that contacts between moving ones connect: disjoint sets of slots.
#[derive(Clone, Default)]
pub(crate) struct Islands {
    /// A slot of the same island, lower than the slot itself or the same.
    parents: Vec<u32>,
}

impl Islands {
    /// Joins the bodies of contacts, but not through those that impulses do not move.
    pub(crate) fn join(&mut self, slots: usize, pairs: impl Iterator<Item = [u32; 2]>, moves: impl Fn(u32) -> bool) {
        self.parents.clear();
        self.parents.extend(0..slots as u32);
        for [a, b] in pairs.filter(|pair| pair.iter().all(|slot| moves(*slot))) {
            let (a, b) = (self.root(a), self.root(b));
            self.parents[a.max(b) as usize] = a.min(b);
        }
    }

    /// The lowest slot of an island.
    pub(crate) fn root(&mut self, mut slot: u32) -> u32 {
        while self.parents[slot as usize] != slot {
            let above = self.parents[self.parents[slot as usize] as usize];
            self.parents[slot as usize] = above;
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
        islands.join(7, [[0, 3], [3, 5], [6, 4], [1, 2], [2, 6]].into_iter(), |slot| slot != 2);
        let roots: Vec<_> = (0..7).map(|slot| islands.root(slot)).collect();
        assert_eq!(roots, [0, 1, 2, 0, 4, 0, 4]);
        islands.join(0, std::iter::empty(), |_| true);
    }
}
