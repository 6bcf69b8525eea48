//! Points on a grid of whole numbers, on which side of a plane one lies is computed without
//! rounding.

use std::ops::Sub;

use glam::DVec3;

/// The longest side of the points' box has at most this power of two of steps, and more than half
/// as many. A determinant of three differences is below `6 * 2^(3 * 38) < 2^117`, so there is room
/// in 128 bits.
const STEPS: i32 = 38;

/// A point in steps of the grid, each coordinate from 0 to 2^38.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct GridPoint([i64; 3]);

impl GridPoint {
    /// All points on the grid of their box, each coordinate within half a step of what it was:
    /// 2^-38 of the longest side, at most. That side must be in the range of lengths.
    pub(crate) fn all(points: &[DVec3]) -> Vec<Self> {
        let low = points.iter().fold(DVec3::INFINITY, |low, p| low.min(*p));
        let high = points.iter().fold(DVec3::NEG_INFINITY, |high, p| high.max(*p));
        let (_, exponent) = libm::frexp((high - low).max_element());
        let step = libm::ldexp(1.0, exponent - STEPS);
        points.iter().map(|p| Self(((*p - low) / step).to_array().map(|x| libm::round(x) as i64))).collect()
    }
}

impl Sub for GridPoint {
    type Output = [i128; 3];

    fn sub(self, other: Self) -> [i128; 3] {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        [a - x, b - y, c - z].map(i128::from)
    }
}

pub(crate) fn cross([a, b, c]: [i128; 3], [x, y, z]: [i128; 3]) -> [i128; 3] {
    [b * z - c * y, c * x - a * z, a * y - b * x]
}

pub(crate) fn dot([a, b, c]: [i128; 3], [x, y, z]: [i128; 3]) -> i128 {
    a * x + b * y + c * z
}
