//! Benchmark scenes without contacts: tumbling boxes, and bodies of every kind.

use hecs::World;
use tumble::math::{Real, Vec3};
use tumble::{Amount, Body, BodyId, Damping, Part, RigidBody, Rng, Shape, spawn_bodies};

/// Number of bodies after which the kinds repeat; the last two are kinematic and fixed.
const KINDS: u64 = 16;
const KINEMATIC: u64 = 14;
const FIXED: u64 = 15;

/// `count` boxes of all proportions, tumbling at up to 9 rad/s: bodies of one kind, with nothing
/// but what a body needs.
pub fn tumbling_boxes(count: usize) -> World {
    let mut rng = Rng::new(0xb0);
    let mut world = World::new();
    spawn_bodies(&mut world, (0..count).map(|_| tumbling_box(&mut rng)));
    world
}

/// The next of [`tumbling_boxes`].
pub fn tumbling_box(rng: &mut Rng) -> Body {
    let shape = Shape::cuboid(rng.vector(0.1, 1.0));
    place(RigidBody::new(shape).without_collider().density(1000.0), rng)
}

/// `count` bodies of every kind there is: all shapes, with their own principal axes and centres of
/// mass or without, damped or not, heavier or lighter in gravity, points, kinematic ones and fixed
/// ones. Their [`BodyId`]s count from zero.
pub fn mixed_bodies(count: usize) -> World {
    let mut world = World::new();
    for id in 0..count as u64 {
        mixed_body(id).spawn(&mut world);
    }
    world
}

/// Those of [`mixed_bodies`] that forces move.
pub fn mixed_moving_bodies(count: usize) -> World {
    let mut world = World::new();
    for id in (0..count as u64).filter(|id| id % KINDS < KINEMATIC) {
        mixed_body(id).spawn(&mut world);
    }
    world
}

/// The body with this [`BodyId`] of [`mixed_bodies`].
pub fn mixed_body(id: u64) -> Body {
    let mut rng = Rng::new(id.wrapping_mul(0x5851_f42d_4c95_7f2d));
    let kind = id % KINDS;
    let mut body = RigidBody::new(mixed_shape(kind, &mut rng)).without_collider().id(BodyId(id));
    body = match kind {
        KINEMATIC => return place(body.kinematic(), &mut rng),
        FIXED => return built(somewhere(body.fixed(), &mut rng)),
        9 => body,
        10 => body.mass(rng.range(0.1, 5.0)),
        _ => body.density(rng.range(100.0, 8000.0)),
    };
    if kind % 3 == 1 {
        body = body.damping(Damping { linear: rng.range(0.0, 0.5), angular: rng.range(0.0, 0.5) });
    }
    if kind % 4 == 2 {
        body = body.gravity_scale(rng.range(-1.0, 1.5));
    }
    if kind == 10 {
        // A point cannot spin.
        return built(body.position(rng.vector(-50.0, 50.0)));
    }
    place(body, &mut rng)
}

fn mixed_shape(kind: u64, rng: &mut Rng) -> Shape {
    let mut length = || rng.range(0.05, 0.5);
    match kind {
        0 => Shape::sphere(length()),
        1 => Shape::cylinder(length(), length()),
        2 => Shape::capsule(length(), length()),
        3 => Shape::cone(length(), length()),
        4 => Shape::ellipsoid([length(), length(), length()].map(f64::from)),
        9 => {
            // A weight on a sphere: neither the centre of mass nor the principal axes are those of
            // the frame.
            let (radius, weight) = (length(), f64::from(length()) * 0.1);
            let sphere = Part::new(Shape::sphere(radius), Amount::Density(700.0));
            let at = rng.vector(-1.0, 1.0) * radius;
            let ball = Part::new(Shape::cuboid([weight, 2.0 * weight, 3.0 * weight]), Amount::Density(7800.0)).at(at);
            Shape::compound([sphere, ball])
        }
        10 => Shape::Point,
        _ => Shape::cuboid([length(), length(), length()].map(f64::from)),
    }
}

/// Within 50 m, turned.
fn somewhere(body: RigidBody, rng: &mut Rng) -> RigidBody {
    body.position(rng.vector(-50.0, 50.0)).orientation(rng.orientation())
}

/// Somewhere, and moving.
fn place(body: RigidBody, rng: &mut Rng) -> Body {
    let spin: Real = 5.0;
    built(
        somewhere(body, rng)
            .linear_velocity(rng.vector(-3.0, 3.0))
            .angular_velocity(Vec3::from(rng.vector(-spin, spin))),
    )
}

#[allow(clippy::expect_used, reason = "the bodies made above are possible")]
fn built(body: RigidBody) -> Body {
    body.build().expect("a possible body")
}
