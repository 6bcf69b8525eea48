//! The rotations that a joint leaves free.

use tumble_math::lane::{Lane, Quat, Vec3};

use crate::joints::axes::Axes;

/// Which rotations a joint leaves free.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Rotations {
    Locked,
    About(usize),
    /// About an axis of the first frame, and another of the second.
    AboutBoth(usize, usize),
    Free,
}

impl Rotations {
    pub(crate) fn of(free: Axes) -> Self {
        match [3, 4, 5].map(|axis| free.has(axis)) {
            [false, false, false] => Self::Locked,
            [true, false, false] => Self::About(0),
            [false, true, false] => Self::About(1),
            [false, false, true] => Self::About(2),
            [false, true, true] => Self::AboutBoth(1, 2),
            [true, false, true] => Self::AboutBoth(0, 2),
            [true, true, false] => Self::AboutBoth(0, 1),
            [true, true, true] => Self::Free,
        }
    }

    /// How many are locked.
    #[inline(always)]
    pub(super) fn locked(self) -> usize {
        match self {
            Self::Locked => 3,
            Self::About(_) => 2,
            Self::AboutBoth(..) => 1,
            Self::Free => 0,
        }
    }

    /// Out of the axes of the first frame, those about which rotations are locked come first; not
    /// for two free rotations, of which the third has no fixed axis.
    #[inline(always)]
    pub(crate) fn locked_axes<L: Lane>(self, axes: [Vec3<L>; 3]) -> [Vec3<L>; 3] {
        match self {
            Self::About(k) => [axes[(k + 1) % 3], axes[(k + 2) % 3], axes[k]],
            _ => axes,
        }
    }

    /// Errors of the locked rotations where the second frame is turned like this against the first.
    #[inline(always)]
    pub(crate) fn errors<L: Lane>(self, turned: Quat<L>) -> [L; 3] {
        let (v, w, zero, two) = ([turned.x, turned.y, turned.z], turned.w, L::splat(0.0), L::splat(2.0));
        // Axes of the second frame along those of the first, but for cosines of the whole.
        let rises = |i: usize, k: usize, j: usize| two * (v[i] * v[k] + w * v[j]);
        let falls = |i: usize, k: usize, j: usize| two * (v[i] * v[k] - w * v[j]);
        match self {
            Self::Locked => {
                let twice = L::select(w.lt(zero), L::splat(-2.0), two);
                [v[0] * twice, v[1] * twice, v[2] * twice]
            }
            Self::About(0) => [-falls(2, 0, 1), rises(1, 0, 2), zero],
            Self::About(1) => [-falls(0, 1, 2), rises(2, 1, 0), zero],
            Self::About(_) => [-falls(1, 2, 0), rises(0, 2, 1), zero],
            Self::AboutBoth(0, 2) => [from_square(rises(0, 2, 1)), zero, zero],
            Self::AboutBoth(0, _) => [from_square(falls(0, 1, 2)), zero, zero],
            Self::AboutBoth(..) => [from_square(falls(1, 2, 0)), zero, zero],
            Self::Free => [zero; 3],
        }
    }
}

/// The sine of the angle between the axes of a universal joint below which they are the same.
pub(super) const MIN_SINE: f64 = 1e-9;

/// Twice the tangent of half the angle by which two axes with this cosine miss being square: unlike
/// the cosine it goes on growing up to where they are the same.
#[inline(always)]
fn from_square<L: Lane>(cosine: L) -> L {
    let one = L::splat(1.0);
    L::splat(2.0) * cosine / (one + (one - cosine * cosine).max(L::splat(0.0)).sqrt())
}
