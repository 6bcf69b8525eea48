//! Tiles in double precision: for sums that single precision is too coarse for.

use tumble_math::lane::{Lane, Quat, Vec3};

use crate::math::Real;

/// A lane whose numbers can be had in double precision.
pub(crate) trait Widen: Lane {
    /// A lane of as many numbers in double precision.
    type Double: Lane;

    /// The same numbers.
    fn widen(self) -> Self::Double;

    /// Overwrites the first numbers of a row, as many as there are bodies.
    fn store_doubles(doubles: Self::Double, row: &mut [f64]);
}

impl Widen for Real {
    type Double = f64;

    #[inline(always)]
    fn widen(self) -> f64 {
        f64::from(self)
    }

    #[inline(always)]
    fn store_doubles(double: f64, row: &mut [f64]) {
        row[0] = double;
    }
}

/// A vector in double precision.
#[inline(always)]
pub(crate) fn widen_vec<T: Widen>(vector: Vec3<T>) -> Vec3<T::Double> {
    Vec3::new(vector.x.widen(), vector.y.widen(), vector.z.widen())
}

/// A quaternion in double precision.
#[inline(always)]
pub(crate) fn widen_quat<T: Widen>(quat: Quat<T>) -> Quat<T::Double> {
    Quat { x: quat.x.widen(), y: quat.y.widen(), z: quat.z.widen(), w: quat.w.widen() }
}
