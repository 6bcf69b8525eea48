use hecs::{Entity, EntityBuilder, World};
use tumble_math::MassProperties;

use crate::components::{
    BodyId, CenterOfMass, Damping, GravityScale, Inertia, InverseInertia, Mass, Momentum, Pose, PreviousPose,
    PrincipalAxes, Velocity, Wrench,
};
use crate::derived::derived;
use crate::state::{Constants, Moments, State};

/// The components of a body that [`RigidBody::build`](crate::RigidBody::build) has checked, ready to be spawned any number of times.
#[derive(Clone, Debug)]
pub struct Body {
    pub(crate) pose: Pose,
    pub(crate) momentum: Option<Momentum>,
    pub(crate) mass: Option<Mass>,
    pub(crate) inertia: Option<Inertia>,
    pub(crate) axes: Option<PrincipalAxes>,
    pub(crate) center_of_mass: Option<CenterOfMass>,
    pub(crate) wrench: Option<Wrench>,
    pub(crate) velocity: Option<Velocity>,
    pub(crate) inverse_inertia: Option<InverseInertia>,
    pub(crate) gravity_scale: Option<GravityScale>,
    pub(crate) damping: Option<Damping>,
    pub(crate) previous_pose: Option<PreviousPose>,
    pub(crate) id: Option<BodyId>,
    pub(crate) properties: Option<MassProperties>,
}

impl Body {
    /// A body that does not move.
    pub(crate) fn at(pose: Pose) -> Self {
        Self {
            pose,
            momentum: None,
            mass: None,
            inertia: None,
            axes: None,
            center_of_mass: None,
            wrench: None,
            velocity: None,
            inverse_inertia: None,
            gravity_scale: None,
            damping: None,
            previous_pose: None,
            id: None,
            properties: None,
        }
    }

    /// The derived quantities at the start.
    pub(crate) fn derived(&self, mass: Mass, momentum: Momentum) -> (Velocity, InverseInertia) {
        let constants = Constants {
            mass: mass.kilograms(),
            inertia: self.inertia.map(|inertia| Moments::new(&inertia, self.axes.as_ref())),
            damping: None,
        };
        derived(&constants, &State::new(&self.pose, &momentum)).into()
    }

    /// Mass, centre of mass and inertia in double precision, in the body's own frame; `None` for a body that forces do not move.
    pub fn properties(&self) -> Option<&MassProperties> {
        self.properties.as_ref()
    }

    /// Adds the body's components to an entity being built, beside the caller's own.
    ///
    /// ```
    /// # use tumble::prelude::*;
    /// struct Health(u32);
    /// let mut world = hecs::World::new();
    /// let mut entity = hecs::EntityBuilder::new();
    /// RigidBody::new(Shape::sphere(0.5)).mass(1.0).build()?.insert_into(&mut entity);
    /// entity.add(Health(3));
    /// world.spawn(entity.build());
    /// # Ok::<(), tumble::BodyError>(())
    /// ```
    pub fn insert_into(&self, entity: &mut EntityBuilder) {
        fn add<T: hecs::Component + Copy>(entity: &mut EntityBuilder, component: Option<T>) {
            if let Some(component) = component {
                entity.add(component);
            }
        }
        entity.add(self.pose);
        add(entity, self.momentum);
        add(entity, self.mass);
        add(entity, self.inertia);
        add(entity, self.axes);
        add(entity, self.center_of_mass);
        add(entity, self.wrench);
        add(entity, self.velocity);
        add(entity, self.inverse_inertia);
        add(entity, self.gravity_scale);
        add(entity, self.damping);
        add(entity, self.previous_pose);
        add(entity, self.id);
    }

    /// Spawns an entity with the body's components.
    pub fn spawn(&self, world: &mut World) -> Entity {
        let mut entity = EntityBuilder::new();
        self.insert_into(&mut entity);
        world.spawn(entity.build())
    }
}
