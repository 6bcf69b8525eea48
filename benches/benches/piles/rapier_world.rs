//! The benchmark scenes rebuilt in Rapier, with sleeping disabled, as a reference engine.

#![allow(
    clippy::unnecessary_cast,
    clippy::useless_conversion,
    reason = "Rapier is in single precision, Real in that of the build"
)]

use hecs::World;
use rapier3d::prelude as rapier;
use tumble::math::Vec3;
use tumble::{BodyId, Momentum, Pose, Settings, Velocity};
use tumble_benches::{FRICTION, PileShape};

use crate::{Places, RunStatus};

/// The same bodies in Rapier, which never sleep. Steps run in the pool of the caller, as ours do.
pub(crate) struct Peer {
    world: rapier::PhysicsWorld,
    bodies: Vec<rapier::RigidBodyHandle>,
}

impl Peer {
    pub(crate) fn new(ours: &World, settings: &Settings) -> RunStatus<Option<Self>> {
        let mut world = rapier::PhysicsWorld::new();
        world.gravity = vector(settings.gravity);
        world.integration_parameters.dt = settings.dt as f32;
        type Parts<'a> = (&'a BodyId, &'a Pose, &'a PileShape, Option<(&'a Momentum, &'a Velocity)>);
        let mut bodies = ours.query::<Parts<'_>>();
        let mut bodies: Vec<_> = bodies.iter().collect();
        bodies.sort_by_key(|(id, ..)| **id);
        let mut handles = Vec::new();
        for (_, pose, shape, moving) in bodies {
            let collider = match shape {
                PileShape::Box(half_extents) => {
                    let [x, y, z] = half_extents.to_array().map(|x| x as f32);
                    rapier::ColliderBuilder::cuboid(x, y, z)
                }
                PileShape::Ball(radius) => rapier::ColliderBuilder::ball(*radius as f32),
            };
            let collider = collider.friction(FRICTION as f32);
            let (body, collider) = match moving {
                Some((_, velocity)) => (
                    rapier::RigidBodyBuilder::dynamic().angvel(vector(velocity.angular)).can_sleep(false),
                    collider.mass(1.0),
                ),
                None => (rapier::RigidBodyBuilder::fixed(), collider),
            };
            let (handle, _) = world.insert(body.translation(vector(pose.position)), collider);
            if moving.is_some() {
                handles.push(handle);
            }
        }
        Ok(Some(Self { world, bodies: handles }))
    }

    pub(crate) fn step(&mut self) {
        self.world.step();
    }

    pub(crate) fn places(&self) -> Places {
        let place = |body: &rapier::RigidBodyHandle| self.world.bodies[*body].translation().to_array().map(f64::from);
        self.bodies.iter().map(place).collect()
    }
}

fn vector(v: Vec3) -> rapier::Vector {
    let [x, y, z] = v.to_array().map(|x| x as f32);
    rapier::Vector::new(x, y, z)
}
