//! The few of many points that hold a body as all of them would.

use tumble_math::lane::Vec3;

use crate::manifold::{ContactPoint, MAX_MANIFOLD_POINTS, NARROW, Points};
use crate::scalar::Scalar;

/// By how much a later point must be better than an earlier one to be taken in its place. Only as
/// much as rounding may make of points that are the same: the order of the points is not the same
/// from step to step, so a larger lead would choose now one and now another of two that differ. Of
/// a stick a hundred times as long as wide, the corner of an end is further from its middle than
/// the end's middle by half a ten-thousandth.
const LEAD: f64 = 1e-6;
/// Points that are deeper by less than this part of the margin, or of the extent of all if that is
/// less, are as deep; and so are all that overlap, for a load presses what rests in aslant.
const AS_DEEP: f64 = 0.05;
/// A load presses in by this number of margins at most; what is deeper is not at rest.
const MAX_PRESSED: f64 = 4.0;
/// A point is as near as the nearest if it is not further by more than this part of its depth: that
/// of a regular pentagon which is left out of a face, where a load tilts it until the other side
/// parts, is deeper by 0.35 of that.
const PRESSED: f64 = 0.4;

/// A middle that is further inside the sides of the chosen points than this part of twice their
/// area over their extent is held; that of a regular pentagon is by 0.17 of it.
const HELD: f64 = 0.125;
/// A point takes the place of another where that moves a side outwards by more than this part of
/// the extent.
const WORTH: f64 = 2e-3;
/// What holds a middle has at least this part of the area of those points that were chosen first.
const MIN_AREA: f64 = 0.8;

/// Which of two shapes a piece was cut of, with which points go.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Cut {
    First,
    Second,
}

/// Of points in a line the two ends. Else all of four points and fewer. Of more: the outermost of
/// the deepest, the one farthest from it, the one that makes the largest triangle with both, and
/// the one that adds most to its area; then those without which a middle of a shape, which stands
/// for its centre of mass, is not held where all points hold it.
pub(crate) fn reduce<R: Scalar>(
    candidates: &[ContactPoint<R>],
    cut: Cut,
    normal: Vec3<R>,
    margin: R,
    middles: &[Vec3<R>],
) -> Points<R> {
    let mut points = Points::none();
    if candidates.len() < 3 {
        candidates.iter().for_each(|candidate| points.push(*candidate));
        return points;
    }
    // On the flat piece, so that distances between its corners are the same however it is tilted.
    let towards = normal * R::splat(if cut == Cut::Second { 0.5 } else { -0.5 });
    let at = |index: usize| candidates[index].position + towards * candidates[index].separation;
    // Of those that are as deep as any, give or take, one at a corner: an edge that lies along
    // another crosses it anywhere, from step to step.
    let least = candidates.iter().fold(candidates[0].separation, |least, candidate| least.min(candidate.separation));
    // Of the extent: the mean of the points is beside it where several are close together.
    let [low, high] = extent(at(0), (0..candidates.len()).map(at));
    let middle = (low + high) * R::splat(0.5);
    let as_deep = at_most_extent(margin, candidates) * R::splat(AS_DEEP);
    let deep = least + as_deep.max(pressed_in(least, margin));
    let is_shallow = |index: usize| candidates[index].separation > deep;
    let square = |v: Vec3<R>| v.dot(v);
    let count = candidates.len();
    let deepest = best(count, is_shallow, |index| square(at(index) - middle));
    let far = best(count, |index| index == deepest, |index| square(at(index) - at(deepest)));
    // Twice the area of a triangle, positive where the points go around the normal.
    let area = |a: Vec3<R>, b: Vec3<R>, c: Vec3<R>| normal.dot((b - a).cross(c - a));
    let wide =
        best(count, |index| [deepest, far].contains(&index), |index| area(at(deepest), at(far), at(index)).abs());
    // An edge that crosses the seams of a surface is held by its ends: what lies on three points
    // does not roll.
    let length = square(at(far) - at(deepest));
    if area(at(deepest), at(far), at(wide)).abs() <= length * R::splat(NARROW) {
        [deepest.min(far), deepest.max(far)].into_iter().for_each(|index| points.push(candidates[index]));
        return points;
    }
    if count <= MAX_MANIFOLD_POINTS {
        candidates.iter().for_each(|candidate| points.push(*candidate));
        return points;
    }
    let corners =
        if area(at(deepest), at(far), at(wide)) < R::splat(0.0) { [deepest, wide, far] } else { [deepest, far, wide] };
    let [a, b, c] = corners.map(at);
    // What a point outside an edge adds.
    let added = |point: Vec3<R>| (-area(a, b, point)).max(-area(b, c, point)).max(-area(c, a, point));
    let last = best(count, |index| corners.contains(&index), |index| added(at(index)));
    // What adds nothing to a triangle is on a side of it, anywhere.
    let of_triangle = area(a, b, c);
    let adds = of_triangle <= R::splat(0.0) || added(at(last)) > of_triangle * R::splat(LEAD);
    let mut chosen = [deepest, far, wide, last];
    if adds {
        for middle in middles {
            hold_middle(&mut chosen, count, *middle, normal, length.sqrt(), &at);
        }
    }
    let chosen = if adds { &mut chosen[..] } else { &mut chosen[..3] };
    // In the order they came in, whatever made them be chosen.
    chosen.sort_unstable();
    chosen.iter().for_each(|index| points.push(candidates[*index]));
    points
}

/// Puts points in the place of others until no point is beyond the side of the four that is nearest
/// to a middle, where that is not well inside and they can hold it. What overhangs an edge is held
/// by both ends of it.
fn hold_middle<R: Scalar>(
    four: &mut [usize; MAX_MANIFOLD_POINTS],
    count: usize,
    middle: Vec3<R>,
    normal: Vec3<R>,
    extent: R,
    at: &impl Fn(usize) -> Vec3<R>,
) {
    let breadth = |four: [usize; MAX_MANIFOLD_POINTS]| width(four.map(at), normal) / extent;
    let least = breadth(*four) * R::splat(MIN_AREA);
    let (held, worth) = (breadth(*four) * R::splat(HELD), extent * R::splat(WORTH));
    let nearest = |four: [usize; MAX_MANIFOLD_POINTS]| nearest_side(four.map(at), middle, normal);
    // Of those that hold it as well the widest.
    let score = |four: [usize; MAX_MANIFOLD_POINTS], depth: R| depth.min(held) + breadth(four) * R::splat(0.1 * WORTH);
    let mut better = *four;
    let Some(mut side) = nearest(better) else { return };
    for _ in 0..MAX_MANIFOLD_POINTS {
        let beyond = |index: usize| side.outwards.dot(at(index) - side.from);
        let furthest = best(count, |index| better.contains(&index), beyond);
        if side.depth >= held || beyond(furthest) <= worth {
            break;
        }
        let (mut next, mut most) = (None, score(better, side.depth) + worth * R::splat(0.1));
        for replaced in 0..MAX_MANIFOLD_POINTS {
            let mut other = better;
            other[replaced] = furthest;
            if let Some(side) = nearest(other).filter(|_| breadth(other) >= least) {
                let score = score(other, side.depth);
                if score > most {
                    (next, most) = (Some((other, side)), score);
                }
            }
        }
        let Some(next) = next else { break };
        (better, side) = next;
    }
    if side.depth > R::splat(0.0) {
        *four = better;
    }
}

/// A side of a polygon, seen from a place.
struct Side<R> {
    from: Vec3<R>,
    /// Unit vector.
    outwards: Vec3<R>,
    /// How far the place is inside of it \[m\].
    depth: R,
}

/// The side of points in a plane that is nearest to a place, or that the place is furthest beyond.
fn nearest_side<R: Scalar>(
    corners: [Vec3<R>; MAX_MANIFOLD_POINTS],
    place: Vec3<R>,
    normal: Vec3<R>,
) -> Option<Side<R>> {
    let mut nearest: Option<Side<R>> = None;
    for (i, from) in corners.into_iter().enumerate() {
        for (j, to) in corners.into_iter().enumerate() {
            let out = (to - from).cross(normal);
            let is_inside = |k: usize| k == i || k == j || out.dot(corners[k] - from) <= R::splat(0.0);
            let length = out.dot(out).sqrt();
            if length <= R::splat(0.0) || !(0..MAX_MANIFOLD_POINTS).all(is_inside) {
                continue;
            }
            let outwards = out * (R::splat(1.0) / length);
            let depth = -outwards.dot(place - from);
            if nearest.as_ref().is_none_or(|nearest| depth < nearest.depth) {
                nearest = Some(Side { from, outwards, depth });
            }
        }
    }
    nearest
}

/// Few points may have none of many that is as near as `level` among them; then the nearest takes
/// the place of one of four without which they are widest, of fewer of the one closest to it.
pub(crate) fn keep_nearest<R: Scalar>(
    points: &mut Points<R>,
    candidates: &[ContactPoint<R>],
    level: R,
    normal: Vec3<R>,
) {
    let mut nearest: Option<&ContactPoint<R>> = None;
    for candidate in candidates {
        if nearest.is_none_or(|nearest| candidate.separation < nearest.separation) {
            nearest = Some(candidate);
        }
    }
    let Some(nearest) = nearest else { return };
    if points.iter().any(|point| point.separation <= level) {
        return;
    }
    let mut places = [Vec3::zero(); MAX_MANIFOLD_POINTS];
    places.iter_mut().zip(points.iter()).for_each(|(place, point)| *place = point.position);
    let count = points.iter().count();
    let score = |replaced: usize| {
        let mut places = places;
        let apart = nearest.position - places[replaced];
        places[replaced] = nearest.position;
        if count == MAX_MANIFOLD_POINTS { width(places, normal) } else { -apart.dot(apart) }
    };
    let mut best: Option<(usize, R)> = None;
    for index in 0..count {
        let score = score(index);
        if best.is_none_or(|(_, best)| score > best) {
            best = Some((index, score));
        }
    }
    if let Some(point) = best.and_then(|(index, _)| points.iter_mut().nth(index)) {
        *point = *nearest;
    }
}

/// How wide four points are: twice their area where each is a corner.
fn width<R: Scalar>([a, b, c, d]: [Vec3<R>; MAX_MANIFOLD_POINTS], normal: Vec3<R>) -> R {
    let across =
        |from: Vec3<R>, to: Vec3<R>, other: [Vec3<R>; 2]| normal.dot((to - from).cross(other[1] - other[0])).abs();
    across(a, b, [c, d]).max(across(a, c, [b, d])).max(across(a, d, [b, c]))
}

/// How far a load presses shapes into each other at most, at this separation \[m\].
pub(crate) fn pressed_in<R: Scalar>(separation: R, margin: R) -> R {
    (-separation).max(R::splat(0.0)).min(margin * R::splat(MAX_PRESSED))
}

/// By how much a point may be further than one at this separation and still be as near \[m\].
pub(crate) fn pressed<R: Scalar>(separation: R, margin: R) -> R {
    pressed_in(separation, margin) * R::splat(PRESSED)
}

/// The corners of the box along the axes that holds all places, of which there is a first.
fn extent<R: Scalar>(first: Vec3<R>, places: impl Iterator<Item = Vec3<R>>) -> [Vec3<R>; 2] {
    let least = |a: Vec3<R>, b: Vec3<R>| Vec3::new(a.x.min(b.x), a.y.min(b.y), a.z.min(b.z));
    let most = |a: Vec3<R>, b: Vec3<R>| Vec3::new(a.x.max(b.x), a.y.max(b.y), a.z.max(b.z));
    places.fold([first; 2], |[low, high], place| [least(low, place), most(high, place)])
}

/// The margin, or the extent of several points if that is less: what counts as a small height among
/// them.
pub(crate) fn at_most_extent<R: Scalar>(margin: R, candidates: &[ContactPoint<R>]) -> R {
    let [first, _, ..] = candidates else { return margin };
    let [low, high] = extent(first.position, candidates.iter().map(|candidate| candidate.position));
    let size = high - low;
    margin.min(size.dot(size).sqrt())
}

/// Which of a number of points has the highest score and is not left out; the first such if none is
/// clearly higher.
fn best<R: Scalar>(count: usize, left_out: impl Fn(usize) -> bool, score: impl Fn(usize) -> R) -> usize {
    let mut best: Option<(usize, R)> = None;
    for index in (0..count).filter(|index| !left_out(*index)) {
        let score = score(index);
        let lead = best.is_none_or(|(_, best)| score > best + best.abs() * R::splat(LEAD));
        if lead {
            best = Some((index, score));
        }
    }
    best.map_or(0, |(index, _)| index)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::support_map::Vector;

    /// Corners of a polygon in a unit circle, of which a line has cut a part off: at which height
    /// it cuts, and its corners as parts of a turn.
    fn cut_polygon(cut: f64, mut turns: Vec<f64>) -> Vec<Vector> {
        turns.sort_by(f64::total_cmp);
        let corners: Vec<_> = turns.iter().map(|turn| (TAU * turn).sin_cos()).collect();
        let mut left = Vec::new();
        for (index, &(x, z)) in corners.iter().enumerate() {
            let (next_x, next_z) = corners[(index + 1) % corners.len()];
            if x <= cut {
                left.push(Vector::new(x, 0.0, z));
            }
            if (x <= cut) != (next_x <= cut) {
                left.push(Vector::new(cut, 0.0, z + (next_z - z) * (cut - x) / (next_x - x)));
            }
        }
        left
    }

    /// How far a place is inside of the convex hull of points in the plane y = 0.
    fn depth(points: &[Vector], place: Vector) -> f64 {
        let directions = (0..360).map(|k| (TAU * f64::from(k) / 360.0).sin_cos());
        let reach = |(x, z): (f64, f64)| {
            points.iter().map(|point| (*point - place).dot(Vector::new(x, 0.0, z))).fold(f64::NEG_INFINITY, f64::max)
        };
        directions.map(reach).fold(f64::INFINITY, f64::min)
    }

    /// The same of any four of the points with an area, at best.
    fn depth_of_four(points: &[Vector], place: Vector, least_area: f64) -> f64 {
        let mut best = f64::NEG_INFINITY;
        let fours = (0..points.len()).flat_map(|a| (0..a).flat_map(move |b| (0..b).map(move |c| [a, b, c])));
        for [a, b, c] in fours {
            for four in (0..c).map(|d| [a, b, c, d].map(|index| points[index])) {
                if width(four, UP) >= least_area {
                    best = best.max(depth(&four, place));
                }
            }
        }
        best
    }

    const UP: Vector = Vector { x: 0.0, y: 1.0, z: 0.0 };

    fn chosen(points: &[Vector], separations: &[f64], middles: &[Vector]) -> Vec<Vector> {
        let candidates: Vec<_> = (0..)
            .zip(points.iter().zip(separations))
            .map(|(feature, (position, separation))| ContactPoint {
                position: *position,
                separation: *separation,
                feature,
            })
            .collect();
        let few = reduce(&candidates, Cut::Second, UP, 0.02, middles);
        few.iter().map(|point| point.position).collect()
    }

    /// Compared with every choice of four that keeps the area; where two points have to change at
    /// once it may not be found.
    #[test]
    fn a_middle_is_held_as_well_as_four_points_can() {
        // A linear congruential generator: its upper bits.
        let mut state = 1_u32;
        let mut number = |low: f64, high: f64| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            low + (high - low) * f64::from(state) / f64::from(u32::MAX)
        };
        let (mut compared, mut missed) = (0, 0);
        while compared < 4000 {
            let cut = number(0.05, 0.6);
            let corners = number(6.0, 13.99) as usize;
            let points = cut_polygon(cut, (0..corners).map(|_| number(0.0, 1.0)).collect());
            let separations: Vec<_> = points.iter().map(|_| number(-2e-4, 2e-4)).collect();
            let Ok(first) = <[Vector; 4]>::try_from(chosen(&points, &separations, &[])) else { continue };
            let middle = Vector::zero();
            // Rounding of an area decides nothing here.
            let best = depth_of_four(&points, middle, (MIN_AREA + 1e-6) * width(first, UP));
            if best < 0.01 {
                continue;
            }
            compared += 1;
            let held = depth(&chosen(&points, &separations, &[middle]), middle);
            missed += u32::from(held < best.min(0.08) - 6e-3);
        }
        assert_eq!(missed, 0, "of {compared}");
    }
}
