//! Where bodies have been.

use std::collections::VecDeque;

use hecs::{Entity, World};
use tumble::Pose;
use tumble::glam::DVec3;

use crate::convert::dvec3;

/// Points of all trails together, and of one.
const MAX_POINTS: usize = 40_000;
const LONGEST: usize = 400;
/// With fewer points a trail shows nothing: then there are none.
const SHORTEST: usize = 8;
/// A trail shows this part of the scene's run.
const SHARE: u64 = 2;

/// The last places of all moving bodies, as far apart in time as makes a trail of half of the
/// scene's run.
#[derive(Debug)]
pub(crate) struct Trails {
    entities: Vec<Entity>,
    every: u64,
    length: usize,
    /// One for each entity, oldest first \[m\].
    places: Vec<VecDeque<DVec3>>,
}

impl Trails {
    pub(crate) fn new(entities: Vec<Entity>, steps: u64) -> Self {
        let length = MAX_POINTS.checked_div(entities.len()).unwrap_or(0).min(LONGEST);
        let entities = if length < SHORTEST { Vec::new() } else { entities };
        let places = entities.iter().map(|_| VecDeque::with_capacity(length)).collect();
        Self { entities, every: (steps / SHARE / length.max(1) as u64).max(1), length, places }
    }

    /// Looks at the world before the step of this number, counted from zero.
    pub(crate) fn before_step(&mut self, step: u64, world: &World) {
        if !step.is_multiple_of(self.every) {
            return;
        }
        let poses = world.view::<&Pose>();
        for (&entity, places) in self.entities.iter().zip(&mut self.places) {
            if let Some(pose) = poses.get(entity) {
                if places.len() >= self.length {
                    places.pop_front();
                }
                places.push_back(dvec3(pose.position));
            }
        }
    }

    /// Forgets what was seen before the step of this number, which is taken back.
    pub(crate) fn take_back(&mut self, step: u64) {
        if step.is_multiple_of(self.every) {
            for places in &mut self.places {
                places.pop_back();
            }
        }
    }

    /// Steps until the next look, at least one.
    pub(crate) fn steps_to_next(&self, step: u64) -> u64 {
        if self.entities.is_empty() { u64::MAX } else { self.every - step % self.every }
    }

    /// Bodies and where they have been, oldest first.
    pub(crate) fn all(&self) -> impl Iterator<Item = (Entity, &VecDeque<DVec3>)> {
        self.entities.iter().copied().zip(&self.places)
    }
}

#[cfg(test)]
mod tests {
    use tumble::math::Vec3;

    use super::*;

    #[test]
    fn a_trail_forgets_its_beginning() {
        let mut world = World::new();
        let entity = world.spawn((Pose::default(),));
        let mut trails = Trails::new(vec![entity], 2400);
        assert_eq!((trails.every, trails.length), (3, 400));
        for step in 0..3000_u64 {
            world.get::<&mut Pose>(entity).unwrap().position = Vec3::X * crate::convert::real(step as f64);
            trails.before_step(step, &world);
        }
        let (of, places) = trails.all().next().unwrap();
        assert_eq!((of, places.len()), (entity, 400));
        assert_eq!((places[0].x, places[399].x), (1800.0, 2997.0));
        assert_eq!((trails.steps_to_next(5), trails.steps_to_next(6)), (1, 3));
        (2996..3000).rev().for_each(|step| trails.take_back(step));
        assert_eq!(trails.places[0].back().map(|place| place.x), Some(2994.0));
    }

    #[test]
    fn there_are_never_too_many_points() {
        let mut world = World::new();
        for (bodies, length) in [(100, 400), (1000, 40), (10_000, 0)] {
            let entities: Vec<Entity> = (0..bodies).map(|_| world.spawn((Pose::default(),))).collect();
            let mut trails = Trails::new(entities, 600);
            for step in 0..600 {
                trails.before_step(step, &world);
            }
            let points: usize = trails.all().map(|(_, places)| places.len()).sum();
            assert!(points <= MAX_POINTS && points == bodies * length.min(trails.length), "{points}");
        }
    }
}
