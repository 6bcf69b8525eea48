//! What the machine can do: moving bytes, and computing in registers.

use std::hint::black_box;
use std::time::Instant;

use pulp::{Arch, Simd, WithSimd};
use rayon::ThreadPool;
use tumble::math::Real;

use crate::lanes::{Lanes, Register, registers};

/// How long and how often things are measured.
#[derive(Clone, Copy)]
pub(crate) struct Effort {
    /// How long a block takes, about \[s\].
    pub(crate) block: f64,
    pub(crate) blocks: u32,
}

impl Effort {
    /// The least time of one pass \[s\], where every thread of the pool makes as many passes.
    ///
    /// The least, because what is measured is a limit: nothing but the machine makes it longer, and
    /// other programs do.
    fn least<T: Send>(self, pool: &ThreadPool, parts: &mut [T], pass: impl Fn(&mut T) + Sync) -> f64 {
        let mut passes = 1_u32;
        loop {
            let seconds = run(pool, parts, passes, &pass);
            if seconds >= self.block * 0.5 {
                break;
            }
            passes = passes.saturating_mul((self.block / seconds.max(1e-9)).clamp(2.0, 100.0) as u32);
        }
        let times = (0..self.blocks).map(|_| run(pool, parts, passes, &pass) / f64::from(passes));
        times.fold(f64::INFINITY, f64::min)
    }
}

/// The time of all threads together \[s\].
fn run<T: Send>(pool: &ThreadPool, parts: &mut [T], passes: u32, pass: &(impl Fn(&mut T) + Sync)) -> f64 {
    let start = Instant::now();
    pool.scope(|scope| {
        for part in parts.iter_mut() {
            scope.spawn(move |_| (0..passes).for_each(|_| pass(part)));
        }
    });
    start.elapsed().as_secs_f64()
}

/// As many real numbers as fill this many bytes, in a part for each thread.
fn parts(pool: &ThreadPool, bytes: usize) -> Vec<Vec<Real>> {
    let threads = pool.current_num_threads();
    let numbers = (bytes / size_of::<Real>() / threads).next_multiple_of(64);
    (0..threads).map(|_| vec![1.0; numbers]).collect()
}

/// Bytes a second, read and written, when half of a working set is copied to the other half.
pub(crate) fn copy_bandwidth(pool: &ThreadPool, working_set: usize, effort: Effort) -> f64 {
    let (from, to) = (parts(pool, working_set / 2), parts(pool, working_set / 2));
    let bytes: usize = from.iter().map(|part| 2 * size_of_val(part.as_slice())).sum();
    let mut pairs: Vec<_> = from.into_iter().zip(to).collect();
    let seconds = effort.least(pool, &mut pairs, |(from, to)| {
        to.copy_from_slice(from);
        black_box(to);
    });
    bytes as f64 / seconds
}

/// Bytes a second, read and written, when every number of a working set is changed in place.
pub(crate) fn update_bandwidth(pool: &ThreadPool, working_set: usize, effort: Effort) -> f64 {
    let mut parts = parts(pool, working_set);
    let bytes: usize = parts.iter().map(|part| 2 * size_of_val(part.as_slice())).sum();
    let arch = Arch::new();
    let seconds = effort.least(pool, &mut parts, |numbers| {
        arch.dispatch(Update { numbers });
        black_box(numbers);
    });
    bytes as f64 / seconds
}

struct Update<'a> {
    numbers: &'a mut [Real],
}

impl WithSimd for Update<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let factor = Lanes::splat(simd, 0.999);
        for register in registers::<S>(self.numbers) {
            (Lanes::load(simd, register) * factor).store(register);
        }
    }
}

/// What all threads of a pool compute together, in numbers a second, with the widest registers of
/// the machine.
#[derive(Clone, Copy)]
pub(crate) struct Arithmetic {
    /// Additions and multiplications, as many of these as of those, not fused.
    pub(crate) simple: f64,
    /// Divisions and square roots, as many of these as of those.
    pub(crate) slow: f64,
}

/// Chains of operations that do not wait for each other: more than a processor has under way at a
/// time, and few enough for 16 registers.
const CHAINS: usize = 12;
const ROUNDS: usize = 256;

pub(crate) fn arithmetic(pool: &ThreadPool, effort: Effort) -> Arithmetic {
    let width = Arch::new().dispatch(Width);
    let operations = (pool.current_num_threads() * CHAINS * ROUNDS * width) as f64;
    let mut parts: Vec<Real> = vec![1.000_1; pool.current_num_threads()];
    let arch = Arch::new();
    let simple = effort.least(pool, &mut parts, |x| {
        black_box(arch.dispatch(Chains::<false>(black_box(*x))));
    });
    let slow = effort.least(pool, &mut parts, |x| {
        black_box(arch.dispatch(Chains::<true>(black_box(*x))));
    });
    Arithmetic { simple: 2.0 * operations / simple, slow: 2.0 * operations / slow }
}

/// How many numbers a register holds.
struct Width;

impl WithSimd for Width {
    type Output = usize;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> usize {
        size_of::<Register<S>>() / size_of::<Real>()
    }
}

/// Every chain is multiplied and added to, or divided and its root taken, over and over.
struct Chains<const DIVIDE: bool>(Real);

impl<const DIVIDE: bool> WithSimd for Chains<DIVIDE> {
    type Output = Real;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Real {
        let (factor, term) = (Lanes::splat(simd, self.0), Lanes::splat(simd, 1.0 - self.0));
        let mut chains = [Lanes::splat(simd, 1.0); CHAINS];
        for _ in 0..ROUNDS {
            for chain in &mut chains {
                *chain = if DIVIDE { (*chain / factor).sqrt() } else { *chain * factor + term };
            }
        }
        let mut sum = Lanes::splat(simd, 0.0);
        for chain in chains {
            sum = sum + chain;
        }
        let mut results = [0.0; 16];
        sum.store(&mut registers::<S>(&mut results)[0]);
        results[0]
    }
}
