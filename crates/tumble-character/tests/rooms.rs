//! Promise: in random closed rooms, whatever is in them and whatever it is made to do, a character
//! never gets out or through anything fixed, is never nowhere, gains no height but by jumps, steps
//! and what lifts it, and is not stuck where there is a way.
//!
//! `TUMBLE_WALKS` is the number of rooms, of 300 steps each.
#![allow(clippy::unwrap_used, reason = "what is not as the test needs it is a failed test")]
#![allow(
    clippy::useless_conversion,
    clippy::unnecessary_cast,
    reason = "Real is f32 in one build and f64 in the other"
)]

mod shared;

use shared::Stage;
use tumble::hecs::Entity;
use tumble::prelude::*;
use tumble::{Queries, Rng};
use tumble_character::{CharacterInput, CharacterSettings};

const ROOM: Real = 6.0;
const STEPS: u32 = 300;

fn walks() -> u64 {
    std::env::var("TUMBLE_WALKS").ok().and_then(|it| it.parse().ok()).unwrap_or(60)
}

fn closed_room(stage: &mut Stage) {
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        for side in [-1.0, 1.0] {
            let half = Vec3::splat(ROOM + 1.0) - axis * (ROOM + 0.95);
            stage.block(axis * side * (ROOM + 0.05), half);
        }
    }
}

fn fixed(stage: &mut Stage, shape: Shape, place: Vec3, turn: Quat) {
    let body = RigidBody::new(shape).fixed().position(place).orientation(turn);
    body.build().unwrap().spawn(&mut stage.world);
}

fn clutter(stage: &mut Stage, rng: &mut Rng) {
    for _ in 0..rng.range(5.0, 40.0) as u32 {
        let place = Vec3::new(rng.range(-ROOM, ROOM), rng.range(-ROOM, -ROOM + 2.5), rng.range(-ROOM, ROOM));
        let turn = if rng.unit() < 0.5 { Quat::IDENTITY } else { rng.orientation() };
        let size = |rng: &mut Rng| f64::from(rng.range(0.05, 1.2));
        let (a, b, c) = (size(rng), size(rng), size(rng));
        let shape = match rng.next_u64() % 5 {
            0 => Shape::sphere(a),
            1 => Shape::cylinder(a, b),
            2 => Shape::capsule(a, b),
            _ => Shape::cuboid([a, b, c]),
        };
        fixed(stage, shape, place, turn);
    }
}

fn heights(rng: &mut Rng, count: usize) -> Vec<f64> {
    let rough = rng.range(0.1, 2.0);
    (0..count * count).map(|_| f64::from(rng.range(0.0, rough))).collect()
}

fn hills(stage: &mut Stage, rng: &mut Rng) -> Entity {
    let heights = heights(rng, 15);
    let collider = tumble::Collider::height_field(heights, 15, [0.9, 0.9]).unwrap();
    stage.world.spawn((Pose::at(Vec3::Y * -ROOM), collider))
}

fn triangles(stage: &mut Stage, rng: &mut Rng) -> Entity {
    let heights = heights(rng, 15);
    let at = |i: usize| (i as Real - 7.0) * 0.9;
    let corners: Vec<Vec3> = (0..225)
        .map(|k| {
            Vec3::new(at(k % 15) + rng.range(-0.3, 0.3), heights[k] as Real - ROOM, at(k / 15) + rng.range(-0.3, 0.3))
        })
        .collect();
    let cells = (0..210_u32).filter(|k| k % 15 < 14);
    let triangles: Vec<[u32; 3]> = cells.flat_map(|k| [[k, k + 15, k + 1], [k + 1, k + 15, k + 16]]).collect();
    stage.mesh(&corners, &triangles)
}

fn moving(stage: &mut Stage, rng: &mut Rng) {
    for _ in 0..6 {
        let place = Vec3::new(rng.range(-4.0, 4.0), rng.range(-ROOM, -ROOM + 2.0), rng.range(-4.0, 4.0));
        let half = Vec3::new(rng.range(0.3, 1.5), rng.range(0.1, 0.5), rng.range(0.3, 1.5));
        let velocity = Velocity { linear: rng.vector(-1.0, 1.0), angular: Vec3::Y * rng.range(-1.0, 1.0) };
        stage.mover(place, half, velocity);
    }
    for _ in 0..8 {
        let place = Vec3::new(rng.range(-4.0, 4.0), rng.range(-3.0, 3.0), rng.range(-4.0, 4.0));
        stage.dynamic(place, Vec3::splat(rng.range(0.1, 0.4)), f64::from(rng.range(1.0, 100.0)));
    }
}

/// A room of a kind, a character in it, and what covers its floor.
fn room(rng: &mut Rng, kind: u64, rate: u32) -> (Stage, Entity, Option<Entity>) {
    let mut stage = Stage::new(rate);
    closed_room(&mut stage);
    let mut ground = None;
    match kind {
        0 => clutter(&mut stage, rng),
        1 => ground = Some(hills(&mut stage, rng)),
        2 => ground = Some(triangles(&mut stage, rng)),
        3 => {
            ground = Some(hills(&mut stage, rng));
            clutter(&mut stage, rng);
        }
        _ => {
            clutter(&mut stage, rng);
            moving(&mut stage, rng);
        }
    }
    let settings = CharacterSettings::of_height(rng.range(0.6, 2.0));
    let place = Vec3::new(rng.range(-4.0, 4.0), 1.0, rng.range(-4.0, 4.0));
    let hero = stage.character(settings, place);
    (stage, hero, ground)
}

fn input(rng: &mut Rng) -> CharacterInput {
    let speed = if rng.unit() < 0.1 { rng.range(10.0, 200.0) } else { rng.range(0.0, 8.0) };
    let velocity = Vec3::new(rng.range(-1.0, 1.0), 0.0, rng.range(-1.0, 1.0)) * speed;
    CharacterInput { velocity, jump: rng.unit() < 0.3, crouch: rng.unit() < 0.1 }
}

/// Whether rays through the middle of the capsule, from where it was, straight and over a step,
/// all meet something fixed.
fn is_through(stage: &Stage, [before, after]: [Vec3; 2], half: Real, lift: Real) -> bool {
    let queries = Queries::of(&stage.world);
    let filter = QueryFilter::new().without_kinematic().without_dynamic();
    let [from, to] = [before, after].map(|it| it + Vec3::Y * half);
    let meets = |a: Vec3, b: Vec3| a != b && queries.is_blocked(&Ray::between(a, b), &filter);
    let over = Vec3::Y * lift.max(to.y - from.y);
    let corner = Vec3::new(to.x, from.y, to.z) + over;
    // A longer way may go round and over things; that it stays in the room is asked of it too.
    let is_short = (to - from).length() < 2.0 * half;
    is_short && meets(from, to) && (meets(from, from + over) || meets(from + over, corner) || meets(corner, to))
}

/// Whether the middle of the capsule is below what covers the floor.
fn is_under_ground(stage: &Stage, ground: Option<Entity>, place: Vec3, half: Real) -> bool {
    let Some(ground) = ground else { return false };
    let is_ground = move |entity| entity == ground;
    let filter = QueryFilter::new().matching(&is_ground);
    let down = Ray::new(place + Vec3::Y * half, -Vec3::Y).with_max_distance(2.0 * ROOM);
    Queries::of(&stage.world).cast_ray(&down, &filter).is_none()
}

#[test]
fn nothing_fixed_is_passed() {
    for number in 0..walks() {
        let mut rng = Rng::stream(23, number);
        let kind = number % 5;
        let rate = [10, 20, 60, 60, 144, 240][(rng.next_u64() % 6) as usize];
        let (mut stage, hero, ground) = room(&mut rng, kind, rate);
        let settings = *stage.world.get::<&tumble_character::Character>(hero).unwrap().settings();
        let half = settings.crouch_height * 0.5;
        let mut before = stage.position(hero);
        // What is lifted by others is not bounded here.
        let may_be_lifted = kind == 4;
        let (mut base, mut was_grounded) = (before.y, false);
        for step in 0..STEPS {
            if step % 15 == 0 {
                stage.input(hero, input(&mut rng));
            }
            stage.step();
            let seen = stage.seen(hero);
            let place = seen.position;
            let label = format!("room {number} ({kind}), {rate} Hz, step {step}: {before} to {place}");
            assert!(place.is_finite() && seen.state.velocity.is_finite(), "{label}");
            let inside = ROOM + 0.01;
            assert!(place.x.abs() < inside && place.z.abs() < inside && place.y > -inside && place.y < ROOM, "{label}");
            if !may_be_lifted || !seen.state.is_crushed {
                assert!(!is_through(&stage, [before, place], half, settings.step_height), "through: {label}");
                assert!(!is_under_ground(&stage, ground, place, half), "under: {label}");
            }
            // Steps and slopes that it has walked in this step before it left the ground, as far as
            // it got across; and a jump.
            let gone = Vec3::new(place.x - before.x, 0.0, place.z - before.z).length();
            let walked = gone * settings.max_slope.tan() + settings.step_height * (1.0 + gone / settings.radius);
            let most = base + settings.jump_height + if was_grounded { walked } else { settings.step_height };
            assert!(may_be_lifted || place.y < most + 0.05, "{label}, from {base} above {most}");
            match (was_grounded, seen.state.is_grounded()) {
                (_, true) => base = place.y,
                (true, false) => base += walked,
                _ => {}
            }
            was_grounded = seen.state.is_grounded();
            before = place;
        }
    }
}

/// Where its capsule could go straight on for a while, it does.
#[test]
fn it_is_not_stuck_where_there_is_a_way() {
    for number in 0..walks() {
        let mut rng = Rng::stream(29, number);
        let kind = number % 4;
        let (mut stage, hero, _) = room(&mut rng, kind, 60);
        let settings = *stage.world.get::<&tumble_character::Character>(hero).unwrap().settings();
        for _ in 0..4 {
            stage.input(hero, CharacterInput { jump: false, crouch: false, ..input(&mut rng) });
            stage.play(hero, 0.5);
            stage.steer(hero, Vec3::ZERO);
            stage.play(hero, 0.5);
            let from = stage.seen(hero);
            if !from.state.is_grounded() || from.state.velocity.length() > 0.01 {
                continue;
            }
            let Some(way) = free_way(&stage, &mut rng, hero, settings.radius) else { continue };
            stage.steer(hero, way * 2.0);
            let end = stage.play(hero, 1.0).last().unwrap().position;
            let moved = (end - from.position) * Vec3::new(1.0, 0.0, 1.0);
            assert!(
                moved.length() > 0.3 || end.y < from.position.y - 0.5,
                "room {number} ({kind}): {} to {end} along {way}, {:?}",
                from.position,
                from.state
            );
        }
    }
}

/// A level way along which its collider meets nothing for twice its width, over ground that is
/// not steep.
fn free_way(stage: &Stage, rng: &mut Rng, hero: Entity, radius: Real) -> Option<Vec3> {
    let queries = Queries::of(&stage.world);
    let collider = (*stage.world.get::<&tumble::Collider>(hero).unwrap()).clone();
    let pose = *stage.world.get::<&Pose>(hero).unwrap();
    let filter = QueryFilter::new().without(hero);
    let length = (4.0 * radius).max(0.6);
    let is_free = |way: Vec3| queries.cast_shape(&collider, &pose, way * length, &filter).is_none();
    let is_flat = |way: Vec3| {
        (1..=10).all(|part| {
            let over = Pose { position: pose.position + way * (length * part as Real * 0.1), ..pose };
            let below = queries.cast_shape(&collider, &over, Vec3::Y * -2.0, &filter);
            below.is_some_and(|it| it.normal.y > 0.65)
        })
    };
    (0..8).find_map(|_| {
        let (sin, cos) = rng.range(0.0, std::f64::consts::TAU as Real).sin_cos();
        let way = Vec3::new(cos, 0.0, sin);
        (is_free(way) && is_flat(way)).then_some(way)
    })
}
