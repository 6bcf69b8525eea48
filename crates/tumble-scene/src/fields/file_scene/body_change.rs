//! The numbers of a body of a file as the model of a scene's body, and how other ones are given to
//! the body in its world.

use glam::{DQuat, DVec3};
use hecs::{Entity, World};
use tumble::math::{Vec3, dquat, dvec3};
use tumble::{
    CenterOfMass, Collider, GravityScale, Material, Pose, Velocity, change_mass_properties, set_angular_velocity,
    set_linear_velocity,
};
use tumble_import::FieldError;
use tumble_import::checked::{positive, real, real_quaternion, real_vector};

use crate::bodies::scene_body::SceneBody;
use crate::convert::collider::material;
use crate::convert::orientation::rotation;
use crate::fields::file_scene::Frame;
use crate::model::collider_model::ColliderModel;
use crate::model::orientation_model::OrientationModel;
use crate::model::scene_model::BodyModel;
use crate::values::checked::{double, double_vector, finite_triple, number};
use crate::values::tuple::{Triple, Tuple};

/// How far from the origin a body may be \[m\].
const MAX_DISTANCE: f64 = 1e15;

/// What of a body can vary, with the values that it has.
pub(crate) fn body_model(body: &SceneBody, name: &str, entity: Entity, world: &World) -> BodyModel {
    let velocity = world.get::<&Velocity>(entity).ok();
    let (origin, orientation) = body_frame(world, entity);
    let scale = world.get::<&GravityScale>(entity).ok();
    let mass = body.body.properties().map(tumble::MassProperties::mass);
    BodyModel {
        name: Some(name.to_owned()),
        mass,
        position: Some(Tuple(origin.to_array())),
        orientation: (orientation != DQuat::IDENTITY)
            .then(|| OrientationModel::Quaternion(Tuple(orientation.to_array()))),
        linear_velocity: velocity.as_ref().map(|velocity| Tuple(double_vector(velocity.linear))),
        angular_velocity: velocity.as_ref().map(|velocity| Tuple(double_vector(velocity.angular))),
        gravity_scale: mass.map(|_| scale.map_or(1.0, |scale| double(scale.0))),
        fixed: velocity.is_none(),
        collider: body.collider.as_ref().map(|collider| collider_model(collider.material())),
        ..BodyModel::default()
    }
}

/// Why such a body has not the number that the path after it leads to.
pub(crate) fn refusal(model: &BodyModel, path: &[&str]) -> Option<String> {
    let lacks = |what: &str| Some(format!("the body has no {what} that could vary"));
    let is_split = model.collider.as_ref().is_some_and(|collider| collider.friction.is_none());
    match path.first().copied()? {
        "mass" | "gravity_scale" if model.mass.is_none() => lacks("mass"),
        "linear_velocity" | "angular_velocity" if model.fixed => lacks("velocity"),
        "collider" if model.collider.is_none() => lacks("collider"),
        "collider" if is_split && path.get(1) == Some(&"friction") => {
            Some("has two coefficients: static_friction and dynamic_friction".to_owned())
        }
        "collider" if !is_split && matches!(path.get(1), Some(&("static_friction" | "dynamic_friction"))) => {
            Some("has one coefficient for both: friction".to_owned())
        }
        "orientation" if model.orientation.is_some() && path.get(1) == Some(&"angle") => Some(
            "the body is turned in the file: only the four numbers of its quaternion, orientation.0 to orientation.3, can vary"
                .to_owned(),
        ),
        "mass" | "gravity_scale" | "position" | "orientation" | "linear_velocity" | "angular_velocity" | "collider" => {
            None
        }
        _ => Some(
            "of a body of such a file only mass, gravity_scale, position.I, orientation.I, orientation.angle, \
             linear_velocity.I, angular_velocity.I and collider.FIELD can vary"
                .to_owned(),
        ),
    }
}

fn collider_model(material: &Material) -> ColliderModel {
    let [at_rest, sliding] = [material.static_friction, material.dynamic_friction].map(double);
    let one = at_rest == sliding;
    ColliderModel {
        friction: one.then_some(at_rest),
        static_friction: (!one).then_some(at_rest),
        dynamic_friction: (!one).then_some(sliding),
        restitution: Some(double(material.restitution)),
        rolling_resistance: Some(double(material.rolling_resistance)),
        surface_velocity: Some(Tuple(double_vector(material.surface_velocity))),
        ..ColliderModel::default()
    }
}

/// The centre of mass and the orientation of a body in its world.
pub(crate) fn center_frame(world: &World, entity: Entity) -> Frame {
    world
        .get::<&Pose>(entity)
        .map_or((DVec3::ZERO, DQuat::IDENTITY), |pose| (dvec3(pose.position), dquat(pose.orientation)))
}

/// The origin and the orientation of a body's own frame.
pub(crate) fn body_frame(world: &World, entity: Entity) -> Frame {
    let (position, orientation) = center_frame(world, entity);
    let center = world.get::<&CenterOfMass>(entity).map_or(DVec3::ZERO, |center| dvec3(center.0));
    (position - orientation * center, orientation)
}

/// The frame that a model says; what it does not say is where it was.
pub(crate) fn model_frame(model: &BodyModel, (origin, orientation): Frame) -> Result<Frame, FieldError> {
    let place = |place: &Triple| finite_triple("position", place);
    let position = model.position.as_ref().map(place).transpose()?;
    let turned = model.orientation.as_ref().map(rotation).transpose()?;
    Ok((position.unwrap_or(origin), turned.unwrap_or(orientation)))
}

/// Moves a body by a rotation about the origin of `from` and the way from there to `to`; its
/// velocity stays.
pub(crate) fn move_body(world: &mut World, entity: Entity, from: Frame, to: Frame) -> Result<(), FieldError> {
    let (center, orientation) = center_frame(world, entity);
    let is_turned = from.1 != to.1;
    let turn = if is_turned { (to.1 * from.1.inverse()).normalize() } else { DQuat::IDENTITY };
    let place = to.0 + turn * (center - from.0);
    if !place.is_finite() || place.abs().max_element() > MAX_DISTANCE {
        return Err(FieldError::new("position", "is further than 1e15 m from the origin"));
    }
    let position = real_vector(place);
    if let Ok(pose) = world.query_one_mut::<&mut Pose>(entity) {
        pose.position = position;
        if is_turned {
            pose.orientation = real_quaternion((turn * orientation).normalize());
        }
    }
    let velocity = world.get::<&Velocity>(entity).map(|velocity| *velocity).ok();
    match velocity {
        Some(velocity) if is_turned => set_angular(world, entity, velocity.angular),
        _ => Ok(()),
    }
}

fn set_linear(world: &mut World, entity: Entity, velocity: Vec3) -> Result<(), FieldError> {
    set_linear_velocity(world, entity, velocity).map_err(|error| FieldError::new("linear_velocity", error))
}

fn set_angular(world: &mut World, entity: Entity, velocity: Vec3) -> Result<(), FieldError> {
    set_angular_velocity(world, entity, velocity).map_err(|error| FieldError::new("angular_velocity", error))
}

/// Gives a body what is other in `now` than it was, but for its place.
pub(crate) fn change_body(
    body: &SceneBody,
    (was, now): (&BodyModel, &BodyModel),
    entity: Entity,
    world: &mut World,
) -> Result<(), FieldError> {
    let before = world.get::<&Velocity>(entity).map(|velocity| *velocity).ok();
    if now.mass != was.mass
        && let (Some(mass), Some(properties)) = (now.mass, body.body.properties())
    {
        let refused = |error: String| FieldError::new("mass", error);
        let scaled = properties.scaled_to_mass(positive("mass", mass)?).map_err(|error| refused(error.to_string()))?;
        change_mass_properties(world, entity, &scaled).map_err(|error| refused(error.to_string()))?;
    }
    if now.gravity_scale != was.gravity_scale
        && let Some(scale) = now.gravity_scale
    {
        let scale = GravityScale(real(number("gravity_scale", scale)?));
        world.insert_one(entity, scale).map_err(|error| FieldError::new("gravity_scale", error))?;
    }
    if now.collider != was.collider {
        change_surface(now, entity, world)?;
    }
    let Some(before) = before else { return Ok(()) };
    let other = |now: &Option<Triple>, was: &Option<Triple>, field| {
        now.as_ref().filter(|_| now != was).map(|it| finite_triple(field, it).map(real_vector)).transpose()
    };
    let linear = other(&now.linear_velocity, &was.linear_velocity, "linear_velocity")?;
    let angular = other(&now.angular_velocity, &was.angular_velocity, "angular_velocity")?;
    let has_other_mass = now.mass != was.mass;
    if has_other_mass || linear.is_some() {
        set_linear(world, entity, linear.unwrap_or(before.linear))?;
    }
    if has_other_mass || angular.is_some() {
        set_angular(world, entity, angular.unwrap_or(before.angular))?;
    }
    Ok(())
}

/// Gives all colliders of a body the numbers of a surface; how they combine with others' stays.
fn change_surface(now: &BodyModel, entity: Entity, world: &mut World) -> Result<(), FieldError> {
    let (Some(model), Ok(collider)) = (&now.collider, world.query_one_mut::<&mut Collider>(entity)) else {
        return Ok(());
    };
    let mut problems = Vec::new();
    let made = material(model, &mut problems);
    let Some(made) = made else {
        return Err(problems.into_iter().next().unwrap_or_else(|| FieldError::new("collider", "is impossible")));
    };
    let Material { friction_combine, restitution_combine, .. } = *collider.material();
    let made = Material { friction_combine, restitution_combine, ..made };
    *collider = collider.clone().with_material(made).map_err(|error| FieldError::new("collider", error))?;
    Ok(())
}
