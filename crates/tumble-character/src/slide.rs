//! Vectors that are to go along planes and not into them.

use tumble::math::{Real, Vec3};

use crate::vectors::{flat, unit};

/// A plane that stops what goes against its normal.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane {
    pub(crate) normal: Vec3,
    /// How fast it moves along its normal \[m/s\].
    pub(crate) speed: Real,
}

/// What is up, and from which inclination of a normal on ground is steep.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Upright {
    pub(crate) up: Vec3,
    /// The cosine of the steepest slope.
    pub(crate) min_up: Real,
}

impl Upright {
    pub(crate) fn is_walkable(&self, normal: Vec3) -> bool {
        normal.dot(self.up) >= self.min_up - 1e-4
    }

    /// Ground that is too steep, no wall and no ceiling.
    pub(crate) fn is_steep(&self, normal: Vec3) -> bool {
        !self.is_walkable(normal) && normal.dot(self.up) > 0.02
    }

    /// The way across the up axis, as it goes along a plane.
    pub(crate) fn lifted(&self, way: Vec3, normal: Vec3) -> Vec3 {
        let rise = normal.dot(self.up);
        if rise < 0.05 { way } else { way - self.up * (way.dot(normal) / rise) }
    }

    /// A velocity after it has met a plane. No ground turns speed across the up axis into height:
    /// what lands on it walks up, and does not fly up.
    fn along(&self, velocity: Vec3, plane: Plane, speed: Real) -> Vec3 {
        let off = |v: Vec3, n: Vec3, speed: Real| v + n * (speed - v.dot(n)).max(0.0);
        let slid = off(velocity, plane.normal, speed);
        let most = velocity.dot(self.up).max(0.0);
        if plane.normal.dot(self.up) <= 0.02 || slid.dot(self.up) <= most || speed > 0.0 {
            return slid;
        }
        let Some(wall) = unit(flat(plane.normal, self.up)) else { return slid };
        let slid = off(off(velocity, wall, 0.0), plane.normal, speed);
        slid - self.up * (slid.dot(self.up) - most).max(0.0)
    }

    /// A vector that goes into none of the planes: along the last, or along the edge of two, or
    /// none. `with_speed` is whether the planes move.
    pub(crate) fn clipped(&self, vector: Vec3, planes: &[Plane], with_speed: bool) -> Vec3 {
        let speed = |plane: &Plane| if with_speed { plane.speed } else { 0.0 };
        let tolerance = vector.length() * 1e-4 + Real::MIN_POSITIVE;
        let fits = |v: Vec3| planes.iter().all(|plane| v.dot(plane.normal) >= speed(plane) - tolerance);
        if fits(vector) {
            return vector;
        }
        for plane in planes.iter().rev() {
            let slid = self.along(vector, *plane, speed(plane));
            if fits(slid) {
                return slid;
            }
        }
        let most = vector.dot(self.up).max(0.0) + tolerance;
        for (i, first) in planes.iter().enumerate() {
            for second in &planes[..i] {
                let Some(edge) = unit(first.normal.cross(second.normal)) else { continue };
                let along = edge * vector.dot(edge);
                if fits(along) && along.dot(self.up) <= most {
                    return along;
                }
            }
        }
        Vec3::ZERO
    }

    /// A vector across the up axis that goes into none of some walls, which stand upright: along
    /// one of them, or none.
    pub(crate) fn clipped_flat(&self, vector: Vec3, walls: &[Plane], with_speed: bool) -> Vec3 {
        let speed = |wall: &Plane| if with_speed { wall.speed } else { 0.0 };
        let tolerance = vector.length() * 1e-4;
        let fits = |v: Vec3| walls.iter().all(|wall| v.dot(wall.normal) >= speed(wall) - tolerance);
        if fits(vector) {
            return vector;
        }
        let off = |wall: &Plane| vector + wall.normal * (speed(wall) - vector.dot(wall.normal)).max(0.0);
        walls.iter().rev().map(off).find(|slid| fits(*slid)).unwrap_or(Vec3::ZERO)
    }
}
