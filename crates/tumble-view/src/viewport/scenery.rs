//! Lines of what stands around the bodies: grounds, springs, joints and trails.

use tumble::glam::DVec3;
use tumble::math::Real;
use tumble::{Buoyancy, DebugView, Joint, Spring, SpringToPoint};

use crate::bodies::Placed;
use crate::convert::dvec3;
use crate::framing::{Frame, Grid};
use crate::gpu::Water;
use crate::layers::Layer;
use crate::lines::{Line, Marks, encoded};
use crate::viewport::{Follow, SEEN, Viewport};

/// Width of a trail \[points\].
const TRAIL: f32 = 1.6;
/// Width of a spring \[points\].
const SPRING: f32 = 1.4;
/// Surfaces of water that are drawn.
const MAX_LEVELS: usize = 4;
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

    /// A surface for each level at which something floats.
    pub(super) fn water(&self) -> Vec<Water> {
        let gravity = dvec3(self.playback.simulation.settings().gravity);
        let Some(up) = (-gravity).try_normalize().filter(|_| self.layers.has(Layer::Water)) else { return Vec::new() };
        let mut levels: Vec<f64> =
            self.playback.world.query::<&Buoyancy>().iter().map(|afloat| f64::from(afloat.level)).collect();
        levels.retain(|level| level.is_finite());
        levels.sort_by(f64::total_cmp);
        levels.dedup();
        levels.truncate(MAX_LEVELS);
        let middle = self.anchor + self.start.middle - self.center;
        let on_it = |level: f64| middle + up * (level - middle.dot(up));
        let radius = SEEN * self.start.radius;
        levels.into_iter().map(|level| Water { middle: on_it(level), normal: up, radius }).collect()
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

#[cfg(test)]
mod tests {
    use clap::Parser as _;

    use super::*;
    use crate::options::Options;

    #[test]
    fn there_is_water_where_something_floats() {
        let viewport = |scene: &str| {
            let options = Options::try_parse_from(["tumble-view", scene]).unwrap();
            Viewport::new(options.scene().unwrap(), &options.view).unwrap()
        };
        assert!(viewport("pyramid").water().is_empty());
        let mut raft = viewport("raft");
        let level =
            raft.playback.world.query::<&Buoyancy>().iter().map(|afloat| f64::from(afloat.level)).next().unwrap();
        let water = raft.water();
        assert_eq!((water.len(), water[0].normal), (1, DVec3::Y));
        assert!((water[0].middle.y - level).abs() < 1e-12);
        raft.layers.toggle(Layer::Water);
        assert!(raft.water().is_empty());
    }
}
