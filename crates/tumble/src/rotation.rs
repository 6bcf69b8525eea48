//! Rotations in the build's [`Real`]: what glam lacks or does less exactly, computed in double
//! precision and rounded once.
//!
//! The same functions in `f64` are those of `tumble-math`, which documents their conventions
//! and errors in full.
//!
//! ```
//! use tumble::math::{Quat, Real};
//! use tumble::rotation::{YawPitchRoll, yaw_pitch_roll};
//!
//! let turned = Quat::from_rotation_z(0.25);
//! assert!((yaw_pitch_roll(turned).yaw - 0.25).abs() < 1e-6);
//! let back: YawPitchRoll = yaw_pitch_roll(turned);
//! assert!(
//!     (tumble::rotation::to_scaled_axis(turned).z - 0.25).abs() < 1e-6 && back.roll.abs() < 1e-6
//! );
//! ```

use tumble_math::EulerRot;
pub use tumble_math::{NotARotation, YawPitchRoll};

use crate::math::{Mat3, Quat, Real, Vec3, dquat, dvec3, quat, real, vec3};

fn double(matrix: Mat3) -> glam::DMat3 {
    glam::DMat3::from_cols(dvec3(matrix.x_axis), dvec3(matrix.y_axis), dvec3(matrix.z_axis))
}

/// Axis, of unit length, and angle in `[0, pi]` \[rad\] of a rotation; `(X, 0)` of none.
///
/// ```
/// use tumble::math::{Quat, Vec3};
/// let (axis, angle) = tumble::rotation::to_axis_angle(Quat::from_rotation_y(-0.5));
/// assert!((axis - Vec3::NEG_Y).length() < 1e-6 && (angle - 0.5).abs() < 1e-6);
/// ```
pub fn to_axis_angle(rotation: Quat) -> (Vec3, Real) {
    let (axis, angle) = tumble_math::to_axis_angle(dquat(rotation));
    (vec3(axis), real(angle))
}

/// The rotation as a vector along its axis with the angle as length \[rad\].
///
/// ```
/// use tumble::math::{Quat, Vec3};
/// let turn = tumble::rotation::to_scaled_axis(Quat::from_rotation_x(0.5));
/// assert!((turn - Vec3::X * 0.5).length() < 1e-6);
/// ```
pub fn to_scaled_axis(rotation: Quat) -> Vec3 {
    vec3(tumble_math::to_scaled_axis(dquat(rotation)))
}

/// The rotation about `vector` by its length \[rad\].
///
/// ```
/// use tumble::math::{Quat, Vec3};
/// let turned = tumble::rotation::from_scaled_axis(Vec3::X * 0.5);
/// assert!((turned - Quat::from_rotation_x(0.5)).length() < 1e-6);
/// ```
pub fn from_scaled_axis(vector: Vec3) -> Quat {
    quat(tumble_math::from_scaled_axis(dvec3(vector)))
}

/// The angle in `[0, pi]` \[rad\] that takes one orientation to the other, exact for small ones
/// too.
///
/// ```
/// use tumble::math::Quat;
/// let angle = tumble::rotation::angle_between(Quat::IDENTITY, Quat::from_rotation_z(1e-4));
/// assert!((angle - 1e-4).abs() < 1e-9);
/// ```
pub fn angle_between(a: Quat, b: Quat) -> Real {
    real(tumble_math::angle_between(dquat(a), dquat(b)))
}

/// The three Euler angles \[rad\] of a rotation in an order, exact next to gimbal lock.
///
/// ```
/// use tumble::glam::EulerRot;
/// use tumble::math::Quat;
/// let (first, _, _) = tumble::rotation::to_euler(Quat::from_rotation_x(0.5), EulerRot::XYZ);
/// assert!((first - 0.5).abs() < 1e-6);
/// ```
pub fn to_euler(rotation: Quat, order: EulerRot) -> (Real, Real, Real) {
    let (first, second, third) = tumble_math::to_euler(dquat(rotation), order);
    (real(first), real(second), real(third))
}

/// Heading, elevation and bank \[rad\]: about z, then the new y, then the new x.
///
/// ```
/// use tumble::math::Quat;
/// let angles = tumble::rotation::yaw_pitch_roll(Quat::from_rotation_y(0.5));
/// assert!((angles.pitch - 0.5).abs() < 1e-6);
/// ```
pub fn yaw_pitch_roll(rotation: Quat) -> YawPitchRoll {
    YawPitchRoll::of(dquat(rotation))
}

/// The rotation with these angles.
///
/// ```
/// use tumble::math::Quat;
/// use tumble::rotation::{YawPitchRoll, from_yaw_pitch_roll};
/// let turned = from_yaw_pitch_roll(YawPitchRoll { pitch: 0.5, ..YawPitchRoll::default() });
/// assert!((turned - Quat::from_rotation_y(0.5)).length() < 1e-6);
/// ```
pub fn from_yaw_pitch_roll(angles: YawPitchRoll) -> Quat {
    quat(angles.rotation())
}

/// The orientation with this rotation matrix.
///
/// ```
/// use tumble::math::{Mat3, Quat};
/// let turned = tumble::rotation::quat_from_matrix(Mat3::from_rotation_z(0.5))?;
/// assert!((turned - Quat::from_rotation_z(0.5)).length() < 1e-6);
/// # Ok::<(), tumble::rotation::NotARotation>(())
/// ```
///
/// # Errors
/// [`NotARotation`]: a matrix that is not orthonormal within 2e-6, or that mirrors.
pub fn quat_from_matrix(matrix: Mat3) -> Result<Quat, NotARotation> {
    tumble_math::quat_from_matrix(double(matrix)).map(quat)
}

/// The orientation whose matrix is nearest to one that has drifted from being a rotation.
///
/// ```
/// use tumble::math::{Mat3, Quat};
/// let turned = tumble::rotation::nearest_rotation(Mat3::from_rotation_z(0.5) * 1.25)?;
/// assert!((turned - Quat::from_rotation_z(0.5)).length() < 1e-6);
/// # Ok::<(), tumble::rotation::NotARotation>(())
/// ```
///
/// # Errors
/// [`NotARotation`]: a matrix that is singular, not finite, or that mirrors.
pub fn nearest_rotation(matrix: Mat3) -> Result<Quat, NotARotation> {
    tumble_math::nearest_rotation(double(matrix)).and_then(tumble_math::quat_from_matrix).map(quat)
}
