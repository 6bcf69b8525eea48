//! The order of things in a step of one character.

use tumble::math::{Real, Vec3};
use tumble::{Collider, Velocity};

use crate::motion::{Motion, Outcome};
use crate::push::Weight;
use crate::settings::Turning;
use crate::state::{CharacterState, GroundState};
use crate::vectors::{flat, limited};

impl Motion<'_> {
    /// Computes the step: its own way through the world as it is, and then what moves it.
    pub(crate) fn plan(mut self) -> Outcome {
        let dt = self.around.dt;
        self.state.is_crushed = false;
        let given_way = self.given_way();
        self.crouch_or_stand();
        let gravity = self.gravity();
        self.remember_jump();
        let wants_jump = self.state.jump_wish > 0.0 && self.state.ground != GroundState::OnSteep;
        self.state.air_time += dt;
        self.accelerate();
        let may_jump = self.state.is_grounded()
            || (!self.state.has_jumped && self.state.air_time - dt <= self.settings.coyote_time);
        if wants_jump && may_jump {
            self.jump(-gravity.dot(self.up()));
            self.fly(gravity);
        } else if self.state.is_grounded() {
            self.walk_and_find_ground(dt);
        } else {
            self.fly(gravity);
        }
        self.keep_to_own_side();
        let own = self.position;
        self.be_carried();
        self.be_pushed(own);
        let weight = self.weigh(gravity, given_way);
        self.outcome(weight)
    }

    /// Walks for a time \[s\], in parts no longer than its radius, so that it stays on ground that
    /// falls away whatever the step.
    fn walk_and_find_ground(&mut self, time: Real) {
        let parts = (self.state.velocity.length() * time / self.settings.radius).ceil().clamp(1.0, MAX_PARTS);
        for part in 0..parts as u32 {
            let left = parts - part as Real;
            match self.state.ground {
                GroundState::OnGround => {
                    self.walk(self.state.velocity * (time / parts));
                    self.find_ground(self.settings.snap_distance);
                }
                // It goes on straight for the rest of the step.
                _ => return self.glide(time * left / parts),
            }
        }
    }

    /// Gravity along the up axis [m/s^2].
    fn gravity(&self) -> Vec3 {
        self.up() * (self.around.gravity.dot(self.up()) * self.settings.gravity_scale)
    }

    fn crouch_or_stand(&mut self) {
        if self.input.crouch {
            self.state.is_crouching = true;
        } else if self.state.is_crouching {
            let room = self.settings.height - self.settings.crouch_height;
            let is_free = self.cast(self.position, self.up() * room).is_none();
            self.state.is_crouching = !is_free;
        }
        self.collider = self.character.collider(self.state.is_crouching);
    }

    fn remember_jump(&mut self) {
        let is_new = self.input.jump && !self.state.was_jump_down;
        self.state.was_jump_down = self.input.jump;
        // One step at least, however short the time that is set.
        let kept = self.settings.jump_buffer.max(self.around.dt);
        self.state.jump_wish = if is_new { kept } else { (self.state.jump_wish - self.around.dt).max(0.0) };
    }

    /// Comes nearer to the wanted velocity.
    fn accelerate(&mut self) {
        let given = self.input.velocity;
        let wanted = if given.is_finite() { flat(given, self.up()) } else { Vec3::ZERO };
        let (own, upward) = (flat(self.state.velocity, self.up()), self.up() * self.state.velocity.dot(self.up()));
        let CharacterRates { rate, is_free } = self.rates(own, wanted);
        if is_free {
            return;
        }
        self.state.velocity = own + limited(wanted - own, rate * self.around.dt) + upward;
    }

    fn rates(&self, own: Vec3, wanted: Vec3) -> CharacterRates {
        let settings = self.settings;
        match self.state.ground {
            GroundState::OnGround if wanted.length_squared() < own.length_squared() => {
                CharacterRates { rate: settings.deceleration, is_free: false }
            }
            GroundState::OnGround => CharacterRates { rate: settings.acceleration, is_free: false },
            _ => CharacterRates { rate: settings.air_acceleration, is_free: wanted == Vec3::ZERO },
        }
    }

    fn jump(&mut self, gravity: Real) {
        let speed = (2.0 * gravity.max(0.0) * self.settings.jump_height).sqrt();
        let ground = self.state.ground_velocity;
        self.state.velocity = flat(self.state.velocity, self.up()) + ground + self.up() * speed;
        self.state.has_jumped = true;
        self.state.jump_wish = 0.0;
        self.be_in_air();
    }

    /// The collider that goes with how it stands, if the body has another.
    fn changed_collider(&self) -> Option<Collider> {
        let now = self.around.collider_of(self.entity)?;
        (now != *self.collider).then(|| self.collider.clone())
    }

    fn outcome(self, weight: Option<Weight>) -> Outcome {
        let velocity = (self.position - self.start) / self.around.dt;
        let is_sane = velocity.is_finite() && self.state.velocity.is_finite();
        let linear = if is_sane { velocity } else { Vec3::ZERO };
        let follows = self.settings.turning == Turning::WithGround;
        Outcome {
            velocity: Velocity { linear, angular: self.settings.up * if follows { self.state.yaw_rate } else { 0.0 } },
            collider: self.changed_collider(),
            state: if is_sane { self.state } else { CharacterState::default() },
            touches: self.touches,
            pushes: self.pushes,
            weight,
        }
    }
}

/// The most parts of a walk in a step.
const MAX_PARTS: Real = 8.0;

/// How fast a velocity changes [m/s^2], if it does.
struct CharacterRates {
    rate: Real,
    is_free: bool,
}
