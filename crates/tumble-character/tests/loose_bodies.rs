//! Promise: what a character walks over, runs into and lands on gets no faster than it, however
//! light it is, and what carries it gets its weight as a body of its mass would give it.
#![allow(clippy::unwrap_used, reason = "what is not as the test needs it is a failed test")]
#![allow(
    clippy::useless_conversion,
    clippy::unnecessary_cast,
    reason = "Real is f32 in one build and f64 in the other"
)]

mod shared;

use shared::{HEIGHT, Stage};
use tumble::hecs::Entity;
use tumble::prelude::*;
use tumble::{GravityScale, Rng};
use tumble_character::{CharacterInput, CharacterSettings};

const GRAVITY: Real = 9.81;
const MASS: Real = 80.0;

/// A rod, a ball, a box or a flat box, as they are beside a character of 1.8 m, and its height.
fn shape(rng: &mut Rng, relative: Real) -> (Shape, Real) {
    let size = |long: f64| long * f64::from(relative);
    let (shape, half) = match rng.next_u64() % 4 {
        0 => (Shape::cuboid([size(0.15), size(0.02), size(0.02)]), 0.02),
        1 => (Shape::sphere(size(0.05)), 0.05),
        2 => (Shape::cuboid([size(0.1); 3]), 0.1),
        _ => (Shape::cuboid([size(0.05), size(0.02), size(0.05)]), 0.02),
    };
    (shape, half * relative)
}

/// Loose bodies of 0.02 to 50 kg beside a character of 1.8 m, on the ground.
fn scatter(stage: &mut Stage, rng: &mut Rng, relative: Real) -> Vec<Entity> {
    let heaviness = f64::from(relative * relative * relative);
    let mut body = |i: u16| {
        let (shape, half) = shape(rng, relative);
        let mass = 0.02 * 2500_f64.powf(rng.unit()) * heaviness;
        let (row, column) = (Real::from(i / 5), Real::from(i % 5));
        let place = Vec3::new(column - 2.0, 0.0, row - 2.0) * (0.45 * relative) + Vec3::Y * half;
        let turn = Quat::from_rotation_y(rng.range(0.0, 6.0));
        let body = RigidBody::new(shape).mass(mass).position(place).orientation(turn);
        body.build().unwrap().spawn(&mut stage.world)
    };
    (0..25).map(&mut body).collect()
}

fn to_and_fro(rng: &mut Rng, place: Vec3, relative: Real) -> CharacterInput {
    let speed = rng.range(1.0, 4.0) * relative.sqrt();
    let across = Vec3::new(rng.range(-1.0, 1.0), 0.0, rng.range(-1.0, 1.0));
    let way = across * relative - place * Vec3::new(1.0, 0.0, 1.0);
    CharacterInput { velocity: way.normalize_or(Vec3::X) * speed, jump: rng.unit() < 0.4, crouch: false }
}

/// Twice as fast as it, and what a step of gravity adds: round bodies are squeezed out from under
/// its foot.
#[test]
fn loose_bodies_get_no_faster_than_it() {
    for number in 0..48 {
        let mut rng = Rng::stream(31, number);
        let height = 0.1 * 200_f64.powf(rng.unit()) as Real;
        let (relative, rate) = (height / HEIGHT, [30, 60, 120, 240][(number % 4) as usize]);
        let mut stage = Stage::with_ground(rate);
        let bodies = scatter(&mut stage, &mut rng, relative);
        let settings = CharacterSettings::of_height(height);
        let hero = stage.character(settings, Vec3::new(0.2, 0.0, 1.6) * relative);
        let (mut own, mut fastest): (Real, Real) = (0.0, 0.0);
        for _ in 0..10 {
            let input = to_and_fro(&mut rng, stage.position(hero), relative);
            stage.input(hero, input);
            for _ in 0..(0.5 * relative.sqrt() * rate as Real).ceil() as u32 {
                own = own.max(stage.seen(hero).state.velocity.length());
                stage.step();
                own = own.max(stage.seen(hero).state.velocity.length());
                fastest = bodies.iter().map(|it| stage.velocity(*it).length()).fold(fastest, Real::max);
            }
        }
        let most = 2.0 * (own + GRAVITY * stage.dt());
        assert!(fastest < most, "{number}: {height} m, {rate} Hz: {fastest} m/s at {own} m/s");
        assert!(fastest > 0.1 * own, "{number}: it has met none");
    }
}

/// One rod in all places below its way.
#[test]
fn a_rod_under_its_foot_stays_where_it_is() {
    for number in 0..120 {
        let mut rng = Rng::stream(37, number);
        let mut stage = Stage::with_ground([30, 60][(number % 2) as usize]);
        let mass = [0.05, 0.3, 1.0][(number % 3) as usize];
        let rod = RigidBody::new(Shape::cuboid([0.15, 0.02, 0.02])).mass(mass);
        let rod = rod.position(Vec3::new(rng.range(-0.2, 0.2), 0.02, -1.0));
        let rod = rod.orientation(Quat::from_rotation_y(rng.range(0.0, 3.2))).build().unwrap().spawn(&mut stage.world);
        let hero = stage.hero(Vec3::ZERO);
        stage.steer(hero, Vec3::Z * -2.0);
        let mut fastest: Real = 0.0;
        for _ in 0..(1.2 / stage.dt()) as u32 {
            stage.step();
            fastest = fastest.max(stage.velocity(rod).length());
        }
        assert!(fastest < 2.0, "{number}: {mass} kg: {fastest} m/s");
    }
}

/// A slab without gravity, a character that falls onto it from this height, and the share of both
/// masses that is its own.
fn floating_slab(rate: u32, mass: f64, height: Real) -> (Stage, Entity, Entity, Real) {
    let mut stage = Stage::new(rate);
    let slab = stage.dynamic(Vec3::Y * -0.1, Vec3::new(2.0, 0.1, 2.0), mass);
    stage.world.insert_one(slab, GravityScale(0.0)).unwrap();
    let hero = stage.hero(Vec3::Y * height);
    (stage, slab, hero, MASS / (MASS + mass as Real))
}

/// Its weight moves both.
#[test]
fn a_slab_that_floats_gets_the_weight_of_a_body_of_its_mass() {
    for rate in [30, 60, 240] {
        for mass in [12.0, 80.0, 800.0] {
            let (mut stage, slab, hero, share) = floating_slab(rate, mass, 0.0);
            stage.play(hero, 1.0);
            let (speed, expected) = (-stage.velocity(slab).y, share * GRAVITY);
            assert!((speed - expected).abs() < expected * 2.1 * stage.dt() + 0.01, "{rate} Hz, {mass} kg: {speed}");
            let pressed = stage.seen(hero).state.load / (expected * mass as Real);
            assert!((pressed - 1.0).abs() < 0.01, "{rate} Hz, {mass} kg: {pressed}");
        }
    }
}

/// What it brings when it lands is shared, and nothing comes back.
#[test]
fn a_slab_that_floats_gets_the_blow_of_a_body_of_its_mass() {
    for rate in [30, 60, 240] {
        for mass in [0.05, 12.0, 80.0, 800.0] {
            let (mut stage, slab, hero, share) = floating_slab(rate, mass, 0.5);
            while !stage.seen(hero).state.is_grounded() {
                stage.step();
            }
            let (speed, fallen) = (-stage.velocity(slab).y, (GRAVITY * (0.5 + 0.5) as Real).sqrt());
            let most = share * fallen + 2.1 * GRAVITY * stage.dt();
            assert!(speed > share * fallen * 0.99 && speed < most, "{rate} Hz, {mass} kg: {speed} below {most}");
        }
    }
}

/// A plank of an eighth of its mass and more, which lies on two blocks, carries all of it.
#[test]
fn a_light_plank_that_rests_on_others_carries_it() {
    for rate in [30, 60, 240] {
        for mass in [12.0, 40.0] {
            let mut stage = Stage::with_ground(rate);
            for x in [-1.0, 1.0] {
                stage.dynamic(Vec3::new(x, 0.2, 0.0), Vec3::new(0.2, 0.2, 0.4), 60.0);
            }
            let plank = stage.dynamic(Vec3::Y * 0.45, Vec3::new(1.2, 0.05, 0.4), mass);
            let hero = stage.hero(Vec3::Y * 0.5);
            stage.play(hero, 3.0);
            let contacts = stage.simulation.contacts().filter(|it| it.bodies.contains(&plank));
            let force = contacts.map(|it| it.impulse().length()).sum::<Real>();
            let force = force / stage.simulation.settings().contact_substep();
            let weight = (MASS + mass as Real) * GRAVITY;
            assert!((force / weight - 1.0).abs() < 0.01, "{rate} Hz, {mass} kg: {force} N for {weight}");
        }
    }
}

/// What falls with it carries nothing, and falls no faster than without it.
#[test]
fn a_slab_that_falls_with_it_feels_no_weight() {
    for rate in [30, 60, 240] {
        let mut stage = Stage::new(rate);
        let slab = stage.dynamic(Vec3::Y * -0.1, Vec3::new(2.0, 0.1, 2.0), 10.0);
        let hero = stage.hero(Vec3::ZERO);
        stage.play(hero, 1.0);
        let speed = -stage.velocity(slab).y;
        assert!(speed < GRAVITY * (1.0 + 4.0 * stage.dt()), "{rate} Hz: {speed} m/s");
    }
}
