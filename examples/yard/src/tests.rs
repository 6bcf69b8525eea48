//! Promise: all that the yard has can be done with a player's keys, what stands stands still, and
//! a restart is the start, to the bit.
//!
//! Why: it is the example that people copy from. If one of these fails, so does their game.

use hecs::Entity;
use tumble::batch::Rng;
use tumble::snapshot::{BodyOrder, state_hash};
use tumble_character::CharacterState;

use super::*;
use crate::game::{SETTLE, place};
use crate::hand::Ball;
use crate::pilot::Stop::{self, Car, Drive, Pull, Run, Shoot, Wait, Walk};
use crate::yard::{Lift, YARD};

fn hash(game: &Game) -> u64 {
    state_hash(&game.world, &BodyOrder::of(&game.world))
}

/// One fixed step.
fn step(game: &mut Game, actions: &Actions) {
    let (before, dt) = (game.simulation.steps(), game.simulation.settings().dt);
    game.update(f64::from(dt), actions);
    assert_eq!(game.simulation.steps(), before + 1);
}

/// Does what the stops say, and calls `each` after every step.
fn play_with(game: &mut Game, stops: &[Stop], mut each: impl FnMut(&Game)) {
    let (mut pilot, begin) = (Pilot::new(stops), game.simulation.steps());
    while !pilot.is_done() {
        let actions = pilot.fly(game);
        step(game, &actions);
        each(game);
        assert!(game.simulation.steps() < begin + 3600, "stuck at {}: {stops:?}", place(&game.world, game.yard.hero));
    }
}

fn play(stops: &[Stop]) -> Game {
    let mut game = Game::new().unwrap();
    play_with(&mut game, stops, |_| ());
    game
}

fn hero(game: &Game) -> Vec3 {
    place(&game.world, game.yard.hero)
}

fn gate_place(game: &Game) -> Vec3 {
    let slider = *game.world.get::<&Joint>(game.yard.gate_slider).unwrap();
    place(&game.world, slider.bodies[1])
}

fn lift(game: &Game) -> (Entity, Vec3) {
    game.world.query::<(Entity, &Pose, &Lift)>().iter().map(|it| (it.0, it.1.position)).next().unwrap()
}

fn weight(game: &Game) -> Vec3 {
    let mut query = game.world.query::<(&Pose, &Mass)>();
    query.iter().find(|it| it.1.kilograms() == 80.0).unwrap().0.position
}

/// Where everything is that is loose and no ball, in the order of ids.
fn loose(game: &Game) -> Vec<Vec3> {
    let mut query = game.world.query::<(&BodyId, &Pose, &Momentum)>().without::<&Ball>();
    let mut found: Vec<_> = query.iter().map(|(id, pose, _)| (*id, pose.position)).collect();
    found.sort_by_key(|it| it.0);
    found.into_iter().map(|it| it.1).collect()
}

/// What is dynamic and stands still is where it was, to a millimetre, after a minute.
#[test]
fn what_stands_stands_still() {
    let mut game = Game::new().unwrap();
    let start = loose(&game);
    for _ in 0..3600 {
        step(&mut game, &Actions::default());
    }
    let moved = start.iter().zip(loose(&game)).map(|(from, to)| from.distance(to)).fold(0.0, Real::max);
    assert!(moved < 1e-3, "{moved} m");
}

#[test]
fn stairs_lead_to_the_deck_and_the_slope_down() {
    let mut game = play(&[Run(-7.5, 2.8), Walk(-14.0, 2.8)]);
    assert!((hero(&game).y - 2.0).abs() < 0.01, "{}", hero(&game));
    let mut air = 0;
    play_with(&mut game, &[Walk(-14.0, 9.5)], |game| {
        air += u32::from(!game.world.get::<&CharacterState>(game.yard.hero).unwrap().is_grounded());
    });
    assert!(hero(&game).y.abs() < 0.01 && air == 0, "{}, {air} steps in the air", hero(&game));
}

#[test]
fn the_lift_keeps_who_rides_it() {
    let mut game = play(&[Run(-10.0, -1.05)]);
    while game.simulation.steps() % 600 != 530 {
        step(&mut game, &Actions::default());
    }
    play_with(&mut game, &[Walk(-14.0, -1.05)], |_| ());
    let (mut highest, mut most) = (0.0, 0.0);
    play_with(&mut game, &[Wait(20.0)], |game| {
        let top = lift(game).1.y + 0.1;
        highest = Real::max(highest, hero(game).y);
        most = Real::max(most, (hero(game).y - top).abs());
        assert_eq!(game.world.get::<&CharacterState>(game.yard.hero).unwrap().ground_entity, Some(lift(game).0));
    });
    assert!((highest - 2.0).abs() < 0.01 && most < 2e-3, "{highest} m, {most} m off");
}

#[test]
fn the_carousel_carries_and_turns() {
    let mut game = play(&[Walk(-6.0, 9.0), Wait(0.2)]);
    let (before, mut farthest) = (hero(&game), 0.0);
    play_with(&mut game, &[Wait(4.5)], |game| farthest = Real::max(farthest, hero(game).distance(before)));
    assert!((1.5..2.5).contains(&farthest), "{farthest} m across");
    let middle = Vec3::new(-6.0, hero(&game).y, 8.0);
    assert!((hero(&game).distance(middle) - before.distance(middle)).abs() < 0.02);
}

/// Through the door, which swings and closes; the plate opens the gate, which closes again.
#[test]
fn the_door_is_pushed_open_and_the_plate_opens_the_gate() {
    let mut game = Game::new().unwrap();
    let gate = gate_place(&game);
    play_with(&mut game, &[Run(6.0, 13.0), Walk(10.5, 13.0)], |_| ());
    assert!(hero(&game).x > 10.0 && gate_place(&game).distance(gate) < 0.01);
    play_with(&mut game, &[Walk(15.0, 11.0), Wait(3.0)], |_| ());
    let open = gate_place(&game).x - gate.x;
    assert!((open + 4.4).abs() < 0.1, "{open} m");
    play_with(&mut game, &[Walk(15.0, 6.0), Wait(14.0)], |_| ());
    assert!(hero(&game).z < 7.0);
    assert!(gate_place(&game).distance(gate) < 0.02);
}

#[test]
fn balls_bring_the_wall_down() {
    let mut game = Game::new().unwrap();
    let high = |game: &Game| {
        loose(game).iter().filter(|it| it.z > -7.5 && it.z < -3.0 && it.x.abs() < 3.0 && it.y > 1.0).count()
    };
    let before = high(&game);
    let shots: Vec<Stop> = (0..8_u8).map(|i| Shoot(Vec3::new(-1.2 + 0.3 * Real::from(i), 1.5, -5.0))).collect();
    play_with(&mut game, &[Run(0.0, 5.0)], |_| ());
    play_with(&mut game, &shots, |_| ());
    play_with(&mut game, &[Wait(2.0)], |_| ());
    assert!(before == 22 && high(&game) < 12, "{before}, then {}", high(&game));
    assert!(game.world.query::<&Ball>().iter().count() == 8);
}

#[test]
fn the_weight_is_pulled_aside_and_swings() {
    let mut game = Game::new().unwrap();
    let rest = weight(&game);
    let mut most: Real = 0.0;
    play_with(&mut game, &[Run(-4.0, -5.0), Pull(rest, Vec3::new(-5.0, 2.0, -9.0), 3.0)], |game| {
        most = most.max(weight(game).x - rest.x);
    });
    assert!(most > 1.5, "{most} m");
    let mut least: Real = 0.0;
    play_with(&mut game, &[Wait(3.0)], |game| least = least.min(weight(game).x - rest.x));
    assert!(least < -0.8, "it swings {least} m to the other side");
    assert!(game.player.grip.is_none());
}

#[test]
fn a_crate_is_lifted_and_stays_at_the_hand() {
    let mut game = Game::new().unwrap();
    play_with(&mut game, &[Run(-7.0, -6.5)], |_| ());
    let mut held = None;
    play_with(&mut game, &[Pull(Vec3::new(-11.0, 2.45, -8.6), Vec3::new(-9.0, 2.8, -4.0), 3.0)], |game| {
        held = game.player.grip.map(|grip| place(&game.world, grip.body)).or(held);
    });
    let held = held.unwrap();
    assert!(held.y > 1.8 && held.z > -8.0, "{held}");
}

/// Enters, drives out of the garage and through the wall of crates, leaves.
#[test]
fn the_car_is_entered_driven_and_left() {
    let enter = [Run(6.0, 13.0), Walk(10.0, 13.0), Walk(15.0, 11.0), Walk(13.2, 14.6), Car];
    let mut game = play(&enter);
    assert!(game.player.driving);
    play_with(&mut game, &[Drive(15.0, 4.0), Drive(3.0, -3.0), Drive(-5.0, -8.0)], |_| ());
    assert!(place(&game.world, game.yard.car).distance(hero(&game)) < 0.5);
    for _ in 0..240 {
        step(&mut game, &Actions { jump: true, ..Actions::default() });
    }
    play_with(&mut game, &[Car, Wait(0.5)], |_| ());
    let (car, out) = (place(&game.world, game.yard.car), hero(&game));
    assert!(!game.player.driving && car.distance(out) < 3.0 && out.x.max(out.z) < 7.0, "{car} {out}");
    assert!(game.world.get::<&CharacterState>(game.yard.hero).unwrap().is_grounded());
}

/// Whatever was done: after a restart the state is that of the start, and the same keys do the
/// same again.
#[test]
fn a_restart_is_the_start() {
    let stops = [
        &[Run(0.0, 8.0), Shoot(Vec3::new(0.0, 1.5, -5.0)), Shoot(Vec3::new(1.0, 1.0, -5.0))][..],
        &[Run(6.0, 13.0), Walk(10.0, 13.0), Walk(15.0, 11.0), Walk(13.2, 14.6), Car, Drive(15.0, 9.0)],
    ];
    let mut game = Game::new().unwrap();
    let start = hash(&game);
    let mut ends = Vec::new();
    for _ in 0..3 {
        assert_eq!(hash(&game), start);
        let mut hashes = Vec::new();
        play_with(&mut game, &stops.concat(), |game| hashes.push(hash(game)));
        assert!(game.player.driving);
        ends.push(hashes);
        game.restart().unwrap();
    }
    let same = |other: &Vec<u64>| other.iter().zip(&ends[0]).position(|(a, b)| a != b);
    assert_eq!(ends.iter().map(same).collect::<Vec<_>>(), [None; 3], "steps in which they differ");
}

/// Slow motion, and frames of any length, take the same steps.
#[test]
fn slow_motion_and_frames_change_no_bit() {
    let end = |frame: f64, slow: bool| {
        let mut game = Game::new().unwrap();
        let mut hashes = Vec::new();
        while game.simulation.steps() < SETTLE + 240 {
            let now = game.simulation.steps();
            let actions =
                Actions { ahead: 1.0, run: true, shoot: now % 20 > 9, jump: now > 90, slow, ..Actions::default() };
            game.update(frame, &actions);
            if game.simulation.steps() > now {
                hashes.push(hash(&game));
            }
        }
        (hashes.len(), hashes)
    };
    assert_eq!(end(1.0 / 60.0, false).1.last(), end(1.0 / 61.0, true).1.last());
    assert_eq!(end(1.0 / 144.0, false), end(1.0 / 30.0, true));
}

/// Keys at random: nobody gets out, nothing is not a number, and the game goes on.
#[test]
fn random_keys_break_nothing() {
    for seed in 0..2 {
        let (mut game, mut rng) = (Game::new().unwrap(), Rng::new(seed));
        let mut actions = Actions::default();
        let (start, mut car) = (hash(&game), 0);
        for now in 0..2500 {
            if now % 12 == 0 {
                let chances = [0.6, 0.2, 0.1, 0.5, 0.5, 0.4, 0.01];
                let [run, jump, crouch, grab, shoot, use_car, restart] = chances.map(|part| rng.range(0.0, 1.0) < part);
                let yaw = actions.yaw + rng.range(-0.8, 0.8);
                let (pitch, ahead, right) = (rng.range(-0.9, 0.5), rng.range(-0.5, 1.5), rng.range(-1.0, 1.0));
                actions = Actions { ahead, right, yaw, pitch, run, jump, crouch, grab, shoot, use_car, slow: false };
                if restart {
                    game.restart().unwrap();
                    assert_eq!(hash(&game), start);
                }
            }
            step(&mut game, &actions);
            car += u32::from(game.player.driving);
            let at = hero(&game);
            assert!(at.x.abs().max(at.z.abs()) < YARD && (-0.1..30.0).contains(&at.y), "seed {seed}, step {now}: {at}");
            for (pose, momentum) in game.world.query::<(&Pose, &Momentum)>().iter() {
                let (at, moves) = (pose.position, momentum.linear.is_finite() && momentum.angular.is_finite());
                assert!(moves && pose.orientation.is_finite(), "seed {seed}, step {now}");
                assert!(at.x.abs().max(at.z.abs()) < YARD && at.y > 0.0, "seed {seed}, step {now}: {at}");
            }
        }
        assert!(seed > 0 || car < 2500);
    }
}
