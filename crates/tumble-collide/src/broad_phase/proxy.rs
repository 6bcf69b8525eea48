//! Broad-phase proxies: the AABB of an object, and whether the object can move.

use crate::aabb::Aabb;
use crate::scalar::Scalar;

/// What the broad phase knows of an object.
///
/// ```
/// use tumble_collide::{Aabb, Proxy};
/// use tumble_math::lane::Vec3;
///
/// let unit = |x: f64| Some(Aabb::about(Vec3::new(x, 0.0, 0.0), Vec3::splat(0.5)));
/// let (crate_of_tea, wall) =
///     (Proxy { aabb: unit(0.0), moves: true }, Proxy { aabb: unit(0.9), moves: false });
/// let ground = Proxy { aabb: None, moves: false };
/// assert!(crate_of_tea.is_near(&wall) && crate_of_tea.is_near(&ground));
/// // Neither of the two moves.
/// assert!(!wall.is_near(&ground));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Proxy<R> {
    /// The box that it is in, world frame, with as much around it as counts as near; `None` for
    /// what has no end.
    pub aabb: Option<Aabb<R>>,
    /// Whether it can be moved: two that cannot do nothing to each other.
    pub moves: bool,
}

impl<R: Scalar> Proxy<R> {
    /// Whether the two may touch: one of them moves, and their boxes meet. What has no end meets
    /// everything that has one; a box that is not finite, or turned inside out, meets nothing.
    #[inline]
    pub fn is_near(&self, other: &Self) -> bool {
        let near = match (&self.aabb, &other.aabb) {
            (Some(a), Some(b)) => a.meets(b) && a.is_finite() && b.is_finite(),
            (Some(a), None) | (None, Some(a)) => a.is_finite(),
            (None, None) => false,
        };
        (self.moves || other.moves) && near
    }
}
