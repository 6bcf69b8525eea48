//! A way along the ground: walls turn it aside, slopes and steps lift it.

use tumble::hecs::Entity;
use tumble::math::Vec3;

use crate::motion::{Advance, Hit, MAX_SLIDES, Motion};
use crate::slide::Plane;
use crate::surroundings::Body;
use crate::vectors::{flat, unit};

impl Motion<'_> {
    /// Goes a way across the up axis \[m\] along the ground.
    pub(super) fn walk(&mut self, way: Vec3) {
        let mut way = way;
        let mut normal = self.state.ground_normal;
        let own = self.state.velocity;
        let mut walls: Vec<Plane> = self.held_by.iter().filter_map(|it| self.upright_wall(it)).collect();
        let mut rest = self.upright.clipped_flat(way, &walls, false);
        for _ in 0..MAX_SLIDES {
            let (hit, left) = match self.advance(self.upright.lifted(rest, normal)) {
                Advance::Done => break,
                Advance::PushedOut => {
                    walls.extend(self.held_by.iter().filter_map(|it| self.upright_wall(it)));
                    rest = self.upright.clipped_flat(way, &walls, false);
                    self.state.velocity = self.upright.clipped_flat(own, &walls, true);
                    continue;
                }
                Advance::Met(hit, left) => (hit, left),
            };
            (way, rest) = (way * left, rest * left);
            if self.upright.is_walkable(hit.normal) && !self.is_a_high_edge(&hit) {
                (rest, normal) = self.onto_slope(rest, normal, hit.normal);
                way = rest;
                continue;
            }
            let is_step = !self.is_kicked(hit.entity);
            if let Some((left, landing)) = is_step.then(|| self.step_up(rest)).flatten() {
                (way, rest, normal) = (way * left, rest * left, landing);
                continue;
            }
            let Some(wall) = self.wall_of(&hit, normal) else {
                self.stop_at(&hit);
                break;
            };
            let plane = self.run_into(&hit, own + self.state.ground_velocity);
            walls.push(self.seen_from_ground(&plane, wall));
            rest = self.upright.clipped_flat(way, &walls, false);
            self.state.velocity = self.upright.clipped_flat(own, &walls, true);
        }
        self.state.ground_normal = normal;
    }

    /// What it pushes ahead and does not step on: other characters, and what is less than half as
    /// heavy as it.
    fn is_kicked(&self, entity: Entity) -> bool {
        match self.around.body(entity) {
            Body::Dynamic(_) => self.around.mobility(entity, Vec3::ZERO, self.up()) * self.settings.mass > 2.0,
            _ => self.around.is_character(entity),
        }
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
        if height <= self.settings.step_height + 0.1 * self.skin() {
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

    /// The plane of something that stands in the way, as an upright wall.
    fn upright_wall(&self, plane: &Plane) -> Option<Plane> {
        let wall = unit(flat(plane.normal, self.up()))?;
        Some(self.seen_from_ground(plane, wall))
    }

    fn seen_from_ground(&self, plane: &Plane, wall: Vec3) -> Plane {
        let speed = (plane.normal * plane.speed - self.state.ground_velocity).dot(wall);
        // What comes near pushes it later, and does not throw it.
        Plane { normal: wall, speed: speed.min(0.0) }
    }
}
