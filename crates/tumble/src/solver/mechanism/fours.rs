//! Rows of a vector and one more number, and four of them side by side.

use tumble_math::lane::{Quat, Vec3};

use crate::simd::{Four, FourLane};

/// Evaluates the same expression for each of four; vectors do not go through a closure.
macro_rules! of_each {
    ($four:expr, $it:ident => $value:expr) => {{
        let [a, b, c, d] = $four;
        [
            {
                let $it = a;
                $value
            },
            {
                let $it = b;
                $value
            },
            {
                let $it = c;
                $value
            },
            {
                let $it = d;
                $value
            },
        ]
    }};
}
pub(super) use of_each;

/// Runs a block for each of the places of four, or of three.
macro_rules! by_place {
    ($k:ident of 4 $block:block) => {
        by_place!(@ $k $block 0 1 2 3)
    };
    ($k:ident of 3 $block:block) => {
        by_place!(@ $k $block 0 1 2)
    };
    (@ $k:ident $block:block $($place:literal)+) => {
        $({
            let $k: usize = $place;
            $block
        })+
    };
}
pub(super) use by_place;

/// A vector, and a number beside it.
#[inline(always)]
pub(super) fn row_of(v: Vec3<f64>, beside: f64) -> Four {
    [v.x, v.y, v.z, beside]
}

/// A quaternion.
#[inline(always)]
pub(crate) fn row(q: Quat<f64>) -> Four {
    [q.x, q.y, q.z, q.w]
}

/// The vector at the head of a row.
#[inline(always)]
pub(super) fn vector([x, y, z, _]: &Four) -> Vec3<f64> {
    Vec3 { x: *x, y: *y, z: *z }
}

/// The quaternion that a row is.
#[inline(always)]
pub(super) fn quaternion([x, y, z, w]: &Four) -> Quat<f64> {
    Quat { x: *x, y: *y, z: *z, w: *w }
}

/// Four numbers from one on, with the last of `count` in the place of those beyond.
#[inline(always)]
pub(super) fn four_of(first: usize, count: usize) -> [usize; 4] {
    of_each!([0, 1, 2, 3], k => (first + k).min(count - 1))
}

/// Whether a place of these has a number that no place before it has.
#[inline(always)]
pub(super) fn is_new(four: [usize; 4], k: usize) -> bool {
    k == 0 || four[k] != four[k - 1]
}

/// The vectors at the head of four rows side by side, and the numbers beside them.
#[inline(always)]
pub(super) fn vectors<T: FourLane>(rows: [&Four; 4]) -> (Vec3<T>, T) {
    let [x, y, z, beside] = T::transpose(of_each!(rows, row => T::load(row)));
    (Vec3 { x, y, z }, beside)
}

/// The quaternions of four rows side by side.
#[inline(always)]
pub(super) fn quaternions<T: FourLane>(rows: [&Four; 4]) -> Quat<T> {
    let [x, y, z, w] = T::transpose(of_each!(rows, row => T::load(row)));
    Quat { x, y, z, w }
}

/// Rows of four vectors, and of the numbers beside them.
#[inline(always)]
pub(super) fn rows_of<T: FourLane>(v: Vec3<T>, beside: T) -> [T; 4] {
    T::transpose([v.x, v.y, v.z, beside])
}

/// Rows of four quaternions.
#[inline(always)]
pub(super) fn rows<T: FourLane>(q: Quat<T>) -> [T; 4] {
    T::transpose([q.x, q.y, q.z, q.w])
}
