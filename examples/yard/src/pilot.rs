//! Plays by itself: from stop to stop, with the keys that a player has.

use tumble::prelude::*;

use crate::game::{Actions, Game, place};

/// Something to do; places are x and z \[m\].
#[derive(Clone, Copy, Debug)]
pub(crate) enum Stop {
    Walk(Real, Real),
    Run(Real, Real),
    Shoot(Vec3),
    /// Takes hold of what is there, and pulls it to the second point for a time \[s\].
    Pull(Vec3, Vec3, Real),
    Car,
    Drive(Real, Real),
    Wait(Real),
}

/// What the tour is.
const TOUR: &[Stop] = &[
    Stop::Run(0.5, 4.0),
    Stop::Shoot(Vec3::new(0.4, 2.6, -5.0)),
    Stop::Shoot(Vec3::new(-0.6, 2.2, -5.0)),
    Stop::Shoot(Vec3::new(0.8, 1.6, -5.0)),
    Stop::Shoot(Vec3::new(-0.3, 1.4, -5.0)),
    Stop::Shoot(Vec3::new(0.4, 0.9, -5.0)),
    Stop::Shoot(Vec3::new(-0.8, 0.9, -5.0)),
    Stop::Wait(1.2),
    Stop::Run(-5.0, -5.0),
    Stop::Pull(Vec3::new(-8.0, 0.8, -9.0), Vec3::new(-4.5, 2.2, -9.0), 2.0),
    Stop::Wait(1.5),
    Stop::Run(-7.5, 2.8),
    Stop::Walk(-14.0, 2.8),
    Stop::Walk(-14.0, 9.5),
    Stop::Run(6.0, 13.0),
    Stop::Walk(10.0, 13.0),
    Stop::Walk(15.0, 11.0),
    Stop::Walk(13.2, 14.6),
    Stop::Car,
    Stop::Drive(15.0, 4.0),
    Stop::Drive(3.0, -4.5),
    Stop::Drive(-3.0, -6.0),
    Stop::Wait(1.5),
];

pub(crate) struct Pilot {
    stops: Vec<Stop>,
    /// In which step the first of them began.
    since: Option<u64>,
    yaw: Real,
    pitch: Real,
}

impl Pilot {
    pub(crate) fn tour() -> Self {
        Self::new(TOUR)
    }

    pub(crate) fn new(stops: &[Stop]) -> Self {
        Self { stops: stops.iter().rev().copied().collect(), since: None, yaw: 0.0, pitch: 0.0 }
    }

    pub(crate) fn is_done(&self) -> bool {
        self.stops.is_empty()
    }

    /// The keys of the next step.
    pub(crate) fn fly(&mut self, game: &Game) -> Actions {
        let now = game.simulation.steps();
        let since = *self.since.get_or_insert(now);
        let passed = (now - since) as Real * game.simulation.settings().dt;
        let (mut actions, is_done) = match self.stops.last().copied() {
            None => (Actions::default(), false),
            Some(stop) => self.act(game, stop, passed),
        };
        if is_done {
            self.stops.pop();
            self.since = None;
        }
        (actions.yaw, actions.pitch) = (self.yaw, self.pitch);
        actions
    }

    fn act(&mut self, game: &Game, stop: Stop, passed: Real) -> (Actions, bool) {
        let idle = Actions::default();
        let hero = place(&game.world, game.yard.hero);
        match stop {
            Stop::Walk(x, z) | Stop::Run(x, z) => {
                let way = Vec3::new(x - hero.x, 0.0, z - hero.z);
                let off = self.look(way);
                let run = matches!(stop, Stop::Run(..)) && way.length() > 1.0;
                let ahead = if off.abs() < 0.5 { 1.0 } else { 0.0 };
                (Actions { ahead, run, ..idle }, way.length() < 0.15)
            }
            Stop::Shoot(at) => {
                self.look(at - hero - Vec3::Y * 1.6);
                (Actions { shoot: passed > 0.3, ..idle }, passed > 0.35)
            }
            Stop::Pull(at, to, seconds) => {
                self.look(if passed < 0.8 { at } else { to } - hero - Vec3::Y * 1.6);
                (Actions { grab: passed > 0.5, ..idle }, passed > seconds)
            }
            Stop::Car => (Actions { use_car: passed > 0.1, ..idle }, passed > 0.3),
            Stop::Drive(x, z) => self.steer(game, Vec3::new(x, 0.0, z)),
            Stop::Wait(seconds) => (idle, passed > seconds),
        }
    }

    /// Turns the head towards something, from where the hand is; returns how far it is off \[rad\].
    fn look(&mut self, way: Vec3) -> Real {
        let flat = Vec3::new(way.x, 0.0, way.z).length();
        // The shoulder is beside the head.
        let aside = (0.55 / flat.max(2.0)).asin();
        let turn = Real::atan2(-way.x, -way.z) + aside - self.yaw;
        let turn = Real::atan2(turn.sin(), turn.cos());
        self.yaw += turn.clamp(-0.08, 0.08);
        self.pitch += (Real::atan2(way.y, flat) - self.pitch).clamp(-0.03, 0.03);
        turn
    }

    fn steer(&mut self, game: &Game, to: Vec3) -> (Actions, bool) {
        let Ok(car) = game.world.get::<&Pose>(game.yard.car) else { return (Actions::default(), true) };
        let local = car.inverse_transform_point(to.with_y(car.position.y));
        let right = -(local.x / local.length().max(0.1) * 2.5).clamp(-1.0, 1.0);
        let ahead = car.orientation * Vec3::Z;
        let turn = Real::atan2(-ahead.x, -ahead.z) - self.yaw;
        self.yaw += Real::atan2(turn.sin(), turn.cos()) * 0.05;
        self.pitch += (-0.15 - self.pitch) * 0.05;
        (Actions { ahead: 0.8, right, ..Actions::default() }, local.z < 1.0)
    }
}
