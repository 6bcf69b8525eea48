//! Promise: settings that cannot be are refused by name, nothing that a game writes panics, and
//! groups, sensors and ignored pairs count as they do for contacts.
#![allow(clippy::unwrap_used, reason = "what is not as the test needs it is a failed test")]

mod shared;

use shared::Stage;
use tumble::prelude::*;
use tumble::{Collider, IgnoreContacts};
use tumble_character::{Character, CharacterInput, CharacterSettings, CharacterState};

type Change = fn(&mut CharacterSettings, Real);

#[test]
fn settings_that_cannot_be_are_named() {
    let fields: [(&str, Change); 20] = [
        ("radius", |it, value| it.radius = value),
        ("height", |it, value| it.height = value),
        ("crouch_height", |it, value| it.crouch_height = value),
        ("skin", |it, value| it.skin = value),
        ("up", |it, value| it.up.x = value),
        ("max_slope", |it, value| it.max_slope = value),
        ("step_height", |it, value| it.step_height = value),
        ("snap_distance", |it, value| it.snap_distance = value),
        ("acceleration", |it, value| it.acceleration = value),
        ("deceleration", |it, value| it.deceleration = value),
        ("air_acceleration", |it, value| it.air_acceleration = value),
        ("jump_height", |it, value| it.jump_height = value),
        ("coyote_time", |it, value| it.coyote_time = value),
        ("jump_buffer", |it, value| it.jump_buffer = value),
        ("gravity_scale", |it, value| it.gravity_scale = value),
        ("max_fall_speed", |it, value| it.max_fall_speed = value),
        ("mass", |it, value| it.mass = value),
        ("push_strength", |it, value| it.push_strength = value),
        ("max_push_out_speed", |it, value| it.max_push_out_speed = value),
        ("up", |it, value| it.up = Vec3::ONE * value),
    ];
    for (field, change) in fields {
        for value in [Real::NAN, Real::INFINITY, -1e10, -1.0] {
            let mut settings = CharacterSettings::of_height(1.8);
            change(&mut settings, value);
            match Character::new(settings) {
                Err(error) => {
                    assert_eq!(error.field(), field, "{value}");
                    assert!(error.to_string().contains(field), "{error}");
                }
                Ok(_) => assert!(value == -1.0 && ["gravity_scale"].contains(&field), "{field} {value}"),
            }
        }
    }
    for height in [0.0, -1.0, 1e-9, 1e30, Real::NAN] {
        assert!(Character::new(CharacterSettings::of_height(height)).is_err(), "{height}");
    }
    let mut character = Character::new(CharacterSettings::default()).unwrap();
    let mut wrong = CharacterSettings::default();
    wrong.mass = -3.0;
    assert!(character.set_settings(wrong).is_err());
    assert_eq!(*character.settings(), CharacterSettings::default());
}

#[test]
fn nothing_that_a_game_writes_panics() {
    let mut stage = Stage::with_ground(60);
    let hero = stage.hero(Vec3::Y);
    let bad = [Real::NAN, Real::INFINITY, -Real::INFINITY, Real::MAX, 1e30, 1e15];
    for value in bad {
        for jump in [false, true] {
            stage.input(hero, CharacterInput { velocity: Vec3::new(value, 1.0, -value), jump, crouch: jump });
            stage.play(hero, 0.2);
            assert!(stage.position(hero).is_finite(), "{value}");
        }
        stage.world.get::<&mut CharacterState>(hero).unwrap().velocity = Vec3::splat(value);
        stage.play(hero, 0.2);
        stage.world.get::<&mut CharacterState>(hero).unwrap().ground_normal = Vec3::splat(value);
        stage.play(hero, 0.2);
        stage.world.get::<&mut Pose>(hero).unwrap().position = Vec3::splat(value);
        stage.play(hero, 0.2);
        *stage.world.get::<&mut Pose>(hero).unwrap() = Pose::at(Vec3::Y);
        *stage.world.get::<&mut CharacterState>(hero).unwrap() = CharacterState::default();
        stage.play(hero, 1.0);
        assert!(stage.position(hero).is_finite() && stage.seen(hero).state.is_grounded(), "{value}");
    }
    // What it stands on goes away, and so do its own components.
    stage.step();
    let ground = stage.seen(hero).state.ground_entity.unwrap();
    stage.world.despawn(ground).unwrap();
    stage.play(hero, 0.5);
    assert!(stage.position(hero).y < -0.5);
    stage.world.remove_one::<Collider>(hero).unwrap();
    stage.play(hero, 0.1);
    stage.world.remove_one::<Velocity>(hero).unwrap();
    stage.play(hero, 0.1);
}

#[test]
fn groups_sensors_and_ignored_pairs_count() {
    let run = |change: &dyn Fn(&mut Stage, tumble::hecs::Entity, tumble::hecs::Entity)| {
        let mut stage = Stage::with_ground(60);
        let wall = stage.block(Vec3::new(2.0, 2.0, 0.0), Vec3::new(0.2, 1.9, 3.0));
        let mut settings = CharacterSettings::of_height(1.8);
        settings.membership = 2;
        let hero = stage.character(settings, Vec3::ZERO);
        change(&mut stage, hero, wall);
        stage.steer(hero, Vec3::X * 3.0);
        stage.play(hero, 1.5);
        stage.position(hero).x > 3.0
    };
    assert!(!run(&|_, _, _| ()));
    assert!(run(&|stage, hero, wall| {
        stage.world.spawn((IgnoreContacts::between(hero, wall),));
    }));
    let changed = |stage: &mut Stage, wall, change: fn(Collider) -> Collider| {
        let mut collider = stage.world.get::<&mut Collider>(wall).unwrap();
        *collider = change(collider.clone());
    };
    assert!(run(&|stage, _, wall| changed(stage, wall, Collider::sensor)));
    assert!(run(&|stage, _, wall| changed(stage, wall, |it| it.with_groups(1, !2))));
    assert!(!run(&|stage, _, wall| changed(stage, wall, |it| it.with_groups(1, 2))));
}

/// Any way up is as good as y.
#[test]
fn every_way_up_is_the_same() {
    let run = |turn: Quat| {
        let mut stage = Stage::new(60);
        let settings = Settings::default().with_gravity(turn * (Vec3::Y * -9.81));
        stage.simulation = Simulation::new(settings).unwrap();
        stage.turned_block(turn * Vec3::new(0.0, -1.0, 0.0), Vec3::new(20.0, 1.0, 20.0), turn);
        stage.turned_block(turn * Vec3::new(3.0, 0.1, 0.0), Vec3::new(1.0, 0.1, 3.0), turn);
        stage.turned_block(turn * Vec3::new(8.0, 2.0, 0.0), Vec3::new(1.0, 2.0, 9.0), turn);
        let mut settings = CharacterSettings::of_height(1.8);
        settings.up = turn * Vec3::Y;
        let hero = stage.character(settings, Vec3::ZERO);
        stage.steer(hero, turn * Vec3::new(3.0, 0.0, 0.5));
        let mut seen: Vec<Vec3> = stage.play(hero, 2.5).iter().map(|it| turn.inverse() * it.position).collect();
        stage.input(hero, CharacterInput { jump: true, ..Default::default() });
        seen.extend(stage.play(hero, 0.5).iter().map(|it| turn.inverse() * it.position));
        seen
    };
    let reference = run(Quat::IDENTITY);
    assert!(reference[149].x > 6.5);
    for turn in [
        Quat::from_rotation_x(3.1),
        Quat::from_rotation_z(1.5),
        Quat::from_rotation_x(-0.7),
        Quat::from_rotation_z(2.5) * Quat::from_rotation_x(1.0),
    ] {
        for (step, (a, b)) in run(turn).iter().zip(&reference).enumerate() {
            assert!((*a - *b).length() < 0.02, "{turn}, step {step}: {a} for {b}");
        }
    }
}
