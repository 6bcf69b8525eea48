//! The fourth-order Runge-Kutta integrator, with constant forces and damping solved exactly.

use tumble_math::lane::{Lane, Quat, Vec3};
use tumble_math::orientation_rate;

use crate::integrators::Kick;
use crate::integrators::state::{Constants, Force, State};
use crate::integrators::{Account, Forces, Scheme};

/// The classical Runge-Kutta method, with constant forces and damping taken out.
///
/// The momenta are split, `p = a + b`: `da/dt = F - c a` under the constant force has an exact
/// solution, and `db/dt = f - c b` under the varying one, with `b = e^(-c t) s`, becomes
/// `ds/dt = e^(c t) f`, to which the method is applied (J. D. Lawson, SIAM J. Numer. Anal. 4,
/// 1967). So damping and constant forces are exact and never limit the step, and the rest is of
/// fourth order.
pub(crate) struct RungeKutta4<L> {
    constants: Constants<L>,
    /// Kicks of constant forces and damping over half a step and over a whole one.
    half: Kick<L>,
    whole: Kick<L>,
    h: L,
}

/// The rates of change of a state but for damping: what the seeds' form of the equations of motion
/// gives an ODE solver.
#[derive(Clone, Copy)]
pub(crate) struct StateRates<L> {
    pub(crate) position: Vec3<L>,
    pub(crate) orientation: Quat<L>,
    pub(crate) force: Force<L>,
}

/// `dx/dt = P/M`, `dq/dt = 1/2 [0, w] q`, `dP/dt = F`, `dL/dt = tau`, without the damping. The
/// orientation need not be of unit length.
#[inline(always)]
pub(crate) fn derivative<L: Lane>(constants: &Constants<L>, force: Force<L>, state: &State<L>) -> StateRates<L> {
    let angular_velocity = constants.angular_velocity(&State { orientation: state.orientation.normalize(), ..*state });
    StateRates {
        position: constants.velocity(state.linear),
        orientation: orientation_rate(state.orientation, angular_velocity),
        force,
    }
}

impl<L: Lane> Scheme<L> for RungeKutta4<L> {
    #[inline(always)]
    fn new(constants: &Constants<L>, h: L) -> Self {
        let half = Kick::new(constants, h * L::splat(0.5));
        Self { constants: *constants, half, whole: Kick::new(constants, h), h }
    }

    #[inline(always)]
    fn advance<F: Forces<L>, A: Account<L>>(&self, start: State<L>, forces: &F, account: &mut A) -> State<L> {
        let (zero, half, h) = (L::splat(0.0), self.h * L::splat(0.5), self.h);
        let (kept, one) = (self.half.kept(), (L::splat(1.0), L::splat(1.0)));
        // What the momenta would be without the varying forces.
        let halfway = self.half.kicked(start, forces.constant());
        let at_end = self.whole.kicked(start, forces.constant());

        let k1 = self.rates(forces, zero, &start);
        let second = moved(&start, &k1, half).with_momenta(&halfway, &k1.force, half, kept);
        let k2 = self.rates(forces, half, &second);
        let third = moved(&start, &k2, half).with_momenta(&halfway, &k2.force, half, one);
        let k3 = self.rates(forces, half, &third);
        let fourth = moved(&start, &k3, h).with_momenta(&at_end, &k3.force, h, kept);
        let k4 = self.rates(forces, h, &fourth);

        let (sixth, a_third) = (h * L::splat(1.0 / 6.0), h * L::splat(1.0 / 3.0));
        let mut end = moved(&moved(&moved(&moved(&start, &k1, sixth), &k2, a_third), &k3, a_third), &k4, sixth);
        end = end.with_momenta(&at_end, &k1.force, sixth, (kept.0 * kept.0, kept.1 * kept.1));
        if F::VARY {
            end = end.with_momenta(&end, &k2.force, a_third, kept);
            end = end.with_momenta(&end, &k3.force, a_third, kept);
            end = end.with_momenta(&end, &k4.force, sixth, one);
        }
        end.orientation = match self.constants.inertia {
            Some(_) => end.orientation.normalize_or(start.orientation),
            None => start.orientation,
        };
        if A::KEPT {
            self.account(account, &start, &end, [&second, &third, &fourth]);
        }
        end
    }
}

impl<L: Lane> RungeKutta4<L> {
    /// The rates at a stage, of the momenta those by the varying forces.
    #[inline(always)]
    fn rates<F: Forces<L>>(&self, forces: &F, offset: L, state: &State<L>) -> StateRates<L> {
        let varying = if F::VARY { forces.varying(offset, state) } else { Force::zero() };
        derivative(&self.constants, varying, state)
    }

    /// Each stage's share: its weight in the method, decayed from the stage to the end.
    #[inline(always)]
    fn account(&self, account: &mut impl Account<L>, start: &State<L>, end: &State<L>, stages: [&State<L>; 3]) {
        let (zero, half) = (L::splat(0.0), self.h * L::splat(0.5));
        let (sixth, third) = (self.h * L::splat(1.0 / 6.0), self.h * L::splat(1.0 / 3.0));
        let (linear, angular) = self.half.kept();
        let mean = self.whole.account_for_the_rest(start, end, account);
        let [second, third_stage, fourth] = stages;
        account.varying_impulse(zero, start, (sixth * (linear * linear), sixth * (angular * angular)), &mean);
        account.varying_impulse(half, second, (third * linear, third * angular), &mean);
        account.varying_impulse(half, third_stage, (third * linear, third * angular), &mean);
        account.varying_impulse(self.h, fourth, (sixth, sixth), &mean);
    }
}

/// Position and orientation moved along the rates for a time; the momenta stay.
#[inline(always)]
fn moved<L: Lane>(state: &State<L>, rates: &StateRates<L>, time: L) -> State<L> {
    State {
        position: state.position + rates.position * time,
        orientation: state.orientation + rates.orientation * time,
        ..*state
    }
}

impl<L: Lane> State<L> {
    /// The same with another state's momenta, and what a force adds to them in a time, of which a
    /// part is kept.
    #[inline(always)]
    fn with_momenta(self, momenta: &Self, force: &Force<L>, time: L, kept: (L, L)) -> Self {
        Self {
            linear: momenta.linear + force.force * (time * kept.0),
            angular: momenta.angular + force.torque * (time * kept.1),
            ..self
        }
    }
}
