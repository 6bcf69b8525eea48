//! What a character stands on.

use tumble::math::{Real, Vec3};

use crate::motion::{Hit, Motion, REACH};
use crate::slide::Plane;
use crate::state::GroundState;
use crate::surroundings::Body;

/// The steps in which a ray may do for a cast.
const SURE_STEPS: u8 = 7;

/// What is below the sole.
#[derive(Clone, Copy, Debug)]
enum Footing {
    /// Ground, with the normal by which to walk on it.
    Ground(Hit, Vec3),
    Steep(Hit),
    Nothing,
}

impl Motion<'_> {
    /// Finds the ground after a walk, and stays on it if it is near enough; else it is in the air.
    pub(super) fn find_ground(&mut self, reach: Real) {
        if self.is_still_on_ground() {
            return;
        }
        self.state.sure_for = SURE_STEPS;
        match self.footing(reach) {
            Footing::Ground(hit, normal) => {
                self.snap_to(&hit);
                self.stand_on(&hit, normal);
            }
            Footing::Steep(hit) => {
                if self.is_wedged() {
                    self.stand_on(&hit, self.up());
                } else {
                    let velocity = self.state.world_velocity();
                    self.slide_on(&hit);
                    self.state.velocity = velocity;
                }
            }
            Footing::Nothing => self.leave_ground(),
        }
    }

    /// Whether it stands where it stood, on the same plane: a ray finds that for much less than a
    /// cast, which is made again after some steps.
    fn is_still_on_ground(&mut self) -> bool {
        let (up, skin, radius) = (self.up(), self.skin(), self.settings.radius);
        let normal = self.state.ground_normal;
        let rise = normal.dot(up);
        if self.state.sure_for == 0 || !self.state.is_grounded() || rise < 0.5 {
            return false;
        }
        // Where it would touch that plane, seen from above.
        let point = self.position + (up - normal) * radius;
        let Some(face) = self.ray(point + up * radius, -up * (radius + skin)) else { return false };
        let down = face.distance - radius;
        if !self.upright.is_walkable(face.normal) || (face.normal - normal).length() > 1e-3 || down.abs() > 0.1 * skin {
            return false;
        }
        self.state.sure_for -= 1;
        if down.abs() > 0.01 * skin {
            self.position -= up * down;
        }
        let hit = Hit { entity: face.entity, distance: skin, normal: face.normal, point };
        self.touch(&hit);
        self.stand_on(&hit, face.normal);
        true
    }

    fn footing(&mut self, reach: Real) -> Footing {
        let (up, skin) = (self.up(), self.skin());
        let down = -up * (reach + 2.0 * skin);
        let mut hit = self.cast(self.position, down);
        while let Some(inside) = hit.filter(|hit| self.is_inside(hit)) {
            if !self.push_out() {
                self.ignored.push(inside.entity);
            }
            hit = self.cast(self.position, down);
        }
        let Some(hit) = hit else { return Footing::Nothing };
        self.touch(&hit);
        if self.upright.is_walkable(hit.normal) {
            return Footing::Ground(hit, hit.normal);
        }
        // What is under its middle, as far as it may step down.
        let middle = self.position + up * self.settings.radius;
        let under = self.ray(middle, -up * (self.settings.radius + reach.max(2.0 * skin)));
        let under = under.filter(|it| it.distance > 0.0 && self.upright.is_walkable(it.normal));
        let is_edge = self.face_beyond(&hit).is_some_and(|face| self.upright.is_walkable(face));
        match under {
            Some(_) if is_edge => Footing::Ground(hit, up),
            Some(under) if under.distance <= self.settings.radius + 2.0 * skin => {
                let (entity, normal, point) = (under.entity, under.normal, under.point);
                // Down to that ground, but not into the slope beside it.
                let room = (hit.distance - skin / hit.normal.dot(up).max(0.1)).max(0.0);
                let distance = (under.distance - self.settings.radius + skin).min(skin + room);
                Footing::Ground(Hit { entity, normal, point, distance }, normal)
            }
            _ => Footing::Steep(hit),
        }
    }

    /// Goes down to the ground, or up to where it is the skin above.
    fn snap_to(&mut self, hit: &Hit) {
        let skin = self.skin();
        let wanted = skin / hit.normal.dot(self.up()).max(0.5);
        let down = hit.distance - wanted;
        if down > skin * 0.01 {
            self.position -= self.up() * down;
        } else if down < -skin * 0.01 {
            self.rise((-down).min(0.5 * skin));
        }
    }

    /// Goes up by a little, as far as there is room.
    fn rise(&mut self, height: Real) {
        let up = self.up();
        let above = self.cast(self.position, up * (height + REACH * self.skin()));
        self.position += up * above.map_or(height, |hit| self.free_way(&hit, up, height));
    }

    /// It stands on ground from now on.
    pub(super) fn stand_on(&mut self, hit: &Hit, normal: Vec3) {
        self.record_ground(hit, normal);
        self.state.ground = GroundState::OnGround;
        self.state.air_time = 0.0;
        self.state.has_jumped = false;
    }

    /// It slides on steep ground from now on.
    pub(super) fn slide_on(&mut self, hit: &Hit) {
        self.record_ground(hit, hit.normal);
        self.state.ground_velocity = Vec3::ZERO;
        self.state.ground = GroundState::OnSteep;
    }

    fn record_ground(&mut self, hit: &Hit, normal: Vec3) {
        self.state.ground_entity = Some(hit.entity);
        self.state.ground_normal = normal;
        self.state.ground_point = hit.point;
        self.state.ground_velocity = self.velocity_of(hit);
        self.state.yaw_rate = match self.around.body(hit.entity) {
            Body::Still => 0.0,
            Body::Kinematic(mover) | Body::Dynamic(mover) => mover.velocity.angular.dot(self.up()),
        };
    }

    /// It is in the air from now on, and keeps the speed across the up axis and that of the ground:
    /// the end of a ramp does not throw it up.
    pub(super) fn leave_ground(&mut self) {
        self.state.velocity += self.state.ground_velocity;
        self.be_in_air();
    }

    pub(super) fn be_in_air(&mut self) {
        self.state.ground = GroundState::InAir;
        self.state.ground_entity = None;
        self.state.ground_velocity = Vec3::ZERO;
        self.state.yaw_rate = 0.0;
    }

    /// Whether steep ground and something else hold it, so that it does not get down.
    fn is_wedged(&self) -> bool {
        let way = -self.up() * (4.0 * self.skin());
        let (mut rest, mut position) = (way, self.position);
        let mut planes: Vec<Plane> = Vec::new();
        for _ in 0..4 {
            let length = rest.length();
            if length < self.skin() * 0.1 {
                return true;
            }
            let direction = rest / length;
            let Some(hit) = self.cast(position, direction * (length + REACH * self.skin())) else { return false };
            let free = self.free_way(&hit, direction, length);
            if free >= length {
                return false;
            }
            position += direction * free;
            planes.push(Plane { normal: hit.normal, speed: 0.0 });
            rest = self.upright.clipped(rest * (1.0 - free / length), &planes, false);
        }
        rest.dot(self.up()) >= -0.1 * self.skin()
    }
}
