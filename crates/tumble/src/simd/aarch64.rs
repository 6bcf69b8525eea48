//! Tiles of NEON.
//!
//! Every 64-bit ARM machine that this is compiled for has NEON, so its intrinsics may run.

#![allow(unsafe_code, reason = "intrinsics; see the SAFETY notes")]

use std::arch::aarch64::*;
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
use self::Double as Neon;
#[cfg(not(feature = "f64"))]
use self::Single as Neon;

/// Widths of all tiles that are not pairs.
pub(super) const BASELINE_WIDTHS: [usize; 2] = [Neon::WIDTH, Real::WIDTH];

/// Runs a kernel on pairs of NEON tiles, for which there are 32 registers.
pub(super) fn with_baseline(kernel: &mut impl Kernel) {
    let left = tiles::<Pair<Neon>, _>(kernel, 0);
    let left = tiles::<Neon, _>(kernel, left);
    kernel.one_by_one(left);
}

/// Runs a kernel of whole blocks on NEON tiles.
pub(super) fn blocks_with_baseline(kernel: &mut impl Kernel) {
    tiles::<Neon, _>(kernel, 0);
}

/// Runs a kernel of fours on two vectors.
pub(super) fn fours_with_baseline(kernel: impl FourKernel) {
    kernel.run::<Pair<Double>>();
}

lane! {
    Double, f64, float64x2_t, uint64x2_t, 2,
    vdupq_n_f64, vld1q_f64, vst1q_f64, vaddq_f64, vsubq_f64, vmulq_f64, vdivq_f64, vsqrtq_f64;
    neg: |n| vnegq_f64(n),
    lt: |a, b| vcltq_f64(a, b),
    select: |mask, t, f| vbslq_f64(mask, t, f),
    any: |m| vmaxvq_u32(vreinterpretq_u32_u64(m)) != 0,
    all: |m| vminvq_u32(vreinterpretq_u32_u64(m)) != 0,
    exp2: |e| vreinterpretq_f64_s64(vshlq_n_s64::<52>(vaddq_s64(vcvtq_s64_f64(e), vdupq_n_s64(1023)))),
}

#[cfg(feature = "f64")]
tile! {
    Double, float64x2_t, 2, vld1q_f64, vst1q_f64,
    or: |x, y| vreinterpretq_f64_u64(vorrq_u64(vreinterpretq_u64_f64(x), vreinterpretq_u64_f64(y))),
    is_zero: |v| vmaxvq_u32(vreinterpretq_u32_f64(v)) == 0,
    rows: row_blocks,
}

#[cfg(feature = "f64")]
blocks!(float64x2_t, vld1q_f64, vst1q_f64, vzip1q_f64, vzip2q_f64);

#[cfg(not(feature = "f64"))]
lane! {
    Single, f32, float32x4_t, uint32x4_t, 4,
    vdupq_n_f32, vld1q_f32, vst1q_f32, vaddq_f32, vsubq_f32, vmulq_f32, vdivq_f32, vsqrtq_f32;
    neg: |n| vnegq_f32(n),
    lt: |a, b| vcltq_f32(a, b),
    select: |mask, t, f| vbslq_f32(mask, t, f),
    any: |m| vmaxvq_u32(m) != 0,
    all: |m| vminvq_u32(m) != 0,
    exp2: |e| vreinterpretq_f32_s32(vshlq_n_s32::<23>(vaddq_s32(vcvtq_s32_f32(e), vdupq_n_s32(127)))),
}

#[cfg(not(feature = "f64"))]
widen_to_four!(Single, Pair<Double>);

#[cfg(not(feature = "f64"))]
tile! {
    Single, float32x4_t, 4, vld1q_f32, vst1q_f32,
    or: |x, y| vreinterpretq_f32_u32(vorrq_u32(vreinterpretq_u32_f32(x), vreinterpretq_u32_f32(y))),
    is_zero: |v| vmaxvq_u32(vreinterpretq_u32_f32(v)) == 0,
    rows: row_blocks,
}

#[cfg(not(feature = "f64"))]
blocks!(float32x4_t, vld1q_f32, vst1q_f32, vzip1q_f32, vzip2q_f32);
