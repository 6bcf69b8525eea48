//! Debug drawing of springs between bodies and to fixed points.

use hecs::{EntityRef, World};

use crate::components::Pose;
use crate::debug_draw::{DebugDraw, DebugView, Pen};
use crate::forces::components::SpringToPoint;
use crate::forces::pairwise::Spring;
use crate::math::dvec3;

impl DebugView {
    /// Of springs, if they are to be seen: each is one line, whichever asks for it.
    fn spring_color(&self) -> Option<[f32; 3]> {
        self.forces.map(|_| Self::FORCE).or(self.springs.then_some(Self::SPRING))
    }

    /// The line of an entity that is a [`Spring`], if both of its ends are there.
    pub(crate) fn draw_spring(&self, world: &World, entity: EntityRef<'_>, target: &mut dyn DebugDraw) {
        let Some(color) = self.spring_color() else { return };
        let Some(spring) = entity.get::<&Spring>() else { return };
        let end = |i: usize| {
            let pose = self.pose(world.entity(spring.bodies[i]).ok()?)?;
            Some(dvec3(pose.transform_point(spring.attachments[i])))
        };
        if let (Some(from), Some(to)) = (end(0), end(1)) {
            Pen { target }.line(from, to, color);
        }
    }

    /// The line of a body's [`SpringToPoint`].
    pub(crate) fn draw_spring_to_point(&self, entity: EntityRef<'_>, pose: &Pose, pen: &mut Pen<'_>) {
        let Some(color) = self.spring_color() else { return };
        if let Some(spring) = entity.get::<&SpringToPoint>() {
            pen.line(dvec3(pose.transform_point(spring.attachment)), dvec3(spring.anchor), color);
        }
    }
}
