//! How much of its weight a character gives to what it stands on.

use tumble::hecs::Entity;
use tumble::math::{Real, Vec3};

use crate::motion::Motion;
use crate::push::Weight;
use crate::surroundings::Body;
use crate::vectors::unit;

/// The most that a body carries, in weights of the mass that is felt at the sole.
const MAX_LOAD: Real = 8.0;
/// The same in the first step on it, when it is not known what it rests on.
const FIRST_LOAD: Real = 2.0;

/// How a body that carries a character has given way in the last step.
#[derive(Clone, Copy, Debug)]
pub(super) struct GivenWay {
    entity: Entity,
    /// What its point at the sole has gained \[m/s\].
    gained: Vec3,
}

impl Motion<'_> {
    /// How what it stood on before the step has taken the weight.
    pub(super) fn given_way(&self) -> Option<GivenWay> {
        let entity = self.state.ground_entity.filter(|_| self.state.is_grounded())?;
        let Body::Dynamic(body) = self.around.body(entity) else { return None };
        let now = body.velocity.at_point(self.state.ground_point, body.position);
        Some(GivenWay { entity, gained: now - self.state.ground_velocity })
    }

    /// The weight on a dynamic body: what makes the character fall as fast as its ground gives way,
    /// found from step to step. What rests on something gets all of it, what is loose next to none.
    pub(super) fn weigh(&mut self, gravity: Vec3, before: Option<GivenWay>) -> Option<Weight> {
        let (mass, dt) = (self.settings.mass, self.around.dt);
        let full = gravity.length() * mass;
        let ground = self.state.ground_entity.filter(|_| self.state.is_grounded());
        let (Some(entity), Some(down)) = (ground, unit(gravity)) else {
            self.state.load = 0.0;
            return None;
        };
        let Body::Dynamic(body) = self.around.body(entity) else {
            self.state.load = full;
            return None;
        };
        let point = self.state.ground_point;
        let felt = 1.0 / self.around.mobility(entity, point - body.position, down).max(Real::MIN_POSITIVE);
        let before = before.filter(|it| it.entity == entity);
        let gained = before.map_or(0.0, |it| it.gained.dot(down));
        let wanted = full - mass * gained / dt;
        let load = self.state.load + (wanted - self.state.load) * (felt / (felt + mass));
        let weights = if before.is_some() { MAX_LOAD } else { FIRST_LOAD };
        let most = full.min(weights * felt * gravity.length());
        self.state.load = if load.is_finite() { load.clamp(0.0, most) } else { 0.0 };
        Some(Weight { entity, point, force: down * self.state.load })
    }
}
