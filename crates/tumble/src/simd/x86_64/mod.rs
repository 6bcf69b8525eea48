//! Tiles of SSE2, AVX2 and AVX-512.
//!
//! Intrinsics are `unsafe`: those of an instruction set may only run where the machine has it.
//! Tiles are private to this module, and the only way to one is a `with_*` function, whose caller
//! has looked.

#![allow(unsafe_code, reason = "intrinsics; see the SAFETY notes")]

use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Neg, Sub};

use tumble_math::lane::Lane;

use super::four::{Four, FourKernel, FourLane, PortableFour};
use super::pair::Pair;
use super::record::{numbers, set_numbers};
use super::{BLOCK, Eight, Kernel, Record, Tile, one_by_one, tiles};
use crate::math::Real;

mod blocks;
mod wide;

/// Widths of all tiles that are not pairs, as the functions below go through them.
pub(super) const WIDTHS: [usize; 4] = [Avx512::WIDTH, Avx2::WIDTH, Sse2::WIDTH, Real::WIDTH];

/// Runs a kernel on SSE2 tiles, which every x86-64 machine has.
pub(super) fn with_sse2(kernel: &mut impl Kernel) {
    sse2_from(kernel, 0);
}

/// Runs a kernel on AVX2 tiles, or on SSE2 tiles where the machine has no AVX2.
pub(super) fn with_avx2(kernel: &mut impl Kernel) {
    avx2_from(kernel, 0);
}

/// Runs a kernel on AVX-512 tiles, or on AVX2 tiles where the machine has no AVX-512F.
pub(super) fn with_avx512(kernel: &mut impl Kernel) {
    #[target_feature(enable = "avx512f")]
    fn enabled(kernel: &mut impl Kernel) -> usize {
        align_the_stack();
        let left = tiles::<Pair<Avx512>>(kernel, 0);
        tiles::<Avx512>(kernel, left)
    }
    let mut left = 0;
    if kernel.len() >= Avx512::WIDTH && std::arch::is_x86_feature_detected!("avx512f") {
        // SAFETY: the machine has AVX-512F.
        left = unsafe { enabled(kernel) };
    }
    avx2_from(kernel, left);
}

/// Runs a kernel from row `first` on. What each instruction set leaves over goes to the code of the
/// next narrower one, which is compiled once and not once more for those that it is left by.
fn avx2_from(kernel: &mut impl Kernel, first: usize) {
    #[target_feature(enable = "avx2")]
    fn enabled(kernel: &mut impl Kernel, first: usize) -> usize {
        align_the_stack();
        let left = tiles::<Pair<Avx2>>(kernel, first);
        tiles::<Avx2>(kernel, left)
    }
    let mut left = first;
    if kernel.len() >= first + Avx2::WIDTH && std::arch::is_x86_feature_detected!("avx2") {
        // SAFETY: the machine has AVX2.
        left = unsafe { enabled(kernel, first) };
    }
    sse2_from(kernel, left);
}

fn sse2_from(kernel: &mut impl Kernel, first: usize) {
    let mut left = first;
    if kernel.len() >= first + Sse2::WIDTH {
        left = tiles::<Sse2>(kernel, first);
    }
    one_by_one(kernel, left);
}

/// Runs a kernel of whole blocks on AVX2 tiles, or one by one where the machine has no AVX2.
pub(super) fn blocks_with_avx2(kernel: &mut impl Kernel) {
    #[target_feature(enable = "avx2")]
    fn enabled(kernel: &mut impl Kernel) {
        align_the_stack();
        tiles::<Avx2>(kernel, 0);
    }
    if std::arch::is_x86_feature_detected!("avx2") {
        // SAFETY: the machine has AVX2.
        unsafe { enabled(kernel) }
    } else {
        one_by_one(kernel, 0);
    }
}

/// Runs a kernel of whole blocks on AVX-512 tiles where they are as wide as a block, which they are
/// in double precision, else as if there were only AVX2.
pub(super) fn blocks_with_avx512(kernel: &mut impl Kernel) {
    #[cfg(feature = "f64")]
    #[target_feature(enable = "avx512f")]
    fn enabled(kernel: &mut impl Kernel) {
        align_the_stack();
        tiles::<Avx512>(kernel, 0);
    }
    #[cfg(feature = "f64")]
    if std::arch::is_x86_feature_detected!("avx512f") {
        // SAFETY: the machine has AVX-512F.
        return unsafe { enabled(kernel) };
    }
    blocks_with_avx2(kernel);
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

/// Declares a lane: its intrinsics, and the few operations that differ in more than a name.
macro_rules! lane {
    (
        $Tile:ident, $Number:ty, $Vector:ident, $Mask:ident, $width:literal,
        $set1:ident, $load:ident, $store:ident, $add:ident, $sub:ident, $mul:ident, $div:ident, $sqrt:ident, $min:ident, $max:ident,
        neg: |$n:ident| $neg:expr,
        lt: |$a:ident, $b:ident| $lt:expr,
        select: |$mask:ident, $if_true:ident, $if_false:ident| $select:expr,
        bits: |$m:ident| $bits:expr,
        exp2: |$e:ident| $exp2:expr,
    ) => {
        #[derive(Clone, Copy)]
        pub(super) struct $Tile($Vector);

        impl $Tile {
            #[inline(always)]
            fn from_array(numbers: &[$Number; $width]) -> Self {
                // SAFETY: the array has the size of the vector, and an unaligned load is used; for
                // the rest see the module.
                Self(unsafe { $load(numbers.as_ptr()) })
            }

            #[inline(always)]
            fn to_array(self) -> [$Number; $width] {
                let mut numbers = [0.0; $width];
                // SAFETY: the array has the size of the vector, and an unaligned store is used; for
                // the rest see the module.
                unsafe { $store(numbers.as_mut_ptr(), self.0) };
                numbers
            }
        }

        lane!(@operator $Tile, Add, add, $add);
        lane!(@operator $Tile, Sub, sub, $sub);
        lane!(@operator $Tile, Mul, mul, $mul);
        lane!(@operator $Tile, Div, div, $div);

        impl Neg for $Tile {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                let $n = self.0;
                // SAFETY: see the module.
                Self(unsafe { $neg })
            }
        }

        impl Lane for $Tile {
            type Mask = $Mask;

            const ROUNDING: f64 = <$Number as Lane>::ROUNDING;

            #[inline(always)]
            fn splat(value: f64) -> Self {
                // SAFETY: see the module.
                Self(unsafe { $set1(<$Number>::splat(value)) })
            }

            #[inline(always)]
            fn sqrt(self) -> Self {
                // SAFETY: see the module.
                Self(unsafe { $sqrt(self.0) })
            }

            #[inline(always)]
            fn lt(self, other: Self) -> $Mask {
                let ($a, $b) = (self.0, other.0);
                // SAFETY: see the module.
                unsafe { $lt }
            }

            #[inline(always)]
            fn select($mask: $Mask, if_true: Self, if_false: Self) -> Self {
                let ($if_true, $if_false) = (if_true.0, if_false.0);
                // SAFETY: see the module.
                Self(unsafe { $select })
            }

            // The instructions too give the second where a number is none or both are zero.
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                // SAFETY: see the module.
                Self(unsafe { $min(self.0, other.0) })
            }

            #[inline(always)]
            fn max(self, other: Self) -> Self {
                // SAFETY: see the module.
                Self(unsafe { $max(self.0, other.0) })
            }

            #[inline(always)]
            fn any($m: $Mask) -> bool {
                // SAFETY: see the module.
                let bits = unsafe { $bits } as u32;
                bits != 0
            }

            #[inline(always)]
            fn all($m: $Mask) -> bool {
                // SAFETY: see the module.
                let bits = unsafe { $bits } as u32;
                bits == (1 << $width) - 1
            }

            #[inline(always)]
            fn exp2_of_integer(self) -> Self {
                let $e = self.0;
                // SAFETY: see the module.
                Self(unsafe { $exp2 })
            }

            #[inline(always)]
            fn sin_cos(self) -> (Self, Self) {
                let (mut sines, mut cosines) = (self.to_array(), [0.0; $width]);
                for (sine, cosine) in sines.iter_mut().zip(&mut cosines) {
                    (*sine, *cosine) = <$Number as Lane>::sin_cos(*sine);
                }
                (Self::from_array(&sines), Self::from_array(&cosines))
            }
        }
    };
    (@operator $Tile:ident, $Operator:ident, $method:ident, $intrinsic:ident) => {
        impl $Operator for $Tile {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: see the module.
                Self(unsafe { $intrinsic(self.0, other.0) })
            }
        }
    };
}

/// Makes a tile of a lane of the build's numbers.
macro_rules! tile {
    (
        $Tile:ident, $Vector:ident, $width:literal, $load:ident, $store:ident,
        or: |$x:ident, $y:ident| $or:expr,
        is_zero: |$v:ident| $is_zero:expr,
        rows: $rows:ident,
    ) => {
        impl Tile for $Tile {
            const WIDTH: usize = $width;

            #[inline(always)]
            fn load<R: Record, const N: usize>(rows: &[R]) -> [Self; N] {
                let rows = &rows[..$width];
                let mut tiles = [Self::splat(0.0); N];
                if R::STRIDE == 1 {
                    // SAFETY: as many numbers behind each other as the tile is wide; for the rest
                    // see the module.
                    tiles[0] = Self(unsafe { $load(rows.as_ptr().cast()) });
                } else if $rows::transposes::<R, N>() {
                    // SAFETY: as many rows as the tile is wide, of at least N numbers each; for the
                    // rest see the module.
                    let vectors: [$Vector; N] = unsafe { $rows::load_rows(rows.as_ptr().cast(), R::STRIDE) };
                    let mut c = 0;
                    while c < N {
                        tiles[c] = Self(vectors[c]);
                        c += 1;
                    }
                } else {
                    let mut c = 0;
                    while c < N {
                        let mut lanes = [0.0; $width];
                        for (lane, row) in lanes.iter_mut().zip(rows) {
                            *lane = numbers::<R, N>(row)[c];
                        }
                        tiles[c] = Self::from_array(&lanes);
                        c += 1;
                    }
                }
                tiles
            }

            #[inline(always)]
            fn gather<const N: usize>(rows: &[&Eight; BLOCK]) -> [Self; N] {
                const { assert!($width <= BLOCK && N >= 4) };
                // SAFETY: see the module.
                let vectors: [$Vector; N] = unsafe { $rows::gather_rows(rows) };
                let mut tiles = [Self(vectors[0]); N];
                let mut c = 1;
                while c < N {
                    tiles[c] = Self(vectors[c]);
                    c += 1;
                }
                tiles
            }

            #[inline(always)]
            fn store<R: Record, const N: usize>(tiles: [Self; N], rows: &mut [R]) {
                let rows = &mut rows[..$width];
                if R::STRIDE == 1 {
                    // SAFETY: as many numbers behind each other as the tile is wide; for the rest
                    // see the module.
                    unsafe { $store(rows.as_mut_ptr().cast(), tiles[0].0) };
                } else if $rows::transposes::<R, N>() {
                    let mut vectors = [tiles[0].0; N];
                    let mut c = 1;
                    while c < N {
                        vectors[c] = tiles[c].0;
                        c += 1;
                    }
                    // SAFETY: as many rows as the tile is wide, of at least N numbers each; for the
                    // rest see the module.
                    unsafe { $rows::store_rows(vectors, rows.as_mut_ptr().cast(), R::STRIDE) };
                } else {
                    let mut lanes = [[0.0; $width]; N];
                    let mut c = 0;
                    while c < N {
                        lanes[c] = tiles[c].to_array();
                        c += 1;
                    }
                    for (i, row) in rows.iter_mut().enumerate() {
                        set_numbers::<R, N>(row, std::array::from_fn(|c| lanes[c][i]));
                    }
                }
            }

            #[inline(always)]
            fn are_zero<const N: usize>(numbers: [Self; N]) -> bool {
                let mut $v = numbers[0].0;
                let mut c = 1;
                while c < N {
                    let ($x, $y) = ($v, numbers[c].0);
                    // SAFETY: see the module.
                    $v = unsafe { $or };
                    c += 1;
                }
                // SAFETY: see the module.
                unsafe { $is_zero }
            }
        }
    };
}

lane! {
    Avx2Four, f64, __m256d, __m256d, 4,
    _mm256_set1_pd, _mm256_loadu_pd, _mm256_storeu_pd, _mm256_add_pd, _mm256_sub_pd, _mm256_mul_pd, _mm256_div_pd,
    _mm256_sqrt_pd, _mm256_min_pd, _mm256_max_pd,
    neg: |n| _mm256_xor_pd(n, _mm256_set1_pd(-0.0)),
    lt: |a, b| _mm256_cmp_pd::<_CMP_LT_OQ>(a, b),
    select: |mask, t, f| _mm256_blendv_pd(f, t, mask),
    bits: |m| _mm256_movemask_pd(m),
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
}

/// Runs a kernel of fours with AVX2, or without where the machine has none.
pub(super) fn fours_with_avx2(kernel: impl FourKernel) {
    #[target_feature(enable = "avx2")]
    fn enabled(kernel: impl FourKernel) {
        align_the_stack();
        kernel.run::<Avx2Four>();
    }
    if std::arch::is_x86_feature_detected!("avx2") {
        // SAFETY: the machine has AVX2.
        unsafe { enabled(kernel) }
    } else {
        kernel.run::<PortableFour>();
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
