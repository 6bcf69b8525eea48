//! How a triangle lies to the centre of a ball, to the axis of a capsule and to a box, in closed
//! form.

use crate::capsule::nearest_of_segments;
use crate::convex_pair::{Approach, approach};
use crate::gjk::on_triangle;
use crate::minkowski::Difference;
use crate::support_map::{Convex, Vector};
use crate::triangle_cuboid::{is_beside_cuboid, of_cuboid};

/// Nearer than this part of the lengths they are computed from two points are one: the direction
/// between them is lost in rounding.
const TOUCHING: f64 = 1e-10;

/// As [`approach`] of a triangle, with the unit normal of its face, and another shape.
pub(crate) fn triangle_approach(shapes: &Difference<'_>, normal: Vector, limit: f64) -> Option<Approach> {
    let Convex::Triangle(corners) = shapes.first else { return approach(shapes, limit) };
    // Near the middle of the other shape coordinates keep their digits.
    let near = corners.map(|corner| corner - shapes.position);
    let found = match shapes.second {
        Convex::Point => of_point(&near, normal),
        Convex::Segment { half_height } if half_height > 0.0 => of_axis(&near, normal, shapes.axes[1] * half_height),
        Convex::Cuboid { half } => return of_cuboid(shapes, &near, normal, half, limit),
        _ => return approach(shapes, limit),
    };
    (found.between < limit).then(|| Approach { on_first: found.on_first + shapes.position, ..found })
}

/// Whether it is soon seen that a triangle and another shape are further apart than `limit`; if
/// not, they may be so still.
pub(crate) fn is_beside(shape: &Difference<'_>, corners: &[Vector; 3], normal: Vector, limit: f64) -> bool {
    let half = match shape.second {
        Convex::Point => Vector::zero(),
        Convex::Segment { half_height } => shape.axes[1] * half_height,
        Convex::Cuboid { half } => return is_beside_cuboid(shape, corners, half, limit),
        _ => return false,
    };
    sides(corners).any(|(from, way)| {
        let out = way.cross(normal);
        let beyond = out.dot(shape.position - from) - out.dot(half).abs();
        beyond > 0.0 && beyond * beyond > limit * limit * way.dot(way)
    })
}

/// The point of a triangle that is nearest to a given one, and whether that is over the face.
fn nearest_to(corners: &[Vector; 3], normal: Vector, point: Vector) -> (Vector, bool) {
    let from = corners.map(|corner| corner - point);
    match on_triangle(from) {
        // The foot on the plane, which the weights give with fewer digits.
        [p, q, r] if p > 0.0 && q > 0.0 && r > 0.0 => (point + normal * normal.dot(from[0]), true),
        [p, q, r] => (corners[0] * p + corners[1] * q + corners[2] * r, false),
    }
}

/// How far a point is from a triangle with a unit normal, or none if it has no area.
pub(crate) fn distance_to(corners: &[Vector; 3], normal: Vector, point: Vector) -> f64 {
    let apart = nearest_to(corners, normal, point).0 - point;
    apart.dot(apart).sqrt()
}

/// Of a point over a face.
fn over_face(corners: &[Vector; 3], normal: Vector, on_first: Vector, point: Vector) -> Approach {
    let height = normal.dot(point - corners[0]);
    let (normal, between) = if height < 0.0 { (normal * -1.0, -height) } else { (normal, height) };
    Approach { normal, between, lead: 0.0, on_first }
}

/// From a point of a triangle to one of a segment that goes as far as `half` from its middle;
/// `None` where both are one.
fn apart(corners: &[Vector; 3], half: Vector, on_first: Vector, point: Vector) -> Option<Approach> {
    let apart = point - on_first;
    let square = apart.dot(apart);
    let square_of = |v: Vector| v.dot(v);
    let size = corners.iter().fold(square_of(half), |size, corner| f64::max(size, square_of(point - *corner)));
    let between = square.sqrt();
    let is_apart = square > TOUCHING * TOUCHING * size;
    is_apart.then(|| Approach { normal: apart * (1.0 / between), between, lead: 0.0, on_first })
}

/// Of the origin.
fn of_point(corners: &[Vector; 3], normal: Vector) -> Approach {
    let (on_first, is_over) = nearest_to(corners, normal, Vector::zero());
    let found = if is_over { None } else { apart(corners, Vector::zero(), on_first, Vector::zero()) };
    found.unwrap_or_else(|| over_face(corners, normal, on_first, Vector::zero()))
}

/// Of a segment about the origin.
fn of_axis(corners: &[Vector; 3], normal: Vector, half: Vector) -> Approach {
    let ends = [half * -1.0, half];
    let heights = ends.map(|end| normal.dot(end - corners[0]));
    let crosses = heights[0] * heights[1] <= 0.0;
    if crosses {
        let through = ends[0] + (ends[1] - ends[0]) * (heights[0] / (heights[0] - heights[1]));
        if sides(corners).all(|(from, way)| normal.dot(way.cross(through - from)) >= 0.0) {
            return through_face(corners, normal, half);
        }
    }
    let lower = usize::from(heights[0].abs() > heights[1].abs());
    let below = (!crosses).then(|| nearest_to(corners, normal, ends[lower]));
    if let Some((on_first, true)) = below {
        // Nothing is nearer than the plane.
        return over_face(corners, normal, on_first, ends[lower]);
    }
    let mut best = (f64::INFINITY, ends[0], ends[0], false);
    let mut take = |on_first: Vector, on_axis: Vector, is_over: bool| {
        let apart = on_axis - on_first;
        let square = apart.dot(apart);
        if square < best.0 {
            best = (square, on_first, on_axis, is_over);
        }
    };
    for (which, end) in ends.into_iter().enumerate() {
        let known = below.filter(|_| which == lower);
        let (on_first, is_over) = known.unwrap_or_else(|| nearest_to(corners, normal, end));
        take(on_first, end, is_over);
    }
    for (from, way) in sides(corners) {
        let (middle, side_half) = (from + way * 0.5, way * 0.5);
        let (t, s) = nearest_of_segments([middle, side_half], [Vector::zero(), half]);
        take(middle + side_half * t, half * s, false);
    }
    let (_, on_first, on_axis, is_over) = best;
    if is_over && !crosses {
        return over_face(corners, normal, on_first, on_axis);
    }
    apart(corners, half, on_first, on_axis).unwrap_or_else(|| through_face(corners, normal, half))
}

/// The shortest way out of a triangle for a segment that goes through it: the set of differences is
/// a prism, with the triangle at both ends.
fn through_face(corners: &[Vector; 3], normal: Vector, half: Vector) -> Approach {
    let height = -normal.dot(corners[0]);
    let reach = normal.dot(half).abs();
    let sign = if height < 0.0 { -1.0 } else { 1.0 };
    let (mut best, mut side) = ((sign * height - reach, normal * sign), None);
    for (number, (from, way)) in sides(corners).enumerate() {
        let across = way.cross(half);
        let out = if across.dot(corners[(number + 2) % 3] - from) > 0.0 { across * -1.0 } else { across };
        let length = out.dot(out).sqrt();
        if length > TOUCHING * (way.dot(way) * half.dot(half)).sqrt() {
            let out = out * (1.0 / length);
            let separation = -out.dot(from);
            if separation > best.0 {
                (best, side) = ((separation, out), Some((from, way)));
            }
        }
    }
    let (between, normal) = best;
    let on_first = match side {
        Some((from, way)) => {
            let (side_middle, side_half) = (from + way * 0.5, way * 0.5);
            let (t, _) = nearest_of_segments([side_middle, side_half], [normal * -between, half]);
            side_middle + side_half * t
        }
        None => {
            let deepest = if normal.dot(half) > 0.0 { half * -1.0 } else { half };
            nearest_to(corners, normal, deepest - normal * between).0
        }
    };
    Approach { normal, between, lead: 0.0, on_first }
}

/// Of each side of a triangle where it begins, and the way to where it ends.
fn sides(corners: &[Vector; 3]) -> impl Iterator<Item = (Vector, Vector)> + '_ {
    (0..3).map(|side| (corners[side], corners[(side + 1) % 3] - corners[side]))
}
