//! Vector code: tiles of bodies side by side, and the choice of instruction set while the program runs.
//!
//! A kernel is written once, generic over [`Tile`]. [`dispatch`] instantiates it for every instruction set the machine may have and
//! runs the widest that it has. All tiles do the same correctly rounded operations in the same order, so the bits are the same
//! with any of them; one body at a time is the reference.
//!
//! `TUMBLE_SIMD=scalar|baseline|avx2|avx512` in the environment forces a choice that the machine can run.

use std::env;
use std::sync::OnceLock;

use tumble_math::lane::Lane;

use crate::math::Real;

#[cfg(target_arch = "x86_64")]
mod x86_64;

/// A lane whose bodies are loaded from and stored to columns.
pub(crate) trait Tile: Lane {
    /// How many bodies.
    const WIDTH: usize;

    /// The tile with `number(i)` for body `i`.
    fn from_fn(number: impl FnMut(usize) -> Real) -> Self;

    /// Hands each body's number to `store`.
    fn for_each(self, store: impl FnMut(usize, Real));
}

impl Tile for Real {
    const WIDTH: usize = 1;

    #[inline(always)]
    fn from_fn(mut number: impl FnMut(usize) -> Real) -> Self {
        number(0)
    }

    #[inline(always)]
    fn for_each(self, mut store: impl FnMut(usize, Real)) {
        store(0, self);
    }
}

/// A computation over tiles of any width.
pub(crate) trait Kernel {
    /// Runs it. Must be `#[inline(always)]`, as must be all that it calls with tiles, and no closure may compute with them: what is
    /// not inlined is compiled without the instruction set, and calls a function for every operation.
    fn run<T: Tile>(self);
}

/// An instruction set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Level {
    Scalar,
    #[cfg(target_arch = "x86_64")]
    Baseline,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl Level {
    #[cfg(target_arch = "x86_64")]
    const ALL: [Self; 4] = [Self::Scalar, Self::Baseline, Self::Avx2, Self::Avx512];
    #[cfg(not(target_arch = "x86_64"))]
    const ALL: [Self; 1] = [Self::Scalar];

    fn name(self) -> &'static str {
        match self {
            Self::Scalar => "scalar",
            #[cfg(target_arch = "x86_64")]
            Self::Baseline => "baseline",
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => "avx2",
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => "avx512",
        }
    }

    fn is_available(self) -> bool {
        match self {
            Self::Scalar => true,
            #[cfg(target_arch = "x86_64")]
            Self::Baseline => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => std::arch::is_x86_feature_detected!("avx2"),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => std::arch::is_x86_feature_detected!("avx512f"),
        }
    }

    /// The one in force: found once, on the first step.
    fn chosen() -> Self {
        static CHOSEN: OnceLock<Level> = OnceLock::new();
        *CHOSEN.get_or_init(|| {
            let available = || Self::ALL.into_iter().rev().filter(|level| level.is_available());
            let wanted = env::var("TUMBLE_SIMD").unwrap_or_default();
            let asked_for = available().find(|level| level.name() == wanted);
            asked_for.or_else(|| available().next()).unwrap_or(Self::Scalar)
        })
    }
}

/// The vector code that the step runs on this machine: `"avx512"`, `"avx2"`, `"baseline"` (what every machine of the target has)
/// or `"scalar"`, one body at a time. The environment variable `TUMBLE_SIMD` forces one of them, if the machine can run it.
pub fn simd_name() -> &'static str {
    Level::chosen().name()
}

/// Runs a kernel with the widest tiles of this machine.
#[inline]
pub(crate) fn dispatch(kernel: impl Kernel) {
    match Level::chosen() {
        Level::Scalar => kernel.run::<Real>(),
        #[cfg(target_arch = "x86_64")]
        Level::Baseline => x86_64::with_sse2(kernel),
        #[cfg(target_arch = "x86_64")]
        Level::Avx2 => x86_64::with_avx2(kernel),
        #[cfg(target_arch = "x86_64")]
        Level::Avx512 => x86_64::with_avx512(kernel),
    }
}
