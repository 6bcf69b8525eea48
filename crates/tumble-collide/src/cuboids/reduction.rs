//! Reduction of clipped contact points to at most four, with a choice that is stable across steps.

use tumble_math::lane::{Lane, Vec3};

use crate::lanes::FAR;

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

    #[inline(always)]
    fn select(mask: L::Mask, if_true: Self, if_false: Self) -> Self {
        Self {
            at: Vec3::select(mask, if_true.at, if_false.at),
            carried: L::select(mask, if_true.carried, if_false.carried),
            feature: L::select(mask, if_true.feature, if_false.feature),
            index: L::select(mask, if_true.index, if_false.index),
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
    mut candidates: [Candidate<L>; N],
    margin: L,
    size: L,
    middle: [L; 2],
) -> [Candidate<L>; 4] {
    let least_size = size * L::splat(MIN_SIZE);
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
        let score = L::select(candidates[k].at.z.lt(L::splat(FAR * 0.5)), scores[k], L::splat(-FAR));
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
