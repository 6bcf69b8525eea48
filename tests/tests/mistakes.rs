//! Promise: with the feature `tracing` a debug build warns, once per kind and with the entity, of a
//! `Velocity` that is written and not read, a body without a collider, a mesh on a mesh and a
//! half-space that moves; and of nothing else.
//!
//! Why: none of these is an error, and what comes of them looks like one of the engine. It fails if
//! a warning is lost, comes twice, or comes where nothing is wrong.

use std::fmt;
use std::sync::{Arc, Mutex};

use hecs::World;
use tracing::field::{Field, Visit};
use tracing::span::{Attributes, Id, Record};
use tracing::{Event, Level, Metadata, Subscriber};
use tumble::prelude::*;

/// The texts of warnings.
#[derive(Clone, Default)]
struct Warnings(Arc<Mutex<Vec<String>>>);

impl Subscriber for Warnings {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        *metadata.level() == Level::WARN
    }

    fn event(&self, event: &Event<'_>) {
        event.record(&mut Text(&self.0));
    }

    fn new_span(&self, _: &Attributes<'_>) -> Id {
        Id::from_u64(1)
    }

    fn record(&self, _: &Id, _: &Record<'_>) {}
    fn record_follows_from(&self, _: &Id, _: &Id) {}
    fn enter(&self, _: &Id) {}
    fn exit(&self, _: &Id) {}
}

struct Text<'a>(&'a Mutex<Vec<String>>);

impl Visit for Text<'_> {
    fn record_debug(&mut self, _: &Field, value: &dyn fmt::Debug) {
        self.0.lock().unwrap().push(format!("{value:?}"));
    }
}

/// The warnings of five steps, before each of which the world is changed.
fn warnings(world: &mut World, mut change: impl FnMut(&mut World)) -> Vec<String> {
    let told = Warnings::default();
    tracing::subscriber::with_default(told.clone(), || {
        let mut simulation = Simulation::new(Settings::default()).unwrap();
        for _ in 0..5 {
            change(world);
            simulation.step(world);
        }
    });
    let texts = told.0.lock().unwrap();
    texts.clone()
}

fn ball(world: &mut World, x: Real) -> hecs::Entity {
    let ball = RigidBody::new(Shape::sphere(0.5)).mass(1.0).position(Vec3::new(x, 1.0, 0.0));
    ball.build().unwrap().spawn(world)
}

#[test]
fn nothing_wrong_is_nothing_to_warn_of() {
    let mut world = World::new();
    spawn_ground(&mut world);
    let (first, second) = (ball(&mut world, 0.0), ball(&mut world, 3.0));
    let slider = RigidBody::new(Shape::sphere(0.5)).kinematic().position(Vec3::Y * 9.0).build().unwrap();
    let slider = slider.spawn(&mut world);
    let told = warnings(&mut world, |world| {
        set_linear_velocity(world, first, Vec3::X).unwrap();
        set_angular_velocity(world, first, Vec3::Y).unwrap();
        world.get::<&mut Momentum>(second).unwrap().apply_impulse(Vec3::X);
        world.get::<&mut Velocity>(slider).unwrap().linear = Vec3::Z;
    });
    assert_eq!(told, Vec::<String>::new());
}

#[test]
fn a_velocity_that_nothing_reads_is_warned_of() {
    let mut world = World::new();
    let entity = ball(&mut world, 0.0);
    let told = warnings(&mut world, |world| world.get::<&mut Velocity>(entity).unwrap().linear = Vec3::X * 5.0);
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].starts_with(&format!("entity {entity:?}: its Velocity was written")), "{told:?}");
}

#[test]
fn what_everything_passes_through_is_warned_of() {
    let mut world = World::new();
    spawn_ground(&mut world);
    let ghost = RigidBody::new(Shape::sphere(0.5)).mass(1.0).without_collider().build().unwrap().spawn(&mut world);
    let told = warnings(&mut world, |_| ());
    assert_eq!(told, [format!("entity {ghost:?} has no Collider: everything passes through it")]);
}

#[test]
fn colliders_that_do_not_meet_are_warned_of() {
    let triangle = || Collider::mesh([Vec3::ZERO, Vec3::Z, Vec3::X], &[[0, 1, 2]]).unwrap();
    let mut world = World::new();
    let ground = world.spawn((Pose::default(), triangle()));
    let body = RigidBody::new(Shape::sphere(0.5)).mass(1.0);
    let sail = body.clone().collider(triangle()).build().unwrap().spawn(&mut world);
    let told = warnings(&mut world, |_| ());
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].starts_with(&format!("entities {sail:?} and {ground:?} are meshes")), "{told:?}");

    let mut world = World::new();
    let sky = body.collider(Collider::half_space()).build().unwrap().spawn(&mut world);
    let told = warnings(&mut world, |_| ());
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(told[0].starts_with(&format!("entity {sky:?} has Momentum and a half-space")), "{told:?}");
}
