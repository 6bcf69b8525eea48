use tumble_math::FreeRotation;
use tumble_math::lane::Lane;

use super::Scheme;
use super::damped::Kick;
use crate::state::{Constants, State};

/// Half a kick, free flight, half a kick. The flight keeps both momenta; [`FreeRotation`] turns the body.
pub(crate) struct MoserVeselov<L> {
    half_kick: Kick<L>,
    rotation: Option<FreeRotation<L>>,
    step_per_mass: L,
}

impl<L: Lane> Scheme<L> for MoserVeselov<L> {
    #[inline(always)]
    fn new(constants: &Constants<L>, h: L) -> Self {
        Self {
            half_kick: Kick::new(constants, h * L::splat(0.5)),
            rotation: constants
                .inertia
                .map(|inertia| FreeRotation::new(inertia.moments, inertia.inverse_moments, inertia.axes, h)),
            step_per_mass: h / constants.mass,
        }
    }

    #[inline(always)]
    fn advance(&self, state: State<L>) -> State<L> {
        let linear = self.half_kick.linear(state.linear);
        let angular = self.half_kick.angular(state.angular);
        State {
            position: state.position + linear * self.step_per_mass,
            orientation: self.rotation.map_or(state.orientation, |free| free.rotate(state.orientation, angular)),
            linear: self.half_kick.linear(linear),
            angular: self.half_kick.angular(angular),
        }
    }
}
