//! The bodies of a world in Rapier.

use hecs::World;
use rapier3d::prelude as rapier;
use tumble::math::{Real, Vec3};
use tumble::{BodyId, Collider, Inertia, Mass, Momentum, Pose, Settings, Shape, Velocity};
use tumble_import::Appearance;

use crate::compare::mean;

/// A world of Rapier, in single precision.
pub(crate) struct RapierWorld(rapier::PhysicsWorld);

/// What Rapier has no counterpart of here.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Unmatched {
    #[error(
        "body {body} has a shape that is compared with nothing: balls, boxes, capsules, cylinders and half-spaces are"
    )]
    Shape { body: u64 },
    #[error("joints are not compared")]
    Joints,
}

impl RapierWorld {
    /// The bodies of our world with the same masses, moments, poses, velocities, friction and
    /// restitution; without colliders where they have none.
    pub(crate) fn of(world: &World, appearance: &[Appearance], settings: &Settings) -> Result<Self, Unmatched> {
        if world.query::<&tumble::Joint>().iter().next().is_some() {
            return Err(Unmatched::Joints);
        }
        let mut theirs = rapier::PhysicsWorld::new();
        theirs.gravity = vector(settings.gravity);
        theirs.integration_parameters.dt = single(settings.dt);
        type Parts<'a> = (
            &'a BodyId,
            &'a Pose,
            Option<&'a Collider>,
            Option<&'a Velocity>,
            Option<(&'a Mass, &'a Momentum)>,
            Option<&'a Inertia>,
        );
        let mut bodies = world.query::<Parts<'_>>();
        let mut bodies: Vec<_> = bodies.iter().collect();
        bodies.sort_by_key(|(id, ..)| **id);
        for (id, pose, collider, velocity, moving, inertia) in bodies {
            let body = match moving {
                Some((mass, _)) => {
                    let moments = vector(inertia.map_or(Vec3::ZERO, Inertia::moments));
                    let properties = rapier::MassProperties::new(vector(Vec3::ZERO), single(mass.kilograms()), moments);
                    rapier::RigidBodyBuilder::dynamic().can_sleep(false).additional_mass_properties(properties)
                }
                None if velocity.is_some() => rapier::RigidBodyBuilder::kinematic_velocity_based(),
                None => rapier::RigidBodyBuilder::fixed(),
            };
            let [x, y, z, w] = pose.orientation.to_array().map(single);
            let place = rapier::Pose::from_parts(vector(pose.position), rapier::Rotation::from_xyzw(x, y, z, w));
            let Velocity { linear, angular } = velocity.copied().unwrap_or_default();
            let body = body.pose(place).linvel(vector(linear)).angvel(vector(angular));
            let Some(collider) = collider else {
                theirs.insert_body(body);
                continue;
            };
            let look = usize::try_from(id.0).ok().and_then(|index| appearance.get(index));
            let shape = look.and_then(shape).ok_or(Unmatched::Shape { body: id.0 })?;
            let material = collider.material();
            let shape = shape.friction(single(material.dynamic_friction)).restitution(single(material.restitution));
            // The mass is the body's.
            theirs.insert(body, shape.density(0.0));
        }
        Ok(Self(theirs))
    }

    pub(crate) fn step(&mut self) {
        self.0.step();
    }

    /// Of the bodies that move \[m\].
    pub(crate) fn mean_height(&self) -> f64 {
        let moving = self.0.bodies.iter().filter(|(_, body)| body.is_dynamic());
        mean(moving.map(|(_, body)| f64::from(body.translation().y)))
    }
}

/// Of shapes with their centre of mass in the middle.
fn shape(look: &Appearance) -> Option<rapier::ColliderBuilder> {
    let narrow = |number: f64| number as f32;
    Some(match look {
        Appearance::HalfSpace => rapier::ColliderBuilder::new(rapier::SharedShape::halfspace(rapier::Vector::Y)),
        Appearance::Shape(Shape::Sphere { radius }) => rapier::ColliderBuilder::ball(narrow(*radius)),
        Appearance::Shape(Shape::Cuboid { half_extents }) => {
            let [x, y, z] = half_extents.to_array().map(narrow);
            rapier::ColliderBuilder::cuboid(x, y, z)
        }
        Appearance::Shape(Shape::Capsule { radius, half_height }) => {
            rapier::ColliderBuilder::capsule_y(narrow(*half_height), narrow(*radius))
        }
        Appearance::Shape(Shape::Cylinder { radius, half_height }) => {
            rapier::ColliderBuilder::cylinder(narrow(*half_height), narrow(*radius))
        }
        _ => return None,
    })
}

#[allow(clippy::unnecessary_cast, reason = "Rapier is in single precision, Real in that of the build")]
fn single(number: Real) -> f32 {
    number as f32
}

fn vector(v: Vec3) -> rapier::Vector {
    let [x, y, z] = v.to_array().map(single);
    rapier::Vector::new(x, y, z)
}
