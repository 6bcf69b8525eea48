//! Promise: a jump is as high as its setting at any step, ceilings stop it, and it is kept for a
//! while when it is asked for too early or too late.
#![allow(clippy::unwrap_used, reason = "what is not as the test needs it is a failed test")]

mod shared;

use shared::{RATES, Stage};
use tumble::prelude::*;
use tumble_character::{CharacterInput, CharacterSettings, CharacterState};

const JUMP: CharacterInput = CharacterInput { velocity: Vec3::ZERO, jump: true, crouch: false };

#[test]
fn a_jump_is_as_high_as_set() {
    for rate in RATES {
        for height in [0.2, 1.0, 3.0] {
            let mut stage = Stage::with_ground(rate);
            let mut settings = CharacterSettings::of_height(1.8);
            settings.jump_height = height;
            let hero = stage.character(settings, Vec3::ZERO);
            stage.play(hero, 0.5);
            stage.input(hero, JUMP);
            let seen = stage.play(hero, 2.0);
            let highest = seen.iter().map(|it| it.position.y).fold(0.0, Real::max);
            // The top of a parabola, of which steps see a point no further than half a step.
            let missed = 9.81 * stage.dt() * stage.dt() / 8.0;
            assert!(highest < height + 1e-3 && highest > height - missed - 1e-3, "{rate} Hz, {height} m: {highest}");
            // The button stays down, and it jumps once.
            assert!(seen.last().unwrap().state.is_grounded());
        }
    }
}

#[test]
fn a_ceiling_stops_a_jump_and_does_not_hold_it() {
    for rate in RATES {
        let mut stage = Stage::with_ground(rate);
        stage.block(Vec3::new(0.0, 2.5, 0.0), Vec3::new(5.0, 0.5, 5.0));
        let hero = stage.hero(Vec3::ZERO);
        stage.play(hero, 0.5);
        stage.input(hero, JUMP);
        let seen = stage.play(hero, 1.0);
        let highest = seen.iter().map(|it| it.position.y).fold(0.0, Real::max);
        assert!(highest <= 0.2 + 1e-3 && highest > 0.1, "{rate} Hz: {highest}");
        // A fall of 0.2 m takes 0.2 s, and so does the way up less.
        let aloft = seen.iter().filter(|it| !it.state.is_grounded()).count() as Real * stage.dt();
        assert!(aloft < 0.3 + 3.0 * stage.dt(), "{rate} Hz: {aloft} s");
    }
}

#[test]
fn a_jump_against_a_wall_is_as_high() {
    for rate in RATES {
        let mut stage = Stage::with_ground(rate);
        stage.block(Vec3::new(1.3, 5.0, 0.0), Vec3::new(1.0, 5.0, 5.0));
        let hero = stage.hero(Vec3::ZERO);
        stage.play(hero, 0.5);
        stage.input(hero, CharacterInput { velocity: Vec3::new(5.0, 0.0, 1.0), ..JUMP });
        let highest = stage.play(hero, 1.0).iter().map(|it| it.position.y).fold(0.0, Real::max);
        let missed = 9.81 * stage.dt() * stage.dt() / 8.0;
        assert!(highest < 1.081 && highest > 1.079 - missed, "{rate} Hz: {highest}");
    }
}

#[test]
fn a_jump_is_kept_before_landing_and_after_a_ledge() {
    let settings = CharacterSettings::of_height(1.8);
    for (early, jumps) in [(0.05, true), (0.2, false)] {
        let mut stage = Stage::with_ground(240);
        let hero = stage.hero(Vec3::Y * 2.0);
        let fall = Real::sqrt(2.0 * 2.0 / 9.81);
        stage.play(hero, fall - early);
        stage.input(hero, JUMP);
        let seen = stage.play(hero, early + 0.3);
        let jumped = seen.iter().any(|it| it.state.has_jumped && it.state.velocity.y > 1.0);
        assert_eq!(jumped, jumps, "{early} s before");
    }
    for (late, jumps) in [(0.05, true), (0.2, false)] {
        let mut stage = Stage::new(240);
        stage.block(Vec3::new(-2.0, -0.5, 0.0), Vec3::new(2.0, 0.5, 2.0));
        let hero = stage.hero(Vec3::new(-1.0, 0.0, 0.0));
        stage.steer(hero, Vec3::X * 4.0);
        let mut aloft = 0.0;
        while aloft < late {
            stage.step();
            let state: CharacterState = stage.seen(hero).state;
            aloft = if stage.position(hero).x > 0.0 { state.air_time } else { 0.0 };
        }
        stage.input(hero, JUMP);
        let top = stage.play(hero, 0.1).last().unwrap().state.velocity.y;
        assert_eq!(top > 1.0, jumps, "{late} s after: {top}");
    }
    assert_eq!((settings.coyote_time, settings.jump_buffer), (0.1, 0.1));
}

#[test]
fn it_crouches_and_stands_up_only_where_there_is_room() {
    let mut stage = Stage::with_ground(60);
    // A tunnel of 1.2 m.
    stage.block(Vec3::new(5.0, 1.7, 0.0), Vec3::new(3.0, 0.5, 3.0));
    let hero = stage.hero(Vec3::ZERO);
    stage.input(hero, CharacterInput { velocity: Vec3::X * 3.0, ..Default::default() });
    stage.play(hero, 2.0);
    assert!(stage.position(hero).x < 2.0);
    stage.input(hero, CharacterInput { velocity: Vec3::X * 3.0, crouch: true, ..Default::default() });
    stage.play(hero, 1.0);
    let inside = stage.position(hero);
    assert!(inside.x > 3.0 && inside.y.abs() < 0.01, "{inside}");
    stage.input(hero, CharacterInput { velocity: Vec3::X * 3.0, ..Default::default() });
    for seen in stage.play(hero, 3.0) {
        let under = (1.75..8.25).contains(&seen.position.x);
        assert!(seen.state.is_crouching || !under, "{seen:?}");
    }
    let end = stage.seen(hero);
    assert!(end.position.x > 9.0 && !end.state.is_crouching && end.position.y.abs() < 0.01);
}
