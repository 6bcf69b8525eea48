//! The hand that grabs a body by a spring, and throws it.

use tumble::SpringToPoint;
use tumble::glam::{DVec2, DVec3};
use tumble::math::Vec3;

use crate::bodies::Placed;
use crate::camera::View;
use crate::convert::real;
use crate::lines::Line;
use crate::playback::Playback;

/// Angular frequency with which a body follows the hand, for a second of watching: it is there in
/// a tenth of one [rad/s].
const QUICKNESS: f64 = 30.0;
/// Up to this angular frequency in a step every integrator follows \[rad\].
const STEADY: f64 = 0.4;
const COLOR: [f32; 4] = [0.98, 0.95, 0.60, 1.0];
const WIDTH: f32 = 2.5;

/// A body in the hand.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hand {
    /// Of the body.
    pub(crate) index: usize,
    /// Where it is held, from the centre of mass along the body's axes \[m\].
    attachment: DVec3,
    /// Where the hand is \[m\].
    at: DVec3,
    /// The spring that the body has itself.
    own: Option<SpringToPoint>,
}

impl Hand {
    /// Takes hold of a dynamic body at a point of the world; there is nothing to hold of others.
    /// The speed is in simulated seconds to a second.
    pub(crate) fn grab(
        playback: &mut Playback,
        index: usize,
        (at, shown): (DVec3, &Placed),
        speed: f64,
    ) -> Option<Self> {
        let body = playback.bodies.all.get(index).filter(|body| body.mass > 0.0)?;
        let attachment = shown.rotation.inverse() * (at - shown.center);
        if !attachment.is_finite() {
            return None;
        }
        let frequency = (QUICKNESS / speed).min(STEADY / playback.dt());
        let spring = SpringToPoint {
            anchor: single(at),
            attachment: single(attachment),
            rest_length: 0.0,
            stiffness: real(body.mass * frequency * frequency),
            damping: real(2.0 * body.mass * frequency),
        };
        let entity = body.entity;
        let own = playback.world.get::<&SpringToPoint>(entity).ok().map(|own| *own);
        playback.world.insert_one(entity, spring).ok()?;
        playback.begin_books();
        Some(Self { index, attachment, at, own })
    }

    /// Moves the hand to what is under a point of the picture, as far from the viewer as it is.
    pub(crate) fn pull(&mut self, playback: &mut Playback, view: &View, point: DVec2) {
        let ray = view.ray(point);
        let along = (self.at - ray.origin).dot(view.towards) / ray.direction.dot(view.towards);
        let at = ray.origin + ray.direction * along;
        let entity = playback.bodies.all.get(self.index).map(|body| body.entity);
        let spring = entity.and_then(|entity| playback.world.get::<&mut SpringToPoint>(entity).ok());
        if let Some(mut spring) = spring
            && at.is_finite()
        {
            self.at = at;
            spring.anchor = single(at);
        }
    }

    /// Lets the body go with the velocity that it has.
    pub(crate) fn release(self, playback: &mut Playback) {
        let Some(entity) = playback.bodies.all.get(self.index).map(|body| body.entity) else { return };
        // A body that is gone took its spring along.
        drop(match self.own {
            Some(own) => playback.world.insert_one(entity, own),
            None => playback.world.remove_one::<SpringToPoint>(entity).map(drop).map_err(|_| hecs::NoSuchEntity),
        });
        playback.begin_books();
    }

    /// From the hand to the body.
    pub(crate) fn line(&self, places: &[Placed]) -> Option<Line> {
        let held = places.get(self.index)?;
        let to = held.center + held.rotation * self.attachment;
        Some(Line { from: self.at, to, from_color: COLOR, to_color: COLOR, width: WIDTH })
    }
}

fn single(vector: DVec3) -> Vec3 {
    Vec3::from_array(vector.to_array().map(real))
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use tumble::{Pose, Velocity};

    use super::*;
    use crate::camera::{Camera, Up};
    use crate::convert::dvec3;
    use crate::playback::tests::open;

    const SIZE: DVec2 = DVec2::new(1280.0, 720.0);

    fn grab(playback: &mut Playback, index: usize, off: DVec3) -> Hand {
        let shown = playback.place()[index];
        Hand::grab(playback, index, (shown.center + off, &shown), 1.0).unwrap()
    }

    #[test]
    fn a_body_follows_the_hand_in_a_moment_and_keeps_its_velocity() {
        let mut playback = open("t-handle");
        let (index, entity) = (0, playback.bodies.all[0].entity);
        let start = playback.place()[index].center;
        let mut hand = grab(&mut playback, index, DVec3::ZERO);
        let camera = Camera { up: Up::Y, yaw: 0.3, pitch: 0.2, distance: 2.0, target: start };
        let view = camera.view(SIZE, 10.0);
        let goal = start + 0.3 * view.right + 0.2 * view.above;
        hand.pull(&mut playback, &view, view.project(goal).unwrap());
        assert!(hand.at.distance(goal) < 1e-12, "{} {goal}", hand.at);
        playback.advance(0.1, Duration::MAX);
        let left = playback.place()[index].center.distance(goal) / start.distance(goal);
        // (1 + 3) exp(-3) of the way, critically damped, and the picture is up to a step late.
        assert!(left < 0.35, "{left}");
        hand.release(&mut playback);
        assert!(playback.world.get::<&SpringToPoint>(entity).is_err());
        assert!(dvec3(playback.world.get::<&Velocity>(entity).unwrap().linear).dot(goal - start) > 0.0);
    }

    #[test]
    fn what_forces_do_not_move_cannot_be_grabbed() {
        let mut playback = open("pyramid");
        let fixed = playback.bodies.all.iter().position(|body| body.mass == 0.0).unwrap();
        let shown = playback.place()[fixed];
        assert!(Hand::grab(&mut playback, fixed, (shown.center, &shown), 1.0).is_none());
        assert!(Hand::grab(&mut playback, 1_000_000, (shown.center, &shown), 1.0).is_none());
    }

    #[test]
    fn a_spring_of_the_body_itself_comes_back() {
        let mut playback = open("t-handle");
        let entity = playback.bodies.all[0].entity;
        let own = SpringToPoint { stiffness: 3.0, ..SpringToPoint::default() };
        playback.world.insert_one(entity, own).unwrap();
        let hand = grab(&mut playback, 0, DVec3::X * 0.01);
        assert!(playback.world.get::<&SpringToPoint>(entity).unwrap().stiffness > 3.0);
        hand.release(&mut playback);
        assert_eq!(*playback.world.get::<&SpringToPoint>(entity).unwrap(), own);
    }

    /// Whatever the hand holds, and however far it is pulled, nothing is lost.
    #[test]
    fn a_wild_hand_breaks_nothing() {
        for scene in ["pyramid", "t-handle", "solar-system", "raft"] {
            let mut playback = open(scene);
            let index = playback.bodies.all.iter().position(|body| body.mass > 0.0).unwrap();
            let off = 0.5 * playback.bodies.all[index].reach;
            let mut hand = grab(&mut playback, index, DVec3::X * off);
            let reach = playback.bodies.all[index].reach;
            for step in 0..100 {
                hand.at = playback.place()[index].center + DVec3::splat(100.0 * reach * f64::from(step % 3 - 1));
                let entity = playback.bodies.all[index].entity;
                playback.world.get::<&mut SpringToPoint>(entity).unwrap().anchor = single(hand.at);
                playback.step();
            }
            let poses: Vec<Pose> = playback.world.query_mut::<&Pose>().into_iter().copied().collect();
            assert!(poses.iter().all(|pose| pose.position.is_finite()), "{scene}");
            hand.release(&mut playback);
            playback.restart().unwrap();
            let mut undisturbed = open(scene);
            assert_eq!(playback.hash(), undisturbed.hash(), "{scene}");
            (0..10).for_each(|_| {
                playback.step();
                undisturbed.step();
            });
            assert_eq!(playback.hash(), undisturbed.hash(), "{scene}");
        }
    }
}
