//! Why a matrix is not the inertia tensor of any body.

use glam::DVec3;
use thiserror::Error;

/// Why a matrix or a triple of moments is not the inertia tensor of any body, with the offending
/// numbers.
///
/// ```
/// use tumble_math::{InertiaError, InertiaTensor};
/// let error = InertiaTensor::from_principal([1.0, 2.0, 3.5], glam::DQuat::IDENTITY).unwrap_err();
/// assert!(matches!(error, InertiaError::TriangleInequality { .. }));
/// ```
#[derive(Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum InertiaError {
    /// An element is NaN or infinite.
    #[error("inertia element ({row}, {column}) is {value:?}, not a finite number")]
    NotFinite {
        /// Row, from 0.
        row: usize,
        /// Column, from 0.
        column: usize,
        /// The element [kg m^2].
        value: f64,
    },
    /// Two mirrored elements differ by more than the tolerance allows.
    #[error("inertia is not symmetric: element ({row}, {column}) is {upper:?}, element ({column}, {row}) is {lower:?}")]
    NotSymmetric {
        /// Row of the upper element, from 0.
        row: usize,
        /// Column of the upper element, from 0.
        column: usize,
        /// Element `(row, column)` [kg m^2].
        upper: f64,
        /// Element `(column, row)` [kg m^2].
        lower: f64,
    },
    /// A principal moment is zero, negative or lost in rounding: a torque would turn the body
    /// infinitely fast. Point masses and thin rods are like that.
    #[error("principal moments of inertia must be positive beyond rounding, they are {}", listed(*.principal))]
    NotPositive {
        /// The principal moments [kg m^2], ascending.
        principal: DVec3,
    },
    /// The largest principal moment is more than the other two together, which no distribution of
    /// mass has: `I1 + I2 - I3 = 2 * integral of z^2 dm >= 0`.
    #[error(
        "principal moments of inertia {} break the triangle inequality: \
         no moment may exceed the sum of the others",
        listed(*.principal)
    )]
    TriangleInequality {
        /// The principal moments [kg m^2], ascending.
        principal: DVec3,
    },
    /// A principal moment is outside [`InertiaTensor::MOMENTS`](crate::InertiaTensor::MOMENTS).
    #[error("principal moments of inertia {} are outside 1e-300 to 1e300 kg m^2", listed(*.principal))]
    OutOfRange {
        /// The principal moments [kg m^2], ascending.
        principal: DVec3,
    },
    /// The quaternion of a rotation is not a unit quaternion: its length is further than 1e-3 from
    /// one.
    #[error("a rotation needs a unit quaternion, its length is {length:?}")]
    Orientation {
        /// Length of the quaternion.
        length: f64,
    },
    /// An axis is zero or not finite and so has no direction.
    #[error("the axis {} has no direction", listed(*.axis))]
    Axis {
        /// The axis as given.
        axis: DVec3,
    },
    /// A mass in a parallel-axis shift is negative or not finite.
    #[error("a parallel-axis shift needs a finite mass of at least zero, it is {mass:?}")]
    Mass {
        /// The mass \[kg\].
        mass: f64,
    },
    /// An offset in a parallel-axis shift is not finite, or its square overflows.
    #[error("the offset {} is not finite or too long", listed(*.offset))]
    Offset {
        /// The offset \[m\].
        offset: DVec3,
    },
}

crate::debug_as_display!(InertiaError);

/// `(1.0, 2.0, 1e300)`: the shortest digits that read back the same, with an exponent where that is
/// shorter.
pub(crate) fn listed(v: DVec3) -> String {
    format!("({:?}, {:?}, {:?})", v.x, v.y, v.z)
}
