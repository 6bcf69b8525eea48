//! Transposes of AVX-512 tiles: rows are read and written as whole vectors, and sorted by
//! permutations of two vectors.
//!
//! With W lanes, rows of a power of two numbers are unzipped: vectors next to each other give their
//! even and their odd units, halving the unit from half a row to one number. Rows of six need fewer
//! permutations: in the 3 W numbers of W/2 rows the first and second number of every row, taken
//! modulo W, fall on different lanes, likewise the third and fourth, the fifth and sixth. So two
//! blends collect each pair of numbers, and one permutation of the two halves' blends gives each
//! number of W rows.

use std::arch::x86_64::_mm512_loadu_si512;
#[cfg(not(feature = "f64"))]
use std::arch::x86_64::{
    _mm256_loadu_pd, _mm256_storeu_pd, _mm512_castpd_ps, _mm512_castpd256_pd512, _mm512_castpd512_pd256,
    _mm512_castps_pd, _mm512_extractf64x4_pd, _mm512_insertf64x4,
};

use super::Record;
use crate::math::Real;
use crate::simd::{BLOCK, Eight};

#[cfg(not(feature = "f64"))]
mod precision {
    pub(super) use std::arch::x86_64::{
        __m512 as Vector, __mmask16 as Mask, _mm512_loadu_ps as load, _mm512_mask_blend_ps as blend,
        _mm512_mask_storeu_ps as store_some, _mm512_maskz_loadu_ps as load_some, _mm512_permutex2var_ps as permute,
        _mm512_storeu_ps as store,
    };

    pub(super) type Index = i32;
    pub(super) const WIDTH: usize = 16;
}

#[cfg(feature = "f64")]
mod precision {
    pub(super) use std::arch::x86_64::{
        __m512d as Vector, __mmask8 as Mask, _mm512_loadu_pd as load, _mm512_mask_blend_pd as blend,
        _mm512_mask_storeu_pd as store_some, _mm512_maskz_loadu_pd as load_some, _mm512_permutex2var_pd as permute,
        _mm512_storeu_pd as store,
    };

    pub(super) type Index = i64;
    pub(super) const WIDTH: usize = 8;
}

use precision::{Index, Mask, Vector, WIDTH, blend, load, load_some, permute, store, store_some};

type Table = [Index; WIDTH];

/// For each lane, where to take its number from: the position in two vectors behind each other.
const fn table(unit: usize, odd: bool, zip: bool) -> Table {
    let mut table = [0; WIDTH];
    let mut lane = 0;
    while lane < WIDTH {
        let position = if zip { lane + if odd { WIDTH } else { 0 } } else { lane };
        let (block, offset) = (position / unit, position % unit);
        let from = if zip {
            (block % 2) * WIDTH + (block / 2) * unit + offset
        } else {
            (2 * block + if odd { 1 } else { 0 }) * unit + offset
        };
        table[lane] = from as Index;
        lane += 1;
    }
    table
}

/// The tables of one unit \[numbers\].
struct Unit<const U: usize>;

impl<const U: usize> Unit<U> {
    const EVEN: Table = table(U, false, false);
    const ODD: Table = table(U, true, false);
    const LOW: Table = table(U, false, true);
    const HIGH: Table = table(U, true, true);
}

/// # Safety
/// The machine has AVX-512F.
#[inline(always)]
unsafe fn permuted(a: Vector, b: Vector, table: &Table) -> Vector {
    // SAFETY: the table has the size of a vector.
    unsafe { permute(a, _mm512_loadu_si512(table.as_ptr().cast()), b) }
}

/// Even units, then odd units, of vectors in groups.
///
/// # Safety
/// The machine has AVX-512F.
#[inline(always)]
unsafe fn unzip<const S: usize, const U: usize>(v: [Vector; S]) -> [Vector; S] {
    let mut unzipped = v;
    let mut k = 0;
    while k < S {
        let (start, within) = (k / (2 * U) * (2 * U), k % (2 * U));
        let pair = start + 2 * (within % U);
        let table = if within < U { &Unit::<U>::EVEN } else { &Unit::<U>::ODD };
        // SAFETY: the caller's promise.
        unzipped[k] = unsafe { permuted(v[pair], v[pair + 1], table) };
        k += 1;
    }
    unzipped
}

/// The inverse of [`unzip`].
///
/// # Safety
/// The machine has AVX-512F.
#[inline(always)]
unsafe fn zip<const S: usize, const U: usize>(v: [Vector; S]) -> [Vector; S] {
    let mut zipped = v;
    let mut k = 0;
    while k < S {
        let (start, within) = (k / (2 * U) * (2 * U), k % (2 * U));
        let even = start + within / 2;
        let table = if within % 2 == 0 { &Unit::<U>::LOW } else { &Unit::<U>::HIGH };
        // SAFETY: the caller's promise.
        zipped[k] = unsafe { permuted(v[even], v[even + U], table) };
        k += 1;
    }
    zipped
}

/// The numbers of rows that are `S` numbers long, `S` a power of two up to eight.
///
/// # Safety
/// The machine has AVX-512F.
#[inline(always)]
unsafe fn unzip_rows<const S: usize>(mut v: [Vector; S]) -> [Vector; S] {
    // SAFETY: the caller's promise.
    unsafe {
        if S == 8 {
            v = unzip::<S, 4>(v);
        }
        if S >= 4 {
            v = unzip::<S, 2>(v);
        }
        unzip::<S, 1>(v)
    }
}

/// The inverse of [`unzip_rows`].
///
/// # Safety
/// The machine has AVX-512F.
#[inline(always)]
unsafe fn zip_rows<const S: usize>(v: [Vector; S]) -> [Vector; S] {
    // SAFETY: the caller's promise.
    unsafe {
        let mut v = zip::<S, 1>(v);
        if S >= 4 {
            v = zip::<S, 2>(v);
        }
        if S == 8 {
            v = zip::<S, 4>(v);
        }
        v
    }
}

/// In vector `vector` of three that hold W/2 rows of six, the lanes with number `2 pair` or
/// `2 pair + 1` of a row.
const fn lanes_of_pair(vector: usize, pair: usize) -> Mask {
    let mut mask = 0;
    let mut lane = 0;
    while lane < WIDTH {
        if (vector * WIDTH + lane) % 6 / 2 == pair {
            mask |= 1 << lane;
        }
        lane += 1;
    }
    mask
}

/// For row i, the lane on which blending leaves number `c`; of the second half of the rows behind
/// the first vector.
const fn lanes_of_number(c: usize) -> Table {
    let mut table = [0; WIDTH];
    let mut row = 0;
    while row < WIDTH {
        let half = row / (WIDTH / 2);
        table[row] = (half * WIDTH + (6 * (row % (WIDTH / 2)) + c) % WIDTH) as Index;
        row += 1;
    }
    table
}

/// For each lane of a blended vector, where its number comes from: a row's even number from the
/// first vector, its odd one from the second.
const fn rows_on_lanes(pair: usize, half: usize) -> Table {
    let mut table = [0; WIDTH];
    let mut row = 0;
    while row < WIDTH / 2 {
        let mut odd = 0;
        while odd < 2 {
            let lane = (6 * row + 2 * pair + odd) % WIDTH;
            table[lane] = (odd * WIDTH + half * (WIDTH / 2) + row) as Index;
            odd += 1;
        }
        row += 1;
    }
    table
}

const NUMBERS: [Table; 6] = [
    lanes_of_number(0),
    lanes_of_number(1),
    lanes_of_number(2),
    lanes_of_number(3),
    lanes_of_number(4),
    lanes_of_number(5),
];
const ROWS: [[Table; 2]; 3] = [
    [rows_on_lanes(0, 0), rows_on_lanes(0, 1)],
    [rows_on_lanes(1, 0), rows_on_lanes(1, 1)],
    [rows_on_lanes(2, 0), rows_on_lanes(2, 1)],
];
/// By vector, then by pair.
const PAIRS: [[Mask; 3]; 3] = [
    [lanes_of_pair(0, 0), lanes_of_pair(0, 1), lanes_of_pair(0, 2)],
    [lanes_of_pair(1, 0), lanes_of_pair(1, 1), lanes_of_pair(1, 2)],
    [lanes_of_pair(2, 0), lanes_of_pair(2, 1), lanes_of_pair(2, 2)],
];

/// The numbers of W rows of six that lie in six vectors.
///
/// # Safety
/// The machine has AVX-512F.
#[inline(always)]
unsafe fn split_sixes(v: [Vector; 6]) -> [Vector; 6] {
    let mut numbers = v;
    let mut pair = 0;
    while pair < 3 {
        let (second, third) = (PAIRS[1][pair], PAIRS[2][pair]);
        // SAFETY: the caller's promise.
        unsafe {
            let first_half = blend(third, blend(second, v[0], v[1]), v[2]);
            let second_half = blend(third, blend(second, v[3], v[4]), v[5]);
            numbers[2 * pair] = permuted(first_half, second_half, &NUMBERS[2 * pair]);
            numbers[2 * pair + 1] = permuted(first_half, second_half, &NUMBERS[2 * pair + 1]);
        }
        pair += 1;
    }
    numbers
}

/// The inverse of [`split_sixes`].
///
/// # Safety
/// The machine has AVX-512F.
#[inline(always)]
unsafe fn join_sixes(v: [Vector; 6]) -> [Vector; 6] {
    let mut rows = v;
    let mut half = 0;
    while half < 2 {
        // SAFETY: the caller's promise.
        unsafe {
            let first = permuted(v[0], v[1], &ROWS[0][half]);
            let second = permuted(v[2], v[3], &ROWS[1][half]);
            let third = permuted(v[4], v[5], &ROWS[2][half]);
            let mut vector = 0;
            while vector < 3 {
                let two = blend(PAIRS[vector][1], first, second);
                rows[3 * half + vector] = blend(PAIRS[vector][2], two, third);
                vector += 1;
            }
        }
        half += 1;
    }
    rows
}

/// # Safety
/// `S` vectors of memory must be readable, and the machine must have AVX-512F.
#[inline(always)]
unsafe fn load_all<const S: usize>(base: *const Real) -> [Vector; S] {
    // SAFETY: the caller's promise.
    let mut v = [unsafe { load(base) }; S];
    let mut k = 1;
    while k < S {
        // SAFETY: the caller's promise.
        v[k] = unsafe { load(base.add(k * WIDTH)) };
        k += 1;
    }
    v
}

/// The rows of `N` numbers that take eight lanes each.
///
/// # Safety
/// As for [`load_rows`].
#[inline(always)]
unsafe fn load_eights<const N: usize>(base: *const Real, stride: usize) -> [Vector; 8] {
    // SAFETY: the caller's promise.
    let mut v = [unsafe { load_some(lanes_of_rows::<N>(), base) }; 8];
    let mut k = 1;
    while k < 8 {
        // SAFETY: the caller's promise.
        v[k] = unsafe { load_some(lanes_of_rows::<N>(), base.add(k * (WIDTH / 8) * stride)) };
        k += 1;
    }
    v
}

/// Whether there is a transpose for such rows.
pub(super) const fn transposes<R: Record, const N: usize>() -> bool {
    match R::STRIDE {
        1 | 2 | 4 | 6 => N == R::STRIDE,
        // A row of seven has a vector of its own in double precision.
        stride => N > 4 && (stride == 8 || stride == 7 && WIDTH == 8),
    }
}

/// Loads the first `N` numbers of as many rows as there are lanes.
///
/// # Safety
/// The rows, `stride` numbers long, must be readable but for padding after the `N` numbers, and the
/// machine must have AVX-512F.
#[inline(always)]
pub(super) unsafe fn load_rows<const N: usize>(base: *const Real, stride: usize) -> [Vector; N] {
    // SAFETY: whole vectors of rows without padding are read, else only the lanes that hold
    // numbers; and the caller's promise.
    unsafe {
        match (N, stride) {
            (1, 1) => [load(base); N],
            (2, 2) => first(unzip_rows::<2>(load_all(base))),
            (4, 4) => first(unzip_rows::<4>(load_all(base))),
            (6, 6) => first(split_sixes(load_all(base))),
            _ => first(unzip_rows::<8>(load_eights::<N>(base, stride))),
        }
    }
}

/// Loads the first `N` numbers of rows that are anywhere.
///
/// # Safety
/// The machine has AVX-512F.
#[inline(always)]
pub(super) unsafe fn gather_rows<const N: usize>(rows: &[&Eight; BLOCK]) -> [Vector; N] {
    // SAFETY: the caller's promise.
    let mut v = [unsafe { joined(rows, 0) }; 8];
    let mut k = 1;
    while k < 8 {
        // SAFETY: as before.
        v[k] = unsafe { joined(rows, k) };
        k += 1;
    }
    // SAFETY: the caller's promise.
    first(unsafe { unzip_rows::<8>(v) })
}

/// The rows that vector `k` has: two of them.
///
/// # Safety
/// The machine has AVX-512F.
#[cfg(not(feature = "f64"))]
#[inline(always)]
unsafe fn joined(rows: &[&Eight; BLOCK], k: usize) -> Vector {
    // SAFETY: a row of eight is as long as half a vector; and the caller's promise.
    unsafe {
        let low = _mm256_loadu_pd(rows[2 * k].0.as_ptr().cast());
        let high = _mm256_loadu_pd(rows[2 * k + 1].0.as_ptr().cast());
        _mm512_castpd_ps(_mm512_insertf64x4::<1>(_mm512_castpd256_pd512(low), high))
    }
}

/// The row that vector `k` has.
///
/// # Safety
/// The machine has AVX-512F.
#[cfg(feature = "f64")]
#[inline(always)]
unsafe fn joined(rows: &[&Eight; BLOCK], k: usize) -> Vector {
    // SAFETY: a row of eight is as long as a vector; and the caller's promise.
    unsafe { load(rows[k].0.as_ptr()) }
}

/// The inverse of [`joined`].
///
/// # Safety
/// The machine has AVX-512F.
#[cfg(not(feature = "f64"))]
#[inline(always)]
unsafe fn part(vector: Vector, rows: &mut [&mut Eight; BLOCK], k: usize) {
    // SAFETY: a row of eight is as long as half a vector; and the caller's promise.
    unsafe {
        let both = _mm512_castps_pd(vector);
        _mm256_storeu_pd(rows[2 * k].0.as_mut_ptr().cast(), _mm512_castpd512_pd256(both));
        _mm256_storeu_pd(rows[2 * k + 1].0.as_mut_ptr().cast(), _mm512_extractf64x4_pd::<1>(both));
    }
}

/// The inverse of [`joined`].
///
/// # Safety
/// The machine has AVX-512F.
#[cfg(feature = "f64")]
#[inline(always)]
unsafe fn part(vector: Vector, rows: &mut [&mut Eight; BLOCK], k: usize) {
    // SAFETY: a row of eight is as long as a vector; and the caller's promise.
    unsafe { store(rows[k].0.as_mut_ptr(), vector) };
}

/// Stores what [`load_rows`] loads.
///
/// # Safety
/// The rows, `stride` numbers long, must be writable, and the machine must have AVX-512F.
#[inline(always)]
pub(super) unsafe fn store_rows<const N: usize>(numbers: [Vector; N], base: *mut Real, stride: usize) {
    // SAFETY: whole vectors of rows without padding are written, else only the lanes that hold
    // numbers; and the caller's promise.
    unsafe {
        match (N, stride) {
            (1, 1) => store(base, numbers[0]),
            (2, 2) => store_all(zip_rows::<2>(first(numbers)), base),
            (4, 4) => store_all(zip_rows::<4>(first(numbers)), base),
            (6, 6) => store_all(join_sixes(first(numbers)), base),
            _ => {
                let rows = zip_rows::<8>(first(numbers));
                let mut k = 0;
                while k < 8 {
                    store_some(base.add(k * (WIDTH / 8) * stride), lanes_of_rows::<N>(), rows[k]);
                    k += 1;
                }
            }
        }
    }
}

/// Stores rows of eight that are anywhere.
///
/// # Safety
/// The machine has AVX-512F.
#[inline(always)]
pub(super) unsafe fn scatter_rows<const N: usize>(numbers: [Vector; N], rows: &mut [&mut Eight; BLOCK]) {
    const { assert!(WIDTH <= BLOCK && N == 8) };
    // SAFETY: the caller's promise.
    let vectors = unsafe { zip_rows::<8>(first(numbers)) };
    let mut k = 0;
    while k < 8 {
        // SAFETY: the caller's promise.
        unsafe { part(vectors[k], rows, k) };
        k += 1;
    }
}

/// The lanes that hold numbers where every row has `N` of them and takes eight lanes.
#[inline(always)]
const fn lanes_of_rows<const N: usize>() -> Mask {
    let mut mask = 0;
    let mut lane = 0;
    while lane < WIDTH {
        if lane % 8 < N {
            mask |= 1 << lane;
        }
        lane += 1;
    }
    mask
}

/// # Safety
/// `S` vectors of memory must be writable, and the machine must have AVX-512F.
#[inline(always)]
unsafe fn store_all<const S: usize>(v: [Vector; S], base: *mut Real) {
    let mut k = 0;
    while k < S {
        // SAFETY: the caller's promise.
        unsafe { store(base.add(k * WIDTH), v[k]) };
        k += 1;
    }
}

/// The first `N` of the vectors, or all of them and the last one again.
#[inline(always)]
fn first<const S: usize, const N: usize>(v: [Vector; S]) -> [Vector; N] {
    let mut chosen = [v[0]; N];
    let mut c = 1;
    while c < N {
        chosen[c] = v[if c < S { c } else { S - 1 }];
        c += 1;
    }
    chosen
}
