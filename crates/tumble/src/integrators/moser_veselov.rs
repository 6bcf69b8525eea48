use tumble_math::FreeRotation;
use tumble_math::lane::Lane;

use super::kick::Kick;
use super::{Account, Forces, Scheme};
use crate::state::{Constants, State};

/// Half a kick, free flight, half a kick. The flight keeps both momenta; [`FreeRotation`] turns the body.
pub(crate) struct MoserVeselov<L> {
    half_kick: Kick<L>,
    rotation: Option<FreeRotation<L>>,
    step_per_mass: L,
    h: L,
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
            h,
        }
    }

    #[inline(always)]
    fn advance<F: Forces<L>, A: Account<L>>(&self, state: State<L>, forces: &F, account: &mut A) -> State<L> {
        let flying = self.half_kick.apply(state, L::splat(0.0), forces, account);
        let landed = State {
            position: flying.position + flying.linear * self.step_per_mass,
            orientation: self
                .rotation
                .map_or(flying.orientation, |rotation| rotation.rotate(flying.orientation, flying.angular)),
            ..flying
        };
        self.half_kick.apply_to_end(landed, self.h, forces, account)
    }
}
