//! Transposes of tiles of up to 256 bits: rows are read and written in blocks of four numbers.
//!
//! A row of more than four numbers is two blocks that may overlap, so no number outside the row is
//! touched.

#![allow(unsafe_code, reason = "pointers to rows; see the SAFETY notes")]

use super::{BLOCK, Eight, Record};
use crate::math::Real;

/// How a vector type loads and stores one block of as many rows as it has lanes.
///
/// # Safety
/// `row` says where each row's block begins; the blocks of as many rows as there are lanes must be
/// readable (writable), and the machine must have the instruction set.
pub(super) trait Block: Sized + Copy {
    unsafe fn load4(row: impl Fn(usize) -> *const Real) -> [Self; 4];
    unsafe fn store4(numbers: [Self; 4], row: impl Fn(usize) -> *mut Real);
}

/// Blocks of vectors of four numbers: four by four, in place.
#[cfg(not(feature = "f64"))]
macro_rules! blocks {
    ($Vector:ty, $load:ident, $store:ident, $zip_low:ident, $zip_high:ident) => {
        impl Block for $Vector {
            #[inline(always)]
            unsafe fn load4(row: impl Fn(usize) -> *const Real) -> [Self; 4] {
                // SAFETY: the caller's promise.
                unsafe {
                    let (a, b) = ($load(row(0).cast()), $load(row(1).cast()));
                    transposed([a, b, $load(row(2).cast()), $load(row(3).cast())])
                }
            }

            #[inline(always)]
            unsafe fn store4(numbers: [Self; 4], row: impl Fn(usize) -> *mut Real) {
                // SAFETY: the caller's promise.
                unsafe {
                    let rows = transposed(numbers);
                    $store(row(0).cast(), rows[0]);
                    $store(row(1).cast(), rows[1]);
                    $store(row(2).cast(), rows[2]);
                    $store(row(3).cast(), rows[3]);
                }
            }
        }

        #[inline(always)]
        unsafe fn transposed([a, b, c, d]: [$Vector; 4]) -> [$Vector; 4] {
            // SAFETY: every machine of the target has vectors of 128 bits.
            unsafe {
                let (ac_low, ac_high) = ($zip_low(a, c), $zip_high(a, c));
                let (bd_low, bd_high) = ($zip_low(b, d), $zip_high(b, d));
                [
                    $zip_low(ac_low, bd_low),
                    $zip_high(ac_low, bd_low),
                    $zip_low(ac_high, bd_high),
                    $zip_high(ac_high, bd_high),
                ]
            }
        }
    };
}

/// Blocks of vectors of two numbers: two rows, each in two vectors.
#[cfg(feature = "f64")]
macro_rules! blocks {
    ($Vector:ty, $load:ident, $store:ident, $zip_low:ident, $zip_high:ident) => {
        impl Block for $Vector {
            #[inline(always)]
            unsafe fn load4(row: impl Fn(usize) -> *const Real) -> [Self; 4] {
                // SAFETY: the caller's promise.
                unsafe {
                    let low = ($load(row(0).cast()), $load(row(1).cast()));
                    let high = ($load(row(0).add(2).cast()), $load(row(1).add(2).cast()));
                    [
                        $zip_low(low.0, low.1),
                        $zip_high(low.0, low.1),
                        $zip_low(high.0, high.1),
                        $zip_high(high.0, high.1),
                    ]
                }
            }

            #[inline(always)]
            unsafe fn store4([a, b, c, d]: [Self; 4], row: impl Fn(usize) -> *mut Real) {
                // SAFETY: the caller's promise.
                unsafe {
                    $store(row(0).cast(), $zip_low(a, b));
                    $store(row(0).add(2).cast(), $zip_low(c, d));
                    $store(row(1).cast(), $zip_high(a, b));
                    $store(row(1).add(2).cast(), $zip_high(c, d));
                }
            }
        }
    };
}

pub(super) use blocks;

/// Whether rows are transposed in blocks; the few short ones are not.
pub(super) const fn transposes<R: Record, const N: usize>() -> bool {
    N >= 4
}

/// Loads the first `N` numbers of as many rows as there are lanes; `N` is at least four.
///
/// # Safety
/// As for [`Block`], of rows of `N` numbers.
#[inline(always)]
pub(super) unsafe fn load_rows<V: Block, const N: usize>(base: *const Real, stride: usize) -> [V; N] {
    let row = |lane: usize| base.wrapping_add(lane * stride);
    // SAFETY: both blocks lie within the row, and the caller's promise.
    let (first, last) = unsafe { (V::load4(row), V::load4(|lane| row(lane).wrapping_add(N - 4))) };
    joined(first, last, N - 4)
}

/// Loads the first `N` numbers of rows that are anywhere; `N` is at least four.
///
/// # Safety
/// The machine has the instruction set, and there are no more lanes than rows.
#[inline(always)]
pub(super) unsafe fn gather_rows<V: Block, const N: usize>(rows: &[&Eight; BLOCK]) -> [V; N] {
    let row = |lane: usize| rows[lane].0.as_ptr();
    // SAFETY: both blocks lie within a row of eight, and the caller's promise.
    let (first, last) = unsafe { (V::load4(row), V::load4(|lane| row(lane).wrapping_add(4))) };
    joined(first, last, 4)
}

/// The first four numbers of rows, and four from `begin` on.
#[inline(always)]
fn joined<V: Copy, const N: usize>(first: [V; 4], last: [V; 4], begin: usize) -> [V; N] {
    let mut numbers = [first[0]; N];
    let mut c = 1;
    while c < N {
        numbers[c] = if c < 4 { first[c] } else { last[c - begin] };
        c += 1;
    }
    numbers
}

/// Stores what [`load_rows`] loads.
///
/// # Safety
/// As for [`Block`], of rows of `N` numbers.
#[inline(always)]
pub(super) unsafe fn store_rows<V: Block, const N: usize>(v: [V; N], base: *mut Real, stride: usize) {
    let row = |lane: usize| base.wrapping_add(lane * stride);
    // SAFETY: both blocks lie within the row, and the caller's promise.
    unsafe {
        V::store4([v[0], v[1], v[2], v[3]], row);
        if N > 4 {
            V::store4([v[N - 4], v[N - 3], v[N - 2], v[N - 1]], |lane| row(lane).wrapping_add(N - 4));
        }
    }
}

/// Stores rows of eight that are anywhere.
///
/// # Safety
/// The machine has the instruction set, and there are no more lanes than rows.
#[inline(always)]
pub(super) unsafe fn scatter_rows<V: Block, const N: usize>(v: [V; N], rows: &mut [&mut Eight; BLOCK]) {
    const { assert!(N == 8) };
    let mut begins = [rows[0].0.as_mut_ptr(); BLOCK];
    let mut i = 1;
    while i < BLOCK {
        begins[i] = rows[i].0.as_mut_ptr();
        i += 1;
    }
    let row = |lane: usize| begins[lane];
    // SAFETY: both blocks lie within a row of eight, and the caller's promise.
    unsafe {
        V::store4([v[0], v[1], v[2], v[3]], row);
        V::store4([v[4], v[5], v[6], v[7]], |lane| row(lane).wrapping_add(4));
    }
}
