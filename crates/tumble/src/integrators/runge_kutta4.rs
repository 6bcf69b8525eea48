use tumble_math::lane::{Lane, Quat, Vec3};
use tumble_math::{decay, orientation_rate};

use super::{Account, Forces, Scheme};
use crate::state::{Constants, Force, State};

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
pub(crate) fn derivative<L: Lane>(constants: &Constants<L>, force: Force<L>, state: &State<L>) -> Rates<L> {
    let angular_velocity = constants
        .inertia
        .map_or(Vec3::zero(), |inertia| inertia.angular_velocity(state.orientation.normalize(), state.angular));
    Rates {
        position: constants.velocity(state.linear),
        orientation: orientation_rate(state.orientation, angular_velocity),
        linear: force.force,
        angular: force.torque,
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
    fn advance<F: Forces<L>, A: Account<L>>(&self, start: State<L>, forces: &F, account: &mut A) -> State<L> {
        let (zero, half, h) = (L::splat(0.0), self.h * L::splat(0.5), self.h);
        let half_later = |state: State<L>| self.half_a_step_of_decay(state);
        let rates = |offset: L, state: &State<L>| derivative(&self.constants, forces.at(offset, state), state);
        let k1 = rates(zero, &start);
        let second = half_later(moved(start, &k1, half));
        let k2 = rates(half, &second);
        let third = moved(half_later(start), &k2, half);
        let k3 = rates(half, &third);
        let fourth = half_later(moved(half_later(start), &k3, h));
        let k4 = rates(h, &fourth);

        let (sixth, a_third) = (h * L::splat(1.0 / 6.0), h * L::splat(1.0 / 3.0));
        let middle = moved(moved(half_later(moved(start, &k1, sixth)), &k2, a_third), &k3, a_third);
        let end = moved(half_later(middle), &k4, sixth);
        let orientation = self.constants.inertia.map_or(start.orientation, |_| end.orientation.normalize());
        let end = State { orientation, ..end };
        if A::KEPT {
            self.account(account, &start, &end, [&second, &third, &fourth]);
        }
        end
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

    /// Each stage's share: its weight in the method, decayed from the stage to the end.
    #[inline(always)]
    fn account(&self, account: &mut impl Account<L>, start: &State<L>, end: &State<L>, stages: [&State<L>; 3]) {
        let one = L::splat(1.0);
        let (zero, half) = (L::splat(0.0), self.h * L::splat(0.5));
        let (sixth, third) = (self.h * L::splat(1.0 / 6.0), self.h * L::splat(1.0 / 3.0));
        let kept = self.kept.unwrap_or((one, one));
        let whole = (kept.0 * kept.0, kept.1 * kept.1);
        let weight = |factor: L, kept: (L, L)| (factor * kept.0, factor * kept.1);
        let mean = self.constants.mean(start, end);
        let [second, third_stage, fourth] = stages;
        account.impulse(zero, start, weight(sixth, whole), &mean);
        account.impulse(half, second, weight(third, kept), &mean);
        account.impulse(half, third_stage, weight(third, kept), &mean);
        account.impulse(self.h, fourth, (sixth, sixth), &mean);
        account.damping(start.linear * (whole.0 - one), start.angular * (whole.1 - one), &mean);
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
