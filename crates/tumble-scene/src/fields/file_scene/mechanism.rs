//! Bodies that joints hold together, and how they are placed and posed as one.

use hecs::{Entity, World};
use tumble_import::{FieldError, ImportedJoint};

use crate::convert::orientation::turned;
use crate::fields::file_scene::body_change::{body_frame, center_frame, model_frame, move_body};
use crate::fields::file_scene::joint_model::{joint_frame, single_axis};
use crate::model::joint_model::JointModel;
use crate::model::orientation_model::TurnModel;
use crate::model::scene_model::BodyModel;
use crate::values::tuple::Tuple;

/// Which bodies joints connect.
#[derive(Clone, Debug)]
pub(crate) struct Mechanisms {
    /// The bodies of each joint, in the order of the joints.
    joints: Vec<[usize; 2]>,
    /// Of each body the first one of its mechanism.
    first: Vec<usize>,
}

impl Mechanisms {
    pub(crate) fn new(bodies: usize, joints: impl Iterator<Item = [usize; 2]>) -> Self {
        let joints: Vec<_> = joints.collect();
        let first = connected(bodies, joints.iter().copied());
        Self { joints, first }
    }

    /// The first body of the mechanism that a body is in; the body itself if it is in none.
    pub(crate) fn of(&self, body: usize) -> usize {
        self.first.get(body).copied().unwrap_or(body)
    }

    /// Puts a body where `now` says, and all that joints hold with it.
    pub(crate) fn place(
        &self,
        body: usize,
        (was, now): (&BodyModel, &BodyModel),
        entities: &[Entity],
        world: &mut World,
    ) -> Result<(), FieldError> {
        let Some(&entity) = entities.get(body) else { return Ok(()) };
        if (now.position, now.orientation) == (was.position, was.orientation) {
            return Ok(());
        }
        let from = body_frame(world, entity);
        let to = model_frame(now, from)?;
        let mechanism = self.of(body);
        let members = entities.iter().zip(&self.first).filter(|(_, first)| **first == mechanism);
        members.map(|(member, _)| *member).try_for_each(|member| move_body(world, member, from, to))
    }

    /// Moves what hangs on the second body of a joint until the joint is at the position that `now`
    /// says.
    pub(crate) fn pose(
        &self,
        index: usize,
        joint: &ImportedJoint,
        (was, now): (&JointModel, &JointModel),
        entities: &[Entity],
        world: &mut World,
    ) -> Result<(), FieldError> {
        let (Some(before), Some(position), Some((axis, is_along))) = (was.position, now.position, single_axis(joint))
        else {
            return Ok(());
        };
        if position == before {
            return Ok(());
        }
        let [a, b] = joint.bodies;
        let others = self.joints.iter().enumerate().filter(|(other, _)| *other != index).map(|(_, ends)| *ends);
        let side = connected(entities.len(), others);
        let (Some(of_a), Some(of_b)) = (side.get(a), side.get(b)) else { return Ok(()) };
        if of_a == of_b {
            return Err(FieldError::new("position", "cannot vary: other joints connect the same bodies, in a loop"));
        }
        let Some(&first) = entities.get(a) else { return Ok(()) };
        let (origin, along) = joint_frame(joint, 0, center_frame(world, first));
        let moved = position - before;
        let to = match is_along {
            true => (origin + along * (axis * moved), along),
            false => (origin, along * turned(&TurnModel { axis: Tuple(axis.to_array()), angle: moved })?),
        };
        let members: Vec<_> = entities.iter().zip(&side).filter(|(_, it)| *it == of_b).map(|(it, _)| *it).collect();
        members.into_iter().try_for_each(|member| move_body(world, member, (origin, along), to))
    }
}

/// Of each body the first of those that it is connected with.
fn connected(bodies: usize, joints: impl Iterator<Item = [usize; 2]>) -> Vec<usize> {
    let mut first: Vec<usize> = (0..bodies).collect();
    let root = |first: &mut Vec<usize>, mut body: usize| {
        while first[body] != body {
            first[body] = first[first[body]];
            body = first[body];
        }
        body
    };
    for [a, b] in joints.filter(|ends| ends.iter().all(|end| *end < bodies)) {
        let (a, b) = (root(&mut first, a), root(&mut first, b));
        first[a.max(b)] = a.min(b);
    }
    (0..bodies).map(|body| root(&mut first, body)).collect()
}
