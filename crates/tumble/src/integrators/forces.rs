use crate::state::{Force, State};

/// What pushes a body, at any stage of a substep.
pub(crate) trait Forces<L> {
    /// Force and torque at a state, `offset` \[s\] after the start of the substep.
    fn at(&self, offset: L, state: &State<L>) -> Force<L>;

    /// Whether the force depends on the momenta.
    fn depends_on_velocity(&self) -> bool;
}

/// A force that stays the same over the step.
pub(crate) struct ConstantForce<L>(pub(crate) Force<L>);

impl<L: Copy> Forces<L> for ConstantForce<L> {
    #[inline(always)]
    fn at(&self, _: L, _: &State<L>) -> Force<L> {
        self.0
    }

    #[inline(always)]
    fn depends_on_velocity(&self) -> bool {
        false
    }
}
