//! Joints out of nodes: between which bodies they are, and where.

use std::collections::HashMap;

use glam::{DQuat, DVec3};
use tumble::{BodyId, Drives, Limits, RigidBody, Shape};

use crate::bodies::appearance::Appearance;
use crate::bodies::imported_body::ImportedBody;
use crate::bodies::imported_joint::{ImportedJoint, frame_on};
use crate::error::FieldError;
use crate::gltf::bodies::GltfBody;
use crate::gltf::joint_axes::JointAxes;
use crate::gltf::tree::Tree;
use crate::gltf::{JointTo, Physics, PhysicsNode};

/// The name of what stands still where no body does.
pub(crate) const WORLD: &str = "world";

/// The nodes of a scene, and which bodies carry them.
struct Carriers<'a> {
    physics: &'a Physics,
    tree: &'a Tree,
    /// Of each node the body that carries it, by its index.
    bodies: Vec<Option<usize>>,
    /// The node of each body.
    nodes: &'a [usize],
}

/// One end of a joint.
struct End {
    /// `None` for what stands still and is no body.
    body: Option<usize>,
    /// In the frame of the body, or of the world.
    position: DVec3,
    orientation: DQuat,
}

/// The joints of a scene whose bodies are at these nodes, in order. Where one leads to what stands
/// still and is no body, such a body is added, with a name from `unique`. What is left out goes to
/// `notices`, with the node.
pub(crate) fn joints(
    (physics, tree): (&Physics, &Tree),
    nodes: &[usize],
    bodies: &mut Vec<GltfBody>,
    unique: impl FnOnce() -> String,
    notices: &mut Vec<(usize, String)>,
) -> Vec<ImportedJoint> {
    let carriers = Carriers::of(physics, tree, nodes);
    let ends: Vec<(&PhysicsNode, &JointTo, [End; 2])> = physics
        .nodes
        .iter()
        .filter_map(|node| Some((node, node.joint.as_ref()?)))
        .filter_map(|(node, to)| match carriers.ends(node, to, bodies) {
            Ok(ends) => Some((node, to, ends)),
            Err(problem) => {
                notices.push((node.index, format!("has a joint that is not simulated: {problem}")));
                None
            }
        })
        .collect();
    let world = bodies.len();
    if ends.iter().any(|(.., ends)| ends.iter().any(|end| end.body.is_none())) {
        bodies.push(GltfBody { name: unique(), body: still(world) });
    }
    let mut joints = Vec::with_capacity(ends.len());
    for (node, to, ends) in &ends {
        let [a, b] = ends.each_ref().map(|end| end.body.unwrap_or(world));
        let (Some(Ok(first)), Some(Ok(second))) =
            (bodies.get(a).map(|body| &body.body), bodies.get(b).map(|body| &body.body))
        else {
            notices.push((node.index, "has a joint to a body that is left out".to_owned()));
            continue;
        };
        let axes = JointAxes::of(&to.joint);
        notices
            .extend(axes.left_out.iter().map(|what| (node.index, format!("has a joint with {what}: not simulated"))));
        let frame = |end: &End, body| frame_on(body, end.position, end.orientation * axes.turned);
        let (Some(first), Some(second)) = (frame(&ends[0], first), frame(&ends[1], second)) else {
            notices.push((node.index, "has a joint that is not simulated: it is too far from its bodies".to_owned()));
            continue;
        };
        joints.push(ImportedJoint {
            name: node.name.clone().unwrap_or_else(|| format!("node-{}", node.index)),
            bodies: [a, b],
            frames: [first, second],
            free: axes.free,
            contacts_enabled: to.enable_collision,
            limits: Some(axes.limits).filter(|limits| *limits != Limits::default()),
            drives: Some(axes.drives).filter(|drives| *drives != Drives::default()),
            friction: None,
            max_effort: None,
            max_speed: None,
        });
    }
    joints
}

/// A body that does not move, at the origin.
fn still(index: usize) -> Result<ImportedBody, FieldError> {
    let body = RigidBody::new(Shape::Point).fixed().id(BodyId(index as u64)).build();
    let body = body.map_err(|error| FieldError::new("", error))?;
    Ok(ImportedBody { body, appearance: Appearance::Shape(Shape::Point), collider: None, pieces: Vec::new() })
}

impl<'a> Carriers<'a> {
    fn of(physics: &'a Physics, tree: &'a Tree, nodes: &'a [usize]) -> Self {
        let by_node: HashMap<usize, usize> = nodes.iter().enumerate().map(|(body, node)| (*node, body)).collect();
        let moves = |node: usize| physics.node(node).is_some_and(|node| node.motion.is_some());
        let moved = tree.inherited(|node| by_node.get(&node).copied().filter(|_| moves(node)));
        let nearest = tree.inherited(|node| by_node.get(&node).copied());
        let bodies = moved.into_iter().zip(nearest).map(|(moved, nearest)| moved.or(nearest)).collect();
        Self { physics, tree, bodies, nodes }
    }

    /// Both ends of a joint, or why it cannot act.
    fn ends(&self, node: &PhysicsNode, to: &JointTo, bodies: &[GltfBody]) -> Result<[End; 2], &'static str> {
        let first = self.end(node.index).ok_or("its node is not in the scene")?;
        let second = self.end(to.connected_node).ok_or("its connectedNode is not in the scene")?;
        if first.body == second.body {
            return Err("both its ends are the same body");
        }
        let moves = |end: &End| {
            let body = end.body.and_then(|body| bodies.get(body));
            // Of a body that is left out nothing is known.
            body.is_some_and(|body| body.body.as_ref().map_or(true, |body| body.body.properties().is_some()))
        };
        if moves(&first) || moves(&second) { Ok([first, second]) } else { Err("forces move neither of its ends") }
    }

    fn end(&self, node: usize) -> Option<End> {
        let place = self.tree.places.get(node).copied().flatten()?;
        let body = self.bodies.get(node).copied().flatten();
        let mut end = End { body, position: place.transform.translation, orientation: place.rotation };
        if let Some(carrier) = body.and_then(|body| self.physics.node(*self.nodes.get(body)?)) {
            let back = carrier.rotation.conjugate();
            end.position = back * (end.position - carrier.position);
            // Exactly: the product has roundings.
            end.orientation =
                if carrier.rotation == end.orientation { DQuat::IDENTITY } else { back * end.orientation };
        }
        Some(end)
    }
}
