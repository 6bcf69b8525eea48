//! The way of one character through one step.

mod carry;
mod crowd;
mod fly;
mod footing;
mod plan;
mod push_out;
mod step_up;
mod walk;
mod weight;

use tumble::hecs::Entity;
use tumble::math::{Quat, Real, Vec3};
use tumble::{Collider, Pose, QueryFilter, Ray, RayHit, Velocity};

use crate::character::Character;
use crate::push::{Push, Weight};
use crate::settings::CharacterSettings;
use crate::slide::{Plane, Upright};
use crate::state::{CharacterInput, CharacterState};
use crate::surroundings::{Body, Surroundings};
use crate::touches::{CharacterTouches, Touch};

/// How far ahead of a way it looks, in skins: it comes nearer than one where it grazes a surface
/// by less than the inverse of this.
const REACH: Real = 3.0;
/// How often a way is bent in a step.
const MAX_SLIDES: usize = 8;

/// A character on its way.
pub(crate) struct Motion<'a> {
    around: &'a Surroundings<'a>,
    entity: Entity,
    character: &'a Character,
    settings: &'a CharacterSettings,
    input: CharacterInput,
    collider: &'a Collider,
    upright: Upright,
    position: Vec3,
    /// Where it is before the step.
    start: Vec3,
    state: CharacterState,
    touches: CharacterTouches,
    /// Bodies that it passes through, and those that it cannot get out of in this step.
    ignored: Vec<Entity>,
    /// What keeps it from going further into those.
    held_by: Vec<Plane>,
    has_been_pushed_out: bool,
    pushes: Vec<Push>,
}

/// What the step makes of a character.
#[derive(Clone, Debug)]
pub(crate) struct Outcome {
    pub(crate) velocity: Velocity,
    /// Another one, where it has crouched or stood up.
    pub(crate) collider: Option<Collider>,
    pub(crate) state: CharacterState,
    pub(crate) touches: CharacterTouches,
    pub(crate) pushes: Vec<Push>,
    pub(crate) weight: Option<Weight>,
}

/// What is met on a way.
#[derive(Clone, Copy, Debug)]
struct Hit {
    entity: Entity,
    distance: Real,
    normal: Vec3,
    point: Vec3,
}

/// How a way ended.
#[derive(Clone, Copy, Debug)]
enum Advance {
    /// It is gone.
    Done,
    /// It began in something, and what is in its way may be other than before.
    PushedOut,
    /// At this, and which part of it is left.
    Met(Hit, Real),
}

impl<'a> Motion<'a> {
    pub(crate) fn new(
        around: &'a Surroundings<'a>,
        entity: Entity,
        (character, state, input): (&'a Character, CharacterState, CharacterInput),
        position: Vec3,
    ) -> Self {
        let settings = character.settings();
        Self {
            around,
            entity,
            character,
            settings,
            input,
            collider: character.collider(state.is_crouching),
            upright: Upright { up: settings.up, min_up: character.min_up },
            position,
            start: position,
            state,
            touches: CharacterTouches::default(),
            ignored: around.ignored_by(entity),
            held_by: Vec::new(),
            has_been_pushed_out: false,
            pushes: Vec::new(),
        }
    }

    fn up(&self) -> Vec3 {
        self.upright.up
    }

    fn skin(&self) -> Real {
        self.settings.skin
    }

    /// The height of the space that it takes now \[m\].
    fn height(&self) -> Real {
        self.settings.height_now(self.state.is_crouching)
    }

    fn filter(&self) -> QueryFilter<'_> {
        let filter = QueryFilter::new().without(self.entity).without_all(&self.ignored);
        match (self.settings.membership, self.settings.filter) {
            (u32::MAX, u32::MAX) => filter,
            (membership, touched) => filter.with_groups(membership, touched),
        }
    }

    /// What its collider meets from a position on.
    fn cast(&self, from: Vec3, way: Vec3) -> Option<Hit> {
        self.cast_by(self.collider, from, way, &self.filter())
    }

    /// What it meets on a way of unit length, or would come too near to at its end. Others that
    /// come towards it are seen at twice the distance.
    fn look(&self, from: Vec3, direction: Vec3, length: Real) -> Option<Hit> {
        let near = length + REACH * self.skin();
        let far = if self.around.has_several { near + length } else { near };
        let hit = self.cast(from, direction * far)?;
        (hit.distance <= near || self.around.is_character(hit.entity)).then_some(hit)
    }

    fn cast_by(&self, collider: &Collider, from: Vec3, way: Vec3, filter: &QueryFilter<'_>) -> Option<Hit> {
        let pose = Pose { position: from, orientation: self.orientation() };
        let hit = self.around.queries.cast_shape(collider, &pose, way, filter)?;
        Some(Hit { entity: hit.entity, distance: hit.distance, normal: hit.normal, point: hit.point })
    }

    fn orientation(&self) -> Quat {
        self.character.base()
    }

    fn ray(&self, from: Vec3, way: Vec3) -> Option<RayHit> {
        self.around.queries.cast_ray(&Ray::between(from, from + way), &self.filter())
    }

    /// How deep its collider, at its position, is in what it meets there \[m\].
    fn depth(&self, hit: &Hit) -> Real {
        let up = self.up();
        let round = self.settings.radius - self.skin();
        let height = if hit.normal.dot(up) > 0.0 { self.settings.radius } else { self.height() - self.settings.radius };
        let deepest = self.position + up * height - hit.normal * round;
        (hit.point - deepest).dot(hit.normal)
    }

    /// How far it can go along a way of unit length until it is as near as it may be. Another
    /// character, which may come as far in the same step, gets half of the room.
    fn free_way(&self, hit: &Hit, direction: Vec3, length: Real) -> Real {
        let rate = -direction.dot(hit.normal);
        if rate <= 1e-6 {
            return length;
        }
        let free = hit.distance - self.skin() / rate;
        if !self.around.is_character(hit.entity) {
            return free.clamp(0.0, length);
        }
        let gone = (self.start - self.position).dot(hit.normal).max(0.0);
        (0.5 * (free - gone / rate)).clamp(0.0, length)
    }

    /// Goes along a way until something is met.
    fn advance(&mut self, way: Vec3) -> Advance {
        let length = way.length();
        if length < self.skin() * 1e-3 {
            return Advance::Done;
        }
        let direction = way / length;
        let Some(hit) = self.look(self.position, direction, length) else {
            self.position += way;
            return Advance::Done;
        };
        if self.is_inside(&hit) {
            self.push_out();
            return Advance::PushedOut;
        }
        let free = self.free_way(&hit, direction, length);
        self.position += direction * free;
        if free >= length {
            return Advance::Done;
        }
        self.touch(&hit);
        Advance::Met(hit, 1.0 - free / length)
    }

    fn touch(&mut self, hit: &Hit) {
        self.touches.add(Touch { entity: hit.entity, point: hit.point, normal: hit.normal });
    }

    /// The velocity of what it meets, there \[m/s\].
    fn velocity_of(&self, hit: &Hit) -> Vec3 {
        match self.around.body(hit.entity) {
            Body::Still => Vec3::ZERO,
            Body::Kinematic(mover) | Body::Dynamic(mover) => mover.velocity.at_point(hit.point, mover.position),
        }
    }

    /// The plane of what it meets, with the speed that it has after a push if it is pushed by a
    /// character of this velocity.
    fn run_into(&mut self, hit: &Hit, velocity: Vec3) -> Plane {
        let normal = hit.normal;
        let Body::Dynamic(body) = self.around.body(hit.entity) else {
            return Plane { normal, speed: self.velocity_of(hit).dot(normal) };
        };
        let arm = hit.point - body.position;
        let speed = -body.velocity.at_point(hit.point, body.position).dot(normal);
        let wanted = -velocity.dot(normal);
        let most = self.settings.push_strength * self.around.dt;
        let mobility = self.around.mobility(hit.entity, arm, normal);
        let after = speed.max((speed + most * mobility).min(wanted));
        if wanted > speed {
            let known = self.pushes.iter().any(|push| push.entity == hit.entity);
            if !known {
                let (entity, point) = (hit.entity, hit.point);
                self.pushes.push(Push { entity, point, direction: -normal, speed: wanted, most, mass: None });
            }
        }
        Plane { normal, speed: -after }
    }
}
