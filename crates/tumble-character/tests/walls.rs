//! Promise: walls are never passed at any speed and step, corners stop a character without
//! jitter, and along a wall it keeps the part of its speed that goes along.
#![allow(clippy::unwrap_used, reason = "what is not as the test needs it is a failed test")]

mod shared;

use shared::{RATES, Stage};
use tumble::Rng;
use tumble::prelude::*;
use tumble_character::CharacterSettings;

#[test]
fn along_a_wall_it_keeps_the_cosine_of_its_speed() {
    for rate in RATES {
        for angle in [0.5, 5.0, 20.0, 45.0, 70.0, 85.0] {
            let mut stage = Stage::with_ground(rate);
            stage.block(Vec3::new(0.0, 2.0, 1.0 + 0.35), Vec3::new(100.0, 2.0, 1.0));
            let hero = stage.hero(Vec3::ZERO);
            let (sin, cos) = Real::to_radians(angle).sin_cos();
            stage.steer(hero, Vec3::new(cos, 0.0, sin) * 4.0);
            stage.play(hero, 1.5);
            let before = stage.position(hero);
            stage.play(hero, 2.0);
            let speed = (stage.position(hero).x - before.x) / 2.0;
            assert!((speed - 4.0 * cos).abs() < 0.02, "{rate} Hz, {angle} degrees: {speed} for {}", 4.0 * cos);
        }
    }
}

#[test]
fn corners_stop_it_without_jitter() {
    let mut rng = Rng::new(3);
    for rate in RATES {
        for case in 0..12 {
            // Two walls that meet at an angle, and the character goes between them.
            let mut stage = Stage::with_ground(rate);
            let opening = rng.range(20.0, 130.0).to_radians();
            for side in [-1.0, 1.0] {
                let turn = Quat::from_rotation_y(side * 0.5 * opening);
                let out = turn * Vec3::new(10.0, 0.0, -side);
                stage.turned_block(out + Vec3::Y * 2.0, Vec3::new(10.2, 2.0, 1.0), turn);
            }
            let hero = stage.hero(Vec3::X * 3.0);
            let aside = rng.range(-0.4, 0.4) * opening * 0.5;
            stage.steer(hero, Vec3::new(-aside.cos(), 0.0, aside.sin()) * 5.0);
            stage.play(hero, 8.0);
            let before = stage.position(hero);
            let seen = stage.play(hero, 1.0);
            let most = seen.iter().map(|it| (it.position - before).length()).fold(0.0, Real::max);
            assert!(most < 2e-3, "{rate} Hz, case {case}, {} degrees: {most}", opening.to_degrees());
            assert!(before.x > 0.0);
        }
    }
}

#[test]
fn no_speed_and_no_step_gets_through_a_wall() {
    let mut rng = Rng::new(5);
    for rate in [10, 60, 240] {
        for case in 0..20 {
            let mut stage = Stage::with_ground(rate);
            // A room of thin walls.
            for side in [-1.0, 1.0] {
                stage.block(Vec3::new(side * 4.0, 2.0, 0.0), Vec3::new(0.01, 2.0, 4.0));
                stage.block(Vec3::new(0.0, 2.0, side * 4.0), Vec3::new(4.0, 2.0, 0.01));
            }
            let mut settings = CharacterSettings::of_height(1.8);
            settings.acceleration = 1e6;
            let hero = stage.character(settings, Vec3::ZERO);
            for _ in 0..10 {
                let speed = Real::powf(10.0, rng.range(0.0, 4.0));
                let way = Vec3::new(rng.range(-1.0, 1.0), 0.0, rng.range(-1.0, 1.0));
                stage.steer(hero, way * speed);
                stage.play(hero, 3.0 / rate as Real);
                let place = stage.position(hero);
                assert!(place.x.abs() < 3.71 && place.z.abs() < 3.71, "{rate} Hz, case {case}: {place}, {speed} m/s");
                assert!(place.y.abs() < 0.02, "{rate} Hz, case {case}: {place}");
            }
        }
    }
}

#[test]
fn a_doorway_just_wide_enough_lets_it_through() {
    let mut rng = Rng::new(7);
    for rate in RATES {
        for case in 0..10 {
            let mut stage = Stage::with_ground(rate);
            let half = 0.3 * 1.02;
            for side in [-1.0, 1.0] {
                stage.block(Vec3::new(0.0, 2.0, side * (half + 2.0)), Vec3::new(0.2, 2.0, 2.0));
            }
            let hero = stage.hero(Vec3::new(-2.0, 0.0, rng.range(-0.25, 0.25)));
            stage.steer(hero, Vec3::new(3.0, 0.0, rng.range(-0.05, 0.05)));
            let seen = stage.play(hero, 3.0);
            let end = seen.last().unwrap().position;
            assert!(end.x > 1.0, "{rate} Hz, case {case}: {end}");
        }
    }
}
