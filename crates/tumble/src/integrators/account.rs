//! Accounting of work per source of momentum change, and the no-op account.

use tumble_math::lane::Vec3;

use crate::integrators::state::State;

/// Keeps account of the work that is done on a body.
///
/// A momentum that changes by `dP` from `P` to `P'` changes the kinetic energy by `dP.(P + P')/2M`,
/// exactly. So each source of a change is given the work `its share of dP . mean velocity`,
/// likewise for rotation, and the shares add up to the change.
pub(crate) trait Account<L> {
    /// Whether anything is kept; `false` lets a scheme leave out what only an account needs.
    const KEPT: bool;

    /// A substep begins at this simulated time \[s\].
    fn begin_substep(&mut self, time: f64);

    /// The constant forces have added their `weight` \[s\] to the linear and the angular momentum.
    fn constant_impulse(&mut self, weight: (L, L), mean: &Mean<L>);

    /// The varying forces at a state, `offset` \[s\] into the substep, have added their `weight`
    /// \[s\] to the momenta.
    fn varying_impulse(&mut self, offset: L, at: &State<L>, weight: (L, L), mean: &Mean<L>);

    /// Damping has added these to the momenta.
    fn damping(&mut self, linear: Vec3<L>, angular: Vec3<L>, mean: &Mean<L>);
}

/// Mean velocities over a change of momentum.
#[derive(Clone, Copy)]
pub(crate) struct Mean<L> {
    pub(crate) linear: Vec3<L>,
    pub(crate) angular: Vec3<L>,
}

/// No account.
pub(crate) struct NoAccount;

impl<L> Account<L> for NoAccount {
    const KEPT: bool = false;

    #[inline(always)]
    fn begin_substep(&mut self, _: f64) {}

    #[inline(always)]
    fn constant_impulse(&mut self, _: (L, L), _: &Mean<L>) {}

    #[inline(always)]
    fn varying_impulse(&mut self, _: L, _: &State<L>, _: (L, L), _: &Mean<L>) {}

    #[inline(always)]
    fn damping(&mut self, _: Vec3<L>, _: Vec3<L>, _: &Mean<L>) {}
}
