//! Promise: what a character stands on carries it and turns it, it keeps that speed when it jumps,
//! rising ground never gets into it and sinking ground does not shed it; what comes pushes it, and
//! it says when it is crushed.
#![allow(clippy::unwrap_used, reason = "what is not as the test needs it is a failed test")]

mod shared;

use shared::{RATES, Stage};
use tumble::prelude::*;
use tumble_character::CharacterInput;

const SLAB: Vec3 = Vec3::new(3.0, 0.25, 3.0);

fn linear(linear: Vec3) -> Velocity {
    Velocity { linear, angular: Vec3::ZERO }
}

#[test]
fn platforms_carry_it() {
    for rate in RATES {
        for velocity in [Vec3::X * 5.0, Vec3::new(1.0, 2.0, -1.0), Vec3::new(0.0, -3.0, 0.0), Vec3::Y * 8.0] {
            let mut stage = Stage::new(rate);
            let slab = stage.mover(Vec3::Y * -0.25, SLAB, linear(Vec3::ZERO));
            let hero = stage.hero(Vec3::new(0.5, 0.01, 0.7));
            stage.play(hero, 0.5);
            stage.set_velocity(slab, linear(velocity));
            let place = stage.position(hero) - stage.position(slab);
            for seen in stage.play(hero, 2.0) {
                assert!(seen.state.is_grounded(), "{rate} Hz, {velocity}");
                assert!((seen.state.ground_velocity - velocity).length() < 1e-4);
            }
            let moved = stage.position(hero) - stage.position(slab) - place;
            assert!(moved.length() < 2e-3, "{rate} Hz, {velocity}: {moved}");
        }
    }
}

#[test]
fn turning_platforms_carry_it_round_and_turn_it() {
    for rate in RATES {
        let mut stage = Stage::new(rate);
        let spin = Velocity { linear: Vec3::ZERO, angular: Vec3::Y * 2.0 };
        let slab = stage.mover(Vec3::Y * -0.25, SLAB, spin);
        let hero = stage.hero(Vec3::new(2.0, 0.01, 0.0));
        let seen = stage.play(hero, 3.0);
        for it in &seen[rate as usize / 2..] {
            let radius = Vec3::new(it.position.x, 0.0, it.position.z).length();
            assert!((radius - 2.0).abs() < 0.05, "{rate} Hz: {}", it.position);
            assert_eq!(it.state.yaw_rate, 2.0);
        }
        // It turns as the platform does.
        let before = [hero, slab].map(|it| stage.world.get::<&Pose>(it).unwrap().orientation);
        stage.play(hero, 1.0);
        let after = [hero, slab].map(|it| stage.world.get::<&Pose>(it).unwrap().orientation);
        let turned = [0, 1].map(|i| after[i] * before[i].inverse());
        assert!(turned[0].dot(turned[1]).abs() > 1.0 - 1e-5);
    }
}

#[test]
fn it_keeps_the_speed_of_the_ground_when_it_jumps() {
    for rate in RATES {
        let mut stage = Stage::new(rate);
        let slab = stage.mover(Vec3::Y * -0.25, SLAB, linear(Vec3::new(4.0, 1.0, 0.0)));
        let hero = stage.hero(Vec3::ZERO);
        stage.play(hero, 1.0);
        stage.input(hero, CharacterInput { jump: true, ..Default::default() });
        let start = stage.position(hero);
        let seen = stage.play(hero, 0.4);
        assert!(seen.iter().all(|it| !it.state.is_grounded()));
        let end = seen.last().unwrap().position;
        let time = seen.len() as Real * stage.dt();
        let upward = Real::sqrt(2.0 * 9.81 * 1.08) + 1.0;
        let expected = start + Vec3::new(4.0 * time, upward * time - 0.5 * 9.81 * time * time, 0.0);
        assert!((end - expected).length() < 1e-3, "{rate} Hz: {end} for {expected}");
        assert!(stage.position(slab).x > 3.0);
    }
}

/// As a lift of a game: at full speed at once, up, stop, down.
#[test]
fn lifts_neither_shed_it_nor_get_into_it() {
    for rate in RATES {
        let mut stage = Stage::new(rate);
        let slab = stage.mover(Vec3::Y * -0.25, SLAB, linear(Vec3::ZERO));
        let hero = stage.hero(Vec3::Y * 0.02);
        stage.steer(hero, Vec3::ZERO);
        stage.play(hero, 0.5);
        for speed in [1.5, 0.0, -1.5, 3.0, -3.0, 0.0] {
            stage.set_velocity(slab, linear(Vec3::Y * speed));
            for _ in 0..rate {
                stage.step();
                let seen = stage.seen(hero);
                let gap = seen.position.y - (stage.position(slab).y + 0.25);
                assert!(seen.state.is_grounded() && gap.abs() < 1e-3, "{rate} Hz, {speed} m/s: {gap}");
            }
        }
    }
}

/// A lift that falls with less than gravity, from rest.
#[test]
fn a_lift_that_falls_slower_than_a_stone_keeps_it() {
    for rate in [30, 60, 240] {
        let mut stage = Stage::new(rate);
        let slab = stage.mover(Vec3::Y * -0.25, SLAB, linear(Vec3::ZERO));
        let hero = stage.hero(Vec3::Y * 0.02);
        stage.play(hero, 0.5);
        for step in 0..rate {
            stage.set_velocity(slab, linear(Vec3::Y * -0.9 * 9.81 * step as Real * stage.dt()));
            stage.step();
            let gap = stage.position(hero).y - (stage.position(slab).y + 0.25);
            assert!(gap.abs() < 2e-3 && stage.seen(hero).state.is_grounded(), "{rate} Hz, step {step}: {gap}");
        }
    }
}

#[test]
fn it_walks_on_a_platform_as_on_ground() {
    for rate in RATES {
        let mut stage = Stage::new(rate);
        let velocity = Vec3::new(-6.0, 0.5, 2.0);
        let slab = stage.mover(Vec3::Y * -0.25, Vec3::new(30.0, 0.25, 3.0), linear(velocity));
        let hero = stage.hero(Vec3::ZERO);
        stage.steer(hero, Vec3::X * 3.0);
        stage.play(hero, 0.5);
        let place = stage.position(hero) - stage.position(slab);
        stage.play(hero, 2.0);
        let moved = stage.position(hero) - stage.position(slab) - place;
        assert!((moved - Vec3::X * 6.0).length() < 0.01, "{rate} Hz: {moved}");
    }
}

#[test]
fn walls_that_come_push_it_and_do_not_get_into_it() {
    for rate in RATES {
        for speed in [0.5, 3.0, 10.0] {
            let mut stage = Stage::with_ground(rate);
            let wall = stage.mover(Vec3::new(-2.0, 1.5, 0.0), Vec3::new(0.5, 1.4, 3.0), linear(Vec3::X * speed));
            let hero = stage.hero(Vec3::ZERO);
            stage.steer(hero, Vec3::X * -1.0);
            let mut pushed = false;
            for seen in stage.play(hero, 2.0 + 2.0 / speed) {
                pushed |= seen.position.x > 0.2;
                assert!(!seen.state.is_crushed);
            }
            let gap = stage.position(hero).x - 0.3 - (stage.position(wall).x + 0.5);
            assert!(pushed && gap > -2e-3 && gap < 0.05, "{rate} Hz, {speed} m/s: gap {gap}");
        }
    }
}

#[test]
fn a_turning_bar_pushes_it() {
    for rate in [30, 60, 240] {
        let mut stage = Stage::with_ground(rate);
        let spin = Velocity { linear: Vec3::ZERO, angular: Vec3::Y * 1.5 };
        stage.mover(Vec3::new(0.0, 1.0, 0.0), Vec3::new(4.0, 0.8, 0.1), spin);
        let hero = stage.hero(Vec3::new(3.0, 0.0, -1.0));
        let mut deepest: Real = 0.0;
        for step in 0..2 * rate {
            stage.step();
            let angle = 1.5 * (step + 1) as Real * stage.dt();
            let place = stage.position(hero);
            let across = (place.x * angle.sin() + place.z * angle.cos()).abs();
            let is_beside = (place.x * angle.cos() - place.z * angle.sin()).abs() < 3.8;
            deepest = if is_beside { deepest.max(0.4 - across) } else { deepest };
        }
        assert!(deepest < 0.03, "{rate} Hz: {deepest}");
    }
}

#[test]
fn it_tells_when_it_is_crushed_and_survives() {
    for rate in RATES {
        let mut stage = Stage::with_ground(rate);
        stage.block(Vec3::new(1.5, 1.5, 0.0), Vec3::new(0.5, 1.5, 3.0));
        let press = stage.mover(Vec3::new(-2.5, 1.5, 0.0), Vec3::new(0.5, 1.4, 3.0), linear(Vec3::X));
        let hero = stage.hero(Vec3::ZERO);
        let seen = stage.play(hero, 3.5);
        assert!(seen.iter().any(|it| it.state.is_crushed), "{rate} Hz");
        assert!(seen.iter().all(|it| it.position.is_finite() && it.position.y > -0.05), "{rate} Hz");
        // The wall goes back, and it is free.
        stage.set_velocity(press, linear(Vec3::X * -2.0));
        stage.play(hero, 1.5);
        stage.steer(hero, Vec3::X * -2.0);
        let seen = stage.play(hero, 1.0);
        assert!(!seen.last().unwrap().state.is_crushed);
        let moved = seen[0].position.x - seen.last().unwrap().position.x;
        assert!(moved > 1.0, "{rate} Hz: {moved}");
    }
}

#[test]
fn dynamic_ground_carries_it() {
    for rate in [60, 240] {
        let mut stage = Stage::with_ground(rate);
        let slippery = Material::default().with_friction(0.0);
        let cart = RigidBody::new(shared::cuboid(SLAB)).mass(2000.0).material(slippery).position(Vec3::Y * 0.25);
        let cart = cart.linear_velocity(Vec3::X * 3.0).build().unwrap().spawn(&mut stage.world);
        let hero = stage.hero(Vec3::new(0.0, 0.5, 0.0));
        stage.play(hero, 1.0);
        let place = stage.position(hero) - stage.position(cart);
        let seen = stage.play(hero, 2.0);
        let moved = stage.position(hero) - stage.position(cart) - place;
        assert!(seen.iter().all(|it| it.state.is_grounded()) && moved.length() < 5e-3, "{rate} Hz: {moved}");
        assert!(stage.position(cart).x > 1.5);
    }
}

/// A platform that goes under a wall leaves the character in front of it.
#[test]
fn a_wall_keeps_it_from_being_carried_on() {
    for rate in RATES {
        let mut stage = Stage::new(rate);
        stage.mover(Vec3::Y * -0.25, Vec3::new(20.0, 0.25, 3.0), linear(Vec3::X * 3.0));
        stage.block(Vec3::new(3.0, 2.0, 0.0), Vec3::new(0.5, 1.95, 3.0));
        let hero = stage.hero(Vec3::ZERO);
        for seen in stage.play(hero, 3.0) {
            assert!(seen.position.x < 2.2 + 2e-3 && seen.position.y.abs() < 0.01, "{rate} Hz: {}", seen.position);
        }
        assert!(stage.position(hero).x > 2.1);
    }
}

#[test]
fn a_lift_under_a_ceiling_crushes_and_does_not_lift_it_through() {
    for rate in RATES {
        let mut stage = Stage::new(rate);
        stage.block(Vec3::new(0.0, 4.5, 0.0), Vec3::new(5.0, 0.5, 5.0));
        stage.mover(Vec3::Y * -0.25, SLAB, linear(Vec3::Y * 1.5));
        let hero = stage.hero(Vec3::ZERO);
        let seen = stage.play(hero, 1.8);
        assert!(seen.iter().any(|it| it.state.is_crushed), "{rate} Hz");
        assert!(seen.iter().all(|it| it.position.y < 2.3), "{rate} Hz: {:?}", seen.last());
    }
}
