//! Eight AABBs in SIMD lanes, tested for overlap against one box at once.

use tumble_math::lane::Vec3;

use crate::aabb::Aabb;
use crate::scalar::Scalar;

/// Boxes side by side, compared with another at once.
pub(crate) const LANES: usize = 8;

/// Eight boxes, their coordinates in lanes. Where there is no box, an empty one.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub(crate) struct Aabb8<R> {
    /// x, y and z of all.
    low: [[R; LANES]; 3],
    high: [[R; LANES]; 3],
}

impl<R: Scalar> Aabb8<R> {
    pub(crate) fn empty() -> Self {
        let end = R::splat(f64::INFINITY);
        Self { low: [[end; LANES]; 3], high: [[-end; LANES]; 3] }
    }

    #[inline]
    pub(crate) fn set(&mut self, lane: usize, aabb: &Aabb<R>) {
        let Aabb { low, high } = *aabb;
        for (axis, (low, high)) in [(low.x, high.x), (low.y, high.y), (low.z, high.z)].into_iter().enumerate() {
            self.low[axis][lane] = low;
            self.high[axis][lane] = high;
        }
    }

    /// The smallest box that holds all of them.
    #[inline]
    pub(super) fn union(&self) -> Aabb<R> {
        let low = self.low.map(|lanes| fold(lanes, R::min));
        let high = self.high.map(|lanes| fold(lanes, R::max));
        Aabb { low: Vec3::new(low[0], low[1], low[2]), high: Vec3::new(high[0], high[1], high[2]) }
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

    /// Marks those that have a point in common with the box.
    ///
    /// Not inlined, so that it is vector code: a compiler that sees what becomes of the marks takes
    /// them one by one.
    #[inline(never)]
    pub(super) fn meeting(&self, other: &Aabb<R>, marks: &mut Marks) {
        let Aabb { low, high } = *other;
        self.compare([low.x, low.y, low.z], [high.x, high.y, high.z], marks);
    }

    /// Marks those that have a point in common with one of other eight, whose numbers are read
    /// where they lie: written one by one and read together they would have to be waited for.
    #[inline(never)]
    pub(super) fn meeting_one_of(&self, others: &Self, lane: usize, marks: &mut Marks) {
        let Self { low, high } = others;
        self.compare([low[0][lane], low[1][lane], low[2][lane]], [high[0][lane], high[1][lane], high[2][lane]], marks);
    }

    /// Sets how far along a ray each of them begins, or infinity where it is not met.
    #[inline(never)]
    pub(crate) fn along(&self, ray: &LaneRay<R>, enter: &mut [R; LANES]) {
        let (zero, end) = (R::splat(0.0), R::splat(f64::INFINITY));
        let sides = [0, 1, 2].map(|axis| {
            if ray.is_upward[axis] { [&self.low[axis], &self.high[axis]] } else { [&self.high[axis], &self.low[axis]] }
        });
        for (lane, enter) in enter.iter_mut().enumerate() {
            let at = |axis: usize, side: usize| {
                let LaneAxis { origin, inverse } = &ray.axes[axis][side];
                (sides[axis][side][lane] - origin[lane]) * inverse[lane]
            };
            let begin = at(0, 0).max(at(1, 0)).max(at(2, 0)).max(zero);
            let leave = at(0, 1).min(at(1, 1)).min(at(2, 1));
            *enter = R::select(leave.lt(begin), end, begin);
        }
    }

    /// Sets how far from a point each of them is, as a square \[m^2\].
    #[inline(never)]
    pub(crate) fn squared_distances(&self, point: &[R; 3], squares: &mut [R; LANES]) {
        let zero = R::splat(0.0);
        let early = R::splat(1.0 - 8.0 * R::ROUNDING);
        for (lane, square) in squares.iter_mut().enumerate() {
            let out =
                |axis: usize| (self.low[axis][lane] - point[axis]).max(point[axis] - self.high[axis][lane]).max(zero);
            let [x, y, z] = [out(0), out(1), out(2)];
            *square = (x * x + y * y + z * z) * early;
        }
    }

    #[inline(always)]
    fn compare(&self, low: [R; 3], high: [R; 3], marks: &mut Marks) {
        for (lane, mark) in marks.0.iter_mut().enumerate() {
            // The widest gap between the two. A difference is zero only where the numbers are the
            // same.
            let gap = |axis: usize| (self.low[axis][lane] - high[axis]).max(low[axis] - self.high[axis][lane]);
            *mark = u32::from(gap(0).max(gap(1)).max(gap(2)) <= R::splat(0.0));
        }
    }
}

/// A ray as boxes are compared with it: made longer and wider where it was rounded.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LaneRay<R> {
    /// By axis, for the near and the far sides of boxes.
    axes: [[LaneAxis<R>; 2]; 3],
    is_upward: [bool; 3],
}

/// A coordinate of a ray's origin and the inverse of that of its direction, the same in all lanes.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
struct LaneAxis<R> {
    origin: [R; LANES],
    inverse: [R; LANES],
}

/// A component of a unit vector is at least this long, so that its inverse is in range.
const MIN_COMPONENT: f64 = 1e-30;

impl<R: Scalar> LaneRay<R> {
    /// Of a box that reaches `half` \[m\] from the origin along each axis, moved along a unit
    /// vector.
    pub(crate) fn new(origin: Vec3<f64>, direction: Vec3<f64>, half: Vec3<f64>) -> Self {
        Self {
            axes: [
                Self::axis(origin.x, direction.x, half.x),
                Self::axis(origin.y, direction.y, half.y),
                Self::axis(origin.z, direction.z, half.z),
            ],
            is_upward: [direction.x >= 0.0, direction.y >= 0.0, direction.z >= 0.0],
        }
    }

    #[inline(always)]
    fn axis(origin: f64, direction: f64, half: f64) -> [LaneAxis<R>; 2] {
        // What rounding to this precision may move.
        let rounded: f64 = R::splat(origin).into();
        let is_exact = half == 0.0 && rounded == origin;
        let more = if is_exact { 0.0 } else { half + 4.0 * R::ROUNDING * (origin.abs() + half) };
        let sign = if direction >= 0.0 { 1.0 } else { -1.0 };
        let inverse = sign / direction.abs().max(MIN_COMPONENT);
        // Sooner by four roundings, and later.
        let of = |more: f64, share: f64| LaneAxis {
            origin: [R::splat(origin + more); LANES],
            inverse: [R::splat(inverse * share); LANES],
        };
        [of(sign * more, 1.0 - 8.0 * R::ROUNDING), of(-sign * more, 1.0 + 8.0 * R::ROUNDING)]
    }
}

/// 1 for some of eight lanes, 0 for the others.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Marks([u32; LANES]);

impl Marks {
    /// Keeps those before a lane.
    #[inline]
    pub(super) fn keep_before(&mut self, lane: usize) {
        self.0.iter_mut().enumerate().for_each(|(place, mark)| *mark &= u32::from(place < lane));
    }

    /// Writes what belongs to the marked lanes from the beginning of `to` on, and returns how many
    /// there are. It writes all lanes, so that there is no branch on marks that nobody can guess.
    #[inline]
    pub(super) fn select<T>(&self, to: &mut [T; LANES], what: impl Fn(usize) -> T) -> usize {
        let mut count = 0;
        for (lane, mark) in self.0.iter().enumerate() {
            // Never more than were tested, so the remainder is the count.
            to[count % LANES] = what(lane);
            count += *mark as usize;
        }
        count
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
