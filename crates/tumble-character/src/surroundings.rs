//! The world as all characters of a step see it: as it is before any of them moves.

use tumble::hecs::{Entity, Without, World};
use tumble::math::{Real, Vec3};
use tumble::{Collider, IgnoreContacts, InverseInertia, Mass, Momentum, Pose, Queries, Velocity};

use crate::character::Character;
use crate::state::{CharacterInput, CharacterState};
use crate::vectors::{sin_cos, turned, unit};

/// A kinematic body that moves and is no character.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mover {
    pub(crate) entity: Entity,
    pub(crate) position: Vec3,
    pub(crate) velocity: Velocity,
}

/// A body that a character has come up against.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Body {
    /// It stays where it is in this step, as far as is known.
    Still,
    /// It moves as prescribed.
    Kinematic(Mover),
    /// It is pushed.
    Dynamic(Mover),
}

/// Another character.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Other {
    /// The middle line of its capsule.
    pub(crate) spine: [Vec3; 2],
    pub(crate) radius: Real,
    /// How far it may come in the step.
    pub(crate) reach: Real,
}

/// What characters ask about.
pub(crate) struct Surroundings<'a> {
    world: &'a World,
    pub(crate) queries: Queries<'a>,
    pub(crate) movers: Vec<Mover>,
    ignored: Vec<[Entity; 2]>,
    /// Whether there is more than one character.
    pub(crate) has_several: bool,
    /// Acceleration of gravity [m/s^2].
    pub(crate) gravity: Vec3,
    /// Length of the step \[s\].
    pub(crate) dt: Real,
}

/// Kinematic bodies that can be run into.
type Kinematic<'a> = Without<Without<(Entity, &'a Pose, &'a Velocity, &'a Collider), &'a Momentum>, &'a Character>;

impl<'a> Surroundings<'a> {
    pub(crate) fn new(world: &'a World, queries: Queries<'a>, gravity: Vec3, dt: Real) -> Self {
        let moves = |velocity: &Velocity| velocity.linear != Vec3::ZERO || velocity.angular != Vec3::ZERO;
        let mut movers: Vec<_> = world
            .query::<Kinematic<'_>>()
            .iter()
            .filter(|(_, _, velocity, collider)| moves(velocity) && !collider.is_sensor())
            .map(|(entity, pose, velocity, _)| Mover { entity, position: pose.position, velocity: *velocity })
            .collect();
        movers.retain(|it| it.velocity.linear.is_finite() && it.velocity.angular.is_finite());
        let ignored = world.query::<&IgnoreContacts>().iter().map(|it| it.bodies).collect();
        let has_several = world.query::<&Character>().iter().nth(1).is_some();
        Self { world, queries, movers, ignored, has_several, gravity, dt }
    }

    /// The bodies that pass through one.
    pub(crate) fn ignored_by(&self, entity: Entity) -> Vec<Entity> {
        let other = |pair: &[Entity; 2]| match *pair {
            [a, b] if a == entity => Some(b),
            [a, b] if b == entity => Some(a),
            _ => None,
        };
        self.ignored.iter().filter_map(other).collect()
    }

    pub(crate) fn body(&self, entity: Entity) -> Body {
        let Ok(found) = self.world.entity(entity) else { return Body::Still };
        let Some(velocity) = found.get::<&Velocity>().map(|it| *it) else { return Body::Still };
        let Some(pose) = found.get::<&Pose>().map(|it| *it) else { return Body::Still };
        let mover = Mover { entity, position: pose.position, velocity };
        match (found.has::<Momentum>(), found.has::<Character>()) {
            (true, _) => Body::Dynamic(mover),
            (false, true) => Body::Still,
            (false, false) => Body::Kinematic(mover),
        }
    }

    pub(crate) fn other(&self, entity: Entity) -> Option<Other> {
        let found = self.world.entity(entity).ok()?;
        let (character, position) = (found.get::<&Character>()?, found.get::<&Pose>()?.position);
        let (state, input) = (found.get::<&CharacterState>()?, found.get::<&CharacterInput>()?);
        let settings = character.settings();
        let spine = settings.spine(position, state.is_crouching);
        let speed = state.velocity.length().max(input.velocity.length()) + self.gravity.length() * self.dt;
        Some(Other { spine, radius: settings.radius, reach: speed * self.dt })
    }

    pub(crate) fn is_character(&self, entity: Entity) -> bool {
        self.world.satisfies::<&Character>(entity)
    }

    pub(crate) fn collider_of(&self, entity: Entity) -> Option<Collider> {
        self.world.get::<&Collider>(entity).ok().map(|it| (*it).clone())
    }

    /// How little a dynamic body moves when it is pushed at a point along a direction [1/kg].
    pub(crate) fn mobility(&self, entity: Entity, arm: Vec3, direction: Vec3) -> Real {
        let Ok(found) = self.world.entity(entity) else { return 0.0 };
        let inverse_mass = found.get::<&Mass>().map_or(0.0, |mass| 1.0 / mass.kilograms());
        let turning = found.get::<&InverseInertia>().map_or(0.0, |inertia| {
            let lever = arm.cross(direction);
            lever.dot(inertia.to_mat3() * lever)
        });
        inverse_mass + turning.max(0.0)
    }
}

impl Mover {
    /// How far a point of it moves in a time \[s\], as the engine moves it.
    pub(crate) fn way_of(&self, point: Vec3, time: Real) -> Vec3 {
        let straight = self.velocity.linear * time;
        let Some(axis) = unit(self.velocity.angular) else { return straight };
        let arm = point - self.position;
        straight + turned(arm, axis, self.velocity.angular.dot(axis) * time) - arm
    }

    /// An upper bound of how far any point at this distance from a place moves in a time \[s\].
    pub(crate) fn reach(&self, place: Vec3, radius: Real, time: Real) -> Real {
        let angle = (self.velocity.angular.length() * time).min(3.2);
        let arm = (place - self.position).length() + radius;
        let chord = 2.0 * sin_cos((angle * 0.5).min(1.6)).0 * arm;
        self.velocity.linear.length() * time + chord
    }
}
