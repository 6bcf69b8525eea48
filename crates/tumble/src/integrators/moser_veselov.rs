use tumble_math::lane::Lane;
use tumble_math::rotate_freely;

use super::Scheme;
use super::damped::Kick;
use crate::state::{Constants, Moments, State};

/// Half a kick, free flight, half a kick. The flight keeps both momenta; [`rotate_freely`] turns the body.
pub(crate) struct MoserVeselov<L> {
    half_kick: Kick<L>,
    inertia: Option<Moments<L>>,
    step_per_mass: L,
    h: L,
}

impl<L: Lane> Scheme<L> for MoserVeselov<L> {
    #[inline(always)]
    fn new(constants: &Constants<L>, h: L) -> Self {
        Self {
            half_kick: Kick::new(constants, h * L::splat(0.5)),
            inertia: constants.inertia,
            step_per_mass: h / constants.mass,
            h,
        }
    }

    #[inline(always)]
    fn advance(&self, state: State<L>) -> State<L> {
        let linear = self.half_kick.linear(state.linear);
        let angular = self.half_kick.angular(state.angular);
        State {
            position: state.position + linear * self.step_per_mass,
            orientation: self.inertia.map_or(state.orientation, |inertia| {
                rotate_freely(state.orientation, inertia.axes, angular, inertia.moments, self.h)
            }),
            linear: self.half_kick.linear(linear),
            angular: self.half_kick.angular(angular),
        }
    }
}
