//! Debug drawing of joints: levers, free axes, limits and loads.

use glam::DVec3;
use hecs::{EntityRef, World};

use crate::debug_draw::joint_limits::Standing;
use crate::debug_draw::{DebugDraw, DebugView, Pen};
use crate::joints::breakable::Breakable;
use crate::joints::joint::Joint;
use crate::joints::joint_load::JointLoad;
use crate::joints::limits::Limits;
use crate::math::{dquat, dvec3};

impl DebugView {
    /// What there is to see of an entity that is a [`Joint`], if both of its ends are there.
    pub(crate) fn draw_joint(&self, world: &World, entity: EntityRef<'_>, target: &mut dyn DebugDraw) {
        if self.joints.is_none() && self.joint_forces.is_none() {
            return;
        }
        let Some(joint) = entity.get::<&Joint>() else { return };
        let is_broken = entity.get::<&Breakable>().is_some_and(|breakable| breakable.is_broken);
        let [Some(first), Some(second)] = joint.bodies.map(|body| self.pose(world.entity(body).ok()?)) else {
            return;
        };
        if is_broken {
            return;
        }
        let mut pen = Pen { target };
        let ends = [(first, joint.frames[0]), (second, joint.frames[1])];
        let anchors = ends.map(|(pose, frame)| dvec3(pose.transform_point(frame.position)));
        if let Some(length) = self.joints {
            pen.line(dvec3(first.position), anchors[0], Self::JOINT);
            pen.line(anchors[1], dvec3(second.position), Self::JOINT);
            let orientations =
                ends.map(|(pose, frame)| (dquat(pose.orientation) * dquat(frame.orientation)).normalize());
            if let Some(limits) = entity.get::<&Limits>() {
                let at = Standing { anchors, orientations, free: joint.free };
                pen.limits(&limits, &at, length.into());
            }
            let is_free = |index: usize| joint.free.has(index) || joint.free.has(3 + index);
            let axes = [DVec3::X, DVec3::Y, DVec3::Z].into_iter().zip(Self::AXES).enumerate();
            for (_, (axis, color)) in axes.filter(|(index, _)| is_free(*index)) {
                let half = orientations[0] * axis * (0.5 * f64::from(length));
                pen.line(anchors[0] - half, anchors[0] + half, color);
            }
        }
        if let (Some(scale), Some(load)) = (self.joint_forces, entity.get::<&JointLoad>()) {
            pen.arrow(crate::math::vec3(anchors[1]), load.force * scale, Self::FORCE);
        }
    }
}
