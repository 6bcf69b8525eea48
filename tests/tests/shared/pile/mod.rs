//! A box without a lid into which everything falls that can touch: balls, boxes, capsules,
//! cylinders and dumbbells, some that bounce, roll badly, are damped or off their centre, on ground
//! with a name, between walls without, with a paddle that turns among them.

#![allow(dead_code, reason = "each test uses a part of it")]

use hecs::{Entity, World};
use tumble::math::{Quat, Real, Vec3};
use tumble::prelude::*;
use tumble::{Amount, Collider, InertiaTensor, Material, Part, Rng};
use tumble_tests::{dquat, quat};

/// Of the random numbers of the plain pile.
pub(crate) const SEED: u64 = 7;

/// Moving bodies, and the paddle.
pub(crate) const BODIES: u64 = 61;

/// The identities of all that have one, in order: those of bodies and that of the ground.
pub(crate) fn identities() -> Vec<u64> {
    (0..=BODIES).collect()
}

/// Scenery without identity: four walls, in this order the first entities of the world.
pub(crate) fn walls(world: &mut World) {
    for (i, x) in [(0, 2.2), (1, -2.2), (2, 2.2), (3, -2.2)] {
        let (at, half) = if i < 2 { (Vec3::X, [0.2, 3.0, 3.0]) } else { (Vec3::Z, [3.0, 3.0, 0.2]) };
        let shape = Shape::cuboid(half);
        let collider = Collider::new(&shape).unwrap();
        RigidBody::new(shape).fixed().position(at * x).build().unwrap().spawn_with(world, (collider,));
    }
}

/// The body of an identity: the ground, the paddle, or one of those that fall.
pub(crate) fn spawn(world: &mut World, id: u64) -> Entity {
    match id {
        0 => {
            let surface = Material { restitution: 0.3, ..Material::default() };
            let collider = Collider::half_space().with_material(surface).unwrap();
            let ground = RigidBody::new(Shape::Point).fixed().id(BodyId(id));
            ground.build().unwrap().spawn_with(world, (collider,))
        }
        1 => {
            let shape = Shape::cuboid([1.2, 0.1, 0.1]);
            let collider = Collider::new(&shape).unwrap();
            let paddle = RigidBody::new(shape).kinematic().position(Vec3::Y * 0.4).angular_velocity(Vec3::Y * 2.0);
            paddle.id(BodyId(id)).build().unwrap().spawn_with(world, (collider,))
        }
        _ => spawn_falling(world, Rng::stream(SEED, id), id),
    }
}

/// A rotation that every machine rounds alike.
fn unit(x: Real, y: Real, z: Real) -> Quat {
    quat(dquat(Quat::from_xyzw(x, y, z, 1.0)))
}

/// What falls, of the kind of its identity.
fn spawn_falling(world: &mut World, mut rng: Rng, id: u64) -> Entity {
    let mut length = || f64::from(rng.range(0.15, 0.25));
    let shape = match id % 8 {
        0 | 2 => Shape::sphere(length()),
        4 => Shape::capsule(length(), length()),
        6 => {
            let ball = |x: f64| Part::new(Shape::sphere(0.15), Amount::Density(800.0)).at([x, 0.0, 0.0]);
            Shape::compound([ball(-length()), ball(length())])
        }
        7 => Shape::cylinder(length(), length()),
        _ => Shape::cuboid([length(), length(), length()]),
    };
    let (layer, place) = ((id - 2) / 9, (id - 2) % 9);
    let [x, y, z] = [place % 3, layer, place / 3].map(|i| i as u8).map(Real::from);
    let at = Vec3::new(1.1 * (x - 1.0), 1.0 + 0.6 * y, 1.1 * (z - 1.0)) + rng.vector(-0.1, 0.1);
    let when = |every: u64| id.is_multiple_of(every);
    let surface = Material {
        restitution: if when(3) { 0.6 } else { 0.0 },
        rolling_resistance: if when(4) { 0.01 } else { 0.0 },
        ..Material::new(rng.range(0.1, 0.9), 0.0)
    };
    let collider = Collider::new(&shape).unwrap().with_material(surface).unwrap();
    let turned = unit(rng.range(-0.5, 0.5), rng.range(-0.5, 0.5), 0.0);
    let mut body = RigidBody::new(shape).id(BodyId(id)).position(at).orientation(turned);
    body = body.linear_velocity(rng.vector(-1.0, 1.0)).angular_velocity(rng.vector(-5.0, 5.0));
    if when(5) {
        // Neither centre nor axes are those of the shape.
        let axes = dquat(unit(0.2, -0.1, 0.3));
        let tensor = InertiaTensor::from_principal([0.4, 0.5, 0.6], axes).unwrap();
        body = body.mass(30.0).center_of_mass([0.02, -0.03, 0.01]).inertia(tensor);
    } else {
        body = body.mass(rng.range(10.0, 60.0));
    }
    if when(7) {
        body = body.damping(Damping { linear: 0.1, angular: 0.3 });
    }
    if when(11) {
        body = body.gravity_scale(0.5).interpolated();
    }
    let body = body.build().unwrap().spawn_with(world, (collider,));
    if when(13) {
        world.insert_one(body, Drag { linear: Vec3::splat(0.5), angular: Vec3::splat(0.01) }).unwrap();
    }
    body
}

/// The pile, its bodies spawned in the order of these identities.
pub(crate) fn scene(ids: &[u64]) -> World {
    let mut world = World::new();
    walls(&mut world);
    for id in ids {
        spawn(&mut world, *id);
    }
    world
}

pub(crate) fn plain_scene() -> World {
    scene(&identities())
}

/// The pile of these random numbers, without its paddle and damped: it comes to rest.
pub(crate) fn settling_scene(seed: u64) -> World {
    let mut world = World::new();
    walls(&mut world);
    spawn(&mut world, 0);
    for id in 2..=BODIES {
        let body = spawn_falling(&mut world, Rng::stream(seed, id), id);
        world.insert_one(body, Damping { linear: 0.5, angular: 1.0 }).unwrap();
    }
    world
}

/// The identities in another order.
pub(crate) fn shuffled(seed: u64) -> Vec<u64> {
    let mut ids = identities();
    let mut rng = Rng::stream(seed, 0);
    for i in (1..ids.len()).rev() {
        ids.swap(i, (rng.next_u64() % (i as u64 + 1)) as usize);
    }
    ids
}

pub(crate) fn settings() -> Settings {
    Settings::default().with_dt(1.0 / 64.0).with_restitution_threshold(0.5)
}
