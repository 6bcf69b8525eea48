//! Lines of what stands around the bodies: grounds, springs, joints and trails.

use tumble::glam::DVec3;
use tumble::math::Real;
use tumble::{DebugView, Joint, Spring, SpringToPoint};

use crate::bodies::Placed;
use crate::framing::{Frame, Grid};
use crate::layers::Layer;
use crate::lines::{Line, Marks, encoded};
use crate::viewport::Follow;
use crate::viewport::Viewport;

/// Width of a trail \[points\].
const TRAIL: f32 = 1.6;
/// Width of a spring \[points\].
const SPRING: f32 = 1.4;
/// Length of the free axes of a joint, as a part of the radius of the scene.
const JOINT_AXES: f64 = 0.08;

impl Viewport {
    /// What bodies hide: the grid, springs, joints and trails.
    pub(super) fn scenery(&self, places: &[Placed]) -> Vec<Line> {
        let mut lines = Vec::new();
        if self.layers.has(Layer::Grid) {
            let frame = Frame { middle: self.anchor + self.start.middle - self.center, radius: self.start.radius };
            let frame = if self.follow == Follow::Nothing { self.start } else { frame };
            let grounds: Vec<_> = self.grounds(places).collect();
            let grid = Grid::below(&frame, &self.start, self.camera.up).on_ground(&frame, self.camera.up, &grounds);
            lines = grid.lines(&frame, self.camera.up);
            // Walls end the floor.
            lines.retain(|line| {
                let middle = 0.5 * (line.from + line.to);
                grounds.iter().all(|(place, normal)| (middle - *place).dot(*normal) >= 0.0)
            });
        }
        if self.layers.has(Layer::Springs) {
            self.springs(&mut lines);
        }
        if self.layers.has(Layer::Trails) {
            self.trails(places, &mut lines);
        }
        lines
    }

    /// A place and the normal of each infinite ground.
    pub(super) fn grounds<'a>(&'a self, places: &'a [Placed]) -> impl Iterator<Item = (DVec3, DVec3)> + 'a {
        let endless = self.playback.bodies.all.iter().zip(places).filter(|(body, _)| body.endless);
        endless.map(|(_, placed)| (placed.origin, placed.rotation * DVec3::Y))
    }

    pub(super) fn springs(&self, lines: &mut Vec<Line>) {
        let world = &self.playback.world;
        // Not to go through ten thousand bodies for nothing.
        let there_are = world.query::<&Spring>().iter().next().is_some()
            || world.query::<&SpringToPoint>().iter().next().is_some()
            || world.query::<&Joint>().iter().next().is_some();
        if there_are {
            let mut marks = Marks::default();
            let joints = Some((JOINT_AXES * self.start.radius) as Real);
            let view = DebugView { springs: true, joints, alpha: self.playback.alpha(), ..DebugView::nothing() };
            view.draw(world, &mut marks);
            lines.extend(marks.lines.into_iter().map(|line| Line { width: SPRING, ..line }));
        }
    }

    pub(super) fn trails(&self, places: &[Placed], lines: &mut Vec<Line>) {
        let poses = self.playback.bodies.by_entity(places);
        for (entity, trail) in self.playback.trails.all() {
            let Some((body, placed)) = poses.get(&entity) else { continue };
            let [red, green, blue] = encoded(body.color);
            let count = trail.len() as f32;
            let color = |age: f32| [red, green, blue, 0.85 * (1.0 - age / count).max(0.0).powi(2)];
            let newest_first = std::iter::once(placed.center).chain(trail.iter().rev().copied());
            let older = trail.iter().rev().copied();
            for (age, (from, to)) in newest_first.zip(older).enumerate() {
                if from != to {
                    let (from_color, to_color) = (color(age as f32), color(age as f32 + 1.0));
                    lines.push(Line { from, to, from_color, to_color, width: TRAIL });
                }
            }
        }
    }
}
