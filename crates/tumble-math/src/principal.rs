//! Principal moments and axes.

use glam::{DMat3, DQuat, DVec3};

use crate::inertia::{InertiaTensor, mirrored};
use crate::rotation::quat_from_orthonormal;

/// The six orders of three columns; the first leaves them as they are.
const PERMUTATIONS: [[usize; 3]; 6] = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];

/// Principal moments of inertia and the frame in which the tensor is diagonal:
/// `I = R(axes) diag(moments) R(axes)^T`.
///
/// `axes` takes principal-frame coordinates to body-frame coordinates; its columns `R x, R y, R z` are the principal
/// axes, right-handed. Of the 24 right-handed frames along the same three lines it is the one nearest the body
/// frame (largest trace of R), so a diagonal tensor has the identity here and keeps the order of its
/// moments. Where moments are equal, the axes within their plane are one choice of many.
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
    /// From eigenvalues and orthonormal eigenvectors (columns) in any order and of any handedness.
    pub(crate) fn nearest_frame(moments: DVec3, vectors: DMat3) -> Self {
        let mut best = (f64::NEG_INFINITY, PERMUTATIONS[0], [1.0; 3]);
        for order in PERMUTATIONS {
            let (trace, signs) = largest_trace(vectors, order);
            if trace > best.0 {
                best = (trace, order, signs);
            }
        }
        let (_, [i, j, k], signs) = best;
        let column = |index: usize, sign: f64| vectors.col(index) * sign;
        let r = DMat3::from_cols(column(i, signs[0]), column(j, signs[1]), column(k, signs[2]));
        Self { moments: DVec3::new(moments[i], moments[j], moments[k]), axes: quat_from_orthonormal(r) }
    }

    /// The matrix `R(axes) diag(moments) R(axes)^T` [kg m^2] in the body frame.
    #[must_use]
    pub fn matrix(&self) -> DMat3 {
        let r = DMat3::from_quat(self.axes);
        mirrored(r * DMat3::from_diagonal(self.moments) * r.transpose())
    }

    /// Angular momentum in the world frame [kg m^2/s] of a body with `orientation` (body to world) at the world-frame angular
    /// velocity `w` [rad/s]: with `q = orientation * axes`, `L = q (moments * (q^-1 w))`.
    ///
    /// For a change of angular velocity it is the angular impulse [N m s] that brings the change about, and over `dt` seconds
    /// the torque [N m] to apply: the idiom of Unity's `inertiaTensor` and `inertiaTensorRotation`.
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

    /// How a small disturbance of a spin about principal axis `axis` (0, 1 or 2) grows: the square of its rate over the
    /// square of the spin,
    ///
    /// ```text
    /// (lambda / w)^2 = (I_j - I_i)(I_i - I_k) / (I_j I_k)        i the axis, j and k the other two
    /// ```
    ///
    /// Negative about the axes of largest and smallest moment: the spin is stable and wobbles at `w sqrt(-s)`.
    /// Positive about the middle one: the disturbance grows as `exp(w sqrt(s) t)` and the body flips over, as
    /// the T-handle does. Zero where two moments are equal. NaN if there is no such axis.
    ///
    /// Source: L. D. Landau, E. M. Lifshitz, "Mechanics", 3rd ed., section 37.
    ///
    /// ```
    /// use tumble_math::PrincipalInertia;
    /// let book = PrincipalInertia { moments: [1.0, 2.0, 2.5].into(), axes: glam::DQuat::IDENTITY };
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

/// The signs that make the columns in this order right-handed with the largest trace, and that trace.
fn largest_trace(vectors: DMat3, order: [usize; 3]) -> (f64, [f64; 3]) {
    let diagonal = [0, 1, 2].map(|row| vectors.col(order[row])[row]);
    let mut signs = diagonal.map(|x| 1.0_f64.copysign(x));
    let permuted = DMat3::from_cols(
        vectors.col(order[0]) * signs[0],
        vectors.col(order[1]) * signs[1],
        vectors.col(order[2]) * signs[2],
    );
    let mut trace: f64 = diagonal.iter().map(|x| x.abs()).sum();
    if permuted.determinant() < 0.0 {
        // Turn the column that costs least.
        let weakest = (0..3).min_by(|&a, &b| diagonal[a].abs().total_cmp(&diagonal[b].abs())).unwrap_or(0);
        signs[weakest] = -signs[weakest];
        trace -= 2.0 * diagonal[weakest].abs();
    }
    (trace, signs)
}
