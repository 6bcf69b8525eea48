use tumble_math::lane::{Lane, Quat, Vec3};
use tumble_math::{decay, orientation_rate};

use super::Scheme;
use crate::state::{Constants, State};

/// The classical Runge-Kutta method, with the damping taken out by an integrating factor.
///
/// With `p = e^(-c t) s` the equation `dp/dt = F - c p` becomes `ds/dt = e^(c t) F`, to which the method is applied; so damping alone
/// is exact and never limits the step (J. D. Lawson, SIAM J. Numer. Anal. 4, 1967). Without damping the factors are one and
/// this is the classical method.
pub(crate) struct RungeKutta4<L> {
    constants: Constants<L>,
    /// What is left of each momentum after half a step.
    kept: Option<(L, L)>,
    h: L,
}

/// The rates of change of a state: what the seeds' form of the equations of motion gives an ODE solver.
#[derive(Clone, Copy)]
pub(crate) struct Rates<L> {
    pub(crate) position: Vec3<L>,
    pub(crate) orientation: Quat<L>,
    pub(crate) linear: Vec3<L>,
    pub(crate) angular: Vec3<L>,
}

/// `dx/dt = P/M`, `dq/dt = 1/2 [0, w] q`, `dP/dt = F`, `dL/dt = tau`, without the damping. The orientation need not be of unit length.
#[inline(always)]
pub(crate) fn derivative<L: Lane>(constants: &Constants<L>, state: State<L>) -> Rates<L> {
    let angular_velocity = constants
        .inertia
        .map_or(Vec3::zero(), |inertia| inertia.angular_velocity(state.orientation.normalize(), state.angular));
    Rates {
        position: constants.velocity(state.linear),
        orientation: orientation_rate(state.orientation, angular_velocity),
        linear: constants.force,
        angular: constants.torque,
    }
}

impl<L: Lane> Scheme<L> for RungeKutta4<L> {
    #[inline(always)]
    fn new(constants: &Constants<L>, h: L) -> Self {
        let half = h * L::splat(0.5);
        Self {
            constants: *constants,
            kept: constants.damping.map(|rates| (decay(rates.linear * half).kept, decay(rates.angular * half).kept)),
            h,
        }
    }

    #[inline(always)]
    fn advance(&self, start: State<L>) -> State<L> {
        let (h, half) = (self.h, self.h * L::splat(0.5));
        let half_later = |state: State<L>| self.half_a_step_of_decay(state);
        let k1 = derivative(&self.constants, start);
        let first = half_later(moved(start, &k1, half));
        let k2 = derivative(&self.constants, first);
        let second = moved(half_later(start), &k2, half);
        let k3 = derivative(&self.constants, second);
        let third = half_later(moved(half_later(start), &k3, h));
        let k4 = derivative(&self.constants, third);

        let (sixth, third) = (h * L::splat(1.0 / 6.0), h * L::splat(1.0 / 3.0));
        let middle = moved(moved(half_later(moved(start, &k1, sixth)), &k2, third), &k3, third);
        let end = moved(half_later(middle), &k4, sixth);
        let orientation = self.constants.inertia.map_or(start.orientation, |_| end.orientation.normalize());
        State { orientation, ..end }
    }
}

impl<L: Lane> RungeKutta4<L> {
    #[inline(always)]
    fn half_a_step_of_decay(&self, state: State<L>) -> State<L> {
        self.kept.map_or(state, |(linear, angular)| State {
            linear: state.linear * linear,
            angular: state.angular * angular,
            ..state
        })
    }
}

/// The state moved along the rates for a time.
#[inline(always)]
fn moved<L: Lane>(state: State<L>, rates: &Rates<L>, time: L) -> State<L> {
    State {
        position: state.position + rates.position * time,
        orientation: state.orientation + rates.orientation * time,
        linear: state.linear + rates.linear * time,
        angular: state.angular + rates.angular * time,
    }
}
