//! The few of many points that hold a body as all of them would.

use tumble_math::lane::Vec3;

use crate::manifold::{ContactPoint, MOST_POINTS, Points};
use crate::scalar::Scalar;

/// By how much a later point must be better than an earlier one to be taken in its place. Only as much as rounding may make of points that are the same:
/// the order of the points is not the same from step to step, so a larger lead would choose now one and now another of two that differ.
const LEAD: f64 = 1.0 + 1e-4;
/// Points that are deeper by less than this part of the margin are as deep.
const AS_DEEP: f64 = 0.05;

/// All of four points and fewer. Of more: the outermost of the deepest, the one farthest from it, the one that makes the largest triangle with both, and the
/// one that adds most to its area.
pub(crate) fn reduce<R: Scalar>(candidates: &[ContactPoint<R>], normal: Vec3<R>, margin: R) -> Points<R> {
    let mut points = Points::none();
    if candidates.len() <= MOST_POINTS {
        candidates.iter().for_each(|candidate| points.push(*candidate));
        return points;
    }
    let at = |index: usize| candidates[index].position;
    // Of those that are as deep as any, give or take, one at a corner: an edge that lies along another crosses it anywhere, from step to step.
    let (mut least, mut sum) = (candidates[0].separation, Vec3::zero());
    for candidate in candidates {
        least = least.min(candidate.separation);
        sum = sum + candidate.position;
    }
    let middle = sum * (R::splat(1.0) / R::splat(candidates.len() as f64));
    let is_shallow = |index: usize| candidates[index].separation > least + margin * R::splat(AS_DEEP);
    let deepest = best(candidates, is_shallow, |point| {
        let apart = point - middle;
        apart.dot(apart)
    });
    let far = best(
        candidates,
        |index| index == deepest,
        |point| {
            let apart = point - at(deepest);
            apart.dot(apart)
        },
    );
    // Twice the area of a triangle, positive where the points go around the normal.
    let area = |a: Vec3<R>, b: Vec3<R>, c: Vec3<R>| normal.dot((b - a).cross(c - a));
    let wide =
        best(candidates, |index| [deepest, far].contains(&index), |point| area(at(deepest), at(far), point).abs());
    let corners =
        if area(at(deepest), at(far), at(wide)) < R::splat(0.0) { [deepest, wide, far] } else { [deepest, far, wide] };
    let [a, b, c] = corners.map(at);
    // What a point outside an edge adds.
    let last = best(
        candidates,
        |index| corners.contains(&index),
        |point| (-area(a, b, point)).max(-area(b, c, point)).max(-area(c, a, point)),
    );
    let mut chosen = [deepest, far, wide, last];
    // In the order they came in, whatever made them be chosen.
    chosen.sort_unstable();
    chosen.into_iter().for_each(|index| points.push(candidates[index]));
    points
}

/// The point of the highest score that is not left out; the first such if none is clearly higher.
fn best<R: Scalar>(
    candidates: &[ContactPoint<R>],
    left_out: impl Fn(usize) -> bool,
    score: impl Fn(Vec3<R>) -> R,
) -> usize {
    let mut best: Option<(usize, R)> = None;
    for (index, candidate) in candidates.iter().enumerate().filter(|(index, _)| !left_out(*index)) {
        let score = score(candidate.position);
        let lead = best.is_none_or(|(_, best)| score > best + best.abs() * R::splat(LEAD - 1.0));
        if lead {
            best = Some((index, score));
        }
    }
    best.map_or(0, |(index, _)| index)
}
