//! Tiles of single precision.

use super::*;
use crate::simd::four::PortableFour;

lane! {
    Sse2, f32, __m128, __m128, 4,
    _mm_set1_ps, _mm_loadu_ps, _mm_storeu_ps, _mm_add_ps, _mm_sub_ps, _mm_mul_ps, _mm_div_ps, _mm_sqrt_ps, _mm_min_ps, _mm_max_ps;
    neg: |n| _mm_xor_ps(n, _mm_set1_ps(-0.0)),
    lt: |a, b| _mm_cmplt_ps(a, b),
    select: |mask, t, f| _mm_or_ps(_mm_and_ps(mask, t), _mm_andnot_ps(mask, f)),
    any: |m| _mm_movemask_ps(m) != 0,
    all: |m| _mm_movemask_ps(m) == 0b1111,
    exp2: |e| _mm_castsi128_ps(_mm_slli_epi32::<23>(_mm_add_epi32(_mm_cvttps_epi32(e), _mm_set1_epi32(127)))),
}

tile! {
    Sse2, __m128, 4, _mm_loadu_ps, _mm_storeu_ps,
    or: |x, y| _mm_or_ps(x, y),
    is_zero: |v| _mm_movemask_epi8(_mm_cmpeq_epi32(_mm_castps_si128(v), _mm_setzero_si128())) == 0xffff,
    rows: row_blocks,
}

lane! {
    Avx2, f32, __m256, __m256, 8,
    _mm256_set1_ps, _mm256_loadu_ps, _mm256_storeu_ps, _mm256_add_ps, _mm256_sub_ps, _mm256_mul_ps, _mm256_div_ps,
    _mm256_sqrt_ps, _mm256_min_ps, _mm256_max_ps;
    neg: |n| _mm256_xor_ps(n, _mm256_set1_ps(-0.0)),
    lt: |a, b| _mm256_cmp_ps::<_CMP_LT_OQ>(a, b),
    select: |mask, t, f| _mm256_blendv_ps(f, t, mask),
    any: |m| _mm256_movemask_ps(m) != 0,
    all: |m| _mm256_movemask_ps(m) == 0xff,
    exp2: |e| _mm256_castsi256_ps(_mm256_slli_epi32::<23>(_mm256_add_epi32(
        _mm256_cvttps_epi32(e),
        _mm256_set1_epi32(127),
    ))),
}

tile! {
    Avx2, __m256, 8, _mm256_loadu_ps, _mm256_storeu_ps,
    or: |x, y| _mm256_or_ps(x, y),
    is_zero: |v| _mm256_testz_si256(_mm256_castps_si256(v), _mm256_castps_si256(v)) == 1,
    rows: row_blocks,
}

lane! {
    Avx512, f32, __m512, __mmask16, 16,
    _mm512_set1_ps, _mm512_loadu_ps, _mm512_storeu_ps, _mm512_add_ps, _mm512_sub_ps, _mm512_mul_ps, _mm512_div_ps,
    _mm512_sqrt_ps, _mm512_min_ps, _mm512_max_ps;
    neg: |n| _mm512_castsi512_ps(_mm512_xor_si512(_mm512_castps_si512(n), _mm512_set1_epi32(i32::MIN))),
    lt: |a, b| _mm512_cmp_ps_mask::<_CMP_LT_OQ>(a, b),
    select: |mask, t, f| _mm512_mask_blend_ps(mask, f, t),
    any: |m| _mm512_mask2int(m) != 0,
    all: |m| _mm512_mask2int(m) == 0xffff,
    exp2: |e| _mm512_castsi512_ps(_mm512_slli_epi32::<23>(_mm512_add_epi32(
        _mm512_cvttps_epi32(e),
        _mm512_set1_epi32(127),
    ))),
}

tile! {
    Avx512, __m512, 16, _mm512_loadu_ps, _mm512_storeu_ps,
    or: |x, y| _mm512_castsi512_ps(_mm512_or_si512(_mm512_castps_si512(x), _mm512_castps_si512(y))),
    is_zero: |v| _mm512_test_epi32_mask(_mm512_castps_si512(v), _mm512_castps_si512(v)) == 0,
    rows: wide,
}

widen_to_four!(Sse2, PortableFour);

impl Widen for Avx2 {
    type Double = Pair<Avx2Four>;

    #[inline(always)]
    fn widen(self) -> Self::Double {
        widen_256(self.0)
    }

    #[inline(always)]
    fn store_doubles(doubles: Self::Double, row: &mut [f64]) {
        row[..4].copy_from_slice(&doubles.0.to_array());
        row[4..8].copy_from_slice(&doubles.1.to_array());
    }
}

impl Widen for Avx512 {
    type Double = Pair<Avx512Eight>;

    #[inline(always)]
    fn widen(self) -> Self::Double {
        widen_512(self.0)
    }

    #[inline(always)]
    fn store_doubles(doubles: Self::Double, row: &mut [f64]) {
        row[..8].copy_from_slice(&doubles.0.to_array());
        row[8..16].copy_from_slice(&doubles.1.to_array());
    }
}
