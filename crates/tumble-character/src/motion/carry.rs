//! What moves a character without its doing: the ground that it stands on, and walls that come.

use tumble::QueryFilter;
use tumble::math::{Real, Vec3};

use crate::motion::{Hit, Motion, REACH};
use crate::slide::Plane;
use crate::surroundings::{Body, Mover};
use crate::vectors::unit;

impl Motion<'_> {
    /// Moves with the ground, as far as there is room. Returns how far it got.
    pub(super) fn be_carried(&mut self) -> Vec3 {
        let Some(ground) = self.state.ground_entity.filter(|_| self.state.is_grounded()) else { return Vec3::ZERO };
        let (Body::Kinematic(mover) | Body::Dynamic(mover)) = self.around.body(ground) else { return Vec3::ZERO };
        let way = mover.way_of(self.state.ground_point, self.around.dt);
        let before = self.position;
        let movers: Vec<_> = self.around.movers.iter().map(|it| it.entity).chain([ground]).collect();
        let left = self.shift(way, &movers);
        if left.dot(way) > way.length() * self.skin() {
            self.state.is_crushed |= way.dot(self.up()) > 0.0 && left.dot(self.up()) > self.skin();
        }
        self.position - before
    }

    /// Gets out of the way of kinematic bodies that would overlap it at the end of the step.
    pub(super) fn be_pushed(&mut self, start: Vec3) {
        if self.around.movers.is_empty() {
            return;
        }
        for mover in self.near_movers() {
            self.be_pushed_by(&mover, start);
        }
    }

    /// The kinematic bodies that may get as far as it.
    fn near_movers(&self) -> Vec<Mover> {
        let (up, dt) = (self.up(), self.around.dt);
        let half = self.height() * 0.5;
        let middle = self.position + up * half;
        let reach = |mover: &Mover| mover.reach(middle, half, dt);
        let most = self.around.movers.iter().map(reach).fold(0.0, Real::max);
        let size = Vec3::splat(half + most + 2.0 * self.skin());
        let filter = self.filter().without_fixed().without_dynamic();
        let near = self.around.queries.in_box(middle - size, middle + size, &filter);
        let find = |entity| self.around.movers.iter().find(|it| it.entity == entity).copied();
        near.into_iter().filter_map(find).collect()
    }

    fn be_pushed_by(&mut self, mover: &Mover, start: Vec3) {
        let (dt, skin) = (self.around.dt, self.skin());
        let middle = self.position + self.up() * (self.height() * 0.5);
        // As the mover sees it.
        let own = self.position - start;
        let way = own - mover.way_of(middle, dt);
        let Some(direction) = unit(way) else { return };
        let length = way.length();
        let entity = mover.entity;
        let is_it = move |found| found == entity;
        let filter = self.filter().matching(&is_it);
        let Some(hit) = self.cast_by(self.collider, start, direction * (length + REACH * skin), &filter) else {
            return;
        };
        let there = own - mover.way_of(hit.point, dt);
        let rate = -direction.dot(hit.normal);
        let into = (there.dot(-hit.normal)).max(length * rate) - hit.distance * rate + skin;
        if into <= 1e-3 * skin || (hit.distance <= 0.0 && rate <= 0.0) {
            return;
        }
        self.touch(&hit);
        let left = self.shift(hit.normal * into, &[entity]);
        if left.length() > skin {
            self.state.is_crushed = true;
        }
        self.be_as_fast_as(&hit, mover);
    }

    /// It moves along the normal at least as fast as what pushes it.
    fn be_as_fast_as(&mut self, hit: &Hit, mover: &Mover) {
        let pushed = mover.velocity.at_point(hit.point, mover.position);
        let missing = (pushed - self.state.world_velocity()).dot(hit.normal);
        if missing > 0.0 && !self.state.is_grounded() {
            self.state.velocity += hit.normal * missing;
        }
    }

    /// Moves by a way without leave of what is passed over; slides along what is in the way.
    /// Returns what is left of it.
    pub(super) fn shift(&mut self, way: Vec3, passed: &[tumble::hecs::Entity]) -> Vec3 {
        let mut rest = way;
        let mut planes: Vec<Plane> = Vec::new();
        let skin = self.skin();
        for _ in 0..4 {
            let length = rest.length();
            if length <= Real::MIN_POSITIVE || !length.is_finite() {
                return Vec3::ZERO;
            }
            let direction = rest / length;
            let is_other = |entity| !passed.contains(&entity);
            let filter: QueryFilter<'_> = self.filter().matching(&is_other);
            let hit = self.cast_by(self.collider, self.position, direction * (length + REACH * skin), &filter);
            // What it is in already does not stop it.
            let Some(hit) = hit.filter(|hit| hit.distance > 0.0 || direction.dot(hit.normal) < -0.5) else {
                self.position += rest;
                return Vec3::ZERO;
            };
            let free = self.free_way(&hit, direction, length);
            self.position += direction * free;
            if free >= length {
                return Vec3::ZERO;
            }
            rest *= 1.0 - free / length;
            self.touch(&hit);
            planes.push(Plane { normal: hit.normal, speed: 0.0 });
            let slid = self.upright.clipped(rest, &planes, false);
            if slid.length() < 0.01 * skin {
                return rest;
            }
            rest = slid;
        }
        rest
    }
}
