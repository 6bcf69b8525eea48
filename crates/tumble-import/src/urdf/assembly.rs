//! Links and joints that nothing is wrong with to bodies and joints between them.

use tumble::math::Real;
use tumble::{Amount, Axes, BodyId, Drive, Drives, JointFriction, Limits, MassProperties, Part, RigidBody, Shape};
use tumble_math::MassError;

use crate::bodies::appearance::Appearance;
use crate::bodies::imported_body::ImportedBody;
use crate::bodies::imported_gear::ImportedGear;
use crate::bodies::imported_joint::{ImportedJoint, angles, frame_on, hard};
use crate::checked::{real, real_quaternion, real_vector};
use crate::error::FieldError;
use crate::limits::MAX_PARTS;
use crate::terminal::one_line;
use crate::urdf::RobotLink;
use crate::urdf::frame::Frame;
use crate::urdf::joint::{Joint, Kind};
use crate::urdf::link::{Inertial, Link};
use crate::urdf::mimic;
use crate::urdf::tree::Tree;
use crate::urdf::welds::Welds;

/// The bodies of a robot and what connects them.
pub(crate) struct Assembly {
    pub(crate) links: Vec<RobotLink>,
    pub(crate) joints: Vec<ImportedJoint>,
    pub(crate) gears: Vec<ImportedGear>,
    /// The links to which joints lead that would follow others, in order.
    pub(crate) not_geared: Vec<usize>,
    pub(crate) welds: Welds,
    /// Of each link whether it is a body or part of one.
    pub(crate) is_body: Vec<bool>,
}

impl Assembly {
    pub(crate) fn of(links: &[Link], tree: &Tree) -> Self {
        let welds = Welds::of(links, tree);
        let mut indices: Vec<Option<usize>> = vec![None; links.len()];
        let mut bodies: Vec<RobotLink> = Vec::new();
        for (head, members) in welds.links_by_head().into_iter().enumerate() {
            let Some(link) = links.get(head).filter(|_| !members.is_empty()) else { continue };
            let is_fixed = welds.fixed == Some(head);
            let has_inertial = members.iter().any(|link| links[*link].inertial.is_some());
            let holds_others = is_fixed && leads_on(tree, &welds, head);
            if !(has_inertial || holds_others) {
                continue;
            }
            let placed: Vec<(&Link, Frame)> = members.iter().map(|link| (&links[*link], welds.within[*link])).collect();
            let body = body(&placed, (tree.frames[head], is_fixed, bodies.len() as u64));
            indices[head] = Some(bodies.len());
            bodies.push(RobotLink { name: link.name.clone(), body: body.map_err(|problem| vec![problem]) });
        }
        let mut joints = Vec::new();
        let mut assembled = vec![None; tree.joints.len()];
        let not_floating = tree.joints.iter().zip(&mut assembled).filter(|(joint, _)| joint.kind != Kind::Floating);
        for (joint, place) in not_floating {
            let [Some(a), Some(b)] = [joint.parent, joint.child].map(|link| indices[welds.heads[link]]) else {
                continue;
            };
            // What is welded, or held, is in one body.
            if a == b {
                continue;
            }
            let made = match (&bodies[a].body, &bodies[b].body) {
                (Ok(parent), Ok(child)) => between(joint, [a, b], [parent, child], &welds),
                _ => continue,
            };
            match made {
                Ok(joint) => {
                    *place = Some(joints.len());
                    joints.push(joint);
                }
                Err(problem) => bodies[b].body = Err(vec![problem]),
            }
        }
        let is_body = welds.heads.iter().map(|head| indices[*head].is_some()).collect();
        let (gears, not_geared) = mimic::gears(&tree.joints, &assembled);
        Self { links: bodies, joints, gears, not_geared, welds, is_body }
    }
}

/// Whether a joint leads from the body with this head to another.
fn leads_on(tree: &Tree, welds: &Welds, head: usize) -> bool {
    let mut joints = tree.joints.iter().filter(|joint| joint.kind != Kind::Floating);
    joints.any(|joint| welds.heads[joint.parent] == head && welds.heads[joint.child] != head)
}

/// A body whose frame is that of the first of its links. What it looks like has no part in its mass
/// properties.
fn body(links: &[(&Link, Frame)], (frame, is_fixed, id): (Frame, bool, u64)) -> Result<ImportedBody, FieldError> {
    let heavy: Vec<(&Inertial, Frame)> =
        links.iter().filter_map(|(link, within)| Some((link.inertial.as_ref()?, *within))).collect();
    let body = match heavy.as_slice() {
        _ if is_fixed => RigidBody::new(Shape::Point).fixed(),
        // Exactly as the file has it.
        [(only, within)] if *within == Frame::IDENTITY => {
            RigidBody::new(Shape::Point).mass(only.mass).center_of_mass(only.center_of_mass).inertia(only.tensor)
        }
        _ => {
            let welded = welded(&heavy).map_err(|error| FieldError::new("inertial", error))?;
            let tensor = welded.inertia().map_err(|error| FieldError::new("inertial", error))?;
            RigidBody::new(Shape::Point).mass(welded.mass()).center_of_mass(welded.center_of_mass()).inertia(tensor)
        }
    };
    let body = body.position(real_vector(frame.position)).orientation(real_quaternion(frame.orientation));
    let body = body.id(BodyId(id)).build().map_err(|error| FieldError::new("inertial", error))?;
    let appearance = shape(links).unwrap_or_else(|| {
        let point = |(mass, center)| Shape::compound([Part::new(Shape::Point, Amount::Mass(mass)).at(center)]);
        body.properties().map_or(Shape::Point, |it| point((it.mass(), it.center_of_mass())))
    });
    Ok(ImportedBody { body, appearance: Appearance::Shape(appearance), collider: None, pieces: Vec::new() })
}

/// Mass properties of links that are fixed to each other, in the frame of their body.
fn welded(links: &[(&Inertial, Frame)]) -> Result<MassProperties, MassError> {
    let mut sum: Option<MassProperties> = None;
    for (inertial, frame) in links {
        let link = MassProperties::new(inertial.mass, inertial.center_of_mass, inertial.tensor)?;
        let link = if *frame == Frame::IDENTITY { link } else { link.transformed(frame.position, frame.orientation)? };
        sum = Some(sum.map_or(link, |sum| sum + link));
    }
    sum.ok_or(MassError::NoParticles)
}

/// What links look like together.
fn shape(links: &[(&Link, Frame)]) -> Option<Shape> {
    let mut parts: Vec<Part> = Vec::new();
    for (link, frame) in links {
        let Some(Shape::Compound(own)) = &link.shape else { continue };
        let moved = own.iter().take(MAX_PARTS - parts.len().min(MAX_PARTS)).map(|part| {
            if *frame == Frame::IDENTITY {
                return part.clone();
            }
            let inner = frame.then(Frame { position: part.position, orientation: part.orientation });
            Part { position: inner.position, orientation: inner.orientation, ..part.clone() }
        });
        parts.extend(moved);
    }
    if parts.is_empty() { None } else { Some(Shape::compound(parts)) }
}

/// A joint between the bodies of its links.
fn between(
    joint: &Joint,
    bodies: [usize; 2],
    [parent, child]: [&ImportedBody; 2],
    welds: &Welds,
) -> Result<ImportedJoint, FieldError> {
    let far = || {
        let field = one_line(&format!("joint {:?}.origin", joint.name));
        FieldError::new(field, "is more than 1e9 m from the centre of mass of a body")
    };
    let on = |body: &ImportedBody, frame: Frame| {
        frame_on(body, frame.position, frame.orientation * joint.to_axis).ok_or_else(far)
    };
    let frames = [on(parent, welds.within[joint.parent].then(joint.origin))?, on(child, welds.within[joint.child])?];
    let (free, axis) = match joint.kind {
        Kind::Revolute | Kind::Continuous => (Axes::ANGULAR_X, Some(Axes::ANGULAR_X)),
        Kind::Prismatic => (Axes::LINEAR_X, Some(Axes::LINEAR_X)),
        // The axis is the normal.
        Kind::Planar => (Axes::LINEAR_Y | Axes::LINEAR_Z | Axes::ANGULAR_X, None),
        Kind::Fixed => (Axes::NONE, None),
        Kind::Floating => (Axes::LINEAR | Axes::ANGULAR, None),
    };
    let range = joint.limit.and_then(|limit| match joint.kind {
        Kind::Revolute => angles(limit.lower, limit.upper),
        Kind::Prismatic => Some([limit.lower, limit.upper]),
        _ => None,
    });
    let positive = |value: f64| Some(real(value)).filter(|value: &Real| *value > 0.0);
    let damper = |(axis, damping)| Drives::from(Drive::velocity(axis, 0.0).with_stiffness(0.0, damping));
    Ok(ImportedJoint {
        name: joint.name.clone(),
        bodies,
        frames,
        free,
        contacts_enabled: false,
        limits: axis.zip(range).map(|(axis, range)| Limits::along(axis, hard(range))),
        drives: axis.zip(positive(joint.damping)).map(damper),
        friction: axis.zip(positive(joint.friction)).map(|(axis, max)| JointFriction::along(axis, max)),
        max_effort: joint.limit.and_then(|limit| limit.effort),
        max_speed: joint.limit.and_then(|limit| limit.velocity),
    })
}

/// Every link that is a body or has a problem by itself, as they are listed where something is
/// wrong with the robot.
pub(crate) fn one_by_one(links: &[Link], frames: &[Frame]) -> Vec<RobotLink> {
    let mut found = Vec::with_capacity(links.len());
    for (link, frame) in links.iter().zip(frames) {
        let body = if !link.problems.is_empty() {
            Err(link.problems.clone())
        } else if link.inertial.is_some() {
            body(&[(link, Frame::IDENTITY)], (*frame, false, found.len() as u64)).map_err(|problem| vec![problem])
        } else {
            continue;
        };
        found.push(RobotLink { name: link.name.clone(), body });
    }
    found
}
