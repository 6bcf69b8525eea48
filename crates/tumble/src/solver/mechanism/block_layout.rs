//! Where the numbers of a matrix in blocks are.

use crate::solver::mechanism::block_kernels::fours;

/// Where the numbers of nodes and blocks are. Where all nodes have `U` rows it follows from their
/// place alone; zero stands for any numbers of rows.
#[derive(Clone, Copy)]
pub(super) struct Layout<'a, const U: usize> {
    pub(super) sizes: &'a [usize],
    pub(super) starts: &'a [usize],
    pub(super) diagonal_starts: &'a [usize],
    pub(super) block_starts: &'a [usize],
    pub(super) transposed_starts: &'a [usize],
}

impl<const U: usize> Layout<'_, U> {
    #[inline(always)]
    pub(super) fn size(self, node: usize) -> usize {
        if U == 0 { self.sizes[node] } else { U }
    }

    #[inline(always)]
    pub(super) fn start(self, node: usize) -> usize {
        if U == 0 { self.starts[node] } else { node * fours(U) }
    }

    #[inline(always)]
    pub(super) fn diagonal(self, node: usize) -> usize {
        if U == 0 { self.diagonal_starts[node] } else { node * U * fours(U) }
    }

    #[inline(always)]
    pub(super) fn block(self, block: usize) -> usize {
        if U == 0 { self.block_starts[block] } else { block * U * fours(U) }
    }

    #[inline(always)]
    pub(super) fn transposed(self, block: usize) -> usize {
        if U == 0 { self.transposed_starts[block] } else { self.block(block) }
    }
}
