//! The inertia tensor of a rigid body, valid by construction.

use std::ops::{Add, RangeInclusive};

use glam::{DMat3, DQuat, DVec3};

use crate::inertia_error::InertiaError;
use crate::principal::PrincipalInertia;
use crate::rotation::change_of_basis;
use crate::symmetric::mirrored;
use crate::symmetric_eigen::symmetric_eigen;
use crate::unit::{unit_quaternion, unit_vector};

/// The inertia tensor `I` of a rigid body about some point, in some frame [kg m^2].
///
/// ```text
/// I = integral of (|r|^2 E - r r^T) dm        L = I w        T = 1/2 w . I w
/// I_xx = integral of (y^2 + z^2) dm           I_xy = - integral of x y dm
/// ```
///
/// The off-diagonal elements are *matrix elements*: minus the integrals of `x y`, `y z`, `x z`.
/// Some tables list the integrals themselves as "products of inertia" (NASA's do); negate those.
///
/// A value of this type is finite, symmetric to the bit, positive definite, and obeys the triangle
/// inequality of principal moments, all within a stated tolerance. Which point and which frame it
/// belongs to is the caller's to know; the mass properties of a body keep it about the centre of
/// mass, in body axes.
///
/// Source: H. Goldstein, C. Poole, J. Safko, "Classical Mechanics", 3rd ed., sections 5.3 and 5.4.
///
/// ```
/// use tumble_math::InertiaTensor;
/// use glam::{DMat3, DVec3};
///
/// let inertia = InertiaTensor::new(DMat3::from_diagonal(DVec3::new(1.0, 2.0, 2.5)))?;
/// assert_eq!(inertia.angular_momentum([0.0, 3.0, 0.0]), DVec3::new(0.0, 6.0, 0.0));
/// assert!(InertiaTensor::new(DMat3::from_diagonal(DVec3::new(1.0, 2.0, 3.5))).is_err());
/// # Ok::<(), tumble_math::InertiaError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InertiaTensor(DMat3);

impl InertiaTensor {
    /// The relative tolerance of [`new`](Self::new): some rounding units of f32 (6e-8), so that the
    /// tensor of a flat plate, `I3 = I1 + I2`, still passes after a trip through single precision.
    pub const TOLERANCE: f64 = 1e-6;

    /// Principal moments outside this range [kg m^2] are refused: their inverses and sums would
    /// overflow.
    pub const MOMENTS: RangeInclusive<f64> = 1e-300..=1e300;

    /// A tensor from its matrix [kg m^2], checked with [`TOLERANCE`](Self::TOLERANCE).
    ///
    /// # Errors
    /// As [`within_tolerance`](Self::within_tolerance).
    pub fn new(matrix: DMat3) -> Result<Self, InertiaError> {
        Self::within_tolerance(matrix, Self::TOLERANCE)
    }

    /// A tensor from its matrix [kg m^2]. Mirrored elements may differ by `relative` times the
    /// largest element (their mean is kept), and the largest principal moment may exceed the sum of
    /// the others by `relative` times itself. Published moments of flat bodies, rounded to three
    /// digits, need about 3e-3. The matrix is kept as it is; what is made of it moves as its
    /// [`nearest_possible`](Self::nearest_possible).
    ///
    /// Positive definite is meant up to rounding, with no tolerance: with `S = diag(I)^(-1/2)`, the
    /// smallest eigenvalue of `S I S` must exceed 16 eps. So moments of 1e-12, 1e12 and 1e12 pass
    /// where the matrix is diagonal and they are exact, but not where a rotation has buried the
    /// small one in the rounding of the large ones.
    ///
    /// # Errors
    /// [`InertiaError`] says which condition failed, with the numbers. A tolerance of NaN accepts
    /// nothing that needs one.
    pub fn within_tolerance(matrix: DMat3, relative: f64) -> Result<Self, InertiaError> {
        let symmetric = symmetrised(matrix, relative)?;
        let moments = sorted(symmetric_eigen(symmetric).0);
        check_moments(moments, relative)?;
        if !definite_beyond_rounding(symmetric) {
            return Err(InertiaError::NotPositive { principal: moments });
        }
        Ok(Self(symmetric))
    }

    /// The nearest tensor that a body can have: where the largest principal moment exceeds the sum
    /// of the others by more than [`TOLERANCE`](Self::TOLERANCE), a third of the excess is taken
    /// from it and added to each of the others, which is the least change of the three. Any other
    /// tensor as it is.
    ///
    /// Mass properties and rigid bodies take this, since no solution of Euler's equations is known
    /// to keep its energy for moments that no body has.
    ///
    /// ```
    /// use tumble_math::InertiaTensor;
    /// use glam::{DMat3, DVec3};
    /// // A flat plate, whose moments were published with three digits.
    /// let plate = DMat3::from_diagonal(DVec3::new(0.345, 0.653, 1.0));
    /// let plate = InertiaTensor::within_tolerance(plate, 3e-3)?.nearest_possible();
    /// assert!(InertiaTensor::new(plate.matrix()).is_ok());
    /// assert!((plate.moment_about([0.0, 0.0, 1.0]) - (1.0 - 0.002 / 3.0)).abs() < 1e-15);
    /// # Ok::<(), tumble_math::InertiaError>(())
    /// ```
    #[must_use]
    pub fn nearest_possible(&self) -> Self {
        let principal = self.principal();
        let largest = principal.moments.max_element();
        let excess = 2.0 * largest - principal.moments.element_sum();
        if excess <= Self::TOLERANCE * largest {
            return *self;
        }
        let third = excess / 3.0;
        let change = |moment: f64| if moment == largest { moment - third } else { moment + third };
        let [x, y, z] = principal.moments.to_array().map(change);
        Self(PrincipalInertia { moments: DVec3::new(x, y, z), axes: principal.axes }.matrix())
    }

    /// The tensor with principal moments `moments` [kg m^2] along the axes that `axes` makes of x,
    /// y and z: `I = R(axes) diag(moments) R(axes)^T`. The length of `axes` may be off by rounding.
    ///
    /// # Errors
    /// A moment that is not positive, a broken triangle inequality (tolerance
    /// [`TOLERANCE`](Self::TOLERANCE)), or a quaternion that is no rotation.
    pub fn from_principal(moments: impl Into<DVec3>, axes: DQuat) -> Result<Self, InertiaError> {
        let diagonal = Self::new(DMat3::from_diagonal(moments.into()))?;
        diagonal.rotated(axes)
    }

    /// The tensor of a body symmetric about `axis` (any length): `axial` about that axis,
    /// `transverse` about every axis across it [kg m^2]: `I = t E + (a - t) n n^T`.
    ///
    /// ```
    /// use tumble_math::InertiaTensor;
    /// let wheel = InertiaTensor::axisymmetric(2.0, 1.5, [0.0, 1.0, 1.0])?;
    /// assert!((wheel.moment_about([0.0, 5.0, 5.0]) - 2.0).abs() < 1e-15);
    /// assert!((wheel.moment_about([1.0, 0.0, 0.0]) - 1.5).abs() < 1e-15);
    /// # Ok::<(), tumble_math::InertiaError>(())
    /// ```
    ///
    /// # Errors
    /// An axis without direction, or moments that [`new`](Self::new) refuses.
    pub fn axisymmetric(axial: f64, transverse: f64, axis: impl Into<DVec3>) -> Result<Self, InertiaError> {
        let axis = axis.into();
        Self::new(DMat3::from_diagonal(DVec3::new(axial, transverse, transverse)))?;
        let n = unit_vector(axis).ok_or(InertiaError::Axis { axis })?;
        Self::new(mirrored(DMat3::from_diagonal(DVec3::splat(transverse)) + outer(n) * (axial - transverse)))
    }

    /// The matrix [kg m^2], symmetric to the bit.
    #[must_use]
    pub fn matrix(&self) -> DMat3 {
        self.0
    }

    /// The inverse matrix [1/(kg m^2)], symmetric to the bit. By `L D L^T` factors, whose error
    /// does not grow when the three axes have very different moments; a diagonal tensor gives exact
    /// reciprocals.
    #[must_use]
    pub fn inverse(&self) -> DMat3 {
        let m = self.0;
        let (xx, yx, zx) = (m.x_axis.x, m.x_axis.y, m.x_axis.z);
        // I = L D L^T, L unit lower triangular with l1 = L_yx, l2 = L_zx, l3 = L_zy.
        let (l1, l2) = (yx / xx, zx / xx);
        let d2 = m.y_axis.y - yx * l1;
        let zy = m.y_axis.z - zx * l1;
        let l3 = zy / d2;
        let d3 = m.z_axis.z - zx * l2 - zy * l3;
        // L^-1 has the rows (1, 0, 0), (-l1, 1, 0), (k, -l3, 1).
        let k = l1 * l3 - l2;
        let (e1, e2, e3) = (1.0 / xx, 1.0 / d2, 1.0 / d3);
        let inverse_xy = -l1 * e2 - k * l3 * e3;
        let inverse_xz = k * e3;
        let inverse_yz = -l3 * e3;
        DMat3::from_cols(
            DVec3::new(e1 + l1 * l1 * e2 + k * k * e3, inverse_xy, inverse_xz),
            DVec3::new(inverse_xy, e2 + l3 * l3 * e3, inverse_yz),
            DVec3::new(inverse_xz, inverse_yz, e3),
        )
    }

    /// Moment of inertia about the axis through the tensor's point along `axis` (any length) [kg
    /// m^2]: `n^T I n`. NaN if `axis` is zero or not finite.
    #[must_use]
    pub fn moment_about(&self, axis: impl Into<DVec3>) -> f64 {
        unit_vector(axis.into()).map_or(f64::NAN, |n| n.dot(self.0 * n))
    }

    /// The tensor of the body turned by `rotation` about the tensor's point: `R I R^T`. Seen
    /// otherwise, `rotation` takes coordinates of the frame the tensor is given in to those of the
    /// frame wanted.
    ///
    /// # Errors
    /// [`InertiaError::Orientation`] if the length of `rotation` is further than 1e-3 from one
    /// (closer is normalised), and [`InertiaError::NotPositive`] if a moment is so small that the
    /// turned matrix cannot hold it.
    pub fn rotated(&self, rotation: DQuat) -> Result<Self, InertiaError> {
        let rotation = unit_quaternion(rotation).map_err(|length| InertiaError::Orientation { length })?;
        let turned = change_of_basis(self.0, rotation);
        definite_after_turning(turned)?;
        Ok(Self(turned))
    }

    /// From the centre of mass to a point `offset` \[m\] away, `mass` in kg: the parallel-axis
    /// theorem as a tensor (Steiner), `I' = I + m (d^2 E - d d^T)`. Axes stay parallel.
    ///
    /// # Errors
    /// A mass that is negative or not finite, an offset that is not finite, or a result out of
    /// range.
    pub fn shifted_from_center(&self, mass: f64, offset: impl Into<DVec3>) -> Result<Self, InertiaError> {
        Self::new(self.0 + steiner(mass, offset.into())?)
    }

    /// From a point to the centre of mass `offset` \[m\] away (either sign), `mass` in kg:
    /// `I' = I - m (d^2 E - d d^T)`.
    ///
    /// # Errors
    /// As [`new`](Self::new): too large a mass or offset leaves moments that no body has. Mass and
    /// offset as in [`shifted_from_center`](Self::shifted_from_center).
    pub fn shifted_to_center(&self, mass: f64, offset: impl Into<DVec3>) -> Result<Self, InertiaError> {
        let moved = Self::new(self.0 - steiner(mass, offset.into())?)?;
        let principal = sorted(symmetric_eigen(moved.0).0);
        // The subtraction leaves a few eps of what was there before.
        if principal.x > 8.0 * f64::EPSILON * symmetric_eigen(self.0).0.max_element() {
            Ok(moved)
        } else {
            Err(InertiaError::NotPositive { principal })
        }
    }

    /// Angular momentum `L = I w` [kg m^2/s] at the angular velocity `w` [rad/s], both in the
    /// tensor's frame.
    #[must_use]
    pub fn angular_momentum(&self, angular_velocity: impl Into<DVec3>) -> DVec3 {
        self.0 * angular_velocity.into()
    }

    /// Kinetic energy of rotation `1/2 w . I w` \[J\] at the angular velocity `w` [rad/s] in the
    /// tensor's frame.
    #[must_use]
    pub fn kinetic_energy(&self, angular_velocity: impl Into<DVec3>) -> f64 {
        let w = angular_velocity.into();
        0.5 * w.dot(self.0 * w)
    }

    /// Principal moments and axes. A diagonal tensor gives its diagonal, in its order, and the
    /// identity, exactly. See [`PrincipalInertia`] for which of the possible frames it is.
    ///
    /// The moments have a small relative error as long as the tensor is well conditioned up to the
    /// scale of its axes; the axes put together again give the tensor within a few eps of its
    /// largest element.
    #[must_use]
    pub fn principal(&self) -> PrincipalInertia {
        let (moments, axes) = symmetric_eigen(self.0);
        PrincipalInertia::nearest_frame(moments, axes)
    }
}

/// Tensors about the same point in the same frame add: the inertia of two bodies fixed to each
/// other.
///
/// The sum of valid tensors is valid. It may exceed [`InertiaTensor::MOMENTS`], and overflow after
/// a hundred million terms at that limit.
impl Add for InertiaTensor {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

/// `m (d^2 E - d d^T)`: the inertia of a mass `m` at `d` about the origin, of [`parallel_axis`]
/// with its input checked.
fn steiner(mass: f64, offset: DVec3) -> Result<DMat3, InertiaError> {
    if !(mass.is_finite() && mass >= 0.0) {
        return Err(InertiaError::Mass { mass });
    }
    let term = parallel_axis(mass, offset);
    if term.is_finite() { Ok(term) } else { Err(InertiaError::Offset { offset }) }
}

/// `m (d^2 E - d d^T)` [kg m^2]: the inertia about the origin of a point mass `m` \[kg\] at `d`
/// \[m\], and the term of the parallel-axis theorem. Diagonal elements as sums of two squares, so
/// nothing cancels.
///
/// ```
/// use glam::{DMat3, DVec3};
/// use tumble_math::parallel_axis;
/// let rim = parallel_axis(2.0, DVec3::X * 3.0);
/// assert_eq!(rim, DMat3::from_diagonal(DVec3::new(0.0, 18.0, 18.0)));
/// ```
#[must_use]
pub fn parallel_axis(mass: f64, d: DVec3) -> DMat3 {
    let (x, y, z) = (d.x, d.y, d.z);
    let (xy, xz, yz) = (-mass * x * y, -mass * x * z, -mass * y * z);
    DMat3::from_cols(
        DVec3::new(mass * (y * y + z * z), xy, xz),
        DVec3::new(xy, mass * (x * x + z * z), yz),
        DVec3::new(xz, yz, mass * (x * x + y * y)),
    )
}

/// `n n^T`.
fn outer(n: DVec3) -> DMat3 {
    DMat3::from_cols(n * n.x, n * n.y, n * n.z)
}

/// Checks finiteness and symmetry; gives the mean of the two halves.
fn symmetrised(matrix: DMat3, relative: f64) -> Result<DMat3, InertiaError> {
    let m = matrix.to_cols_array_2d(); // m[column][row]
    for (column, elements) in m.iter().enumerate() {
        for (row, &value) in elements.iter().enumerate() {
            if !value.is_finite() {
                return Err(InertiaError::NotFinite { row, column, value });
            }
        }
    }
    let largest = m.as_flattened().iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
    let mut mean = m;
    for (row, column) in [(0, 1), (0, 2), (1, 2)] {
        let (upper, lower) = (m[column][row], m[row][column]);
        if upper != lower {
            let within = (upper - lower).abs() <= relative * largest;
            if !within {
                return Err(InertiaError::NotSymmetric { row, column, upper, lower });
            }
        }
        let value = 0.5 * upper + 0.5 * lower;
        mean[column][row] = value;
        mean[row][column] = value;
    }
    Ok(DMat3::from_cols_array_2d(&mean))
}

fn sorted(v: DVec3) -> DVec3 {
    let mut moments = v.to_array();
    moments.sort_by(f64::total_cmp);
    DVec3::from_array(moments)
}

/// Positive, in range, triangle inequality. `moments` ascending.
fn check_moments(moments: DVec3, relative: f64) -> Result<(), InertiaError> {
    let principal = moments;
    if moments.x <= 0.0 {
        return Err(InertiaError::NotPositive { principal });
    }
    if moments.x < *InertiaTensor::MOMENTS.start() || moments.z > *InertiaTensor::MOMENTS.end() {
        return Err(InertiaError::OutOfRange { principal });
    }
    let excess = moments.z - (moments.x + moments.y);
    if excess <= 0.0 || excess <= relative * moments.z {
        Ok(())
    } else {
        Err(InertiaError::TriangleInequality { principal })
    }
}

/// Whether a matrix that has been turned, with every element known to a few eps of the largest
/// moment, is positive definite beyond that: a thin rod turned a little has a smallest moment that
/// is all rounding. 32 eps: a turn, `R I R^T`, costs up to 25. A diagonal matrix has not been
/// turned, or not by more than a renaming of its axes.
pub(crate) fn definite_after_turning(m: DMat3) -> Result<(), InertiaError> {
    let diagonal = m.y_axis.x == 0.0 && m.z_axis.x == 0.0 && m.z_axis.y == 0.0;
    let principal = sorted(symmetric_eigen(m).0);
    let rounding = if diagonal { 0.0 } else { 32.0 * f64::EPSILON * principal.z };
    if principal.x > rounding { Ok(()) } else { Err(InertiaError::NotPositive { principal }) }
}

/// Whether a symmetric matrix is positive definite by more than its rounding, whatever the units of
/// each axis: the smallest eigenvalue of `S I S`, `S = diag(I)^(-1/2)`, exceeds 16 eps. The
/// elements of `S I S` are at most 1 and carry a few eps each of error from having been computed,
/// and so do its eigenvalues.
fn definite_beyond_rounding(m: DMat3) -> bool {
    let diagonal = DVec3::new(m.x_axis.x, m.y_axis.y, m.z_axis.z);
    if diagonal.min_element() <= 0.0 {
        return false;
    }
    let s = DVec3::new(diagonal.x.sqrt(), diagonal.y.sqrt(), diagonal.z.sqrt());
    let (xy, xz, yz) = (m.y_axis.x / s.x / s.y, m.z_axis.x / s.x / s.z, m.z_axis.y / s.y / s.z);
    let scaled = DMat3::from_cols(DVec3::new(1.0, xy, xz), DVec3::new(xy, 1.0, yz), DVec3::new(xz, yz, 1.0));
    symmetric_eigen(scaled).0.min_element() > 16.0 * f64::EPSILON
}
