//! Promise: what falls between two fixed faces gains no energy, however short the substeps: at no
//! time is there more than 2 % of the weight by the size beyond the least so far, and what the way
//! of a fall in a substep is of the size, twelve times.
//!
//! Why: faces that meet at a sharp angle push a body out of both, and each takes up what the other
//! gives. Passes over the two do not end, and what they leave of the speed of a push is several
//! times as much along the middle: a coin that came into a groove at 4.2 m/s left it at 8.8 m/s,
//! with 64 substeps.

use hecs::World;
use tumble::Material;
use tumble::math::{Quat, Vec3};
use tumble::prelude::*;
use tumble_tests::touching::{collider, fixed_box, spawn, surfaced};
use tumble_tests::{Draw, cases, quat, real};

const GRAVITY: f64 = 9.81;

/// Of about the same size.
fn shapes(size: f64) -> [Shape; 7] {
    [
        Shape::cylinder(size, 0.2 * size),
        Shape::cylinder(0.2 * size, size),
        Shape::cone(size, 0.4 * size),
        Shape::frustum(size, 0.5 * size, 0.2 * size),
        Shape::cuboid([size, 0.2 * size, size]),
        Shape::ellipsoid([size, 0.2 * size, size]),
        Shape::capsule(0.2 * size, size),
    ]
}

/// Bodies of 2 cm to 5 m fall into grooves of 23 to 100 degrees, with and without friction and
/// restitution, alone in their worlds.
#[test]
fn what_is_wedged_gains_no_energy() {
    let mut failures = Vec::new();
    for case in 0..u64::from(cases(120)) {
        let mut draw = Draw::new(0x3ED6, case);
        let size = draw.log_between(0.02, 5.0);
        let substeps = 4_u32 << (2 * (case % 3));
        let friction = if draw.often(0.6) { 0.0 } else { draw.between(0.0, 0.6) };
        let restitution = if draw.often(0.7) { 0.0 } else { draw.between(0.1, 0.9) };
        let material = Material::new(real(friction), real(restitution));
        let half_angle = draw.between(0.2, 0.9);
        let mut world = World::new();
        for side in [-1.0, 1.0] {
            let turned = Quat::from_rotation_z(real(side * (0.5 * std::f64::consts::PI - half_angle)));
            let middle = turned * Vec3::new(real(5.0 * side * size), real(-size), 0.0);
            fixed_box(&mut world, [5.0 * size, size, 5.0 * size], (middle, turned), material);
        }
        let shape = shapes(size)[(case / 3 % 7) as usize].clone();
        let height = 1.5 * size / half_angle.sin() + 0.6 * size;
        let turned = quat(draw.orientation());
        let body = RigidBody::new(shape.clone()).density(500.0).position(Vec3::Y * real(height)).orientation(turned);
        let entity = spawn(&mut world, body, surfaced(collider(&shape), material));
        let mass = world.get::<&Mass>(entity).unwrap().kilograms();
        let settings = Settings::default().with_contact_substeps(substeps);
        let mut simulation = Simulation::new(settings).unwrap();
        let scale = f64::from(mass) * GRAVITY * size;
        let (mut least, mut rise) = (f64::INFINITY, 0.0_f64);
        while simulation.time() < 12.0 * (size / GRAVITY).sqrt() {
            simulation.step(&mut world);
            let energy = simulation.totals(&world).energy() / scale;
            rise = rise.max(energy - least);
            least = least.min(energy);
        }
        let fall = (2.0 * GRAVITY * size).sqrt() * f64::from(settings.contact_substep());
        let most = 0.02 + 12.0 * fall / size;
        let is_bounded = rise <= most;
        if !is_bounded {
            failures.push(format!(
                "case {case}: {shape:?} of {size:.3} m in {half_angle:.2} rad, {substeps} substeps, \
                 friction {friction:.2}, restitution {restitution:.2}: {rise:.3} for {most:.3}"
            ));
        }
    }
    assert!(failures.is_empty(), "{}:\n{}", failures.len(), failures.join("\n"));
}
