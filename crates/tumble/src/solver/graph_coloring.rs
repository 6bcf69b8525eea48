//! Greedy graph coloring of contacts, so that no two of one color share a dynamic body.

use crate::solver::solver_bodies::SolverRow;

/// Which contacts can be solved in parallel: those of one color have no dynamic body in common.
///
/// Colors are given in the order of the contacts, to each the lowest that both bodies have not got
/// yet, so they depend on nothing but which contacts there are.
#[derive(Clone, Default)]
pub(crate) struct GraphColoring {
    /// By row, the colors that it has as bits: of contacts between dynamic bodies, and of those
    /// with a non-dynamic body.
    taken: Vec<[u64; 2]>,
    /// By contact.
    colors: Vec<ContactColor>,
}

/// The color of a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ContactColor {
    /// Only the second body is dynamic.
    pub(crate) has_non_dynamic: bool,
    /// From 0; [`ContactColor::OVERFLOW`] for a contact whose bodies have all colors already, which
    /// is solved by itself.
    pub(crate) index: u32,
}

impl ContactColor {
    /// The index of contacts without a color.
    pub(crate) const OVERFLOW: u32 = u64::BITS;
}

impl GraphColoring {
    /// Of each contact.
    pub(crate) fn colors(&self) -> &[ContactColor] {
        &self.colors
    }

    /// Of contacts, each with the rows of its bodies; those from `first_non_dynamic` on are not
    /// dynamic.
    pub(crate) fn color(&mut self, rows: impl Iterator<Item = [SolverRow; 2]>, first_non_dynamic: usize) {
        self.taken.clear();
        self.taken.resize(first_non_dynamic, [0; 2]);
        self.colors.clear();
        for [first, second] in rows {
            let has_non_dynamic = first.index() >= first_non_dynamic;
            let which = usize::from(has_non_dynamic);
            let taken =
                self.taken[second.index()][which] | if has_non_dynamic { 0 } else { self.taken[first.index()][0] };
            let index = taken.trailing_ones();
            if index < ContactColor::OVERFLOW {
                self.taken[second.index()][which] |= 1 << index;
                if !has_non_dynamic {
                    self.taken[first.index()][0] |= 1 << index;
                }
            }
            self.colors.push(ContactColor { has_non_dynamic, index });
        }
    }
}

/// Sorts things into buckets: `bucket` has that of each place. Returns where each bucket ends.
pub(crate) fn sort_into_buckets<T: Copy, const N: usize>(
    unsorted: &[T],
    bucket: impl Fn(usize) -> usize,
    sorted: &mut Vec<T>,
) -> [usize; N] {
    let mut ends = [0; N];
    (0..unsorted.len()).for_each(|place| ends[bucket(place)] += 1);
    let mut sum = 0;
    for end in &mut ends {
        (*end, sum) = (sum, sum + *end);
    }
    sorted.clear();
    sorted.extend_from_slice(unsorted);
    for (place, it) in unsorted.iter().enumerate() {
        let next = &mut ends[bucket(place)];
        sorted[*next] = *it;
        *next += 1;
    }
    ends
}
