//! Bodies out of nodes: which there are, where they are, and what they consist of.

use std::collections::{BTreeMap, HashMap, HashSet};

use glam::{DQuat, DVec3};
use tumble::{Amount, BodyId, Part, RigidBody, Shape};

use crate::bodies::appearance::Appearance;
use crate::bodies::imported_body::ImportedBody;
use crate::bodies::imported_collider::{ColliderRole, ImportedCollider};
use crate::bodies::imported_joint::ImportedJoint;
use crate::checked::{MAX_NAME_BYTES, check_name, real_quaternion, real_vector};
use crate::error::FieldError;
use crate::gltf::Geometry;
use crate::gltf::MotionKind;
use crate::gltf::SurfaceMaterial;
use crate::gltf::collider::{Colliders, collider, is_ground};
use crate::gltf::groups;
use crate::gltf::joints::{WORLD, joints};
use crate::gltf::moving::moving;
use crate::gltf::solid::solid;
use crate::gltf::tree::Tree;
use crate::gltf::triangles::Triangles;
use crate::gltf::unsupported::listed;
use crate::gltf::{Physics, PhysicsNode};
use crate::inertia_repair::InertiaRepairs;

/// Most lines of notices about bodies.
const MAX_NOTICES: usize = 50;

/// A body of the file, or what is wrong with it.
///
/// ```
/// use tumble_import::InertiaRepairs;
/// use tumble_import::gltf::GltfBodies;
///
/// let text = r#"{ "asset": { "version": "2.0" }, "nodes": [
/// { "name": "ball", "extensions": { "KHR_physics_rigid_bodies": { "motion": { "mass": 1,
///     "inertiaDiagonal": [1, 1, 9] } } } } ] }"#;
/// let file = GltfBodies::from_bytes(text.as_bytes(), None, "ball.gltf", InertiaRepairs::Refused)?;
/// assert!(file.bodies[0].body.is_err());
/// # Ok::<(), tumble_import::FileError>(())
/// ```
#[derive(Clone, Debug)]
pub struct GltfBody {
    /// The name of its node, or one made from the node's index.
    pub name: String,
    /// The body, its [`BodyId`] its index in the file.
    pub body: Result<ImportedBody, FieldError>,
}

/// What the bodies of a document have in common while they are made.
struct Made<'a, 'b> {
    triangles: &'a mut Triangles<'b>,
    /// Colliders of meshes, which are made once for all bodies that have the same.
    colliders: Colliders,
    repairs: InertiaRepairs,
}

/// Notices about nodes: which node, and what.
type Notices = Vec<(usize, String)>;

/// The bodies of a scene: one for every motion, and one for every collider or trigger that nothing
/// carries; the joints between them; and what there is to tell of both.
pub(crate) fn bodies(
    (physics, tree): (&Physics, &Tree),
    triangles: &mut Triangles<'_>,
    repairs: InertiaRepairs,
) -> (Vec<GltfBody>, Vec<ImportedJoint>, Vec<String>) {
    let mut carried: BTreeMap<usize, Vec<&PhysicsNode>> = BTreeMap::new();
    for node in &physics.nodes {
        if node.motion.is_some() {
            carried.entry(node.index).or_default();
        }
        // OMI's holders of colliders and both's compounds of triggers are nothing by themselves.
        let collider = node.collider.as_ref().and_then(|collider| collider.geometry);
        if collider.or_else(|| node.trigger.as_ref()?.geometry).is_some() {
            carried.entry(node.body.unwrap_or(node.index)).or_default().push(node);
        }
    }
    let mut notices = Notices::new();
    let mut names = BodyNames::default();
    let mut bodies = Vec::with_capacity(carried.len());
    let mut made = Made { triangles, colliders: HashMap::new(), repairs };
    let mut nodes = Vec::with_capacity(carried.len());
    for (index, parts) in carried {
        let Some(node) = physics.node(index) else { continue };
        nodes.push(index);
        let name = names.of(node);
        let id = BodyId(bodies.len() as u64);
        let body = body(node, &parts, id, &mut made, &mut notices);
        bodies.push(GltfBody { name, body });
    }
    let joints = joints((physics, tree), &nodes, &mut bodies, || names.unique(WORLD, "still"), &mut notices);
    let mut told = grouped(physics, &notices);
    told.extend(groups::assign(bodies.iter_mut().filter_map(|body| body.body.as_mut().ok())));
    (bodies, joints, told)
}

/// What is said of many nodes is said once, with their names.
fn grouped(physics: &Physics, notices: &Notices) -> Vec<String> {
    let mut nodes_of: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (node, notice) in notices {
        nodes_of.entry(notice).or_default().push(*node);
    }
    let called = |index: usize| physics.node(index).and_then(|node| node.name.as_deref());
    let left_out = nodes_of.len().saturating_sub(MAX_NOTICES);
    let mut lines: Vec<String> =
        nodes_of.into_iter().take(MAX_NOTICES).map(|(notice, nodes)| listed(notice, &nodes, called)).collect();
    if left_out > 0 {
        lines.push(format!("and {left_out} more"));
    }
    lines
}

/// Names that are a scene's: not empty, not too long, none twice.
#[derive(Default)]
struct BodyNames(HashSet<String>);

impl BodyNames {
    fn of(&mut self, node: &PhysicsNode) -> String {
        let given = node.name.as_deref().filter(|name| check_name(name).is_ok());
        let number = format!("node-{}", node.index);
        self.unique(given.unwrap_or(&number), &number)
    }

    /// The name itself or, if it is taken, with what tells it apart and a count behind it.
    fn unique(&mut self, given: &str, mark: &str) -> String {
        let mut name = given.to_owned();
        // With room for what is added.
        let base: String = name.chars().take(MAX_NAME_BYTES / 8).collect();
        let mut tries = 0_usize;
        while !self.0.insert(name.clone()) {
            tries += 1;
            // Other nodes may bear such names already.
            let again = if tries == 1 { String::new() } else { format!(", {tries}") };
            name = format!("{base} ({mark}{again})");
        }
        name
    }
}

fn body(
    node: &PhysicsNode,
    parts: &[&PhysicsNode],
    id: BodyId,
    made: &mut Made<'_, '_>,
    notices: &mut Notices,
) -> Result<ImportedBody, FieldError> {
    let mut pieces = Vec::new();
    for part in parts {
        pieces_of(part, node, made.triangles, &mut pieces, notices)?;
    }
    let shape = together(&pieces, |piece| piece.role == ColliderRole::Solid);
    let built = match node.motion.filter(|motion| motion.kind != MotionKind::Static) {
        None => RigidBody::new(shape.clone().unwrap_or(Shape::Point)).fixed(),
        Some(motion) => {
            let mut told = Vec::new();
            let built =
                moving(node, &motion, shape.as_ref(), made.repairs, &mut told).map_err(|error| of(node, error))?;
            notices.extend(told.into_iter().map(|notice| (node.index, notice)));
            built
        }
    };
    let body = built
        .id(id)
        .without_collider()
        .position(real_vector(node.position))
        .orientation(real_quaternion(node.rotation))
        .build()
        .map_err(|error| of(node, FieldError::new(field_of_motion(&error.field()), error)))?;
    let mut told = Vec::new();
    let is_moved = body.properties().is_some();
    let collider = collider(&pieces, shape.as_ref(), is_moved, &mut made.colliders, &mut told);
    notices.extend(told.into_iter().map(|notice| (node.index, notice)));
    let appearance = match pieces.as_slice() {
        _ if !is_moved && is_ground(&pieces) => Appearance::HalfSpace,
        [ImportedCollider { surface: Some(surface), geometry, position, orientation, .. }]
            if !matches!(geometry, Geometry::Mesh { convex_hull: true, .. })
                && (*position, *orientation) == (DVec3::ZERO, DQuat::IDENTITY) =>
        {
            Appearance::Mesh(surface.clone())
        }
        // What is seen is also what only notices.
        _ => Appearance::Shape(shape.or_else(|| together(&pieces, |_| true)).unwrap_or(Shape::Point)),
    };
    Ok(ImportedBody { body, appearance, collider, pieces })
}

/// The shapes of some pieces as one, each as heavy as it is large; `None` if none has a volume.
fn together(pieces: &[ImportedCollider], wanted: impl Fn(&ImportedCollider) -> bool) -> Option<Shape> {
    let part = |piece: &ImportedCollider| {
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
    pieces: &mut Vec<ImportedCollider>,
    notices: &mut Notices,
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
        let in_node = |error: FieldError| of(part, error.inside(kind));
        let solid = solid(&geometry, part.scale, triangles).map_err(in_node)?;
        let (position, mut orientation) = (to_body * (part.position - body.position), to_body * part.rotation);
        if part.index == body.index {
            // Exactly: the product has roundings.
            orientation = DQuat::IDENTITY;
        }
        let name = part.name.clone().unwrap_or_else(|| format!("node-{}", part.index));
        let collider = ImportedCollider {
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
        notices.extend(solid.notices.into_iter().map(|notice| (part.index, format!("a {kind} {notice}"))));
        pieces.push(collider);
    }
    Ok(())
}

/// An error with the node that it is of.
fn of(node: &PhysicsNode, error: FieldError) -> FieldError {
    match &node.name {
        Some(name) => error.of_node(node.index, name),
        None => error.inside(&format!("nodes[{}]", node.index)),
    }
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
