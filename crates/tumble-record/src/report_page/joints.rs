//! Joints between the shown bodies.

use std::collections::HashMap;

use glam::DVec3;
use hecs::{Entity, World};
use serde::Serialize;
use tumble::{Breakable, Joint, Limits, Pose};

use crate::trajectory::frame::Frame;
use crate::trajectory::glb::bodies::Bodies;
use crate::trajectory::glb::sample::{double, single};

/// More joints than this are more than anyone can tell apart.
const MAX_JOINTS: usize = 5000;

/// The joints that are there in the first frame.
#[derive(Debug)]
pub(crate) struct Joints {
    entities: Vec<Entity>,
    pub(crate) shown: Vec<DrawnJoint>,
    /// How many there are, shown or not.
    pub(crate) all: usize,
}

/// A joint as the script draws it.
#[derive(Debug, Serialize)]
pub(crate) struct DrawnJoint {
    /// Among the shown.
    bodies: [usize; 2],
    /// In the frames of the bodies \[m\].
    anchors: [[f32; 3]; 2],
    /// Whether it is a rope or a rod: a line from anchor to anchor.
    line: bool,
    /// When it was first seen not to hold any more \[s\].
    until: Option<f64>,
}

impl Joints {
    pub(crate) fn of(frame: &Frame<'_>, bodies: &Bodies) -> Self {
        let numbers: HashMap<Entity, usize> = bodies.all().iter().map(|body| body.entity).zip(0..).collect();
        let mut joints = Self { entities: Vec::new(), shown: Vec::new(), all: 0 };
        for (entity, joint, limits) in frame.world.query::<(Entity, &Joint, Option<&Limits>)>().iter() {
            joints.all += 1;
            let [Some(&a), Some(&b)] = joint.bodies.map(|body| numbers.get(&body)) else { continue };
            let anchor = |end: usize, body: usize| {
                let center = bodies.all().get(body).map_or(DVec3::ZERO, |body| body.center);
                let from_center = joint
                    .frames
                    .get(end)
                    .map_or(DVec3::ZERO, |frame| DVec3::from_array(frame.position.to_array().map(double)));
                (center + from_center).to_array().map(single)
            };
            if joints.shown.len() < MAX_JOINTS {
                let line = limits.is_some_and(|limits| limits.distance.is_some());
                joints.entities.push(entity);
                joints.shown.push(DrawnJoint {
                    bodies: [a, b],
                    anchors: [anchor(0, a), anchor(1, b)],
                    line,
                    until: None,
                });
            }
        }
        joints
    }

    /// Notes which have ceased to hold.
    pub(crate) fn record(&mut self, frame: &Frame<'_>) {
        for (joint, &entity) in self.shown.iter_mut().zip(&self.entities) {
            if holds(frame.world, entity) {
                joint.until = None;
            } else {
                joint.until = joint.until.or(Some(frame.time));
            }
        }
    }
}

/// Whether a joint is there with both bodies, and whole.
fn holds(world: &World, entity: Entity) -> bool {
    let is_broken = world.get::<&Breakable>(entity).is_ok_and(|breakable| breakable.is_broken);
    let has_ends = |joint: &Joint| joint.bodies.iter().all(|body| world.satisfies::<&Pose>(*body));
    !is_broken && world.get::<&Joint>(entity).is_ok_and(|joint| has_ends(&joint))
}
