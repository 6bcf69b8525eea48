//! Rays and what they meet, as lines.

use crate::debug_draw::{DebugDraw, DebugView, Pen};
use crate::math::{Real, dvec3};
use crate::queries::hits::RayHit;
use crate::queries::ray::Ray;

/// An endless ray that meets nothing is drawn this long \[m\].
const LONGEST: Real = 1000.0;
/// The arrow of the normal, as a part of the way to the hit; and its longest \[m\].
const NORMAL: [Real; 2] = [0.1, 1.0];

impl DebugView {
    /// Draws a ray up to what it meets, and the normal there as an arrow; or all of it, at most a
    /// thousand metres, in another colour.
    ///
    /// ```
    /// use tumble::{DebugView, Queries, QueryFilter, Ray, prelude::*};
    ///
    /// let mut world = hecs::World::new();
    /// spawn_ground(&mut world);
    /// let ray = Ray::new(Vec3::Y * 2.0, -Vec3::Y);
    /// let hit = Queries::of(&world).cast_ray(&ray, &QueryFilter::new());
    ///
    /// let mut lines = Vec::new();
    /// DebugView::draw_ray(&ray, hit.as_ref(), &mut |from, to, color| {
    ///     lines.push((from, to, color))
    /// });
    /// assert_eq!(lines[0], (Vec3::Y * 2.0, Vec3::ZERO, DebugView::RAY[0]));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn draw_ray(ray: &Ray, hit: Option<&RayHit>, target: &mut dyn DebugDraw) {
        let mut pen = Pen { target };
        let [meets, misses] = Self::RAY;
        match hit {
            Some(hit) => {
                pen.line(dvec3(ray.origin), dvec3(hit.point), meets);
                pen.arrow(hit.point, hit.normal * (NORMAL[0] * hit.distance).min(NORMAL[1]), meets);
            }
            None => pen.line(dvec3(ray.origin), dvec3(ray.at(ray.max_distance.min(LONGEST))), misses),
        }
    }
}
