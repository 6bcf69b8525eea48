//! Components as rows of numbers, which tiles are loaded from and stored to.

#![allow(unsafe_code, reason = "what lies where in memory; see the SAFETY notes")]

use std::mem::size_of;

use crate::components::{
    Damping, GravityScale, Inertia, InverseInertia, Mass, Momentum, Pose, PreviousPose, PrincipalAxes, Velocity, Wind,
    Wrench,
};
use crate::math::Real;

/// A component that is `NUMBERS` numbers in a row, possibly with padding after them.
///
/// # Safety
/// The type has a fixed layout, its alignment is at least that of [`Real`], and it starts with
/// `NUMBERS` initialised [`Real`]s, for each of which any value is allowed that a step can store.
pub(crate) unsafe trait Record: Copy {
    /// How many numbers.
    const NUMBERS: usize;
    /// From one row's numbers to the next row's, in numbers.
    #[cfg(vector_code)]
    const STRIDE: usize = size_of::<Self>() / size_of::<Real>();
}

/// Eight numbers that belong together, in half a cache line or, in double precision, a whole one.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(crate) struct Eight<T = Real>(pub(crate) [T; 8]);

impl Eight {
    pub(crate) const ZERO: Self = Self([0.0; 8]);
}

macro_rules! records {
    ($($Component:ty: $numbers:literal),+ $(,)?) => {
        $(
            const _: () = assert!(
                size_of::<$Component>() % size_of::<Real>() == 0 && size_of::<$Component>() >= $numbers * size_of::<Real>()
            );
            // SAFETY: `repr(C)` or `repr(transparent)` around glam vectors and numbers in order;
            // `Vec3` has no padding, and the one vector of four numbers comes first.
            unsafe impl Record for $Component {
                const NUMBERS: usize = $numbers;
            }
        )+
    };
}

records! {
    Real: 1,
    Eight: 8,
    Mass: 1,
    GravityScale: 1,
    Damping: 2,
    Wind: 3,
    PrincipalAxes: 4,
    Inertia: 6,
    InverseInertia: 6,
    Momentum: 6,
    Velocity: 6,
    Wrench: 6,
    Pose: 7,
    PreviousPose: 7,
}

/// The numbers of a row.
#[inline(always)]
pub(crate) fn numbers<R: Record, const N: usize>(row: &R) -> [Real; N] {
    const { assert!(N <= R::NUMBERS) };
    // SAFETY: a record starts with that many initialised numbers, and is aligned for them.
    unsafe { *std::ptr::from_ref(row).cast::<[Real; N]>() }
}

/// Overwrites the numbers of a row.
#[inline(always)]
pub(crate) fn set_numbers<R: Record, const N: usize>(row: &mut R, numbers: [Real; N]) {
    const { assert!(N <= R::NUMBERS) };
    // SAFETY: as in `numbers`; a record takes any number that a step can store.
    unsafe { *std::ptr::from_mut(row).cast::<[Real; N]>() = numbers };
}
