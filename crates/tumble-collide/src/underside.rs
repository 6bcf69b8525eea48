//! The few of a body's corners that hold it on a plane as all of them would.
//!
//! A body comes to stand on a facet of the lower hull of its corners. Heights are measured over
//! that facet, so that a tilt of the whole body changes nothing, and a corner is worth how far out
//! it is less its height many times over: what lies over a lower corner never takes its place. All
//! lengths are in proportion to the body.

use crate::face_clipping::AS_NEAR;
use crate::manifold::{ContactPoint, MAX_MANIFOLD_POINTS, Points};
use crate::manifold_reduction::pressed;
use crate::support_map::Vector;

/// By how much a later point must be better than an earlier one to be taken in its place: as much
/// as rounding may make of points that are the same.
const LEAD: f64 = 1e-6;
/// A corner must be further out by this multiple of its height over the facet to be worth more than
/// one on it: half a degree.
const WORTH: f64 = 100.0;
/// What is up a steeper slope from a corner is behind it, since no turn by less than 45 degrees
/// makes it touch; no steeper facet is stood on.
const STEEPEST: f64 = 1.0;
/// Points nearer to each other than this part of the extent of all are one, and triangles so narrow
/// are none.
const NARROW: f64 = 1e-6;
/// A corner that turns out to be behind a later one makes room for another, this often at most.
const MAX_TURNS: usize = 2 * MAX_MANIFOLD_POINTS;

/// A corner seen along the normal.
#[derive(Clone, Copy)]
struct Corner {
    index: usize,
    at: [f64; 2],
    /// Along the facet, where a tilt changes no distance.
    on: [f64; 2],
    /// Over the plane.
    height: f64,
    /// Over the facet.
    above: f64,
}

/// Where corners are in the plane, and the facet that is stood on: through the lowest corner, with
/// a slope.
struct Facet {
    up: Vector,
    axes: [Vector; 2],
    /// Along the facet.
    own_axes: [Vector; 2],
    lowest: Corner,
    slope: [f64; 2],
    /// Of what is near, along the facet.
    middle: [f64; 2],
    extent: f64,
}

/// Those that are there come first.
struct Chosen {
    corners: [Option<Corner>; MAX_MANIFOLD_POINTS],
}

/// Up to four of the points near a plane, in their order; their separations are their heights over
/// it.
pub(crate) fn stood_on(
    points: impl Iterator<Item = ContactPoint<f64>> + Clone,
    up: Vector,
    margin: f64,
) -> Points<f64> {
    let mut few = Points::none();
    let Some(facet) = Facet::under(&points, up) else { return few };
    let corners = || points.clone().enumerate().map(|(index, point)| facet.corner(index, &point));
    let mut chosen = Chosen { corners: [None; MAX_MANIFOLD_POINTS] };
    for _ in 0..MAX_TURNS {
        let Some(next) = chosen.next(corners(), &facet) else { break };
        chosen.add(next);
    }
    chosen.keep(facet.lowest, AS_NEAR * f64::min(facet.extent, margin) + pressed(facet.lowest.height, margin));
    for (index, point) in points.enumerate() {
        if chosen.corners.iter().flatten().any(|corner| corner.index == index) {
            few.push(point);
        }
    }
    few
}

impl Facet {
    /// `None` of no points.
    fn under(points: &(impl Iterator<Item = ContactPoint<f64>> + Clone), up: Vector) -> Option<Self> {
        let nowhere = Corner { index: 0, at: [0.0; 2], on: [0.0; 2], height: 0.0, above: 0.0 };
        let (axes, zero) = (axes_across(up), [0.0; 2]);
        let mut this = Self { up, axes, own_axes: axes, lowest: nowhere, slope: zero, middle: zero, extent: 0.0 };
        let corners = || points.clone().enumerate().map(|(index, point)| this.corner(index, &point));
        let mut lowest: Option<Corner> = None;
        for corner in corners() {
            if lowest.is_none_or(|lowest| corner.height < lowest.height) {
                lowest = Some(corner);
            }
        }
        let [low, high] = bounds(corners().map(|corner| corner.at));
        this.lowest = lowest?;
        this.extent = length(minus(high, low));
        this.lean(points, between(low, high));
        this.own_axes = axes_across(crate::support_map::unit(up - axes[0] * this.slope[0] - axes[1] * this.slope[1]));
        let [low, high] = bounds(points.clone().enumerate().map(|(index, point)| this.corner(index, &point).on));
        this.middle = between(low, high);
        Some(this)
    }

    /// Turns the plane about the lowest corner towards the middle until it meets a second, and
    /// about both, to the side where that is less, until it meets a third.
    fn lean(&mut self, points: &(impl Iterator<Item = ContactPoint<f64>> + Clone), middle: [f64; 2]) {
        let towards = minus(middle, self.lowest.at);
        let way = if length(towards) > NARROW * self.extent { unit(towards) } else { [1.0, 0.0] };
        let Some((slope, second)) = self.turned(points.clone(), way) else { return };
        self.slope = slope;
        let along = unit(minus(second.at, self.lowest.at));
        let across = [-along[1], along[0]];
        let sides = [across, minus([0.0; 2], across)].map(|across| self.turned(points.clone(), across));
        let slopes = sides.into_iter().flatten().map(|(slope, _)| slope);
        if let Some(least) = slopes.min_by(|a, b| length(*a).total_cmp(&length(*b))) {
            self.slope = least;
        }
    }

    /// How the plane slopes once it is turned up in one direction as far as the points let it, and
    /// which point does not.
    fn turned(&self, points: impl Iterator<Item = ContactPoint<f64>>, way: [f64; 2]) -> Option<([f64; 2], Corner)> {
        let mut least: Option<(f64, Corner)> = None;
        for (index, point) in points.enumerate() {
            let corner = self.corner(index, &point);
            let run = dot(way, minus(corner.at, self.lowest.at));
            if run > NARROW * self.extent {
                let slope = corner.above / run;
                if least.is_none_or(|(least, _)| slope < least) {
                    least = Some((slope, corner));
                }
            }
        }
        let (slope, corner) = least?;
        let turned = [self.slope[0] + way[0] * slope, self.slope[1] + way[1] * slope];
        (length(turned) <= STEEPEST).then_some((turned, corner))
    }

    fn corner(&self, index: usize, point: &ContactPoint<f64>) -> Corner {
        let at = self.axes.map(|axis| axis.dot(point.position));
        let height = point.separation;
        let on = self.own_axes.map(|axis| axis.dot(point.position + self.up * (0.5 * height)));
        let above = height - self.lowest.height - dot(self.slope, minus(at, self.lowest.at));
        Corner { index, at, on, height, above }
    }
}

impl Corner {
    /// Whether another is too much lower for this one to touch.
    fn is_behind(&self, other: &Self) -> bool {
        let up = f64::max(self.above - other.above, self.height - other.height);
        up > STEEPEST * length(minus(self.at, other.at))
    }
}

impl Chosen {
    /// The best of what is left: the outermost, the one farthest from it, the one that makes the
    /// largest triangle with both, and the one that adds most to that.
    fn next(&self, corners: impl Iterator<Item = Corner>, facet: &Facet) -> Option<Corner> {
        let [.., None] = self.corners else { return None };
        let is_another = |corner: &Corner| {
            let mut chosen = self.corners.iter().flatten();
            chosen.all(|other| {
                let is_apart = length(minus(corner.at, other.at)) > NARROW * facet.extent;
                is_apart && !corner.is_behind(other)
            })
        };
        let mut best: Option<(f64, Corner)> = None;
        for corner in corners.filter(is_another) {
            let Some(score) = self.score(&corner, facet) else { continue };
            if best.is_none_or(|(best, _)| score > best + best.abs() * LEAD) {
                best = Some((score, corner));
            }
        }
        best.map(|(_, corner)| corner)
    }

    /// In the first place that is free, and away with those it is under.
    fn add(&mut self, corner: Corner) {
        let stay = self.corners.into_iter().flatten().filter(|other| !other.is_behind(&corner));
        let mut all = [None; MAX_MANIFOLD_POINTS];
        for (place, corner) in all.iter_mut().zip(stay.chain([corner])) {
            *place = Some(corner);
        }
        self.corners = all;
    }

    fn score(&self, corner: &Corner, facet: &Facet) -> Option<f64> {
        let cost = WORTH * corner.above;
        let [a, b, c] = match self.corners {
            [None, ..] => return Some(length(minus(corner.on, facet.middle)) - cost),
            [Some(a), None, ..] => return Some(length(minus(corner.on, a.on)) - cost),
            [Some(a), Some(b), None, _] => {
                let area = area(a.on, b.on, corner.on).abs();
                let base = length(minus(b.on, a.on));
                return (area > NARROW * facet.extent * base).then_some(area - cost * base);
            }
            [Some(a), Some(b), Some(c), _] => [a.on, b.on, c.on],
        };
        let way = if area(a, b, c) < 0.0 { 1.0 } else { -1.0 };
        let mut best: Option<f64> = None;
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let beyond = way * area(from, to, corner.on);
            let base = length(minus(to, from));
            if beyond > NARROW * facet.extent * base {
                let score = beyond - cost * base;
                best = Some(best.map_or(score, |best| f64::max(best, score)));
            }
        }
        best
    }

    /// Where none is as low as the lowest, that takes the place of one of four without which they
    /// are widest, of fewer of the one closest to it, and of those behind it.
    fn keep(&mut self, lowest: Corner, slack: f64) {
        if self.corners.iter().flatten().any(|corner| corner.height <= lowest.height + slack) {
            return;
        }
        let mut best: Option<(f64, usize)> = None;
        for (index, corner) in self.corners.iter().enumerate() {
            let Some(corner) = corner else { continue };
            let mut places = self.corners.map(|corner| corner.map(|corner| corner.at));
            places[index] = Some(lowest.at);
            let score = match places {
                [Some(a), Some(b), Some(c), Some(d)] => width([a, b, c, d]),
                _ => -length(minus(corner.at, lowest.at)),
            };
            if best.is_none_or(|(best, _)| score > best) {
                best = Some((score, index));
            }
        }
        if let Some((_, index)) = best {
            self.corners[index] = None;
            self.add(lowest);
        }
    }
}

/// Two axes across a direction.
pub(crate) fn axes_across(up: Vector) -> [Vector; 2] {
    let aside = if up.x.abs() < 0.5 { Vector::new(1.0, 0.0, 0.0) } else { Vector::new(0.0, 1.0, 0.0) };
    let first = crate::support_map::unit(up.cross(aside));
    [first, up.cross(first)]
}

/// The least and the greatest coordinates of places.
fn bounds(places: impl Iterator<Item = [f64; 2]>) -> [[f64; 2]; 2] {
    places.fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[low, high], [x, y]| {
        [[low[0].min(x), low[1].min(y)], [high[0].max(x), high[1].max(y)]]
    })
}

fn between([a, b]: [f64; 2], [c, d]: [f64; 2]) -> [f64; 2] {
    [0.5 * (a + c), 0.5 * (b + d)]
}

/// How wide four points are: twice their area where each is a corner.
fn width([a, b, c, d]: [[f64; 2]; MAX_MANIFOLD_POINTS]) -> f64 {
    let across = |[a, b]: [[f64; 2]; 2], [c, d]: [[f64; 2]; 2]| {
        let ([p, q], [r, s]) = (minus(b, a), minus(d, c));
        (p * s - q * r).abs()
    };
    across([a, b], [c, d]).max(across([a, c], [b, d])).max(across([a, d], [b, c]))
}

fn minus([a, b]: [f64; 2], [c, d]: [f64; 2]) -> [f64; 2] {
    [a - c, b - d]
}

fn dot([a, b]: [f64; 2], [c, d]: [f64; 2]) -> f64 {
    a * c + b * d
}

fn length(v: [f64; 2]) -> f64 {
    dot(v, v).sqrt()
}

fn unit(v: [f64; 2]) -> [f64; 2] {
    let length = length(v);
    if length > 0.0 { [v[0] / length, v[1] / length] } else { [1.0, 0.0] }
}

/// Twice the area of a triangle, positive where its corners go around against the clock.
fn area(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    let ([p, q], [r, s]) = (minus(b, a), minus(c, a));
    p * s - q * r
}
