//! Small dense systems of linear equations.

/// Solves `a x = b` for a matrix of as many rows as `b` has, row by row, by elimination with row
/// exchanges; `a` is overwritten and `b` becomes `x`. A column without a pivot gives zero.
#[inline(always)]
pub(crate) fn solve(a: &mut [f64], b: &mut [f64]) {
    let n = b.len();
    for k in 0..n {
        let (mut pivot, mut greatest) = (k, a[k * n + k].abs());
        for row in k + 1..n {
            let number = a[row * n + k].abs();
            if number > greatest {
                (pivot, greatest) = (row, number);
            }
        }
        if greatest == 0.0 {
            continue;
        }
        if pivot != k {
            let (first, second) = a.split_at_mut(pivot * n);
            first[k * n..(k + 1) * n].swap_with_slice(&mut second[..n]);
            b.swap(k, pivot);
        }
        let (above, below) = a.split_at_mut((k + 1) * n);
        let row = &above[k * n + k..];
        let (inverse, of_row) = (1.0 / row[0], b[k]);
        for (other, right) in below.chunks_exact_mut(n).zip(&mut b[k + 1..]) {
            let factor = other[k] * inverse;
            if factor != 0.0 {
                for (number, of_row) in other[k..].iter_mut().zip(row) {
                    *number -= factor * of_row;
                }
                *right -= factor * of_row;
            }
        }
    }
    for k in (0..n).rev() {
        let row = &a[k * n..(k + 1) * n];
        let known: f64 = row[k + 1..].iter().zip(&b[k + 1..]).map(|(number, x)| number * x).sum();
        b[k] = if row[k] == 0.0 { 0.0 } else { (b[k] - known) / row[k] };
    }
}
