//! Warnings of silent mistakes, once per kind and in debug builds alone: a velocity that nothing
//! reads, a body that everything passes through, colliders that do not meet.

use std::collections::{BTreeSet, HashMap};

use hecs::{Entity, World};

use crate::collision::collider::Collider;
use crate::collision::collider_shape::ColliderShape;
use crate::components::{Inertia, InverseInertia, Mass, Momentum, Velocity};
use crate::integrators::derived::derived;
use crate::integrators::state::moving_body;
use crate::math::Real;

/// What a warning is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Mistake {
    WrittenVelocity,
    NoCollider,
    SurfaceOnSurface,
    MovingHalfSpace,
}

/// Which warnings were given, and the velocities that the last step left.
#[derive(Clone, Debug, Default)]
pub(crate) struct Mistakes {
    told: BTreeSet<Mistake>,
    velocities: HashMap<Entity, Velocity>,
}

impl Mistakes {
    /// Before a step: warns of what the caller did since the last.
    pub(crate) fn warn(&mut self, world: &World) {
        if !cfg!(debug_assertions) {
            return;
        }
        self.once(Mistake::WrittenVelocity, |it| {
            let entity = it.written_velocity(world)?;
            Some(format!(
                "entity {entity:?}: its Velocity was written, which a step overwrites: the state of a body with \
                 Momentum is its Momentum; call set_velocity"
            ))
        });
        self.once(Mistake::NoCollider, |_| {
            let entity = without_collider(world)?;
            Some(format!("entity {entity:?} has no Collider: everything passes through it"))
        });
        self.once(Mistake::SurfaceOnSurface, |_| {
            let [first, second] = surfaces(world)?;
            Some(format!(
                "entities {first:?} and {second:?} are meshes or height fields, which do not touch each other: what \
                 moves needs a solid, such as a convex hull"
            ))
        });
        self.once(Mistake::MovingHalfSpace, |_| {
            let entity = moving_half_space(world)?;
            Some(format!("entity {entity:?} has Momentum and a half-space as its Collider, which is for fixed ground"))
        });
    }

    /// After a step: what velocities it left.
    pub(crate) fn remember(&mut self, world: &World) {
        self.velocities.clear();
        if cfg!(debug_assertions) && !self.told.contains(&Mistake::WrittenVelocity) {
            let mut bodies = world.query::<(Entity, &Velocity)>().with::<&Momentum>();
            self.velocities.extend(bodies.iter().map(|(entity, velocity)| (entity, *velocity)));
        }
    }

    fn once(&mut self, mistake: Mistake, text: impl FnOnce(&Self) -> Option<String>) {
        if self.told.contains(&mistake) {
            return;
        }
        if let Some(text) = text(self) {
            tracing::warn!("{text}");
            self.told.insert(mistake);
        }
    }

    /// A dynamic body whose velocity is neither what the last step left nor that of its momentum.
    fn written_velocity(&self, world: &World) -> Option<Entity> {
        let mut bodies = world.query::<(Entity, &Velocity, &Momentum)>().with::<&Mass>();
        let written = bodies.iter().find(|(entity, velocity, momentum)| {
            let is_left = match self.velocities.get(entity) {
                Some(left) => left == *velocity,
                None => **velocity == Velocity::default() || **momentum != Momentum::default(),
            };
            !is_left && !is_derived(world, *entity, velocity)
        });
        written.map(|(entity, ..)| entity)
    }
}

/// Whether a velocity is that of the body's momentum, to a thousandth.
fn is_derived(world: &World, entity: Entity, velocity: &Velocity) -> bool {
    let Some((constants, state)) = world.entity(entity).ok().and_then(moving_body) else { return true };
    let (own, _) = <(Velocity, InverseInertia)>::from(derived(&constants, &state));
    let near = |a: crate::math::Vec3, b: crate::math::Vec3| {
        let tolerance: Real = 1e-3;
        (a - b).length() <= tolerance * a.length().max(b.length())
    };
    near(own.linear, velocity.linear) && near(own.angular, velocity.angular)
}

/// A dynamic body of some extent without a collider, in a world where others have one.
fn without_collider(world: &World) -> Option<Entity> {
    world.query::<&Collider>().iter().next()?;
    world.query::<Entity>().with::<(&Momentum, &Mass, &Inertia)>().without::<&Collider>().iter().next()
}

/// A dynamic body that is a surface, and another surface.
fn surfaces(world: &World) -> Option<[Entity; 2]> {
    let is_surface = |(_, collider): &(Entity, &Collider)| {
        matches!(collider.geometry(), ColliderShape::Mesh(_) | ColliderShape::HeightField(_))
    };
    let mut moving = world.query::<(Entity, &Collider)>().with::<&Momentum>();
    let (moving, _) = moving.iter().find(is_surface)?;
    let mut all = world.query::<(Entity, &Collider)>();
    let other = all.iter().filter(is_surface).find(|(other, _)| *other != moving);
    other.map(|(other, _)| [moving, other])
}

fn moving_half_space(world: &World) -> Option<Entity> {
    let mut moving = world.query::<(Entity, &Collider)>().with::<&Momentum>();
    let found = moving.iter().find(|(_, collider)| matches!(collider.geometry(), ColliderShape::HalfSpace));
    found.map(|(entity, _)| entity)
}
