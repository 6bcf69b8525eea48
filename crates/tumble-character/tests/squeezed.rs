//! Promise: characters keep out of each other and of loose bodies where there is little room, and
//! say so where there is none.
#![allow(clippy::unwrap_used, reason = "what is not as the test needs it is a failed test")]
#![allow(
    clippy::useless_conversion,
    clippy::unnecessary_cast,
    reason = "Real is f32 in one build and f64 in the other"
)]

mod shared;

use shared::{RATES, Stage};
use tumble::hecs::Entity;
use tumble::prelude::*;
use tumble::{Collider, Rng};
use tumble_character::CharacterSettings;

const UP: Vec3 = Vec3::Y;

/// All walk to one place, up to three radii in a step.
#[test]
fn a_crowd_that_comes_together_in_long_steps_shares_the_room() {
    let mut nearest = Real::MAX;
    for number in 0..80 {
        let mut rng = Rng::stream(41, number);
        let mut stage = Stage::with_ground([10, 20, 30][(number % 3) as usize]);
        let count = 4 + rng.next_u64() % 7;
        let height = rng.range(0.12, 0.6);
        let crowd: Vec<(Entity, CharacterSettings)> = (0..count)
            .map(|i| {
                let (sin, cos) = (i as Real * std::f64::consts::TAU as Real / count as Real).sin_cos();
                let settings = CharacterSettings::of_height(height * rng.range(0.7, 1.0));
                let place = Vec3::new(cos, 0.0, sin) * (height * rng.range(1.5, 2.5));
                (stage.character(settings, place), settings)
            })
            .collect();
        let speed = rng.range(0.5, 3.0) * height / 6.0 / stage.dt();
        for _ in 0..40 {
            for (one, _) in &crowd {
                let way = -stage.position(*one) * Vec3::new(1.0, 0.0, 1.0);
                stage.steer(*one, way.normalize_or_zero() * speed);
            }
            stage.step();
            for (i, (one, first)) in crowd.iter().enumerate() {
                for (other, second) in &crowd[..i] {
                    let gap = (stage.position(*one) - stage.position(*other)).length();
                    nearest = nearest.min(gap / (first.radius + second.radius));
                }
            }
        }
    }
    assert!(nearest > 0.9, "{nearest} of both radii");
}

/// Its capsule, smaller by skin and by a thirtieth.
fn core(settings: &CharacterSettings) -> Collider {
    let round = f64::from(settings.radius - settings.skin) * 0.967;
    let half = f64::from(settings.height * 0.5 - settings.radius);
    let place = Pose::at(UP * (settings.height * 0.5));
    Collider::new(&Shape::capsule(round, half)).unwrap().with_offset(place).unwrap()
}

/// In a heap of loose bodies, light and heavy, it gets out of what it overlaps.
#[test]
fn it_is_not_stuck_in_a_loose_body() {
    for number in 0..24 {
        let mut rng = Rng::stream(43, number);
        let rate = [10, 60, 60, 120][(number % 4) as usize];
        let mut stage = Stage::with_ground(rate);
        for i in 0..20_u8 {
            let half = rng.range(0.2, 0.5);
            let shape = match number % 3 {
                0 => Shape::sphere(f64::from(half)),
                1 => Shape::cuboid([1.0, 0.6, 1.0].map(|side| side * f64::from(half))),
                _ => Shape::cylinder(f64::from(half), f64::from(half) * 0.6),
            };
            let place = Vec3::new(rng.range(-2.0, 2.0), 0.6 + 0.5 * Real::from(i), rng.range(-2.0, 2.0));
            let body = RigidBody::new(shape).density(50.0 * 40_f64.powf(rng.unit())).position(place);
            let rolls = Material::default().with_rolling_resistance(0.03);
            body.material(rolls).build().unwrap().spawn(&mut stage.world);
        }
        stage.simulation.step_many(&mut stage.world, 4 * rate);
        let hero = stage.hero(UP * rng.range(4.0, 7.0));
        let settings = *stage.world.get::<&tumble_character::Character>(hero).unwrap().settings();
        let (core, mut stuck) = (core(&settings), 0);
        for step in 0..6 * rate {
            if step % (rate / 2) == 0 {
                let way = Vec3::new(rng.range(-1.0, 1.0), 0.0, rng.range(-1.0, 1.0));
                stage.steer(hero, way * 3.0);
            }
            stage.step();
            let queries = stage.simulation.queries(&stage.world);
            let filter = QueryFilter::new().without(hero);
            let is_in = !queries.overlapping(&core, &Pose::at(stage.position(hero)), &filter).is_empty();
            stuck = if is_in && !stage.seen(hero).state.is_crushed { stuck + 1 } else { 0 };
            assert!(stuck <= (rate / 2).max(5), "{number}: {rate} Hz, step {step}: {:?}", stage.seen(hero));
        }
    }
}

/// A box between it and a wall cannot go: it goes itself, and only as far as it has to.
#[test]
fn it_gets_out_of_a_box_that_cannot_go() {
    for rate in RATES {
        for mass in [1.0, 100.0, 5000.0] {
            let mut stage = Stage::with_ground(rate);
            stage.block(Vec3::new(1.5, 1.0, 0.0), Vec3::new(0.5, 1.0, 3.0));
            let wedged = stage.dynamic(Vec3::new(0.5, 0.5, 0.0), Vec3::new(0.499, 0.5, 0.499), mass);
            let hero = stage.hero(Vec3::X * -0.15);
            let end = stage.play(hero, 1.0).last().unwrap().position.x;
            let gap = stage.position(wedged).x - 0.499 - end;
            assert!(gap > 0.275 && gap < 0.32, "{rate} Hz, {mass} kg: {gap}");
        }
    }
}

/// A lift that leaves it no room below a ceiling goes through it; it says so, stays where it is,
/// comes out below, and is on the ground then.
#[test]
fn a_lift_that_crushes_it_passes() {
    for rate in RATES {
        for speed in [0.5, 2.0] {
            let mut stage = Stage::with_ground(rate);
            stage.block(UP * 3.5, Vec3::new(4.0, 0.5, 4.0));
            let velocity = Velocity { linear: UP * speed, ..Velocity::default() };
            stage.mover(UP * 0.1, Vec3::new(2.0, 0.1, 2.0), velocity);
            let hero = stage.hero(UP * 0.2);
            let mut was_crushed = false;
            for seen in stage.play(hero, 8.0 / speed) {
                let top = seen.position.y + 1.8;
                assert!(top < 3.001 && seen.position.y > -0.001, "{rate} Hz: {seen:?}");
                was_crushed |= seen.state.is_crushed;
            }
            let end = stage.seen(hero);
            assert!(was_crushed && !end.state.is_crushed, "{rate} Hz: {end:?}");
            assert!(end.state.is_grounded() && end.position.length() < 0.01, "{rate} Hz: {end:?}");
        }
    }
}
