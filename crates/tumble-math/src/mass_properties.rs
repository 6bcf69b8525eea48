//! Mass, centre of mass and inertia of a rigid body.

use std::ops::{Add, RangeInclusive};

use glam::{DMat3, DQuat, DVec3};

use crate::inertia::{InertiaTensor, definite_after_turning, parallel_axis};
use crate::inertia_error::InertiaError;
use crate::mass_error::MassError;
use crate::rotation::change_of_basis;
use crate::symmetric_eigen::symmetric_eigen;
use crate::unit::unit_quaternion;

/// Mass \[kg\], centre of mass \[m\] and inertia tensor about the centre of mass [kg m^2] of a
/// rigid body, in one frame.
///
/// The tensor may be singular, unlike an [`InertiaTensor`]: a point mass has none, a thin rod none
/// about itself. Two bodies fixed to each other add; a hole is taken away with
/// [`without`](Self::without).
///
/// Masses lie in [`MASSES`](Self::MASSES) and coordinates within [`REACH`](Self::REACH), so that no
/// sum of a realistic number of bodies overflows.
///
/// ```
/// use tumble_math::MassProperties;
/// use glam::DVec3;
///
/// // A dumbbell: two masses on a massless bar.
/// let a = MassProperties::point(2.0, [-1.0, 0.0, 0.0])?;
/// let b = MassProperties::point(6.0, [1.0, 0.0, 0.0])?;
/// let dumbbell = a + b;
/// assert_eq!(dumbbell.mass(), 8.0);
/// assert_eq!(dumbbell.center_of_mass(), DVec3::new(0.5, 0.0, 0.0));
/// assert_eq!(dumbbell.tensor_about_center().col(1), DVec3::new(0.0, 6.0, 0.0));
/// assert!(dumbbell.inertia().is_err()); // nothing resists a turn about the bar
/// # Ok::<(), tumble_math::MassError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassProperties {
    mass: f64,
    center_of_mass: DVec3,
    tensor: DMat3,
}

impl MassProperties {
    /// Masses outside this range \[kg\] are refused. An electron has 1e-30, the observable universe
    /// 1e53.
    pub const MASSES: RangeInclusive<f64> = 1e-100..=1e100;

    /// Coordinates further out than this \[m\] are refused: mass times distance squared must stay
    /// far from overflow.
    pub const REACH: f64 = 1e90;

    /// From a mass \[kg\], the centre of mass \[m\] and the inertia about the centre of mass [kg
    /// m^2]; of a tensor that was accepted with a tolerance the
    /// [`nearest_possible`](InertiaTensor::nearest_possible).
    ///
    /// # Errors
    /// A mass or a position out of range.
    pub fn new(mass: f64, center_of_mass: impl Into<DVec3>, inertia: InertiaTensor) -> Result<Self, MassError> {
        Self::from_parts(mass, center_of_mass.into(), inertia.nearest_possible().matrix())
    }

    /// A point mass \[kg\] at `position` \[m\]. Its tensor about itself is zero.
    ///
    /// # Errors
    /// A mass or a position out of range.
    pub fn point(mass: f64, position: impl Into<DVec3>) -> Result<Self, MassError> {
        Self::from_parts(mass, position.into(), DMat3::ZERO)
    }

    /// Particles `(mass, position)` \[kg, m\] fixed to each other.
    ///
    /// ```text
    /// M = sum m_i      c = sum m_i x_i / M
    /// I = sum m_i (|r_i|^2 E - r_i r_i^T),  r_i = x_i - c
    /// ```
    ///
    /// ```
    /// use tumble_math::MassProperties;
    /// use glam::DVec3;
    /// let corners = [-1.0, 1.0].map(|x| (0.5, DVec3::new(x, 0.0, 0.0)));
    /// let rod = MassProperties::of_particles(corners)?;
    /// assert_eq!(rod.tensor_about_center().col(2).z, 1.0);
    /// # Ok::<(), tumble_math::MassError>(())
    /// ```
    ///
    /// # Errors
    /// No particle at all, or one with a mass or a position out of range (named by its index).
    pub fn of_particles(particles: impl IntoIterator<Item = (f64, DVec3)>) -> Result<Self, MassError> {
        let mut sum: Option<Self> = None;
        for (index, (mass, position)) in particles.into_iter().enumerate() {
            let particle = Self::point(mass, position)
                .map_err(|source| MassError::Particle { index, source: Box::new(source) })?;
            sum = Some(sum.map_or(particle, |sum| sum + particle));
        }
        sum.ok_or(MassError::NoParticles)
    }

    /// Checks mass and position; the tensor is the caller's word.
    pub(crate) fn from_parts(mass: f64, center_of_mass: DVec3, tensor: DMat3) -> Result<Self, MassError> {
        check_mass(mass)?;
        check_position(center_of_mass)?;
        Ok(Self { mass, center_of_mass, tensor })
    }

    /// Mass \[kg\].
    #[must_use]
    pub fn mass(&self) -> f64 {
        self.mass
    }

    /// Centre of mass \[m\].
    #[must_use]
    pub fn center_of_mass(&self) -> DVec3 {
        self.center_of_mass
    }

    /// Inertia tensor about the centre of mass, axes parallel to those of the frame [kg m^2].
    /// Positive semi-definite.
    #[must_use]
    pub fn tensor_about_center(&self) -> DMat3 {
        self.tensor
    }

    /// Inertia tensor about any point \[m\], axes parallel to those of the frame [kg m^2].
    #[must_use]
    pub fn tensor_about(&self, point: impl Into<DVec3>) -> DMat3 {
        self.tensor + parallel_axis(self.mass, self.center_of_mass - point.into())
    }

    /// The inertia about the centre of mass as a validated tensor.
    ///
    /// # Errors
    /// [`InertiaError::NotPositive`] for a point mass or a rod, whose moments are not all positive,
    /// and for a body so thin that turning it has lost its smallest moment (below 7e-15 of the
    /// largest) in rounding.
    pub fn inertia(&self) -> Result<InertiaTensor, InertiaError> {
        let inertia = InertiaTensor::new(self.tensor)?;
        definite_after_turning(self.tensor)?;
        Ok(inertia)
    }

    /// The same body turned by `orientation` about the origin, then moved by `position` \[m\]. Seen
    /// otherwise, in the frame in which the body's frame has this pose.
    ///
    /// # Errors
    /// An orientation whose length is further than 1e-3 from one (closer is normalised), a position
    /// out of range.
    pub fn transformed(&self, position: impl Into<DVec3>, orientation: DQuat) -> Result<Self, MassError> {
        let orientation = unit_quaternion(orientation).map_err(|length| MassError::Orientation { length })?;
        let position = position.into();
        check_position(position)?;
        let center = position + orientation * self.center_of_mass;
        Self::from_parts(self.mass, center, change_of_basis(self.tensor, orientation))
    }

    /// The same body moved so that its centre of mass is there \[m\].
    ///
    /// # Errors
    /// A position out of range.
    pub fn centered_at(&self, center_of_mass: impl Into<DVec3>) -> Result<Self, MassError> {
        Self::from_parts(self.mass, center_of_mass.into(), self.tensor)
    }

    /// This body and another, in the same frame, fixed to each other. Also as the operator `+`.
    ///
    /// ```text
    /// I = I1 + I2 + (m1 m2 / (m1 + m2)) (d^2 E - d d^T)      d = c2 - c1
    /// ```
    ///
    /// This is the parallel-axis theorem for both at once, with only the distance of the two
    /// centres in it, so nothing cancels far from the origin.
    #[must_use]
    pub fn combined(&self, other: &Self) -> Self {
        let mass = self.mass + other.mass;
        let share = other.mass / mass;
        let d = other.center_of_mass - self.center_of_mass;
        Self {
            mass,
            center_of_mass: self.center_of_mass + d * share,
            tensor: self.tensor + other.tensor + parallel_axis(self.mass * share, d),
        }
    }

    /// This body with a hole: `hole` is what was there before, in the same frame. "Negative mass".
    ///
    /// ```text
    /// I = I1 - I2 - (m1 m2 / (m1 - m2)) (d^2 E - d d^T)      d = c2 - c1
    /// ```
    ///
    /// Where a thin wall is left most digits cancel; tubes and spherical shells have closed forms
    /// without that loss, [`tube`](Self::tube) and [`thick_shell`](Self::thick_shell).
    ///
    /// # Errors
    /// [`MassError::Hole`] if what remains is no body: the hole is heavier or sticks out.
    pub fn without(&self, hole: &Self) -> Result<Self, MassError> {
        let mass = self.mass - hole.mass;
        let share = hole.mass / mass;
        let d = hole.center_of_mass - self.center_of_mass;
        let center_of_mass = self.center_of_mass - d * share;
        let shift = parallel_axis(self.mass * share, d);
        let tensor = self.tensor - hole.tensor - shift;
        // Bound of the rounding in the three terms: a few eps of each, of the masses' difference
        // (hence their ratio), and of the centres, whose difference d may be small beside them.
        let reach = self.center_of_mass.length() + hole.center_of_mass.length();
        let terms = half_trace(self.tensor) + half_trace(hole.tensor) + half_trace(shift);
        let rounding = 8.0 * f64::EPSILON * (self.mass / mass) * (terms + self.mass * share * d.length() * reach);
        if mass > 0.0 && is_a_distribution_of_mass(tensor, rounding) {
            Self::from_parts(mass, center_of_mass, tensor)
        } else {
            Err(MassError::Hole { mass: self.mass, hole: hole.mass })
        }
    }

    /// The same distribution of mass with another total \[kg\].
    ///
    /// # Errors
    /// A mass out of range.
    pub fn scaled_to_mass(&self, mass: f64) -> Result<Self, MassError> {
        let tensor = self.tensor * (mass / self.mass);
        if mass.is_finite() && !tensor.is_finite() {
            return Err(MassError::OutOfRange { mass });
        }
        Self::from_parts(mass, self.center_of_mass, tensor)
    }
}

/// [`MassProperties::combined`]. For many, `bodies.reduce(|a, b| a + b)`.
impl Add for MassProperties {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        self.combined(&other)
    }
}

/// Whether `tensor`, known within `rounding`, can be that of a body:
/// `integral of r r^T dm = 1/2 tr(I) E - I` has no negative eigenvalue. That holds the triangle
/// inequality too.
fn is_a_distribution_of_mass(tensor: DMat3, rounding: f64) -> bool {
    let second_moments = DMat3::from_diagonal(DVec3::splat(half_trace(tensor))) - tensor;
    second_moments.is_finite() && symmetric_eigen(second_moments).0.min_element() >= -rounding
}

fn half_trace(m: DMat3) -> f64 {
    0.5 * (m.x_axis.x + m.y_axis.y + m.z_axis.z)
}

pub(crate) fn check_mass(mass: f64) -> Result<(), MassError> {
    if !mass.is_finite() {
        Err(MassError::NotFinite { mass })
    } else if mass <= 0.0 {
        Err(MassError::NotPositive { mass })
    } else if !MassProperties::MASSES.contains(&mass) {
        Err(MassError::OutOfRange { mass })
    } else {
        Ok(())
    }
}

pub(crate) fn check_position(position: DVec3) -> Result<(), MassError> {
    // Written so that NaN fails.
    if position.is_finite() && position.abs().max_element() <= MassProperties::REACH {
        Ok(())
    } else {
        Err(MassError::Position { position })
    }
}
