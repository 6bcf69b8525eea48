use tumble_math::lane::{Lane, Vec3};
use tumble_math::{Decay, decay};

use crate::state::Constants;

/// What a force and a damping do to a momentum over a fixed time: `p <- kept p + impulse`.
#[derive(Clone, Copy)]
pub(crate) struct Kick<L> {
    linear: Part<L>,
    angular: Part<L>,
}

#[derive(Clone, Copy)]
struct Part<L> {
    /// `e^(-c t)`; `None` without damping, so that an undamped momentum is not touched.
    kept: Option<L>,
    /// The integral of the force, weighed by how much of it is left at the end.
    impulse: Vec3<L>,
}

impl<L: Lane> Kick<L> {
    /// The kick of a body's constant force and torque over the time `t`, exact in the damping.
    #[inline(always)]
    pub(crate) fn new(constants: &Constants<L>, t: L) -> Self {
        let part = |force: Vec3<L>, rate: Option<L>| match rate.map(|rate| decay(rate * t)) {
            None => Part { kept: None, impulse: force * t },
            Some(Decay { kept, mean }) => Part { kept: Some(kept), impulse: force * (mean * t) },
        };
        Self {
            linear: part(constants.force, constants.damping.map(|rates| rates.linear)),
            angular: part(constants.torque, constants.damping.map(|rates| rates.angular)),
        }
    }

    /// The linear momentum after the kick.
    #[inline(always)]
    pub(crate) fn linear(&self, momentum: Vec3<L>) -> Vec3<L> {
        self.linear.apply(momentum)
    }

    /// The angular momentum after the kick.
    #[inline(always)]
    pub(crate) fn angular(&self, momentum: Vec3<L>) -> Vec3<L> {
        self.angular.apply(momentum)
    }
}

impl<L: Lane> Part<L> {
    #[inline(always)]
    fn apply(&self, momentum: Vec3<L>) -> Vec3<L> {
        self.kept.map_or(momentum, |kept| momentum * kept) + self.impulse
    }
}
