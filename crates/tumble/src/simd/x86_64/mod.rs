//! Tiles of SSE2, AVX2 and AVX-512.
//!
//! Intrinsics are `unsafe`: those of an instruction set may only run where the machine has it.
//! Tiles are private to this module, and the only way to one is a `with_*` function, whose caller
//! has looked.

#![allow(unsafe_code, reason = "intrinsics; see the SAFETY notes")]

use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Neg, Sub};

use tumble_math::lane::Lane;

use super::four::{Four, FourKernel, FourLane};
#[cfg(not(feature = "f64"))]
use super::intrinsics::widen_to_four;
use super::intrinsics::{lane, tile};
use super::pair::Pair;
use super::record::{numbers, set_numbers};
use super::{BLOCK, Eight, Kernel, Record, Tile, Widen, row_blocks, tiles};
use crate::math::Real;

mod blocks;
mod wide;

/// Widths of all tiles that are not pairs, as the functions below go through them.
pub(super) const WIDTHS: [usize; 4] = [Avx512::WIDTH, Avx2::WIDTH, Sse2::WIDTH, Real::WIDTH];

/// Those of every x86-64 machine.
pub(super) const BASELINE_WIDTHS: [usize; 2] = [Sse2::WIDTH, Real::WIDTH];

/// The code of a kernel for each instruction set. As functions of its type they are compiled in the
/// units of the kernels' modules, side by side; as functions of this module all would be in one.
trait Compiled: Kernel + Sized {
    /// Runs it on AVX-512 tiles, and returns the first row that is left.
    ///
    /// # Safety
    /// The machine has AVX-512F.
    #[target_feature(enable = "avx512f")]
    unsafe fn avx512_tiles(&mut self) -> usize {
        align_the_stack();
        let left = tiles::<Pair<Avx512>, _>(self, 0);
        tiles::<Avx512, _>(self, left)
    }

    /// Runs it on AVX2 tiles from row `first` on, and returns the first row that is left.
    ///
    /// # Safety
    /// The machine has AVX2.
    #[target_feature(enable = "avx2")]
    unsafe fn avx2_tiles(&mut self, first: usize) -> usize {
        align_the_stack();
        let left = tiles::<Pair<Avx2>, _>(self, first);
        tiles::<Avx2, _>(self, left)
    }

    /// Runs it on SSE2 tiles from row `first` on, which every x86-64 machine has, and returns the
    /// first row that is left.
    fn sse2_tiles(&mut self, first: usize) -> usize {
        tiles::<Sse2, _>(self, first)
    }

    /// Runs it on AVX-512 tiles that are no wider than a block, and returns the first row that is
    /// left.
    ///
    /// # Safety
    /// The machine has AVX-512F.
    #[target_feature(enable = "avx512f")]
    unsafe fn avx512_blocks(&mut self) -> usize {
        align_the_stack();
        tiles::<Avx512, _>(self, 0)
    }

    /// Runs it on AVX2 tiles from row `first` on, of which whole halves of blocks are left.
    ///
    /// # Safety
    /// The machine has AVX2.
    #[target_feature(enable = "avx2")]
    unsafe fn avx2_blocks(&mut self, first: usize) {
        align_the_stack();
        tiles::<Avx2, _>(self, first);
    }
}

impl<K: Kernel> Compiled for K {}

/// Runs a kernel on SSE2 tiles.
pub(super) fn with_baseline(kernel: &mut impl Kernel) {
    sse2_from(kernel, 0);
}

/// Runs a kernel on AVX2 tiles, or on SSE2 tiles where the machine has no AVX2.
pub(super) fn with_avx2(kernel: &mut impl Kernel) {
    avx2_from(kernel, 0);
}

/// Runs a kernel on AVX-512 tiles, or on AVX2 tiles where the machine has no AVX-512F.
pub(super) fn with_avx512(kernel: &mut impl Kernel) {
    let mut left = 0;
    if kernel.len() >= Avx512::WIDTH && std::arch::is_x86_feature_detected!("avx512f") {
        // SAFETY: the machine has AVX-512F.
        left = unsafe { kernel.avx512_tiles() };
    }
    avx2_from(kernel, left);
}

/// Runs a kernel from row `first` on. What each instruction set leaves over goes to the code of the
/// next narrower one, which is compiled once and not once more for those that it is left by.
fn avx2_from(kernel: &mut impl Kernel, first: usize) {
    let mut left = first;
    if kernel.len() >= first + Avx2::WIDTH && std::arch::is_x86_feature_detected!("avx2") {
        // SAFETY: the machine has AVX2.
        left = unsafe { kernel.avx2_tiles(first) };
    }
    sse2_from(kernel, left);
}

fn sse2_from(kernel: &mut impl Kernel, first: usize) {
    let mut left = first;
    if kernel.len() >= first + Sse2::WIDTH {
        left = kernel.sse2_tiles(first);
    }
    kernel.one_by_one(left);
}

/// Runs a kernel of whole blocks one by one: few machines are without AVX2, and each instruction
/// set more is half a minute of compiling.
pub(super) fn blocks_with_baseline(kernel: &mut impl Kernel) {
    kernel.one_by_one(0);
}

/// Runs a kernel of whole blocks on AVX2 tiles, or one by one where the machine has no AVX2.
pub(super) fn blocks_with_avx2(kernel: &mut impl Kernel) {
    avx2_blocks_from(kernel, 0);
}

/// Runs a kernel of whole blocks on AVX-512 tiles, and on AVX2 tiles the half of a block that they
/// leave over.
pub(super) fn blocks_with_avx512(kernel: &mut impl Kernel) {
    let mut left = 0;
    if kernel.len() >= Avx512::WIDTH && std::arch::is_x86_feature_detected!("avx512f") {
        // SAFETY: the machine has AVX-512F.
        left = unsafe { kernel.avx512_blocks() };
    }
    avx2_blocks_from(kernel, left);
}

fn avx2_blocks_from(kernel: &mut impl Kernel, first: usize) {
    if first >= kernel.len() {
        return;
    }
    if std::arch::is_x86_feature_detected!("avx2") {
        // SAFETY: the machine has AVX2.
        unsafe { kernel.avx2_blocks(first) }
    } else {
        kernel.one_by_one(first);
    }
}

/// Has the function that this is inlined into keep its stack at multiples of 64 bytes. The compiler
/// lets vectors that it runs out of registers for lie across cache lines otherwise, since it learns
/// too late that there are any.
#[inline(always)]
fn align_the_stack() {
    #[repr(align(64))]
    struct CacheLine(u8);
    std::hint::black_box(&mut CacheLine(0).0);
}

lane! {
    Avx2Four, f64, __m256d, __m256d, 4,
    _mm256_set1_pd, _mm256_loadu_pd, _mm256_storeu_pd, _mm256_add_pd, _mm256_sub_pd, _mm256_mul_pd, _mm256_div_pd,
    _mm256_sqrt_pd, _mm256_min_pd, _mm256_max_pd;
    neg: |n| _mm256_xor_pd(n, _mm256_set1_pd(-0.0)),
    lt: |a, b| _mm256_cmp_pd::<_CMP_LT_OQ>(a, b),
    select: |mask, t, f| _mm256_blendv_pd(f, t, mask),
    any: |m| _mm256_movemask_pd(m) != 0,
    all: |m| _mm256_movemask_pd(m) == 0b1111,
    exp2: |e| _mm256_castsi256_pd(_mm256_slli_epi64::<52>(_mm256_add_epi64(
        _mm256_cvtepi32_epi64(_mm256_cvttpd_epi32(e)),
        _mm256_set1_epi64x(1023),
    ))),
}

impl FourLane for Avx2Four {
    #[inline(always)]
    fn load(numbers: &Four) -> Self {
        Self::from_array(numbers)
    }

    #[inline(always)]
    fn store(self, numbers: &mut Four) {
        *numbers = self.to_array();
    }

    #[inline(always)]
    fn transpose([a, b, c, d]: [Self; 4]) -> [Self; 4] {
        // SAFETY: see the module.
        let [a, b, c, d] = unsafe { blocks::transpose_256d([a.0, b.0, c.0, d.0]) };
        [Self(a), Self(b), Self(c), Self(d)]
    }
}

lane! {
    Avx512Eight, f64, __m512d, __mmask8, 8,
    _mm512_set1_pd, _mm512_loadu_pd, _mm512_storeu_pd, _mm512_add_pd, _mm512_sub_pd, _mm512_mul_pd, _mm512_div_pd,
    _mm512_sqrt_pd, _mm512_min_pd, _mm512_max_pd;
    neg: |n| _mm512_castsi512_pd(_mm512_xor_si512(_mm512_castpd_si512(n), _mm512_set1_epi64(i64::MIN))),
    lt: |a, b| _mm512_cmp_pd_mask::<_CMP_LT_OQ>(a, b),
    select: |mask, t, f| _mm512_mask_blend_pd(mask, f, t),
    any: |m| _mm512_mask2int(m.into()) != 0,
    all: |m| _mm512_mask2int(m.into()) == 0xff,
    exp2: |e| _mm512_castsi512_pd(_mm512_slli_epi64::<52>(_mm512_add_epi64(
        _mm512_cvtepi32_epi64(_mm512_cvttpd_epi32(e)),
        _mm512_set1_epi64(1023),
    ))),
}

/// Eight numbers in double precision.
#[cfg(not(feature = "f64"))]
#[inline(always)]
fn widen_256(numbers: __m256) -> Pair<Avx2Four> {
    // SAFETY: see the module.
    unsafe {
        let (low, high) = (_mm256_castps256_ps128(numbers), _mm256_extractf128_ps::<1>(numbers));
        Pair(Avx2Four(_mm256_cvtps_pd(low)), Avx2Four(_mm256_cvtps_pd(high)))
    }
}

/// Sixteen numbers in double precision.
#[cfg(not(feature = "f64"))]
#[inline(always)]
fn widen_512(numbers: __m512) -> Pair<Avx512Eight> {
    // SAFETY: see the module.
    unsafe {
        let high = _mm256_castpd_ps(_mm512_extractf64x4_pd::<1>(_mm512_castps_pd(numbers)));
        Pair(Avx512Eight(_mm512_cvtps_pd(_mm512_castps512_ps256(numbers))), Avx512Eight(_mm512_cvtps_pd(high)))
    }
}

/// Runs a kernel of fours without AVX2.
pub(super) fn fours_with_baseline(kernel: impl FourKernel) {
    kernel.portably();
}

/// The code of a kernel of fours, [as of others](Compiled).
trait CompiledFours: FourKernel + Sized {
    /// # Safety
    /// The machine has AVX2.
    #[target_feature(enable = "avx2")]
    unsafe fn avx2_fours(self) {
        align_the_stack();
        self.run::<Avx2Four>();
    }
}

impl<K: FourKernel> CompiledFours for K {}

/// Runs a kernel of fours with AVX2, or without where the machine has none.
pub(super) fn fours_with_avx2(kernel: impl FourKernel) {
    if std::arch::is_x86_feature_detected!("avx2") {
        // SAFETY: the machine has AVX2.
        unsafe { kernel.avx2_fours() }
    } else {
        fours_with_baseline(kernel);
    }
}

#[cfg(not(feature = "f64"))]
mod single;

#[cfg(feature = "f64")]
mod double;

#[cfg(feature = "f64")]
use double::{Avx2, Avx512, Sse2};
#[cfg(not(feature = "f64"))]
use single::{Avx2, Avx512, Sse2};
