//! New mass properties for a body that is already in a world.

use hecs::{Entity, World};
use tumble_math::MassProperties;

use crate::components::property_error::PropertyError;
use crate::components::{
    CenterOfMass, Inertia, InertiaComponentError, InverseInertia, Mass, Momentum, Pose, PreviousPose, PrincipalAxes,
    Velocity,
};
use crate::integrators::derived::derived;
use crate::integrators::state::{Constants, Moments, State, moving_body};
use crate::math::{Vec3, dquat, dvec3, quat, vec3};

/// Why a body keeps the mass properties that it has.
///
/// ```
/// # use tumble::{ChangeMassError, MassProperties, RigidBody, Shape, change_mass_properties};
/// # let mut world = tumble::hecs::World::new();
/// let wall = RigidBody::new(Shape::sphere(1.0)).fixed().build()?.spawn(&mut world);
/// let error = change_mass_properties(&mut world, wall, &MassProperties::point(1.0, [0.0; 3])?);
/// assert_eq!(error, Err(ChangeMassError::NotMoving(wall)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ChangeMassError {
    /// The entity is gone, or no dynamic body.
    #[error("entity {0:?} is not a moving body: it needs Pose, Momentum and Mass")]
    NotMoving(Entity),
    /// The mass does not fit the precision of the build.
    #[error(transparent)]
    Mass(#[from] PropertyError),
    /// The moments of inertia do not.
    #[error(transparent)]
    Inertia(#[from] InertiaComponentError),
    /// The new centre of mass, or the angular momentum about it, does not.
    #[error("the centre of mass {0} cannot be one of this body")]
    Center(glam::DVec3),
}

tumble_math::debug_as_display!(ChangeMassError);

/// Gives a moving body another mass, centre of mass and inertia, all in its own frame: a skater who
/// pulls in the arms, a tank that drains.
///
/// The body's frame stays where it is, and so do its linear momentum and its angular momentum about
/// any point of the world. Where the centre of mass moves within the frame, the body's
/// `Momentum::angular`, which is about that centre, takes up the difference. `Velocity` and
/// `InverseInertia` are those of the new properties. What it changes of the kinetic energy is work
/// of no force: a [`Ledger`](crate::Ledger) shows it as
/// [`between_steps`](crate::LedgerEntry::between_steps).
///
/// What of the body moves inside it while it changes is not seen: for a spring or a collider its
/// points are where they were along the frame, but attachments that are given from the centre of
/// mass move with that.
///
/// ```
/// use tumble::{MassProperties, change_mass_properties, prelude::*};
///
/// let mut world = hecs::World::new();
/// let arms_out = Shape::cylinder(0.4, 0.9).mass_properties(tumble::Amount::Mass(60.0))?;
/// let arms_in = Shape::cylinder(0.2, 0.9).mass_properties(tumble::Amount::Mass(60.0))?;
/// let skater = RigidBody::new(Shape::cylinder(0.4, 0.9))
///     .mass(60.0)
///     .angular_velocity(Vec3::Y * 3.0)
///     .build()?;
/// let skater = skater.spawn(&mut world);
/// change_mass_properties(&mut world, skater, &arms_in)?;
/// // A quarter of the inertia.
/// assert!((world.get::<&Velocity>(skater)?.angular.y - 12.0).abs() < 1e-4);
/// change_mass_properties(&mut world, skater, &arms_out)?;
/// assert!((world.get::<&Velocity>(skater)?.angular.y - 3.0).abs() < 1e-5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`ChangeMassError`], and the body is as it was.
pub fn change_mass_properties(
    world: &mut World,
    entity: Entity,
    properties: &MassProperties,
) -> Result<(), ChangeMassError> {
    let not_moving = ChangeMassError::NotMoving(entity);
    let body = world.entity(entity).map_err(|_| not_moving.clone())?;
    if moving_body(body).is_none() {
        return Err(not_moving);
    }
    let mass = Mass::new(properties.mass())?;
    let center = properties.center_of_mass();
    let is_point = properties.tensor_about_center() == glam::DMat3::ZERO;
    let principal = match is_point {
        true => None,
        false => Some(properties.inertia().map_err(InertiaComponentError::from)?.principal()),
    };
    let inertia = principal.map(|principal| Inertia::new(principal.moments)).transpose()?;
    let axes = principal.filter(|principal| principal.axes != glam::DQuat::IDENTITY);
    let axes = axes.map(|principal| PrincipalAxes(quat(principal.axes)));

    let (Some(mut pose), Some(mut momentum)) =
        (body.get::<&Pose>().map(|pose| *pose), body.get::<&Momentum>().map(|momentum| *momentum))
    else {
        return Err(not_moving);
    };
    let before = body.get::<&CenterOfMass>().map_or(glam::DVec3::ZERO, |center| dvec3(center.0));
    let previous = body.get::<&PreviousPose>().map(|previous| {
        let moved = vec3(dquat(previous.0.orientation) * (center - before));
        PreviousPose(Pose { position: previous.0.position + moved, ..previous.0 })
    });
    let moved = dquat(pose.orientation) * (center - before);
    pose.position += vec3(moved);
    momentum.angular -= vec3(moved.cross(dvec3(momentum.linear)));
    if is_point {
        // What has no extent holds no spin.
        momentum.angular = Vec3::ZERO;
    }
    if !(pose.position.is_finite() && momentum.angular.is_finite() && vec3(center).is_finite()) {
        return Err(ChangeMassError::Center(center));
    }
    let constants = Constants {
        mass: mass.kilograms(),
        inertia: inertia.as_ref().map(|inertia| Moments::new(inertia, axes.as_ref())),
        damping: None,
    };
    let (velocity, inverse): (Velocity, InverseInertia) = derived(&constants, &State::new(&pose, &momentum)).into();
    let has_center = body.has::<CenterOfMass>() || center != glam::DVec3::ZERO;

    // The entity was found in this world, so inserting cannot fail.
    let _ = world.insert(entity, (pose, momentum, mass, velocity));
    match inertia {
        Some(inertia) => drop(world.insert(entity, (inertia, inverse))),
        None => drop((world.remove_one::<Inertia>(entity), world.remove_one::<InverseInertia>(entity))),
    }
    match axes {
        Some(axes) => drop(world.insert_one(entity, axes)),
        None => drop(world.remove_one::<PrincipalAxes>(entity)),
    }
    if has_center {
        let _ = world.insert_one(entity, CenterOfMass(vec3(center)));
    }
    if let Some(previous) = previous {
        let _ = world.insert_one(entity, previous);
    }
    Ok(())
}
