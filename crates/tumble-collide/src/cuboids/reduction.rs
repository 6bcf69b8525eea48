//! Reduction of clipped contact points to at most four, with a choice that is stable across steps.

use tumble_math::lane::{Lane, Vec3};

use crate::lanes::{FAR, sign};

/// By how much a later point must be better than an earlier one to be taken in its place. Only as
/// much as rounding may make of points that are the same: the order of the points is not the same
/// from step to step, so a larger lead would choose now one and now another of two that differ.
const LEAD: f64 = 1e-4;
/// Points that are deeper by less than this part of the margin are as deep.
const AS_DEEP: f64 = 0.05;

/// Points in one place are one, and three in a line are two: squares of distances and areas that
/// are less than this part of the square of the faces' size are none. A corner of one face that
/// lies on one of the other is found up to three times.
const MIN_SIZE: f64 = 1e-5;

/// A point that may be one of a manifold's.
#[derive(Clone, Copy)]
pub(super) struct Candidate<L> {
    /// Along the edges of the reference face, and above it, which is the separation; [`FAR`] where
    /// there is none.
    pub(super) at: Vec3<L>,
    /// How far it goes along with the incident box.
    pub(super) carried: L,
    /// Which edges and corners meet, below 64.
    pub(super) feature: L,
    /// Which of the candidates it is.
    pub(super) index: L,
}

impl<L: Lane> Candidate<L> {
    /// None, after all others.
    #[inline(always)]
    pub(super) fn nowhere() -> Self {
        let zero = L::splat(0.0);
        Self { at: Vec3::new(zero, zero, L::splat(FAR)), carried: zero, feature: zero, index: L::splat(FAR) }
    }

    /// One of the candidates; far away where it is further than the margin.
    #[inline(always)]
    pub(super) fn within(self, margin: L, index: usize) -> Self {
        let z = L::select(margin.lt(self.at.z), L::splat(FAR), self.at.z);
        Self { at: Vec3::new(self.at.x, self.at.y, z), index: L::splat(index as f64), ..self }
    }

    /// Whether it is a point.
    #[inline(always)]
    fn is_there(&self) -> L::Mask {
        self.at.z.lt(L::splat(FAR * 0.5))
    }

    #[inline(always)]
    fn select(mask: L::Mask, if_true: Self, if_false: Self) -> Self {
        Self {
            at: Vec3::select(mask, if_true.at, if_false.at),
            carried: L::select(mask, if_true.carried, if_false.carried),
            feature: L::select(mask, if_true.feature, if_false.feature),
            index: L::select(mask, if_true.index, if_false.index),
        }
    }

    /// As [`select`](Self::select), with the index of the second.
    #[inline(always)]
    fn select_point(mask: L::Mask, if_true: Self, if_false: Self) -> Self {
        Self {
            at: Vec3::select(mask, if_true.at, if_false.at),
            carried: L::select(mask, if_true.carried, if_false.carried),
            feature: L::select(mask, if_true.feature, if_false.feature),
            index: if_false.index,
        }
    }
}

/// Up to four of the points there are: the outermost of the deepest, the one farthest from it, the
/// one that makes the largest triangle with both, and the one that adds most to its area, as far as
/// they are apart; the rest are far away. `size` is the square of half the diagonal of the smaller
/// face, `middle` that of what both faces have in common, from which the outermost are far: the
/// mean of the points is beside it where several are in one place.
#[inline(always)]
pub(super) fn choose<L: Lane, const N: usize>(
    candidates: [Candidate<L>; N],
    margin: L,
    size: L,
    middle: [L; 2],
) -> [Candidate<L>; 4] {
    let least_size = size * L::splat(MIN_SIZE);
    let count = count_of(&candidates);
    if L::all(count.lt(L::splat(4.5))) {
        let all = first_four(&candidates);
        if L::all(L::splat(0.5).lt(are_corners(&all, count, least_size))) {
            return all;
        }
    }
    best_four(candidates, margin, least_size, middle)
}

/// As [`choose`], of any number of points.
#[inline(always)]
fn best_four<L: Lane, const N: usize>(
    mut candidates: [Candidate<L>; N],
    margin: L,
    least_size: L,
    middle: [L; 2],
) -> [Candidate<L>; 4] {
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let mut least = L::splat(FAR);
    let mut k = 0;
    while k < N {
        least = least.min(candidates[k].at.z);
        k += 1;
    }
    // Of those that are as deep as any, give or take, one at a corner: an edge that lies along
    // another crosses it anywhere, from step to step.
    let deep = least + margin * L::splat(AS_DEEP);
    let mut scores = [L::splat(-FAR); N];
    let mut k = 0;
    while k < N {
        let at = candidates[k].at;
        scores[k] = L::select(deep.lt(at.z), L::splat(-FAR), square(at.x - middle[0], at.y - middle[1]));
        k += 1;
    }
    let first = best(&mut candidates, scores, L::splat(-0.5 * FAR));
    let mut k = 0;
    while k < N {
        let at = candidates[k].at;
        scores[k] = square(at.x - first.at.x, at.y - first.at.y);
        k += 1;
    }
    let second = best(&mut candidates, scores, least_size);
    let mut k = 0;
    while k < N {
        scores[k] = area(first.at, second.at, candidates[k].at).abs();
        k += 1;
    }
    let third = best(&mut candidates, scores, least_size);
    // What a point outside an edge of the triangle adds, whichever way around its corners go.
    let way = area(first.at, second.at, third.at);
    let around = L::select(way.lt(zero), one, -one);
    let mut k = 0;
    while k < N {
        let at = candidates[k].at;
        let beyond_first = area(first.at, second.at, at) * around;
        let beyond_second = area(second.at, third.at, at) * around;
        let beyond_third = area(third.at, first.at, at) * around;
        scores[k] = beyond_first.max(beyond_second).max(beyond_third);
        k += 1;
    }
    in_order([first, second, third, best(&mut candidates, scores, least_size)])
}

/// How many points there are.
#[inline(always)]
fn count_of<L: Lane, const N: usize>(candidates: &[Candidate<L>; N]) -> L {
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let mut count = zero;
    let mut k = 0;
    while k < N {
        count = count + L::select(candidates[k].is_there(), one, zero);
        k += 1;
    }
    count
}

/// The first four points that there are, in their order and without their index.
#[inline(always)]
fn first_four<L: Lane, const N: usize>(candidates: &[Candidate<L>; N]) -> [Candidate<L>; 4] {
    let mut four = [Candidate::nowhere(); 4];
    let mut k = N;
    while k > 0 {
        k -= 1;
        let is_there = candidates[k].is_there();
        // Those after it move on by one place; there are `N - 1 - k` of them at most.
        let mut place = if N - 1 - k < 3 { N - 1 - k } else { 3 };
        while place > 0 {
            four[place] = Candidate::select_point(is_there, four[place - 1], four[place]);
            place -= 1;
        }
        four[0] = Candidate::select_point(is_there, candidates[k], four[0]);
    }
    four
}

/// One where each of up to four points is a corner of their convex hull, clearly so: then all of
/// them would be chosen. Else zero.
#[inline(always)]
fn are_corners<L: Lane>([a, b, c, d]: &[Candidate<L>; 4], count: L, least_size: L) -> L {
    // So that rounding in areas about other corners changes nothing.
    let clear = least_size * L::splat(2.0);
    let (abc, abd) = (area(a.at, b.at, c.at), area(a.at, b.at, d.at));
    let (acd, bcd) = (area(a.at, c.at, d.at), area(b.at, c.at, d.at));
    let least = abc.abs().min(abd.abs()).min(acd.abs().min(bcd.abs()));
    // Of four points in the plane one is within the triangle of the others where this is negative.
    let turns = (sign(abc) * sign(abd)) * (sign(acd) * sign(bcd));
    let four = above(least, clear) * above(turns, L::splat(0.0));
    let three = above(abc.abs(), clear);
    let two = above(square(b.at.x - a.at.x, b.at.y - a.at.y), clear);
    let up_to_two = L::select(count.lt(L::splat(1.5)), L::splat(1.0), two);
    let up_to_three = L::select(count.lt(L::splat(2.5)), up_to_two, three);
    L::select(count.lt(L::splat(3.5)), up_to_three, four)
}

/// One where a number is above the bar, else zero.
#[inline(always)]
fn above<L: Lane>(number: L, bar: L) -> L {
    L::select(bar.lt(number), L::splat(1.0), L::splat(0.0))
}

/// In the order they came in, whatever made them be chosen: a solver that takes them one after the
/// other finds no rest while their order changes.
#[inline(always)]
fn in_order<L: Lane>(mut chosen: [Candidate<L>; 4]) -> [Candidate<L>; 4] {
    let swaps = [[0, 1], [2, 3], [0, 2], [1, 3], [1, 2]];
    let mut k = 0;
    while k < swaps.len() {
        let [i, j] = swaps[k];
        let swapped = chosen[j].index.lt(chosen[i].index);
        let (a, b) = (chosen[i], chosen[j]);
        chosen[i] = Candidate::select(swapped, b, a);
        chosen[j] = Candidate::select(swapped, a, b);
        k += 1;
    }
    chosen
}

/// Takes out the point of the highest score above `bar`; the first such if none is clearly higher.
#[inline(always)]
fn best<L: Lane, const N: usize>(candidates: &mut [Candidate<L>; N], scores: [L; N], mut bar: L) -> Candidate<L> {
    let mut chosen = Candidate::nowhere();
    let mut k = 0;
    while k < N {
        // What is not there has no score.
        let score = L::select(candidates[k].is_there(), scores[k], L::splat(-FAR));
        let better = bar.lt(score);
        chosen = Candidate::select(better, candidates[k], chosen);
        bar = L::select(better, score + score.abs() * L::splat(LEAD), bar);
        k += 1;
    }
    let mut k = 0;
    while k < N {
        let at = &mut candidates[k].at;
        let taken = (chosen.index - L::splat(k as f64)).abs().lt(L::splat(0.5));
        at.z = L::select(taken, L::splat(FAR), at.z);
        k += 1;
    }
    chosen
}

/// Twice the area of a triangle in the plane, positive where its corners go around against the
/// clock.
#[inline(always)]
fn area<L: Lane>(a: Vec3<L>, b: Vec3<L>, c: Vec3<L>) -> L {
    (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
}

#[inline(always)]
fn square<L: Lane>(x: L, y: L) -> L {
    x * x + y * y
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// In parts of the face, and above it.
    type Point = (f32, f32, f32);

    /// Up to twelve points in a face, and its half width \[m\]; some are in one place and some
    /// in a line.
    fn points() -> impl Strategy<Value = (Vec<Option<Point>>, f32)> {
        let place = prop_oneof![2 => -1.0_f32..1.0, 1 => Just(-1.0), 1 => Just(1.0), 1 => Just(0.25)];
        let point = proptest::option::weighted(0.4, (place.clone(), place, -1.0_f32..1.0));
        (proptest::collection::vec(point, 12), prop_oneof![Just(0.01_f32), Just(1.0), Just(100.0)])
    }

    fn candidates(points: &[Option<Point>], width: f32) -> [Candidate<f32>; 12] {
        std::array::from_fn(|k| {
            let Some((x, y, z)) = points[k] else { return Candidate::nowhere() };
            let at = Vec3::new(x * width, y * width * 0.3, z * width * 0.01);
            Candidate { at, carried: 0.5, feature: k as f32, index: 0.0 }.within(0.02 * width, k)
        })
    }

    fn places(chosen: [Candidate<f32>; 4]) -> [[f32; 4]; 4] {
        chosen.map(|it| [it.at.x, it.at.y, it.at.z, it.feature])
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4096))]

        #[test]
        fn points_that_are_all_corners_are_chosen_without_a_choice((points, width) in points()) {
            let (margin, size) = (0.02 * width, width * width * 1.09);
            let candidates = candidates(&points, width);
            let chosen = choose(candidates, margin, size, [0.1 * width, 0.0]);
            let general = best_four(candidates, margin, size * MIN_SIZE as f32, [0.1 * width, 0.0]);
            prop_assert_eq!(places(chosen), places(general));
        }
    }

    #[test]
    fn four_corners_are_taken_and_a_point_between_them_is_not() {
        let corner = |x: f32, y: f32| Some((x, y, 0.0));
        let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        let short = |fifth: Option<Point>, fourth: Option<Point>| {
            let mut points = vec![None; 12];
            points[..3].copy_from_slice(&corners[..3]);
            (points[7], points[9]) = (fourth, fifth);
            let candidates = candidates(&points, 1.0);
            let count = count_of(&candidates);
            count < 4.5 && are_corners(&first_four(&candidates), count, 1e-5) > 0.5
        };
        assert!(short(None, corners[3]) && short(None, None));
        assert!(!short(corners[3], corners[3]), "there are five");
        assert!(!short(None, corner(0.3, -0.2)), "one is within the triangle of the others");
        assert!(!short(None, corner(0.0, -1.0)), "three are in a line");
        assert!(!short(None, corners[0]), "two are in one place");
    }
}
