//! What of a shape lies over a triangle: the box around it, and pieces of few corners.

use crate::aabb::Aabb;
use crate::feature::Feature;
use crate::minkowski::Difference;
use crate::support_map::{Convex, Vector};

/// The most points that a triangle has in common with a piece of four corners, and one more.
pub(crate) const SMALL: usize = 8;
/// With a segment, and one more.
pub(crate) const FEWEST: usize = 3;

/// The box along the axes around a shape with a layer.
pub(crate) fn around(shape: &Difference<'_>, layer: f64) -> Aabb<f64> {
    let (middle, axes) = (shape.position, &shape.axes);
    let abs = |v: Vector| Vector::new(v.x.abs(), v.y.abs(), v.z.abs());
    let half = match shape.second {
        Convex::Point => Vector::zero(),
        Convex::Segment { half_height } => abs(axes[1]) * half_height,
        Convex::Cuboid { half } => abs(axes[0]) * half.x + abs(axes[1]) * half.y + abs(axes[2]) * half.z,
        _ => {
            let (x, y, z) = (Vector::new(1.0, 0.0, 0.0), Vector::new(0.0, 1.0, 0.0), Vector::new(0.0, 0.0, 1.0));
            let far = |axis: Vector| axis.dot(shape.second_support(axis));
            let high = Vector::new(far(x), far(y), far(z)) + Vector::splat(layer);
            let low = Vector::new(-far(x * -1.0), -far(y * -1.0), -far(z * -1.0)) - Vector::splat(layer);
            return Aabb { low, high };
        }
    };
    Aabb::about(middle, half + Vector::splat(layer))
}

/// The piece of a point, a segment or a box that lies furthest in a direction.
pub(crate) fn small_piece(shape: &Convex<'_>, direction: Vector) -> Option<Feature<f64, 4>> {
    match *shape {
        Convex::Point => Some(Feature::point(Vector::zero())),
        Convex::Segment { half_height } => Some(axis(half_height)),
        Convex::Cuboid { half } => Some(Feature::of_cuboid(half, direction)),
        _ => None,
    }
}

/// A segment as a piece.
pub(crate) fn axis<const N: usize>(half_height: f64) -> Feature<f64, N> {
    let end = Vector::new(0.0, half_height, 0.0);
    Feature::segment(end * -1.0, end)
}

/// The face of a triangle with a unit normal, as it looks in a direction.
pub(crate) fn face([a, b, c]: &[Vector; 3], normal: Vector, direction: Vector) -> Feature<f64, 3> {
    if normal.dot(direction) >= 0.0 {
        Feature::new([(*a, 0), (*b, 1), (*c, 2)], normal)
    } else {
        Feature::new([(*c, 2), (*b, 1), (*a, 0)], normal * -1.0)
    }
}
