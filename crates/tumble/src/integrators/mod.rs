//! The integration schemes: each advances one state over one substep of length `h` \[s\].
//!
//! They are generic over [`Lane`](tumble_math::lane::Lane), so one body and a tile of bodies run
//! the same code.

#![allow(clippy::manual_map, reason = "a closure that computes with tiles is compiled without their instruction set")]

pub(crate) mod account;
pub(crate) mod clear_range;
pub(crate) mod derived;
pub(crate) mod forces;
pub(crate) mod kick;
pub(crate) mod kinematic;
pub(crate) mod kinetic_energy;
pub(crate) mod moser_veselov;
pub(crate) mod response_range;
pub(crate) mod runge_kutta4;
pub(crate) mod semi_implicit_euler;
pub(crate) mod state;

pub(crate) use crate::integrators::account::{Account, Mean, NoAccount};
pub(crate) use crate::integrators::forces::{ConstantForce, Forces};
pub(crate) use crate::integrators::kick::Kick;
pub(crate) use crate::integrators::moser_veselov::MoserVeselov;
pub(crate) use crate::integrators::runge_kutta4::{RungeKutta4, derivative};
pub(crate) use crate::integrators::semi_implicit_euler::SemiImplicitEuler;

use tumble_math::lane::Lane;

use crate::integrators::state::{Constants, Force, State};

/// One integration scheme, prepared for one body and one length of substep.
pub(crate) trait Scheme<L: Lane> {
    /// Of a body and the length of a substep: all that does not depend on the state.
    fn new(constants: &Constants<L>, h: L) -> Self;

    /// The state one substep later, under forces that are evaluated at every stage and, where asked
    /// for, with an account of their work.
    fn advance<F: Forces<L>, A: Account<L>>(&self, state: State<L>, forces: &F, account: &mut A) -> State<L>;

    /// The same under a constant force, to the bit; `None` where that takes more than the usual way
    /// for a body of the tile.
    #[inline(always)]
    fn advance_shortly(&self, state: State<L>, force: Force<L>) -> Option<State<L>> {
        Some(self.advance(state, &ConstantForce(force), &mut NoAccount))
    }
}

/// An integration scheme, of one body or of a tile of any width.
pub(crate) trait AnyWidth {
    /// The scheme for tiles of one width.
    type Of<L: Lane>: Scheme<L>;

    /// Whether a step holds more than there are registers for.
    const IS_LARGE: bool;
}

macro_rules! any_width {
    ($($Scheme:ident: $is_large:literal),+) => {
        $(
            impl AnyWidth for $Scheme<()> {
                type Of<L: Lane> = $Scheme<L>;

                const IS_LARGE: bool = $is_large;
            }
        )+
    };
}

any_width!(SemiImplicitEuler: false, RungeKutta4: true, MoserVeselov: false);
