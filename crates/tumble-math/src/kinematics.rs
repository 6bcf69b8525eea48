//! Velocities, forces and torques on a rigid body.

use std::iter::Sum;
use std::ops::{Add, AddAssign};

use glam::DVec3;

use crate::inertia::InertiaTensor;
use crate::unit::unit_vector;

/// Velocity [m/s] of the point of a body that is `r` \[m\] away from where the body has the
/// velocity `linear`: `v + w x r`.
///
/// `angular` is the angular velocity [rad/s]. All vectors in one frame.
///
/// ```
/// use glam::DVec3;
/// use tumble_math::velocity_at_point;
/// // The foot of a wheel of radius 0.5 that rolls along x stands still.
/// let foot = velocity_at_point(
///     DVec3::new(2.0, 0.0, 0.0),
///     DVec3::new(0.0, 0.0, -4.0),
///     DVec3::new(0.0, -0.5, 0.0),
/// );
/// assert_eq!(foot, DVec3::ZERO);
/// ```
#[must_use]
pub fn velocity_at_point(linear: DVec3, angular: DVec3, r: DVec3) -> DVec3 {
    linear + angular.cross(r)
}

/// A force \[N\] and a torque [N m] about a stated point, what any number of forces on a rigid body
/// amount to (a wrench).
///
/// Adding them up is D'Alembert's principle at work: the body moves as under the single sum.
///
/// ```
/// use glam::DVec3;
/// use tumble_math::ForceAndTorque;
/// // A couple: two opposite forces turn without pushing.
/// let couple: ForceAndTorque = [1.0, -1.0]
///     .into_iter()
///     .map(|s| ForceAndTorque::of_force_at(DVec3::Y * s, DVec3::X * s))
///     .sum();
/// assert_eq!((couple.force, couple.torque), (DVec3::ZERO, DVec3::Z * 2.0));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ForceAndTorque {
    /// The force \[N\].
    pub force: DVec3,
    /// The torque about the stated point [N m].
    pub torque: DVec3,
}

impl ForceAndTorque {
    /// A force `f` \[N\] that acts at `r` \[m\] from the point: itself, and the torque `r x f`.
    /// Through the point there is none.
    #[must_use]
    pub fn of_force_at(force: DVec3, r: DVec3) -> Self {
        Self { force, torque: r.cross(force) }
    }

    /// The same forces about another point, `offset` \[m\] away from this one: the force stays, the
    /// torque loses `offset x f`.
    #[must_use]
    pub fn about(self, offset: DVec3) -> Self {
        Self { force: self.force, torque: self.torque - offset.cross(self.force) }
    }
}

impl Add for ForceAndTorque {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { force: self.force + other.force, torque: self.torque + other.torque }
    }
}

impl AddAssign for ForceAndTorque {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Sum for ForceAndTorque {
    fn sum<I: Iterator<Item = Self>>(iter: I) -> Self {
        iter.fold(Self::default(), Add::add)
    }
}

/// Angular acceleration [rad/s^2] of a body under a torque [N m]: Euler's equation,
/// `I^-1 (tau - w x I w)`.
///
/// Inertia and torque about the centre of mass (or a point at rest), everything in one frame. Off
/// the principal axes the answer is not along the torque: a torque about x turns the body about y
/// and z as well.
///
/// Source: H. Goldstein, C. Poole, J. Safko, "Classical Mechanics", 3rd ed., equation 5.39.
///
/// ```
/// use glam::DVec3;
/// use tumble_math::{InertiaTensor, angular_acceleration, torque_for_angular_acceleration};
/// let body = InertiaTensor::axisymmetric(1.0, 3.0, [1.0, 1.0, 0.0])?;
/// let response = angular_acceleration(&body, DVec3::ZERO, DVec3::X);
/// assert!(response.x > 0.0 && response.y > 0.0);
/// assert!(
///     (torque_for_angular_acceleration(&body, DVec3::ZERO, response) - DVec3::X).length() < 1e-15
/// );
/// # Ok::<(), tumble_math::InertiaError>(())
/// ```
#[must_use]
pub fn angular_acceleration(inertia: &InertiaTensor, angular_velocity: DVec3, torque: DVec3) -> DVec3 {
    inertia.inverse() * (torque - angular_velocity.cross(inertia.angular_momentum(angular_velocity)))
}

/// Torque [N m] that gives a body an angular acceleration `a` [rad/s^2]: `I a + w x I w`, the
/// inverse of [`angular_acceleration`].
///
/// ```
/// use glam::DVec3;
/// use tumble_math::{InertiaTensor, torque_for_angular_acceleration};
/// // To keep a plate turning about an axis between its principal ones takes a torque.
/// let plate = InertiaTensor::axisymmetric(1.0, 2.0, [0.0, 0.0, 1.0])?;
/// let torque = torque_for_angular_acceleration(&plate, DVec3::new(1.0, 0.0, 1.0), DVec3::ZERO);
/// assert!(torque.length() > 0.9);
/// # Ok::<(), tumble_math::InertiaError>(())
/// ```
#[must_use]
pub fn torque_for_angular_acceleration(
    inertia: &InertiaTensor,
    angular_velocity: DVec3,
    angular_acceleration: DVec3,
) -> DVec3 {
    inertia.angular_momentum(angular_acceleration) + angular_velocity.cross(inertia.angular_momentum(angular_velocity))
}

/// Moment of inertia [kg m^2] of particles `(mass, position)` \[kg, m\] about the line through
/// `point` along `direction`: `sum m d^2`, d the distance from the line. NaN if `direction` (any
/// length) is zero or not finite.
///
/// ```
/// use tumble_math::moment_about_axis;
/// use glam::DVec3;
/// let particles = [(2.0, DVec3::new(3.0, 7.0, 0.0)), (1.0, DVec3::new(0.0, -5.0, 1.0))];
/// assert_eq!(moment_about_axis(particles, DVec3::ZERO, DVec3::Y), 2.0 * 9.0 + 1.0);
/// ```
#[must_use]
pub fn moment_about_axis(particles: impl IntoIterator<Item = (f64, DVec3)>, point: DVec3, direction: DVec3) -> f64 {
    let Some(n) = unit_vector(direction) else {
        return f64::NAN;
    };
    // |n x r| is the distance itself; r^2 - (n . r)^2 would cancel for a particle near the line.
    particles.into_iter().map(|(mass, position)| mass * n.cross(position - point).length_squared()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The power of forces on a moving body does not depend on the point it is reckoned about.
    #[test]
    fn power_is_the_same_about_any_point() {
        let (v, w) = (DVec3::new(1.0, -2.0, 0.5), DVec3::new(0.25, 3.0, -1.0));
        let forces = [(DVec3::X * 4.0, DVec3::new(0.0, 1.0, 2.0)), (DVec3::new(-1.0, 0.5, 8.0), DVec3::Y * 3.0)];
        let about_origin: ForceAndTorque = forces.into_iter().map(|(f, r)| ForceAndTorque::of_force_at(f, r)).sum();
        let power: f64 = forces.into_iter().map(|(f, r)| f.dot(velocity_at_point(v, w, r))).sum();
        for offset in [DVec3::ZERO, DVec3::new(5.0, -7.0, 0.125)] {
            let there = about_origin.about(offset);
            let total = there.force.dot(velocity_at_point(v, w, offset)) + there.torque.dot(w);
            // Products of up to a thousand, a dozen roundings.
            assert!((total - power).abs() <= 1e-12, "{total} {power}");
        }
        let mut twice = about_origin;
        twice += about_origin;
        assert_eq!(twice, about_origin + about_origin);
    }

    /// Euler's equation on a principal frame, written out: `I1 dw1 = tau1 + (I2 - I3) w2 w3` and so
    /// on.
    #[test]
    fn euler_equations_by_hand() {
        let inertia = InertiaTensor::from_principal([2.0, 3.0, 4.0], glam::DQuat::IDENTITY).unwrap();
        let (w, torque) = (DVec3::new(1.0, 2.0, 3.0), DVec3::new(0.5, 0.25, -1.0));
        let expected = DVec3::new((0.5 - 6.0) / 2.0, (0.25 + 2.0 * 3.0) / 3.0, (-1.0 - 2.0) / 4.0);
        assert!((angular_acceleration(&inertia, w, torque) - expected).length() <= 4.0 * f64::EPSILON * 3.5);
    }

    #[test]
    fn a_line_without_direction_has_no_moment() {
        assert!(moment_about_axis([(1.0, DVec3::X)], DVec3::ZERO, DVec3::ZERO).is_nan());
    }
}
