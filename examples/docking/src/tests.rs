//! Promise: the game can be won with a player's keys, loses no momentum when two bodies become one,
//! and plays the same again from a snapshot.
//!
//! Why: it is the example that people copy from. If one of these fails, so does their game.

#![cfg_attr(feature = "f64", allow(clippy::useless_conversion, reason = "Real is f64 in this build"))]

use tumble::energy::Totals;
use tumble::glam::DVec3;
use tumble::snapshot::{BodyOrder, state_hash};

use super::*;

/// What the pilot takes at most \[s\].
const LIMIT: f64 = 150.0;

fn hash(game: &Game) -> u64 {
    state_hash(&game.world, &BodyOrder::of(&game.world))
}

fn totals(game: &Game) -> Totals {
    Totals::of(&game.world, game.simulation.settings(), &BodyOrder::of(&game.world))
}

fn fuel(game: &Game) -> Real {
    game.world.query::<&Fuel>().iter().next().map_or(0.0, |fuel| fuel.0)
}

fn craft(game: &Game) -> (Craft, Craft) {
    (Craft::of::<Player>(&game.world).unwrap(), Craft::of::<Target>(&game.world).unwrap())
}

/// One fixed step.
fn step(game: &mut Game, pilot: impl FnMut(&World) -> Controls) {
    let (before, dt) = (game.simulation.steps(), game.simulation.settings().dt);
    game.update(f64::from(dt), pilot);
    assert_eq!(game.simulation.steps(), before + 1);
}

/// Flies until they are docked or the time is over; returns what was left in the tank, and the
/// totals of the two, before they were one.
fn fly(game: &mut Game) -> (Real, Totals) {
    let mut last = (fuel(game), totals(game));
    while game.outcome != Outcome::Docked && game.simulation.time() < LIMIT {
        last = (fuel(game), totals(game));
        step(game, pilot::fly);
    }
    last
}

#[test]
fn the_pilot_docks_from_every_start() {
    for (level, starts) in [(0, 5), (1, 20), (2, 5)] {
        for seed in 0..starts {
            let mut game = Game::new(level, seed).unwrap();
            let (left, _) = fly(&mut game);
            assert_eq!(game.outcome, Outcome::Docked, "level {level}, start {seed}");
            assert!(left > 0.25 * TANK.0, "level {level}, start {seed}: {left} kg left");
        }
    }
}

/// The pair has the momenta of both, and keeps them to the bit while it tumbles on.
#[test]
fn docking_loses_no_momentum() {
    let mut game = Game::new(1, 0).unwrap();
    let (_, before) = fly(&mut game);
    let after = totals(&game);
    // The sum of two is rounded, and the centre of mass that it is taken about: a rounding each.
    let rounding = |sum: f64| 2.0 * f64::from(Real::EPSILON) * sum;
    let (linear, angular) = (before.linear_momentum.length(), before.angular_momentum.length());
    assert!((after.linear_momentum - before.linear_momentum).length() <= rounding(linear));
    assert!((after.angular_momentum - before.angular_momentum).length() <= rounding(angular));
    assert!(after.energy() < before.energy(), "what is latched no longer moves against each other");

    let momenta = |game: &Game| game.world.query::<&Momentum>().iter().copied().collect::<Vec<_>>();
    let docked = momenta(&game);
    assert_eq!(docked.len(), 1);
    for _ in 0..3600 {
        step(&mut game, |_| Controls { push: Vec3::ONE, turn: Vec3::ONE, ..Controls::default() });
    }
    assert_eq!(momenta(&game), docked);
    assert_eq!(game.outcome, Outcome::Docked);
}

#[test]
fn a_flight_from_a_snapshot_is_the_same_flight() {
    let mut game = Game::new(2, 3).unwrap();
    let (start, at_start) = (game.save().unwrap(), hash(&game));
    for _ in 0..600 {
        step(&mut game, pilot::fly);
    }
    let (kept, left) = (game.save().unwrap(), fuel(&game));
    fly(&mut game);
    let docked = (game.simulation.steps(), hash(&game));

    // From the start, with two bodies where there is one.
    game.restore(&start).unwrap();
    assert_eq!((game.simulation.steps(), hash(&game), fuel(&game)), (0, at_start, TANK.0));
    assert_eq!(game.outcome, Outcome::Flying);
    fly(&mut game);
    assert_eq!((game.simulation.steps(), hash(&game)), docked);

    // From the middle.
    game.restore(&kept).unwrap();
    assert_eq!((game.simulation.steps(), fuel(&game)), (600, left));
    fly(&mut game);
    assert_eq!((game.simulation.steps(), hash(&game)), docked);
}

/// Frames of any length take the same steps.
#[test]
fn frames_change_nothing() {
    let end = |frame: f64| {
        let mut game = Game::new(1, 4).unwrap();
        while game.simulation.steps() < 900 {
            game.update(frame.min((900 - game.simulation.steps()) as f64 / 60.0), pilot::fly);
        }
        (game.simulation.steps(), hash(&game))
    };
    assert_eq!(end(1.0 / 37.0), end(1.0 / 144.0));
}

#[test]
fn latches_catch_what_the_rules_allow_only() {
    let good = || Approach { gap: Vec3::X * 0.2, drift: Vec3::Y * 0.29, misalignment: 0.17, spin: 0.07 };
    assert_eq!(good().verdict(), Some(Ok(())));
    assert_eq!(Approach { gap: Vec3::X * 0.26, ..good() }.verdict(), None);
    assert_eq!(Approach { drift: Vec3::Y * 0.31, ..good() }.verdict(), Some(Err("too fast")));
    assert_eq!(Approach { misalignment: 0.18, ..good() }.verdict(), Some(Err("not aligned")));
    assert_eq!(Approach { spin: 0.09, ..good() }.verdict(), Some(Err("spinning against it")));
}

/// A ship that runs into the satellite's side bounces, and what one loses the other has.
#[test]
fn hulls_bounce() {
    let mut game = Game::new(0, 0).unwrap();
    let (ship, target) = craft(&game);
    let side = target.pose.orientation * Vec3::Z;
    let mass = game.world.get::<&Mass>(ship.entity).unwrap().kilograms();
    game.world.get::<&mut Pose>(ship.entity).unwrap().position = side * 3.0;
    game.world.get::<&mut Momentum>(ship.entity).unwrap().linear = side * -mass;
    let before = totals(&game);
    for _ in 0..180 {
        step(&mut game, |_| Controls { assist: Assist::Off, ..Controls::default() });
    }
    let (ship, target) = craft(&game);
    let (apart, after) = (ship.pose.position - target.pose.position, totals(&game));
    assert!((ship.velocity.linear - target.velocity.linear).dot(apart) > 0.0, "they move apart");
    assert!(apart.length() > HULLS);
    // Some twenty steps push; each rounds two momenta of up to a few hundred.
    let rounding = 40.0 * f64::from(Real::EPSILON);
    assert!((after.linear_momentum - before.linear_momentum).length() < rounding * before.linear_momentum.length());
    assert!(before.linear_momentum.length() > DVec3::splat(100.0).length());
}

#[test]
fn an_empty_tank_closes_the_valves() {
    let mut game = Game::new(0, 0).unwrap();
    let (ship, _) = craft(&game);
    game.world.get::<&mut Fuel>(ship.entity).unwrap().0 = 0.1;
    let forward = |_: &World| Controls { push: Vec3::Y, ..Controls::default() };
    // Four nozzles empty it in two and a half seconds.
    for _ in 0..149 {
        step(&mut game, forward);
    }
    assert_eq!(game.outcome, Outcome::Flying);
    for _ in 0..3 {
        step(&mut game, forward);
    }
    assert_eq!((game.outcome.clone(), fuel(&game)), (Outcome::OutOfFuel, 0.0));
    assert_eq!(game.world.get::<&Thruster>(ship.entity).unwrap().force, Vec3::ZERO);
}

/// Whoever looks and changes keys twice a second only, as people do, gets there too.
#[test]
fn a_slow_pilot_docks_as_well() {
    for level in 0..LEVELS.len() {
        let mut game = Game::new(level, 0).unwrap();
        let mut controls = Controls::default();
        while game.outcome != Outcome::Docked && game.simulation.time() < LIMIT {
            let look = game.simulation.steps().is_multiple_of(30);
            step(&mut game, |world| {
                if look {
                    controls = pilot::fly(world);
                }
                controls
            });
        }
        assert_eq!(game.outcome, Outcome::Docked, "level {level}");
    }
}

#[test]
fn whoever_is_too_fast_bounces_and_may_try_again() {
    let mut game = Game::new(0, 0).unwrap();
    let (ship, target) = craft(&game);
    let mass = game.world.get::<&Mass>(ship.entity).unwrap().kilograms();
    let facing = target.pose.orientation * Quat::from_rotation_z(std::f64::consts::PI as Real);
    let before_it = target.pose.transform_point(Vec3::Y * 3.6);
    *game.world.get::<&mut Pose>(ship.entity).unwrap() = Pose { position: before_it, orientation: facing };
    game.world.get::<&mut Momentum>(ship.entity).unwrap().linear = -target.port_axis() * mass * 0.6;
    update_derived(&mut game.world);

    let mut told = vec![game.outcome.clone()];
    for _ in 0..600 {
        step(&mut game, |_| Controls { assist: Assist::Match, ..Controls::default() });
        if told.last() != Some(&game.outcome) {
            told.push(game.outcome.clone());
        }
    }
    assert_eq!(told, [Outcome::Flying, Outcome::Missed("too fast".to_owned()), Outcome::Flying]);
}

#[test]
fn the_command_line_names_what_is_wrong() {
    let parsed = |line: &str| Options::parse(line.split_whitespace().map(str::to_owned));
    let options = parsed("--level 3 --start 7 --screenshot a.png --at 2.5").unwrap();
    assert_eq!((options.level, options.seed, options.at, options.autopilot), (2, 7, 2.5, false));
    let error = |line| parsed(line).unwrap_err().to_string();
    assert_eq!(error("--level 4"), "--level 4: there are 1 to 3");
    assert_eq!(error("--at noon"), "--at noon: that is no number for it");
    assert_eq!(error("--at inf"), "--at inf: from 0 to 3600 seconds");
    assert_eq!(error("--screenshot a"), "--screenshot a: only .png files are written");
    assert_eq!(error("--start"), "--start needs a value");
    assert_eq!(error("--stop"), "--stop: try --autopilot, --level, --start, --screenshot, --at or --help");
}

/// The help has every option that is read, and every key of the README's table.
#[test]
fn the_help_has_all_options_and_keys() {
    for option in ["--autopilot", "--level", "--start", "--screenshot", "--at"] {
        assert!(crate::options::HELP.contains(&format!("      {option} ")), "{option}");
    }
    let guide = include_str!("../README.md");
    let table = guide.split("## Keys").nth(1).unwrap().split("## ").next().unwrap();
    let keys = table.lines().filter_map(|line| line.strip_prefix("| ")?.split(" | ").next());
    let words: Vec<&str> =
        keys.skip(1).flat_map(|keys| keys.split([' ', ',', '`'])).filter(|key| !key.is_empty()).collect();
    assert!(words.len() > 20, "{words:?}");
    for word in words {
        let (_, keys) = crate::options::HELP.split_once("Keys:").unwrap();
        assert!(keys.split([' ', ',', '\n']).any(|known| known == word), "{word}");
    }
}
