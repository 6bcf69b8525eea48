//! Tiles of WebAssembly's vectors of 128 bits.
//!
//! A module that is compiled with them does not load where they are missing, so their intrinsics
//! may run.

#![allow(unsafe_code, reason = "intrinsics; see the SAFETY notes")]
#![allow(unused_unsafe, reason = "what other targets call unsafe is safe on this one")]

use std::arch::wasm32::*;
use std::ops::{Add, Div, Mul, Neg, Sub};

use tumble_math::lane::Lane;

use super::four::{Four, FourKernel, FourLane};
use super::intrinsics::{lane, tile};
use super::pair::Pair;
use super::record::{numbers, set_numbers};
use super::row_blocks::Block;
#[cfg(not(feature = "f64"))]
use super::row_blocks::blocks_of_fours;
#[cfg(feature = "f64")]
use super::row_blocks::blocks_of_twos;
use super::{BLOCK, Eight, Kernel, Record, Tile, one_by_one, row_blocks, tiles};
use crate::math::Real;

#[cfg(feature = "f64")]
use self::Simd128Double as Simd128;
#[cfg(not(feature = "f64"))]
use self::Simd128Single as Simd128;

/// Widths of all tiles.
pub(super) const BASELINE_WIDTHS: [usize; 2] = [Simd128::WIDTH, Real::WIDTH];

/// Runs a kernel on tiles of one vector; most machines below have 16 registers for them.
pub(super) fn with_baseline(kernel: &mut impl Kernel) {
    let left = tiles::<Simd128>(kernel, 0);
    one_by_one(kernel, left);
}

/// Runs a kernel of whole blocks on tiles of one vector.
pub(super) fn blocks_with_baseline(kernel: &mut impl Kernel) {
    tiles::<Simd128>(kernel, 0);
}

/// Runs a kernel of fours on two vectors.
pub(super) fn fours_with_baseline(kernel: impl FourKernel) {
    kernel.run::<Pair<Simd128Double>>();
}

/// Loads a vector, aligned or not.
#[inline(always)]
unsafe fn load<T>(numbers: *const T) -> v128 {
    // SAFETY: the caller's promise.
    unsafe { v128_load(numbers.cast()) }
}

/// Stores a vector, aligned or not.
#[inline(always)]
unsafe fn store<T>(numbers: *mut T, vector: v128) {
    // SAFETY: the caller's promise.
    unsafe { v128_store(numbers.cast(), vector) }
}

lane! {
    Simd128Double, f64, v128, v128, 2,
    f64x2_splat, load, store, f64x2_add, f64x2_sub, f64x2_mul, f64x2_div, f64x2_sqrt, min_f64, max_f64,
    neg: |n| f64x2_neg(n),
    lt: |a, b| f64x2_lt(a, b),
    select: |mask, t, f| v128_bitselect(t, f, mask),
    any: |m| v128_any_true(m),
    all: |m| i64x2_all_true(m),
    exp2: |e| i64x2_shl(i64x2_extend_low_i32x4(i32x4_add(i32x4_trunc_sat_f64x2_zero(e), i32x4_splat(1023))), 52),
}

impl FourLane for Pair<Simd128Double> {
    #[inline(always)]
    fn load(&[a, b, c, d]: &Four) -> Self {
        Self(Simd128Double::from_array(&[a, b]), Simd128Double::from_array(&[c, d]))
    }

    #[inline(always)]
    fn store(self, numbers: &mut Four) {
        let ([a, b], [c, d]) = (self.0.to_array(), self.1.to_array());
        *numbers = [a, b, c, d];
    }
}

/// The first where it is less, else the second: `pmin` gives its first where they are equal.
#[inline(always)]
fn min_f64(a: v128, b: v128) -> v128 {
    f64x2_pmin(b, a)
}

#[inline(always)]
fn max_f64(a: v128, b: v128) -> v128 {
    f64x2_pmax(b, a)
}

#[cfg(feature = "f64")]
tile! {
    Simd128Double, v128, 2, load, store,
    or: |x, y| v128_or(x, y),
    is_zero: |v| !v128_any_true(v),
    rows: row_blocks,
}

#[cfg(feature = "f64")]
blocks_of_twos!(v128, load, store, low_halves, high_halves);

#[cfg(not(feature = "f64"))]
lane! {
    Simd128Single, f32, v128, v128, 4,
    f32x4_splat, load, store, f32x4_add, f32x4_sub, f32x4_mul, f32x4_div, f32x4_sqrt, min_f32, max_f32,
    neg: |n| f32x4_neg(n),
    lt: |a, b| f32x4_lt(a, b),
    select: |mask, t, f| v128_bitselect(t, f, mask),
    any: |m| v128_any_true(m),
    all: |m| i32x4_all_true(m),
    exp2: |e| i32x4_shl(i32x4_add(i32x4_trunc_sat_f32x4(e), i32x4_splat(127)), 23),
}

/// As [`min_f64`].
#[cfg(not(feature = "f64"))]
#[inline(always)]
fn min_f32(a: v128, b: v128) -> v128 {
    f32x4_pmin(b, a)
}

#[cfg(not(feature = "f64"))]
#[inline(always)]
fn max_f32(a: v128, b: v128) -> v128 {
    f32x4_pmax(b, a)
}

#[cfg(not(feature = "f64"))]
tile! {
    Simd128Single, v128, 4, load, store,
    or: |x, y| v128_or(x, y),
    is_zero: |v| !v128_any_true(v),
    rows: row_blocks,
}

#[cfg(not(feature = "f64"))]
blocks_of_fours!(v128, load, store, zip_low, zip_high, low_halves, high_halves);

#[cfg(not(feature = "f64"))]
#[inline(always)]
fn zip_low(a: v128, b: v128) -> v128 {
    i32x4_shuffle::<0, 4, 1, 5>(a, b)
}

#[cfg(not(feature = "f64"))]
#[inline(always)]
fn zip_high(a: v128, b: v128) -> v128 {
    i32x4_shuffle::<2, 6, 3, 7>(a, b)
}

#[inline(always)]
fn low_halves(a: v128, b: v128) -> v128 {
    i64x2_shuffle::<0, 2>(a, b)
}

#[inline(always)]
fn high_halves(a: v128, b: v128) -> v128 {
    i64x2_shuffle::<1, 3>(a, b)
}
