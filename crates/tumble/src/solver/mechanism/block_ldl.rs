//! A sparse symmetric positive matrix in blocks, factored as `L D L^T`.

use crate::simd::{Four, FourKernel, FourLane, dispatch_fours};
use crate::solver::mechanism::block_kernels::{
    MAX_ROWS, backward, fours, invert, invert_sized, multiply, product, sized, subtract_columns, subtract_transposed,
    subtract_transposed_square, transpose, unrolled,
};
use crate::solver::mechanism::block_layout::Layout;
use crate::solver::mechanism::elimination::Elimination;

/// The matrix of a mechanism's rows, block by block: a node has the rows of a joint.
///
/// Vectors and the rows of blocks are in whole fours, of which the last numbers may mean nothing.
#[derive(Clone, Debug, Default)]
pub(crate) struct BlockLdl {
    pub(crate) elimination: Elimination,
    /// By place in the order of elimination: the rows of a node.
    sizes: Vec<usize>,
    /// By place, where its numbers begin in a vector, in fours; and how many fours there are.
    pub(crate) starts: Vec<usize>,
    /// By place, where its block on the diagonal begins; and where the last ends. Blocks are in
    /// rows of whole fours.
    diagonal_starts: Vec<usize>,
    /// Once factored, their inverses.
    diagonal: Vec<Four>,
    /// By block beyond the diagonal, where it begins; and where the last ends.
    block_starts: Vec<usize>,
    blocks: Vec<Four>,
    /// Once factored: `D^-1 B` of each block `B`.
    weights: Vec<Four>,
    /// The same transposed: where each begins, and the numbers.
    transposed_starts: Vec<usize>,
    transposed: Vec<Four>,
    /// By place.
    softness: Vec<Softness>,
    /// By row, by how much its number on the diagonal was raised.
    raised: Vec<Four>,
    /// For each row and each pair of its blocks, the first of them below: the block that the pair
    /// changes.
    targets: Vec<u32>,
    /// The rows of every node, if all have as many and there is code for that many, else zero.
    uniform: usize,
    /// Which rows may depend on others, and whether one does, as far as the factors tell.
    pub(super) dependence: Dependence,
    pub(crate) has_dependent_rows: bool,
}

/// Which rows of a matrix may depend on others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Dependence {
    #[default]
    None,
    /// On others of the same node: those past its locked axes.
    WithinJoints,
    BetweenJoints,
}

/// By how much of itself each number on the diagonal of a node is raised, from which row on; those
/// before are raised as where there is no misfit.
#[derive(Clone, Copy, Debug)]
struct Softness {
    amount: f64,
    from: usize,
}

/// Calls a method with the number of rows of all nodes: for those of balls, hinges and welds with a
/// constant.
macro_rules! uniformly {
    ($it:ident.$method:ident($($argument:expr),*)) => {
        match $it.uniform {
            3 => $it.$method::<T, 3>($($argument,)*),
            5 => $it.$method::<T, 5>($($argument,)*),
            6 => $it.$method::<T, 6>($($argument,)*),
            _ => $it.$method::<T, 0>($($argument,)*),
        }
    };
}

/// As [`sized`], of blocks in a [`Layout`] of `U`: one call where that is a constant, for each is
/// compiled into the caller.
macro_rules! laid_out {
    ($U:ident, $kernel:ident($($argument:expr),*; $sizes:expr)) => {
        if $U == 0 {
            sized!($kernel($($argument),*; $sizes))
        } else {
            $kernel::<T>($($argument,)* [$U, $U])
        }
    };
}

/// By how much of itself each number on the diagonal is raised.
const REGULARIZATION: f64 = 1e-9;
/// The same where rows may depend on others, which it makes harmless: about as much again is the
/// rounding of the factors of such rows.
const REGULARIZATION_OF_DEPENDENT: f64 = 1e-8;
/// The same by the square of a misfit, and the most.
const SOFTNESS_OF_MISFIT: f64 = 1e5;
const MAX_SOFTNESS: f64 = 0.1;
/// By the misfit, where that is less, of a mechanism in contact: a loaded bridge responds by little
/// more than joints that contradict each other, and has to hold when it is struck.
const SOFTNESS_OF_TOUCHED: f64 = 0.3;

impl BlockLdl {
    /// Of nodes with these numbers of rows.
    pub(crate) fn new(elimination: Elimination, sizes: Vec<usize>, dependence: Dependence) -> Self {
        let mut it = Self { elimination, sizes, dependence, ..Self::default() };
        let Self { elimination, sizes, .. } = &it;
        let starts = ends(sizes.iter().map(|size| fours(*size)));
        let diagonal_starts = ends(sizes.iter().map(|size| size * fours(*size)));
        let (mut of_blocks, mut of_transposed) = (Vec::new(), Vec::new());
        let mut targets = Vec::new();
        for row in 0..sizes.len() {
            let blocks = elimination.blocks_of(row);
            for block in blocks.clone() {
                let column = elimination.columns[block];
                let (n, m) = (sizes[row], sizes[column as usize]);
                of_blocks.push(n * fours(m));
                of_transposed.push(m * fours(n));
                for before in blocks.start..block {
                    let above = elimination.columns[before] as usize;
                    // Elimination makes the neighbours of a node neighbours of each other.
                    targets.push(elimination.block_at(above, column).map_or(u32::MAX, |target| target as u32));
                }
            }
        }
        let first = sizes.first().copied().unwrap_or(0);
        let is_uniform = matches!(first, 3 | 5 | 6) && sizes.iter().all(|size| *size == first);
        let uniform = if is_uniform { first } else { 0 };
        let [block_starts, transposed_starts] = [of_blocks, of_transposed].map(|counts| ends(counts.into_iter()));
        it.diagonal = vec![[0.0; 4]; last(&diagonal_starts)];
        it.blocks = vec![[0.0; 4]; last(&block_starts)];
        it.weights = it.blocks.clone();
        it.transposed = vec![[0.0; 4]; last(&transposed_starts)];
        it.raised = vec![[0.0; 4]; last(&starts)];
        it.softness = vec![Softness { amount: it.regularization(), from: 0 }; it.sizes.len()];
        Self { starts, diagonal_starts, block_starts, transposed_starts, targets, uniform, ..it }
    }

    /// Whether rows may depend on others.
    pub(super) fn may_depend(&self) -> bool {
        self.dependence != Dependence::None
    }

    /// Whether rows of several joints may depend on each other.
    pub(super) fn has_loops(&self) -> bool {
        self.dependence == Dependence::BetweenJoints
    }

    /// By how much of itself a number on the diagonal of no soft row is raised.
    #[inline(always)]
    fn regularization(&self) -> f64 {
        if self.may_depend() { REGULARIZATION_OF_DEPENDENT } else { REGULARIZATION }
    }

    /// Raises rows of a node from one on by more where they have a misfit, of the size of the arms
    /// or \[rad\]: by up to 1e5 times as much as it makes rows respond, times a part.
    pub(super) fn soften(&mut self, (node, from): (usize, usize), misfit: f64, (part, is_touched): (f64, bool)) {
        let softness = (SOFTNESS_OF_MISFIT * misfit * misfit).min(MAX_SOFTNESS);
        let softness = if is_touched { softness.min(SOFTNESS_OF_TOUCHED * misfit) } else { softness };
        self.softness[node] = Softness { amount: (part * softness).max(REGULARIZATION_OF_DEPENDENT), from };
    }

    /// By how much of itself each number on the diagonal of a node is raised.
    #[inline(always)]
    pub(super) fn softness(&self, node: usize) -> f64 {
        self.softness[node].amount
    }

    /// By how much each row of a node was raised.
    #[inline(always)]
    pub(super) fn raised_mut(&mut self, node: usize) -> &mut [Four] {
        &mut self.raised[self.starts[node]..self.starts[node + 1]]
    }

    /// How many fours a vector has.
    pub(crate) fn len(&self) -> usize {
        last(&self.starts)
    }

    /// Where a block beyond the diagonal begins.
    pub(super) fn block_start(&self, block: usize) -> usize {
        self.block_starts[block]
    }

    /// The numbers of all blocks beyond the diagonal.
    pub(super) fn blocks_mut(&mut self) -> &mut [Four] {
        &mut self.blocks
    }

    /// Where the numbers of a node are in a vector, number by number.
    pub(crate) fn place(&self, node: usize) -> usize {
        4 * self.start(node)
    }

    /// The same in fours.
    #[inline(always)]
    pub(super) fn start(&self, node: usize) -> usize {
        self.starts[node]
    }

    /// Sets a block beyond the diagonal to zero.
    pub(crate) fn clear(&mut self, block: usize) {
        self.blocks[self.block_starts[block]..self.block_starts[block + 1]].fill([0.0; 4]);
    }

    /// The block of a node on the diagonal, of which the half below the diagonal is to be set.
    pub(crate) fn diagonal_mut(&mut self, node: usize) -> &mut [Four] {
        &mut self.diagonal[self.diagonal_starts[node]..self.diagonal_starts[node + 1]]
    }

    /// Factors the matrix that was set.
    pub(crate) fn factor(&mut self) {
        match self.uniform {
            3 => dispatch_fours(Factor::<3> { matrix: self }),
            5 => dispatch_fours(Factor::<5> { matrix: self }),
            6 => dispatch_fours(Factor::<6> { matrix: self }),
            _ => dispatch_fours(Factor::<0> { matrix: self }),
        }
    }

    #[inline(always)]
    fn factor_uniform<T: FourLane, const U: usize>(&mut self) {
        let Self { elimination, sizes, starts, diagonal_starts, block_starts, transposed_starts, .. } = self;
        let layout = Layout::<U> { sizes, starts, diagonal_starts, block_starts, transposed_starts };
        let Self { diagonal, blocks, weights, transposed, targets, raised, dependence, .. } = self;
        let may_depend = *dependence != Dependence::None;
        let mut targets = targets.iter();
        self.has_dependent_rows = false;
        for row in 0..sizes.len() {
            let (n, w) = (layout.size(row), fours(layout.size(row)));
            let (before, after) = diagonal.split_at_mut(layout.diagonal(row) + n * w);
            let pivot = &mut before[layout.diagonal(row)..];
            let depends = if U == 0 {
                invert_sized(pivot, &raised[layout.start(row)..], n)
            } else {
                invert(pivot, &raised[layout.start(row)..], U)
            };
            self.has_dependent_rows |= may_depend & depends;
            let range = elimination.blocks_of(row);
            for block in range.clone() {
                let column = elimination.columns[block] as usize;
                let m = layout.size(column);
                let v = fours(m);
                let of_row = layout.block(block)..layout.block(block) + n * v;
                let weight = &mut weights[of_row.clone()];
                let weight_transposed = &mut transposed[layout.transposed(block)..][..m * w];
                laid_out!(U, product(pivot, &blocks[of_row.clone()], weight; [n, m]));
                laid_out!(U, transpose(weight, weight_transposed; [n, m]));
                for before in range.start..block {
                    let Some(&target) = targets.next() else { return };
                    let k = layout.size(elimination.columns[before] as usize);
                    // The target belongs to a later row than both factors.
                    let (left, right) = blocks.split_at_mut(layout.block(target as usize));
                    let (left, right) = (&left[layout.block(before)..][..n * fours(k)], &mut right[..k * v]);
                    if U != 0 || n == k {
                        laid_out!(U, subtract_transposed_square(left, weight, right; [n, m]));
                    } else {
                        subtract_transposed::<T>(left, weight, right, [n, k, m]);
                    }
                }
                let at = layout.diagonal(column) - layout.diagonal(row) - n * w;
                let (of_row, at) = (&blocks[of_row], &mut after[at..][..m * v]);
                if U != 0 || n == m {
                    laid_out!(U, subtract_transposed_square(of_row, weight, at; [n, m]));
                } else {
                    subtract_transposed::<T>(of_row, weight, at, [n, m, m]);
                }
            }
        }
    }

    /// Raises the numbers on the diagonal of a node of `n` rows, once they are set.
    #[inline(always)]
    pub(super) fn raise(&mut self, node: usize, n: usize) {
        let w = fours(n);
        let (Softness { amount, from }, regularization) = (self.softness[node], self.regularization());
        let numbers = &mut self.diagonal[self.diagonal_starts[node]..][..n * w];
        let raised = &mut self.raised[self.starts[node]..][..w];
        unrolled!(i in n {
            let number = &mut numbers[i * w + i / 4][i % 4];
            let softness = if i < from { regularization } else { amount };
            raised[i / 4][i % 4] = *number * softness;
            *number *= 1.0 + softness;
        });
    }

    /// Goes forward with many right sides, `width` fours of them by row.
    #[inline(always)]
    pub(super) fn forward<T: FourLane>(&self, x: &mut [Four], width: usize) {
        for row in 0..self.sizes.len() {
            let n = self.sizes[row];
            for block in self.elimination.blocks_of(row) {
                let column = self.elimination.columns[block] as usize;
                let (m, weights) = (self.sizes[column], &self.weights[self.block_starts[block]..]);
                for (i, j) in (0..n).flat_map(|i| (0..m).map(move |j| (i, j))) {
                    let weight = T::splat(weights[i * fours(m) + j / 4][j % 4]);
                    let (from, to) = ((self.place(row) + i) * width, (self.place(column) + j) * width);
                    // A later node has a later place.
                    let (before, after) = x.split_at_mut(to);
                    for (there, here) in after[..width].iter_mut().zip(&before[from..from + width]) {
                        (T::load(there) - weight * T::load(here)).store(there);
                    }
                }
            }
        }
    }

    /// Many right sides times the inverse pivots.
    #[inline(always)]
    pub(super) fn times_pivots<T: FourLane>(&self, x: &[Four], y: &mut [Four], width: usize) {
        for row in 0..self.sizes.len() {
            let (n, pivot) = (self.sizes[row], &self.diagonal[self.diagonal_starts[row]..]);
            for (i, k) in (0..n).flat_map(|i| (0..n).map(move |k| (i, k))) {
                let number = T::splat(pivot[i * fours(n) + k / 4][k % 4]);
                let (from, to) = ((self.place(row) + k) * width, (self.place(row) + i) * width);
                for (there, here) in y[to..to + width].iter_mut().zip(&x[from..from + width]) {
                    (T::load(there) + number * T::load(here)).store(there);
                }
            }
        }
    }

    /// Solves for a right side, in its place.
    pub(crate) fn solve(&self, x: &mut [Four]) {
        dispatch_fours(Solve { matrix: self, x });
    }

    #[inline(always)]
    fn solve_uniform<T: FourLane, const U: usize>(&self, x: &mut [Four]) {
        let Self { elimination, sizes, starts, diagonal_starts, block_starts, transposed_starts, .. } = self;
        let layout = Layout::<U> { sizes, starts, diagonal_starts, block_starts, transposed_starts };
        let x = &mut x[..last(starts)];
        for row in 0..sizes.len() {
            let n = layout.size(row);
            let here = local(&x[layout.start(row)..][..fours(n)]);
            for block in elimination.blocks_of(row) {
                let column = elimination.columns[block] as usize;
                let m = layout.size(column);
                let weight = &self.weights[layout.block(block)..][..n * fours(m)];
                let there = &mut x[layout.start(column)..][..fours(m)];
                laid_out!(U, subtract_columns(weight, &here, there; [n, m]));
            }
        }
        for row in (0..sizes.len()).rev() {
            let n = layout.size(row);
            let mut here = local(&x[layout.start(row)..][..fours(n)]);
            let pivot = &self.diagonal[layout.diagonal(row)..][..n * fours(n)];
            laid_out!(U, multiply(pivot, &mut here; [n, n]));
            for block in elimination.blocks_of(row) {
                let column = elimination.columns[block] as usize;
                let m = layout.size(column);
                let weight = &self.transposed[layout.transposed(block)..][..m * fours(n)];
                let there = &x[layout.start(column)..][..fours(m)];
                laid_out!(U, backward(weight, there, &mut here; [n, m]));
            }
            x[layout.start(row)..][..fours(n)].copy_from_slice(&here[..fours(n)]);
        }
    }
}

/// A copy of the numbers of a node.
#[inline(always)]
fn local(numbers: &[Four]) -> [Four; fours(MAX_ROWS)] {
    let mut local = [[0.0; 4]; fours(MAX_ROWS)];
    let mut i = 0;
    while i < numbers.len() {
        local[i] = numbers[i];
        i += 1;
    }
    local
}

/// A kernel for each number of rows: one for all would take far longer to compile.
struct Factor<'a, const U: usize> {
    matrix: &'a mut BlockLdl,
}

impl<const U: usize> FourKernel for Factor<'_, U> {
    #[inline(always)]
    fn run<T: FourLane>(self) {
        self.matrix.factor_uniform::<T, U>();
    }
}

struct Solve<'a> {
    matrix: &'a BlockLdl,
    x: &'a mut [Four],
}

impl FourKernel for Solve<'_> {
    #[inline(always)]
    fn run<T: FourLane>(self) {
        let Self { matrix, x } = self;
        uniformly!(matrix.solve_uniform(x));
    }
}

/// Sums of the counts before each, and of all.
pub(super) fn ends(counts: impl Iterator<Item = usize>) -> Vec<usize> {
    let mut ends = vec![0];
    ends.extend(counts.scan(0, |sum, count| {
        *sum += count;
        Some(*sum)
    }));
    ends
}

fn last(ends: &[usize]) -> usize {
    ends.last().copied().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_solved_satisfies_the_equations() {
        // A linear congruential generator: its upper bits.
        let mut state = 1_u32;
        let mut number = move || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state) / f64::from(1_u32 << 31) - 1.0
        };
        for case in 0..24 {
            let mut groups: Vec<_> = (0..7).map(|node| vec![node, (node + 1) % 7]).collect();
            groups.extend([vec![3, 7, 8], vec![8, 9]]);
            let elimination = Elimination::by_minimum_degree(10, &groups, |_, _| true).unwrap();
            // Of a third of them all nodes have one size.
            let size = |_| if case % 3 == 0 { 1 + case % 9 } else { 1 + ((number() + 1.0) * 4.49) as usize };
            let sizes: Vec<_> = (0..10).map(size).collect();
            let mut ldl = BlockLdl::new(elimination, sizes.clone(), Dependence::BetweenJoints);
            let count = 4 * ldl.len();
            let mut dense = vec![vec![0.0; count]; count];
            let place: Vec<_> = (0..10_u32).map(|n| ldl.elimination.order.iter().position(|m| *m == n)).collect();
            // The sum over groups of a positive matrix on the group's rows.
            for group in &groups {
                let nodes: Vec<_> = group.iter().filter_map(|node| place[*node as usize]).collect();
                let rows: Vec<_> = nodes.iter().flat_map(|n| ldl.place(*n)..ldl.place(*n) + sizes[*n]).collect();
                for _ in 0..rows.len() + 2 {
                    let v: Vec<_> = rows.iter().map(|_| number()).collect();
                    for (i, r) in rows.iter().enumerate() {
                        rows.iter().enumerate().for_each(|(j, c)| dense[*r][*c] += v[i] * v[j]);
                    }
                }
            }
            for row in 0..10 {
                let (n, at) = (sizes[row], ldl.place(row));
                for i in 0..n {
                    (0..=i).for_each(|j| ldl.diagonal_mut(row)[i * fours(n) + j / 4][j % 4] = dense[at + i][at + j]);
                }
                for block in ldl.elimination.blocks_of(row) {
                    let column = ldl.elimination.columns[block] as usize;
                    let (m, to) = (sizes[column], ldl.place(column));
                    let begin = ldl.block_start(block);
                    for i in 0..n {
                        for j in 0..m {
                            ldl.blocks_mut()[begin + i * fours(m) + j / 4][j % 4] = dense[at + i][to + j];
                        }
                    }
                }
            }
            sizes.iter().enumerate().for_each(|(node, size)| ldl.raise(node, *size));
            ldl.factor();
            let right: Vec<Four> = (0..ldl.len()).map(|_| [0; 4].map(|_| number())).collect();
            let mut x = right.clone();
            ldl.solve(&mut x);
            let (x, right) = (x.as_flattened(), right.as_flattened());
            let is_row = |at: &usize| (0..10).any(|row| (ldl.place(row)..ldl.place(row) + sizes[row]).contains(at));
            let rows: Vec<_> = (0..count).filter(is_row).collect();
            let scale = rows.iter().fold(1.0, |most: f64, at| most.max(x[*at].abs()));
            for at in &rows {
                let (sum, b) = (rows.iter().map(|other| dense[*at][*other] * x[*other]).sum::<f64>(), right[*at]);
                assert!((sum - b).abs() < 300.0 * REGULARIZATION * scale, "{sum} {b} {scale}");
            }
        }
    }
}
