//! The precision the engine simulates in: glam's `f32` types, or with the cargo feature `f64` its
//! `f64` types.
//!
//! A renderer with another version of glam takes them as arrays, `theirs::Vec3::from(v.to_array())`
//! and `theirs::Quat::from_array(q.to_array())`, or with the feature `mint` through that crate:
#![cfg_attr(
    feature = "mint",
    doc = "
```
use tumble::math::{Quat, Real, Vec3};

let drawn: mint::Vector3<Real> = Vec3::Y.into(); // and on: theirs::Vec3::from(drawn)
let turned: mint::Quaternion<Real> = Quat::from_rotation_x(0.5).into();
assert_eq!((drawn.y, Quat::from(turned)), (1.0, Quat::from_rotation_x(0.5)));
```
"
)]

#[cfg(not(feature = "f64"))]
mod chosen {
    /// A real number of the simulation: `f32`, or `f64` with the cargo feature `f64`.
    pub type Real = f32;
    /// A vector of three [`Real`]s.
    pub type Vec3 = glam::Vec3;
    /// A quaternion of four [`Real`]s; orientations take body coordinates to world coordinates.
    pub type Quat = glam::Quat;
    /// A 3x3 matrix of [`Real`]s.
    pub type Mat3 = glam::Mat3;
    /// A 4x4 matrix of [`Real`]s.
    pub type Mat4 = glam::Mat4;
    /// `"f32"` or `"f64"`: the precision this build simulates in.
    pub const PRECISION: &str = "f32";

    pub(crate) fn real(value: f64) -> Real {
        value as f32
    }

    pub(crate) fn vec3(value: glam::DVec3) -> Vec3 {
        value.as_vec3()
    }

    pub(crate) fn quat(value: glam::DQuat) -> Quat {
        value.as_quat()
    }
}

#[cfg(feature = "f64")]
mod chosen {
    /// A real number of the simulation: `f64` in this build.
    pub type Real = f64;
    /// A vector of three [`Real`]s.
    pub type Vec3 = glam::DVec3;
    /// A quaternion of four [`Real`]s; orientations take body coordinates to world coordinates.
    pub type Quat = glam::DQuat;
    /// A 3x3 matrix of [`Real`]s.
    pub type Mat3 = glam::DMat3;
    /// A 4x4 matrix of [`Real`]s.
    pub type Mat4 = glam::DMat4;
    /// `"f32"` or `"f64"`: the precision this build simulates in.
    pub const PRECISION: &str = "f64";

    pub(crate) fn real(value: f64) -> Real {
        value
    }

    pub(crate) fn vec3(value: glam::DVec3) -> Vec3 {
        value
    }

    pub(crate) fn quat(value: glam::DQuat) -> Quat {
        value
    }
}

pub use chosen::*;

/// A vector in double precision, as shapes and tensors take it, whatever the build simulates in.
///
/// ```
/// use tumble::math::{Vec3, dvec3};
///
/// assert_eq!(dvec3(Vec3::X), glam::DVec3::X);
/// ```
pub fn dvec3(value: Vec3) -> glam::DVec3 {
    value.into()
}

/// An orientation in double precision, as shapes and tensors take it, whatever the build simulates
/// in.
///
/// ```
/// use tumble::{Amount, Part, Shape, math::{Quat, dquat}};
///
/// let tilt = Quat::from_rotation_x(0.5);
/// let fin = Part::new(Shape::cuboid([0.1, 0.5, 0.01]), Amount::Mass(0.2)).turned(dquat(tilt));
/// assert!((fin.orientation.x - 0.25_f64.sin()).abs() < 1e-7);
/// ```
pub fn dquat(value: Quat) -> glam::DQuat {
    glam::DQuat::from_xyzw(value.x.into(), value.y.into(), value.z.into(), value.w.into())
}

/// A vector turned, in the same operations on every machine: glam's for a quaternion of `f32`
/// depend on what it has.
#[inline]
pub(crate) fn rotated(rotation: Quat, vector: Vec3) -> Vec3 {
    tumble_math::lane::Quat::<Real>::from(rotation).rotate(vector.into()).into()
}

/// A product of rotations, in the same operations on every machine.
#[inline]
pub(crate) fn product(first: Quat, second: Quat) -> Quat {
    (tumble_math::lane::Quat::<Real>::from(first) * tumble_math::lane::Quat::from(second)).into()
}

/// One body's vector in double precision.
pub(crate) fn double(vector: tumble_math::lane::Vec3<Real>) -> glam::DVec3 {
    dvec3(vector.into())
}

/// One body's quaternion in double precision.
pub(crate) fn double_quat(quat: tumble_math::lane::Quat<Real>) -> glam::DQuat {
    dquat(quat.into())
}
