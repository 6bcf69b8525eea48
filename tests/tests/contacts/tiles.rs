//! Promise: where bodies are read for their contacts in tiles, they move as where they are read one
//! by one. They do as well with a sensor far away.
//!
//! Why: boxes and balls about their centres of mass are placed in tiles, and a body of another
//! shape sends its whole tile the other way; constrained bodies are read in tiles unless laws act
//! on them; so does what is out of range. Where there is a sensor, pairs are looked for further
//! away, and what is found there must be no contact.

use hecs::{Entity, World};
use tumble::prelude::*;
use tumble::{BodyState, ForceLaw, GravityScale, Material, Shape, Wrench};
use tumble_tests::touching::{collider, ground, spawn};
use tumble_tests::{Draw, cases, quat, real, vec3};

const STREAM: u64 = 0x71_1e5;

/// A law without a force.
struct Nothing;

impl ForceLaw for Nothing {
    fn wrench(&self, _: &BodyState<'_>) -> Wrench {
        Wrench::default()
    }
}

/// What is far away from the bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Beside {
    Nothing,
    /// A capsule for each falls there: neighbours in their archetype.
    Capsules,
    /// It stays, or falls.
    Sensor,
}

/// A heap of bodies of a size \[m\], most of them boxes and balls, of which some are out of range.
fn heap(draw: &mut Draw, beside: Beside) -> (World, Vec<Entity>) {
    let mut world = World::new();
    ground(&mut world, Material::new(0.5, 0.3), tumble::math::Quat::IDENTITY);
    let (size, count) = (draw.log_between(0.01, 100.0), draw.between(1.0, 60.0) as u64);
    let (others, far, heavy) = (draw.often(0.5), draw.often(0.3), draw.often(0.3));
    let scaled = draw.often(0.3);
    let bodies = (0..count).map(|id| {
        let half = [(); 3].map(|()| size * draw.log_between(0.02, 0.5));
        let shape = match draw.between(0.0, if others { 5.0 } else { 3.0 }) as u32 {
            0 | 1 => Shape::cuboid(half),
            2 => Shape::sphere(half[0]),
            3 => Shape::capsule(half[0], half[1]),
            _ => Shape::cone(half[0], half[1]),
        };
        let away = if far && draw.often(0.1) { 3e9 } else { 0.0 };
        let at = draw.vector(2.0 * size) + glam::DVec3::new(away, 2.5 * size, 0.0);
        let kilograms = if heavy && draw.often(0.1) { 1e25 } else { draw.log_between(1e-3, 1e3) };
        let speed = if draw.often(0.5) { size * draw.log_between(1.0, 300.0) } else { size };
        let body = RigidBody::new(shape.clone()).mass(kilograms).position(vec3(at)).id(BodyId(1 + id));
        let body = body.orientation(quat(draw.orientation())).linear_velocity(vec3(draw.vector(speed)));
        let entity = spawn(&mut world, body.angular_velocity(vec3(draw.vector(20.0))), collider(&shape));
        if scaled {
            world.insert_one(entity, GravityScale(real(draw.between(-0.5, 2.0)))).unwrap();
        }
        if beside == Beside::Capsules {
            let (shape, place) = (Shape::capsule(1.0, 1.0), glam::DVec3::new(1e6 + 1e4 * id as f64, 1e5, 0.0));
            let body = RigidBody::new(shape.clone()).mass(1.0).position(vec3(place)).id(BodyId(1000 + id));
            let capsule = spawn(&mut world, body, collider(&shape));
            if scaled {
                world.insert_one(capsule, GravityScale(1.0)).unwrap();
            }
        }
        entity
    });
    let bodies = bodies.collect();
    if beside == Beside::Sensor {
        let body = RigidBody::new(Shape::sphere(1.0)).position(vec3(glam::DVec3::new(1e6, 1e5, 0.0)));
        let body = if draw.often(0.5) { body.fixed() } else { body.mass(1.0).id(BodyId(2000)) };
        spawn(&mut world, body, collider(&Shape::sphere(1.0)).sensor());
    }
    (world, bodies)
}

/// The bits of all bodies after each step, beside others or under a law, and how many contacts.
fn moved(case: u64, beside: Beside, law: bool) -> (Vec<String>, usize) {
    let draw = &mut Draw::new(STREAM, case);
    let rate = draw.between(10.0, 240.0);
    let (mut world, bodies) = heap(draw, beside);
    let mut simulation = Simulation::new(Settings::default().with_dt(real(1.0 / rate))).unwrap();
    if law {
        simulation.add_global_law(Nothing);
    }
    let mut contacts = 0;
    let after = (0..40).map(|_| {
        simulation.step(&mut world);
        contacts += simulation.contacts().count();
        let state = |body: &Entity| (*world.get::<&Pose>(*body).unwrap(), *world.get::<&Momentum>(*body).unwrap());
        format!("{:?}", bodies.iter().map(state).collect::<Vec<_>>())
    });
    (after.collect(), contacts)
}

#[test]
fn tiles_have_the_bits_of_single_bodies() {
    let mut touched = 0;
    for case in 0..u64::from(cases(100)) {
        let (in_tiles, contacts) = moved(case, Beside::Nothing, false);
        touched += contacts;
        for (beside, law) in [(Beside::Capsules, false), (Beside::Sensor, false), (Beside::Nothing, true)] {
            let (one_by_one, _) = moved(case, beside, law);
            let differs = in_tiles.iter().zip(&one_by_one).position(|(a, b)| a != b);
            assert_eq!(differs, None, "case {case}, {beside:?}, law {law}");
        }
    }
    assert!(touched > 1000, "{touched} contacts");
}
