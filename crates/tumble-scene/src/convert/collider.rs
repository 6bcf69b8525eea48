//! Models of colliders to colliders.

use tumble::math::Real;
use tumble::{Collider, ColliderError, Material, Pose, Shape};
use tumble_import::checked::{note, real, real_quaternion, real_vector};
use tumble_import::{Appearance, FieldError, shortest};

use crate::model::collider_model::ColliderModel;
use crate::model::scene_model::{BodyModel, Groups, ShapeModel};
use crate::values::checked::finite_triple;

/// What the body touches others with; `ground` is what it is, `shape` is `None` if it has been
/// complained of already.
pub(crate) fn collider(
    model: &BodyModel,
    ground: Option<&Appearance>,
    shape: Option<&Shape>,
    problems: &mut Vec<FieldError>,
) -> Option<Collider> {
    let surface = model.collider.as_ref()?;
    let of_whole = surfaced(surface, problems);
    if !surface.parts.is_empty() {
        let made = of_parts(surface, shape?, problems);
        of_whole?;
        return made;
    }
    let (material, membership, filter) = of_whole?;
    let collider = match (&model.shape, shape) {
        (Some(shape), _) if shape.is_ground() => Ok(match ground? {
            Appearance::HeightField(heights) => heights.collider().clone(),
            _ => Collider::half_space(),
        }),
        // What stands still is as it is, hollows and all; what moves has to be solid.
        (Some(ShapeModel::Mesh { .. }), Some(Shape::Mesh(solid))) if model.fixed || model.kinematic => {
            let mesh = solid.mesh();
            Collider::mesh(mesh.positions().iter().copied(), mesh.triangles())
        }
        (_, Some(shape)) => Collider::new(shape),
        (_, None) => return None,
    };
    let collider = collider.and_then(|collider| collider.with_groups(membership, filter).with_material(material));
    let collider = collider.map(|it| as_sensor(it, surface));
    note(problems, collider.map_err(|error| FieldError::new(field(&error), error)))
}

fn as_sensor(collider: Collider, model: &ColliderModel) -> Collider {
    if model.sensor == Some(true) { collider.sensor() } else { collider }
}

/// The surface, and the groups as bits.
fn surfaced(surface: &ColliderModel, problems: &mut Vec<FieldError>) -> Option<(Material, u32, u32)> {
    let material = material(surface, problems);
    let groups = [("groups", &surface.groups), ("touches", &surface.touches)].map(|(field, numbers)| match numbers {
        Some(Groups(numbers)) => note(problems, bits(field, numbers)),
        None => Some(u32::MAX),
    });
    let (material, [Some(membership), Some(filter)]) = (material?, groups) else { return None };
    Some((material, membership, filter))
}

/// A compound of which each part has what is said of it.
fn of_parts(surface: &ColliderModel, shape: &Shape, problems: &mut Vec<FieldError>) -> Option<Collider> {
    let parts = match shape {
        Shape::Compound(parts) if parts.len() == surface.parts.len() => parts,
        _ => {
            let problem = "must be one for each part of the body's shape, a compound";
            problems.push(FieldError::new("collider.parts", problem));
            return None;
        }
    };
    let mut made = Vec::new();
    for (index, (part, model)) in parts.iter().zip(&surface.parts).enumerate() {
        let mut of_part = Vec::new();
        let part_model = model.over(surface);
        if !model.parts.is_empty() {
            of_part.push(FieldError::new("collider.parts", "has no parts of its own: name them in one list"));
        }
        let surfaced = surfaced(&part_model, &mut of_part);
        problems.extend(of_part.into_iter().map(|error| error.inside(&format!("collider.parts[{index}]"))));
        // A weight, with nothing to touch.
        let (Some((material, membership, filter)), false) = (surfaced, part.shape == Shape::Point) else { continue };
        let at = Pose { position: real_vector(part.position), orientation: real_quaternion(part.orientation) };
        let collider = Collider::new(&part.shape)
            .and_then(|it| it.with_offset(at))
            .and_then(|it| it.with_groups(membership, filter).with_material(material))
            .map(|it| as_sensor(it, &part_model));
        let within = |error| FieldError::new(format!("shape.compound.parts[{index}]"), error);
        made.extend(note(problems, collider.map_err(within)));
    }
    note(problems, Collider::compound(made).map_err(|error| FieldError::new("collider.parts", error)))
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
pub(crate) fn material(model: &ColliderModel, problems: &mut Vec<FieldError>) -> Option<Material> {
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
    let rolling = number("rolling_resistance", model.rolling_resistance, Real::MAX);
    let moving = model.surface_velocity.as_ref();
    let moving = moving.and_then(|it| note(problems, finite_triple("collider.surface_velocity", it)));
    let material = Material {
        // One of the two alone says both.
        static_friction: at_rest.or(sliding).unwrap_or(usual.static_friction),
        dynamic_friction: sliding.or(at_rest).unwrap_or(usual.dynamic_friction),
        restitution: restitution.unwrap_or(usual.restitution),
        rolling_resistance: rolling.unwrap_or(usual.rolling_resistance),
        surface_velocity: moving.map_or(usual.surface_velocity, real_vector),
        friction_combine: model.friction_combine.map_or(usual.friction_combine, Into::into),
        restitution_combine: model.restitution_combine.map_or(usual.restitution_combine, Into::into),
    };
    (problems.len() == before).then_some(material)
}

/// A bit for each group.
fn bits(field: &str, groups: &[u32]) -> Result<u32, FieldError> {
    groups.iter().enumerate().try_fold(0, |bits, (index, &group)| match 1_u32.checked_shl(group) {
        Some(bit) => Ok(bits | bit),
        None => {
            Err(FieldError::new(format!("collider.{field}[{index}]"), format!("must be from 0 to 31, not {group}")))
        }
    })
}

fn coefficient(field: &str, value: f64, most: Real) -> Result<Real, FieldError> {
    let number = real(value);
    if (0.0..=most).contains(&number) {
        return Ok(number);
    }
    let wanted = if most < Real::MAX { format!("from 0 to {most}") } else { "zero or positive, and finite".to_owned() };
    Err(FieldError::new(field, format!("must be {wanted}, not {}", shortest(value))))
}
