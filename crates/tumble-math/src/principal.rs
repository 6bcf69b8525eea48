//! Principal moments and axes.

use glam::{DMat3, DQuat, DVec3};

use crate::inertia::InertiaTensor;
use crate::rotation::quat_from_orthonormal;
use crate::symmetric::mirrored;

/// The six orders of three columns; the first leaves them as they are.
const PERMUTATIONS: [[usize; 3]; 6] = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];

/// Principal moments of inertia and the frame in which the tensor is diagonal:
/// `I = R(axes) diag(moments) R(axes)^T`.
///
/// `axes` takes principal-frame coordinates to body-frame coordinates; its columns `R x, R y, R z`
/// are the principal axes, right-handed. Of the 24 right-handed frames along the same three lines
/// it is the one nearest the body frame (largest trace of R), so a diagonal tensor has the identity
/// here and keeps the order of its moments. Where moments are equal, the axes within their plane
/// are one choice of many.
///
/// ```
/// use tumble_math::InertiaTensor;
/// use glam::DQuat;
///
/// let tilted = InertiaTensor::from_principal([3.0, 1.0, 2.5], DQuat::from_rotation_z(0.3))?;
/// let principal = tilted.principal();
/// assert!((principal.moments - glam::DVec3::new(3.0, 1.0, 2.5)).length() < 1e-14);
/// assert!(principal.axes.dot(DQuat::from_rotation_z(0.3)) > 1.0 - 1e-14);
/// # Ok::<(), tumble_math::InertiaError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrincipalInertia {
    /// Moments about the principal axes, in the order of the axes [kg m^2].
    pub moments: DVec3,
    /// Rotation from the principal frame to the body frame, a unit quaternion with `w >= 0`.
    pub axes: DQuat,
}

impl PrincipalInertia {
    /// From eigenvalues and orthonormal right-handed eigenvectors (columns) in any order.
    ///
    /// For each order of the columns the signs that make the diagonal positive give the largest
    /// trace. The best of the six is right-handed by itself: two cubes are never turned
    /// by more than 62.8 degrees against each other (J. K. Mackenzie, Biometrika 45, 1958), so a
    /// right-handed frame reaches a trace of 1
    /// + 2 cos(62.8 deg) = 1.9, and a left-handed one, minus a rotation, none above 1.
    pub(crate) fn nearest_frame(moments: DVec3, vectors: DMat3) -> Self {
        let trace = |order: [usize; 3]| -> f64 { (0..3).map(|row| vectors.col(order[row])[row].abs()).sum() };
        let mut best = PERMUTATIONS[0];
        for order in PERMUTATIONS {
            // Strictly: of equals the first, so that the identity stays.
            if trace(order) > trace(best) {
                best = order;
            }
        }
        let axis = |row: usize| {
            let column = vectors.col(best[row]);
            column * 1.0_f64.copysign(column[row])
        };
        let [i, j, k] = best;
        Self {
            moments: DVec3::new(moments[i], moments[j], moments[k]),
            axes: quat_from_orthonormal(DMat3::from_cols(axis(0), axis(1), axis(2))),
        }
    }

    /// The matrix `R(axes) diag(moments) R(axes)^T` [kg m^2] in the body frame.
    #[must_use]
    pub fn matrix(&self) -> DMat3 {
        let r = DMat3::from_quat(self.axes);
        mirrored(r * DMat3::from_diagonal(self.moments) * r.transpose())
    }

    /// Angular momentum in the world frame [kg m^2/s] of a body with `orientation` (body to world)
    /// at the world-frame angular velocity `w` [rad/s]: with `q = orientation * axes`,
    /// `L = q (moments * (q^-1 w))`.
    ///
    /// For a change of angular velocity it is the angular impulse [N m s] that brings the change
    /// about, and over `dt` seconds the torque [N m] to apply: the idiom of Unity's `inertiaTensor`
    /// and `inertiaTensorRotation`.
    ///
    /// ```
    /// use tumble_math::PrincipalInertia;
    /// use glam::{DQuat, DVec3};
    /// let body = PrincipalInertia { moments: [1.0, 2.0, 2.5].into(), axes: DQuat::IDENTITY };
    /// let (now, wanted) = (DVec3::ZERO, DVec3::new(0.0, 0.0, 4.0));
    /// let orientation = DQuat::from_rotation_y(std::f64::consts::FRAC_PI_2); // body x is world -z
    /// let impulse = body.angular_momentum_world(orientation, wanted - now);
    /// assert!((impulse - DVec3::new(0.0, 0.0, 4.0)).length() < 1e-14);
    /// ```
    #[must_use]
    pub fn angular_momentum_world(&self, orientation: DQuat, angular_velocity: DVec3) -> DVec3 {
        let q = orientation * self.axes;
        q * (self.moments * (q.conjugate() * angular_velocity))
    }

    /// How a small disturbance of a spin about principal axis `axis` (0, 1 or 2) grows: the square
    /// of its rate over the square of the spin,
    ///
    /// ```text
    /// (lambda / w)^2 = (I_j - I_i)(I_i - I_k) / (I_j I_k)        i the axis, j and k the other two
    /// ```
    ///
    /// Negative about the axes of largest and smallest moment: the spin is stable and wobbles at
    /// `w sqrt(-s)`. Positive about the middle one: the disturbance grows as `exp(w sqrt(s) t)` and
    /// the body flips over, as the T-handle does. Zero where two moments are equal. NaN if there is
    /// no such axis.
    ///
    /// Source: L. D. Landau, E. M. Lifshitz, "Mechanics", 3rd ed., section 37.
    ///
    /// ```
    /// use tumble_math::PrincipalInertia;
    /// let book =
    ///     PrincipalInertia { moments: [1.0, 2.0, 2.5].into(), axes: glam::DQuat::IDENTITY };
    /// let stability: Vec<f64> = (0..3).map(|axis| book.spin_instability(axis)).collect();
    /// assert!(stability[0] < 0.0 && stability[1] > 0.0 && stability[2] < 0.0);
    /// ```
    #[must_use]
    pub fn spin_instability(&self, axis: usize) -> f64 {
        if axis > 2 {
            return f64::NAN;
        }
        let (i, j, k) = (self.moments[axis], self.moments[(axis + 1) % 3], self.moments[(axis + 2) % 3]);
        ((j - i) / j) * ((i - k) / k)
    }
}

impl From<InertiaTensor> for PrincipalInertia {
    fn from(inertia: InertiaTensor) -> Self {
        inertia.principal()
    }
}
