//! The stress scene is the same for everyone: one seed, one set of bits, on every platform.
//!
//! Published speeds and hashes are worth nothing if the scene behind them changes. It would fail if
//! the generator, the order of its draws or the arithmetic after it changed.

use hecs::World;
use tumble::{BodyId, BodyOrder, Momentum, Pose, state_hash};
use tumble_import::FileError;
use tumble_scene::{MAX_BODIES, Scene, SceneError};

fn world(bodies: usize, seed: u64) -> World {
    let mut world = World::new();
    Scene::stress(bodies, seed).unwrap().spawn(&mut world).unwrap();
    world
}

fn hash(bodies: usize, seed: u64) -> u64 {
    let world = world(bodies, seed);
    state_hash(&world, &BodyOrder::of(&world))
}

#[test]
fn the_initial_state_is_pinned() {
    let expected = if tumble::math::PRECISION == "f32" { PINNED_F32 } else { PINNED_F64 };
    assert_eq!(format!("{:016x}", hash(1000, 1)), expected);
}

#[test]
fn a_seed_gives_the_same_bits_again_and_another_seed_others() {
    assert_eq!(hash(100, 7), hash(100, 7));
    assert_ne!(hash(100, 7), hash(100, 8));
}

#[test]
fn more_bodies_do_not_change_how_the_first_ones_move() {
    let (few, many) = (world(10, 3), world(500, 3));
    let (few_order, many_order) = (BodyOrder::of(&few), BodyOrder::of(&many));
    for (few_entity, many_entity) in few_order.entities().iter().zip(many_order.entities()) {
        assert_eq!(*few.get::<&Momentum>(*few_entity).unwrap(), *many.get::<&Momentum>(*many_entity).unwrap());
        let orientation = |world: &World, entity| world.get::<&Pose>(entity).unwrap().orientation;
        assert_eq!(orientation(&few, *few_entity), orientation(&many, *many_entity));
    }
}

#[test]
fn ids_are_the_order_of_the_names() {
    let world = world(20, 0);
    for (index, &entity) in BodyOrder::of(&world).entities().iter().enumerate() {
        assert_eq!(world.get::<&BodyId>(entity).unwrap().0, index as u64);
    }
}

#[test]
fn too_many_bodies_are_refused_before_any_is_made() {
    assert!(matches!(Scene::stress(MAX_BODIES + 1, 0), Err(SceneError::File(FileError::Invalid { .. }))));
}

const PINNED_F32: &str = "d77b974de3b52d80";
const PINNED_F64: &str = "d2f77e183f560a2b";
