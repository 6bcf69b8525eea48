//! Models of colliders to colliders, and ground without end.

use glam::{DQuat, DVec3};
use tumble::math::Real;
use tumble::{Collider, ColliderError, Material, Shape};

use super::{finite_triple, note, real, unit_quaternion};
use crate::collider_model::ColliderModel;
use crate::error::{FieldError, shortest};
use crate::model::{BodyModel, ShapeModel, Triple};

/// A normal shorter than this has no direction to speak of.
const SHORTEST_NORMAL: f64 = 1e-9;

/// What the body touches others with; `shape` is `None` if it has been complained of already.
pub(super) fn collider(model: &BodyModel, shape: Option<&Shape>, problems: &mut Vec<FieldError>) -> Option<Collider> {
    let surface = model.collider.as_ref()?;
    let material = material(surface, problems)?;
    let collider = match (&model.shape, shape) {
        (Some(ShapeModel::HalfSpace { .. }), _) => Ok(Collider::half_space()),
        // What stands still is as it is, hollows and all; what moves has to be solid.
        (Some(ShapeModel::Mesh { .. }), Some(Shape::Mesh(solid))) if model.fixed || model.kinematic => {
            let mesh = solid.mesh();
            Collider::mesh(mesh.positions().iter().copied(), mesh.triangles())
        }
        (_, Some(shape)) => Collider::new(shape),
        (_, None) => return None,
    };
    let collider = collider.and_then(|collider| collider.with_material(material));
    note(problems, collider.map_err(|error| FieldError::new(field(&error), error)))
}

/// Where a scene has what the engine complains of.
fn field(error: &ColliderError) -> String {
    match error {
        ColliderError::Length { field, .. } => format!("shape.{field}"),
        ColliderError::Material { field, .. } => format!("collider.{field}"),
        _ => "collider".to_owned(),
    }
}

/// The surface, with the engine's defaults for what is not said of it.
fn material(model: &ColliderModel, problems: &mut Vec<FieldError>) -> Option<Material> {
    let before = problems.len();
    let usual = Material::default();
    if model.friction.is_some() {
        for (field, given) in [("static_friction", model.static_friction), ("dynamic_friction", model.dynamic_friction)]
        {
            if given.is_some() {
                let problem = "friction is given too: give it, or static_friction and dynamic_friction";
                problems.push(FieldError::new(format!("collider.{field}"), problem));
            }
        }
    }
    let mut number = |field: &str, given: Option<f64>, most: Real| {
        note(problems, coefficient(field, given?, most).map_err(|error| error.inside("collider")))
    };
    let both = number("friction", model.friction, Real::MAX);
    let at_rest = number("static_friction", model.static_friction, Real::MAX).or(both);
    let sliding = number("dynamic_friction", model.dynamic_friction, Real::MAX).or(both);
    let restitution = number("restitution", model.restitution, 1.0);
    let rolling = number("rolling_friction", model.rolling_friction, Real::MAX);
    let material = Material {
        // One of the two alone says both.
        static_friction: at_rest.or(sliding).unwrap_or(usual.static_friction),
        dynamic_friction: sliding.or(at_rest).unwrap_or(usual.dynamic_friction),
        restitution: restitution.unwrap_or(usual.restitution),
        rolling_friction: rolling.unwrap_or(usual.rolling_friction),
        friction_combine: model.friction_combine.map_or(usual.friction_combine, Into::into),
        restitution_combine: model.restitution_combine.map_or(usual.restitution_combine, Into::into),
    };
    (problems.len() == before).then_some(material)
}

fn coefficient(field: &str, value: f64, most: Real) -> Result<Real, FieldError> {
    let number = real(value);
    if (0.0..=most).contains(&number) {
        return Ok(number);
    }
    let wanted = if most < Real::MAX { format!("from 0 to {most}") } else { "zero or positive, and finite".to_owned() };
    Err(FieldError::new(field, format!("must be {wanted}, not {}", shortest(value))))
}

/// What cannot be said of a body whose shape has no end.
pub(super) fn check_half_space(model: &BodyModel, problems: &mut Vec<FieldError>) {
    let Some(ShapeModel::HalfSpace { .. }) = model.shape else { return };
    if !model.fixed {
        problems.push(FieldError::new("shape.half_space", "has no end and cannot move: the body is to be fixed"));
    }
    let given = [
        ("mass", model.mass.is_some()),
        ("density", model.density.is_some()),
        ("inertia", model.inertia.is_some()),
        ("center_of_mass", model.center_of_mass.is_some()),
    ];
    for (field, _) in given.into_iter().filter(|(_, is_given)| *is_given) {
        problems.push(FieldError::new(field, "belongs to a body with an end, and the shape is a half_space"));
    }
}

/// The rotation from the body's frame to the world, if the model has any. The frame of a half-space has y along the normal.
pub(super) fn orientation(model: &BodyModel) -> Result<Option<DQuat>, FieldError> {
    let given = model.orientation.as_ref().map(|given| unit_quaternion("orientation", given)).transpose()?;
    let Some(ShapeModel::HalfSpace { normal }) = &model.shape else { return Ok(given) };
    let turn = from_y_to(normal).map_err(|error| error.inside("shape.half_space"))?;
    Ok(Some(given.map_or(turn, |given| (given * turn).normalize())))
}

/// The shortest rotation that takes the y axis to a direction of any length.
fn from_y_to(normal: &Triple) -> Result<DQuat, FieldError> {
    let vector = finite_triple("normal", normal)?;
    let length = vector.length();
    if length < SHORTEST_NORMAL {
        return Err(FieldError::new("normal", format!("has no direction: its length is {}", shortest(length))));
    }
    let DVec3 { x, y, z } = vector / length;
    // Twice the angle's half: 1 + cos, and the axis times sin. Near the opposite, where both vanish, any axis across will do.
    let rotation = DQuat::from_xyzw(z, 0.0, -x, 1.0 + y);
    Ok(if y > -1.0 + 1e-12 { rotation.normalize() } else { DQuat::from_xyzw(1.0, 0.0, 0.0, 0.0) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Tuple;

    #[test]
    fn normals_become_orientations() {
        assert_eq!(from_y_to(&Tuple([0.0, 7.0, 0.0])).unwrap(), DQuat::IDENTITY);
        for normal in [[0.0, -1.0, 0.0], [3.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.3, -0.5, 0.2], [1e-5, -1.0, 0.0]] {
            let turned = from_y_to(&Tuple(normal)).unwrap() * DVec3::Y;
            let off = turned - DVec3::from_array(normal).normalize();
            // A few roundings; nearly opposite 1 + y has lost six digits.
            assert!(off.length() < 1e-10, "{normal:?}: {turned}");
        }
        for none in [[0.0; 3], [f64::NAN, 1.0, 0.0], [0.0, f64::INFINITY, 0.0]] {
            assert_eq!(from_y_to(&Tuple(none)).unwrap_err().field, "normal", "{none:?}");
        }
    }
}
