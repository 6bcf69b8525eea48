//! Tiles of double precision.

use super::*;

lane! {
    Sse2, f64, __m128d, __m128d, 2,
    _mm_set1_pd, _mm_loadu_pd, _mm_storeu_pd, _mm_add_pd, _mm_sub_pd, _mm_mul_pd, _mm_div_pd, _mm_sqrt_pd, _mm_min_pd, _mm_max_pd;
    neg: |n| _mm_xor_pd(n, _mm_set1_pd(-0.0)),
    lt: |a, b| _mm_cmplt_pd(a, b),
    select: |mask, t, f| _mm_or_pd(_mm_and_pd(mask, t), _mm_andnot_pd(mask, f)),
    any: |m| _mm_movemask_pd(m) != 0,
    all: |m| _mm_movemask_pd(m) == 0b11,
    // Biased exponents are positive, so zeros extend them to 64 bits.
    exp2: |e| _mm_castsi128_pd(_mm_slli_epi64::<52>(_mm_unpacklo_epi32(
        _mm_add_epi32(_mm_cvttpd_epi32(e), _mm_set1_epi32(1023)),
        _mm_setzero_si128(),
    ))),
}

tile! {
    Sse2, __m128d, 2, _mm_loadu_pd, _mm_storeu_pd,
    or: |x, y| _mm_or_pd(x, y),
    is_zero: |v| _mm_movemask_epi8(_mm_cmpeq_epi32(_mm_castpd_si128(v), _mm_setzero_si128())) == 0xffff,
    rows: row_blocks,
}

pub(super) use super::Avx2Four as Avx2;

tile! {
    Avx2, __m256d, 4, _mm256_loadu_pd, _mm256_storeu_pd,
    or: |x, y| _mm256_or_pd(x, y),
    is_zero: |v| _mm256_testz_si256(_mm256_castpd_si256(v), _mm256_castpd_si256(v)) == 1,
    rows: row_blocks,
}

pub(super) use super::Avx512Eight as Avx512;

tile! {
    Avx512, __m512d, 8, _mm512_loadu_pd, _mm512_storeu_pd,
    or: |x, y| _mm512_castsi512_pd(_mm512_or_si512(_mm512_castpd_si512(x), _mm512_castpd_si512(y))),
    is_zero: |v| _mm512_test_epi32_mask(_mm512_castpd_si512(v), _mm512_castpd_si512(v)) == 0,
    rows: wide,
}
