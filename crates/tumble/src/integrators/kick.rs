//! Kicks: momentum updates under force and damping, exact for a constant force.

use tumble_math::lane::{Lane, Vec3};
use tumble_math::{Decay, decay};

use crate::integrators::state::{Constants, Force, State};
use crate::integrators::{Account, Forces, Mean};

/// The change of momenta by a force and damping over a fixed time: `p <- kept p + weight F`, exact
/// for a constant force.
#[derive(Clone, Copy)]
pub(crate) struct Kick<L> {
    constants: Constants<L>,
    linear: Part<L>,
    angular: Part<L>,
}

#[derive(Clone, Copy)]
struct Part<L> {
    /// `e^(-c t)`; `None` without damping, so that an undamped momentum is not touched.
    kept: Option<L>,
    /// The time, each moment weighed by how much of what it adds is left at the end \[s\].
    weight: L,
}

impl<L: Lane> Part<L> {
    #[inline(always)]
    fn new(rate: Option<L>, t: L) -> Self {
        let Some(rate) = rate else { return Self { kept: None, weight: t } };
        let Decay { kept, mean } = decay(rate * t);
        Self { kept: Some(kept), weight: mean * t }
    }

    #[inline(always)]
    fn apply(&self, momentum: Vec3<L>, force: Vec3<L>) -> Vec3<L> {
        let kept = match self.kept {
            Some(kept) => momentum * kept,
            None => momentum,
        };
        kept + force * self.weight
    }

    /// The change of a momentum by damping.
    #[inline(always)]
    fn damped(&self, momentum: Vec3<L>) -> Vec3<L> {
        match self.kept {
            Some(kept) => momentum * (kept - L::splat(1.0)),
            None => Vec3::zero(),
        }
    }
}

impl<L: Lane> Kick<L> {
    /// A kick over the time `t` \[s\].
    #[inline(always)]
    pub(crate) fn new(constants: &Constants<L>, t: L) -> Self {
        let rates = constants.damping;
        Self {
            constants: *constants,
            linear: Part::new(rates.map(|rates| rates.linear), t),
            angular: Part::new(rates.map(|rates| rates.angular), t),
        }
    }

    /// The state with its momenta kicked by the forces as they are at the state itself.
    #[inline(always)]
    pub(crate) fn apply(
        &self,
        state: State<L>,
        offset: L,
        forces: &impl Forces<L>,
        account: &mut impl Account<L>,
    ) -> State<L> {
        self.apply_as_at(state, offset, &state, forces, account)
    }

    /// The state with its momenta kicked so that the forces are those at the end of the kick, to
    /// second order: a force that depends on velocity is evaluated again, at the state that its
    /// first value leads to.
    #[inline(always)]
    pub(crate) fn apply_to_end(
        &self,
        state: State<L>,
        offset: L,
        forces: &impl Forces<L>,
        account: &mut impl Account<L>,
    ) -> State<L> {
        match forces.depends_on_velocity() {
            Some(depends) => {
                let predicted = self.kicked(state, forces.at(offset, &state));
                // The kick changes the momenta alone; where the force does not depend on them they
                // stay, as without the others of the tile.
                let linear = Vec3::select(depends, predicted.linear, state.linear);
                let angular = Vec3::select(depends, predicted.angular, state.angular);
                self.apply_as_at(state, offset, &State { linear, angular, ..state }, forces, account)
            }
            None => self.apply(state, offset, forces, account),
        }
    }

    #[inline(always)]
    fn apply_as_at<A: Account<L>>(
        &self,
        state: State<L>,
        offset: L,
        evaluated_at: &State<L>,
        forces: &impl Forces<L>,
        account: &mut A,
    ) -> State<L> {
        let kicked = self.kicked(state, forces.at(offset, evaluated_at));
        if A::KEPT {
            let mean = self.account_for_the_rest(&state, &kicked, account);
            account.varying_impulse(offset, evaluated_at, (self.linear.weight, self.angular.weight), &mean);
        }
        kicked
    }

    /// Enters what damping and constant forces do in a kick from this state to that, and returns
    /// the mean velocities over which all forces act: damping comes first, so that it is given what
    /// it takes from the momenta at the start, which is never positive.
    #[inline(always)]
    pub(crate) fn account_for_the_rest(
        &self,
        start: &State<L>,
        end: &State<L>,
        account: &mut impl Account<L>,
    ) -> Mean<L> {
        let mean = match self.constants.damping {
            Some(_) => {
                let damped = self.kicked(*start, Force { force: Vec3::zero(), torque: Vec3::zero() });
                let lost = (self.linear.damped(start.linear), self.angular.damped(start.angular));
                account.damping(lost.0, lost.1, &self.constants.mean(start, &damped));
                self.constants.mean(&damped, end)
            }
            None => self.constants.mean(start, end),
        };
        account.constant_impulse((self.linear.weight, self.angular.weight), &mean);
        mean
    }

    /// The factors that damping leaves of the linear and the angular momentum over the kick.
    #[inline(always)]
    pub(crate) fn kept(&self) -> (L, L) {
        let one = L::splat(1.0);
        (self.linear.kept.unwrap_or(one), self.angular.kept.unwrap_or(one))
    }

    /// The state with its momenta kicked by a force.
    #[inline(always)]
    pub(crate) fn kicked(&self, state: State<L>, force: Force<L>) -> State<L> {
        State {
            linear: self.linear.apply(state.linear, force.force),
            angular: self.angular.apply(state.angular, force.torque),
            ..state
        }
    }
}

impl<L: Lane> Constants<L> {
    /// Mean velocities of two states, each with its own orientation.
    #[inline(always)]
    pub(crate) fn mean(&self, before: &State<L>, after: &State<L>) -> Mean<L> {
        let half = L::splat(0.5);
        Mean {
            linear: self.velocity(before.linear + after.linear) * half,
            angular: (self.angular_velocity(before) + self.angular_velocity(after)) * half,
        }
    }
}
