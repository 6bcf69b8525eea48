//! The semi-implicit Euler integrator.

use tumble_math::lane::Lane;
use tumble_math::rotate_to_first_order;

use crate::integrators::Kick;
use crate::integrators::state::{Constants, Moments, State};
use crate::integrators::{Account, Forces, Scheme};

/// `P += F h`, `L += tau h`, `x += P/M h`, `q += 1/2 [0, w] q h`, normalised.
pub(crate) struct SemiImplicitEuler<L> {
    kick: Kick<L>,
    inertia: Option<Moments<L>>,
    inverse_mass: L,
    h: L,
}

impl<L: Lane> Scheme<L> for SemiImplicitEuler<L> {
    #[inline(always)]
    fn new(constants: &Constants<L>, h: L) -> Self {
        Self {
            kick: Kick::new(constants, h),
            inertia: constants.inertia,
            inverse_mass: L::splat(1.0) / constants.mass,
            h,
        }
    }

    #[inline(always)]
    fn advance<F: Forces<L>, A: Account<L>>(&self, state: State<L>, forces: &F, account: &mut A) -> State<L> {
        let kicked = self.kick.apply(state, L::splat(0.0), forces, account);
        let orientation = match &self.inertia {
            Some(inertia) => {
                let angular_velocity = inertia.angular_velocity(kicked.orientation, kicked.angular);
                rotate_to_first_order(kicked.orientation, angular_velocity, self.h)
            }
            None => kicked.orientation,
        };
        State { position: kicked.position + kicked.linear * self.inverse_mass * self.h, orientation, ..kicked }
    }
}
