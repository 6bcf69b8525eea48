//! Bodies out of nodes: their mass, inertia, pose and velocity.

use std::collections::{BTreeMap, HashMap};

use glam::{DQuat, DVec3};
use tumble::{Amount, BodyId, InertiaTensor, MassProperties, Part, RigidBody, Shape};

use super::geometry::Geometry;
use super::material::SurfaceMaterial;
use super::motion::{Motion, MotionKind};
use super::physics::{Physics, PhysicsNode};
use super::solid::solid;
use super::triangles::Triangles;
use crate::convert::{check_name, real, real_quaternion, real_vector};
use crate::error::FieldError;
use crate::looks::Looks;
use crate::scene_body::SceneBody;
use crate::{ColliderRole, SceneCollider};

/// Density of what has colliders and neither mass nor density: that of water [kg/m^3].
const DENSITY: f64 = 1000.0;

/// Moments that the file calls infinite are this many times the largest finite one: as many as single precision tells apart
/// from infinitely many, leaving room for a spin about the finite axis.
const INFINITE_MOMENT: f64 = 1e5;

/// Radius of the ball that stands for a body without a shape \[m\].
const WITHOUT_SHAPE: f64 = 0.5;

/// A body of the file, or what is wrong with it.
pub(crate) struct GltfBody {
    pub(crate) name: String,
    /// The node that it is.
    pub(crate) node: usize,
    pub(crate) body: Result<SceneBody, FieldError>,
}

/// The bodies of a scene: one for every motion, and one for every collider or trigger that nothing carries.
pub(super) fn bodies(physics: &mut Physics, triangles: &mut Triangles<'_>) -> Vec<GltfBody> {
    let mut carried: BTreeMap<usize, Vec<&PhysicsNode>> = BTreeMap::new();
    for node in &physics.nodes {
        if node.motion.is_some() {
            carried.entry(node.index).or_default();
        }
        if node.collider.is_some() || node.trigger.is_some() {
            carried.entry(node.body.unwrap_or(node.index)).or_default().push(node);
        }
    }
    let mut notices = Vec::new();
    let mut names = Names::default();
    let mut bodies = Vec::with_capacity(carried.len());
    for (index, parts) in carried {
        let Some(node) = physics.node(index) else { continue };
        let name = names.of(node);
        let id = BodyId(bodies.len() as u64);
        let mut own = Vec::new();
        let body = body(node, &parts, id, triangles, &mut own);
        notices.extend(own.into_iter().map(|notice| format!("nodes[{index}] {name:?}: {notice}")));
        bodies.push(GltfBody { name, node: index, body });
    }
    physics.notices.append(&mut notices);
    bodies
}

/// Names that are a scene's: not empty, not too long, none twice.
#[derive(Default)]
struct Names(HashMap<String, usize>);

impl Names {
    fn of(&mut self, node: &PhysicsNode) -> String {
        let numbered = format!("node-{}", node.index);
        let name = match &node.name {
            Some(name) if check_name(name).is_ok() && name.len() + numbered.len() < 250 => name.clone(),
            _ => numbered.clone(),
        };
        let name = if self.0.contains_key(&name) { format!("{name} ({numbered})") } else { name };
        self.0.insert(name.clone(), node.index);
        name
    }
}

fn body(
    node: &PhysicsNode,
    parts: &[&PhysicsNode],
    id: BodyId,
    triangles: &mut Triangles<'_>,
    notices: &mut Vec<String>,
) -> Result<SceneBody, FieldError> {
    let mut pieces = Vec::new();
    for part in parts {
        pieces_of(part, node, triangles, &mut pieces, notices)?;
    }
    let shape = together(&pieces, |piece| piece.role == ColliderRole::Solid);
    let built = match node.motion.filter(|motion| motion.kind != MotionKind::Static) {
        None => RigidBody::new(shape.clone().unwrap_or(Shape::Point)).fixed(),
        Some(motion) => moving(node, &motion, shape.as_ref(), notices)?,
    };
    let body = built
        .id(id)
        .position(real_vector(node.position))
        .orientation(real_quaternion(node.rotation))
        .build()
        .map_err(|error| FieldError::new(field_of_motion(&error.field()), error))?;
    let looks = match pieces.as_slice() {
        [SceneCollider { surface: Some(surface), geometry, position, orientation, .. }]
            if matches!(geometry, Geometry::Mesh { convex_hull: false, .. })
                && (*position, *orientation) == (DVec3::ZERO, DQuat::IDENTITY) =>
        {
            Looks::Mesh(surface.clone())
        }
        // What is seen is also what only notices.
        _ => Looks::Shape(shape.or_else(|| together(&pieces, |_| true)).unwrap_or(Shape::Point)),
    };
    Ok(SceneBody { body, looks, forces: Vec::new(), springs_to: Vec::new(), colliders: pieces })
}

/// The shapes of some pieces as one, each as heavy as it is large; `None` if none has a volume.
fn together(pieces: &[SceneCollider], wanted: impl Fn(&SceneCollider) -> bool) -> Option<Shape> {
    let part = |piece: &SceneCollider| {
        let shape = piece.shape.clone()?;
        Some(Part::new(shape, Amount::Density(1.0)).at(piece.position).turned(piece.orientation))
    };
    let mut parts: Vec<Part> = pieces.iter().filter(|piece| wanted(piece)).filter_map(part).collect();
    match parts.as_slice() {
        [] => None,
        [only] if only.position == DVec3::ZERO && only.orientation == DQuat::IDENTITY => Some(parts.remove(0).shape),
        _ => Some(Shape::Compound(parts)),
    }
}

/// The collider and the trigger of a node, in the frame of the body that carries them.
fn pieces_of(
    part: &PhysicsNode,
    body: &PhysicsNode,
    triangles: &mut Triangles<'_>,
    pieces: &mut Vec<SceneCollider>,
    notices: &mut Vec<String>,
) -> Result<(), FieldError> {
    let to_body = body.rotation.conjugate();
    let collider = part.collider.as_ref().map(|collider| {
        let material = collider.material.clone().unwrap_or_default();
        (ColliderRole::Solid, collider.geometry, material, collider.filter.clone())
    });
    let trigger = part
        .trigger
        .as_ref()
        .map(|trigger| (ColliderRole::Trigger, trigger.geometry, SurfaceMaterial::default(), trigger.filter.clone()));
    for (role, geometry, material, filter) in collider.into_iter().chain(trigger) {
        let Some(geometry) = geometry else { continue };
        let kind = if role == ColliderRole::Trigger { "trigger" } else { "collider" };
        let in_node = |error: FieldError| error.inside(&format!("nodes[{}] {kind}", part.index));
        let solid = solid(&geometry, part.scale, triangles).map_err(in_node)?;
        let (position, mut orientation) = (to_body * (part.position - body.position), to_body * part.rotation);
        if part.index == body.index {
            // Exactly: the product has roundings.
            orientation = DQuat::IDENTITY;
        }
        let name = part.name.clone().unwrap_or_else(|| format!("node-{}", part.index));
        let collider = SceneCollider {
            name,
            role,
            geometry,
            shape: solid.shape,
            surface: solid.surface,
            position,
            orientation,
            material,
            filter,
        };
        let of = &collider.name;
        notices.extend(solid.notices.iter().map(|notice| format!("{kind} {of:?} {notice}")));
        pieces.push(collider);
    }
    Ok(())
}

/// A body that moves by itself or by forces.
fn moving(
    node: &PhysicsNode,
    motion: &Motion,
    shape: Option<&Shape>,
    notices: &mut Vec<String>,
) -> Result<RigidBody, FieldError> {
    let (linear, angular) = (node.linear_velocity(), node.angular_velocity());
    let with_velocity = |body: RigidBody, angular: DVec3| {
        body.linear_velocity(real_vector(linear)).angular_velocity(real_vector(angular))
    };
    let infinite_mass = motion.mass == Some(f64::INFINITY);
    let moments = motion.inertia_diagonal;
    let never_turns = moments.is_some_and(|moments| !moments.is_finite() && moments.min_element().is_infinite());
    let seen = shape.cloned().unwrap_or(Shape::Point);
    if motion.kind == MotionKind::Kinematic || (infinite_mass && moments.is_none_or(|_| never_turns)) {
        if infinite_mass && motion.kind != MotionKind::Kinematic {
            notices.push("has infinite mass and inertia: it is kinematic".to_owned());
        }
        let offset = node.center_of_mass().map_or(DVec3::ZERO, |center| center - node.position);
        if angular != DVec3::ZERO && offset != DVec3::ZERO {
            notices.push("is kinematic: it turns about its node's origin, not about its centerOfMass".to_owned());
        }
        return Ok(with_velocity(RigidBody::new(seen).kinematic(), angular));
    }
    let properties = mass_properties(node, motion, shape, notices)?;
    let mut body = RigidBody::new(Shape::Point).mass(properties.mass()).center_of_mass(properties.center_of_mass());
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
        if angular != DVec3::ZERO {
            notices.push("has infinite inertia and an angularVelocity: it is left without".to_owned());
        }
        return Ok(with_velocity(body, DVec3::ZERO));
    }
    let inertia = inertia(motion, &properties, notices)?;
    Ok(with_velocity(body.principal_inertia(inertia), angular))
}

/// What the file says, and what follows from the shape where it is silent.
fn mass_properties(
    node: &PhysicsNode,
    motion: &Motion,
    shape: Option<&Shape>,
    notices: &mut Vec<String>,
) -> Result<MassProperties, FieldError> {
    let ball = Shape::sphere(WITHOUT_SHAPE);
    let solid = shape.unwrap_or(&ball);
    let mass = motion.mass.filter(|mass| mass.is_finite());
    let silent = mass.is_none() && motion.mass.is_none();
    let amount = match (mass, shape) {
        (Some(mass), _) => Amount::Mass(mass),
        (None, Some(_)) => Amount::Density(DENSITY),
        (None, None) => Amount::Mass(1.0),
    };
    if shape.is_none() && motion.inertia_diagonal.is_none() {
        notices.push(format!("has no inertiaDiagonal and no collider with a volume: it has the inertia of a ball of radius {WITHOUT_SHAPE} m"));
    }
    if silent {
        notices.push(match shape {
            Some(_) => format!("has no mass: it is that of its colliders at {DENSITY} kg/m3"),
            None => "has no mass and no collider with a volume: it is 1 kg".to_owned(),
        });
    }
    let properties = solid.mass_properties(amount).map_err(|error| FieldError::new("motion.mass", error))?;
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
    notices: &mut Vec<String>,
) -> Result<tumble::PrincipalInertia, FieldError> {
    let wrong = |error: tumble::InertiaError| FieldError::new("motion.inertiaDiagonal", error);
    let Some(moments) = motion.inertia_diagonal else {
        return properties.inertia().map(|inertia| inertia.principal()).map_err(wrong);
    };
    let mut finite = moments;
    if !moments.is_finite() {
        let largest = moments.to_array().into_iter().filter(|moment| moment.is_finite()).fold(0.0, f64::max);
        finite = moments.min(DVec3::splat(INFINITE_MOMENT * largest));
        notices
            .push(format!("has infinite moments of inertia: they are {INFINITE_MOMENT} times its largest finite one"));
    }
    InertiaTensor::from_principal(finite, motion.inertia_orientation).map_err(wrong)?;
    Ok(tumble::PrincipalInertia { moments: finite, axes: motion.inertia_orientation })
}

/// The engine's name of a field as the file has it.
fn field_of_motion(field: &str) -> String {
    let own = match field {
        "mass" => "mass",
        "inertia" => "inertiaDiagonal",
        "center_of_mass" => "centerOfMass",
        "linear_velocity" => "linearVelocity",
        "angular_velocity" => "angularVelocity",
        "gravity_scale" => "gravityFactor",
        other => return other.to_owned(),
    };
    format!("motion.{own}")
}
