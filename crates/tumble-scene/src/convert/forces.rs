//! Models of forces to forces.

use std::collections::HashMap;

use glam::{DQuat, DVec3};
use tumble::{Frame, GravityMass};
use tumble_import::FieldError;
use tumble_import::checked::{finite, note, positive, real_vector};

use crate::alike::find;
use crate::bodies::force::{Force, HullShape, thrust_is_finite};
use crate::convert::name;
use crate::model::force_model::{ForceModel, FrameModel, HullModel, PerAxis};
use crate::model::scene_model::{BodyModel, ShapeModel};
use crate::values::checked::{double_vector, finite_triple, not_negative, number, rate};
use crate::values::tuple::Triple;

/// Fresh water [kg/m^3].
const WATER: f64 = 1000.0;

/// How the spring of a body finds another one.
#[derive(Clone, Copy)]
pub(crate) struct Others<'a> {
    /// Indices of all bodies, or none where no body has a spring.
    pub(crate) by_name: &'a HashMap<String, usize>,
    /// At least those that a spring without a rest length leads to.
    pub(crate) model: &'a dyn Fn(usize) -> Option<&'a BodyModel>,
}

/// The indices of bodies by name, if any body has a spring.
pub(crate) fn indices(bodies: &[BodyModel]) -> HashMap<String, usize> {
    let has_spring = |body: &BodyModel| body.forces.iter().any(|force| matches!(force, ForceModel::Spring { .. }));
    if !bodies.iter().any(has_spring) {
        return HashMap::new();
    }
    bodies.iter().enumerate().map(|(index, body)| (name(body, index), index)).collect()
}

/// The bodies to which those springs of a body lead whose length is the distance at the start.
pub(crate) fn springs_by_distance(body: &BodyModel, by_name: &HashMap<String, usize>) -> impl Iterator<Item = usize> {
    body.forces.iter().filter_map(|force| match force {
        ForceModel::Spring { to, rest_length: None, .. } => by_name.get(to).copied(),
        _ => None,
    })
}

/// The forces of a body, and for each spring among them the index of the body that it leads to.
pub(crate) fn forces(
    model: &BodyModel,
    index: usize,
    others: Others<'_>,
    problems: &mut Vec<FieldError>,
) -> (Vec<Force>, Vec<usize>) {
    let is_moved = !model.fixed && !model.kinematic;
    let mut forces = Vec::new();
    let mut springs_to = Vec::new();
    let mut seen = Vec::new();
    if let Some(scale) = model.gravity_scale
        && let Some(scale) = note(problems, finite("gravity_scale", scale))
        && is_moved
    {
        forces.push(Force::GravityScale(scale));
    }
    if model.gravity_scale.is_some() {
        seen.push("gravity_scale");
    }
    for (i, force) in model.forces.iter().enumerate() {
        let name = force.name();
        let field = format!("forces[{i}].{name}");
        let may_repeat = matches!(force, ForceModel::Thruster { .. } | ForceModel::Spring { .. });
        if seen.contains(&name) && !may_repeat {
            problems.push(FieldError::new(field, "is given twice"));
            continue;
        }
        if !seen.contains(&name) {
            seen.push(name);
        }
        if !is_moved && !matches!(force, ForceModel::GravityMass { .. }) {
            let kind = if model.fixed { "fixed" } else { "kinematic" };
            problems.push(FieldError::new(field, format!("acts on nothing: the body is {kind}")));
            continue;
        }
        let checked = match force {
            ForceModel::Spring { to, .. } => other(to, index, others).and_then(|to| {
                springs_to.push(to);
                spring(model, force, (others.model)(to))
            }),
            _ => alone(model, force),
        };
        let checked = note(problems, checked.map_err(|error| error.inside(&field)));
        forces.extend(checked);
    }
    if !thrust_is_finite(&forces) {
        problems.push(FieldError::new("forces", "the nozzles of all thrusters together are too strong"));
    }
    (forces, springs_to)
}

/// A force that needs no other body. The fields of errors are from the force on.
fn alone(body: &BodyModel, force: &ForceModel) -> Result<Force, FieldError> {
    Ok(match *force {
        ForceModel::Damping { linear, angular } => {
            Force::Damping { linear: rate("linear", linear)?, angular: rate("angular", angular)? }
        }
        ForceModel::GravityScale(scale) => Force::GravityScale(finite("", scale)?),
        ForceModel::Drag { linear: None, angular: None } => {
            return Err(FieldError::new("", "needs linear or angular"));
        }
        ForceModel::Drag { linear, angular } => {
            Force::Drag { linear: coefficients("linear", linear)?, angular: coefficients("angular", angular)? }
        }
        ForceModel::Wind(ref velocity) => Force::Wind(finite_triple("", velocity)?.to_array()),
        ForceModel::Magnus { coefficient } => Force::Magnus { coefficient: number("coefficient", coefficient)? },
        ForceModel::Thruster { ref force, ref point, throttle } => Force::Thruster {
            force: finite_triple("force", force)?.to_array(),
            point: or_zero("point", point)?,
            throttle: number("throttle", throttle.unwrap_or(1.0))?,
        },
        ForceModel::ConstantWrench { force: None, torque: None, .. } => {
            return Err(FieldError::new("", "needs force or torque"));
        }
        ForceModel::ConstantWrench { ref force, ref torque, frame } => Force::ConstantWrench {
            force: or_zero("force", force)?,
            torque: or_zero("torque", torque)?,
            frame: frame.into(),
        },
        ForceModel::SpringToPoint { ref anchor, ref attachment, rest_length, stiffness, damping } => {
            Force::SpringToPoint {
                anchor: finite_triple("anchor", anchor)?.to_array(),
                attachment: or_zero("attachment", attachment)?,
                rest_length: not_negative("rest_length", rest_length)?,
                stiffness: not_negative("stiffness", stiffness)?,
                damping: not_negative("damping", damping)?,
            }
        }
        ForceModel::PointGravity { ref center, mu, softening } => Force::PointGravity {
            center: or_zero("center", center)?,
            mu: number("mu", mu)?,
            softening: softening_length(softening)?,
        },
        ForceModel::GravityMass { mu, softening } => {
            Force::GravityMass { mu: gravity_of(body, mu)?, softening: softening_length(softening)? }
        }
        ForceModel::Buoyancy { density, level, ref hull, ref center } => {
            let hull = crate::convert::forces::hull(body, hull.as_ref())?;
            let density = not_negative("density", density.unwrap_or(WATER))?;
            number("density", density * hull.volume()).map_err(|_| FieldError::new("hull", "displaces too much"))?;
            Force::Buoyancy { density, level: finite("level", level)?, hull, center: or_zero("center", center)? }
        }
        ForceModel::AngularVelocityServo { ref target, frame, max_torque } => Force::AngularVelocityServo {
            target: finite_triple("target", target)?.to_array(),
            frame: frame.into(),
            max_torque: max_torque.map(|torque| not_negative("max_torque", torque)).transpose()?,
        },
        // The caller has that one checked with the body it leads to.
        ForceModel::Spring { .. } => return Err(FieldError::new("to", "needs another body")),
    })
}

/// The index of the body that a spring leads to.
fn other(to: &str, index: usize, others: Others<'_>) -> Result<usize, FieldError> {
    match find("body", to, others.by_name) {
        Ok(other) if other == index => Err(FieldError::new("to", format!("{to:?} is the body itself"))),
        Ok(other) => Ok(other),
        Err(problem) => Err(FieldError::new("to", problem)),
    }
}

fn spring(body: &BodyModel, force: &ForceModel, other: Option<&BodyModel>) -> Result<Force, FieldError> {
    let ForceModel::Spring { to, attachment, attachment_to, rest_length, stiffness, damping } = force else {
        return alone(body, force);
    };
    let attachment = or_zero("attachment", attachment)?;
    let attachment_to = or_zero("attachment_to", attachment_to)?;
    let rest_length = match (rest_length, other) {
        (Some(length), _) => *length,
        (None, Some(other)) => (world_point(body, attachment) - world_point(other, attachment_to)).length(),
        (None, None) => 0.0,
    };
    Ok(Force::Spring {
        to: to.clone(),
        attachment,
        attachment_to,
        rest_length: not_negative("rest_length", rest_length)?,
        stiffness: not_negative("stiffness", *stiffness)?,
        damping: not_negative("damping", *damping)?,
    })
}

/// Where a point of the body's frame is at the start \[m\], in the engine's precision: a spring is
/// to be at rest there, not nearly so. Of a body that has no place the error is its own.
fn world_point(body: &BodyModel, point: [f64; 3]) -> DVec3 {
    let position = body.position.map_or(DVec3::ZERO, |position| DVec3::from_array(position.0));
    let orientation = crate::convert::ground::orientation(body).ok().flatten();
    let turned = orientation.unwrap_or(DQuat::IDENTITY) * DVec3::from_array(point);
    DVec3::from_array(double_vector(real_vector(position))) + turned
}

/// Gravitational constant times mass [m^3/s^2], given or that of the body's mass.
fn gravity_of(body: &BodyModel, mu: Option<f64>) -> Result<f64, FieldError> {
    match mu.or(body.mass.map(|mass| GravityMass::CONSTANT * mass)) {
        Some(mu) => number("mu", mu),
        None => number("mu", GravityMass::CONSTANT * mass_of(body)?),
    }
}

/// The mass of a body that was not given one \[kg\].
fn mass_of(body: &BodyModel) -> Result<f64, FieldError> {
    let properties = crate::convert::shape(body.shape.as_ref()).ok().and_then(|shape| match body.density {
        Some(density) => shape.mass_properties(tumble::Amount::Density(density)).ok(),
        None => shape.own_mass_properties().ok(),
    });
    match properties {
        Some(properties) => Ok(properties.mass()),
        None => Err(FieldError::new("mu", "is missing, and the body has no mass to take it from")),
    }
}

/// The hull given, or the body's own shape.
fn hull(body: &BodyModel, hull: Option<&HullModel>) -> Result<HullShape, FieldError> {
    let (field, hull) = match (hull, &body.shape) {
        (Some(HullModel::Sphere { radius }), _) => ("hull.sphere", HullShape::Sphere { radius: *radius }),
        (Some(HullModel::Cuboid { half_extents }), _) => {
            ("hull.cuboid", HullShape::Cuboid { half_extents: half_extents.0 })
        }
        (None, Some(ShapeModel::Sphere { radius } | ShapeModel::HollowSphere { radius })) => {
            ("hull", HullShape::Sphere { radius: *radius })
        }
        (None, Some(ShapeModel::Cuboid { half_extents })) => {
            ("hull", HullShape::Cuboid { half_extents: half_extents.0 })
        }
        (None, shape) => {
            let shape = shape.as_ref().map_or("point", ShapeModel::name);
            let problem = format!("is missing: only a sphere or cuboid is its own hull, and the body is a {shape}");
            return Err(FieldError::new("hull", problem));
        }
    };
    let length = |name: &str, length| {
        positive(name, length).and_then(|length| number(name, length)).map_err(|error| error.inside(field))
    };
    match hull {
        HullShape::Sphere { radius } => length("radius", radius).map(|_| hull),
        HullShape::Cuboid { half_extents } => {
            half_extents.into_iter().try_for_each(|half| length("half_extents", half).map(|_| ()))?;
            Ok(hull)
        }
    }
}

impl HullShape {
    /// \[m^3\]
    fn volume(&self) -> f64 {
        match self {
            Self::Sphere { radius } => std::f64::consts::PI * radius * radius * radius * 4.0 / 3.0,
            Self::Cuboid { half_extents } => 8.0 * half_extents.iter().product::<f64>(),
        }
    }
}

impl From<FrameModel> for Frame {
    fn from(model: FrameModel) -> Self {
        match model {
            FrameModel::World => Self::World,
            FrameModel::Body => Self::Body,
        }
    }
}

fn or_zero(field: &str, vector: &Option<Triple>) -> Result<[f64; 3], FieldError> {
    vector.as_ref().map_or(Ok([0.0; 3]), |vector| finite_triple(field, vector).map(|vector| vector.to_array()))
}

fn coefficients(field: &str, numbers: Option<PerAxis>) -> Result<[f64; 3], FieldError> {
    let numbers = numbers.map_or([0.0; 3], |numbers| numbers.to_triple().0);
    numbers.into_iter().try_for_each(|number| not_negative(field, number).map(|_| ()))?;
    Ok(numbers)
}

/// A length whose square has room \[m\].
fn softening_length(length: f64) -> Result<f64, FieldError> {
    finite("softening", not_negative("softening", length)?)
}
