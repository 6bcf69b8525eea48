//! Points against one shape: whether they are inside, and which of its points is nearest.

use tumble_math::lane::Lane;

use crate::collider_shape::{ColliderShape, Isometry};
use crate::convex_pair::{difference, wide_placement};
use crate::gjk::{Nearest, nearest, on_segment, on_triangle};
use crate::scalar::Scalar;
use crate::support_map::{Convex, Vector, unit};
use crate::surface::Surface;

/// The point of a shape that is nearest to another.
///
/// ```
/// use tumble_collide::{ColliderShape, Isometry};
/// use tumble_math::lane::Vec3;
///
/// let cube = ColliderShape::Cuboid { half_extents: Vec3::splat(0.5_f32) };
/// let at = Isometry::at(Vec3::zero());
/// let found = cube.nearest_point(&at, Vec3::new(2.5, 0.25, 0.0), 10.0).unwrap();
/// assert_eq!((found.distance, found.point), (2.0, Vec3::new(0.5, 0.25, 0.0)));
/// assert!(cube.nearest_point(&at, Vec3::new(2.5, 0.25, 0.0), 1.0).is_none());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearestPoint {
    /// How far apart they are \[m\]; zero inside of what is solid.
    pub distance: f64,
    /// World frame \[m\]; the other point itself where that is inside.
    pub point: Vector,
    /// Of a compound, the place of the part in its list; otherwise zero.
    pub part: u32,
    /// Of a mesh or a height field, the number of the triangle; otherwise zero.
    pub triangle: u32,
}

impl<R: Scalar> ColliderShape<R> {
    /// Whether a point \[m\] is inside or on the surface. Meshes and height fields, which are
    /// surfaces, have no inside.
    ///
    /// ```
    /// use tumble_collide::{ColliderShape, Isometry};
    /// use tumble_math::lane::Vec3;
    ///
    /// let can = ColliderShape::Cylinder { radius: 0.5_f32, half_height: 1.0 };
    /// let at = Isometry::at(Vec3::zero());
    /// assert!(
    ///     can.contains(&at, Vec3::new(0.3, 0.9, 0.3))
    ///         && !can.contains(&at, Vec3::new(0.4, 0.9, 0.4))
    /// );
    /// ```
    #[must_use]
    pub fn contains(&self, at: &Isometry<f64>, point: Vector) -> bool {
        let local = at.to_local(point);
        match *self {
            Self::Sphere { radius } => local.dot(local).sqrt() <= radius.into(),
            Self::Capsule { radius, half_height } => {
                let half: f64 = half_height.into();
                let out = (Lane::abs(local.y) - half).max(0.0);
                (local.x * local.x + local.z * local.z + out * out).sqrt() <= radius.into()
            }
            Self::HalfSpace => local.y <= 0.0,
            Self::Compound(ref compound) => {
                compound.parts().iter().any(|(inner, part)| part.contains(&at.then(&wide_placement(inner)), point))
            }
            _ => Convex::of(self).is_some_and(|(inner, _)| inner.contains(local)),
        }
    }

    /// The point of the shape that is nearest to another \[m\], if it is not further away than
    /// `most` \[m\].
    ///
    /// Of what is at the same distance it is the first part, and the first triangle.
    #[must_use]
    pub fn nearest_point(&self, at: &Isometry<f64>, point: Vector, most: f64) -> Option<NearestPoint> {
        let found = |distance: f64, point: Vector| NearestPoint { distance, point, part: 0, triangle: 0 };
        match self {
            Self::Compound(compound) => {
                let mut first: Option<NearestPoint> = None;
                for (part, (inner, shape)) in (0..).zip(compound.parts()) {
                    let most = first.map_or(most, |first| first.distance);
                    let next = shape.nearest_point(&at.then(&wide_placement(inner)), point, most);
                    if let Some(next) = next.filter(|next| first.is_none_or(|first| next.distance < first.distance)) {
                        first = Some(NearestPoint { part, ..next });
                    }
                }
                first
            }
            Self::Mesh(mesh) => on_surface(mesh.as_ref(), at, point, most),
            Self::HeightField(field) => on_surface(field.as_ref(), at, point, most),
            _ if self.contains(at, point) => (most >= 0.0).then(|| found(0.0, point)),
            Self::HalfSpace => {
                let local = at.to_local(point);
                let foot = Vector::new(local.x, 0.0, local.z);
                (local.y <= most).then(|| found(local.y, at.to_world(foot)))
            }
            _ => {
                let (convex, layer) = Convex::of(self)?;
                let shapes = difference(convex, at, Convex::Point, &Isometry { position: point, ..*at })?;
                // Further than it has to be, so that what is just as far is found by any limit.
                let limit = (most + layer) * (1.0 + 1e-9);
                let (distance, on_first) = match nearest(&shapes, limit) {
                    Nearest::Apart { between, on_first } => {
                        let length = between.dot(between).sqrt();
                        ((length - layer).max(0.0), on_first + unit(between) * layer.min(length))
                    }
                    Nearest::Overlap(_) => (0.0, at.to_local(point)),
                    Nearest::Far => return None,
                };
                (distance <= most).then(|| found(distance, at.to_world(on_first)))
            }
        }
    }
}

/// How far out of a tapered capsule a point is, by its distance from the axis and its height \[m\];
/// negative inside, where it may be less than the true one.
pub(crate) fn out_of_tapered([below, above]: [f64; 2], half_height: f64, [across, y]: [f64; 2]) -> f64 {
    let ball = |radius: f64, center: f64| (across * across + (y - center) * (y - center)).sqrt() - radius;
    let balls = ball(below, -half_height).min(ball(above, half_height));
    let sine = (below - above) / (2.0 * half_height);
    if sine.is_nan() || sine.abs() >= 1.0 {
        return balls;
    }
    let cosine = (1.0 - sine * sine).sqrt();
    // Along the side and away from it, from the centre of the lower ball.
    let (along, away) = ((y + half_height) * cosine - across * sine, across * cosine + (y + half_height) * sine);
    let is_beside = along >= 0.0 && along <= 2.0 * half_height * cosine;
    if is_beside { balls.min(away - below) } else { balls }
}

/// The point of a triangle that is nearest to the origin. Its sides are asked as well: rounding
/// moves what is in a triangle that is little more than a line.
pub(crate) fn nearest_of_triangle(corners: [Vector; 3]) -> Vector {
    let of_sides = [0, 1, 2].map(|side: usize| {
        let [from, to] = [corners[side], corners[(side + 1) % 3]];
        let [first, second] = on_segment(from, to);
        from * first + to * second
    });
    let weighted = corners.into_iter().zip(on_triangle(corners));
    let within = weighted.fold(Vector::zero(), |sum, (corner, weight)| sum + corner * weight);
    of_sides.into_iter().fold(within, |best, it| if it.dot(it) < best.dot(best) { it } else { best })
}

fn on_surface(surface: &impl Surface, at: &Isometry<f64>, point: Vector, most: f64) -> Option<NearestPoint> {
    let local = at.to_local(point);
    let mut first: Option<NearestPoint> = None;
    let mut least = most;
    surface.around(local, most, &mut |triangle| {
        let corners = surface.triangle(triangle).map(|corner| corner - local);
        let between = nearest_of_triangle(corners);
        let distance = between.dot(between).sqrt();
        let is_first = first.is_none_or(|first| (distance, triangle) < (first.distance, first.triangle));
        if distance <= least && is_first {
            least = distance;
            first = Some(NearestPoint { distance, point: at.to_world(local + between), part: 0, triangle });
        }
        least
    });
    first
}
