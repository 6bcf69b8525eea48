//! How SSE2 and AVX2 load and store blocks of rows.

use std::arch::x86_64::*;

use crate::math::Real;
use crate::simd::row_blocks::{Block, blocks};

#[cfg(not(feature = "f64"))]
blocks!(__m128, _mm_loadu_ps, _mm_storeu_ps, _mm_unpacklo_ps, _mm_unpackhi_ps);

#[cfg(feature = "f64")]
blocks!(__m128d, _mm_loadu_pd, _mm_storeu_pd, _mm_unpacklo_pd, _mm_unpackhi_pd);

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
    unsafe fn store4(numbers: [Self; 4], row: impl Fn(usize) -> *mut Real) {
        // SAFETY: the caller's promise.
        unsafe {
            let rows = transpose_256(numbers);
            let mut i = 0;
            while i < 4 {
                _mm_storeu_ps(row(i), _mm256_castps256_ps128(rows[i]));
                _mm_storeu_ps(row(i + 4), _mm256_extractf128_ps::<1>(rows[i]));
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
    unsafe fn store4(numbers: [Self; 4], row: impl Fn(usize) -> *mut Real) {
        // SAFETY: the caller's promise.
        unsafe {
            let rows = transpose_256d(numbers);
            _mm256_storeu_pd(row(0), rows[0]);
            _mm256_storeu_pd(row(1), rows[1]);
            _mm256_storeu_pd(row(2), rows[2]);
            _mm256_storeu_pd(row(3), rows[3]);
        }
    }
}

#[inline(always)]
pub(super) unsafe fn transpose_256d([a, b, c, d]: [__m256d; 4]) -> [__m256d; 4] {
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
