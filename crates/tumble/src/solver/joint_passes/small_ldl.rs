//! `L D L^T` of the small symmetric matrix of a joint, of a tile's joints side by side.

use crate::simd::Tile;
use crate::simd::block_lanes::{Lanes, at, put};

/// By how much of itself each number on the diagonal is raised, which makes rows that depend on
/// others harmless.
const REGULARIZATION: f64 = 1e-6;
/// What is left of a number on the diagonal below which its row answers to nothing.
const MIN_PIVOT: f64 = 1e-7;

/// Where the number in a row and a column of the lower triangle is.
pub(super) const fn place(row: usize, column: usize) -> usize {
    row * (row + 1) / 2 + column
}

/// Factors the lower triangle of a matrix of `R` rows; the inverses of `D` are on the diagonal.
#[inline(always)]
pub(super) fn factor<T: Tile, const R: usize, const M: usize>(
    mut matrix: [T; M],
    factors: &mut [Lanes; M],
    lane: usize,
) {
    let (zero, one) = (T::splat(0.0), T::splat(1.0));
    let mut least = [zero; R];
    let mut j = 0;
    while j < R {
        let diagonal = matrix[place(j, j)];
        least[j] = diagonal * T::splat(MIN_PIVOT);
        matrix[place(j, j)] = diagonal * T::splat(1.0 + REGULARIZATION);
        j += 1;
    }
    j = 0;
    while j < R {
        let pivot = matrix[place(j, j)];
        let inverse = T::select(least[j].lt(pivot), one / pivot, zero);
        let mut column = [zero; R];
        let mut i = j + 1;
        while i < R {
            column[i] = matrix[place(i, j)];
            let weight = column[i] * inverse;
            let mut k = j + 1;
            while k <= i {
                matrix[place(i, k)] = matrix[place(i, k)] - weight * column[k];
                k += 1;
            }
            matrix[place(i, j)] = weight;
            i += 1;
        }
        matrix[place(j, j)] = inverse;
        j += 1;
    }
    let mut m = 0;
    while m < M {
        put(matrix[m], &mut factors[m], lane);
        m += 1;
    }
}

/// The solution for a right side.
#[inline(always)]
pub(super) fn solve<T: Tile, const R: usize, const M: usize>(
    factors: &[Lanes; M],
    lane: usize,
    mut right: [T; R],
) -> [T; R] {
    let mut i = 1;
    while i < R {
        let mut j = 0;
        while j < i {
            right[i] = right[i] - at::<T>(&factors[place(i, j)], lane) * right[j];
            j += 1;
        }
        i += 1;
    }
    i = R;
    while i > 0 {
        i -= 1;
        right[i] = right[i] * at::<T>(&factors[place(i, i)], lane);
        let mut j = i + 1;
        while j < R {
            right[i] = right[i] - at::<T>(&factors[place(j, i)], lane) * right[j];
            j += 1;
        }
    }
    right
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Real;
    use crate::simd::BLOCK;

    /// Of a matrix and of one whose last row depends on the others: times the solution it gives the
    /// right side back, but for the row that answers to nothing.
    #[test]
    fn a_solution_gives_the_right_side_back() {
        let mut factors = [[0.0; BLOCK]; 6];
        let matrix: [Real; 6] = [4.0, 1.0, 3.0, -1.0, 0.5, 2.0];
        factor::<Real, 3, 6>(matrix, &mut factors, 2);
        let x = solve::<Real, 3, 6>(&factors, 2, [1.0, -2.0, 3.0]);
        let full = [[4.0, 1.0, -1.0], [1.0, 3.0, 0.5], [-1.0, 0.5, 2.0]];
        for (row, right) in full.iter().zip([1.0, -2.0, 3.0]) {
            let sum: Real = row.iter().zip(x).map(|(a, b)| a * b).sum();
            assert!((sum - right).abs() < 1e-4, "{sum} of {right}");
        }
        factor::<Real, 3, 6>([1.0, 0.0, 1.0, 0.0, 0.0, 0.0], &mut factors, 0);
        let [.., last] = solve::<Real, 3, 6>(&factors, 0, [1.0, 1.0, 1.0]);
        assert_eq!(last, 0.0);
    }
}
