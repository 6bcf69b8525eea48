//! Convex shapes as what they reach in each direction.

use tumble_math::lane::Vec3;

use crate::collider_shape::ColliderShape;
use crate::convex_hull::ConvexHull;
use crate::feature::{Feature, Near};
use crate::frustum::Frustum;
use crate::query::point::out_of_tapered;
use crate::scalar::Scalar;

/// Shapes in general meet in double precision, whatever the precision of the caller: so no length
/// needs a tolerance of its own.
pub(crate) type Vector = Vec3<f64>;

/// A convex shape in its own frame, but for the layer of even thickness that a ball and a capsule
/// have around it.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Convex<'a> {
    Point,
    /// Along y.
    Segment {
        half_height: f64,
    },
    Cuboid {
        half: Vector,
    },
    Frustum(Frustum),
    Ellipsoid {
        radii: Vector,
    },
    /// What is between a ball at `-half_height` and one at `+half_height` on y.
    Tapered {
        radii: [f64; 2],
        half_height: f64,
    },
    Hull(&'a ConvexHull),
    /// A hull that is smaller by these factors along its axes, about its middle.
    SmallerHull(&'a ConvexHull, Vector),
    Triangle([Vector; 3]),
}

impl<'a> Convex<'a> {
    /// What is inside the layer, and how thick that is; `None` for what is not convex or has no
    /// end.
    pub(crate) fn of<R: Scalar>(shape: &'a ColliderShape<R>) -> Option<(Self, f64)> {
        let inner = match *shape {
            ColliderShape::Sphere { radius } => return Some((Self::Point, radius.into())),
            ColliderShape::Capsule { radius, half_height } => {
                return Some((Self::Segment { half_height: half_height.into() }, radius.into()));
            }
            ColliderShape::Cuboid { half_extents } => Self::Cuboid { half: wide(half_extents) },
            ColliderShape::Cylinder { radius, half_height } => {
                Self::Frustum(Frustum { radii: [radius.into(); 2], half_height: half_height.into() })
            }
            ColliderShape::Cone { radius, half_height } => {
                Self::Frustum(Frustum { radii: [radius.into(), 0.0], half_height: half_height.into() })
            }
            ColliderShape::Frustum { radius_bottom, radius_top, half_height } => Self::Frustum(Frustum {
                radii: [radius_bottom.into(), radius_top.into()],
                half_height: half_height.into(),
            }),
            ColliderShape::Ellipsoid { radii } => Self::Ellipsoid { radii: wide(radii) },
            ColliderShape::TaperedCapsule { radius_bottom, radius_top, half_height } => {
                Self::Tapered { radii: [radius_bottom.into(), radius_top.into()], half_height: half_height.into() }
            }
            ColliderShape::Hull(ref hull) => Self::Hull(hull),
            _ => return None,
        };
        Some((inner, 0.0))
    }

    /// The point furthest in a direction, which may have any length but zero.
    pub(crate) fn support(&self, d: Vector) -> Vector {
        match *self {
            Self::Point => Vector::zero(),
            Self::Segment { half_height } => Vector::new(0.0, with_sign(half_height, d.y), 0.0),
            Self::Cuboid { half } => {
                Vector::new(with_sign(half.x, d.x), with_sign(half.y, d.y), with_sign(half.z, d.z))
            }
            Self::Frustum(frustum) => frustum.support(d),
            Self::Ellipsoid { radii } => {
                let scaled = radii.scale(d);
                let length = scaled.dot(scaled).sqrt();
                if length > 0.0 { radii.scale(scaled) * (1.0 / length) } else { Vector::zero() }
            }
            Self::Tapered { radii, half_height } => {
                let [below, above] = tapered_ends(radii, half_height, unit(d));
                if above.dot(d) >= below.dot(d) { above } else { below }
            }
            Self::Hull(hull) => hull.support(d),
            Self::SmallerHull(hull, scale) => {
                hull.middle() + (hull.support(d.scale(scale)) - hull.middle()).scale(scale)
            }
            Self::Triangle(corners) => {
                let [a, b, c] = corners;
                let best = if b.dot(d) > a.dot(d) { b } else { a };
                if c.dot(d) > best.dot(d) { c } else { best }
            }
        }
    }

    /// The piece of the surface that holds the point furthest in the direction of a unit vector; of
    /// faces not further out of the way than is near.
    pub(crate) fn feature(&self, d: Vector, near: Near) -> Feature<f64> {
        match *self {
            Self::Point => Feature::point(Vector::zero()),
            Self::Segment { half_height } => {
                Feature::segment(Vector::new(0.0, -half_height, 0.0), Vector::new(0.0, half_height, 0.0))
            }
            Self::Cuboid { half } => Feature::of_cuboid(half, d),
            Self::Frustum(frustum) => frustum.feature(d, near),
            Self::Ellipsoid { .. } | Self::SmallerHull(..) => Feature::point(self.support(d)),
            Self::Tapered { radii, half_height } => {
                let [below, above] = tapered_ends(radii, half_height, d);
                Feature::segment(below, above)
            }
            Self::Hull(hull) => hull.feature(d, near.pressed),
            Self::Triangle([a, b, c]) => {
                let normal = unit((b - a).cross(c - a));
                if normal.dot(d) >= 0.0 {
                    Feature::new([(a, 0), (b, 1), (c, 2)], normal)
                } else {
                    Feature::new([(c, 2), (b, 1), (a, 0)], normal * -1.0)
                }
            }
        }
    }

    /// The normal of the flat face that looks most in a direction, where there is one.
    pub(crate) fn face_normal(&self, d: Vector) -> Option<Vector> {
        match *self {
            Self::Cuboid { half } => Some(Feature::<f64, 4>::of_cuboid(half, d).normal),
            Self::Frustum(frustum) => frustum.cap_normal(d),
            Self::Hull(hull) => Some(hull.face_normal(d)),
            Self::Triangle([a, b, c]) => {
                let normal = unit((b - a).cross(c - a));
                Some(if normal.dot(d) >= 0.0 { normal } else { normal * -1.0 })
            }
            Self::Point
            | Self::Segment { .. }
            | Self::Ellipsoid { .. }
            | Self::Tapered { .. }
            | Self::SmallerHull(..) => None,
        }
    }

    /// Whether it has flat faces and nothing else.
    pub(crate) fn is_faceted(&self) -> bool {
        matches!(self, Self::Cuboid { .. } | Self::Hull(_) | Self::Triangle(_))
    }

    /// Whether it is round somewhere, without its layer.
    pub(crate) fn has_round_core(&self) -> bool {
        matches!(self, Self::Frustum(_) | Self::Ellipsoid { .. } | Self::Tapered { .. })
    }

    /// Whether it stays where it is when it turns about its y axis.
    pub(crate) fn is_axially_symmetric(&self) -> bool {
        match self {
            Self::Point | Self::Segment { .. } | Self::Frustum(_) | Self::Tapered { .. } => true,
            Self::Ellipsoid { radii } => radii.x == radii.z,
            Self::Cuboid { .. } | Self::Hull(_) | Self::SmallerHull(..) | Self::Triangle(_) => false,
        }
    }

    /// Whether a point is inside or on the surface; of what has no volume none is.
    pub(crate) fn contains(&self, point: Vector) -> bool {
        let across = (point.x * point.x + point.z * point.z).sqrt();
        match *self {
            Self::Cuboid { half } => point.x.abs() <= half.x && point.y.abs() <= half.y && point.z.abs() <= half.z,
            Self::Frustum(Frustum { radii: [below, above], half_height }) => {
                let share = 0.5 + 0.5 * point.y / half_height;
                point.y.abs() <= half_height && across <= below + (above - below) * share
            }
            Self::Ellipsoid { radii } => {
                let scaled = Vector::new(point.x / radii.x, point.y / radii.y, point.z / radii.z);
                scaled.dot(scaled) <= 1.0
            }
            Self::Tapered { radii, half_height } => out_of_tapered(radii, half_height, [across, point.y]) <= 0.0,
            Self::Hull(hull) => hull.planes().all(|(normal, corner)| normal.dot(point - corner) <= 0.0),
            Self::Point | Self::Segment { .. } | Self::SmallerHull(..) | Self::Triangle(_) => false,
        }
    }

    /// A point inside, far from the surface.
    pub(crate) fn middle(&self) -> Vector {
        match *self {
            Self::Hull(hull) | Self::SmallerHull(hull, _) => hull.middle(),
            Self::Triangle([a, b, c]) => (a + b + c) * (1.0 / 3.0),
            _ => Vector::zero(),
        }
    }
}

/// The points of both balls of a tapered capsule that are furthest along a unit vector.
fn tapered_ends(radii: [f64; 2], half_height: f64, d: Vector) -> [Vector; 2] {
    let up = Vector::new(0.0, half_height, 0.0);
    [d * radii[0] - up, d * radii[1] + up]
}

/// The same in double precision.
pub(crate) fn wide<R: Scalar>(v: Vec3<R>) -> Vector {
    Vector::new(v.x.into(), v.y.into(), v.z.into())
}

/// The same in the caller's precision.
pub(crate) fn narrow<R: Scalar>(v: Vector) -> Vec3<R> {
    Vec3::new(R::splat(v.x), R::splat(v.y), R::splat(v.z))
}

/// Of length one; as it is where it has no direction.
pub(crate) fn unit(v: Vector) -> Vector {
    let length = v.dot(v).sqrt();
    if length > 0.0 { v * (1.0 / length) } else { v }
}

fn with_sign(value: f64, of: f64) -> f64 {
    if of < 0.0 { -value } else { value }
}
