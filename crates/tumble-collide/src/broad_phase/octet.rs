use tumble_math::lane::Vec3;

use crate::bounds::Bounds;
use crate::scalar::Scalar;

/// Boxes side by side, compared with another at once.
pub(super) const LANES: usize = 8;

/// Eight boxes, their coordinates in lanes. Where there is no box, an empty one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Octet<R> {
    /// x, y and z of all.
    low: [[R; LANES]; 3],
    high: [[R; LANES]; 3],
}

impl<R: Scalar> Octet<R> {
    pub(super) fn empty() -> Self {
        let end = R::splat(f64::INFINITY);
        Self { low: [[end; LANES]; 3], high: [[-end; LANES]; 3] }
    }

    #[inline]
    pub(super) fn set(&mut self, lane: usize, bounds: &Bounds<R>) {
        let Bounds { low, high } = *bounds;
        for (axis, (low, high)) in [(low.x, high.x), (low.y, high.y), (low.z, high.z)].into_iter().enumerate() {
            self.low[axis][lane] = low;
            self.high[axis][lane] = high;
        }
    }

    #[inline]
    pub(super) fn get(&self, lane: usize) -> Bounds<R> {
        let corner = |of: &[[R; LANES]; 3]| Vec3::new(of[0][lane], of[1][lane], of[2][lane]);
        Bounds { low: corner(&self.low), high: corner(&self.high) }
    }

    /// The smallest box that holds all of them.
    #[inline]
    pub(super) fn union(&self) -> Bounds<R> {
        let low = self.low.map(|lanes| fold(lanes, R::min));
        let high = self.high.map(|lanes| fold(lanes, R::max));
        Bounds { low: Vec3::new(low[0], low[1], low[2]), high: Vec3::new(high[0], high[1], high[2]) }
    }

    /// The lengths of the sides of all of them, added up \[m\].
    #[inline]
    pub(super) fn sides(&self) -> R {
        let mut sides = [R::splat(0.0); LANES];
        for axis in 0..3 {
            for (lane, side) in sides.iter_mut().enumerate() {
                // Nothing is as long as nothing.
                *side = *side + (self.high[axis][lane] - self.low[axis][lane]).max(R::splat(0.0));
            }
        }
        fold(sides, |a, b| a + b)
    }

    /// Those that have a point in common with the box.
    #[inline]
    pub(super) fn meeting(&self, other: &Bounds<R>) -> Hits {
        let (low, high) = (other.low, other.high);
        let mut hits = [0_u8; LANES];
        // One loop over bytes without branches, of which compilers make vector code.
        for (lane, hit) in hits.iter_mut().enumerate() {
            *hit = u8::from(self.low[0][lane] <= high.x)
                & u8::from(low.x <= self.high[0][lane])
                & u8::from(self.low[1][lane] <= high.y)
                & u8::from(low.y <= self.high[1][lane])
                & u8::from(self.low[2][lane] <= high.z)
                & u8::from(low.z <= self.high[2][lane]);
        }
        Hits(u64::from_le_bytes(hits))
    }
}

/// Combines the lanes by halves.
#[inline]
fn fold<R: Scalar>(mut lanes: [R; LANES], combine: impl Fn(R, R) -> R) -> R {
    for width in [4, 2, 1] {
        for lane in 0..width {
            lanes[lane] = combine(lanes[lane], lanes[lane + width]);
        }
    }
    lanes[0]
}

/// Some of the eight lanes, from the first on: a byte each, 1 where it is one of them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hits(u64);

impl Hits {
    /// Those of them that come before a lane.
    #[inline]
    pub(super) fn before(self, lane: usize) -> Self {
        Self(self.0 & ((1 << (8 * lane)) - 1))
    }
}

impl Iterator for Hits {
    type Item = usize;

    #[inline]
    fn next(&mut self) -> Option<usize> {
        let first = (self.0 != 0).then(|| self.0.trailing_zeros() as usize / 8)?;
        self.0 &= self.0 - 1;
        Some(first)
    }
}
