//! Promise: a character pushes what is dynamic with its strength and no more, is stopped by what
//! is heavy, weighs on what it stands on, and nothing gets more force through it than that.
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
use tumble_character::CharacterSettings;

fn speed(stage: &Stage, body: Entity) -> Real {
    stage.velocity(body).length()
}

#[test]
fn a_light_box_is_pushed_ahead() {
    for rate in RATES {
        let mut stage = Stage::with_ground(rate);
        let half = Vec3::splat(0.5);
        let light = stage.dynamic(Vec3::new(1.5, 0.5, 0.0), half, 20.0);
        let hero = stage.hero(Vec3::ZERO);
        stage.steer(hero, Vec3::X * 2.0);
        stage.play(hero, 1.0);
        let before = stage.position(hero);
        let mut fastest: Real = 0.0;
        for _ in 0..3 * rate {
            stage.step();
            fastest = fastest.max(speed(&stage, light));
        }
        let moved = stage.position(hero).x - before.x;
        // Friction takes half of `mu g dt` off the speed between two pushes, and at most all of it.
        let least = 2.0 - 0.5 * 9.81 * stage.dt() - 0.1;
        assert!(moved > least * 3.0, "{rate} Hz: {moved} of 6 m");
        assert!(fastest < 2.4, "{rate} Hz: {fastest} m/s");
        assert!(stage.position(light).x > stage.position(hero).x + 0.75, "{rate} Hz");
        assert!(stage.touches(hero).contains(light) || stage.position(light).x > stage.position(hero).x + 0.8);
    }
}

/// On ice the speed of a heavy box is the strength times the time over the mass.
#[test]
fn a_heavy_box_gets_no_more_than_its_strength() {
    for rate in RATES {
        let mut stage = Stage::new(rate);
        let ice = Material::default().with_friction(0.0);
        let ground = RigidBody::new(Shape::cuboid([50.0, 1.0, 50.0])).fixed().material(ice).position(-Vec3::Y);
        ground.build().unwrap().spawn(&mut stage.world);
        let heavy =
            RigidBody::new(Shape::cuboid([0.5; 3])).mass(5000.0).material(ice).position(Vec3::new(0.81, 0.5, 0.0));
        let heavy = heavy.build().unwrap().spawn(&mut stage.world);
        let hero = stage.hero(Vec3::ZERO);
        stage.play(hero, 0.2);
        stage.steer(hero, Vec3::X * 3.0);
        stage.play(hero, 2.0);
        let strength = CharacterSettings::of_height(1.8).push_strength;
        let most = strength * 2.0 / 5000.0;
        let reached = stage.velocity(heavy).x;
        assert!(reached <= most * 1.01 && reached > 0.5 * most, "{rate} Hz: {reached} m/s for {most}");
        assert!(stage.position(hero).x < stage.position(heavy).x - 0.78);
    }
}

#[test]
fn a_light_box_between_it_and_a_wall_stays_calm() {
    for rate in RATES {
        for mass in [0.5, 5.0, 50.0] {
            let mut stage = Stage::with_ground(rate);
            stage.block(Vec3::new(3.0, 2.0, 0.0), Vec3::new(0.5, 2.0, 5.0));
            let light = stage.dynamic(Vec3::new(2.0, 0.5, 0.0), Vec3::splat(0.49), mass);
            let hero = stage.hero(Vec3::ZERO);
            stage.steer(hero, Vec3::X * 5.0);
            let mut fastest: Real = 0.0;
            for _ in 0..4 * rate {
                stage.step();
                fastest = fastest.max(speed(&stage, light));
            }
            let (place, end) = (stage.position(light), stage.position(hero));
            assert!(fastest < 7.0, "{rate} Hz, {mass} kg: {fastest} m/s");
            assert!(place.is_finite() && place.x < 2.6, "{rate} Hz, {mass} kg: {place}");
            assert!(end.x < place.x && end.y < 0.1, "{rate} Hz, {mass} kg: {end}, {place}");
        }
    }
}

/// A see-saw: a plank over a hinge, a weight at one end, a character at the other.
#[test]
fn its_weight_tips_a_see_saw() {
    for (mass, tips) in [(40.0, true), (160.0, false)] {
        let mut stage = Stage::with_ground(60);
        let plank = stage.dynamic(Vec3::Y * 0.5, Vec3::new(3.0, 0.05, 0.5), 30.0);
        let frame = RigidBody::new(Shape::Point).fixed().build().unwrap().spawn(&mut stage.world);
        let hinge = Joint::hinge(frame, plank).at(&stage.world, Vec3::Y * 0.5, Vec3::Z).unwrap();
        stage.world.spawn((hinge,));
        let weight = stage.dynamic(Vec3::new(2.5, 0.75, 0.0), Vec3::splat(0.2), mass);
        let hero = stage.hero(Vec3::new(-2.5, 0.6, 0.0));
        stage.play(hero, 3.0);
        let higher = stage.position(weight).y > stage.position(hero).y;
        assert_eq!(higher, tips, "{mass} kg: {} and {}", stage.position(weight), stage.position(hero));
    }
}

/// The ground carries a slab, and what the character on it weighs.
#[test]
fn it_weighs_what_is_set() {
    for rate in [30, 60, 240] {
        let mut stage = Stage::with_ground(rate);
        let slab = stage.dynamic(Vec3::Y * 0.1, Vec3::new(1.0, 0.1, 1.0), 100.0);
        let hero = stage.hero(Vec3::new(0.2, 0.25, 0.1));
        stage.play(hero, 2.0);
        let contacts = stage.simulation.contacts().filter(|it| it.bodies.contains(&slab) && !it.bodies.contains(&hero));
        let force =
            contacts.map(|it| it.impulse().length()).sum::<Real>() / stage.simulation.settings().contact_substep();
        assert!((force / (180.0 * 9.81) - 1.0).abs() < 0.01, "{rate} Hz: {force} N");
    }
}

#[test]
fn dynamic_bodies_bounce_off_it() {
    let mut stage = Stage::with_ground(60);
    let ball = RigidBody::new(Shape::sphere(0.15)).mass(0.5).position(Vec3::new(4.0, 1.0, 0.0));
    let ball = ball.material(Material::default().with_restitution(0.8)).linear_velocity(Vec3::X * -12.0);
    let ball = ball.build().unwrap().spawn(&mut stage.world);
    let hero = stage.hero(Vec3::ZERO);
    stage.play(hero, 0.6);
    assert!(stage.velocity(ball).x > 1.0, "{}", stage.velocity(ball));
    assert!(stage.position(hero).length() < 0.02);
    // And what falls on its head does not push it into the ground.
    let brick = stage.dynamic(Vec3::new(0.0, 3.0, 0.0), Vec3::splat(0.2), 10.0);
    for seen in stage.play(hero, 3.0) {
        assert!(seen.position.y > -0.01 && !seen.state.is_crushed);
    }
    assert!(stage.position(brick).y < 2.5);
}

#[test]
fn a_ball_is_kicked_and_not_stepped_on() {
    let mut stage = Stage::with_ground(60);
    let ball = RigidBody::new(Shape::sphere(0.11)).mass(0.45).position(Vec3::new(2.0, 0.11, 0.0));
    let ball = ball.build().unwrap().spawn(&mut stage.world);
    let hero = stage.hero(Vec3::ZERO);
    stage.steer(hero, Vec3::X * 4.0);
    let highest = stage.play(hero, 2.0).iter().map(|it| it.position.y).fold(0.0, Real::max);
    assert!(highest < 0.01, "{highest}");
    assert!(stage.position(ball).x > stage.position(hero).x, "{}", stage.position(ball));
}

/// Thrown into a heap of boxes it gets through or stands still, and nothing explodes.
#[test]
fn a_heap_of_boxes_stays_a_heap() {
    for rate in [30, 60, 120] {
        let mut stage = Stage::with_ground(rate);
        let mut rng = tumble::Rng::new(11);
        let boxes: Vec<Entity> = (0..40)
            .map(|i| {
                let place = Vec3::new(rng.range(-2.0, 2.0), 0.3 + 0.3 * i as Real, rng.range(-2.0, 2.0));
                let half = rng.range(0.1, 0.3);
                stage.dynamic(place, Vec3::splat(half), f64::from(half * half * half * 2000.0))
            })
            .collect();
        let hero = stage.hero(Vec3::X * 6.0);
        stage.play(hero, 3.0);
        let mut fastest: Real = 0.0;
        for part in 0..12 {
            let way = Vec3::new(rng.range(-1.0, 1.0), 0.0, rng.range(-1.0, 1.0)) - stage.position(hero) * 0.3;
            stage.steer(hero, way.normalize_or(Vec3::X) * 4.0);
            for _ in 0..rate / 2 {
                stage.step();
                fastest = boxes.iter().map(|it| speed(&stage, *it)).fold(fastest, Real::max);
            }
            assert!(fastest < 15.0, "{rate} Hz, part {part}: {fastest} m/s");
        }
        assert!(stage.position(hero).y > -0.05);
    }
}

/// Two that walk into each other stop, and one that is put into another gets out.
#[test]
fn characters_do_not_pass_through_each_other() {
    for rate in RATES {
        let mut stage = Stage::with_ground(rate);
        let (left, right) = (stage.hero(Vec3::X * -3.0), stage.hero(Vec3::X * 3.0));
        stage.steer(left, Vec3::X * 4.0);
        stage.steer(right, Vec3::X * -4.0);
        stage.play(left, 2.0);
        let gap = stage.position(right).x - stage.position(left).x;
        assert!(gap > 0.55 && gap < 0.8, "{rate} Hz: {gap}");
        let mut stage = Stage::with_ground(rate);
        let (first, second) = (stage.hero(Vec3::ZERO), stage.hero(Vec3::new(0.1, 0.0, 0.05)));
        stage.play(first, 1.0);
        let gap = (stage.position(second) - stage.position(first)).length();
        assert!(gap > 0.57 && gap < 0.7, "{rate} Hz: {gap}");
    }
}
