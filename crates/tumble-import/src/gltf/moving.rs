//! Bodies that move: their mass, inertia and velocity.

use glam::DVec3;
use tumble::{Amount, InertiaTensor, MassProperties, PrincipalInertia, RigidBody, Shape};

use crate::checked::{real, real_vector};
use crate::error::FieldError;
use crate::gltf::PhysicsNode;
use crate::gltf::{Motion, MotionKind};
use crate::inertia_repair::{InertiaRepairs, nearest_moments, repair_notice};

/// Density of what has colliders and neither mass nor density: that of water [kg/m^3].
const DENSITY: f64 = 1000.0;

/// Moments that the file calls infinite are this many times the largest finite one: as many as
/// single precision tells apart from infinitely many, leaving room for a spin about the finite
/// axis.
const INFINITE_MOMENT: f64 = 1e5;

/// Radius of the ball that stands for a body without a shape \[m\].
const WITHOUT_SHAPE: f64 = 0.5;

/// A body that moves by itself or by forces, at the origin. What there is to tell goes to
/// `notices`.
pub(crate) fn moving(
    node: &PhysicsNode,
    motion: &Motion,
    shape: Option<&Shape>,
    repairs: InertiaRepairs,
    notices: &mut Vec<String>,
) -> Result<RigidBody, FieldError> {
    let infinite_mass = motion.mass == Some(f64::INFINITY);
    let never_turns = motion.inertia_diagonal.is_some_and(|moments| moments.min_element().is_infinite());
    if motion.kind == MotionKind::Kinematic {
        return Ok(kinematic(node, shape, notices));
    }
    if infinite_mass && (never_turns || motion.inertia_diagonal.is_none()) {
        notices.push("has infinite mass and inertia: it is kinematic".to_owned());
        return Ok(kinematic(node, shape, notices));
    }
    let properties = mass_properties(node, motion, shape, notices)?;
    let mut body = RigidBody::new(Shape::Point)
        .mass(properties.mass())
        .center_of_mass(properties.center_of_mass())
        .linear_velocity(real_vector(node.linear_velocity()));
    let gravity = if infinite_mass { 0.0 } else { motion.gravity_factor };
    if infinite_mass {
        notices.push(
            "has infinite mass: gravity does not move it, other forces would, as if it had that of its shape"
                .to_owned(),
        );
    }
    if gravity != 1.0 {
        body = body.gravity_scale(real(gravity));
    }
    if never_turns {
        if node.angular_velocity() != DVec3::ZERO {
            notices.push("has infinite inertia and an angularVelocity: it is left without".to_owned());
        }
        return Ok(body);
    }
    let inertia = inertia(motion, &properties, repairs, notices)?;
    Ok(body.principal_inertia(inertia).angular_velocity(real_vector(node.angular_velocity())))
}

/// A body that moves with its velocities, which the engine takes for those of its frame's origin
/// and the file for those of the centre of mass.
fn kinematic(node: &PhysicsNode, shape: Option<&Shape>, notices: &mut Vec<String>) -> RigidBody {
    let computed = || Some(shape?.mass_properties(Amount::Density(1.0)).ok()?.center_of_mass());
    let from_origin = match node.center_of_mass() {
        Some(center) => center - node.position,
        None => node.rotation * computed().unwrap_or_default(),
    };
    let angular = node.angular_velocity();
    let around = angular.cross(from_origin);
    if around != DVec3::ZERO {
        notices.push("is kinematic and turns about its node's origin, not about its centre of mass".to_owned());
    }
    RigidBody::new(shape.cloned().unwrap_or(Shape::Point))
        .kinematic()
        .linear_velocity(real_vector(node.linear_velocity() - around))
        .angular_velocity(real_vector(angular))
}

/// What the file says, and what follows from the shape where it is silent.
fn mass_properties(
    node: &PhysicsNode,
    motion: &Motion,
    shape: Option<&Shape>,
    notices: &mut Vec<String>,
) -> Result<MassProperties, FieldError> {
    if shape.is_none() && motion.inertia_diagonal.is_none() {
        let ball = format!("it has the inertia of a ball of radius {WITHOUT_SHAPE} m");
        notices.push(format!("has no inertiaDiagonal and no collider with a volume: {ball}"));
    }
    let amount = match (motion.mass, shape) {
        (Some(mass), _) if mass.is_finite() => Amount::Mass(mass),
        (Some(_), Some(_)) => Amount::Density(DENSITY),
        (Some(_), None) => Amount::Mass(1.0),
        (None, Some(_)) => {
            notices.push(format!("has no mass: it is that of its colliders at {DENSITY} kg/m3"));
            Amount::Density(DENSITY)
        }
        (None, None) => {
            notices.push("has no mass and no collider with a volume: it is 1 kg".to_owned());
            Amount::Mass(1.0)
        }
    };
    let ball = Shape::sphere(WITHOUT_SHAPE);
    let properties = shape.unwrap_or(&ball).mass_properties(amount);
    let properties = properties.map_err(|error| FieldError::new("motion.mass", error))?;
    match motion.center_of_mass {
        None => Ok(properties),
        Some(center) => {
            properties.centered_at(node.scale * center).map_err(|error| FieldError::new("motion.centerOfMass", error))
        }
    }
}

fn inertia(
    motion: &Motion,
    properties: &MassProperties,
    repairs: InertiaRepairs,
    notices: &mut Vec<String>,
) -> Result<PrincipalInertia, FieldError> {
    let Some(mut moments) = motion.inertia_diagonal else {
        let of_shape = properties.inertia().map(|inertia| inertia.principal());
        return of_shape.map_err(|error| FieldError::new("motion", format!("has colliders whose {error}")));
    };
    let field = |problem: &dyn std::fmt::Display| FieldError::new("motion.inertiaDiagonal", problem);
    let infinite = moments.to_array().into_iter().filter(|moment| moment.is_infinite()).count();
    if infinite == 1 {
        return Err(field(
            &"one infinite moment beside two finite ones is that of no body: two or three can be infinite",
        ));
    }
    if infinite > 1 {
        let finite = moments.min_element();
        moments = moments.min(DVec3::splat(INFINITE_MOMENT * finite));
        notices.push(format!("has infinite moments of inertia: they are {INFINITE_MOMENT} times its finite one"));
    }
    let impossible = match InertiaTensor::from_principal(moments, motion.inertia_orientation) {
        Ok(_) => return Ok(PrincipalInertia { moments, axes: motion.inertia_orientation }),
        Err(error) => error,
    };
    let Some((nearest, away)) = nearest_moments(moments) else { return Err(field(&impossible)) };
    if repairs == InertiaRepairs::Refused {
        return Err(field(&format_args!("{impossible}; --repair takes the nearest possible")));
    }
    notices.push(repair_notice(moments, nearest, away));
    moments = nearest;
    Ok(PrincipalInertia { moments, axes: motion.inertia_orientation })
}
