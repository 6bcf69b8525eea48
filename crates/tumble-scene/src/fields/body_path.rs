//! The numbers of a body, by what follows the body in a path.

use crate::fields::field_path::{component, element, from_zero};
use crate::fields::force_path::in_force;
use crate::model::collider_model::ColliderModel;
use crate::model::orientation_model::{OrientationModel, TurnModel};
use crate::model::scene_model::{BodyModel, InertiaModel, PartModel, ShapeModel};
use crate::values::tuple::{Quadruple, Tuple};

/// The number that a path such as `["inertia", "principal", "0"]` leads to, if the body has it.
pub(crate) fn in_body<'a>(body: &'a mut BodyModel, path: &[&str]) -> Option<&'a mut f64> {
    match path {
        ["mass"] => Some(body.mass.get_or_insert(0.0)),
        ["density"] => Some(body.density.get_or_insert(0.0)),
        ["gravity_scale"] => Some(body.gravity_scale.get_or_insert(0.0)),
        ["position", axis] => from_zero(&mut body.position, axis),
        ["linear_velocity", axis] => from_zero(&mut body.linear_velocity, axis),
        ["angular_velocity", axis] => from_zero(&mut body.angular_velocity, axis),
        ["orientation", rest @ ..] => in_orientation(&mut body.orientation, rest),
        // Only what is given can be varied: the shape's would have to be known here.
        ["center_of_mass", axis] => component(body.center_of_mass.as_mut()?, axis),
        ["inertia", rest @ ..] => in_inertia(body.inertia.as_deref_mut()?, rest),
        ["shape", rest @ ..] => in_shape(body.shape.as_mut()?, rest),
        ["collider", "surface_velocity", axis] => from_zero(&mut body.collider.as_mut()?.surface_velocity, axis),
        ["collider", field] => in_collider(body.collider.as_mut()?, field),
        ["forces", index, rest @ ..] => in_force(element(&mut body.forces, index)?, rest),
        _ => None,
    }
}

fn in_inertia<'a>(inertia: &'a mut InertiaModel, path: &[&str]) -> Option<&'a mut f64> {
    match path {
        ["principal", axis] => component(inertia.principal.as_mut()?, axis),
        ["axes", axis] => from_identity(&mut inertia.axes, axis),
        ["tensor", row, column] => component(element(&mut inertia.tensor.as_mut()?.0, row)?, column),
        _ => None,
    }
}

/// Of both coefficients of friction in one and each alone, that which the file has; neither begins
/// from another.
fn in_collider<'a>(collider: &'a mut ColliderModel, field: &str) -> Option<&'a mut f64> {
    let is_split = collider.static_friction.is_some() || collider.dynamic_friction.is_some();
    match field {
        "friction" if !is_split => Some(collider.friction.get_or_insert(0.0)),
        "static_friction" => collider.static_friction.as_mut(),
        "dynamic_friction" => collider.dynamic_friction.as_mut(),
        "restitution" => Some(collider.restitution.get_or_insert(0.0)),
        "rolling_resistance" => Some(collider.rolling_resistance.get_or_insert(0.0)),
        _ => None,
    }
}

/// With or without the shape's name, as in the file or as in messages.
fn in_shape<'a>(shape: &'a mut ShapeModel, path: &[&str]) -> Option<&'a mut f64> {
    let path = match path.split_first() {
        Some((name, rest)) if *name == shape.name() => rest,
        _ => path,
    };
    match (shape, path) {
        (ShapeModel::Sphere { radius } | ShapeModel::HollowSphere { radius }, ["radius"]) => Some(radius),
        (ShapeModel::Cuboid { half_extents: lengths }, ["half_extents", axis])
        | (ShapeModel::Ellipsoid { radii: lengths }, ["radii", axis]) => component(lengths, axis),
        (
            ShapeModel::Cylinder { radius, half_height }
            | ShapeModel::Capsule { radius, half_height }
            | ShapeModel::Cone { radius, half_height },
            [length],
        ) => match *length {
            "radius" => Some(radius),
            "half_height" => Some(half_height),
            _ => None,
        },
        (ShapeModel::HalfSpace { normal }, ["normal", axis]) => component(normal, axis),
        (ShapeModel::HeightField { spacing, .. }, ["spacing", axis]) => component(spacing, axis),
        (ShapeModel::HeightField { heights, .. }, ["heights", row, column]) => {
            element(&mut element(&mut heights.0, row)?.0, column)
        }
        (ShapeModel::Compound { parts }, ["parts", index, rest @ ..]) => in_part(element(parts, index)?, rest),
        _ => None,
    }
}

fn in_part<'a>(part: &'a mut PartModel, path: &[&str]) -> Option<&'a mut f64> {
    match path {
        ["mass"] => Some(part.mass.get_or_insert(0.0)),
        ["density"] => Some(part.density.get_or_insert(0.0)),
        ["position", axis] => from_zero(&mut part.position, axis),
        ["orientation", rest @ ..] => in_orientation(&mut part.orientation, rest),
        ["shape", rest @ ..] => in_shape(&mut part.shape, rest),
        _ => None,
    }
}

/// In the form that the scene has; without one in either, the angle about y.
fn in_orientation<'a>(orientation: &'a mut Option<OrientationModel>, path: &[&str]) -> Option<&'a mut f64> {
    let about_y = || OrientationModel::Turn(TurnModel { axis: Tuple([0.0, 1.0, 0.0]), angle: 0.0 });
    let none = || OrientationModel::Quaternion(Tuple([0.0, 0.0, 0.0, 1.0]));
    let is_turn = matches!(path, ["angle"] | ["axis", ..]);
    match (orientation.get_or_insert_with(if is_turn { about_y } else { none }), path) {
        (OrientationModel::Quaternion(quaternion), [index]) => component(quaternion, index),
        (OrientationModel::Turn(turn), ["angle"]) => Some(&mut turn.angle),
        (OrientationModel::Turn(turn), ["axis", index]) => component(&mut turn.axis, index),
        _ => None,
    }
}

fn from_identity<'a>(quaternion: &'a mut Option<Quadruple>, axis: &str) -> Option<&'a mut f64> {
    component(quaternion.get_or_insert(Tuple([0.0, 0.0, 0.0, 1.0])), axis)
}
