//! The kick-drift-kick integrator with the discrete Moser-Veselov map for free rotation.

use tumble_math::FreeRotation;
use tumble_math::lane::{Lane, Quat};

use crate::integrators::Kick;
use crate::integrators::state::{Constants, Force, State};
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
        self.half_kick.apply_to_end(self.landed(flying, orientation), self.h, forces, account)
    }

    #[inline(always)]
    fn advance_shortly(&self, state: State<L>, force: Force<L>) -> Option<State<L>> {
        let flying = self.half_kick.kicked(state, force);
        let orientation = match &self.rotation {
            Some(rotation) => rotation.rotate_shortly(flying.orientation, flying.angular)?,
            None => flying.orientation,
        };
        Some(self.half_kick.kicked(self.landed(flying, orientation), force))
    }
}

impl<L: Lane> MoserVeselov<L> {
    /// The end of a flight: its way is straight, and this is its orientation.
    #[inline(always)]
    fn landed(&self, flying: State<L>, orientation: Quat<L>) -> State<L> {
        let position = flying.position + flying.linear * self.inverse_mass * self.h;
        State { position, orientation, ..flying }
    }
}
