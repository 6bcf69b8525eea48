//! Transposes of SSE2 and AVX2 tiles: rows are read and written in blocks of four numbers.
//!
//! A row of more than four numbers is two blocks that may overlap, so no number outside the row is
//! touched.

use std::arch::x86_64::*;

use super::Record;
use crate::math::Real;
use crate::simd::{BLOCK, Eight};

/// How a vector type loads and stores one block of as many rows as it has lanes.
///
/// # Safety
/// `row` says where each row's block begins, or the first one is at `base` and the others `stride`
/// numbers apart; the blocks of as many rows as there are lanes must be readable (writable), and
/// the machine must have the instruction set.
pub(super) trait Block: Sized + Copy {
    unsafe fn load4(row: impl Fn(usize) -> *const Real) -> [Self; 4];
    unsafe fn store4(numbers: [Self; 4], base: *mut Real, stride: usize);
}

/// Four by four, in place.
#[cfg(not(feature = "f64"))]
impl Block for __m128 {
    #[inline(always)]
    unsafe fn load4(row: impl Fn(usize) -> *const Real) -> [Self; 4] {
        // SAFETY: the caller's promise.
        unsafe {
            transpose_128([_mm_loadu_ps(row(0)), _mm_loadu_ps(row(1)), _mm_loadu_ps(row(2)), _mm_loadu_ps(row(3))])
        }
    }

    #[inline(always)]
    unsafe fn store4(numbers: [Self; 4], base: *mut Real, stride: usize) {
        // SAFETY: the caller's promise.
        unsafe {
            let rows = transpose_128(numbers);
            _mm_storeu_ps(base, rows[0]);
            _mm_storeu_ps(base.add(stride), rows[1]);
            _mm_storeu_ps(base.add(2 * stride), rows[2]);
            _mm_storeu_ps(base.add(3 * stride), rows[3]);
        }
    }
}

#[cfg(not(feature = "f64"))]
#[inline(always)]
unsafe fn transpose_128([a, b, c, d]: [__m128; 4]) -> [__m128; 4] {
    // SAFETY: SSE2 is part of x86-64.
    unsafe {
        let (ab_low, ab_high) = (_mm_unpacklo_ps(a, b), _mm_unpackhi_ps(a, b));
        let (cd_low, cd_high) = (_mm_unpacklo_ps(c, d), _mm_unpackhi_ps(c, d));
        [
            _mm_movelh_ps(ab_low, cd_low),
            _mm_movehl_ps(cd_low, ab_low),
            _mm_movelh_ps(ab_high, cd_high),
            _mm_movehl_ps(cd_high, ab_high),
        ]
    }
}

/// Rows i and i + 4 share a vector.
#[cfg(not(feature = "f64"))]
impl Block for __m256 {
    #[inline(always)]
    unsafe fn load4(row: impl Fn(usize) -> *const Real) -> [Self; 4] {
        // SAFETY: the caller's promise.
        unsafe {
            transpose_256([
                two_rows(row(0), row(4)),
                two_rows(row(1), row(5)),
                two_rows(row(2), row(6)),
                two_rows(row(3), row(7)),
            ])
        }
    }

    #[inline(always)]
    unsafe fn store4(numbers: [Self; 4], base: *mut Real, stride: usize) {
        // SAFETY: the caller's promise.
        unsafe {
            let rows = transpose_256(numbers);
            let mut i = 0;
            while i < 4 {
                _mm_storeu_ps(base.add(i * stride), _mm256_castps256_ps128(rows[i]));
                _mm_storeu_ps(base.add((i + 4) * stride), _mm256_extractf128_ps::<1>(rows[i]));
                i += 1;
            }
        }
    }
}

/// A row, and in the upper half another.
#[cfg(not(feature = "f64"))]
#[inline(always)]
unsafe fn two_rows(lower: *const Real, upper: *const Real) -> __m256 {
    // SAFETY: the caller has AVX2, and both rows are readable.
    unsafe { _mm256_insertf128_ps::<1>(_mm256_castps128_ps256(_mm_loadu_ps(lower)), _mm_loadu_ps(upper)) }
}

/// Four by four within each half.
#[cfg(not(feature = "f64"))]
#[inline(always)]
unsafe fn transpose_256([a, b, c, d]: [__m256; 4]) -> [__m256; 4] {
    // SAFETY: the caller has AVX2.
    unsafe {
        let (ab_low, ab_high) = (_mm256_unpacklo_ps(a, b), _mm256_unpackhi_ps(a, b));
        let (cd_low, cd_high) = (_mm256_unpacklo_ps(c, d), _mm256_unpackhi_ps(c, d));
        [
            _mm256_shuffle_ps::<0b01_00_01_00>(ab_low, cd_low),
            _mm256_shuffle_ps::<0b11_10_11_10>(ab_low, cd_low),
            _mm256_shuffle_ps::<0b01_00_01_00>(ab_high, cd_high),
            _mm256_shuffle_ps::<0b11_10_11_10>(ab_high, cd_high),
        ]
    }
}

/// Two rows, each in two vectors.
#[cfg(feature = "f64")]
impl Block for __m128d {
    #[inline(always)]
    unsafe fn load4(row: impl Fn(usize) -> *const Real) -> [Self; 4] {
        // SAFETY: the caller's promise.
        unsafe {
            let low = (_mm_loadu_pd(row(0)), _mm_loadu_pd(row(1)));
            let high = (_mm_loadu_pd(row(0).add(2)), _mm_loadu_pd(row(1).add(2)));
            [
                _mm_unpacklo_pd(low.0, low.1),
                _mm_unpackhi_pd(low.0, low.1),
                _mm_unpacklo_pd(high.0, high.1),
                _mm_unpackhi_pd(high.0, high.1),
            ]
        }
    }

    #[inline(always)]
    unsafe fn store4([a, b, c, d]: [Self; 4], base: *mut Real, stride: usize) {
        // SAFETY: the caller's promise.
        unsafe {
            _mm_storeu_pd(base, _mm_unpacklo_pd(a, b));
            _mm_storeu_pd(base.add(2), _mm_unpacklo_pd(c, d));
            _mm_storeu_pd(base.add(stride), _mm_unpackhi_pd(a, b));
            _mm_storeu_pd(base.add(stride + 2), _mm_unpackhi_pd(c, d));
        }
    }
}

/// Four by four.
#[cfg(feature = "f64")]
impl Block for __m256d {
    #[inline(always)]
    unsafe fn load4(row: impl Fn(usize) -> *const Real) -> [Self; 4] {
        // SAFETY: the caller's promise.
        unsafe {
            transpose_256d([
                _mm256_loadu_pd(row(0)),
                _mm256_loadu_pd(row(1)),
                _mm256_loadu_pd(row(2)),
                _mm256_loadu_pd(row(3)),
            ])
        }
    }

    #[inline(always)]
    unsafe fn store4(numbers: [Self; 4], base: *mut Real, stride: usize) {
        // SAFETY: the caller's promise.
        unsafe {
            let rows = transpose_256d(numbers);
            _mm256_storeu_pd(base, rows[0]);
            _mm256_storeu_pd(base.add(stride), rows[1]);
            _mm256_storeu_pd(base.add(2 * stride), rows[2]);
            _mm256_storeu_pd(base.add(3 * stride), rows[3]);
        }
    }
}

#[cfg(feature = "f64")]
#[inline(always)]
unsafe fn transpose_256d([a, b, c, d]: [__m256d; 4]) -> [__m256d; 4] {
    // SAFETY: the caller has AVX2.
    unsafe {
        let (ab_even, ab_odd) = (_mm256_unpacklo_pd(a, b), _mm256_unpackhi_pd(a, b));
        let (cd_even, cd_odd) = (_mm256_unpacklo_pd(c, d), _mm256_unpackhi_pd(c, d));
        [
            _mm256_permute2f128_pd::<0x20>(ab_even, cd_even),
            _mm256_permute2f128_pd::<0x20>(ab_odd, cd_odd),
            _mm256_permute2f128_pd::<0x31>(ab_even, cd_even),
            _mm256_permute2f128_pd::<0x31>(ab_odd, cd_odd),
        ]
    }
}

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
    // SAFETY: both blocks lie within the row, and the caller's promise.
    unsafe {
        V::store4([v[0], v[1], v[2], v[3]], base, stride);
        if N > 4 {
            V::store4([v[N - 4], v[N - 3], v[N - 2], v[N - 1]], base.add(N - 4), stride);
        }
    }
}
