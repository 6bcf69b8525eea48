//! Balls that are shot into a scene.

use hecs::{Entity, World};
use tumble::glam::DVec3;
use tumble::math::Vec3;
use tumble::{BodyId, Pose, PreviousPose, RigidBody, Shape, Velocity, set_velocity};

use crate::bodies::Bodies;
use crate::convert::real;
use crate::playback::Playback;

/// Of one more, the oldest is shot again.
pub(crate) const MAX_BALLS: usize = 30;
/// A ball is this many times as dense as the bodies of the scene.
const DENSER: f64 = 4.0;
/// Density where the scene has none: that of water [kg/m^3].
const WATER: f64 = 1000.0;

/// What is known of the balls. They are the last of the bodies, and have identities above theirs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Balls {
    /// How many bodies the scene has.
    pub(crate) first: usize,
    next_id: Option<u64>,
    /// Place among the balls of the one to be shot again.
    oldest: usize,
    density: f64,
}

/// A ball at the moment it is shot.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shot {
    /// \[m\]
    pub(crate) from: DVec3,
    /// \[m/s\]
    pub(crate) velocity: DVec3,
    /// The same for all balls of a scene \[m\].
    pub(crate) radius: f64,
}

impl Balls {
    pub(crate) fn new(world: &World, bodies: &Bodies) -> Self {
        let highest = world.query::<&BodyId>().iter().map(|id| id.0).max();
        let next_id = highest.map_or(Some(0), |id| id.checked_add(1));
        let density = bodies.density().map_or(WATER, |density| DENSER * density);
        Self { first: bodies.all.len(), next_id, oldest: 0, density }
    }
}

impl Playback {
    /// Shoots a ball; why it cannot be, if it cannot.
    pub(crate) fn shoot(&mut self, shot: &Shot) -> Result<(), String> {
        let [position, velocity] = [shot.from, shot.velocity].map(|it| Vec3::from_array(it.to_array().map(real)));
        if self.bodies.all.len() - self.balls.first < MAX_BALLS {
            let id = self.balls.next_id.ok_or("the scene has taken the last identity")?;
            let ball = RigidBody::new(Shape::sphere(shot.radius)).density(self.balls.density).id(BodyId(id));
            let ball = ball.position(position).linear_velocity(velocity).interpolated();
            let ball = ball.build().map_err(|error| error.to_string())?;
            let mass = self.balls.density * 4.0 / 3.0 * std::f64::consts::PI * shot.radius.powi(3);
            let number = self.bodies.all.len() - self.balls.first + 1;
            let entity = ball.spawn(&mut self.world);
            self.bodies.add_ball(entity, format!("ball {number}"), shot.radius, mass);
            self.balls.next_id = id.checked_add(1);
        } else {
            let slot = self.balls.first + self.balls.oldest;
            self.balls.oldest = (self.balls.oldest + 1) % MAX_BALLS;
            let Some(entity) = self.bodies.all.get(slot).map(|body| body.entity) else { return Ok(()) };
            self.shoot_again(entity, position, velocity).map_err(|error| error.to_string())?;
        }
        self.begin_books();
        Ok(())
    }

    /// The body is the same, so that steps before it was shot last can be taken back.
    fn shoot_again(&mut self, ball: Entity, at: Vec3, velocity: Vec3) -> Result<(), tumble::VelocityError> {
        set_velocity(&mut self.world, ball, Velocity { linear: velocity, angular: Vec3::ZERO })?;
        if let Ok(mut pose) = self.world.get::<&mut Pose>(ball) {
            *pose = Pose::at(at);
        }
        if let Ok(mut previous) = self.world.get::<&mut PreviousPose>(ball) {
            previous.0 = Pose::at(at);
        }
        Ok(())
    }

    /// Removes balls that the state that was put back does not have.
    pub(crate) fn remove_balls(&mut self, balls: &[Entity]) {
        for &ball in balls {
            // What is gone already need not be removed.
            drop(self.world.despawn(ball));
        }
        if !balls.is_empty() {
            self.bodies.all.retain(|body| self.world.contains(body.entity));
            self.balls.oldest = 0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::playback::tests::open;

    const SHOT: Shot = Shot { from: DVec3::new(0.0, 3.0, 20.0), velocity: DVec3::new(0.0, 0.0, -20.0), radius: 0.4 };

    #[test]
    fn a_restart_removes_balls_and_is_the_beginning() {
        let mut undisturbed = open("pyramid");
        (0..20).for_each(|_| undisturbed.step());
        let mut playback = open("pyramid");
        let scene = playback.bodies.all.len();
        (0..5).for_each(|_| playback.step());
        for _ in 0..3 {
            playback.shoot(&SHOT).unwrap();
            playback.step();
        }
        assert_eq!(playback.bodies.all.len(), scene + 3);
        playback.restart().unwrap();
        assert_eq!((playback.bodies.all.len(), playback.order.len()), (scene, scene));
        (0..20).for_each(|_| playback.step());
        assert_eq!(playback.hash(), undisturbed.hash());
    }

    #[test]
    fn there_are_never_too_many_balls() {
        let mut playback = open("t-handle");
        for count in 1..=MAX_BALLS + 5 {
            playback.shoot(&Shot { from: DVec3::X * (10.0 * count as f64), ..SHOT }).unwrap();
            assert_eq!(playback.bodies.all.len(), 1 + count.min(MAX_BALLS));
        }
        let again = playback.bodies.all[1].entity;
        assert_eq!(
            playback.world.get::<&Pose>(again).unwrap().position.x,
            10.0 * (MAX_BALLS + 1) as tumble::math::Real
        );
        // It comes from the momentum, and is rounded by the mass.
        let speed = playback.world.get::<&Velocity>(again).unwrap().linear.z;
        assert!((speed + 20.0).abs() < 1e-5, "{speed}");
    }

    #[test]
    fn balls_go_with_the_steps_that_are_taken_back() {
        let mut playback = open("pyramid");
        playback.keep_past();
        playback.step();
        let before = playback.hash();
        for _ in 0..MAX_BALLS + 3 {
            playback.shoot(&SHOT).unwrap();
            playback.step();
        }
        for _ in 0..MAX_BALLS + 3 {
            assert!(playback.step_back());
        }
        // The last was shot after the step that it is at now.
        assert_eq!(playback.bodies.all.len(), playback.balls.first + 1);
        assert!(playback.step_back());
        assert_eq!(playback.bodies.all.len(), playback.balls.first);
        playback.step();
        assert_eq!(playback.hash(), before);
    }

    #[test]
    fn what_cannot_be_shot_is_reported() {
        let mut playback = open("t-handle");
        assert!(playback.shoot(&Shot { radius: 1e300, ..SHOT }).is_err());
        assert!(playback.shoot(&Shot { from: DVec3::NAN, ..SHOT }).is_err());
        assert_eq!(playback.bodies.all.len(), 1);
    }
}
