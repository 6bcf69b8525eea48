//! Arithmetic on the blocks of a matrix, in rows of whole fours.

use crate::simd::{Four, FourLane};
use crate::solver::mechanism::fours::{by_place, of_each};

/// The most rows of a node: of a joint with six free axes, a twist, a distance and a cone.
pub(crate) const MAX_ROWS: usize = 9;

/// Calls a kernel with the sizes of its blocks: for those of balls, hinges and welds with
/// constants, so that its loops are unrolled.
macro_rules! sized {
    ($kernel:ident($($argument:expr),*; $sizes:expr)) => {
        match $sizes {
            [3, 3] => $kernel::<T>($($argument,)* [3, 3]),
            [5, 5] => $kernel::<T>($($argument,)* [5, 5]),
            [6, 6] => $kernel::<T>($($argument,)* [6, 6]),
            sizes => $kernel::<T>($($argument,)* sizes),
        }
    };
}
pub(super) use sized;

/// A loop over rows, at most [`MAX_ROWS`], that is unrolled where their number is a constant.
macro_rules! unrolled {
    ($i:ident in $n:ident $body:block) => {
        $crate::solver::mechanism::block_kernels::unrolled!(@ $i $n $body 0 1 2 3 4 5 6 7 8)
    };
    (@ $i:ident $n:ident $body:block $($number:literal)+) => {
        $(
            if $n > $number {
                let $i: usize = $number;
                $body
            }
        )+
    };
}
pub(super) use unrolled;

/// How many fours a row of `n` numbers takes.
#[inline(always)]
pub(crate) const fn fours(n: usize) -> usize {
    n.div_ceil(4)
}

/// `c = a b`, with `a` of `n x n` and `b` of `n x m` numbers.
#[inline(always)]
pub(super) fn product<T: FourLane>(a: &[Four], b: &[Four], c: &mut [Four], [n, m]: [usize; 2]) {
    let (w, v) = (fours(n), fours(m));
    let (a, b, c) = (&a[..n * w], &b[..n * v], &mut c[..n * v]);
    for i in 0..n {
        for j in 0..v {
            let mut sum = T::splat(a[i * w][0]) * T::load(&b[j]);
            for k in 1..n {
                sum = sum + T::splat(a[i * w + k / 4][k % 4]) * T::load(&b[k * v + j]);
            }
            sum.store(&mut c[i * v + j]);
        }
    }
}

/// `c = b^T`, with `b` of `n x m` numbers.
#[inline(always)]
pub(super) fn transpose<T: FourLane>(b: &[Four], c: &mut [Four], [n, m]: [usize; 2]) {
    let (w, v) = (fours(n), fours(m));
    let (b, c) = (&b[..n * v], &mut c[..m * w]);
    for i in 0..w {
        for j in 0..v {
            let rows = of_each!([4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3], row => {
                if row < n { T::load(&b[row * v + j]) } else { T::splat(0.0) }
            });
            let columns = T::transpose(rows);
            by_place!(k of 4 {
                if 4 * j + k < m {
                    columns[k].store(&mut c[(4 * j + k) * w + i]);
                }
            });
        }
    }
}

/// `c -= a^T b`, with `a` of `n x n` and `b` of `n x m` numbers.
#[inline(always)]
pub(super) fn subtract_transposed_square<T: FourLane>(a: &[Four], b: &[Four], c: &mut [Four], [n, m]: [usize; 2]) {
    subtract_transposed::<T>(a, b, c, [n, n, m]);
}

/// `c -= a^T b`, with `a` of `n x k` and `b` of `n x m` numbers.
#[inline(always)]
pub(super) fn subtract_transposed<T: FourLane>(a: &[Four], b: &[Four], c: &mut [Four], [n, k, m]: [usize; 3]) {
    let (w, v) = (fours(k), fours(m));
    let (a, b, c) = (&a[..n * w], &b[..n * v], &mut c[..k * v]);
    for i in 0..k {
        for j in 0..v {
            let mut sum = T::load(&c[i * v + j]);
            for r in 0..n {
                sum = sum - T::splat(a[r * w + i / 4][i % 4]) * T::load(&b[r * v + j]);
            }
            sum.store(&mut c[i * v + j]);
        }
    }
}

/// `y -= w x`, with `w^T` of `m x n` numbers.
#[inline(always)]
pub(super) fn backward<T: FourLane>(transposed: &[Four], x: &[Four], y: &mut [Four], [n, m]: [usize; 2]) {
    subtract_columns::<T>(transposed, x, y, [m, n]);
}

/// `y -= w^T x`, with `w` of `n x m` numbers.
#[inline(always)]
pub(super) fn subtract_columns<T: FourLane>(w: &[Four], x: &[Four], y: &mut [Four], [n, m]: [usize; 2]) {
    let v = fours(m);
    let (w, x, y) = (&w[..n * v], &x[..fours(n)], &mut y[..v]);
    for j in 0..v {
        let mut sum = T::load(&y[j]);
        for i in 0..n {
            sum = sum - T::load(&w[i * v + j]) * T::splat(x[i / 4][i % 4]);
        }
        sum.store(&mut y[j]);
    }
}

/// `x = a x`, with a symmetric `a` of `n x n` numbers.
#[inline(always)]
pub(super) fn multiply<T: FourLane>(a: &[Four], x: &mut [Four], [n, _]: [usize; 2]) {
    let w = fours(n);
    let (a, x) = (&a[..n * w], &mut x[..w]);
    let mut products = [T::splat(0.0); fours(MAX_ROWS)];
    for j in 0..w {
        let mut sum = T::load(&a[j]) * T::splat(x[0][0]);
        for i in 1..n {
            sum = sum + T::load(&a[i * w + j]) * T::splat(x[i / 4][i % 4]);
        }
        products[j] = sum;
    }
    for j in 0..w {
        products[j].store(&mut x[j]);
    }
}

/// Inverts a block on the diagonal, as [`invert`].
#[inline(always)]
pub(super) fn invert_sized(a: &mut [Four], raised: &[Four], n: usize) -> bool {
    match n {
        3 => invert(a, raised, 3),
        5 => invert(a, raised, 5),
        6 => invert(a, raised, 6),
        n => invert(a, raised, n),
    }
}

/// A pivot that is no more than this many times what it was raised by is one of a dependent row.
const DEPENDENT: f64 = 1e5;

/// Inverts a symmetric positive matrix in its place, of which the diagonal was raised, from the
/// half below its diagonal. A row without response, as of bodies that do not turn, gets none.
/// Returns whether a row depends on others.
#[inline(always)]
pub(super) fn invert(a: &mut [Four], raised: &[Four], n: usize) -> bool {
    let w = fours(n);
    let (a, raised) = (&mut a[..n * w], &raised[..w]);
    let mut is_dependent = false;
    // L below the diagonal, and 1/D.
    let mut inverse_pivots = [0.0; MAX_ROWS];
    unrolled!(j in n {
        let pivot = a[j * w + j / 4][j % 4];
        is_dependent |= pivot <= DEPENDENT * raised[j / 4][j % 4];
        inverse_pivots[j] = if pivot > 0.0 { 1.0 / pivot } else { 0.0 };
        for i in j + 1..n {
            let factor = a[i * w + j / 4][j % 4] * inverse_pivots[j];
            for k in j + 1..=i {
                a[i * w + k / 4][k % 4] -= factor * a[k * w + j / 4][j % 4];
            }
        }
        for i in j + 1..n {
            a[i * w + j / 4][j % 4] *= inverse_pivots[j];
        }
    });
    // The inverse above the diagonal, where nothing is left that it needs.
    unrolled!(column in n {
        let mut y = [0.0; MAX_ROWS];
        y[column] = 1.0;
        for i in column + 1..n {
            let mut sum = a[i * w + column / 4][column % 4];
            for k in column + 1..i {
                sum += a[i * w + k / 4][k % 4] * y[k];
            }
            y[i] = -sum;
        }
        for i in (column..n).rev() {
            let mut sum = 0.0;
            for k in i + 1..n {
                sum += a[k * w + i / 4][i % 4] * y[k];
            }
            y[i] = y[i] * inverse_pivots[i] - sum;
            a[column * w + i / 4][i % 4] = y[i];
        }
    });
    unrolled!(i in n {
        for j in 0..i {
            a[i * w + j / 4][j % 4] = a[j * w + i / 4][i % 4];
        }
    });
    is_dependent
}

/// One at a place.
pub(super) const UNITS: [Four; 4] =
    [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
