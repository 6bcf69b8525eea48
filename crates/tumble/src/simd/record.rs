//! Components as rows of numbers, which tiles are loaded from and stored to; records of eight named
//! numbers, and the same of several records side by side.

#![allow(unsafe_code, reason = "what lies where in memory; see the SAFETY notes")]

use std::mem::size_of;

use tumble_math::lane::{Quat, Vec3};

use super::{BLOCK, Tile};
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

/// A record of eight numbers, as [`octet!`] declares it.
///
/// # Safety
/// It is `Lanes<Real>`, and `Lanes<T>` is laid out as [`Eight<T>`](Eight) for every `T`.
pub(crate) unsafe trait Octet: Record + 'static {
    /// The same fields, each of several records side by side.
    type Lanes<T: Copy>: Copy;

    /// All numbers zero.
    // SAFETY: laid out as the numbers.
    const ZERO: Self = unsafe { *std::ptr::from_ref(&Eight::ZERO).cast::<Self>() };

    /// The zero record, for lanes without a row.
    #[inline(always)]
    fn zero() -> &'static Self {
        const NUMBERS: &Eight = &Eight::ZERO;
        // SAFETY: laid out as the numbers.
        unsafe { &*std::ptr::from_ref(NUMBERS).cast() }
    }
}

/// What a field of an [`Octet`] may be.
///
/// # Safety
/// It is laid out as `[T; COUNT]`.
pub(crate) unsafe trait NumberField<T>: Copy {
    const COUNT: usize;
}

// SAFETY: one number.
unsafe impl<T: Copy> NumberField<T> for T {
    const COUNT: usize = 1;
}

// SAFETY: itself.
unsafe impl<T: Copy, const N: usize> NumberField<T> for [T; N] {
    const COUNT: usize = N;
}

// SAFETY: `repr(C)`, three numbers.
unsafe impl<T: Copy> NumberField<T> for Vec3<T> {
    const COUNT: usize = 3;
}

// SAFETY: as one vector.
unsafe impl<T: Copy, const N: usize> NumberField<T> for [Vec3<T>; N] {
    const COUNT: usize = 3 * N;
}

// SAFETY: `repr(C)`, four numbers.
unsafe impl<T: Copy> NumberField<T> for Quat<T> {
    const COUNT: usize = 4;
}

/// Declares an [`Octet`]. Its fields are `T`, vectors and quaternions of `T`, or arrays of these,
/// eight numbers in all. Without a parameter it is the record, with a tile as `T` its lanes.
macro_rules! octet {
    (
        $(#[$about:meta])*
        $vis:vis struct $Name:ident<$T:ident> {
            $($(#[$about_field:meta])* $field_vis:vis $field:ident: $Field:ty,)+
        }
    ) => {
        $(#[$about])*
        #[derive(Copy, Debug)]
        #[repr(C, align(32))]
        $vis struct $Name<$T = $crate::math::Real> {
            $($(#[$about_field])* $field_vis $field: $Field,)+
        }

        // Derived, it would clone field by field, since the parameter need not be `Copy`.
        impl<$T: Copy> Clone for $Name<$T> {
            #[inline(always)]
            fn clone(&self) -> Self {
                *self
            }
        }

        impl<$T: Copy> $Name<$T> {
            const NUMBERS: usize = 0 $(+ <$Field as $crate::simd::NumberField<$T>>::COUNT)+;
        }

        const _: () = assert!(
            <$Name>::NUMBERS == 8
                && $crate::simd::is_as_eight::<$Name>()
        );

        // SAFETY: `repr(C)`, and eight numbers, which is checked above.
        #[allow(unsafe_code, reason = "the layout is checked where it is declared")]
        unsafe impl $crate::simd::Record for $Name {
            const NUMBERS: usize = 8;
        }

        // SAFETY: as for `Record`; all fields are rows of the parameter, whatever it is.
        #[allow(unsafe_code, reason = "the layout is checked where it is declared")]
        unsafe impl $crate::simd::Octet for $Name {
            type Lanes<L: Copy> = $Name<L>;
        }
    };
}

pub(crate) use octet;

/// Whether a record has the size and the alignment of eight numbers in a row.
pub(crate) const fn is_as_eight<R: Record>() -> bool {
    size_of::<R>() == size_of::<Eight>() && align_of::<R>() == align_of::<Eight>()
}

/// Eight numbers by their names.
#[inline(always)]
fn named<R: Octet, T: Copy>(numbers: [T; 8]) -> R::Lanes<T> {
    const { assert!(size_of::<R::Lanes<T>>() == size_of::<Eight<T>>()) };
    const { assert!(align_of::<R::Lanes<T>>() == align_of::<Eight<T>>()) };
    let numbers = Eight(numbers);
    // SAFETY: the promise of `Octet`.
    unsafe { *std::ptr::from_ref(&numbers).cast() }
}

/// The numbers of lanes.
#[inline(always)]
fn lane_numbers<R: Octet, T: Copy>(lanes: &R::Lanes<T>) -> [T; 8] {
    const { assert!(size_of::<R::Lanes<T>>() == size_of::<Eight<T>>()) };
    // SAFETY: the promise of `Octet`.
    unsafe { *std::ptr::from_ref(lanes).cast() }
}

/// Every number of the first where a mask is set, else of the second.
#[inline(always)]
pub(crate) fn select_rows<T: Tile, R: Octet>(mask: T::Mask, first: R::Lanes<T>, second: R::Lanes<T>) -> R::Lanes<T> {
    let (first, second) = (lane_numbers::<R, T>(&first), lane_numbers::<R, T>(&second));
    let mut selected = first;
    let mut i = 0;
    while i < selected.len() {
        selected[i] = T::select(mask, first[i], second[i]);
        i += 1;
    }
    named::<R, T>(selected)
}

/// Records that are anywhere, as many as a tile has lanes: at most a block's.
#[inline(always)]
pub(crate) fn gather_rows<T: Tile, R: Octet>(rows: &[&R; BLOCK]) -> R::Lanes<T> {
    // SAFETY: the promise of `Octet`, for what is behind each reference.
    let rows: &[&Eight; BLOCK] = unsafe { &*std::ptr::from_ref(rows).cast() };
    named::<R, T>(T::gather(rows))
}

/// The first records, as many as a tile has lanes.
#[inline(always)]
pub(crate) fn load_rows<T: Tile, R: Octet>(rows: &[R]) -> R::Lanes<T> {
    named::<R, T>(T::load(rows))
}

/// Overwrites the first records, as many as a tile has lanes.
#[inline(always)]
pub(crate) fn store_rows<T: Tile, R: Octet>(lanes: R::Lanes<T>, rows: &mut [R]) {
    T::store(lane_numbers::<R, T>(&lanes), rows);
}

/// Overwrites records that are anywhere, as many as a tile has lanes: at most a block's.
#[inline(always)]
pub(crate) fn scatter_rows<T: Tile, R: Octet>(lanes: R::Lanes<T>, rows: &mut [&mut R; BLOCK]) {
    // SAFETY: the promise of `Octet`, for what is behind each reference.
    let rows: &mut [&mut Eight; BLOCK] = unsafe { &mut *std::ptr::from_mut(rows).cast() };
    T::scatter(lane_numbers::<R, T>(&lanes), rows);
}

/// A record to test with.
#[cfg(test)]
pub(super) mod sample {
    use super::{Quat, Real, Vec3};

    octet! {
        pub(in crate::simd) struct Sample<T> {
            pub(in crate::simd) vector: Vec3<T>,
            pub(in crate::simd) number: T,
            pub(in crate::simd) quaternion: Quat<T>,
        }
    }

    impl Sample {
        /// Eight times the same number.
        pub(in crate::simd) fn of(x: Real) -> Self {
            Self { vector: Vec3::splat(x), number: x, quaternion: Quat { x, y: x, z: x, w: x } }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::sample::Sample;
    use super::*;

    #[test]
    fn fields_are_in_their_order() {
        let lanes = named::<Sample, Real>([1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]);
        assert_eq!((lanes.vector, lanes.number), (Vec3::new(1.0, 2.0, 3.0), 4.0));
        assert_eq!(lanes.quaternion, Quat { x: 5.0, y: 6.0, z: 7.0, w: 8.0 });
        assert_eq!(lane_numbers::<Sample, Real>(&lanes), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]);
    }

    #[test]
    fn a_record_is_stored_and_gathered() {
        let mut rows = [Sample::ZERO; 2];
        let sample = Sample { number: 2.0, ..Sample::of(1.0) };
        store_rows::<Real, Sample>(sample, &mut rows[1..]);
        assert_eq!((rows[0].number, rows[1].number), (0.0, 2.0));
        let gathered = gather_rows::<Real, _>(&[&rows[1]; BLOCK]);
        assert_eq!((gathered.vector, gathered.number), (sample.vector, 2.0));
        assert_eq!(load_rows::<Real, _>(&rows[1..]).quaternion, sample.quaternion);
        assert_eq!(Sample::zero().vector, Vec3::zero());
    }
}
