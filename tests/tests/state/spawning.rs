//! Promise: however bodies are spawned, one by one, many of any kinds or many copies of one, they
//! have the same components with the same bits, and the entities come back in the order of the
//! bodies.
//!
//! Why: the ways to many bodies at once write columns and not entities. It fails where one forgets
//! a component, mixes up rows, takes over an entity of the caller's, or derives a quantity of the
//! wrong body.

use std::collections::BTreeSet;

use hecs::{ColumnBatchType, Component, Entity, EntityBuilder, EntityRef, World};
use tumble::glam::{DQuat, DVec3};
use tumble::math::{Quat, Real, Vec3};
use tumble::{
    Amount, Body, BodyId, CenterOfMass, Damping, GravityScale, Inertia, InertiaTensor, InverseInertia, Mass, Momentum,
    Part, Pose, PreviousPose, PrincipalAxes, RigidBody, Settings, Shape, Velocity, Wrench, spawn_bodies, step,
    update_derived,
};
use tumble_benches::mixed_body;
use tumble_tests::hash;

/// Not a multiple of the blocks that bodies are spawned in, and some of them.
const BODIES: u64 = 2500;

fn component<T: Component + Copy + std::fmt::Debug>(entity: EntityRef<'_>) -> String {
    entity.get::<&T>().map_or_else(String::new, |component| format!("{:?} ", *component))
}

/// Everything a body may have, written out: numbers that print alike have the same bits, but for
/// NaNs, of which there are none.
fn components(world: &World, entity: Entity) -> String {
    let e = world.entity(entity).unwrap();
    let state = component::<Pose>(e) + &component::<PreviousPose>(e) + &component::<Momentum>(e);
    let constant = component::<Mass>(e) + &component::<Inertia>(e) + &component::<PrincipalAxes>(e);
    let derived = component::<Velocity>(e) + &component::<InverseInertia>(e) + &component::<Wrench>(e);
    let own = component::<GravityScale>(e) + &component::<Damping>(e) + &component::<CenterOfMass>(e);
    state + &constant + &derived + &own + &component::<BodyId>(e)
}

/// Bodies of every kind, every fifth drawn between steps and every seventh without an identity.
fn bodies() -> Vec<Body> {
    let body = |i: u64| match i % 35 {
        0 | 7 | 14 | 21 | 28 => {
            RigidBody::new(Shape::sphere(0.1 + 0.001 * i as f64)).without_collider().mass(1.0).build().unwrap()
        }
        5 | 10 | 15 => {
            let brick = RigidBody::new(Shape::cuboid([0.1, 0.2, 0.3])).without_collider().mass(1.0 + i as f64);
            brick.interpolated().position(Vec3::splat(i as Real)).build().unwrap()
        }
        // One whose frame is only turned, and one whose frame is only off the centre of mass.
        20 => {
            let turned = DQuat::from_rotation_x(0.3);
            let tensor = InertiaTensor::from_principal(DVec3::new(1.0, 2.0, 2.5), turned).unwrap();
            RigidBody::new(Shape::sphere(1.0)).without_collider().mass(1.0).inertia(tensor).build().unwrap()
        }
        25 => {
            let ball = |mass: f64| Part::new(Shape::sphere(0.5), Amount::Mass(mass));
            let dumbbell = Shape::compound([ball(1.0), ball(2.0).at(Vec3::X * 2.0)]);
            RigidBody::new(dumbbell).without_collider().build().unwrap()
        }
        _ => mixed_body(i),
    };
    (0..BODIES).map(body).collect()
}

fn one_by_one(world: &mut World, bodies: &[Body]) -> Vec<Entity> {
    bodies.iter().map(|body| body.spawn(world)).collect()
}

#[test]
fn one_body_has_the_components_of_its_entity_builder() {
    let mut kinds = BTreeSet::new();
    for body in bodies() {
        let mut world = World::new();
        let mut builder = EntityBuilder::new();
        body.insert_into(&mut builder);
        let (built, spawned) = (world.spawn(builder.build()), body.spawn(&mut world));
        assert_eq!(components(&world, spawned), components(&world, built));
        let types = |entity| world.entity(entity).unwrap().component_types().collect::<BTreeSet<_>>();
        assert_eq!(types(spawned), types(built));
        kinds.insert(types(built));
    }
    assert!(kinds.len() >= 8, "only {} kinds were tried", kinds.len());
}

#[test]
fn many_bodies_are_as_if_spawned_one_by_one() {
    let bodies = bodies();
    let (mut slow, mut fast, mut owned) = (World::new(), World::new(), World::new());
    let expected = one_by_one(&mut slow, &bodies);
    assert_eq!(spawn_bodies(&mut fast, &bodies), expected);
    assert_eq!(spawn_bodies(&mut owned, bodies), expected);
    for entity in expected {
        assert_eq!(components(&fast, entity), components(&slow, entity));
        assert_eq!(components(&owned, entity), components(&slow, entity));
    }
    let archetypes = |world: &World| {
        let mut sizes: Vec<u32> = world.archetypes().map(hecs::Archetype::len).filter(|&rows| rows > 0).collect();
        sizes.sort_unstable();
        sizes
    };
    assert_eq!(archetypes(&fast), archetypes(&slow), "no component more and none less");
    for world in [&mut slow, &mut fast] {
        step(world, &Settings::default());
    }
    assert_eq!(hash(&fast), hash(&slow));
}

/// Free handles, fewer than are needed, more, and none, with entities of the caller's and reserved
/// ones among them.
#[test]
fn a_world_in_use_keeps_what_is_in_it() {
    let bodies = bodies();
    for despawned in [1, 700, 3000] {
        let mut world = World::new();
        let mine: Vec<Entity> = (0..6000).map(|i| world.spawn((i,))).collect();
        for entity in &mine[..despawned] {
            world.despawn(*entity).unwrap();
        }
        let reserved = world.reserve_entity();
        let spawned = spawn_bodies(&mut world, &bodies);
        let copies = bodies[1].spawn_copies(&mut world, [(Pose::default(), Momentum::default()); 100]);

        let mut alone = World::new();
        for (entity, expected) in spawned.iter().zip(one_by_one(&mut alone, &bodies)) {
            assert_eq!(components(&world, *entity), components(&alone, expected));
        }
        for (i, entity) in mine.iter().enumerate().skip(despawned) {
            assert_eq!(*world.get::<&i32>(*entity).unwrap(), i as i32);
        }
        assert!(world.contains(reserved) && components(&world, reserved).is_empty());
        let all: BTreeSet<Entity> = spawned.iter().chain(&copies).copied().chain([reserved]).collect();
        assert_eq!(all.len(), bodies.len() + 101, "an entity was given twice");
        assert_eq!(world.len() as usize, all.len() + 6000 - despawned);
    }
}

fn states() -> Vec<(Pose, Momentum)> {
    let state = |i: u64| {
        let x = i as Real;
        let pose = Pose { position: Vec3::new(x, 2.0, -x), orientation: Quat::from_rotation_x(0.01 * x) };
        (pose, Momentum { linear: Vec3::new(0.1 * x, 3.0, 1.0), angular: Vec3::new(1.0, 0.2 * x, -0.5) })
    };
    (0..BODIES).map(state).collect()
}

/// A copy differs from its body in its state, what is derived of it, and its identity.
#[test]
fn copies_are_the_body_in_other_states() {
    for kind in 0..16 {
        let body = mixed_body(kind);
        let (mut fast, mut slow) = (World::new(), World::new());
        let entities = body.spawn_copies(&mut fast, states());
        for (i, (pose, momentum)) in states().into_iter().enumerate() {
            let entity = body.spawn(&mut slow);
            *slow.get::<&mut Pose>(entity).unwrap() = pose;
            slow.get::<&mut BodyId>(entity).unwrap().0 += i as u64;
            if let Ok(mut own) = slow.get::<&mut Momentum>(entity) {
                *own = momentum;
            }
            assert_eq!(entities[i], entity);
        }
        update_derived(&mut slow);
        for entity in entities {
            assert_eq!(components(&fast, entity), components(&slow, entity), "a body of kind {kind}");
        }
    }
}

#[test]
fn copies_are_drawn_where_they_are() {
    let body = RigidBody::new(Shape::sphere(1.0))
        .without_collider()
        .mass(1.0)
        .interpolated()
        .position(Vec3::X)
        .build()
        .unwrap();
    let mut world = World::new();
    for (entity, (pose, _)) in body.spawn_copies(&mut world, states()).into_iter().zip(states()) {
        assert_eq!(world.get::<&PreviousPose>(entity).unwrap().0, pose);
        assert!(!world.satisfies::<&BodyId>(entity), "no identity comes of none");
    }
}

#[test]
fn nothing_comes_of_nothing() {
    let mut world = World::new();
    assert_eq!(spawn_bodies(&mut world, Vec::<Body>::new()), []);
    assert_eq!(mixed_body(0).spawn_copies(&mut world, []), []);
    assert_eq!(world.len(), 0);
}

/// Columns of the caller's own, and rows that are too few or too many.
#[test]
fn copies_fill_the_batch_that_there_is() {
    let brick = RigidBody::new(Shape::cuboid([0.1, 0.2, 0.3])).without_collider().mass(1.0).build().unwrap();
    let mut types = ColumnBatchType::new();
    brick.insert_types_into(&mut types);
    types.add::<u8>();

    let batch = types.clone().into_batch(10);
    brick.insert_copies_into(&batch, states().into_iter().take(9));
    let mut own = batch.writer::<u8>().unwrap();
    (0..10).for_each(|i| own.push(i).unwrap());
    drop(own);
    brick.insert_copies_into(&batch, states().into_iter().skip(9));
    let mut world = World::new();
    let entities: Vec<Entity> = world.spawn_column_batch(batch.build().unwrap()).collect();
    for (i, (entity, (pose, _))) in entities.into_iter().zip(states()).enumerate() {
        assert_eq!((*world.get::<&Pose>(entity).unwrap(), *world.get::<&u8>(entity).unwrap()), (pose, i as u8));
    }

    let short = types.into_batch(10);
    brick.insert_copies_into(&short, states().into_iter().take(9));
    assert!(short.build().is_err());

    let mut only_poses = ColumnBatchType::new();
    only_poses.add::<Pose>();
    let batch = only_poses.into_batch(10);
    brick.insert_copies_into(&batch, states());
    assert!(batch.build().is_ok());
}

/// States 5 items and gives another number of them.
struct Misstated(u32);

impl Iterator for Misstated {
    type Item = (Pose, Momentum);

    fn next(&mut self) -> Option<Self::Item> {
        self.0 = self.0.checked_sub(1)?;
        Some((Pose::default(), Momentum::default()))
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        (5, Some(5))
    }
}

impl ExactSizeIterator for Misstated {}

#[test]
fn a_length_that_is_not_true_does_no_harm() {
    let brick = RigidBody::new(Shape::cuboid([0.1, 0.2, 0.3])).without_collider().mass(1.0).build().unwrap();
    for (given, spawned) in [(4, 0), (5, 5), (9, 5)] {
        let mut world = World::new();
        assert_eq!(brick.spawn_copies(&mut world, Misstated(given)).len(), spawned);
        assert_eq!(world.len() as usize, spawned);
    }
}
