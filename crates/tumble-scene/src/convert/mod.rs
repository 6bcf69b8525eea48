//! Model to bodies: every value is checked here, with the field it came from.

pub(crate) mod collider;
pub(crate) mod forces;
pub(crate) mod gears;
pub(crate) mod ground;
pub(crate) mod joint_options;
pub(crate) mod joints;
pub(crate) mod orientation;

use std::sync::Arc;

use glam::{DMat3, DQuat, DVec3};
use tumble::math::Vec3;
use tumble::{Amount, Axes, BodyId, InertiaTensor, Part, PrincipalInertia, RigidBody, Shape};

pub(crate) use crate::convert::forces::{Others, indices, springs_by_distance};

use tumble_import::checked::{check_name, note, positive, real_quaternion, real_vector, unit_quaternion};
use tumble_import::{Appearance, FieldError};

use crate::bodies::scene_body::SceneBody;
use crate::model::scene_model::{BodyModel, InertiaModel, PartModel, ShapeModel};
use crate::values::axes::axes;
use crate::values::checked::finite_triple;
use crate::values::tuple::Triple;

/// The model's body with its name and forces, or everything that is wrong with it.
pub(crate) fn body(model: &BodyModel, index: usize, others: Others<'_>) -> Result<SceneBody, Vec<FieldError>> {
    let mut problems = Vec::new();
    let checked = note(&mut problems, shape(model.shape.as_ref()));
    let ground = ground::appearance(model, &mut problems);
    let collider = collider::collider(model, ground.as_ref(), checked.as_ref(), &mut problems);
    let shape = checked.unwrap_or(Shape::Point);
    let body = with_fields(model, index, shape.clone(), &mut problems);
    let locked_axes = locked_axes(model, &mut problems);
    let (forces, springs_to) = forces::forces(model, index, others, &mut problems);
    if !problems.is_empty() {
        return Err(problems);
    }
    // The scene's own collider is beside the body.
    let body = body.without_collider().build().map_err(|error| vec![FieldError::new(error.field(), error)])?;
    let appearance = ground.unwrap_or(Appearance::Shape(shape));
    Ok(SceneBody { body, appearance, forces, springs_to, collider, locked_axes, pieces: Vec::new() })
}

/// The axes of the world that a dynamic body is locked along and about.
fn locked_axes(model: &BodyModel, problems: &mut Vec<FieldError>) -> Axes {
    if !model.locked_axes.is_empty() && (model.fixed || model.kinematic) {
        problems.push(FieldError::new("locked_axes", "is for bodies that are neither fixed nor kinematic"));
    }
    note(problems, axes("locked_axes", &model.locked_axes)).unwrap_or_default()
}

/// The name given, or `body-<index>`.
pub(crate) fn name(model: &BodyModel, index: usize) -> String {
    model.name.clone().unwrap_or_else(|| numbered(index as u64))
}

/// The name of a body that was given none.
pub(crate) fn numbered(index: u64) -> String {
    format!("body-{index}")
}

/// Takes over one field after the other; what fails is noted and left out.
fn with_fields(model: &BodyModel, index: usize, shape: Shape, problems: &mut Vec<FieldError>) -> RigidBody {
    let mut body = kind(model, shape, problems).id(BodyId(index as u64));
    if let Some(name) = &model.name {
        note(problems, check_name(name));
    }
    body = with_mass(model, body, problems);
    if let Some(inertia) = model.inertia.as_ref().and_then(|inertia| note(problems, principal_inertia(inertia))) {
        body = body.principal_inertia(inertia);
    }
    let center = model.center_of_mass.as_ref().map(|center| finite_triple("center_of_mass", center));
    if let Some(center) = center.and_then(|center| note(problems, center)) {
        body = body.center_of_mass(center);
    }
    if let Some(position) = triple(&model.position, "position", problems) {
        body = body.position(position);
    }
    if let Some(orientation) = note(problems, ground::orientation(model)).flatten() {
        body = body.orientation(real_quaternion(orientation));
    }
    if let Some(velocity) = triple(&model.linear_velocity, "linear_velocity", problems) {
        body = body.linear_velocity(velocity);
    }
    if let Some(velocity) = triple(&model.angular_velocity, "angular_velocity", problems) {
        body = body.angular_velocity(velocity);
    }
    body
}

fn kind(model: &BodyModel, shape: Shape, problems: &mut Vec<FieldError>) -> RigidBody {
    match (model.fixed, model.kinematic) {
        (true, true) => {
            problems.push(FieldError::new("kinematic", "a body is fixed or kinematic, not both"));
            RigidBody::new(shape).fixed()
        }
        (true, false) => {
            let moves = [("linear_velocity", &model.linear_velocity), ("angular_velocity", &model.angular_velocity)];
            for (field, velocity) in moves {
                if velocity.is_some_and(|velocity| velocity.0 != [0.0; 3]) {
                    problems.push(FieldError::new(field, "a fixed body does not move"));
                }
            }
            RigidBody::new(shape).fixed()
        }
        (false, true) => RigidBody::new(shape).kinematic(),
        (false, false) => RigidBody::new(shape),
    }
}

fn with_mass(model: &BodyModel, body: RigidBody, problems: &mut Vec<FieldError>) -> RigidBody {
    let own_mass = matches!(model.shape, Some(ShapeModel::Compound { .. }));
    let is_ground = model.shape.as_ref().is_some_and(ShapeModel::is_ground);
    let needs_none = own_mass || is_ground || model.fixed || model.kinematic;
    match (model.mass, model.density) {
        (Some(_), Some(density)) => {
            let problem = format!("is {density}, but mass is given too: give one of them");
            problems.push(FieldError::new("density", problem));
            body
        }
        (Some(mass), None) => match note(problems, positive("mass", mass)) {
            Some(mass) => body.mass(mass),
            None => body,
        },
        (None, Some(density)) => match note(problems, positive("density", density)) {
            Some(_) if model.shape.is_none() => {
                problems.push(FieldError::new("density", "needs a shape"));
                body
            }
            Some(density) => body.density(density),
            None => body,
        },
        (None, None) => {
            if !needs_none {
                problems.push(FieldError::new("mass", "is missing: give a mass, or a density with a shape"));
            }
            body
        }
    }
}

/// The shape with its lengths and parts checked.
fn shape(model: Option<&ShapeModel>) -> Result<Shape, FieldError> {
    // Ground has no mass; it is distinguished from a point where it matters.
    let Some(model) = model.filter(|model| !model.is_ground()) else {
        return Ok(Shape::Point);
    };
    let shape = unchecked_shape(model).map_err(|error| error.inside("shape"))?;
    // Lengths must be good even where no mass comes of them, so any mass will do for the check.
    let checked = match shape {
        Shape::Compound(_) => shape.own_mass_properties(),
        _ => shape.mass_properties(Amount::Mass(1.0)),
    };
    match checked {
        Ok(_) => Ok(shape),
        Err(error) => Err(FieldError::new(format!("shape.{}", error.path()), error)),
    }
}

fn unchecked_shape(model: &ShapeModel) -> Result<Shape, FieldError> {
    Ok(match *model {
        ShapeModel::Point => Shape::Point,
        ShapeModel::Sphere { radius } => Shape::sphere(radius),
        ShapeModel::HollowSphere { radius } => Shape::hollow_sphere(radius),
        ShapeModel::Cuboid { half_extents } => Shape::cuboid(half_extents.0),
        ShapeModel::Cylinder { radius, half_height } => Shape::cylinder(radius, half_height),
        ShapeModel::Capsule { radius, half_height } => Shape::capsule(radius, half_height),
        ShapeModel::Cone { radius, half_height } => Shape::cone(radius, half_height),
        ShapeModel::Ellipsoid { radii } => Shape::ellipsoid(radii.0),
        ShapeModel::Compound { ref parts } => {
            let part = |(index, model): (usize, &PartModel)| {
                part(model).map_err(|error| error.inside(&format!("parts[{index}]")))
            };
            Shape::Compound(parts.iter().enumerate().map(part).collect::<Result<_, _>>()?)
        }
        ShapeModel::Mesh { ref solid, .. } | ShapeModel::ConvexHull { ref solid, .. } => match solid {
            Some(Ok(solid)) => Shape::Mesh(Arc::clone(solid)),
            Some(Err(error)) => return Err(error.clone()),
            None => return Err(FieldError::new(model.name(), "has not been made")),
        },
        ShapeModel::HalfSpace { .. } | ShapeModel::HeightField { .. } => {
            return Err(FieldError::new(model.name(), "cannot be a part of something: it has no volume"));
        }
    })
}

fn part(model: &PartModel) -> Result<Part, FieldError> {
    let shape = unchecked_shape(&model.shape).map_err(|error| error.inside("shape"))?;
    let amount = match (model.mass, model.density) {
        (Some(_), Some(density)) => {
            let problem = format!("is {density}, but mass is given too: give one of them");
            return Err(FieldError::new("density", problem));
        }
        (Some(mass), None) => Amount::Mass(positive("mass", mass)?),
        (None, Some(density)) => Amount::Density(positive("density", density)?),
        // A compound as a part knows its own mass.
        (None, None) if matches!(shape, Shape::Compound(_)) => own_amount(&shape)?,
        (None, None) => return Err(FieldError::new("mass", "is missing: give a mass or a density")),
    };
    let mut part = Part::new(shape, amount);
    if let Some(position) = &model.position {
        part = part.at(finite_triple("position", position)?);
    }
    if let Some(orientation) = &model.orientation {
        part = part.turned(orientation::rotation(orientation)?);
    }
    Ok(part)
}

fn own_amount(compound: &Shape) -> Result<Amount, FieldError> {
    match compound.own_mass_properties() {
        Ok(properties) => Ok(Amount::Mass(properties.mass())),
        Err(error) => Err(FieldError::new(format!("shape.{}", error.path()), error)),
    }
}

fn principal_inertia(model: &InertiaModel) -> Result<PrincipalInertia, FieldError> {
    match (&model.principal, &model.tensor) {
        (Some(_), Some(_)) => Err(FieldError::new("inertia.tensor", "principal is given too: give one of them")),
        (None, None) => Err(FieldError::new("inertia", "needs principal or tensor")),
        (None, Some(_)) if model.axes.is_some() => {
            Err(FieldError::new("inertia.axes", "belongs to principal, not to tensor"))
        }
        (None, Some(rows)) => {
            let [x, y, z] = rows.0.map(|row| DVec3::from_array(row.0));
            InertiaTensor::new(DMat3::from_cols(x, y, z).transpose())
                .map(|tensor| tensor.principal())
                .map_err(|error| FieldError::new("inertia.tensor", error))
        }
        (Some(moments), None) => {
            let axes = match &model.axes {
                Some(axes) => unit_quaternion("inertia.axes", axes.0)?,
                None => DQuat::IDENTITY,
            };
            // The tensor is made for its checks; moments and axes keep the order they were given
            // in.
            InertiaTensor::from_principal(moments.0, axes)
                .map(|_| PrincipalInertia { moments: DVec3::from_array(moments.0), axes })
                .map_err(|error| FieldError::new("inertia.principal", error))
        }
    }
}

fn triple(value: &Option<Triple>, field: &str, problems: &mut Vec<FieldError>) -> Option<Vec3> {
    note(problems, finite_triple(field, value.as_ref()?)).map(real_vector)
}
