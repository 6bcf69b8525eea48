//! Velocities of bodies that are already in a world.

use hecs::{Component, Entity, EntityRef, World};

use crate::body::body_error::BodyError;
use crate::body::rigid_body::{finite, within};
use crate::components::{Inertia, InverseInertia, Mass, Momentum, Pose, PrincipalAxes, Velocity};
use crate::integrators::derived::derived;
use crate::integrators::state::moving_body;
use crate::math::{Vec3, dquat, dvec3, vec3};
use crate::range::MAX_SPEED;

/// Why a body keeps the velocity that it has.
///
/// ```
/// use tumble::{VelocityError, prelude::*};
///
/// let mut world = hecs::World::new();
/// let ground = spawn_ground(&mut world);
/// let error = set_linear_velocity(&mut world, ground, Vec3::X).unwrap_err();
/// assert_eq!(error, VelocityError::Lacks { entity: ground, component: "Momentum" });
/// assert_eq!(error.to_string(), "entity 0v1 has no Momentum: it is no body that moves");
/// ```
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum VelocityError {
    /// There is no such entity in the world.
    #[error("{entity:?} is not in the world")]
    Missing {
        /// The entity.
        entity: Entity,
    },
    /// The entity is a fixed body, or no body.
    #[error("entity {entity:?} has no {component}: it is no body that moves")]
    Lacks {
        /// The entity.
        entity: Entity,
        /// `"Momentum"`, `"Mass"` or `"Pose"`.
        component: &'static str,
    },
    /// No body can have this velocity, or not this one.
    #[error("entity {entity:?}: {source}")]
    Impossible {
        /// The entity.
        entity: Entity,
        /// What is wrong with the velocity.
        source: BodyError,
    },
}

tumble_math::debug_as_display!(VelocityError);

/// Gives a body another velocity of its centre of mass [m/s], in the world frame. Its angular
/// velocity stays.
///
/// The state of a dynamic body is its [`Momentum`]: that is set, and the [`Velocity`] with it. Of a
/// kinematic body it is the `Velocity`.
///
/// ```
/// use tumble::prelude::*;
///
/// let mut world = hecs::World::new();
/// let ball = RigidBody::new(Shape::sphere(0.1)).mass(2.0).build()?.spawn(&mut world);
/// set_linear_velocity(&mut world, ball, Vec3::X * 3.0)?;
/// assert_eq!(world.get::<&Momentum>(ball)?.linear, Vec3::X * 6.0);
/// assert_eq!(world.get::<&Velocity>(ball)?.linear, Vec3::X * 3.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`VelocityError`] names the entity and what it lacks, or the velocity that is not finite or over
/// 1e9 m/s along an axis.
#[doc(alias("set_linvel", "set_velocity", "SetVelocity"))]
pub fn set_linear_velocity(world: &mut World, entity: Entity, linear: Vec3) -> Result<(), VelocityError> {
    set(world, entity, Some(linear), None)
}

/// Gives a body another angular velocity [rad/s], in the world frame. The velocity of its centre of
/// mass stays. What is set is as of [`set_linear_velocity`].
///
/// ```
/// use tumble::prelude::*;
///
/// let mut world = hecs::World::new();
/// let plank = RigidBody::new(Shape::cuboid([1.0, 0.1, 0.2])).mass(2.0).build()?;
/// let plank = plank.spawn(&mut world);
/// set_angular_velocity(&mut world, plank, Vec3::new(1.0, 2.0, 3.0))?;
/// let velocity = *world.get::<&Velocity>(plank)?;
/// assert!((velocity.angular - Vec3::new(1.0, 2.0, 3.0)).length() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As of [`set_linear_velocity`]; and a point mass, having no inertia, cannot turn.
#[doc(alias("set_angvel", "spin"))]
pub fn set_angular_velocity(world: &mut World, entity: Entity, angular: Vec3) -> Result<(), VelocityError> {
    set(world, entity, None, Some(angular))
}

/// Gives a body another velocity and angular velocity at once, as [`set_linear_velocity`] and
/// [`set_angular_velocity`] do.
///
/// ```
/// use tumble::prelude::*;
///
/// let mut world = hecs::World::new();
/// let ball = RigidBody::new(Shape::sphere(0.1)).mass(2.0).linear_velocity(Vec3::X).build()?;
/// let ball = ball.spawn(&mut world);
/// set_velocity(&mut world, ball, Velocity::default())?; // stop
/// assert_eq!(*world.get::<&Momentum>(ball)?, Momentum::default());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As of [`set_linear_velocity`] and [`set_angular_velocity`]; the body is as it was.
pub fn set_velocity(world: &mut World, entity: Entity, velocity: Velocity) -> Result<(), VelocityError> {
    set(world, entity, Some(velocity.linear), Some(velocity.angular))
}

fn set(world: &mut World, entity: Entity, linear: Option<Vec3>, angular: Option<Vec3>) -> Result<(), VelocityError> {
    let body = world.entity(entity).map_err(|_| VelocityError::Missing { entity })?;
    let impossible = |source| VelocityError::Impossible { entity, source };
    for (field, value) in [("linear_velocity", linear), ("angular_velocity", angular)] {
        value.map_or(Ok(()), |value| within(field, value, MAX_SPEED)).map_err(impossible)?;
    }
    if !body.has::<Momentum>() {
        let Some(mut velocity) = body.get::<&mut Velocity>() else {
            return Err(VelocityError::Lacks { entity, component: "Momentum" });
        };
        velocity.linear = linear.unwrap_or(velocity.linear);
        velocity.angular = angular.unwrap_or(velocity.angular);
        return Ok(());
    }
    let mut momentum: Momentum = component(body, "Momentum")?;
    if let Some(linear) = linear {
        let mass: Mass = component(body, "Mass")?;
        let wanted = dvec3(linear) * f64::from(mass.kilograms());
        momentum.linear = finite("linear_velocity", vec3(wanted)).map_err(impossible)?;
    }
    if let Some(angular) = angular {
        momentum.angular = angular_momentum(body, angular)?;
    }
    write(body, momentum);
    Ok(())
}

fn component<T: Component + Copy>(body: EntityRef<'_>, component: &'static str) -> Result<T, VelocityError> {
    let found = body.get::<&T>().map(|found| *found);
    found.ok_or(VelocityError::Lacks { entity: body.entity(), component })
}

/// The angular momentum that a dynamic body has at an angular velocity.
fn angular_momentum(body: EntityRef<'_>, angular: Vec3) -> Result<Vec3, VelocityError> {
    let impossible = |source| VelocityError::Impossible { entity: body.entity(), source };
    let pose: Pose = component(body, "Pose")?;
    let Some(inertia) = body.get::<&Inertia>() else {
        let is_still = angular == Vec3::ZERO;
        return if is_still { Ok(Vec3::ZERO) } else { Err(impossible(BodyError::SpinningPoint)) };
    };
    let axes = body.get::<&PrincipalAxes>().map_or(glam::DQuat::IDENTITY, |axes| dquat(axes.0));
    let frame = (dquat(pose.orientation) * axes).normalize();
    let spin = frame.conjugate() * dvec3(angular);
    finite("angular_velocity", vec3(frame * (dvec3(inertia.moments()) * spin))).map_err(impossible)
}

/// Writes the momentum of a dynamic body, and what is derived from it.
fn write(body: EntityRef<'_>, momentum: Momentum) {
    if let Some(mut own) = body.get::<&mut Momentum>() {
        *own = momentum;
    }
    if let (Some((constants, state)), Some(mut velocity)) = (moving_body(body), body.get::<&mut Velocity>()) {
        (*velocity, _) = <(Velocity, InverseInertia)>::from(derived(&constants, &state));
    }
}
