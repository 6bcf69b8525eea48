//! A sparse symmetric positive matrix in blocks, factored as `L D L^T`.

use crate::math::Real;
use crate::solver::mechanism::elimination::Elimination;

/// The matrix of a mechanism's rows, block by block: a node has the rows of a joint.
#[derive(Clone, Debug, Default)]
pub(crate) struct BlockLdl {
    pub(crate) elimination: Elimination,
    /// By place in the order of elimination: the rows of a node.
    sizes: Vec<usize>,
    /// By place, where its numbers begin in a vector; and how many there are.
    pub(crate) starts: Vec<usize>,
    /// By place, where its block on the diagonal begins, of `size x size` numbers in rows; and
    /// where the last ends.
    diagonal_starts: Vec<usize>,
    /// Once factored, their inverses.
    diagonal: Vec<f64>,
    /// By block beyond the diagonal, where it begins; and where the last ends.
    block_starts: Vec<usize>,
    blocks: Vec<f64>,
    /// Once factored: `D^-1 B` of each block `B`.
    weights: Vec<f64>,
    /// By row, by how much its number on the diagonal was raised.
    raised: Vec<f64>,
    /// For each row and each pair of its blocks, the first of them below: the block that the pair
    /// changes.
    targets: Vec<u32>,
    /// Whether a row depends on others, as far as the factors tell.
    pub(crate) has_dependent_rows: bool,
}

/// By how much of itself each number on the diagonal is raised, which makes rows harmless that
/// depend on others. Rounding of the state makes such rows contradict each other a little.
const REGULARIZATION: f64 = if size_of::<Real>() == size_of::<f64>() { 1e-9 } else { 1e-7 };

/// Calls a kernel with the sizes of its blocks: for those of balls, hinges and welds with
/// constants, so that its loops are unrolled.
macro_rules! sized {
    ($kernel:ident($($argument:expr),*; $sizes:expr)) => {
        match $sizes {
            [3, 3] => $kernel($($argument,)* [3, 3]),
            [5, 5] => $kernel($($argument,)* [5, 5]),
            [6, 6] => $kernel($($argument,)* [6, 6]),
            sizes => $kernel($($argument,)* sizes),
        }
    };
}

impl BlockLdl {
    /// Of nodes with these numbers of rows.
    pub(crate) fn new(elimination: Elimination, sizes: Vec<usize>) -> Self {
        let mut it = Self { elimination, sizes, ..Self::default() };
        let Self { elimination, sizes, .. } = &it;
        let starts = ends(sizes.iter().copied());
        let diagonal_starts = ends(sizes.iter().map(|size| size * size));
        let mut of_blocks = Vec::new();
        let mut targets = Vec::new();
        for row in 0..sizes.len() {
            let blocks = elimination.blocks_of(row);
            for block in blocks.clone() {
                let column = elimination.columns[block];
                of_blocks.push(sizes[row] * sizes[column as usize]);
                for before in blocks.start..block {
                    let above = elimination.columns[before] as usize;
                    // Elimination makes the neighbours of a node neighbours of each other.
                    targets.push(elimination.block_at(above, column).map_or(u32::MAX, |target| target as u32));
                }
            }
        }
        let block_starts = ends(of_blocks.into_iter());
        it.diagonal = vec![0.0; last(&diagonal_starts)];
        it.blocks = vec![0.0; last(&block_starts)];
        it.weights = it.blocks.clone();
        it.raised = Vec::with_capacity(last(&starts));
        Self { starts, diagonal_starts, block_starts, targets, ..it }
    }

    /// How many rows in all.
    pub(crate) fn len(&self) -> usize {
        last(&self.starts)
    }

    /// Sets all blocks beyond the diagonal to zero.
    pub(crate) fn clear(&mut self) {
        self.blocks.fill(0.0);
    }

    /// The block of a node on the diagonal, to be set as a whole, in rows of its size.
    pub(crate) fn diagonal_mut(&mut self, node: usize) -> &mut [f64] {
        &mut self.diagonal[self.diagonal_starts[node]..self.diagonal_starts[node + 1]]
    }

    /// A block beyond the diagonal, to be added to.
    pub(crate) fn block_mut(&mut self, block: usize) -> &mut [f64] {
        &mut self.blocks[self.block_starts[block]..self.block_starts[block + 1]]
    }

    /// Factors the matrix that was set.
    pub(crate) fn factor(&mut self) {
        let Self { elimination, sizes, diagonal_starts, diagonal, block_starts, blocks, weights, targets, .. } = self;
        let mut target = targets.iter();
        self.has_dependent_rows = false;
        self.raised.clear();
        for (start, n) in diagonal_starts.iter().zip(&*sizes) {
            for i in 0..*n {
                let number = &mut diagonal[start + i * n + i];
                self.raised.push(*number * REGULARIZATION);
                *number *= 1.0 + REGULARIZATION;
            }
        }
        for row in 0..sizes.len() {
            let n = sizes[row];
            let pivot = &mut diagonal[diagonal_starts[row]..diagonal_starts[row + 1]];
            self.has_dependent_rows |= invert_sized(pivot, &self.raised[self.starts[row]..], n);
            let range = elimination.blocks_of(row);
            for block in range.clone() {
                let column = elimination.columns[block] as usize;
                let m = sizes[column];
                let pivot = &diagonal[diagonal_starts[row]..diagonal_starts[row + 1]];
                let whole = block_starts[block]..block_starts[block + 1];
                sized!(product(pivot, &blocks[whole.clone()], &mut weights[whole.clone()]; [n, m]));
                for before in range.start..block {
                    let Some(&target) = target.next() else { return };
                    let k = sizes[elimination.columns[before] as usize];
                    let [first, at] = [before, target as usize].map(|it| block_starts[it]..block_starts[it + 1]);
                    // The target belongs to a later row than both factors.
                    let (left, right) = blocks.split_at_mut(at.start);
                    let (left, right) = (&left[first], &mut right[..k * m]);
                    if n == k {
                        sized!(subtract_transposed_square(left, &weights[whole.clone()], right; [n, m]));
                    } else {
                        subtract_transposed(left, &weights[whole.clone()], right, [n, k, m]);
                    }
                }
                let at = diagonal_starts[column]..diagonal_starts[column + 1];
                let (of_row, weight, at) = (&blocks[whole.clone()], &weights[whole], &mut diagonal[at]);
                if n == m {
                    sized!(subtract_transposed_square(of_row, weight, at; [n, m]));
                } else {
                    subtract_transposed(of_row, weight, at, [n, m, m]);
                }
            }
        }
    }

    /// Solves for a right side, in its place.
    pub(crate) fn solve(&self, x: &mut [f64]) {
        let Self { elimination, sizes, starts, diagonal_starts, diagonal, block_starts, weights, .. } = self;
        for row in 0..sizes.len() {
            let n = sizes[row];
            let (before, after) = x.split_at_mut(starts[row + 1]);
            let here = &before[starts[row]..];
            for block in elimination.blocks_of(row) {
                let column = elimination.columns[block] as usize;
                let there = &mut after[starts[column] - starts[row + 1]..];
                sized!(forward(&weights[block_starts[block]..], here, there; [n, sizes[column]]));
            }
        }
        for row in (0..sizes.len()).rev() {
            let n = sizes[row];
            let (before, after) = x.split_at_mut(starts[row + 1]);
            let here = &mut before[starts[row]..];
            let pivot = &diagonal[diagonal_starts[row]..];
            match n {
                3 => multiply(pivot, here, 3),
                5 => multiply(pivot, here, 5),
                6 => multiply(pivot, here, 6),
                _ => multiply(pivot, here, n),
            }
            for block in elimination.blocks_of(row) {
                let column = elimination.columns[block] as usize;
                let there = &after[starts[column] - starts[row + 1]..];
                sized!(backward(&weights[block_starts[block]..], there, here; [n, sizes[column]]));
            }
        }
    }
}

/// The most rows of a node: of a joint with six free axes, a twist, a distance and a cone.
pub(crate) const MAX_ROWS: usize = 9;

/// Sums of the counts before each, and of all.
fn ends(counts: impl Iterator<Item = usize>) -> Vec<usize> {
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

/// `c = a b`, with `a` of `n x n` and `b` of `n x m` numbers.
#[inline(always)]
fn product(a: &[f64], b: &[f64], c: &mut [f64], [n, m]: [usize; 2]) {
    let (a, b, c) = (&a[..n * n], &b[..n * m], &mut c[..n * m]);
    for i in 0..n {
        for j in 0..m {
            let mut sum = a[i * n] * b[j];
            for k in 1..n {
                sum += a[i * n + k] * b[k * m + j];
            }
            c[i * m + j] = sum;
        }
    }
}

/// `c -= a^T b`, with `a` of `n x n` and `b` of `n x m` numbers.
#[inline(always)]
fn subtract_transposed_square(a: &[f64], b: &[f64], c: &mut [f64], [n, m]: [usize; 2]) {
    subtract_transposed(a, b, c, [n, n, m]);
}

/// `c -= a^T b`, with `a` of `n x k` and `b` of `n x m` numbers.
#[inline(always)]
fn subtract_transposed(a: &[f64], b: &[f64], c: &mut [f64], [n, k, m]: [usize; 3]) {
    let (a, b, c) = (&a[..n * k], &b[..n * m], &mut c[..k * m]);
    for i in 0..k {
        for j in 0..m {
            let mut sum = c[i * m + j];
            for r in 0..n {
                sum -= a[r * k + i] * b[r * m + j];
            }
            c[i * m + j] = sum;
        }
    }
}

/// `y -= w^T x`, with `w` of `n x m` numbers.
#[inline(always)]
fn forward(w: &[f64], x: &[f64], y: &mut [f64], [n, m]: [usize; 2]) {
    let (w, x, y) = (&w[..n * m], &x[..n], &mut y[..m]);
    for i in 0..n {
        for j in 0..m {
            y[j] -= w[i * m + j] * x[i];
        }
    }
}

/// `x = a x`, with `a` of `n x n` numbers.
#[inline(always)]
fn multiply(a: &[f64], x: &mut [f64], n: usize) {
    let (a, x) = (&a[..n * n], &mut x[..n]);
    let mut products = [0.0; MAX_ROWS];
    for i in 0..n {
        let mut sum = a[i * n] * x[0];
        for j in 1..n {
            sum += a[i * n + j] * x[j];
        }
        products[i] = sum;
    }
    x.copy_from_slice(&products[..n]);
}

/// `y -= w x`, with `w` of `n x m` numbers.
#[inline(always)]
fn backward(w: &[f64], x: &[f64], y: &mut [f64], [n, m]: [usize; 2]) {
    let (w, x, y) = (&w[..n * m], &x[..m], &mut y[..n]);
    for i in 0..n {
        for j in 0..m {
            y[i] -= w[i * m + j] * x[j];
        }
    }
}

/// Inverts a block on the diagonal, as [`invert`].
fn invert_sized(a: &mut [f64], raised: &[f64], n: usize) -> bool {
    match n {
        3 => invert(a, raised, 3),
        5 => invert(a, raised, 5),
        6 => invert(a, raised, 6),
        n => invert(a, raised, n),
    }
}

/// A pivot that is no more than this many times what it was raised by is one of a dependent row.
const DEPENDENT: f64 = 30.0;

/// Inverts a symmetric positive matrix in its place, of which the diagonal was raised. A row
/// without response, as of bodies that do not turn, gets none. Returns whether a row depends on
/// others.
#[inline(always)]
fn invert(a: &mut [f64], raised: &[f64], n: usize) -> bool {
    let (a, raised) = (&mut a[..n * n], &raised[..n]);
    let mut is_dependent = false;
    // L below the diagonal, and 1/D.
    let mut inverse_pivots = [0.0; MAX_ROWS];
    for j in 0..n {
        let pivot = a[j * n + j];
        is_dependent |= pivot <= DEPENDENT * raised[j];
        inverse_pivots[j] = if pivot > 0.0 { 1.0 / pivot } else { 0.0 };
        for i in j + 1..n {
            let factor = a[i * n + j] * inverse_pivots[j];
            for k in j + 1..=i {
                a[i * n + k] -= factor * a[k * n + j];
            }
        }
        for i in j + 1..n {
            a[i * n + j] *= inverse_pivots[j];
        }
    }
    let mut inverse = [0.0; MAX_ROWS * MAX_ROWS];
    for column in 0..n {
        let mut y = [0.0; MAX_ROWS];
        y[column] = 1.0;
        for i in column + 1..n {
            y[i] = -(column..i).map(|k| a[i * n + k] * y[k]).sum::<f64>();
        }
        for i in (0..n).rev() {
            y[i] = y[i] * inverse_pivots[i] - (i + 1..n).map(|k| a[k * n + i] * y[k]).sum::<f64>();
            inverse[i * n + column] = y[i];
        }
    }
    // Of both halves one, so that it stays symmetric.
    for i in 0..n {
        for j in 0..=i {
            let x = inverse[i * n + j];
            (a[i * n + j], a[j * n + i]) = (x, x);
        }
    }
    is_dependent
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Random positive matrices with the pattern of a ring with a tail, of blocks of all sizes:
    /// the solution times the matrix is the right side.
    #[test]
    fn what_is_solved_satisfies_the_equations() {
        // A linear congruential generator: its upper bits.
        let mut state = 1_u32;
        let mut number = move || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state) / f64::from(1_u32 << 31) - 1.0
        };
        for _ in 0..20 {
            let mut groups: Vec<_> = (0..7).map(|node| vec![node, (node + 1) % 7]).collect();
            groups.extend([vec![3, 7, 8], vec![8, 9]]);
            let elimination = Elimination::by_minimum_degree(10, &groups);
            let sizes: Vec<_> = (0..10).map(|_| 1 + ((number() + 1.0) * 2.99) as usize).collect();
            let mut ldl = BlockLdl::new(elimination, sizes.clone());
            ldl.clear();
            let count = ldl.len();
            let mut dense = vec![vec![0.0; count]; count];
            let place: Vec<_> = (0..10_u32).map(|n| ldl.elimination.order.iter().position(|m| *m == n)).collect();
            // The sum over groups of a positive matrix on the group's rows.
            for group in &groups {
                let nodes: Vec<_> = group.iter().filter_map(|node| place[*node as usize]).collect();
                let rows: Vec<_> = nodes.iter().flat_map(|n| ldl.starts[*n]..ldl.starts[*n] + sizes[*n]).collect();
                for _ in 0..rows.len() + 2 {
                    let v: Vec<_> = rows.iter().map(|_| number()).collect();
                    for (i, r) in rows.iter().enumerate() {
                        rows.iter().enumerate().for_each(|(j, c)| dense[*r][*c] += v[i] * v[j]);
                    }
                }
            }
            for row in 0..10 {
                let (n, at) = (sizes[row], ldl.starts[row]);
                for i in 0..n {
                    (0..n).for_each(|j| ldl.diagonal_mut(row)[i * n + j] = dense[at + i][at + j]);
                }
                for block in ldl.elimination.blocks_of(row) {
                    let column = ldl.elimination.columns[block] as usize;
                    let (m, to) = (sizes[column], ldl.starts[column]);
                    for i in 0..n {
                        (0..m).for_each(|j| ldl.block_mut(block)[i * m + j] = dense[at + i][to + j]);
                    }
                }
            }
            ldl.factor();
            let right: Vec<_> = (0..count).map(|_| number()).collect();
            let mut x = right.clone();
            ldl.solve(&mut x);
            let scale = x.iter().fold(1.0, |most: f64, x| most.max(x.abs()));
            for (row, b) in dense.iter().zip(&right) {
                let sum: f64 = row.iter().zip(&x).map(|(a, x)| a * x).sum();
                assert!((sum - b).abs() < 300.0 * REGULARIZATION * scale, "{sum} {b} {scale}");
            }
        }
    }
}
