//! Where a line is inside round shapes. Lines are given from their point nearest to the origin.

use crate::query::line::{Line, Span, in_slab};
use crate::support_map::{Vector, unit};

/// A ball about the origin.
pub(crate) fn in_sphere(line: &Line, radius: f64) -> Option<Span> {
    let square = line.point.dot(line.point);
    let half = (radius - square.sqrt()) * (radius + square.sqrt());
    if half.is_nan() || half < 0.0 {
        return None;
    }
    let half = half.sqrt();
    Some(Span { from: -half, to: half, normal: unit(line.at(-half)) })
}

/// A ball about a point on y.
fn in_sphere_at(line: &Line, radius: f64, y: f64) -> Option<Span> {
    let moved = Line { point: line.point - Vector::new(0.0, y, 0.0), ..*line };
    let (near, offset) = moved.seen_from_nearest();
    in_sphere(&near, radius).map(|span| span.shifted(offset))
}

/// A cylinder along y with a half ball on each end.
pub(crate) fn in_capsule(line: &Line, radius: f64, half_height: f64) -> Option<Span> {
    let balls = [-half_height, half_height].map(|y| in_sphere_at(line, radius, y));
    let side = in_frustum(line, [radius; 2], half_height);
    union([balls[0], balls[1], side])
}

/// All between a ball at `-half_height` and one at `half_height` on y.
pub(crate) fn in_tapered_capsule(line: &Line, radii: [f64; 2], half_height: f64) -> Option<Span> {
    let [below, above] = radii;
    let balls = [(below, -half_height), (above, half_height)].map(|(radius, y)| in_sphere_at(line, radius, y));
    // The sine of the angle of the side: the balls touch it along circles.
    let sine = (below - above) / (2.0 * half_height);
    if sine.is_nan() || sine.abs() >= 1.0 {
        // One ball is inside the other.
        return balls[usize::from(above > below)];
    }
    let cosine = (1.0 - sine * sine).sqrt();
    let [low, high] = [-half_height + below * sine, half_height + above * sine];
    let middle = 0.5 * (low + high);
    let moved = Line { point: line.point - Vector::new(0.0, middle, 0.0), ..*line };
    let side = in_frustum(&moved, [below * cosine, above * cosine], 0.5 * (high - low));
    union([balls[0], balls[1], side])
}

fn union(spans: [Option<Span>; 3]) -> Option<Span> {
    spans.into_iter().flatten().reduce(Span::or)
}

/// A cylinder, a cone or what is between them, along y.
pub(crate) fn in_frustum(line: &Line, [below, above]: [f64; 2], half_height: f64) -> Option<Span> {
    let slab = in_slab(line, 1, [-half_height, half_height])?;
    let slope = (above - below) / (2.0 * half_height);
    let middle = 0.5 * (above + below);
    slab.and(in_cone(line, middle, slope)?)
}

/// All whose distance from y is at most `middle + slope y`.
fn in_cone(line: &Line, middle: f64, slope: f64) -> Option<Span> {
    let (p, d) = (line.point, line.along);
    let reach = middle + slope * p.y;
    // a t^2 + 2 b t + c <= 0.
    let a = d.x * d.x + d.z * d.z - slope * slope * d.y * d.y;
    let b = p.x * d.x + p.z * d.z - slope * d.y * reach;
    let across = (p.x * p.x + p.z * p.z).sqrt();
    let c = (across - reach) * (across + reach);
    let outward = |t: f64| {
        let at = line.at(t);
        let around = (at.x * at.x + at.z * at.z).sqrt();
        // At its tip a cone looks along y.
        let out = if around > 0.0 { Vector::new(at.x / around, 0.0, at.z / around) } else { Vector::zero() };
        unit(out - Vector::new(0.0, if around > 0.0 { slope } else { slope.signum() }, 0.0))
    };
    let (all, none) = (f64::INFINITY, f64::NEG_INFINITY);
    if a == 0.0 {
        // Along the side, or along the axis of a cylinder.
        if b == 0.0 {
            return (c <= 0.0 && reach >= 0.0).then_some(Span { from: none, to: all, normal: Vector::zero() });
        }
        let t = -c / (2.0 * b);
        let span = if b > 0.0 { [none, t] } else { [t, all] };
        return Some(Span { from: span[0], to: span[1], normal: outward(t) });
    }
    let square = b * b - a * c;
    if a > 0.0 {
        if square.is_nan() || square < 0.0 {
            return None;
        }
        let [first, second] = roots(a, b, c, square.sqrt());
        let tip = slope * d.y;
        // Both on the other side of the tip are on the cone's mirror image.
        if middle + slope * (p.y + d.y * 0.5 * (first + second)) < 0.0 && tip != 0.0 {
            return None;
        }
        return Some(Span { from: first, to: second, normal: outward(first) });
    }
    // Steeper than the side: inside from one root on, and in the mirror image up to the other.
    let [first, second] = roots(a, b, c, square.max(0.0).sqrt());
    if slope * d.y > 0.0 {
        Some(Span { from: second, to: all, normal: outward(second) })
    } else {
        Some(Span { from: none, to: first, normal: Vector::zero() })
    }
}

/// The lower and the higher root of `a t^2 + 2 b t + c`, without differences of what is nearly
/// equal.
fn roots(a: f64, b: f64, c: f64, root: f64) -> [f64; 2] {
    let q = -(b + if b < 0.0 { -root } else { root });
    let (one, other) = (q / a, if q == 0.0 { 0.0 } else { c / q });
    [one.min(other), one.max(other)]
}

/// An ellipsoid about the origin: the unit ball of stretched space.
pub(crate) fn in_ellipsoid(line: &Line, radii: Vector) -> Option<Span> {
    let inverse = Vector::new(1.0 / radii.x, 1.0 / radii.y, 1.0 / radii.z);
    let (point, along) = (line.point.scale(inverse), line.along.scale(inverse));
    let stretch = along.dot(along).sqrt();
    let stretched = Line { point, along: along * (1.0 / stretch) };
    let (near, offset) = stretched.seen_from_nearest();
    let span = in_sphere(&near, 1.0)?.shifted(offset);
    let normal = unit(span.normal.scale(inverse));
    Some(Span { from: span.from / stretch, to: span.to / stretch, normal })
}
