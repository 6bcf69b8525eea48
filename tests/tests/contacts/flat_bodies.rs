//! Promise: coins and boards from a millimetre on, let go or dropped on ground of any kind, never
//! get through it, and lie on it as deep as their weight makes them.
//!
//! Why: in one step at 60 Hz a body falls by `g dt^2` = 2.7 mm, which is more than such a thing is
//! thick, and it begins the step with a velocity that does not tell. It fails if gravity's fall is
//! left out of how far contacts look ahead, or of what is taken for a path through the ground.

use hecs::{Entity, World};
use tumble::math::{Quat, Vec3};
use tumble::prelude::*;
use tumble_tests::touching::{pose, prism, spawn, velocity};
use tumble_tests::{Draw, dvec3, real};

const GRAVITY: f64 = 9.81;

/// Level ground at the origin; of surfaces with cells of a random size.
fn spawn_ground(world: &mut World, kind: &str, draw: &mut Draw) {
    let cell = draw.log_between(0.05, 10.0);
    let count = 9;
    let middle = 0.5 * cell * (count - 1) as f64;
    let (collider, y) = match kind {
        "plane" => (Collider::half_space(), 0.0),
        "box" => (Collider::new(&Shape::cuboid([10.0, 1.0, 10.0])).unwrap(), -1.0),
        "hull" => {
            // The frustum of a pyramid, upside down.
            let corner = |i: u32| {
                let [x, y, z] = [0, 1, 2].map(|axis| if i & (1 << axis) == 0 { -1.0 } else { 1.0 });
                glam::DVec3::new((9.0 + y) * x, y, (9.0 + y) * z)
            };
            (Collider::convex_hull((0..8).map(corner)).unwrap(), -1.0)
        }
        "heights" => (Collider::height_field(vec![0.0; count * count], count, [cell, cell]).unwrap(), 0.0),
        _ => {
            let place = |i: usize| {
                glam::DVec3::new(cell * (i % count) as f64 - middle, 0.0, cell * (i / count) as f64 - middle)
            };
            let corners = (0..count * count).map(place);
            let cells = (0..count * count).filter(|i| i % count + 1 < count && i / count + 1 < count);
            let triangles = cells.flat_map(|i| {
                let [a, b, c, d] = [i, i + 1, i + count, i + count + 1].map(|i| i as u32);
                [[a, c, d], [a, d, b]]
            });
            (Collider::mesh(corners, &triangles.collect::<Vec<_>>()).unwrap(), 0.0)
        }
    };
    spawn(world, RigidBody::new(Shape::Point).fixed().position(Vec3::Y * real(y)), collider);
}

/// A prism with five to twelve sides, or a board of two halves, with a shape of about its mass.
fn prism_or_halves(draw: &mut Draw, [radius, half]: [f64; 2]) -> (Shape, Collider) {
    if draw.often(0.5) {
        let sides = draw.between(5.0, 12.99) as u32;
        return (Shape::cylinder(radius, half), prism(sides, radius, half));
    }
    let part = Collider::new(&Shape::cuboid([0.5 * radius, half, radius])).unwrap();
    let halves = [-0.5, 0.5].map(|side| {
        let position = Vec3::X * real(side * radius);
        part.clone().with_offset(Pose { position, orientation: Quat::IDENTITY }).unwrap()
    });
    (Shape::cuboid([radius, half, radius]), Collider::compound(halves).unwrap())
}

/// A coin or a board over the ground, on a hull a prism or a board of two halves too, with half its
/// thickness and half its length \[m\].
fn spawn_flat(world: &mut World, ground: &str, draw: &mut Draw) -> (Entity, [f64; 2]) {
    let thin = draw.log_between(1e-3, 0.01);
    let long = thin * draw.log_between(3.0, 30.0);
    let shape = if draw.often(0.5) {
        Shape::cylinder(0.5 * long, 0.5 * thin)
    } else {
        Shape::cuboid([0.5 * long, 0.5 * thin, 0.5 * draw.between(2.0 * thin, long)])
    };
    let (shape, collider) = if ground == "hull" && draw.often(0.6) {
        prism_or_halves(draw, [0.5 * long, 0.5 * thin])
    } else {
        let collider = Collider::new(&shape).unwrap();
        (shape, collider)
    };
    let gap = if draw.often(0.3) { 0.0 } else { draw.log_between(1e-5, 0.1) };
    let axis = draw.direction() * glam::DVec3::new(1.0, 0.0, 1.0);
    let tilt = if draw.often(0.5) { 0.0 } else { draw.between(0.0, 0.3) };
    let tilted = Quat::from_axis_angle(Vec3::new(real(axis.x), 0.0, real(axis.z)).normalize(), real(tilt));
    // The corners of a board may be further out than half its length.
    let height = 0.5 * thin + gap + 0.75 * long * tilt.sin();
    let turned = tilted * Quat::from_rotation_y(real(draw.between(0.0, 6.0)));
    let body = RigidBody::new(shape).density(draw.log_between(100.0, 10_000.0)).position(Vec3::Y * real(height));
    (spawn(world, body.orientation(turned), collider), [0.5 * thin, 0.5 * long])
}

fn check(ground: &str) {
    let stiffness = (std::f64::consts::TAU * 60.0).powi(2);
    let mut failed = Vec::new();
    for case in 0..150 {
        let mut draw = Draw::new(2411, case);
        let mut world = World::new();
        spawn_ground(&mut world, ground, &mut draw);
        let (flat, [half, long]) = spawn_flat(&mut world, ground, &mut draw);
        let rate = draw.log_between(60.0, 240.0);
        let mut simulation = Simulation::new(Settings::default().with_dt(real(1.0 / rate))).unwrap();
        // Half-spaces push out what is in them; there a blow turns the far end in by what it goes
        // in a substep, where other ground has an underside that must not be reached.
        let height = f64::from(pose(&world, flat).position.y);
        let a_substep = (2.0 * GRAVITY * height).sqrt() * f64::from(simulation.settings().contact_substep());
        let deepest = if ground == "plane" { a_substep } else { 0.0 };
        let mut least = f64::INFINITY;
        for _ in 0..(3.0 * rate) as u32 {
            simulation.step(&mut world);
            least = least.min(f64::from(pose(&world, flat).position.y));
        }
        let depth = half - f64::from(pose(&world, flat).position.y);
        let moving = velocity(&world, flat);
        let speed = dvec3(moving.linear).length() + dvec3(moving.angular).length() * long;
        // A board on contacts of 60 Hz is `g/w^2` deep, and twice that where edges carry it.
        if least < -deepest || depth > 2.0 * GRAVITY / stiffness || depth < -2e-4 || speed > 2e-3 {
            failed.push(format!(
                "{case}: half {half:.5} long {long:.4} least {least:.5} depth {depth:.6} {speed:.6} m/s"
            ));
        }
    }
    assert!(failed.is_empty(), "{ground}: {} of 150:\n{}", failed.len(), failed.join("\n"));
}

#[test]
fn flat_bodies_lie_on_a_half_space() {
    check("plane");
}

#[test]
fn flat_bodies_lie_on_a_box() {
    check("box");
}

#[test]
fn flat_bodies_lie_on_a_hull() {
    check("hull");
}

#[test]
fn flat_bodies_lie_on_a_mesh() {
    check("mesh");
}

#[test]
fn flat_bodies_lie_on_a_height_field() {
    check("heights");
}
