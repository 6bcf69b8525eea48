//! A way through the air, or down a steep slope.

use tumble::math::{Real, Vec3};

use crate::motion::{Advance, Hit, MAX_SLIDES, Motion};
use crate::push::Push;
use crate::surroundings::Body;
use crate::vectors::flat;

impl Motion<'_> {
    /// Flies as the velocity and gravity have it, until it lands.
    pub(super) fn fly(&mut self, gravity: Vec3) {
        self.fly_for(self.around.dt, gravity);
    }

    /// Goes on with its velocity for a time \[s\].
    pub(super) fn glide(&mut self, time: Real) {
        self.fly_for(time, Vec3::ZERO);
    }

    fn fly_for(&mut self, dt: Real, gravity: Vec3) {
        let before = self.state.velocity;
        let mut rest = before * dt + gravity * (0.5 * dt * dt);
        let mut velocity = before + gravity * dt;
        let fall = -velocity.dot(self.up()) - self.settings.max_fall_speed;
        if fall > 0.0 {
            velocity += self.up() * fall;
            rest += self.up() * (fall * dt).min(-rest.dot(self.up())).max(0.0);
        }
        let free_velocity = velocity;
        let mut planes = self.held_by.clone();
        let mut slope = None;
        let mut way = rest;
        rest = self.upright.clipped(way, &planes, false);
        for _ in 0..MAX_SLIDES {
            let (hit, left) = match self.advance(rest) {
                Advance::Done => break,
                Advance::PushedOut => {
                    planes.extend_from_slice(&self.held_by);
                    rest = self.upright.clipped(way, &planes, false);
                    velocity = self.upright.clipped(free_velocity, &planes, true);
                    continue;
                }
                Advance::Met(hit, left) => (hit, left),
            };
            (way, rest) = (way * left, rest * left);
            if self.is_landing(&hit, velocity) {
                return self.land(&hit, velocity, rest);
            }
            if self.upright.is_steep(hit.normal) {
                slope = Some(hit);
            }
            let plane = self.run_into(&hit, velocity);
            planes.push(plane);
            rest = self.upright.clipped(way, &planes, false);
            velocity = self.upright.clipped(free_velocity, &planes, true);
        }
        self.state.velocity = velocity;
        self.end_flight(slope, velocity, free_velocity);
    }

    /// Where it is at the end of a flight without a landing: in the air, on a steep slope, or
    /// wedged between two.
    fn end_flight(&mut self, slope: Option<Hit>, velocity: Vec3, free: Vec3) {
        let up = self.up();
        let Some(hit) = slope else { return self.be_in_air() };
        let falls = free.dot(up) < 0.0;
        let is_held = velocity.dot(up) > 0.02 * free.dot(up);
        if falls && is_held {
            self.stand_on(&hit, up);
            self.state.velocity = flat(velocity - self.state.ground_velocity, up);
        } else {
            self.slide_on(&hit);
        }
    }

    fn is_landing(&self, hit: &Hit, velocity: Vec3) -> bool {
        let relative = velocity - self.velocity_of(hit);
        self.upright.is_walkable(hit.normal) && relative.dot(self.up()) <= 0.0
    }

    fn land(&mut self, hit: &Hit, velocity: Vec3, rest: Vec3) {
        let up = self.up();
        self.push_by_landing(hit, velocity);
        self.stand_on(hit, hit.normal);
        self.state.velocity = flat(velocity - self.state.ground_velocity, up);
        self.walk(flat(rest, up));
        self.find_ground(self.settings.snap_distance);
    }

    /// What it lands on gets the momentum of a blow without bounce.
    fn push_by_landing(&mut self, hit: &Hit, velocity: Vec3) {
        let Body::Dynamic(_) = self.around.body(hit.entity) else { return };
        self.pushes.push(Push {
            entity: hit.entity,
            point: hit.point,
            direction: -hit.normal,
            speed: -velocity.dot(hit.normal),
            most: Real::MAX,
            mass: Some(self.settings.mass),
        });
    }
}
