//! What vectors are asked for along and across the up axis.

use tumble::math::{Quat, Real, Vec3};

/// The part of a vector across an axis of unit length.
pub(crate) fn flat(vector: Vec3, up: Vec3) -> Vec3 {
    vector - up * vector.dot(up)
}

/// The direction of a vector that has one.
pub(crate) fn unit(vector: Vec3) -> Option<Vec3> {
    let length = vector.length();
    (length > Real::MIN_POSITIVE && length.is_finite()).then(|| vector / length)
}

/// No longer than this.
pub(crate) fn limited(vector: Vec3, most: Real) -> Vec3 {
    let length = vector.length();
    if length > most { vector * (most / length) } else { vector }
}

/// A vector turned about an axis of unit length by an angle \[rad\], by the formula of Rodrigues.
pub(crate) fn turned(vector: Vec3, axis: Vec3, angle: Real) -> Vec3 {
    let (sin, cos) = sin_cos(angle);
    vector * cos + axis.cross(vector) * sin + axis * (axis.dot(vector) * (1.0 - cos))
}

/// The same bits on every machine.
pub(crate) fn sin_cos(angle: Real) -> (Real, Real) {
    let (sin, cos) = libm::sincos(f64::from(angle));
    (sin as Real, cos as Real)
}

/// The shortest rotation from y to an axis of unit length.
pub(crate) fn from_y_to(up: Vec3) -> Quat {
    let half = 1.0 + up.y;
    if half < 1e-6 {
        return Quat::from_xyzw(1.0, 0.0, 0.0, 0.0);
    }
    let length = (up.z * up.z + up.x * up.x + half * half).sqrt();
    Quat::from_xyzw(up.z / length, 0.0, -up.x / length, half / length)
}
