//! Promise: cones and frusta of 2 cm to 2 m that roll on their sides, on the ground or on a box,
//! keep their energy for 20 s and go around the point where their sides meet, which stays.
//!
//! Why: they touch along a line that turns. Contacts that stop the velocity of its ends at the end
//! of a substep, not over it, give a cone of 5 cm three times its energy within half a minute.
//! Friction that stops twisting and sliding at once, each as if it were alone, has them twist.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::{DQuat, DVec3};
use hecs::{Entity, World};
use tumble::prelude::*;
use tumble_tests::touching::{collider, frustum_center, ground_or_cube, pose, spawn, surfaced};
use tumble_tests::{Draw, Rise, cases, dquat, dvec3, quat, real, run, settings_at_random, vec3};

const G: f64 = 9.81;

/// The apex, or where the sides of a frustum would meet, at a distance from the centre of mass.
fn apex(world: &World, body: Entity, along_axis: f64) -> DVec3 {
    let pose = pose(world, body);
    dvec3(pose.position) + dquat(pose.orientation) * (DVec3::Y * along_axis)
}

#[test]
fn what_rolls_on_its_side_gains_no_energy() {
    for case in 0..cases(60) {
        let mut draw = Draw::new(905, case.into());
        let radius = draw.log_between(0.01, 1.0);
        let half = radius * draw.log_between(0.8, 4.0);
        let top = if draw.often(0.5) { 0.0 } else { draw.between(0.2, 0.8) };
        let shape = if top == 0.0 { Shape::cone(radius, half) } else { Shape::frustum(radius, top * radius, half) };
        let surface = Material::default().with_friction(real(draw.between(0.5, 1.0)));
        let mut world = World::new();
        ground_or_cube(&mut draw, &mut world, 100.0 * radius, surface);

        // On its side, the base towards the turned x axis; it turns about the line of contact.
        let slope = ((1.0 - top) * radius / (2.0 * half)).atan();
        let heading = DQuat::from_rotation_y(draw.between(0.0, TAU));
        let lying = heading * DQuat::from_rotation_z(FRAC_PI_2 + slope);
        let speed = draw.between(0.1, 0.4) * (G * radius).sqrt();
        let height = radius * slope.cos() - half * slope.sin();
        let body = RigidBody::new(shape.clone())
            .mass(draw.log_between(0.01, 1e3))
            .position(vec3(DVec3::Y * height))
            .orientation(quat(lying))
            .angular_velocity(vec3(heading * DVec3::X * (speed / radius)));
        let body = spawn(&mut world, body, surfaced(collider(&shape), surface));
        let settings = settings_at_random(&mut draw, [4.0, 16.0]);
        let mut simulation = Simulation::new(settings).unwrap();
        let second = (1.0 / f64::from(settings.dt)) as u32;
        run(&mut simulation, &mut world, second);

        let far = 2.0 * half * (1.0 / (1.0 - top) - frustum_center(top));
        let start = (simulation.totals(&world), apex(&world, body, far));
        let (mut rise, mut away) = (Rise::from(start.0.energy()), 0.0_f64);
        for _ in 0..20 * second {
            simulation.step(&mut world);
            rise.note(simulation.totals(&world).energy());
            away = away.max((apex(&world, body, far) - start.1).length());
        }
        let (gain, kinetic) = (rise.most(), start.0.kinetic());
        let kept = simulation.totals(&world).kinetic() / kinetic;
        let of = format!("case {case}, {shape:?}, {settings:?}");
        assert!(gain < 0.02 * kinetic && kept > 0.98, "{of}: gains {} of its energy, keeps {kept}", gain / kinetic);
        assert!(away < 0.01 * far, "{of}: the apex goes {away} m away");
    }
}
