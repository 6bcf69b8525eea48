//! What the two ways to solve the equation of the map have in common.

use crate::lane::{Lane, Vec3};

/// A way to solve the equation of the map for one body and one length of step.
///
/// Most steps are short. What serves them may be less work, but a body must get the same bits from
/// either function: others in its tile may need the longer way.
pub(super) trait Solver<L: Lane>: Copy {
    /// The largest kappa of a short step.
    const LARGEST_SHORT_KAPPA: f64;

    /// Two invariants of the motion that are proportional to `h^2`, from the principal components
    /// `y` of the angular momentum and the right side `b = h/2 y`.
    fn invariants(&self, y: Vec3<L>, b: Vec3<L>) -> (L, L);

    /// The square of the largest half-turn a step can make.
    fn kappa(&self, invariants: (L, L)) -> L;

    /// `u` of a short step.
    fn short_turn(&self, invariants: (L, L), kappa: L, b: Vec3<L>) -> Vec3<L>;

    /// `u` where kappa is at most [`LARGEST_KAPPA`](super::LARGEST_KAPPA).
    fn turn(&self, invariants: (L, L), kappa: L, b: Vec3<L>) -> Vec3<L>;

    /// `1/sqrt(1 + u^2) - 1` of a short step, from `u^2`.
    fn short_shrinkage(&self, uu: L) -> L;

    /// The same where kappa is at most [`LARGEST_KAPPA`](super::LARGEST_KAPPA).
    fn shrinkage(&self, kappa: L, uu: L) -> L;

    /// The angles `h w_j`; `to_drive` is what takes `y` to `b`.
    fn angles(&self, y: Vec3<L>, to_drive: L) -> Vec3<L>;
}
