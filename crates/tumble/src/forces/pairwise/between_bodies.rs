//! Springs and gravity between bodies in given states, in double precision.

use std::collections::HashMap;

use glam::DVec3;
use hecs::{Entity, World};

use crate::components::{Mass, Momentum, Pose, Velocity};
use crate::forces::pairwise;
use crate::forces::pairwise::{GravityMass, Spring};
use crate::integrators::state::{Constants, State, moving_body};
use crate::math::{Real, double, double_quat, dquat, dvec3};

/// A body as forces between bodies see it, in double precision.
struct End {
    position: DVec3,
    orientation: glam::DQuat,
    linear_velocity: DVec3,
    angular_velocity: DVec3,
    /// Its place among those that are asked for.
    index: Option<usize>,
}

impl End {
    fn of(constants: &Constants<Real>, state: &State<Real>, index: Option<usize>) -> Self {
        let upright = State { orientation: state.orientation.normalize(), ..*state };
        Self {
            position: double(state.position),
            orientation: double_quat(upright.orientation),
            linear_velocity: double(constants.velocity(state.linear)),
            angular_velocity: double(constants.angular_velocity(&upright)),
            index,
        }
    }
}

/// Forces of other bodies on one, by springs and by gravity.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Pull {
    pub(crate) springs: Pulled,
    pub(crate) gravity: Pulled,
}

/// Force \[N\] and torque about the centre of mass [N m].
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Pulled {
    pub(crate) force: DVec3,
    pub(crate) torque: DVec3,
}

/// The forces of other bodies on these in these states, in their order; empty without any. The
/// states of all others are those of the world.
pub(crate) fn forces_between_bodies(world: &World, bodies: &[Entity], states: &[State<Real>]) -> Vec<Pull> {
    if !pairwise::are_in(world) {
        return Vec::new();
    }
    let places = bodies.iter().enumerate().map(|(index, entity)| (*entity, index)).collect();
    let bodies = BetweenBodies { world, states, places };
    let mut pulls = vec![Pull::default(); states.len()];
    for spring in world.query::<&Spring>().iter() {
        bodies.add_spring(spring, &mut pulls);
    }
    bodies.add_gravity(&mut pulls);
    pulls
}

struct BetweenBodies<'a> {
    world: &'a World,
    states: &'a [State<Real>],
    places: HashMap<Entity, usize>,
}

impl BetweenBodies<'_> {
    /// A body in the state that was given, or in that of the world.
    fn end(&self, entity: Entity) -> Option<End> {
        let body = self.world.entity(entity).ok()?;
        let index = self.places.get(&entity).copied();
        if let Some(state) = index.and_then(|index| self.states.get(index)) {
            let (constants, _) = moving_body(body)?;
            return Some(End::of(&constants, state, index));
        }
        if let Some((constants, state)) = moving_body(body) {
            return Some(End::of(&constants, &state, None));
        }
        let pose = *body.get::<&Pose>()?;
        let velocity = body.get::<&Velocity>().map_or(Velocity::default(), |velocity| *velocity);
        Some(End {
            position: dvec3(pose.position),
            orientation: dquat(pose.orientation).normalize(),
            linear_velocity: dvec3(velocity.linear),
            angular_velocity: dvec3(velocity.angular),
            index,
        })
    }

    fn add_spring(&self, spring: &Spring, pulls: &mut [Pull]) {
        if !spring.bodies.iter().any(|entity| self.places.contains_key(entity)) {
            return;
        }
        let [a, b] = spring.bodies.map(|entity| self.end(entity));
        let (Some(a), Some(b)) = (a, b) else { return };
        if spring.bodies[0] == spring.bodies[1] {
            return;
        }
        let arms = [a.orientation * dvec3(spring.attachments[0]), b.orientation * dvec3(spring.attachments[1])];
        let between = (b.position - a.position) + (arms[1] - arms[0]);
        let (length, direction) = (between.length(), between.normalize_or_zero());
        let velocity = |end: &End, arm: DVec3| end.linear_velocity + end.angular_velocity.cross(arm);
        let speed = direction.dot(velocity(&b, arms[1]) - velocity(&a, arms[0]));
        let elastic = f64::from(spring.stiffness) * (length - f64::from(spring.rest_length));
        let on_a = direction * (elastic + f64::from(spring.damping) * speed);
        for (end, arm, force) in [(a, arms[0], on_a), (b, arms[1], -on_a)] {
            if let Some(Pull { springs, .. }) = end.index.and_then(|index| pulls.get_mut(index)) {
                springs.force += force;
                springs.torque += arm.cross(force);
            }
        }
    }

    /// `F_i = M_i sum mu_j r/(r^2 + e_i^2 + e_j^2)^(3/2)`.
    fn add_gravity(&self, pulls: &mut [Pull]) {
        let mut query = self.world.query::<(Entity, &GravityMass, Option<&Mass>, Option<&Momentum>)>();
        let all: Vec<(End, GravityMass, f64)> = query
            .iter()
            .filter_map(|(entity, gravity, mass, momentum)| {
                let mass = mass.filter(|_| momentum.is_some()).map_or(0.0, |mass| f64::from(mass.kilograms()));
                Some((self.end(entity)?, *gravity, mass))
            })
            .collect();
        for (i, (end, gravity, mass)) in all.iter().enumerate() {
            let Some(pull) = end.index.and_then(|index| pulls.get_mut(index)) else { continue };
            for (_, (other, by, _)) in all.iter().enumerate().filter(|(j, _)| *j != i) {
                let r = other.position - end.position;
                let softening = f64::from(gravity.softening).powi(2) + f64::from(by.softening).powi(2);
                let square = r.length_squared() + softening;
                if square > 0.0 {
                    pull.gravity.force += r * (mass * f64::from(by.mu) / (square * square.sqrt()));
                }
            }
        }
    }
}
