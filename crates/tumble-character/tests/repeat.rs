//! Promise: the same characters give the same bits, whatever the number of threads and the order
//! in which they were spawned, and after they were put back to an earlier step.
#![allow(clippy::unwrap_used, reason = "what is not as the test needs it is a failed test")]
#![allow(
    clippy::useless_conversion,
    clippy::unnecessary_cast,
    reason = "Real is f32 in one build and f64 in the other"
)]

mod shared;

use rayon::ThreadPoolBuilder;
use shared::Stage;
use tumble::hecs::{Entity, World};
use tumble::prelude::*;
use tumble::{Rng, Rollback};
use tumble_character::{Character, CharacterInput, CharacterSettings, CharacterState, SavedCharacters};

const COUNT: u64 = 250;

/// A crowd on hills, among boxes, some of which move.
fn crowd(backwards: bool) -> Stage {
    let mut stage = Stage::new(60);
    let mut rng = Rng::new(17);
    let heights: Vec<f64> = (0..41 * 41).map(|_| f64::from(rng.range(0.0, 0.4))).collect();
    let field = tumble::Collider::height_field(heights, 41, [1.0, 1.0]).unwrap();
    stage.world.spawn((Pose::default(), field, BodyId(0)));
    let orders = [false, true].map(|turn| turn == backwards);
    let numbers: Vec<u64> = if orders[0] { (0..COUNT).collect() } else { (0..COUNT).rev().collect() };
    for i in numbers {
        let mut rng = Rng::stream(19, i);
        let place = Vec3::new(rng.range(-15.0, 15.0), 1.0, rng.range(-15.0, 15.0));
        let thing = match i % 5 {
            0 => {
                let body = RigidBody::new(Shape::cuboid([0.3; 3])).mass(20.0).position(place + Vec3::Y);
                body.build().unwrap().spawn(&mut stage.world)
            }
            1 => {
                let body = RigidBody::new(Shape::cuboid([1.0, 0.2, 1.0])).kinematic().position(place - Vec3::Y * 0.5);
                let body = body.linear_velocity(rng.vector(-0.3, 0.3)).angular_velocity(Vec3::Y * rng.range(-1.0, 1.0));
                body.build().unwrap().spawn(&mut stage.world)
            }
            _ => {
                let settings = CharacterSettings::of_height(rng.range(0.8, 2.0));
                stage.world.spawn(Character::new(settings).unwrap().at(place))
            }
        };
        stage.world.insert_one(thing, BodyId(i + 1)).unwrap();
    }
    stage
}

fn steer(world: &mut World, step: u64) {
    for (id, input) in world.query_mut::<(&BodyId, &mut CharacterInput)>() {
        let mut rng = Rng::stream(id.0, step / 20);
        input.velocity = Vec3::new(rng.range(-4.0, 4.0), 0.0, rng.range(-4.0, 4.0));
        input.jump = rng.unit() < 0.2;
        input.crouch = rng.unit() < 0.1;
    }
}

fn play(stage: &mut Stage, from: u64, to: u64) {
    for step in from..to {
        steer(&mut stage.world, step);
        stage.step();
    }
}

/// All that there is to know of all bodies, by id.
fn bits(world: &World) -> Vec<(u64, Vec<u64>)> {
    let mut found: Vec<(u64, Vec<u64>)> = world
        .query::<(&BodyId, &Pose, Option<&Velocity>, Option<&CharacterState>)>()
        .iter()
        .map(|(id, pose, velocity, state)| {
            let velocity = velocity.map_or(Vec3::ZERO, |it| it.linear);
            let state = state.copied().unwrap_or_default();
            let numbers = [pose.position, velocity, state.velocity, state.ground_normal, state.ground_velocity];
            let turned = pose.orientation.to_array();
            let all = numbers.iter().flat_map(Vec3::to_array).chain(turned).chain([state.air_time]);
            (id.0, all.map(|it| f64::from(it).to_bits()).collect())
        })
        .collect();
    found.sort();
    found
}

#[test]
fn threads_and_the_order_of_spawning_do_not_matter() {
    let run = |threads: usize, backwards: bool| {
        let mut stage = crowd(backwards);
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| play(&mut stage, 0, 100));
        bits(&stage.world)
    };
    let reference = run(1, false);
    for (threads, backwards) in [(2, false), (4, false), (1, true), (3, true)] {
        assert!(run(threads, backwards) == reference, "{threads} threads, backwards: {backwards}");
    }
}

#[test]
fn a_rewind_leads_to_the_same_bits() {
    let mut stage = crowd(false);
    let mut rollback = Rollback::new(64);
    let mut saved = Vec::new();
    for step in 0..120 {
        rollback.save(&stage.world, &stage.simulation).unwrap();
        saved.push(SavedCharacters::capture(&stage.world));
        play(&mut stage, step, step + 1);
    }
    let end = bits(&stage.world);
    for back in [100, 70, 119] {
        rollback.rewind_to_step(back, &mut stage.world, &mut stage.simulation).unwrap();
        saved[back as usize].restore(&mut stage.world);
        for step in back..120 {
            rollback.save(&stage.world, &stage.simulation).unwrap();
            play(&mut stage, step, step + 1);
        }
        assert!(bits(&stage.world) == end, "back to step {back}");
    }
}

/// Characters of another world, made from the saved state alone, go on as the first do.
#[test]
fn another_world_goes_on_with_the_same_bits() {
    let mut stage = crowd(false);
    play(&mut stage, 0, 90);
    let (snapshot, saved) = (stage.simulation.snapshot(&stage.world).unwrap(), SavedCharacters::capture(&stage.world));
    let mut other = crowd(true);
    other.simulation.restore(&snapshot, &mut other.world).unwrap();
    saved.restore(&mut other.world);
    play(&mut stage, 90, 150);
    play(&mut other, 90, 150);
    assert!(bits(&stage.world) == bits(&other.world));
}

/// What is known of a character is no more than its components.
#[test]
fn a_state_is_a_plain_copy() {
    fn is_plain<T: Copy + Send + Sync + 'static>() {}
    is_plain::<CharacterState>();
    is_plain::<CharacterInput>();
    let mut stage = Stage::with_ground(60);
    let hero: Entity = stage.hero(Vec3::Y);
    let before = stage.seen(hero);
    stage.step();
    assert_ne!(stage.seen(hero).state, before.state);
}
