//! Unit direction and length of the line between the ends of a spring.

use tumble_math::lane::{Lane, Vec3};

/// From one end of a spring to the other.
#[derive(Clone, Copy)]
pub(crate) struct Direction<L> {
    /// Of unit length; zero where the ends meet, for no direction is better than another there.
    pub(crate) unit: Vec3<L>,
    /// \[m\]
    pub(crate) length: L,
}

impl<L: Lane> Direction<L> {
    #[inline(always)]
    pub(crate) fn of(difference: Vec3<L>) -> Self {
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let length = difference.dot(difference).sqrt();
        let inverse = L::select(zero.lt(length), one / length, zero);
        Self { unit: difference * inverse, length }
    }
}
