//! Force evaluation for the integrators, split into a constant and a varying part.

use tumble_math::lane::Lane;

use crate::integrators::state::{Force, State};

/// The forces on a body, at any stage of a substep.
pub(crate) trait Forces<L: Lane> {
    /// Whether there is more than the constant part.
    const VARY: bool;

    /// The part that is the same at every stage.
    fn constant(&self) -> Force<L>;

    /// The part that depends on the state or on time, at a state, `offset` \[s\] after the start of
    /// the substep.
    fn varying(&self, offset: L, state: &State<L>) -> Force<L>;

    /// For which bodies the force depends on the momenta; `None` for none.
    fn depends_on_velocity(&self) -> Option<L::Mask>;

    /// All of the force at a state.
    #[inline(always)]
    fn at(&self, offset: L, state: &State<L>) -> Force<L> {
        let constant = self.constant();
        if !Self::VARY {
            return constant;
        }
        let varying = self.varying(offset, state);
        Force { force: constant.force + varying.force, torque: constant.torque + varying.torque }
    }
}

/// A force that stays the same over the step.
pub(crate) struct ConstantForce<L>(pub(crate) Force<L>);

impl<L: Lane> Forces<L> for ConstantForce<L> {
    const VARY: bool = false;

    #[inline(always)]
    fn constant(&self) -> Force<L> {
        self.0
    }

    #[inline(always)]
    fn varying(&self, _: L, _: &State<L>) -> Force<L> {
        Force::zero()
    }

    #[inline(always)]
    fn depends_on_velocity(&self) -> Option<L::Mask> {
        None
    }
}
