//! The kick-drift-kick integrator with the discrete Moser-Veselov map for free rotation.

use tumble_math::FreeRotation;
use tumble_math::lane::Lane;

use crate::integrators::Kick;
use crate::integrators::state::{Constants, State};
use crate::integrators::{Account, Forces, Scheme};

/// Half a kick, free flight, half a kick. The flight keeps both momenta; [`FreeRotation`] turns the
/// body.
pub(crate) struct MoserVeselov<L> {
    half_kick: Kick<L>,
    rotation: Option<FreeRotation<L>>,
    inverse_mass: L,
    h: L,
}

impl<L: Lane> Scheme<L> for MoserVeselov<L> {
    #[inline(always)]
    fn new(constants: &Constants<L>, h: L) -> Self {
        let rotation = match &constants.inertia {
            Some(inertia) => Some(FreeRotation::new(inertia.moments, inertia.inverse_moments, inertia.axes, h)),
            None => None,
        };
        Self {
            half_kick: Kick::new(constants, h * L::splat(0.5)),
            rotation,
            inverse_mass: L::splat(1.0) / constants.mass,
            h,
        }
    }

    #[inline(always)]
    fn advance<F: Forces<L>, A: Account<L>>(&self, state: State<L>, forces: &F, account: &mut A) -> State<L> {
        let flying = self.half_kick.apply(state, L::splat(0.0), forces, account);
        let orientation = match &self.rotation {
            Some(rotation) => rotation.rotate(flying.orientation, flying.angular),
            None => flying.orientation,
        };
        let position = flying.position + flying.linear * self.inverse_mass * self.h;
        let landed = State { position, orientation, ..flying };
        self.half_kick.apply_to_end(landed, self.h, forces, account)
    }
}
