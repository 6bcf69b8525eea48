//! Shapes that are moved along a straight line, without turning, until they meet another.

use crate::collider_shape::{ColliderShape, Isometry};
use crate::convex_pair::{approach, difference, wide_placement};
use crate::gjk::{Nearest, nearest};
use crate::query::line::Line;
use crate::query::overlap::around;
use crate::query::ray::Ray;
use crate::scalar::Scalar;
use crate::support_map::{Convex, Vector, unit};
use crate::surface::Surface;

/// A way is gone in at most this number of advances.
const MAX_ADVANCES: usize = 64;
/// Nearer than this part of what both shapes reach they touch.
const TOUCHING: f64 = 1e-7;

/// Where a shape that is moved along a ray meets another first.
///
/// ```
/// use tumble_collide::{ColliderShape, Isometry, Ray};
/// use tumble_math::lane::Vec3;
///
/// let (sphere, wall) = (ColliderShape::Sphere { radius: 0.5_f32 }, ColliderShape::HalfSpace);
/// let at = |y: f64| Isometry::at(Vec3::new(0.0, y, 0.0));
/// let down = Ray::new(Vec3::new(0.0, 3.0, 0.0), Vec3::new(0.0, -1.0, 0.0), 10.0).unwrap();
/// let hit = wall.cast_shape(&at(0.0), &sphere, &at(3.0), &down).unwrap();
/// assert_eq!((hit.distance, hit.normal), (2.5, Vec3::new(0.0, 1.0, 0.0)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeCastHit {
    /// How far the moved shape goes \[m\]; zero where both overlap from the beginning.
    pub distance: f64,
    /// Where they touch then \[m\], world frame.
    pub point: Vector,
    /// Of the surface that is met, towards the moved shape; unit vector, world frame. Where both
    /// overlap from the beginning, the shortest way out.
    pub normal: Vector,
    /// Of a compound that is met, the place of the part in its list; otherwise zero.
    pub part: u32,
    /// Of a mesh or a height field, the number of the triangle; otherwise zero.
    pub triangle: u32,
}

impl<R: Scalar> ColliderShape<R> {
    /// Where a shape that is at `from` and is moved along a ray without turning meets this one; of
    /// the ray its direction and length count. Surfaces are met from both sides. No surface meets
    /// another, nor a half-space; half-spaces are not moved.
    ///
    /// Of what is met at the same distance it is the first part, and the first triangle.
    #[must_use]
    pub fn cast_shape(
        &self,
        at: &Isometry<f64>,
        moved: &Self,
        from: &Isometry<f64>,
        ray: &Ray,
    ) -> Option<ShapeCastHit> {
        let mut first: Option<ShapeCastHit> = None;
        let mut take = |hit: Option<ShapeCastHit>, part: u32| {
            if let Some(hit) = hit.filter(|hit| first.is_none_or(|first| hit.distance < first.distance)) {
                first = Some(ShapeCastHit { part, ..hit });
            }
        };
        match (self, moved) {
            (Self::Compound(compound), _) => {
                for (part, (inner, shape)) in (0..).zip(compound.parts()) {
                    take(shape.cast_shape(&at.then(&wide_placement(inner)), moved, from, ray), part);
                }
            }
            (_, Self::Compound(compound)) => {
                for (inner, shape) in compound.parts() {
                    take(self.cast_shape(at, shape, &from.then(&wide_placement(inner)), ray), 0);
                }
            }
            (Self::HalfSpace, _) => take(on_half_space(at, moved, from, ray), 0),
            (Self::Mesh(mesh), _) => take(on_surface(mesh.as_ref(), at, (moved, from), ray, false), 0),
            (Self::HeightField(field), _) => take(on_surface(field.as_ref(), at, (moved, from), ray, false), 0),
            (_, Self::Mesh(mesh)) => take(on_surface(mesh.as_ref(), from, (self, at), ray, true), 0),
            (_, Self::HeightField(field)) => take(on_surface(field.as_ref(), from, (self, at), ray, true), 0),
            _ => {
                let pair = Convex::of(self).zip(Convex::of(moved));
                take(pair.and_then(|(still, moved)| meet(still, at, moved, from, ray)), 0);
            }
        }
        first
    }
}

fn on_half_space<R: Scalar>(
    ground: &Isometry<f64>,
    moved: &ColliderShape<R>,
    from: &Isometry<f64>,
    ray: &Ray,
) -> Option<ShapeCastHit> {
    let (convex, layer) = Convex::of(moved)?;
    let up = ground.orientation.rotate(Vector::new(0.0, 1.0, 0.0));
    let height = moved.height_over(from, ground)?;
    let rate = -up.dot(ray.direction());
    let distance = if height <= 0.0 { 0.0 } else { height / rate };
    if !(0.0..=ray.max_distance()).contains(&distance) {
        return None;
    }
    let lowest = from.to_world(convex.support(from.orientation.rotate_back(up * -1.0))) - up * layer;
    let point = lowest + ray.direction() * distance;
    Some(ShapeCastHit { distance, point, normal: up, part: 0, triangle: 0 })
}

/// The first meeting of a convex shape that is moved with one that is not.
///
/// G. van den Bergen, "Ray casting against general convex objects with application to continuous
/// collision detection" (2004): from one distance of both to the next, along the plane between
/// them.
fn meet(
    (still, layer): (Convex<'_>, f64),
    at: &Isometry<f64>,
    (moved, moved_layer): (Convex<'_>, f64),
    from: &Isometry<f64>,
    ray: &Ray,
) -> Option<ShapeCastHit> {
    let layers = layer + moved_layer;
    let mut distance = 0.0;
    let mut normal = None;
    for _ in 0..MAX_ADVANCES {
        let here = Isometry { position: from.position + ray.direction() * distance, ..*from };
        let shapes = difference(still, at, moved, &here)?;
        let Nearest::Apart { between, on_first } = nearest(&shapes, f64::INFINITY) else {
            // They overlap from the beginning, or what is inside their layers touches.
            let found = approach(&shapes, f64::INFINITY)?;
            let normal = normal.unwrap_or_else(|| at.orientation.rotate(found.normal));
            let point = at.to_world(found.on_first) + normal * layer;
            return Some(ShapeCastHit { distance, point, normal, part: 0, triangle: 0 });
        };
        let length = between.dot(between).sqrt();
        let along = at.orientation.rotate(between * (1.0 / length));
        let gap = length - layers;
        let rate = -along.dot(ray.direction());
        let reach = on_first.dot(on_first).sqrt() + length + layers;
        if gap <= TOUCHING * reach {
            if rate <= 0.0 && gap >= -TOUCHING * reach {
                return None;
            }
            let normal = if distance > 0.0 { normal.unwrap_or(along) } else { along };
            let point = at.to_world(on_first) + along * layer;
            return Some(ShapeCastHit { distance, point, normal, part: 0, triangle: 0 });
        }
        distance += gap / rate;
        if rate <= 0.0 || distance > ray.max_distance() {
            return None;
        }
        normal = Some(along);
    }
    None
}

/// Whether a convex shape with a layer that goes along a line up to a distance may get nearer than
/// `slack` \[m\] to a triangle, as seen along its plane.
fn may_reach(
    [a, b, c]: &[Vector; 3],
    (convex, layer): (Convex<'_>, f64),
    place: &Isometry<f64>,
    (line, most): (&Line, f64),
    slack: f64,
) -> bool {
    let normal = unit((*b - *a).cross(*c - *a));
    if normal.dot(normal) == 0.0 {
        return true;
    }
    let height = |way: f64| {
        let furthest = convex.support(place.orientation.rotate_back(normal * way));
        normal.dot(place.to_world(furthest) - *a) + layer * way
    };
    // The other corners of a thin triangle are not in its plane, for rounding.
    let beside = [b, c].map(|corner| normal.dot(*corner - *a));
    let (lowest, highest) = (beside[0].min(beside[1]).min(0.0), beside[0].max(beside[1]).max(0.0));
    let (low, high, rate) = (height(-1.0), height(1.0), normal.dot(line.along) * most);
    let slack = slack + 2.0 * TOUCHING * most;
    low.min(low + rate) <= highest + slack && high.max(high + rate) >= lowest - slack
}

/// The first meeting of a surface and a convex shape, of which one is moved, triangle by triangle.
fn on_surface<R: Scalar>(
    surface: &impl Surface,
    ground: &Isometry<f64>,
    (shape, place): (&ColliderShape<R>, &Isometry<f64>),
    ray: &Ray,
    is_moved: bool,
) -> Option<ShapeCastHit> {
    let convex = Convex::of(shape)?;
    let local = Isometry {
        position: ground.to_local(place.position),
        orientation: ground.orientation.conjugate() * place.orientation,
    };
    let aabb = around(convex, &local);
    let (size, center) = (aabb.high - aabb.low, aabb.center());
    // Seen from a surface that is moved the other shape comes.
    let direction = ray.direction() * if is_moved { -1.0 } else { 1.0 };
    let line = Line { point: center, along: ground.orientation.rotate_back(direction) };
    // What is this near touches.
    let slack = 2.0 * TOUCHING * (size.dot(size).sqrt() + center.dot(center).sqrt());
    let half = size * 0.5 + Vector::splat(slack);
    let mut first: Option<ShapeCastHit> = None;
    surface.along(&line, half, ray.max_distance(), &mut |triangle| {
        let most = first.map_or(ray.max_distance(), |first| first.distance);
        if !may_reach(&surface.triangle(triangle), convex, &local, (&line, most), slack) {
            return most;
        }
        let (shape, ray) = ((Convex::Triangle(surface.triangle(triangle)), 0.0), ray.shortened(most));
        let hit =
            if is_moved { meet(convex, place, shape, ground, &ray) } else { meet(shape, ground, convex, place, &ray) };
        if let Some(hit) = hit
            && first.is_none_or(|first| (hit.distance, triangle) < (first.distance, first.triangle))
        {
            first = Some(ShapeCastHit { triangle, ..hit });
        }
        first.map_or(ray.max_distance(), |first| first.distance)
    });
    first
}
