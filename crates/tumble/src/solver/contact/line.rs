//! Contacts along a line that turns about the normal, as those of cones that roll on their sides.

use tumble_math::lane::Vec3;

use crate::simd::block_lanes::{Lanes, at, put};
use crate::simd::{BLOCK, Tile};
use crate::solver::contact::update_geometry::LAG;

/// Lines of contact in a block.
#[derive(Clone, Copy)]
#[repr(C)]
pub(crate) struct Line {
    /// About the normal, in the last substep \[rad\]; zero where no line was found again.
    pub(crate) turn: Lanes,
    /// By how much the relative angular velocity about the tangents differs from its mean over the
    /// last substep, as the points have it [rad/s].
    pub(crate) lag: [Lanes; 2],
}

impl Line {
    pub(crate) const NONE: Self = Self { turn: [0.0; BLOCK], lag: [[0.0; BLOCK]; 2] };

    /// How much a line between two points turned about the normal to where it is now; zero where it
    /// is another.
    pub(crate) fn turn_between<T: Tile>(normal: Vec3<T>, before: Vec3<T>, now: Vec3<T>) -> T {
        let (turn, square) = (normal.dot(before.cross(now)), now.dot(now));
        let half = turn * T::splat(0.5);
        let is_same = (half * half).lt(square * square * T::splat(LAG));
        T::select(is_same, turn / square, T::splat(0.0))
    }

    /// Finds the lag, with the relative spin, and what of it free motion gains in half a substep.
    ///
    /// As along the surface, what is to vanish is the velocity in the middle of a substep. What
    /// rolls about a line that turns has another one at the end, by which a cone on its side would
    /// gain energy to first order in the substep.
    #[inline(always)]
    pub(crate) fn find_lag<T: Tile>(
        &mut self,
        lane: usize,
        (normal, tangent): (Vec3<T>, Vec3<T>),
        (spin, gain): (Vec3<T>, Vec3<T>),
    ) {
        let (zero, half) = (T::splat(0.0), T::splat(0.5));
        let turn: T = at(&self.turn, lane);
        let lag = gain - normal.cross(spin) * (turn * half);
        let is_small = gain.dot(gain).lt(spin.dot(spin) * T::splat(LAG));
        let lag = Vec3::select(zero.lt(turn.abs()), Vec3::select(is_small, lag, Vec3::zero()), Vec3::zero());
        put(tangent.dot(lag), &mut self.lag[0], lane);
        put(normal.cross(tangent).dot(lag), &mut self.lag[1], lane);
        put(zero, &mut self.turn, lane);
    }

    /// Forgets the lag where contacts bounce.
    #[inline(always)]
    pub(crate) fn forget_lag_where<T: Tile>(&mut self, bounces: T::Mask, lane: usize) {
        for lag in &mut self.lag {
            put(T::select(bounces, T::splat(0.0), at(lag, lane)), lag, lane);
        }
    }

    /// The parts of a motion along the normal before a substep: that in its middle and the lag.
    #[inline(always)]
    pub(crate) fn with_lag<T: Tile>(&self, [along, about, about_second]: [T; 3], lane: usize) -> [T; 3] {
        [along, about + at(&self.lag[0], lane), about_second + at(&self.lag[1], lane)]
    }

    /// The same after it, without the lag.
    #[inline(always)]
    pub(crate) fn without_lag<T: Tile>(&self, [along, about, about_second]: [T; 3], lane: usize) -> [T; 3] {
        [along, about - at(&self.lag[0], lane), about_second - at(&self.lag[1], lane)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Real;

    #[test]
    fn a_line_turns_about_the_normal_counter_clockwise() {
        let normal = Vec3::new(0.0, 0.0, 1.0);
        let turned = |angle: Real| Vec3::new(3.0 * angle.cos(), 3.0 * angle.sin(), 0.0);
        let turn = |angle: Real| Line::turn_between(normal, turned(0.2), turned(0.2 + angle));
        assert!((turn(0.1) - 0.1).abs() < 1e-3 && (turn(-0.1) + 0.1).abs() < 1e-3);
        // Another line, which shares nothing with the one before.
        assert_eq!(turn(1.0), 0.0);
    }
}
