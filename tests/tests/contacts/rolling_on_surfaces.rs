//! Promise: what rolls over a flat mesh or height field rolls as on a plane: capsules and cans of
//! 5 cm to 2 m keep speed and direction, whatever the triangles are and however they lie to its
//! way.
//!
//! Why: an edge of a body that crosses the seams of triangles has a point at each. Taken for a face
//! that lies on three points its contact does not roll: a capsule along a seam went four times as
//! fast after twenty seconds.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::{DQuat, DVec3};
use hecs::World;
use tumble::Collider;
use tumble::prelude::*;
use tumble_tests::touching::{collider, spawn, surfaced, velocity};
use tumble_tests::{Draw, cases, dvec3, quat, real, run, settings_at_random, vec3};

/// Vertices along each side of the ground.
const SIDE: usize = 25;

/// Level ground of cells of this size \[m\]: a height field, or a mesh with its vertices moved
/// about and either diagonal of each cell.
fn level_ground(draw: &mut Draw, cell: f64) -> Collider {
    if draw.often(0.3) {
        return Collider::height_field(vec![0.0; SIDE * SIDE], SIDE, [cell; 2]).unwrap();
    }
    let middle = 0.5 * (SIDE - 1) as f64;
    let vertices: Vec<DVec3> = (0..SIDE * SIDE)
        .map(|i| {
            let [x, z] = [i % SIDE, i / SIDE].map(|place| place as f64 - middle + draw.between(-0.3, 0.3));
            DVec3::new(x, 0.0, z) * cell
        })
        .collect();
    let cells = (0..SIDE * SIDE).filter(|i| i % SIDE + 1 < SIDE && i / SIDE + 1 < SIDE);
    let triangles: Vec<[u32; 3]> = cells
        .flat_map(|i| {
            let [a, b, c, d] = [i, i + 1, i + SIDE, i + SIDE + 1].map(|i| i as u32);
            if draw.often(0.5) { [[a, c, d], [a, d, b]] } else { [[a, c, b], [b, c, d]] }
        })
        .collect();
    Collider::mesh(vertices, &triangles).unwrap()
}

#[test]
fn what_rolls_over_seams_keeps_its_speed() {
    for case in 0..cases(80) {
        let mut draw = Draw::new(903, case.into());
        let radius = draw.log_between(0.05, 2.0);
        let half = radius * draw.between(0.3, 3.0);
        let shape = if draw.often(0.5) { Shape::capsule(radius, half) } else { Shape::cylinder(radius, half) };
        let cell = radius * draw.log_between(0.3, 20.0);
        let surface = Material::default().with_friction(real(draw.between(0.3, 1.0)));
        let mut world = World::new();
        let under = RigidBody::new(Shape::Point).fixed();
        spawn(&mut world, under, surfaced(level_ground(&mut draw, cell), surface));

        let turn = DQuat::from_rotation_y(draw.between(0.0, TAU));
        // From the middle on, a third of the way to the side at most.
        let speed = draw.log_between(0.05, 1.0) * (9.81 * radius).sqrt();
        let seconds = f64::min(10.0, 4.0 * cell / speed);
        let way = turn * DVec3::Z * speed;
        let body = RigidBody::new(shape.clone())
            .mass(draw.log_between(0.1, 1e3))
            .position(vec3(DVec3::Y * radius))
            .orientation(quat(turn * DQuat::from_rotation_z(FRAC_PI_2)))
            .linear_velocity(vec3(way))
            .angular_velocity(vec3(turn * DVec3::X * (speed / radius)));
        let body = spawn(&mut world, body, surfaced(collider(&shape), surface));
        let settings = settings_at_random(&mut draw, [2.0, 16.0]);
        let mut simulation = Simulation::new(settings).unwrap();
        run(&mut simulation, &mut world, (seconds / f64::from(settings.dt)) as u32);

        let now = dvec3(velocity(&world, body).linear);
        let wrong = (now - way).length() / speed;
        assert!(wrong < 0.01, "case {case}, {shape:?}, cells of {cell} m: {now} for {way}");
    }
}
