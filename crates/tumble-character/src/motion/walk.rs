//! A way along the ground: walls turn it aside, slopes and steps lift it.

use tumble::math::Vec3;

use crate::motion::{Hit, MAX_SLIDES, Motion};
use crate::vectors::{flat, unit};

impl Motion<'_> {
    /// Goes a way across the up axis \[m\] along the ground.
    pub(super) fn walk(&mut self, way: Vec3) {
        let mut rest = way;
        let mut normal = self.state.ground_normal;
        let mut walls: Vec<Vec3> = self.held_by.iter().filter_map(|it| unit(flat(it.normal, self.up()))).collect();
        rest = self.upright.clipped_flat(rest, &walls);
        for _ in 0..MAX_SLIDES {
            let lifted = self.upright.lifted(rest, normal);
            let length = lifted.length();
            if length < self.skin() * 1e-3 {
                break;
            }
            let direction = lifted / length;
            let Some(hit) = self.cast(self.position, direction * (length + 2.0 * self.skin())) else {
                self.position += lifted;
                break;
            };
            if self.is_inside(&hit) {
                self.push_out();
                continue;
            }
            let free = self.free_way(&hit, direction, length);
            self.position += direction * free;
            if free >= length {
                break;
            }
            rest *= 1.0 - free / length;
            self.touch(&hit);
            if self.upright.is_walkable(hit.normal) && !self.is_a_high_edge(&hit) {
                (rest, normal) = self.onto_slope(rest, normal, hit.normal);
                continue;
            }
            if let Some((left, landing)) = self.step_up(rest) {
                (rest, normal) = (left, landing);
                continue;
            }
            let Some(wall) = self.wall_of(&hit, normal) else {
                self.stop_at(&hit);
                break;
            };
            walls.push(wall);
            rest = self.upright.clipped_flat(rest, &walls);
            self.lose_speed(&hit, wall, &walls);
        }
        self.state.ground_normal = normal;
    }

    /// The rest of a way where the slope changes, and the normal by which it is lifted. Between two
    /// slopes it goes along the valley.
    fn onto_slope(&self, rest: Vec3, before: Vec3, normal: Vec3) -> (Vec3, Vec3) {
        let lifted = self.upright.lifted(rest, normal);
        if lifted.dot(before) >= -1e-4 * lifted.length() {
            return (rest, normal);
        }
        let valley = unit(before.cross(normal)).and_then(|valley| unit(flat(valley, self.up())));
        let (Some(valley), Some(both)) = (valley, unit(before + normal)) else { return (Vec3::ZERO, normal) };
        (valley * rest.dot(valley), both)
    }

    /// The normal, across the up axis, of the upright wall by which an obstacle stops who walks on
    /// a slope; none where floor and ceiling meet.
    fn wall_of(&self, hit: &Hit, ground: Vec3) -> Option<Vec3> {
        let up = self.up();
        let along = unit(flat(ground.cross(hit.normal), up));
        let wall = match along {
            Some(along) => unit(flat(along.cross(up), up))?,
            None => unit(flat(hit.normal, up))?,
        };
        let side = wall.dot(hit.normal);
        (side.abs() > 1e-3).then(|| wall * side.signum())
    }

    /// Whether it is the edge of something too high to go over, though its round foot would glide
    /// up there.
    fn is_a_high_edge(&self, hit: &Hit) -> bool {
        let height = (hit.point - self.position).dot(self.up());
        if height <= self.settings.step_height + self.skin() {
            return false;
        }
        let face = self.face_beyond(hit);
        face.is_none_or(|face| face.dot(hit.normal) < 0.98)
    }

    fn stop_at(&mut self, hit: &Hit) {
        let velocity = self.state.velocity;
        self.run_into(hit, velocity);
        self.state.velocity = Vec3::ZERO;
    }

    /// What is left of its velocity at a wall, relative to the ground.
    fn lose_speed(&mut self, hit: &Hit, wall: Vec3, walls: &[Vec3]) {
        let own = self.state.velocity;
        let world = own + self.state.ground_velocity;
        let plane = self.run_into(hit, world);
        // Along the wall, what moves away from it does not stop it.
        let speed = (plane.normal * plane.speed - self.state.ground_velocity).dot(wall);
        if own.dot(wall) >= speed {
            return;
        }
        let slid = own + wall * (speed - own.dot(wall));
        let is_free = walls.iter().all(|it| *it == wall || slid.dot(*it) >= -1e-4 * own.length());
        self.state.velocity = if is_free { slid } else { self.upright.clipped_flat(own, walls) };
    }
}
