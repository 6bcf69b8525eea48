//! What the user does to the scene: picks, grabs, shoots, goes back.

use tumble::glam::{DVec2, DVec3};

use super::{Follow, Viewport, center_of_mass, found};
use crate::arrows::Largest;
use crate::balls::Shot;
use crate::bodies::Placed;
use crate::camera::View;
use crate::convert::dvec3;
use crate::failure::Failure;
use crate::framing;
use crate::hand::Hand;
use crate::lines::Line;
use crate::pick::first_hit;
use crate::tuning::Change;

/// Radius of a ball, in radii of the frame.
const BALL: f64 = 0.05;
/// How long a ball is on its way to the middle of the picture, in seconds of watching.
const FLIGHT: f64 = 0.5;
/// Edges of the box around the picked body, and their width \[points\].
const PICKED: [f32; 4] = [0.95, 0.97, 1.0, 0.55];
const EDGE: f32 = 1.2;

impl Viewport {
    /// The body that is seen at a point of the picture, and the point of it \[m\].
    fn hit_at(&self, at: DVec2, size: DVec2) -> Option<(usize, DVec3)> {
        let (view, places) = (self.view(size), self.playback.place());
        let (bodies, ray) = (&self.playback.bodies.all, view.ray(at));
        let enlargement =
            |index: usize| framing::enlargement(&view, places[index].center, bodies[index].reach, bodies.len());
        let bounds = (0..bodies.len()).map(|index| bodies[index].bounds(&places[index], enlargement(index)));
        let (index, distance) = first_hit(&ray, bounds, |index| {
            // What is seen larger than it is, or is not what others touch, is picked by its box.
            let is_as_seen = enlargement(index) == 1.0 && !bodies[index].touches_unseen;
            if is_as_seen { self.playback.hit(index, &places[index], &ray) } else { None }
        })?;
        let is_as_seen = enlargement(index) == 1.0;
        Some((index, if is_as_seen { ray.origin + ray.direction * distance } else { places[index].center }))
    }

    /// The body that is seen at a point of the picture.
    pub(crate) fn body_at(&self, at: DVec2, size: DVec2) -> Option<usize> {
        self.hit_at(at, size).map(|(index, _)| index)
    }

    /// Takes hold of the dynamic body that is seen at a point of the picture. The speed is in
    /// simulated seconds to a second.
    pub(crate) fn grab(&mut self, at: DVec2, size: DVec2, speed: f64) {
        self.release();
        let Some((index, point)) = self.hit_at(at, size) else { return };
        let Some(shown) = self.playback.place().get(index).copied() else { return };
        self.hand = Hand::grab(&mut self.playback, index, (point, &shown), speed);
        self.books = None;
    }

    pub(crate) fn holds(&self) -> bool {
        self.hand.is_some()
    }

    /// Moves what is held to a point of the picture.
    pub(crate) fn pull(&mut self, to: DVec2, size: DVec2) {
        let view = self.view(size);
        if let Some(hand) = &mut self.hand {
            hand.pull(&mut self.playback, &view, to);
        }
    }

    /// Lets go of what is held; the camera stays where it is, and goes with what it follows from
    /// there.
    pub(crate) fn release(&mut self) {
        let Some(hand) = self.hand.take() else { return };
        hand.release(&mut self.playback);
        self.books = None;
        let places = self.playback.place();
        self.anchor = match self.follow {
            Follow::Nothing => self.anchor,
            Follow::All => center_of_mass(&self.playback, &places).unwrap_or(self.anchor),
            Follow::Body(index) => found(&places, index).unwrap_or(self.anchor),
        };
        self.shift = self.camera.target - self.anchor;
    }

    /// Shoots a ball from the camera to what is at a point of the picture as far away as its
    /// middle; why not, if it cannot be. The speed is in simulated seconds to a second.
    pub(crate) fn shoot(&mut self, at: DVec2, size: DVec2, speed: f64) -> Result<(), String> {
        let view = self.view(size);
        let (ray, radius) = (view.ray(at), BALL * self.start.radius);
        let mut from = ray.origin;
        // Out of the ground that the camera looks through from behind.
        for (place, normal) in self.grounds(&self.playback.place()) {
            let (depth, rising) = (radius - (from - place).dot(normal), ray.direction.dot(normal));
            if depth > 0.0 && rising > 0.0 {
                from += ray.direction * (depth / rising);
            }
        }
        let time = FLIGHT * speed;
        let fall = 0.5 * time * dvec3(self.playback.simulation.settings().gravity);
        let velocity = ray.direction * (view.unit / time) - fall;
        self.playback.shoot(&Shot { from, velocity, radius })?;
        self.books = None;
        Ok(())
    }

    pub(crate) fn restart(&mut self) -> Result<(), Failure> {
        self.release();
        self.playback.restart()?;
        self.forget_the_moment();
        if self.follow == Follow::All {
            self.anchor = self.center;
            self.shift = self.start.middle - self.center;
        }
        Ok(())
    }

    /// Goes a step back; whether there was one.
    pub(crate) fn step_back(&mut self) -> bool {
        let went = self.playback.step_back();
        if went {
            self.forget_the_moment();
        }
        went
    }

    /// Changes the setting that is chosen; why not, if the engine refuses it.
    pub(crate) fn tune(&mut self, change: Change) -> Result<(), String> {
        self.books = None;
        self.tuning.turn(&mut self.playback, change)
    }

    /// Moves the slider of a setting to a place from 0 to 1; why not, if the engine refuses it.
    pub(crate) fn slide(&mut self, row: usize, place: f64) -> Result<(), String> {
        self.books = None;
        self.tuning.slide(&mut self.playback, row, place)
    }

    /// Shows this scene as another was, with what is in both.
    pub(crate) fn keep_view_of(&mut self, other: &Self) {
        (self.camera, self.sun, self.layers) = (other.camera, other.sun, other.layers);
        let here = |index: usize| {
            let name = &other.playback.bodies.all.get(index)?.name;
            self.playback.bodies.all.iter().position(|body| body.name == *name)
        };
        self.picked = other.picked.and_then(here);
        let follow = match other.follow {
            Follow::Body(index) => here(index).map_or(Follow::All, Follow::Body),
            same => same,
        };
        self.set_follow(follow);
    }

    /// What was seen or picked may no longer be there.
    fn forget_the_moment(&mut self) {
        self.books = None;
        self.largest = Largest::default();
        let bodies = self.playback.bodies.all.len();
        self.picked = self.picked.filter(|&index| index < bodies);
        if matches!(self.follow, Follow::Body(index) if index >= bodies) {
            self.set_follow(Follow::Nothing);
        }
        if self.hand.is_some_and(|hand| hand.index >= bodies) {
            self.release();
        }
    }

    /// The edges of the box around the picked body.
    pub(super) fn frame_of_picked(&self, view: &View, places: &[Placed]) -> Vec<Line> {
        let bodies = &self.playback.bodies.all;
        let picked = self.picked.and_then(|index| Some((bodies.get(index)?, places.get(index)?)));
        let Some((body, placed)) = picked.filter(|(body, _)| !body.endless) else { return Vec::new() };
        let enlarged = framing::enlargement(view, placed.center, body.reach, bodies.len());
        let around = body.bounds(placed, enlarged);
        let corner =
            |signs: [f64; 3]| around.center + around.rotation * (around.half_extents * DVec3::from_array(signs));
        let mut lines = Vec::with_capacity(12);
        for axis in 0..3 {
            for (a, b) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
                let end = |along: f64| {
                    let mut signs = [0.0; 3];
                    signs[axis] = along;
                    signs[(axis + 1) % 3] = a;
                    signs[(axis + 2) % 3] = b;
                    corner(signs)
                };
                lines.push(Line { from: end(-1.0), to: end(1.0), from_color: PICKED, to_color: PICKED, width: EDGE });
            }
        }
        lines
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::layers::Layer;
    use crate::viewport::tests::{SIZE, viewport};

    fn seen(viewport: &Viewport, index: usize) -> DVec2 {
        viewport.view(SIZE).project(viewport.playback.place()[index].center).unwrap()
    }

    #[test]
    fn what_is_grabbed_comes_under_the_mouse_and_the_camera_stays() {
        let mut viewport = viewport(&["pyramid"]);
        // The uppermost box, which lies still.
        let places = viewport.playback.place();
        let height = |index: &usize| places[*index].center.y;
        let top = (0..places.len()).max_by(|a, b| height(a).total_cmp(&height(b))).unwrap();
        let (before, target) = (seen(&viewport, top), viewport.camera.target);
        viewport.grab(before, SIZE, 1.0);
        assert!(viewport.holds());
        let goal = before + DVec2::new(60.0, -60.0);
        for _ in 0..60 {
            viewport.pull(goal, SIZE);
            viewport.playback.advance(1.0 / 60.0, Duration::MAX);
            viewport.aim(&viewport.playback.place());
        }
        let places = viewport.playback.place();
        let line = viewport.hand.unwrap().line(&places).unwrap();
        let [hand, held] = [line.from, line.to].map(|at| viewport.view(SIZE).project(at).unwrap());
        assert!(hand.distance(goal) < 1e-6, "{hand} {goal}");
        // It hangs below the hand by g/w^2, a centimetre of the 20 m that are seen.
        assert!(held.distance(goal) < 5.0, "{held} {goal}");
        viewport.release();
        viewport.aim(&places);
        assert!(!viewport.holds() && viewport.camera.target.distance(target) < 1e-9, "{}", viewport.camera.target);
    }

    #[test]
    fn ground_and_sky_are_not_grabbed() {
        let mut viewport = viewport(&["pyramid"]);
        for at in [DVec2::new(10.0, 710.0), DVec2::new(640.0, 1.0)] {
            viewport.grab(at, SIZE, 1.0);
            assert!(!viewport.holds(), "{at}");
        }
    }

    #[test]
    fn a_ball_flies_to_what_it_is_aimed_at() {
        let mut viewport = viewport(&["pyramid"]);
        let at = DVec2::new(700.0, 200.0);
        let view = viewport.view(SIZE);
        let ray = view.ray(at);
        viewport.shoot(at, SIZE, 1.0).unwrap();
        let ball = viewport.playback.bodies.all.len() - 1;
        assert_eq!(viewport.playback.bodies.all[ball].name, "ball 1");
        // Until shortly before it would be there, for the boxes are in the way.
        viewport.playback.go_to(0.6 * FLIGHT);
        let off = viewport.playback.place()[ball].center - ray.origin;
        let aside = (off - ray.direction * off.dot(ray.direction)).length();
        // It flies in an arc above the line of sight: g/2 t (T - t).
        let arc = 0.5 * 9.81 * 0.6 * 0.4 * FLIGHT * FLIGHT;
        assert!(aside < 1.01 * arc + 1e-3, "{aside} {arc}");
        assert!((off.dot(ray.direction) / view.unit - 0.6).abs() < 0.1, "{off}");
        viewport.picked = Some(ball);
        viewport.set_follow(Follow::Body(ball));
        viewport.restart().unwrap();
        assert_eq!((viewport.picked, viewport.follow), (None, Follow::Nothing));
    }

    #[test]
    fn a_scene_that_is_read_again_is_seen_as_it_was() {
        let mut before = viewport(&["raft"]);
        let last = before.playback.bodies.all.len() - 1;
        before.picked = Some(last);
        before.set_follow(Follow::Body(last));
        before.camera.yaw += 0.3;
        before.layers.toggle(Layer::Grid);
        let mut after = viewport(&["raft"]);
        after.keep_view_of(&before);
        assert_eq!((after.picked, after.follow), (Some(last), Follow::Body(last)));
        assert_eq!((after.camera, after.layers), (before.camera, before.layers));
        // No body of the other has that name.
        let mut other = viewport(&["t-handle"]);
        other.keep_view_of(&before);
        assert_eq!((other.picked, other.follow), (None, Follow::All));
    }

    #[test]
    fn the_picked_body_is_framed() {
        let mut viewport = viewport(&["mujoco-box"]);
        let (view, places) = (viewport.view(SIZE), viewport.playback.place());
        assert!(viewport.frame_of_picked(&view, &places).is_empty());
        viewport.picked = Some(0);
        let lines = viewport.frame_of_picked(&view, &places);
        let mut lengths: Vec<f64> = lines.iter().map(|line| line.from.distance(line.to)).collect();
        lengths.sort_by(f64::total_cmp);
        // Half extents 0.1, 0.2, 0.3.
        let expected = [[0.2; 4], [0.4; 4], [0.6; 4]].concat();
        assert!(lengths.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-9), "{lengths:?}");
        assert_eq!(lines.len(), 12);
    }
}
