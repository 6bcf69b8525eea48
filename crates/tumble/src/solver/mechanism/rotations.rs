//! The rotations that a joint leaves free.

use crate::joints::axes::Axes;

/// Which rotations a joint leaves free.
#[derive(Clone, Copy, Debug)]
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
}

/// The sine of the angle between the axes of a universal joint below which they are the same.
pub(super) const MIN_SINE: f64 = 1e-9;

/// Twice the tangent of half the angle by which two axes with this cosine miss being square: unlike
/// the cosine it goes on growing up to where they are the same.
#[inline(always)]
pub(super) fn from_square(cosine: f64) -> f64 {
    2.0 * cosine / (1.0 + (1.0 - cosine * cosine).max(0.0).sqrt())
}
