use tumble_math::lane::Lane;
use tumble_math::rotate_to_first_order;

use super::Scheme;
use super::damped::Kick;
use crate::state::{Constants, Moments, State};

/// `P += F h`, `L += tau h`, `x += P/M h`, `q += 1/2 [0, w] q h`, normalised.
pub(crate) struct SemiImplicitEuler<L> {
    kick: Kick<L>,
    inertia: Option<Moments<L>>,
    step_per_mass: L,
    h: L,
}

impl<L: Lane> Scheme<L> for SemiImplicitEuler<L> {
    #[inline(always)]
    fn new(constants: &Constants<L>, h: L) -> Self {
        Self { kick: Kick::new(constants, h), inertia: constants.inertia, step_per_mass: h / constants.mass, h }
    }

    #[inline(always)]
    fn advance(&self, state: State<L>) -> State<L> {
        let linear = self.kick.linear(state.linear);
        let angular = self.kick.angular(state.angular);
        State {
            position: state.position + linear * self.step_per_mass,
            orientation: self.inertia.map_or(state.orientation, |inertia| {
                let angular_velocity = inertia.angular_velocity(state.orientation, angular);
                rotate_to_first_order(state.orientation, angular_velocity, self.h)
            }),
            linear,
            angular,
        }
    }
}
