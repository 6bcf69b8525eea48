//! Validated bodies: their components, and how they are spawned into a world.

use hecs::{DynamicBundle, Entity, EntityBuilder, World};
use tumble_math::MassProperties;

use crate::collision::collider::Collider;
use crate::components::{
    BodyId, CenterOfMass, Damping, GravityScale, Inertia, InverseInertia, Mass, Momentum, Pose, PreviousPose,
    PrincipalAxes, Velocity, Wrench,
};
use crate::integrators::derived::derived;
use crate::integrators::state::{Constants, Moments, State};

/// The components of a dynamic body without optional ones.
type Plain = (Pose, Momentum, Mass, Inertia, Wrench, Velocity, InverseInertia);
type PlainWithId = (Pose, Momentum, Mass, Inertia, Wrench, Velocity, InverseInertia, BodyId);
type PlainWithCollider = (Pose, Momentum, Mass, Inertia, Wrench, Velocity, InverseInertia, Collider);
type PlainWithBoth = (Pose, Momentum, Mass, Inertia, Wrench, Velocity, InverseInertia, BodyId, Collider);

/// The components of a body that [`RigidBody::build`](crate::RigidBody::build) has checked, ready
/// to be spawned any number of times.
///
/// ```
/// # use tumble::prelude::*;
/// # let mut world = hecs::World::new();
/// let brick = RigidBody::new(Shape::cuboid([0.1, 0.05, 0.03])).mass(2.0).build()?;
/// let (one, another) = (brick.spawn(&mut world), brick.spawn(&mut world));
/// assert_ne!(one, another);
/// assert_eq!(brick.properties().map(|properties| properties.mass()), Some(2.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
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
    pub(crate) collider: Option<Collider>,
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
            collider: None,
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

    /// Mass \[kg\], centre of mass \[m\] and inertia [kg m^2] in double precision, in the body's
    /// own frame; `None` for a fixed or kinematic body.
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
        fn add<T: hecs::Component + Clone>(entity: &mut EntityBuilder, component: Option<T>) {
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
        add(entity, self.collider.clone());
    }

    /// Spawns an entity with the body's components. Many at once come much sooner from
    /// [`spawn_copies`](Self::spawn_copies) and [`spawn_bodies`](crate::spawn_bodies()).
    pub fn spawn(&self, world: &mut World) -> Entity {
        // hecs knows the archetype of a tuple at once, and has to look for that of an
        // `EntityBuilder`.
        match (self.as_tuple(), self.id, self.collider.clone()) {
            (Some(plain), None, None) => world.spawn(plain),
            (Some((a, b, c, d, e, f, g)), Some(id), None) => world.spawn((a, b, c, d, e, f, g, id)),
            (Some((a, b, c, d, e, f, g)), None, Some(collider)) => world.spawn((a, b, c, d, e, f, g, collider)),
            (Some((a, b, c, d, e, f, g)), Some(id), Some(collider)) => world.spawn((a, b, c, d, e, f, g, id, collider)),
            (None, ..) => {
                let mut entity = EntityBuilder::new();
                self.insert_into(&mut entity);
                world.spawn(entity.build())
            }
        }
    }

    /// Spawns an entity with the body's components and the caller's own beside them; where both
    /// have a component, such as a [`Collider`], it is the caller's.
    ///
    /// ```
    /// # use tumble::prelude::*;
    /// struct Health(u32);
    /// # let mut world = hecs::World::new();
    /// let barrel = RigidBody::new(Shape::cylinder(0.3, 0.5)).mass(40.0).build()?;
    /// let entity = barrel.spawn_with(&mut world, (Health(3),));
    /// assert_eq!(world.get::<&Health>(entity)?.0, 3);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn spawn_with(&self, world: &mut World, own: impl DynamicBundle) -> Entity {
        let mut entity = EntityBuilder::new();
        self.insert_into(&mut entity);
        entity.add_bundle(own);
        world.spawn(entity.build())
    }

    /// The same with another identity, or none: [`weld`](crate::weld()) leaves that of the
    /// first body, and two bodies with one id are one to a [`Snapshot`](crate::Snapshot).
    ///
    /// ```
    /// # use tumble::{prelude::*, weld};
    /// # let mut world = hecs::World::new();
    /// let ball = |id, x: Real| {
    ///     RigidBody::new(Shape::sphere(0.5))
    ///         .mass(1.0)
    ///         .position(Vec3::X * x)
    ///         .id(BodyId(id))
    ///         .build()
    /// };
    /// let balls = [ball(1, 0.0)?.spawn(&mut world), ball(2, 1.0)?.spawn(&mut world)];
    /// let pair = weld(&world, &balls)?.with_id(Some(BodyId(3)));
    /// assert_eq!(pair.pose().position, Vec3::X * 0.5);
    /// let pair = pair.spawn(&mut world);
    /// assert_eq!(*world.get::<&BodyId>(pair)?, BodyId(3));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn with_id(self, id: Option<BodyId>) -> Self {
        Self { id, ..self }
    }

    /// Where it will be spawned: its centre of mass, and its orientation.
    pub fn pose(&self) -> Pose {
        self.pose
    }

    /// Makes room in the world for more bodies of this kind, where hecs lets us: of the kind that
    /// most are.
    pub(crate) fn reserve(&self, world: &mut World, additional: u32) {
        match (self.as_tuple(), self.id, &self.collider) {
            (Some(_), None, None) => world.reserve::<Plain>(additional),
            (Some(_), Some(_), None) => world.reserve::<PlainWithId>(additional),
            (Some(_), None, Some(_)) => world.reserve::<PlainWithCollider>(additional),
            (Some(_), Some(_), Some(_)) => world.reserve::<PlainWithBoth>(additional),
            (None, ..) => {}
        }
    }

    /// The components of a body that has nothing but what most have, without its id and collider.
    fn as_tuple(&self) -> Option<Plain> {
        let plain = self.axes.is_none()
            && self.center_of_mass.is_none()
            && self.gravity_scale.is_none()
            && self.damping.is_none()
            && self.previous_pose.is_none();
        if !plain {
            return None;
        }
        Some((
            self.pose,
            self.momentum?,
            self.mass?,
            self.inertia?,
            self.wrench?,
            self.velocity?,
            self.inverse_inertia?,
        ))
    }
}
