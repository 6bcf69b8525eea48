//! Steps: up, forward, and down onto something that can be stood on.

use tumble::math::{Real, Vec3};

use crate::motion::{Hit, Motion};
use crate::vectors::{flat, unit};

impl Motion<'_> {
    /// Takes a step on the way across the up axis \[m\] if there is one that is low enough. Returns
    /// the part of the way that is left and the normal of where it stands then.
    pub(super) fn step_up(&mut self, way: Vec3) -> Option<(Real, Vec3)> {
        let (up, skin, most) = (self.up(), self.skin(), self.settings.step_height);
        let length = way.length();
        let direction = unit(way)?;
        if most <= 0.0 {
            return None;
        }
        let above = self.cast(self.position, up * (most + 2.0 * skin));
        let lift = above.map_or(most + skin, |hit| self.free_way(&hit, up, most + skin));
        if lift < skin {
            return None;
        }
        let lifted = self.position + up * lift;
        let ahead = self.look(lifted, direction, length);
        let free = ahead.map_or(length, |hit| self.free_way(&hit, direction, length));
        if free < (length * 1e-2).max(skin * 1e-2) {
            return None;
        }
        let over = lifted + direction * free;
        let below = self.cast(over, -up * (lift + 4.0 * skin))?;
        if below.distance <= 0.0 {
            return None;
        }
        let height = (below.point - self.position).dot(up);
        // Where there is no room above the step there is none on it.
        let is_low = height <= most.min(lift) + skin * 0.1;
        if !is_low || !self.can_stand_on(&below) {
            return None;
        }
        let gap = skin / below.normal.dot(up).max(0.5);
        self.position = over - up * (below.distance - gap).max(0.0);
        self.touch(&below);
        let normal = if self.upright.is_walkable(below.normal) { below.normal } else { up };
        Some((1.0 - free / length, normal))
    }

    /// Whether it is ground that can be walked on, or the edge of such ground.
    fn can_stand_on(&self, hit: &Hit) -> bool {
        if self.settings.step_height >= self.settings.radius * (1.0 - self.upright.min_up)
            && self.upright.is_walkable(hit.normal)
        {
            return true;
        }
        self.face_beyond(hit).is_some_and(|face| self.upright.is_walkable(face))
    }

    /// The normal of the face on the other side of the point where it touches something, seen from
    /// above: of an edge that it has come up against, that of the top.
    pub(super) fn face_beyond(&self, hit: &Hit) -> Option<Vec3> {
        let (up, skin) = (self.up(), self.skin());
        let outward = unit(flat(-hit.normal, up)).unwrap_or(Vec3::ZERO);
        let above: Real = 2.0 * skin;
        let face = self.ray(hit.point + outward * (0.5 * skin) + up * above, -up * (2.0 * above))?;
        (face.distance > 0.0).then_some(face.normal)
    }
}
