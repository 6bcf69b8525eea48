//! Promise: a character goes up and down what is no steeper than `max_slope` with the speed across
//! the up axis that is wanted, stands still there, and stays on it over crests; what is steeper it
//! slides down, and never gains height on it.
#![allow(clippy::unwrap_used, reason = "what is not as the test needs it is a failed test")]

mod shared;

use shared::{RATES, Stage};
use tumble::prelude::*;
use tumble_character::{CharacterInput, CharacterSettings, GroundState};

fn degrees(angle: Real) -> Real {
    angle.to_radians()
}

#[test]
fn speed_across_the_up_axis_is_the_same_up_and_down() {
    for rate in RATES {
        for angle in [-45.0, -30.0, -10.0, 0.0, 10.0, 30.0, 45.0] {
            let mut stage = Stage::new(rate);
            stage.slope(degrees(angle), 50.0);
            let hero = stage.hero(Vec3::Y * 0.1);
            stage.play(hero, 1.0);
            stage.steer(hero, Vec3::X * 4.0);
            stage.play(hero, 0.5);
            let before = stage.position(hero);
            let seen = stage.play(hero, 2.0);
            assert!(seen.iter().all(|it| it.state.is_grounded()), "{rate} Hz, {angle} degrees");
            let moved = stage.position(hero) - before;
            assert!((moved.x - 8.0).abs() < 0.02, "{rate} Hz, {angle} degrees: {moved}");
            let rise = 8.0 * degrees(angle).tan();
            assert!((moved.y - rise).abs() < 0.02, "{rate} Hz, {angle} degrees: {moved} for {rise}");
        }
    }
}

#[test]
fn it_stands_still_on_a_slope() {
    for angle in [5.0, 20.0, 40.0, 49.0] {
        let mut stage = Stage::new(60);
        stage.slope(degrees(angle), 50.0);
        let hero = stage.hero(Vec3::Y * 0.1);
        stage.play(hero, 1.0);
        let before = stage.position(hero);
        stage.play(hero, 20.0);
        let moved = (stage.position(hero) - before).length();
        assert!(moved < 1e-4, "{angle} degrees: {moved} m in 20 s");
    }
}

#[test]
fn it_slides_down_what_is_steeper_and_gains_no_height() {
    for rate in RATES {
        for angle in [52.0, 60.0, 70.0, 80.0] {
            let mut stage = Stage::with_ground(rate);
            stage.slope(degrees(angle), 50.0);
            let hero = stage.hero(Vec3::new(-1.0, 0.0, 0.0));
            stage.input(hero, CharacterInput { velocity: Vec3::new(6.0, 0.0, 1.0), ..Default::default() });
            let highest = stage.play(hero, 2.0).iter().map(|it| it.position.y).fold(0.0, Real::max);
            assert!(highest < 0.02, "{rate} Hz, {angle} degrees: walks up to {highest}");
            // Put on the slope it comes down, whatever it wants.
            let height = 5.0;
            let hero = stage.hero(Vec3::new(height / degrees(angle).tan() - 0.6, height, 20.0));
            stage.steer(hero, Vec3::X * 6.0);
            let seen = stage.play(hero, 3.0);
            let highest = seen.iter().map(|it| it.position.y).fold(0.0, Real::max);
            assert!(highest <= height + 0.02, "{rate} Hz, {angle} degrees: up to {highest}");
            assert!(seen.iter().any(|it| it.state.ground == GroundState::OnSteep));
            let last = seen.last().unwrap();
            assert!(last.position.y < 0.1, "{rate} Hz, {angle} degrees: ends at {last:?}");
        }
    }
}

/// A jump against a steep slope is no way up either.
#[test]
fn jumps_gain_no_height_on_steep_ground() {
    for angle in [55.0, 65.0, 80.0] {
        let mut stage = Stage::with_ground(60);
        stage.slope(degrees(angle), 50.0);
        let hero = stage.hero(Vec3::new(-0.5, 0.0, 0.0));
        let mut highest: Real = 0.0;
        for step in 0..600 {
            let jump = step % 7 < 3;
            stage.input(hero, CharacterInput { velocity: Vec3::X * 8.0, jump, crouch: false });
            stage.step();
            highest = highest.max(stage.position(hero).y);
        }
        let jump = CharacterSettings::of_height(shared::HEIGHT).jump_height;
        assert!(highest < jump + 0.05, "{angle} degrees: {highest} m for a jump of {jump}");
    }
}

#[test]
fn crests_do_not_launch_it() {
    for rate in RATES {
        for angle in [10.0, 25.0, 40.0] {
            // A roof: up, and down on the other side.
            let mut stage = Stage::new(rate);
            let (sin, cos) = (degrees(angle).sin(), degrees(angle).cos());
            let roof = |side: Real| Vec3::new(side * (10.0 * cos + sin), -10.0 * sin - cos, 0.0);
            for side in [-1.0, 1.0] {
                let turn = Quat::from_rotation_z(-side * degrees(angle));
                let center = turn * Vec3::new(side * 10.0, -1.0, 0.0);
                assert!(roof(side).is_finite());
                stage.turned_block(center, Vec3::new(10.0, 1.0, 5.0), turn);
            }
            let from = Vec3::new(-6.0, -6.0 * degrees(angle).tan() + 0.2, 0.0);
            let hero = stage.hero(from);
            stage.play(hero, 0.5);
            stage.steer(hero, Vec3::X * 5.0);
            let seen = stage.play(hero, 2.0);
            let aloft = seen.iter().filter(|it| !it.state.is_grounded()).count();
            assert_eq!(aloft, 0, "{rate} Hz, {angle} degrees");
            assert!(seen.last().unwrap().position.x > 2.0);
        }
    }
}

/// Off the end of a ramp it walks, and is not thrown up.
#[test]
fn the_end_of_a_ramp_does_not_throw_it_up() {
    for rate in RATES {
        let mut stage = Stage::new(rate);
        let angle = degrees(30.0);
        let turn = Quat::from_rotation_z(angle);
        stage.turned_block(turn * Vec3::new(-5.0, -1.0, 0.0), Vec3::new(5.0, 1.0, 5.0), turn);
        let hero = stage.hero(Vec3::new(-6.0, -6.0 * angle.tan() + 0.2, 0.0));
        stage.play(hero, 0.5);
        stage.steer(hero, Vec3::X * 5.0);
        let seen = stage.play(hero, 2.0);
        let highest = seen.iter().map(|it| it.position.y).fold(Real::MIN, Real::max);
        assert!(highest < 0.02 && highest > -0.3, "{rate} Hz: {highest}");
        assert!(seen.last().unwrap().position.y < -1.0);
    }
}

#[test]
fn between_two_steep_slopes_it_stands_and_gets_out() {
    for angle in [55.0, 60.0, 70.0] {
        let mut stage = Stage::new(60);
        for side in [-1.0, 1.0] {
            let turn = Quat::from_rotation_z(side * degrees(angle));
            stage.turned_block(turn * Vec3::new(side * 10.0, -1.0, 0.0), Vec3::new(12.0, 1.0, 10.0), turn);
        }
        let hero = stage.hero(Vec3::new(0.1, 3.0, 0.0));
        let seen = stage.play(hero, 3.0);
        let standing = seen[120..].iter().filter(|it| it.state.is_grounded()).count();
        assert!(standing > 55, "{angle} degrees: stands in {standing} of 60 steps, {:?}", seen.last());
        let rest = seen.last().unwrap().position;
        assert!((seen[150].position - rest).length() < 0.01);
        // Along the groove it walks, and out of it it jumps.
        stage.steer(hero, Vec3::Z * 3.0);
        stage.play(hero, 1.0);
        assert!(stage.position(hero).z > 2.0, "{angle} degrees: {}", stage.position(hero));
        stage.input(hero, CharacterInput { jump: true, ..Default::default() });
        let highest = stage.play(hero, 0.5).iter().map(|it| it.position.y).fold(Real::MIN, Real::max);
        assert!(highest > rest.y + 0.8, "{angle} degrees: jumps {}", highest - rest.y);
    }
}
