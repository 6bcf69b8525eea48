//! Welding of several bodies into one that conserves linear and angular momentum.

use glam::DVec3;
use hecs::{Entity, EntityRef, World};
use tumble_math::{InertiaTensor, MassProperties, MovingBody, WeldedBody, change_of_basis};

use crate::body::body_error::BodyError;
use crate::body::bundle::Body;
use crate::components::{
    BodyId, CenterOfMass, Damping, GravityScale, Inertia, Mass, Momentum, Pose, PreviousPose, PrincipalAxes, Wrench,
};
use crate::math::{Vec3, dquat, dvec3, quat, vec3};

/// Why bodies cannot be welded.
///
/// ```
/// # use tumble::{WeldError, weld};
/// assert_eq!(weld(&hecs::World::new(), &[]).unwrap_err(), WeldError::NoBodies);
/// ```
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WeldError {
    /// There is no body to weld.
    #[error("there is no body to weld")]
    NoBodies,
    /// The same entity is there twice.
    #[error("{entity:?} is there twice")]
    Duplicate {
        /// The entity.
        entity: Entity,
    },
    /// There is no such entity in the world.
    #[error("{entity:?} is not in the world")]
    Missing {
        /// The entity.
        entity: Entity,
    },
    /// The entity is no dynamic body, but fixed, kinematic or no body at all: it has not all of
    /// [`Pose`], [`Momentum`] and [`Mass`].
    #[error("{entity:?} is no body that forces move: it lacks a {lacks}")]
    Immovable {
        /// The entity.
        entity: Entity,
        /// `"Pose"`, `"Momentum"` or `"Mass"`.
        lacks: &'static str,
    },
    /// The state or the inertia of a body is not finite, or is impossible.
    #[error("{entity:?}: {source}")]
    Impossible {
        /// The entity.
        entity: Entity,
        /// What is wrong with it.
        source: BodyError,
    },
    /// What would come of it is no body: too heavy or too far out for the precision of the build,
    /// or without inertia about some axis, as points in a row are.
    #[error("the bodies together: {0}")]
    Together(BodyError),
}

tumble_math::debug_as_display!(WeldError);

/// The body that the bodies of these entities make together once they are fixed to each other as
/// they are now: ready to be spawned, in the place of the others. The world is not changed.
///
/// Linear and angular momentum are those of all together, to the rounding of the build's precision;
/// energy is lost in general ([`tumble_math::weld`] has the equations, and how much). The frame is
/// that of the first entity, whose [`BodyId`], [`GravityScale`] and [`Damping`] it takes over, and
/// whether it has a [`PreviousPose`]; forces and what else is on the entities is left to the
/// caller.
///
/// It has no [`Collider`](crate::Collider): give it one with
/// [`spawn_with`](Body::spawn_with). Bodies without [`Inertia`] count as points, and do not turn.
///
/// ```
/// use tumble::{prelude::*, weld};
///
/// let mut world = hecs::World::new();
/// let ball = |y: Real, v: Real| {
///     RigidBody::new(Shape::sphere(0.1))
///         .mass(2.0)
///         .position(Vec3::Y * y)
///         .linear_velocity(Vec3::X * v)
///         .build()
/// };
/// // Two balls catch each other in passing, and turn about their middle.
/// let balls = [ball(1.0, 1.0)?.spawn(&mut world), ball(-1.0, -1.0)?.spawn(&mut world)];
/// let pair = weld(&world, &balls)?;
/// for ball in balls {
///     world.despawn(ball)?;
/// }
/// let pair = pair.spawn(&mut world);
/// assert_eq!(world.get::<&Pose>(pair)?.position, Vec3::ZERO);
/// let momentum = *world.get::<&Momentum>(pair)?;
/// assert_eq!((momentum.linear, momentum.angular), (Vec3::ZERO, Vec3::Z * -4.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`WeldError`] names the entity that is there twice, gone, or no dynamic body.
pub fn weld(world: &World, entities: &[Entity]) -> Result<Body, WeldError> {
    let first = *entities.first().ok_or(WeldError::NoBodies)?;
    check_unique(entities)?;
    let mut bodies = Vec::with_capacity(entities.len());
    for &entity in entities {
        bodies.push(moving_body(reference(world, entity)?)?);
    }
    let welded = tumble_math::weld(bodies.iter().copied()).map_err(|error| cause(error, entities))?;
    // The sum of the momenta as they are, not by way of velocities.
    let linear = entities.iter().filter_map(|entity| world.get::<&Momentum>(*entity).ok());
    let linear = linear.map(|momentum| dvec3(momentum.linear)).sum();
    body_in_frame_of(reference(world, first)?, &welded, linear).map_err(WeldError::Together)
}

fn check_unique(entities: &[Entity]) -> Result<(), WeldError> {
    let mut sorted = entities.to_vec();
    sorted.sort_unstable();
    match sorted.windows(2).find(|pair| pair.first() == pair.last()) {
        Some(&[entity, _]) => Err(WeldError::Duplicate { entity }),
        _ => Ok(()),
    }
}

fn reference(world: &World, entity: Entity) -> Result<EntityRef<'_>, WeldError> {
    world.entity(entity).map_err(|_| WeldError::Missing { entity })
}

fn copied<T: hecs::Component + Copy>(body: EntityRef<'_>) -> Option<T> {
    body.get::<&T>().map(|component| *component)
}

fn component<T: hecs::Component + Copy>(body: EntityRef<'_>, lacks: &'static str) -> Result<T, WeldError> {
    copied(body).ok_or(WeldError::Immovable { entity: body.entity(), lacks })
}

/// A body of the world in double precision, in a frame at its centre of mass.
fn moving_body(body: EntityRef<'_>) -> Result<MovingBody, WeldError> {
    let pose: Pose = component(body, "Pose")?;
    let momentum: Momentum = component(body, "Momentum")?;
    let mass: Mass = component(body, "Mass")?;
    let axes: Option<PrincipalAxes> = copied(body);
    let impossible = |source| WeldError::Impossible { entity: body.entity(), source };
    for (field, value) in
        [("position", pose.position), ("momentum.linear", momentum.linear), ("momentum.angular", momentum.angular)]
    {
        if !value.is_finite() {
            return Err(impossible(BodyError::NotFinite { field, value: dvec3(value) }));
        }
    }
    let kilograms = mass.kilograms().into();
    let mut moving = MovingBody {
        properties: MassProperties::point(kilograms, DVec3::ZERO).map_err(|error| impossible(error.into()))?,
        position: dvec3(pose.position),
        orientation: dquat(pose.orientation),
        linear_velocity: dvec3(momentum.linear) / kilograms,
        angular_velocity: DVec3::ZERO,
    };
    if let Some(inertia) = copied::<Inertia>(body) {
        let moments = dvec3(inertia.moments());
        let axes = axes.map_or(glam::DQuat::IDENTITY, |axes| dquat(axes.0));
        let tensor = InertiaTensor::from_principal(moments, axes).map_err(|error| impossible(error.into()))?;
        let properties = MassProperties::new(kilograms, DVec3::ZERO, tensor);
        moving.properties = properties.map_err(|error| impossible(error.into()))?;
        let frame = (moving.orientation * axes).normalize();
        moving.angular_velocity = frame * ((frame.conjugate() * dvec3(momentum.angular)) / moments);
    }
    Ok(moving)
}

/// The error of the mathematics, with the entity for the index.
fn cause(error: tumble_math::WeldError, entities: &[Entity]) -> WeldError {
    let named = |index: usize, source: BodyError| match entities.get(index) {
        Some(&entity) => WeldError::Impossible { entity, source },
        None => WeldError::Together(source),
    };
    match error {
        tumble_math::WeldError::Pose { body, source } => named(body, source.into()),
        tumble_math::WeldError::Velocity { body, field, velocity } => {
            named(body, BodyError::NotFinite { field, value: velocity })
        }
        _ => WeldError::NoBodies,
    }
}

/// The composite in the frame of one of the bodies.
fn body_in_frame_of(frame: EntityRef<'_>, welded: &WeldedBody, linear_momentum: DVec3) -> Result<Body, BodyError> {
    let pose: Pose = copied(frame).unwrap_or_default();
    let orientation = dquat(pose.orientation).normalize();
    let to_frame = orientation.conjugate();
    let offset: Option<CenterOfMass> = copied(frame);
    let origin = dvec3(pose.position) - orientation * offset.map_or(DVec3::ZERO, |offset| dvec3(offset.0));
    let center = to_frame * (welded.properties.center_of_mass() - origin);
    let mass = Mass::new(welded.properties.mass()).map_err(BodyError::MassRange)?;

    let position = finite("position", welded.properties.center_of_mass())?;
    let momentum = Momentum {
        linear: finite("linear_velocity", linear_momentum)?,
        angular: finite("angular_velocity", welded.angular_momentum)?,
    };
    let mut body = Body::at(Pose { position, orientation: pose.orientation });
    body.center_of_mass = Some(CenterOfMass(finite("center_of_mass", center)?)).filter(|c| c.0 != Vec3::ZERO);
    let mut properties = MassProperties::point(welded.properties.mass(), center)?;
    if welded.properties.tensor_about_center() != glam::DMat3::ZERO {
        let tensor = InertiaTensor::new(change_of_basis(welded.properties.tensor_about_center(), to_frame))?;
        let principal = tensor.principal();
        body.inertia = Some(Inertia::new(principal.moments).map_err(BodyError::InertiaRange)?);
        body.axes = (principal.axes != glam::DQuat::IDENTITY).then(|| PrincipalAxes(quat(principal.axes)));
        properties = MassProperties::new(welded.properties.mass(), center, tensor)?;
    }
    body.mass = Some(mass);
    body.momentum = Some(momentum);
    body.wrench = Some(Wrench::default());
    body.gravity_scale = copied::<GravityScale>(frame);
    body.damping = copied::<Damping>(frame);
    body.previous_pose = copied::<PreviousPose>(frame).map(|_| PreviousPose(body.pose));
    body.id = copied::<BodyId>(frame);
    body.properties = Some(properties);
    let (velocity, inverse_inertia) = body.derived(mass, momentum);
    body.velocity = Some(velocity);
    body.inverse_inertia = body.inertia.map(|_| inverse_inertia);
    Ok(body)
}

fn finite(field: &'static str, value: DVec3) -> Result<Vec3, BodyError> {
    let rounded = vec3(value);
    if rounded.is_finite() { Ok(rounded) } else { Err(BodyError::NotFinite { field, value }) }
}
