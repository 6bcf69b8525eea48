//! One body, or a tile of bodies side by side, as the integrators see it.

use hecs::EntityRef;
use tumble_math::lane::{Lane, Quat, Vec3};

use crate::components::{Inertia, Mass, Momentum, Pose, PrincipalAxes, Wrench};
use crate::math::Real;

/// Mass, inertia and damping of a body: constant during a step.
#[derive(Clone, Copy)]
pub(crate) struct Constants<L> {
    /// Mass \[kg\].
    pub(crate) mass: L,
    /// Moments of inertia; a point mass has none and does not turn.
    pub(crate) inertia: Option<Moments<L>>,
    /// Rates [1/s] at which momentum decays.
    pub(crate) damping: Option<DampingRates<L>>,
}

/// Principal moments [kg m^2], their inverses, and the rotation from the principal frame to the
/// body frame where they differ.
#[derive(Clone, Copy)]
pub(crate) struct Moments<L> {
    pub(crate) moments: Vec3<L>,
    pub(crate) inverse_moments: Vec3<L>,
    pub(crate) axes: Option<Quat<L>>,
}

/// Rates of decay [1/s].
#[derive(Clone, Copy)]
pub(crate) struct DampingRates<L> {
    pub(crate) linear: L,
    pub(crate) angular: L,
}

/// Sum of forces \[N\] and of torques about the centre of mass [N m], world frame.
#[derive(Clone, Copy)]
pub(crate) struct Force<L> {
    pub(crate) force: Vec3<L>,
    pub(crate) torque: Vec3<L>,
}

impl<L: Lane> Force<L> {
    /// No force.
    #[inline(always)]
    pub(crate) fn zero() -> Self {
        Self { force: Vec3::zero(), torque: Vec3::zero() }
    }
}

/// The state of a body: what a step advances.
#[derive(Clone, Copy)]
pub(crate) struct State<L> {
    /// Centre of mass \[m\].
    pub(crate) position: Vec3<L>,
    /// Unit quaternion, body frame to world.
    pub(crate) orientation: Quat<L>,
    /// Linear momentum [kg m/s], world frame.
    pub(crate) linear: Vec3<L>,
    /// Angular momentum about the centre of mass [kg m^2/s], world frame.
    pub(crate) angular: Vec3<L>,
}

impl<L: Lane> Constants<L> {
    /// `v = P/M` [m/s].
    #[inline(always)]
    pub(crate) fn velocity(&self, linear_momentum: Vec3<L>) -> Vec3<L> {
        linear_momentum * (L::splat(1.0) / self.mass)
    }

    /// `w = I^-1 L` \[rad/s\], world frame, for a unit orientation; zero for a point mass.
    #[inline(always)]
    pub(crate) fn angular_velocity(&self, state: &State<L>) -> Vec3<L> {
        match &self.inertia {
            Some(inertia) => inertia.angular_velocity(state.orientation, state.angular),
            None => Vec3::zero(),
        }
    }
}

impl<L: Lane> Constants<L> {
    /// The most by which an impulse of one newton second at a point can change the velocity there,
    /// along the impulse [1/kg]; the point is given from the centre of mass along the body's axes.
    ///
    /// An impulse along the unit vector `n` changes it by `1/M + sum (n . e_i x r)^2/I_i`, with the
    /// principal axes `e_i`. The second term is a quadratic form of rank two, whose larger
    /// eigenvalue follows from its trace and the sum of squares of its elements.
    #[inline(always)]
    pub(crate) fn most_inverse_mass_at(&self, point_body: Vec3<L>) -> L {
        let (zero, two, half) = (L::splat(0.0), L::splat(2.0), L::splat(0.5));
        let mut turning = zero;
        if let Some(inertia) = &self.inertia {
            let r = match inertia.axes {
                Some(axes) => axes.rotate_back(point_body),
                None => point_body,
            };
            let (square, m) = (r.scale(r), inertia.inverse_moments);
            let diagonal = Vec3::new(square.y + square.z, square.z + square.x, square.x + square.y).scale(m);
            let weighed = square.scale(m);
            let mixed = weighed.x * weighed.y + weighed.y * weighed.z + weighed.z * weighed.x;
            let trace = diagonal.x + diagonal.y + diagonal.z;
            let squares = diagonal.dot(diagonal) + two * mixed;
            turning = (trace + (two * squares - trace * trace).max(zero).sqrt()) * half;
        }
        L::splat(1.0) / self.mass + turning
    }
}

impl<L: Lane> Moments<L> {
    /// `w = R I^-1 R^T L` [rad/s], world frame, for a unit orientation.
    #[inline(always)]
    pub(crate) fn angular_velocity(&self, orientation: Quat<L>, angular_momentum: Vec3<L>) -> Vec3<L> {
        let [a, b, c] = self.world_axes(orientation);
        let m = self.inverse_moments;
        let l = angular_momentum;
        a * (a.dot(l) * m.x) + b * (b.dot(l) * m.y) + c * (c.dot(l) * m.z)
    }

    /// The principal axes in the world frame, for a unit orientation.
    #[inline(always)]
    pub(crate) fn world_axes(&self, orientation: Quat<L>) -> [Vec3<L>; 3] {
        match self.axes {
            Some(axes) => orientation * axes,
            None => orientation,
        }
        .axes()
    }
}

impl Moments<Real> {
    #[inline(always)]
    pub(crate) fn new(inertia: &Inertia, axes: Option<&PrincipalAxes>) -> Self {
        Self {
            moments: inertia.moments().into(),
            inverse_moments: inertia.inverse_moments().into(),
            axes: axes.map(|axes| axes.0.into()),
        }
    }
}

impl From<Wrench> for Force<Real> {
    #[inline(always)]
    fn from(wrench: Wrench) -> Self {
        Self { force: wrench.force.into(), torque: wrench.torque.into() }
    }
}

impl State<Real> {
    /// Whether every number of it is finite.
    pub(crate) fn is_finite(&self) -> bool {
        // Nothing times what is not finite is no number.
        let (zero, q) = (0.0, self.orientation);
        let nothing = self.position * zero + self.linear * zero + self.angular * zero;
        nothing.x + nothing.y + nothing.z + (q.x * zero + q.y * zero) + (q.z * zero + q.w * zero) == zero
    }

    #[inline(always)]
    pub(crate) fn new(pose: &Pose, momentum: &Momentum) -> Self {
        Self {
            position: pose.position.into(),
            orientation: pose.orientation.into(),
            linear: momentum.linear.into(),
            angular: momentum.angular.into(),
        }
    }
}

/// The constants, without the damping, and the state of a body that has them: of one that forces
/// move.
pub(crate) fn moving_body(body: EntityRef<'_>) -> Option<(Constants<Real>, State<Real>)> {
    let axes = body.get::<&PrincipalAxes>().map(|axes| *axes);
    let inertia = body.get::<&Inertia>().map(|inertia| Moments::new(&inertia, axes.as_ref()));
    let constants = Constants { mass: body.get::<&Mass>()?.kilograms(), inertia, damping: None };
    Some((constants, State::new(&*body.get::<&Pose>()?, &*body.get::<&Momentum>()?)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Real;

    /// Against impulses in many directions: none does more, and one does as much but for the
    /// coarseness of the directions.
    #[test]
    fn the_most_inverse_mass_is_reached_and_not_exceeded() {
        let axes = Quat { x: 0.1, y: -0.5, z: 0.3, w: 0.8 }.normalize();
        let inverse_moments = Vec3::new(2.0, 0.5, 7.0);
        let inertia = Moments { moments: Vec3::new(0.5, 2.0, 1.0 / 7.0), inverse_moments, axes: Some(axes) };
        let constants = Constants::<Real> { mass: 2.0, inertia: Some(inertia), damping: None };
        let turning = State {
            position: Vec3::zero(),
            orientation: Quat { x: 0.0, y: 0.0, z: 0.0, w: 1.0 },
            linear: Vec3::zero(),
            angular: Vec3::zero(),
        };
        for point in [Vec3::new(0.3, -0.8, 1.1), Vec3::new(0.0, 0.0, 1.0), Vec3::zero()] {
            let mut most: Real = 0.0;
            for i in 0..200_u16 {
                for j in 0..100_u16 {
                    let (sine, cosine) = Lane::sin_cos(Real::from(i) * 0.0314);
                    let (low, high) = Lane::sin_cos(Real::from(j) * 0.0314);
                    let n = Vec3::new(cosine * low, sine * low, high);
                    let angular = point.cross(n);
                    let spin = constants.angular_velocity(&State { angular, ..turning });
                    most = most.max(1.0 / constants.mass + angular.dot(spin));
                }
            }
            let bound = constants.most_inverse_mass_at(point);
            assert!(most <= bound * (1.0 + 1e-5) && most >= bound * 0.998, "{most} and {bound} at {point:?}");
        }
    }
}
