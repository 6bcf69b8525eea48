//! One body, or a tile of bodies side by side, as the integrators see it.

use hecs::EntityRef;
use tumble_math::lane::{Lane, Quat, Vec3};

use crate::components::{Inertia, Mass, Momentum, Pose, PrincipalAxes, Wrench};
use crate::math::{Real, double, double_quat};

/// What does not change during a step.
#[derive(Clone, Copy)]
pub(crate) struct Constants<L> {
    /// Mass \[kg\].
    pub(crate) mass: L,
    /// What resists turning; a point mass has none and does not turn.
    pub(crate) inertia: Option<Moments<L>>,
    /// Rates [1/s] at which momentum decays.
    pub(crate) damping: Option<Rates<L>>,
}

/// Principal moments [kg m^2], their inverses, and the rotation from the principal frame to the body frame where they differ.
#[derive(Clone, Copy)]
pub(crate) struct Moments<L> {
    pub(crate) moments: Vec3<L>,
    pub(crate) inverse_moments: Vec3<L>,
    pub(crate) axes: Option<Quat<L>>,
}

/// Rates of decay [1/s].
#[derive(Clone, Copy)]
pub(crate) struct Rates<L> {
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
        let vectors = [self.position, self.linear, self.angular].map(double);
        vectors.iter().all(|vector| vector.is_finite()) && double_quat(self.orientation).is_finite()
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

/// The constants, without the damping, and the state of a body that has them: of one that forces move.
pub(crate) fn moving_body(body: EntityRef<'_>) -> Option<(Constants<Real>, State<Real>)> {
    let axes = body.get::<&PrincipalAxes>().map(|axes| *axes);
    let inertia = body.get::<&Inertia>().map(|inertia| Moments::new(&inertia, axes.as_ref()));
    let constants = Constants { mass: body.get::<&Mass>()?.kilograms(), inertia, damping: None };
    Some((constants, State::new(&*body.get::<&Pose>()?, &*body.get::<&Momentum>()?)))
}
