//! Rays, as queries take them.

use crate::math::{Real, Vec3, dvec3};

/// A straight line from a point, as far as it goes.
///
/// The direction may have any length but zero; distances are in metres all the same. A ray with a
/// number that is not finite, or without a direction, meets nothing; the greatest distance may be
/// infinite.
///
/// ```
/// use tumble::{Ray, math::Vec3};
///
/// let ray = Ray::between(Vec3::ZERO, Vec3::new(0.0, 3.0, 4.0));
/// assert_eq!(ray.max_distance, 5.0);
/// assert_eq!(Ray::new(Vec3::Y, Vec3::X * 2.0).at(3.0), Vec3::new(3.0, 1.0, 0.0));
/// ```
#[doc(alias = "raycast")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it begins, world frame \[m\].
    pub origin: Vec3,
    /// Where it goes, world frame.
    pub direction: Vec3,
    /// How far it goes \[m\].
    pub max_distance: Real,
}

impl Ray {
    /// From a point in a direction, without an end.
    #[must_use]
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        Self { origin, direction, max_distance: Real::INFINITY }
    }

    /// From a point to another. Between two points that are the same there is none: it meets
    /// nothing.
    #[must_use]
    pub fn between(from: Vec3, to: Vec3) -> Self {
        Self { origin: from, direction: to - from, max_distance: (to - from).length() }
    }

    /// The same, that goes no further than this \[m\].
    #[must_use]
    pub fn with_max_distance(self, max_distance: Real) -> Self {
        Self { max_distance, ..self }
    }

    /// The point at a distance from its origin \[m\].
    #[must_use]
    pub fn at(&self, distance: Real) -> Vec3 {
        self.origin + self.direction.normalize_or_zero() * distance
    }

    /// In double precision; `None` of what is no ray.
    pub(crate) fn wide(&self) -> Option<tumble_collide::Ray> {
        let (origin, direction) = (dvec3(self.origin), dvec3(self.direction));
        tumble_collide::Ray::new(origin.into(), direction.into(), self.max_distance.into())
    }
}
