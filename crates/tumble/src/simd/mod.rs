//! Vector code: tiles of bodies side by side, and the choice of instruction set while the program
//! runs.
//!
//! A kernel is written once, generic over [`Tile`]. [`dispatch`] instantiates it for every
//! instruction set the machine may have and runs the widest that it has. All tiles do the same
//! correctly rounded operations in the same order, so the bits are the same with any of them; one
//! body at a time is the reference.
//!
//! `TUMBLE_SIMD=scalar|baseline|avx2|avx512` in the environment forces a choice that the machine
//! can run.

use std::env;
use std::sync::OnceLock;

use tumble_math::lane::Lane;

use crate::math::Real;

pub(crate) mod block_lanes;
mod four;
#[cfg(vector_code)]
mod intrinsics;
#[cfg(vector_code)]
mod pair;
mod record;
#[cfg(vector_code)]
mod row_blocks;
mod rows;
#[cfg(test)]
mod tests;
mod widen;

#[cfg(all(vector_code, target_arch = "aarch64"))]
mod aarch64;
#[cfg(all(vector_code, target_arch = "wasm32"))]
mod wasm32;
#[cfg(all(vector_code, target_arch = "x86_64"))]
mod x86_64;

#[cfg(all(vector_code, target_arch = "aarch64"))]
use aarch64 as target;
#[cfg(all(vector_code, target_arch = "wasm32"))]
use wasm32 as target;
#[cfg(all(vector_code, target_arch = "x86_64"))]
use x86_64 as target;

pub(crate) use four::{Four, FourKernel, FourLane};
use record::Eight;
pub(crate) use record::{
    NumberField, Octet, Record, gather_rows, is_as_eight, load_rows, octet, scatter_rows, select_rows, store_rows,
};
pub(crate) use rows::{RowColors, Rows, gather};
pub(crate) use widen::{Widen, widen_quat, widen_vec};

/// The most bodies of a tile for which a chunk may have to be filled up.
pub(crate) const WIDEST: usize = 16;

/// The most bodies of any tile: two of the widest.
pub(crate) const MAX_BODIES: usize = 2 * WIDEST;

/// A lane whose bodies are loaded from and stored to columns.
pub(crate) trait Tile: Lane + Widen {
    /// How many bodies.
    const WIDTH: usize;

    /// Whether it is two tiles side by side.
    const IS_PAIR: bool = false;

    /// The first `N` numbers of each of the first rows, as many as there are bodies.
    fn load<R: Record, const N: usize>(rows: &[R]) -> [Self; N];

    /// The first `N` numbers of rows that are anywhere, as many as there are bodies: at most a
    /// block's.
    #[inline(always)]
    fn gather<const N: usize>(rows: &[&Eight; BLOCK]) -> [Self; N] {
        const { assert!(Self::WIDTH <= BLOCK) };
        let mut gathered = [Eight::ZERO; BLOCK];
        let mut i = 0;
        while i < Self::WIDTH {
            gathered[i] = *rows[i];
            i += 1;
        }
        Self::load(&gathered)
    }

    /// Overwrites the first `N` numbers of each of the first rows.
    fn store<R: Record, const N: usize>(numbers: [Self; N], rows: &mut [R]);

    /// Overwrites rows of eight numbers that are anywhere, as many as there are bodies: at most a
    /// block's.
    #[inline(always)]
    fn scatter<const N: usize>(numbers: [Self; N], rows: &mut [&mut Eight; BLOCK]) {
        const { assert!(Self::WIDTH <= BLOCK && N == 8) };
        let mut changed = [Eight::ZERO; BLOCK];
        Self::store(numbers, &mut changed);
        let mut i = 0;
        while i < Self::WIDTH {
            *rows[i] = changed[i];
            i += 1;
        }
    }

    /// Whether all of these are positive zeros.
    fn are_zero<const N: usize>(numbers: [Self; N]) -> bool;
}

impl Tile for Real {
    const WIDTH: usize = 1;

    #[inline(always)]
    fn load<R: Record, const N: usize>(rows: &[R]) -> [Self; N] {
        record::numbers(&rows[0])
    }

    #[inline(always)]
    fn store<R: Record, const N: usize>(numbers: [Self; N], rows: &mut [R]) {
        record::set_numbers(&mut rows[0], numbers);
    }

    #[inline(always)]
    fn are_zero<const N: usize>(numbers: [Self; N]) -> bool {
        let mut bits = 0;
        for number in numbers {
            bits |= number.to_bits();
        }
        bits == 0
    }
}

/// A computation over tiles of any width.
pub(crate) trait Kernel {
    /// Whether it needs more registers than there are: tiles do not go in pairs then.
    const IS_LARGE: bool = false;

    /// Whether it runs seldom: tiles do not go in pairs either, and in WebAssembly, which is loaded
    /// over networks, bodies go one by one.
    const IS_RARE: bool = false;

    /// How many bodies there are.
    fn len(&self) -> usize;

    /// Runs it on the tile of bodies from row `i`. Must be `#[inline(always)]`, as must be all that
    /// it calls with tiles, and no closure may compute with them: what is not inlined is compiled
    /// without the instruction set, and calls a function for every operation.
    fn tile<T: Tile>(&mut self, i: usize);

    /// Whether no lane from row `i` of a block on has anything: a tile from there on is left out.
    #[inline(always)]
    fn is_empty(&self, _: usize) -> bool {
        false
    }

    /// Runs it on one body at a time from row `first` on.
    fn one_by_one(&mut self, first: usize)
    where
        Self: Sized,
    {
        if first < self.len() {
            tiles::<Real, _>(self, first);
        }
    }
}

/// Runs a kernel on whole tiles from row `i` on, and returns the first row that is left: all of
/// them, if they are pairs and the kernel is large or rare.
#[inline(always)]
fn tiles<T: Tile, K: Kernel>(kernel: &mut K, mut i: usize) -> usize {
    if T::IS_PAIR && (K::IS_LARGE || K::IS_RARE) {
        return i;
    }
    while i + T::WIDTH <= kernel.len() {
        if T::WIDTH >= BLOCK || !kernel.is_empty(i) {
            kernel.tile::<T>(i);
        }
        i += T::WIDTH;
    }
    i
}

/// An instruction set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Level {
    #[cfg(not(vectors_alone))]
    Scalar,
    #[cfg(vector_code)]
    Baseline,
    #[cfg(avx_code)]
    Avx2,
    #[cfg(avx_code)]
    Avx512,
}

impl Level {
    /// From the narrowest to the widest.
    const ALL: &[Self] = &[
        #[cfg(not(vectors_alone))]
        Self::Scalar,
        #[cfg(vector_code)]
        Self::Baseline,
        #[cfg(avx_code)]
        Self::Avx2,
        #[cfg(avx_code)]
        Self::Avx512,
    ];

    fn name(self) -> &'static str {
        match self {
            #[cfg(not(vectors_alone))]
            Self::Scalar => "scalar",
            #[cfg(vector_code)]
            Self::Baseline => "baseline",
            #[cfg(avx_code)]
            Self::Avx2 => "avx2",
            #[cfg(avx_code)]
            Self::Avx512 => "avx512",
        }
    }

    fn is_available(self) -> bool {
        match self {
            #[cfg(not(vectors_alone))]
            Self::Scalar => true,
            #[cfg(vector_code)]
            Self::Baseline => true,
            #[cfg(avx_code)]
            Self::Avx2 => std::arch::is_x86_feature_detected!("avx2"),
            #[cfg(avx_code)]
            Self::Avx512 => std::arch::is_x86_feature_detected!("avx512f"),
        }
    }

    /// Widths of the tiles that it has, the widest first.
    fn widths(self) -> &'static [usize] {
        match self {
            #[cfg(not(vectors_alone))]
            Self::Scalar => &[Real::WIDTH],
            #[cfg(vector_code)]
            Self::Baseline => &target::BASELINE_WIDTHS,
            #[cfg(avx_code)]
            Self::Avx2 => &target::WIDTHS[1..],
            #[cfg(avx_code)]
            Self::Avx512 => &target::WIDTHS,
        }
    }

    /// The one in force: found once, on the first step.
    fn chosen() -> Self {
        static CHOSEN: OnceLock<Level> = OnceLock::new();
        *CHOSEN.get_or_init(|| {
            let available = || Self::ALL.iter().copied().rev().filter(|level| level.is_available());
            let wanted = env::var("TUMBLE_SIMD").unwrap_or_default();
            let asked_for = available().find(|level| level.name() == wanted);
            asked_for.or_else(|| available().next()).unwrap_or(Self::ALL[0])
        })
    }

    #[inline]
    fn run(self, kernel: &mut impl Kernel) {
        match self {
            #[cfg(not(vectors_alone))]
            Self::Scalar => kernel.one_by_one(0),
            #[cfg(vector_code)]
            Self::Baseline => target::with_baseline(kernel),
            #[cfg(avx_code)]
            Self::Avx2 => target::with_avx2(kernel),
            #[cfg(avx_code)]
            Self::Avx512 => target::with_avx512(kernel),
        }
    }

    #[inline]
    fn run_in_blocks(self, kernel: &mut impl Kernel) {
        match self {
            #[cfg(not(vectors_alone))]
            Self::Scalar => kernel.one_by_one(0),
            #[cfg(vector_code)]
            Self::Baseline => target::blocks_with_baseline(kernel),
            #[cfg(avx_code)]
            Self::Avx2 => target::blocks_with_avx2(kernel),
            #[cfg(avx_code)]
            Self::Avx512 => target::blocks_with_avx512(kernel),
        }
    }

    /// AVX-512 has no other fours than AVX2.
    #[inline]
    fn run_fours(self, kernel: impl FourKernel) {
        match self {
            #[cfg(not(vectors_alone))]
            Self::Scalar => kernel.portably(),
            #[cfg(vector_code)]
            Self::Baseline => target::fours_with_baseline(kernel),
            #[cfg(avx_code)]
            Self::Avx2 | Self::Avx512 => target::fours_with_avx2(kernel),
        }
    }
}

/// The vector code that the step runs on this machine: `"avx512"`, `"avx2"`, `"baseline"` (what
/// every machine of the target has) or `"scalar"`, one body at a time. The environment variable
/// `TUMBLE_SIMD` forces one of them, if the machine can run it.
///
/// ```
/// println!("steps run on {}", tumble::simd_name());
/// ```
pub fn simd_name() -> &'static str {
    Level::chosen().name()
}

/// Runs a kernel with the widest tiles of this machine that fit, and narrower ones on what is left.
#[inline]
pub(crate) fn dispatch(kernel: &mut impl Kernel) {
    Level::chosen().run(kernel);
}

/// How many things a block has. A block is laid out for lanes, the same on every machine, and
/// worked on in tiles as wide as it is or, where they are narrower, in several.
pub(crate) const BLOCK: usize = 16;

/// Rows that [`dispatch_in_blocks`] runs over are filled up to a multiple of this: to whole blocks
/// small worlds would work on more empty rows than others.
pub(crate) const HALF_BLOCK: usize = BLOCK / 2;

/// Runs a kernel of whole halves of blocks with the widest tiles of this machine that are no wider
/// than a block.
#[inline]
pub(crate) fn dispatch_in_blocks(kernel: &mut impl Kernel) {
    debug_assert!(kernel.len().is_multiple_of(HALF_BLOCK));
    Level::chosen().run_in_blocks(kernel);
}

/// Runs a kernel with tiles no wider than a block, and on what is no half of a block one body at a
/// time.
pub(crate) fn dispatch_blocks_and_rest(kernel: &mut impl Kernel) {
    let mut whole = WholeHalves(kernel);
    dispatch_in_blocks(&mut whole);
    let rest = whole.len();
    kernel.one_by_one(rest);
}

/// The whole halves of the blocks of a kernel.
struct WholeHalves<'k, K>(&'k mut K);

impl<K: Kernel> Kernel for WholeHalves<'_, K> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.0.len() - self.0.len() % HALF_BLOCK
    }

    #[inline(always)]
    fn is_empty(&self, i: usize) -> bool {
        self.0.is_empty(i)
    }

    #[inline(always)]
    fn tile<T: Tile>(&mut self, i: usize) {
        self.0.tile::<T>(i);
    }
}

/// Runs a kernel of fours with the instruction set in force.
#[inline]
pub(crate) fn dispatch_fours(kernel: impl FourKernel) {
    Level::chosen().run_fours(kernel);
}

/// The width of the widest tile of this machine.
pub(crate) fn widest() -> usize {
    Level::chosen().widths()[0]
}

/// The width of the narrowest tile of this machine that has room for this many bodies, at most
/// those of the widest.
pub(crate) fn narrowest_for(bodies: usize) -> usize {
    let widths = Level::chosen().widths();
    widths.iter().rev().copied().find(|&width| width >= bodies).unwrap_or(widths[0])
}
