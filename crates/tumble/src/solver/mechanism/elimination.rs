//! In which order the nodes of a sparse symmetric matrix are eliminated, and what that fills in.

use std::collections::BTreeSet;

/// The order, and the blocks beyond the diagonal in rows of this order.
#[derive(Clone, Debug, Default)]
pub(crate) struct Elimination {
    /// The nodes in the order in which they are eliminated.
    pub(crate) order: Vec<u32>,
    /// By place in the order, where its blocks begin; and where the last ones end.
    pub(crate) begins: Vec<u32>,
    /// The column of each block, as a place in the order; ascending in each row.
    pub(crate) columns: Vec<u32>,
}

impl Elimination {
    /// By minimum degree, ties by the lower number. Nodes are neighbours where they have one of
    /// these groups in common; a node may be in several groups. `None` where it does not go on
    /// after a node and those of its neighbours that are left.
    pub(crate) fn by_minimum_degree(
        nodes: usize,
        groups: &[Vec<u32>],
        mut goes_on: impl FnMut(u32, &[u32]) -> bool,
    ) -> Option<Self> {
        let mut neighbors = vec![BTreeSet::new(); nodes];
        for group in groups {
            for &node in group {
                neighbors[node as usize].extend(group.iter().copied().filter(|other| *other != node));
            }
        }
        let mut queue: BTreeSet<_> = (0..).zip(&neighbors).map(|(node, of_it)| (of_it.len(), node)).collect();
        let (mut order, mut places) = (Vec::with_capacity(nodes), vec![0; nodes]);
        let mut later = Vec::with_capacity(nodes);
        while let Some((_, node)) = queue.pop_first() {
            places[node as usize] = order.len() as u32;
            order.push(node);
            let of_it: Vec<u32> = std::mem::take(&mut neighbors[node as usize]).into_iter().collect();
            if !goes_on(node, &of_it) {
                return None;
            }
            for &other in &of_it {
                let of_other = &mut neighbors[other as usize];
                queue.remove(&(of_other.len(), other));
                of_other.remove(&node);
                of_other.extend(of_it.iter().copied().filter(|third| *third != other));
                queue.insert((of_other.len(), other));
            }
            later.push(of_it);
        }
        let (mut begins, mut columns) = (vec![0], Vec::new());
        for of_it in later {
            let begin = columns.len();
            columns.extend(of_it.iter().map(|node: &u32| places[*node as usize]));
            columns[begin..].sort_unstable();
            begins.push(columns.len() as u32);
        }
        Some(Self { order, begins, columns })
    }

    /// The blocks of a row.
    pub(crate) fn blocks_of(&self, row: usize) -> std::ops::Range<usize> {
        self.begins[row] as usize..self.begins[row + 1] as usize
    }

    /// The block in a row and column.
    pub(crate) fn block_at(&self, row: usize, column: u32) -> Option<usize> {
        let blocks = self.blocks_of(row);
        self.columns[blocks.clone()].binary_search(&column).ok().map(|i| blocks.start + i)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chain_fills_in_nothing_and_a_star_one_block_a_leaf() {
        let chain: Vec<_> = (0..9).map(|node| vec![node, node + 1]).collect();
        let elimination = Elimination::by_minimum_degree(10, &chain, |_, _| true).unwrap();
        assert_eq!(elimination.columns.len(), 9);
        // Leaves that share one body with a hub, and nothing with each other.
        let star: Vec<_> = (1..8).map(|leaf| vec![0, leaf]).collect();
        let elimination = Elimination::by_minimum_degree(8, &star, |_, _| true).unwrap();
        assert_eq!(elimination.columns.len(), 7);
        assert_eq!(elimination.order[..6], [1, 2, 3, 4, 5, 6]);
    }

    #[test]
    fn a_ring_fills_in_less_than_a_row_each() {
        let ring: Vec<_> = (0..12).map(|node| vec![node, (node + 1) % 12]).collect();
        let elimination = Elimination::by_minimum_degree(12, &ring, |_, _| true).unwrap();
        assert_eq!(elimination.columns.len(), 12 + 9);
        for row in 0..12 {
            let columns = &elimination.columns[elimination.blocks_of(row)];
            assert!(columns.iter().all(|column| *column as usize > row) && columns.is_sorted());
        }
    }
}
