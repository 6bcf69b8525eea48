//! Where a line is inside a convex shape.

use tumble_math::lane::Lane;

use crate::collider_shape::ColliderShape;
use crate::convex_hull::ConvexHull;
use crate::query::round_line::{in_capsule, in_ellipsoid, in_frustum, in_sphere, in_tapered_capsule};
use crate::scalar::Scalar;
use crate::support_map::{Vector, wide};

/// A line: a point and a unit vector.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    pub(crate) point: Vector,
    pub(crate) along: Vector,
}

/// The part of a line that is inside a convex shape, by distance from the line's point \[m\].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Span {
    pub(crate) from: f64,
    pub(crate) to: f64,
    /// Outward where it enters; a unit vector.
    pub(crate) normal: Vector,
}

impl Line {
    pub(crate) fn at(&self, distance: f64) -> Vector {
        self.point + self.along * distance
    }

    /// The same line from the point that is nearest to the origin, and how far along that is: from
    /// there on differences of squares keep their digits.
    pub(crate) fn seen_from_nearest(&self) -> (Self, f64) {
        let to_nearest = -self.point.dot(self.along);
        (Self { point: self.at(to_nearest), along: self.along }, to_nearest)
    }
}

impl Span {
    /// The same by distance from a point that is this far before the line's.
    pub(crate) fn shifted(self, by: f64) -> Self {
        Self { from: self.from + by, to: self.to + by, ..self }
    }

    /// What is in both, if there is any.
    pub(crate) fn and(self, other: Self) -> Option<Self> {
        let normal = if other.from > self.from { other.normal } else { self.normal };
        let (from, to) = (self.from.max(other.from), self.to.min(other.to));
        (from <= to).then_some(Self { from, to, normal })
    }

    /// From where either begins to where both end, of two that touch.
    pub(crate) fn or(self, other: Self) -> Self {
        let normal = if other.from < self.from { other.normal } else { self.normal };
        Self { from: self.from.min(other.from), to: self.to.max(other.to), normal }
    }
}

/// Where a line is inside a convex shape or a half-space; `None` of other shapes.
pub(crate) fn inside<R: Scalar>(shape: &ColliderShape<R>, line: &Line) -> Option<Span> {
    let (near, offset) = line.seen_from_nearest();
    let span = match *shape {
        ColliderShape::Sphere { radius } => in_sphere(&near, radius.into()),
        ColliderShape::Cuboid { half_extents } => in_cuboid(&near, wide(half_extents)),
        ColliderShape::Capsule { radius, half_height } => in_capsule(&near, radius.into(), half_height.into()),
        ColliderShape::Cylinder { radius, half_height } => in_frustum(&near, [radius.into(); 2], half_height.into()),
        ColliderShape::Cone { radius, half_height } => in_frustum(&near, [radius.into(), 0.0], half_height.into()),
        ColliderShape::Frustum { radius_bottom, radius_top, half_height } => {
            in_frustum(&near, [radius_bottom.into(), radius_top.into()], half_height.into())
        }
        ColliderShape::TaperedCapsule { radius_bottom, radius_top, half_height } => {
            in_tapered_capsule(&near, [radius_bottom.into(), radius_top.into()], half_height.into())
        }
        ColliderShape::Ellipsoid { radii } => in_ellipsoid(&near, wide(radii)),
        ColliderShape::Hull(ref hull) => in_hull(&near, hull),
        ColliderShape::HalfSpace => in_slab(&near, 1, [f64::NEG_INFINITY, 0.0]),
        ColliderShape::Mesh(_) | ColliderShape::HeightField(_) | ColliderShape::Compound(_) => None,
    };
    span.map(|span| span.shifted(offset))
}

pub(crate) const AXES: [Vector; 3] =
    [Vector { x: 1.0, y: 0.0, z: 0.0 }, Vector { x: 0.0, y: 1.0, z: 0.0 }, Vector { x: 0.0, y: 0.0, z: 1.0 }];

/// Where a coordinate is between two bounds.
pub(crate) fn in_slab(line: &Line, axis: usize, [low, high]: [f64; 2]) -> Option<Span> {
    let (point, along) = (component(line.point, axis), component(line.along, axis));
    if along == 0.0 {
        let all = Span { from: f64::NEG_INFINITY, to: f64::INFINITY, normal: AXES[axis] };
        return (low <= point && point <= high).then_some(all);
    }
    let [first, last] = if along > 0.0 { [low, high] } else { [high, low] };
    let normal = if along > 0.0 { AXES[axis] * -1.0 } else { AXES[axis] };
    Some(Span { from: (first - point) / along, to: (last - point) / along, normal })
}

fn in_cuboid(line: &Line, half: Vector) -> Option<Span> {
    let slab = |axis: usize, half: f64| in_slab(line, axis, [-half, half]);
    slab(0, half.x)?.and(slab(1, half.y)?)?.and(slab(2, half.z)?)
}

fn in_hull(line: &Line, hull: &ConvexHull) -> Option<Span> {
    let mut span = Span { from: f64::NEG_INFINITY, to: f64::INFINITY, normal: Vector::zero() };
    for (normal, corner) in hull.planes() {
        let (rate, height) = (normal.dot(line.along), normal.dot(line.point - corner));
        if rate == 0.0 {
            if height > 0.0 {
                return None;
            }
            continue;
        }
        let distance = -height / rate;
        if rate > 0.0 {
            span.to = Lane::min(span.to, distance);
        } else if distance > span.from {
            (span.from, span.normal) = (distance, normal);
        }
        if span.from > span.to {
            return None;
        }
    }
    Some(span)
}

pub(crate) fn component(v: Vector, axis: usize) -> f64 {
    match axis {
        0 => v.x,
        1 => v.y,
        _ => v.z,
    }
}
