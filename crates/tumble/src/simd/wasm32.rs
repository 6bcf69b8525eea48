//! Tiles of WebAssembly's vectors of 128 bits.
//!
//! A module that is compiled with them does not load where they are missing, so their intrinsics
//! may run.

#![allow(unsafe_code, reason = "intrinsics; see the SAFETY notes")]
#![allow(unused_unsafe, reason = "what other targets call unsafe is safe on this one")]

use std::arch::wasm32::*;
use std::ops::{Add, Div, Mul, Neg, Sub};

use tumble_math::lane::Lane;

use super::four::FourKernel;
#[cfg(not(feature = "f64"))]
use super::four::FourLane;
#[cfg(not(feature = "f64"))]
use super::intrinsics::widen_to_four;
use super::intrinsics::{lane, tile};
use super::pair::Pair;
use super::record::{numbers, set_numbers};
use super::row_blocks::{Block, blocks};
use super::{BLOCK, Eight, Kernel, Record, Tile, Widen, row_blocks, tiles};
use crate::math::Real;

#[cfg(feature = "f64")]
use self::Double as Simd128;
#[cfg(not(feature = "f64"))]
use self::Single as Simd128;

/// Widths of all tiles.
pub(super) const BASELINE_WIDTHS: [usize; 2] = [Simd128::WIDTH, Real::WIDTH];

/// Runs a kernel on tiles of one vector; most machines below have 16 registers for them.
pub(super) fn with_baseline<K: Kernel>(kernel: &mut K) {
    let left = if K::IS_RARE { 0 } else { tiles::<Simd128, _>(kernel, 0) };
    kernel.one_by_one(left);
}

/// Runs a kernel of whole blocks on tiles of one vector.
pub(super) fn blocks_with_baseline(kernel: &mut impl Kernel) {
    tiles::<Simd128, _>(kernel, 0);
}

/// Runs a kernel of fours on two vectors.
pub(super) fn fours_with_baseline(kernel: impl FourKernel) {
    kernel.run::<Pair<Double>>();
}

lane! {
    Double, f64, v128, v128, 2,
    f64x2_splat, v128_load, v128_store, f64x2_add, f64x2_sub, f64x2_mul, f64x2_div, f64x2_sqrt;
    neg: |n| f64x2_neg(n),
    lt: |a, b| f64x2_lt(a, b),
    select: |mask, t, f| v128_bitselect(t, f, mask),
    any: |m| v128_any_true(m),
    all: |m| i64x2_all_true(m),
    exp2: |e| i64x2_shl(i64x2_extend_low_i32x4(i32x4_add(i32x4_trunc_sat_f64x2_zero(e), i32x4_splat(1023))), 52),
}

#[cfg(feature = "f64")]
tile! {
    Double, v128, 2, v128_load, v128_store,
    or: |x, y| v128_or(x, y),
    is_zero: |v| !v128_any_true(v),
    rows: row_blocks,
}

#[cfg(not(feature = "f64"))]
lane! {
    Single, f32, v128, v128, 4,
    f32x4_splat, v128_load, v128_store, f32x4_add, f32x4_sub, f32x4_mul, f32x4_div, f32x4_sqrt;
    neg: |n| f32x4_neg(n),
    lt: |a, b| f32x4_lt(a, b),
    select: |mask, t, f| v128_bitselect(t, f, mask),
    any: |m| v128_any_true(m),
    all: |m| i32x4_all_true(m),
    exp2: |e| i32x4_shl(i32x4_add(i32x4_trunc_sat_f32x4(e), i32x4_splat(127)), 23),
}

#[cfg(not(feature = "f64"))]
widen_to_four!(Single, Pair<Double>);

#[cfg(not(feature = "f64"))]
tile! {
    Single, v128, 4, v128_load, v128_store,
    or: |x, y| v128_or(x, y),
    is_zero: |v| !v128_any_true(v),
    rows: row_blocks,
}

blocks!(v128, v128_load, v128_store, zip_low, zip_high);

#[inline(always)]
fn zip_low(a: v128, b: v128) -> v128 {
    if cfg!(feature = "f64") { i64x2_shuffle::<0, 2>(a, b) } else { i32x4_shuffle::<0, 4, 1, 5>(a, b) }
}

#[inline(always)]
fn zip_high(a: v128, b: v128) -> v128 {
    if cfg!(feature = "f64") { i64x2_shuffle::<1, 3>(a, b) } else { i32x4_shuffle::<2, 6, 3, 7>(a, b) }
}
