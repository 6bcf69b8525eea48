//! Promise: a thin plank that slides down a wall or over an edge gains no energy and is not thrown,
//! however far it turns or slides in a step. At no time is there more than 2.5 `g h / v` of its
//! weight by its length beyond the least so far, with the substep `h` and the speed `v` of a fall
//! by its length.
//!
//! Why: what turns about its lower edge is led to the end of a step along the chord of its way,
//! which dips into the ground by more than the plank is thick. If the second net stops it there, it
//! hangs on its edge; and if gravity that contacts have taken is taken back then, it flies up.

use hecs::{Entity, World};
use tumble::Material;
use tumble::math::{Quat, Vec3};
use tumble::prelude::*;
use tumble_tests::touching::{collider, fixed_box, pose, spawn, surfaced};
use tumble_tests::{Draw, cases, real};

const GRAVITY: f64 = 9.81;

fn spawn_plank(world: &mut World, half: [f64; 3], body: impl Fn(RigidBody) -> RigidBody, material: Material) -> Entity {
    let shape = Shape::cuboid(half);
    spawn(world, body(RigidBody::new(shape.clone()).density(25.0)), surfaced(collider(&shape), material))
}

fn settings(rate: f64, substeps: u32) -> Settings {
    Settings::default().with_dt(real(1.0 / rate)).with_contact_substeps(substeps)
}

/// Planks of 1 cm to 10 m, 5 to 150 times as long as thick, lean at 52 to 80 degrees.
#[test]
fn planks_that_slide_down_gain_no_energy() {
    let mut failures = Vec::new();
    for case in 0..u64::from(cases(300)) {
        let mut draw = Draw::new(0x9A4C, case);
        let size = draw.log_between(0.01, 10.0);
        let (rate, substeps) = (draw.log_between(30.0, 240.0), if draw.often(0.5) { 4 } else { 16 });
        let (has_wall, thin) = (draw.often(0.5), 0.5 * size * draw.log_between(1.0 / 150.0, 0.2));
        let friction = if draw.often(0.5) { 0.0 } else { draw.between(0.0, 0.6) };
        let material = Material::new(real(friction), 0.0);
        let mut world = World::new();
        fixed_box(&mut world, [3.0 * size, size, 3.0 * size], (Vec3::NEG_Y * real(size), Quat::IDENTITY), material);
        if has_wall {
            let middle = Vec3::new(real(-size), real(3.0 * size), 0.0);
            fixed_box(&mut world, [size, 3.0 * size, 3.0 * size], (middle, Quat::IDENTITY), material);
        }
        let (angle, half) = (draw.between(0.9, 1.4), 0.5 * size);
        let place = |along: f64, across: f64| real(half * along + thin * across);
        let at = Vec3::new(place(angle.cos(), angle.sin()), place(angle.sin(), angle.cos()), 0.0);
        let leans = |body: RigidBody| body.position(at).orientation(Quat::from_rotation_z(real(-angle)));
        let plank = spawn_plank(&mut world, [half, thin, 0.2 * size], leans, material);
        let mut simulation = Simulation::new(settings(rate, substeps)).unwrap();
        let begin = simulation.totals(&world).energy();
        let weight = 25.0 * 8.0 * half * thin * 0.2 * size * GRAVITY;
        let (mut least, mut rise) = (begin, 0.0_f64);
        while simulation.time() < 3.0 * size.sqrt() {
            simulation.step(&mut world);
            let energy = simulation.totals(&world).energy();
            least = least.min(energy);
            rise = rise.max(energy - least);
        }
        let most = 2.5 * (GRAVITY / size).sqrt() / (rate * f64::from(substeps)) * weight * size;
        let height = f64::from(pose(&world, plank).position.y);
        println!("case {case}: {:.3} of the most, {} high in the end", rise / most, height / size);
        if rise > most {
            failures.push((case, rise / most));
        }
    }
    assert!(failures.is_empty(), "{failures:?}");
}

/// A plank that lies and slides goes over the edge of what it lies on without rising, in steps in
/// which it goes up to half of its length, and 1.5 to 8 times as thick as it falls in a substep.
#[test]
fn planks_slide_over_an_edge_without_rising() {
    for case in 0..u64::from(cases(200)) {
        let mut draw = Draw::new(0x9A4D, case);
        let (size, substeps) = (draw.log_between(0.01, 10.0), if draw.often(0.5) { 4 } else { 16 });
        let thin = 0.5 * size * draw.log_between(1.0 / 150.0, 0.02);
        let h = (2.0 * thin / (draw.between(1.5, 8.0) * GRAVITY)).sqrt();
        let dt = h * f64::from(substeps);
        let material = Material::new(0.0, 0.0);
        let mut world = World::new();
        fixed_box(&mut world, [3.0 * size, size, 3.0 * size], (Vec3::NEG_Y * real(size), Quat::IDENTITY), material);
        let speed = size * draw.between(0.05, 0.5) / dt;
        let turned = Quat::from_rotation_y(real(draw.between(-0.7, 0.7)));
        let at = Vec3::new(real(1.5 * size), real(thin), 0.0);
        let lies = |body: RigidBody| body.position(at).linear_velocity(Vec3::X * real(speed)).orientation(turned);
        let plank = spawn_plank(&mut world, [0.5 * size, thin, 0.2 * size], lies, material);
        let mut simulation = Simulation::new(settings(1.0 / dt, substeps)).unwrap();
        let mut highest = 0.0_f64;
        while pose(&world, plank).position.x < real(3.0 * size) {
            simulation.step(&mut world);
            highest = highest.max(f64::from(pose(&world, plank).position.y));
        }
        println!("case {case}: {} half thicknesses high", highest / thin);
        assert!(highest < 1.1 * thin, "case {case}: {} half thicknesses high", highest / thin);
    }
}
