//! Promise: steps up to `step_height` are taken, higher ones are walls, stairs go down without a
//! hop, and what leads onto a steep slope is no step.
#![allow(clippy::unwrap_used, reason = "what is not as the test needs it is a failed test")]

mod shared;

use shared::{RATES, Stage};
use tumble::prelude::*;
use tumble_character::CharacterSettings;

fn settings() -> CharacterSettings {
    CharacterSettings::of_height(1.8)
}

#[test]
fn a_step_just_low_enough_is_taken_and_one_just_too_high_is_not() {
    let limit = settings().step_height;
    for rate in RATES {
        for speed in [0.5, 2.0, 6.0] {
            for part in [0.1, 0.5, 0.9, 0.99, 1.01, 1.1, 1.5, 2.5] {
                let mut stage = Stage::with_ground(rate);
                let height = limit * part;
                stage.block(Vec3::new(51.0, height * 0.5, 0.0), Vec3::new(50.0, height * 0.5, 3.0));
                let hero = stage.hero(Vec3::ZERO);
                stage.steer(hero, Vec3::X * speed);
                stage.play(hero, 3.0 / speed + 0.5);
                let end = stage.position(hero);
                if part < 1.0 {
                    assert!((end.y - height).abs() < 0.01 && end.x > 1.5, "{rate} Hz, {speed} m/s, {height} m: {end}");
                } else {
                    assert!(end.y < 0.01 && end.x < 0.75, "{rate} Hz, {speed} m/s, {height} m: {end}");
                }
            }
        }
    }
}

#[test]
fn stairs_go_up_and_down_at_full_speed() {
    for rate in RATES {
        for (rise, run) in [(0.1, 0.3), (0.18, 0.28), (0.3, 0.3), (0.25, 0.6)] {
            let mut stage = Stage::with_ground(rate);
            let count = 12;
            for i in 0..count {
                let (x, y) = (1.0 + i as Real * run, (i + 1) as Real * rise);
                stage.block(Vec3::new(x + 20.0, y * 0.5, 0.0), Vec3::new(20.0, y * 0.5, 2.0));
            }
            let hero = stage.hero(Vec3::ZERO);
            stage.steer(hero, Vec3::X * 3.0);
            let seen = stage.play(hero, 3.0);
            let end = seen.last().unwrap();
            let aloft = seen.iter().filter(|it| !it.state.is_grounded()).count();
            assert!(aloft <= 1, "{rate} Hz, {rise}/{run}: {aloft} of {} in the air", seen.len());
            assert!(end.position.x > 8.6, "{rate} Hz, {rise}/{run}: {}", end.position);
            assert!((end.position.y - count as Real * rise).abs() < 0.02, "{rate} Hz, {rise}/{run}: {}", end.position);
            // And back.
            stage.steer(hero, Vec3::X * -3.0);
            let seen = stage.play(hero, 3.0);
            let aloft = seen.iter().filter(|it| !it.state.is_grounded()).count();
            assert_eq!(aloft, 0, "{rate} Hz, {rise}/{run}: in the air on the way down");
            let end = seen.last().unwrap().position;
            assert!(end.x < 0.4 && end.y.abs() < 0.02, "{rate} Hz, {rise}/{run}: {end}");
        }
    }
}

#[test]
fn a_low_ceiling_forbids_a_step() {
    let mut stage = Stage::with_ground(60);
    stage.block(Vec3::new(11.0, 0.15, 0.0), Vec3::new(10.0, 0.15, 3.0));
    stage.block(Vec3::new(10.0, 2.0 + 0.5, 0.0), Vec3::new(20.0, 0.5, 3.0));
    let hero = stage.hero(Vec3::ZERO);
    stage.steer(hero, Vec3::X * 3.0);
    stage.play(hero, 2.0);
    let end = stage.position(hero);
    assert!(end.x < 0.75 && end.y < 0.01, "{end}");
}

#[test]
fn a_step_is_no_way_onto_a_steep_slope() {
    for rate in RATES {
        for angle in [55.0, 65.0, 75.0] {
            let mut stage = Stage::with_ground(rate);
            stage.slope(Real::to_radians(angle), 20.0);
            // And one that begins with a kerb.
            let turn = Quat::from_rotation_z(Real::to_radians(angle));
            let up = Vec3::new(0.0, 0.2, 50.0);
            stage.turned_block(turn * -Vec3::Y + up, Vec3::new(20.0, 1.0, 5.0), turn);
            for z in [0.0, 50.0] {
                let hero = stage.hero(Vec3::new(-2.0, 0.0, z));
                stage.steer(hero, Vec3::X * 5.0);
                let highest = stage.play(hero, 2.0).iter().map(|it| it.position.y).fold(0.0, Real::max);
                assert!(highest < 0.05, "{rate} Hz, {angle} degrees, z {z}: {highest}");
            }
        }
    }
}

/// A wall whose top edge is between the limit and the radius meets the round foot from below its
/// widest place; it is a wall all the same.
#[test]
fn low_walls_are_not_climbed_by_the_round_foot() {
    for part in [1.05, 1.2, 1.5] {
        let mut settings = settings();
        settings.step_height = 0.1;
        let mut stage = Stage::with_ground(60);
        let height = 0.1 * part;
        stage.block(Vec3::new(2.0, height * 0.5, 0.0), Vec3::new(1.0, height * 0.5, 3.0));
        let hero = stage.character(settings, Vec3::ZERO);
        stage.steer(hero, Vec3::X * 2.0);
        let seen = stage.play(hero, 2.0);
        let end = seen.last().unwrap().position;
        assert!(end.y < 0.03 && end.x < 1.0, "{height} m: {end}");
    }
}
