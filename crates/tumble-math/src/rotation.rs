//! Rotations: what glam lacks or does less exactly.

use glam::{DMat3, DMat4, DQuat, DVec3};
use thiserror::Error;

use crate::symmetric::mirrored;
use crate::unit::{unit_quaternion, unit_vector};

/// How far `R R^T` may be from the identity, element by element, and the matrix still be taken for
/// a rotation that was rounded: about 17 rounding units of f32, and what a matrix printed with six
/// digits needs.
pub const ROTATION_TOLERANCE: f64 = 2e-6;

/// A matrix that is no rotation.
///
/// ```
/// use tumble_math::{NotARotation, quat_from_matrix};
/// let mirror = glam::DMat3::from_diagonal(glam::DVec3::new(-1.0, 1.0, 1.0));
/// assert_eq!(quat_from_matrix(mirror), Err(NotARotation::Reflection { determinant: -1.0 }));
/// ```
#[derive(Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum NotARotation {
    /// The rows are not orthonormal within [`ROTATION_TOLERANCE`], or not finite.
    #[error("the rows of the matrix are not orthonormal: R R^T differs from the identity by {error:?}")]
    NotOrthonormal {
        /// Largest element of `|R R^T - E|`; NaN if the matrix is not finite.
        error: f64,
    },
    /// The matrix is orthonormal but mirrors: its determinant is -1.
    #[error("the matrix is a reflection (determinant {determinant:?}), not a rotation")]
    Reflection {
        /// The determinant.
        determinant: f64,
    },
}

crate::debug_as_display!(NotARotation);

/// The matrix of multiplication by `q` from the left, `M(q) p = q p`, with quaternions as columns
/// `(x, y, z, w)`.
///
/// `M(a b) = M(a) M(b)`, and for a unit quaternion M is orthogonal.
///
/// ```
/// use tumble_math::{left_multiplication_matrix, right_multiplication_matrix};
/// use glam::{DQuat, DVec4};
///
/// let (a, b) = (DQuat::from_xyzw(1.0, 2.0, 3.0, 4.0), DQuat::from_xyzw(5.0, 6.0, 7.0, 8.0));
/// assert_eq!(left_multiplication_matrix(a) * DVec4::from(b), DVec4::from(a * b));
/// assert_eq!(right_multiplication_matrix(b) * DVec4::from(a), DVec4::from(a * b));
/// ```
#[must_use]
pub fn left_multiplication_matrix(q: DQuat) -> DMat4 {
    let DQuat { x, y, z, w } = q;
    DMat4::from_cols_array(&[w, z, -y, -x, -z, w, x, -y, y, -x, w, -z, x, y, z, w])
}

/// The matrix of multiplication by `q` from the right, `M(q) p = p q`, with quaternions as columns
/// `(x, y, z, w)`.
///
/// With [`left_multiplication_matrix`], `M_left(q) M_right(q*)` is the rotation matrix of a unit
/// quaternion bordered by zeros and a one.
///
/// ```
/// use glam::{DQuat, DVec4};
/// use tumble_math::right_multiplication_matrix;
/// let (a, b) = (DQuat::from_xyzw(1.0, 2.0, 3.0, 4.0), DQuat::from_xyzw(5.0, 6.0, 7.0, 8.0));
/// assert_eq!(right_multiplication_matrix(b) * DVec4::from(a), DVec4::from(a * b));
/// ```
#[must_use]
pub fn right_multiplication_matrix(q: DQuat) -> DMat4 {
    let DQuat { x, y, z, w } = q;
    DMat4::from_cols_array(&[w, -z, y, -x, z, w, -x, -y, -y, x, w, -z, x, y, z, w])
}

/// Axis (unit) and angle in `[0, pi]` of the rotation `q`, which need not be of unit length.
///
/// `q` and `-q` give the same answer (at exactly half a turn, `w = 0`, opposite axes). Exact to
/// rounding at every angle: glam's method gives zero for angles below 2e-8 and angles up to 2 pi.
/// No rotation, or no quaternion at all (zero, not finite), gives `(X, 0)`.
///
/// ```
/// use tumble_math::to_axis_angle;
/// let (axis, angle) = to_axis_angle(glam::DQuat::from_xyzw(0.0, -5e-13, 0.0, 1.0));
/// assert_eq!((axis, angle), (glam::DVec3::NEG_Y, 1e-12));
/// ```
#[must_use]
pub fn to_axis_angle(q: DQuat) -> (DVec3, f64) {
    let v = if q.w < 0.0 { -q.xyz() } else { q.xyz() };
    match unit_vector(v) {
        Some(axis) if q.w.is_finite() => {
            let angle = 2.0 * libm::atan2(v.dot(axis), q.w.abs());
            (axis, angle)
        }
        _ => (DVec3::X, 0.0),
    }
}

/// The rotation `q` as a vector along its axis with the angle, in `[0, pi]`, as length \[rad\].
///
/// The inverse of [`from_scaled_axis`] up to half a turn. At exactly half a turn both directions
/// are right.
///
/// ```
/// use tumble_math::to_scaled_axis;
/// let turn = to_scaled_axis(glam::DQuat::from_rotation_y(0.5));
/// assert!(turn.abs_diff_eq(glam::DVec3::Y * 0.5, 1e-15));
/// ```
#[must_use]
pub fn to_scaled_axis(q: DQuat) -> DVec3 {
    let (axis, angle) = to_axis_angle(q);
    axis * angle
}

/// The unit quaternion of the rotation about `v` by the angle `|v|` \[rad\].
///
/// `w = cos(|v|/2)`, `(x, y, z) = sin(|v|/2) / |v| v`. Exact to rounding for tiny `v` too, also
/// where `|v|^2` vanishes; NaN where `v` is not finite.
///
/// ```
/// use tumble_math::{angle_between, from_scaled_axis};
/// let quarter = from_scaled_axis(glam::DVec3::Z * std::f64::consts::FRAC_PI_2);
/// assert!(
///     angle_between(quarter, glam::DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2)) < 1e-15
/// );
/// ```
#[must_use]
pub fn from_scaled_axis(v: DVec3) -> DQuat {
    let Some(axis) = unit_vector(v) else {
        return if v == DVec3::ZERO {
            DQuat::IDENTITY
        } else {
            DQuat::from_xyzw(f64::NAN, f64::NAN, f64::NAN, f64::NAN)
        };
    };
    let (sin, cos) = (0.5 * v.dot(axis)).sin_cos();
    DQuat::from_xyzw(axis.x * sin, axis.y * sin, axis.z * sin, cos)
}

/// Angle in `[0, pi]` between two orientations \[rad\]: that of the turn which takes one to the
/// other.
///
/// `2 atan2(|v|, |w|)` of `a* b`, exact at every angle; `DQuat::angle_between` takes an arc cosine,
/// which knows no angle below 2e-8. Neither quaternion need be of unit length.
///
/// ```
/// use glam::DQuat;
/// use tumble_math::angle_between;
/// assert_eq!(angle_between(DQuat::IDENTITY, DQuat::from_xyzw(0.0, 5e-13, 0.0, 1.0)), 1e-12);
/// ```
#[must_use]
pub fn angle_between(a: DQuat, b: DQuat) -> f64 {
    // The product a* b, grouped so that equal quaternions give exactly zero.
    let v = (b.xyz() * a.w - a.xyz() * b.w) - a.xyz().cross(b.xyz());
    to_axis_angle(DQuat::from_vec4(v.extend(a.dot(b)))).1
}

/// The matrix `w*` of the cross product, `w* r = w x r`, with which a rotation matrix obeys
/// `dR/dt = w* R`.
///
/// ```
/// use tumble_math::cross_product_matrix;
/// use glam::DVec3;
/// let (w, r) = (DVec3::new(1.0, 2.0, 3.0), DVec3::new(-4.0, 5.0, 0.5));
/// assert_eq!(cross_product_matrix(w) * r, w.cross(r));
/// ```
#[must_use]
pub fn cross_product_matrix(w: DVec3) -> DMat3 {
    DMat3::from_cols_array(&[0.0, w.z, -w.y, -w.z, 0.0, w.x, w.y, -w.x, 0.0])
}

/// The unit quaternion, with `w >= 0`, of a rotation matrix.
///
/// The matrix is checked, within [`ROTATION_TOLERANCE`]; then the largest of the four components is
/// taken from the diagonal and the others from the off-diagonal elements, so nothing cancels at any
/// angle. Half a turn (`w = 0`) has two quaternions; the one is returned whose largest component is
/// positive.
///
/// Source: S. W. Shepperd, "Quaternion from rotation matrix", J. Guidance and Control 1 (1978).
///
/// # Errors
/// A matrix that is not orthonormal, or that mirrors.
///
/// ```
/// use tumble_math::quat_from_matrix;
/// use glam::{DMat3, DVec3};
/// assert!(quat_from_matrix(DMat3::from_rotation_x(3.0)).is_ok());
/// assert!(quat_from_matrix(DMat3::from_diagonal(DVec3::new(1.0, 1.0, -1.0))).is_err());
/// ```
pub fn quat_from_matrix(matrix: DMat3) -> Result<DQuat, NotARotation> {
    let difference = (matrix * matrix.transpose() - DMat3::IDENTITY).to_cols_array();
    let largest = difference.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    let error = if matrix.is_finite() { largest } else { f64::NAN };
    let orthonormal = error <= ROTATION_TOLERANCE;
    if !orthonormal {
        return Err(NotARotation::NotOrthonormal { error });
    }
    let determinant = matrix.determinant();
    if determinant < 0.0 {
        return Err(NotARotation::Reflection { determinant });
    }
    Ok(quat_from_orthonormal(matrix))
}

/// [`quat_from_matrix`] without the check.
pub(crate) fn quat_from_orthonormal(m: DMat3) -> DQuat {
    let (xx, yy, zz) = (m.x_axis.x, m.y_axis.y, m.z_axis.z);
    // Four times the products of the components: yx is row y, column x.
    let (xy, xz, yz) = (m.x_axis.y + m.y_axis.x, m.x_axis.z + m.z_axis.x, m.y_axis.z + m.z_axis.y);
    let (wx, wy, wz) = (m.y_axis.z - m.z_axis.y, m.z_axis.x - m.x_axis.z, m.x_axis.y - m.y_axis.x);
    let trace = xx + yy + zz;
    let q = if trace >= xx && trace >= yy && trace >= zz {
        DQuat::from_xyzw(wx, wy, wz, 1.0 + trace)
    } else if xx >= yy && xx >= zz {
        DQuat::from_xyzw(1.0 + xx - yy - zz, xy, xz, wx)
    } else if yy >= zz {
        DQuat::from_xyzw(xy, 1.0 + yy - xx - zz, yz, wy)
    } else {
        DQuat::from_xyzw(xz, yz, 1.0 + zz - xx - yy, wz)
    };
    let q = q.normalize();
    if q.w < 0.0 { -q } else { q }
}

/// The matrix `m` of the frame `B` seen from the frame `A`, where `basis` takes coordinates of `B`
/// to those of `A`: `R m R^T`.
///
/// `R`, of determinant one, is that of the normalised `basis`, which must not be zero. A symmetric
/// matrix stays symmetric to the bit; anything else is computed as it stands.
///
/// ```
/// use tumble_math::change_of_basis;
/// use glam::{DMat3, DQuat, DVec3};
/// let body = DMat3::from_diagonal(DVec3::new(1.0, 2.0, 3.0));
/// let world = change_of_basis(body, DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2));
/// assert!(world.abs_diff_eq(DMat3::from_diagonal(DVec3::new(2.0, 1.0, 3.0)), 1e-15));
/// ```
#[must_use]
pub fn change_of_basis(m: DMat3, basis: DQuat) -> DMat3 {
    let r = DMat3::from_quat(unit_quaternion(basis).unwrap_or_else(|_| basis.normalize()));
    let turned = r * m * r.transpose();
    if m == m.transpose() { mirrored(turned) } else { turned }
}
