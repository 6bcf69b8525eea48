//! Rays against one shape.

use crate::collider_shape::{ColliderShape, Isometry};
use crate::convex_pair::wide_placement;
use crate::query::line::{Line, inside};
use crate::query::triangle_line::{TriangleLine, first_triangle};
use crate::scalar::Scalar;
use crate::support_map::{Vector, unit};

/// A straight line from a point, as far as it goes.
///
/// ```
/// use tumble_collide::Ray;
/// use tumble_math::lane::Vec3;
///
/// let ray = Ray::new(Vec3::zero(), Vec3::new(0.0, 3.0, 0.0), 10.0).unwrap();
/// assert_eq!(ray.at(5.0), Vec3::new(0.0, 5.0, 0.0));
/// assert!(Ray::new(Vec3::zero(), Vec3::zero(), 10.0).is_none());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    origin: Vector,
    direction: Vector,
    max_distance: f64,
}

/// Where a ray meets a shape first.
///
/// ```
/// use tumble_collide::{ColliderShape, Isometry, Ray};
/// use tumble_math::lane::Vec3;
///
/// let sphere = ColliderShape::Sphere { radius: 0.5_f32 };
/// let at = Isometry::at(Vec3::new(3.0, 0.0, 0.0));
/// let ray = Ray::new(Vec3::zero(), Vec3::new(1.0, 0.0, 0.0), 10.0).unwrap();
/// let hit = sphere.cast_ray(&at, &ray).unwrap();
/// assert_eq!((hit.distance, hit.normal), (2.5, Vec3::new(-1.0, 0.0, 0.0)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeRayHit {
    /// From the ray's origin \[m\]; zero where that is inside.
    pub distance: f64,
    /// Of the surface, against the ray; unit vector, world frame. Where the origin is inside, the
    /// direction back along the ray.
    pub normal: Vector,
    /// Of a compound, the place of the part in its list; otherwise zero.
    pub part: u32,
    /// Of a mesh or a height field, the number of the triangle; otherwise zero.
    pub triangle: u32,
}

impl Ray {
    /// From a point in a direction of any length; `None` where a number is not finite, the
    /// direction is zero, or it goes less than no distance \[m\], which may be infinite.
    #[must_use]
    pub fn new(origin: Vector, direction: Vector, max_distance: f64) -> Option<Self> {
        // Scaled first: the square of a short or a long one is out of range.
        let most = direction.x.abs().max(direction.y.abs()).max(direction.z.abs());
        let direction = unit(direction * (1.0 / most));
        let is_ray = origin.dot(origin).is_finite() && direction.dot(direction).is_finite() && max_distance >= 0.0;
        is_ray.then_some(Self { origin, direction, max_distance })
    }

    /// Where it begins \[m\].
    #[must_use]
    pub fn origin(&self) -> Vector {
        self.origin
    }

    /// A unit vector.
    #[must_use]
    pub fn direction(&self) -> Vector {
        self.direction
    }

    /// How far it goes \[m\].
    #[must_use]
    pub fn max_distance(&self) -> f64 {
        self.max_distance
    }

    /// The point at a distance \[m\].
    #[must_use]
    pub fn at(&self, distance: f64) -> Vector {
        self.origin + self.direction * distance
    }

    /// The same, but no longer than this \[m\].
    #[must_use]
    pub fn shortened(&self, max_distance: f64) -> Self {
        Self { max_distance: self.max_distance.min(max_distance), ..*self }
    }

    /// In the frame of a shape.
    fn line(&self, at: &Isometry<f64>) -> Line {
        Line { point: at.to_local(self.origin), along: at.orientation.rotate_back(self.direction) }
    }
}

impl<R: Scalar> ColliderShape<R> {
    /// Where a ray meets the shape first. What is solid is met at no distance by a ray that begins
    /// inside; meshes and height fields are surfaces, which are met from both sides.
    ///
    /// Of what is met at the same distance it is the first part, and the first triangle.
    #[must_use]
    pub fn cast_ray(&self, at: &Isometry<f64>, ray: &Ray) -> Option<ShapeRayHit> {
        if let Self::Compound(compound) = self {
            let mut first: Option<ShapeRayHit> = None;
            for (part, (inner, shape)) in (0..).zip(compound.parts()) {
                let most = first.map_or(ray.max_distance, |hit| hit.distance);
                let hit = shape.cast_ray(&at.then(&wide_placement(inner)), &ray.shortened(most));
                if let Some(hit) = hit.filter(|hit| first.is_none_or(|first| hit.distance < first.distance)) {
                    first = Some(ShapeRayHit { part, ..hit });
                }
            }
            return first;
        }
        let line = ray.line(at);
        let on_surface = |met: Option<TriangleLine>| {
            let TriangleLine { distance, normal, triangle } = met?;
            let normal = if normal.dot(line.along) > 0.0 { normal * -1.0 } else { normal };
            Some(ShapeRayHit { distance, normal: at.orientation.rotate(normal), part: 0, triangle })
        };
        match self {
            Self::Mesh(mesh) => on_surface(first_triangle(mesh.as_ref(), &line, ray.max_distance)),
            Self::HeightField(field) => on_surface(first_triangle(field.as_ref(), &line, ray.max_distance)),
            _ => {
                let span = inside(self, &line)?;
                if span.to < 0.0 || span.from > ray.max_distance || span.from.is_nan() {
                    return None;
                }
                let is_outside = span.from > 0.0;
                let normal = if is_outside { at.orientation.rotate(span.normal) } else { ray.direction * -1.0 };
                Some(ShapeRayHit { distance: span.from.max(0.0), normal, part: 0, triangle: 0 })
            }
        }
    }
}
