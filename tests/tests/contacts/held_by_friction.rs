//! Promise: what friction holds stays where it is: boxes, cans, cones, frusta and prisms of 2 cm to
//! 2 m on slopes of up to nine tenths of the steepest, also on a box that they overhang; and boxes,
//! cans and prisms on platforms that turn, at up to seven tenths of the rate that throws them off.
//! What stands upright on level ground, or overhangs a box, comes to rest.
//!
//! Why: points of a flat face that are others from step to step lose their impulses, and what rests
//! trembles down the slope. Friction that stops what slides at the end of a substep instead of over
//! it lets what turns with a platform creep inwards by `w^2 h/2` of its radius a second. Points
//! that are solved one after the other around a tall body drive it to whirl. Twisting and sliding
//! that are stopped both at once swing up where the middle of a face is beside the centre of mass.

use std::f64::consts::TAU;

use glam::{DQuat, DVec3};
use hecs::{Entity, World};
use tumble::prelude::*;
use tumble_tests::touching::{
    collider, cube_below, frustum_center, ground_or_cube, pose, prism, spawn, surfaced, velocity,
};
use tumble_tests::{Draw, cases, dvec3, quat, real, settings_at_random, vec3};

const G: f64 = 9.81;

/// What stands on a face.
struct Standing {
    shape: Shape,
    collider: Collider,
    /// Of its origin and of its centre of mass over the face \[m\].
    origin: f64,
    height: f64,
}

impl Standing {
    /// One of five kinds, with this radius \[m\].
    fn new(draw: &mut Draw, radius: f64) -> Self {
        let half = radius * draw.between(0.3, 0.7);
        Self::high(draw, radius, half)
    }

    /// The same of this half of its height \[m\].
    fn high(draw: &mut Draw, radius: f64, half: f64) -> Self {
        let of = |shape: Shape, height: f64| Self { collider: collider(&shape), shape, origin: half, height };
        match draw.between(0.0, 5.0) as u32 {
            0 => of(Shape::cuboid([radius, half, radius * draw.between(0.5, 1.0)]), half),
            1 => of(Shape::cylinder(radius, half), half),
            2 => of(Shape::cone(radius, half), 0.5 * half),
            3 => {
                let top = draw.between(0.3, 0.9);
                of(Shape::frustum(radius, top * radius, half), 2.0 * half * frustum_center(top))
            }
            _ => {
                let sides = draw.between(3.0, 12.99) as u32;
                Self { collider: prism(sides, radius, half), ..of(Shape::cylinder(radius, half), half) }
            }
        }
    }
}

/// The highest speed of a body within a second, ten seconds from now [m/s].
fn fastest_after_a_while(world: &mut World, body: Entity, settings: Settings) -> f64 {
    let mut simulation = Simulation::new(settings).unwrap();
    let steps = |seconds: f64| (seconds / f64::from(settings.dt)) as u32;
    simulation.step_many(world, steps(10.0));
    let speeds = (0..steps(1.0)).map(|_| {
        simulation.step(world);
        dvec3(velocity(world, body).linear).length()
    });
    speeds.fold(0.0, f64::max)
}

/// What stands upright and is up to 4.5 times as high as wide comes to rest.
#[test]
fn what_stands_comes_to_rest() {
    for case in 0..cases(80) {
        let mut draw = Draw::new(904, case.into());
        let radius = draw.log_between(0.01, 1.0);
        let half = radius * draw.between(1.0, 4.5);
        let Standing { shape, collider: touched, origin, .. } = Standing::high(&mut draw, radius, half);
        let mut world = World::new();
        let on_plane = ground_or_cube(&mut draw, &mut world, 10.0 * radius, Material::default());
        let turn = DQuat::from_rotation_y(draw.between(0.0, TAU));
        let body = RigidBody::new(shape.clone()).position(vec3(DVec3::Y * origin)).orientation(quat(turn));
        let body = spawn(&mut world, body.mass(draw.log_between(0.01, 1e3)), touched);

        let fastest = fastest_after_a_while(&mut world, body, settings_at_random(&mut draw, [4.0, 16.0]));
        let slow = 1e-3 * (G * half.max(radius)).sqrt();
        assert!(fastest < slow, "case {case}, {shape:?}, on a plane {on_plane}: {fastest} m/s");
    }
}

/// What overhangs the side of a box by a fifth to nine tenths of half its width comes to rest.
#[test]
fn what_overhangs_comes_to_rest() {
    for case in 0..cases(80) {
        let mut draw = Draw::new(906, case.into());
        let radius = draw.log_between(0.02, 2.0);
        let half = radius * draw.between(0.3, 2.0);
        let angle = draw.between(0.0, TAU);
        // How far its outline reaches over the middle where it overhangs, in radii.
        let (shape, touched, width) = match draw.between(0.0, 3.0) as u32 {
            0 => {
                let depth = draw.between(0.3, 1.0);
                let shape = Shape::cuboid([radius, half, radius * depth]);
                (shape.clone(), collider(&shape), angle.cos().abs() + depth * angle.sin().abs())
            }
            1 => (Shape::cylinder(radius, half), collider(&Shape::cylinder(radius, half)), 1.0),
            _ => {
                let sides = draw.between(5.0, 12.99) as u32;
                let corners = (0..sides).map(|k| (angle + f64::from(k) * TAU / f64::from(sides)).cos());
                (Shape::cylinder(radius, half), prism(sides, radius, half), corners.fold(0.0, f64::max))
            }
        };
        let mut world = World::new();
        let surface = Material::default().with_friction(0.6);
        cube_below(&mut world, 5.0 * radius, surface);
        // From the edge to the centre of mass.
        let inside = radius * width * draw.between(0.1, 0.8);
        let body = RigidBody::new(shape)
            .mass(draw.log_between(0.01, 1e3))
            .position(vec3(DVec3::new(5.0 * radius - inside, half, 0.0)))
            .orientation(quat(DQuat::from_rotation_y(angle)));
        let body = spawn(&mut world, body, surfaced(touched, surface));
        let fastest = fastest_after_a_while(&mut world, body, settings_at_random(&mut draw, [4.0, 16.0]));
        let slow = 1e-4 * (G * radius).sqrt();
        assert!(fastest < slow, "case {case}, {radius} m, {inside} m on the box: {fastest} m/s");
        let fallen = half - f64::from(pose(&world, body).position.y);
        assert!(fallen < 0.05 * half, "case {case}: fallen by {fallen} m");
    }
}

#[test]
fn what_friction_holds_on_a_slope_stays() {
    for case in 0..cases(120) {
        let mut draw = Draw::new(901, case.into());
        let radius = draw.log_between(0.02, 2.0);
        let Standing { shape, collider: touched, origin, height } = Standing::new(&mut draw, radius);
        let friction = draw.between(0.2, 0.8);
        let surface = Material::default().with_friction(real(friction));
        let steep = (friction * draw.between(0.3, 0.9)).atan();
        let down = DQuat::from_rotation_y(draw.between(0.0, TAU)) * DVec3::X;
        let gravity = (down * steep.sin() - DVec3::Y * steep.cos()) * G;

        let mut world = World::new();
        let overhangs = draw.often(0.4);
        // A cone or a triangle on a box with its own width would tip over that one's edge.
        let wide = if overhangs { 1.0 } else { draw.between(3.0, 20.0) };
        let thick = radius * draw.between(0.5, 3.0);
        let below = Shape::cuboid([wide * radius, thick, wide * radius]);
        let under = RigidBody::new(below.clone()).fixed().position(vec3(DVec3::Y * -thick));
        spawn(&mut world, under, surfaced(collider(&below), surface));
        let body = RigidBody::new(shape)
            .mass(draw.log_between(0.01, 1e3))
            .position(vec3(DVec3::Y * origin))
            .orientation(quat(DQuat::from_rotation_y(draw.between(0.0, TAU))));
        let body = spawn(&mut world, body, surfaced(touched, surface));

        let settings = settings_at_random(&mut draw, [4.0, 16.0]).with_gravity(vec3(gravity));
        let mut simulation = Simulation::new(settings).unwrap();
        let steps = |seconds: f64| (seconds / f64::from(settings.dt)) as u32;
        simulation.step_many(&mut world, steps(2.0));
        let before = dvec3(pose(&world, body).position);
        simulation.step_many(&mut world, steps(10.0));
        let moved = dvec3(pose(&world, body).position).distance(before);
        assert!(moved < 1e-4 * radius, "case {case}: {moved} m of {radius} m");
        // It is pressed in by what its weight presses, and stands.
        assert!((before.y - height).abs() < 0.05 * radius, "case {case}: {} m of {height} m", before.y);
    }
}

#[test]
fn what_friction_holds_on_a_turning_platform_turns_with_it() {
    for case in 0..cases(60) {
        let mut draw = Draw::new(902, case.into());
        let radius = draw.log_between(0.1, 2.0);
        let Standing { shape, collider: touched, origin, .. } = Standing::new(&mut draw, radius);
        let friction = draw.between(0.2, 0.8);
        let surface = Material::default().with_friction(real(friction));
        let out = radius * draw.between(1.0, 5.0);
        let rate = (draw.between(0.05, 0.5) * friction * G / out).sqrt();

        let mut world = World::new();
        let platform = Shape::cylinder(out + 2.0 * radius, radius);
        let turning = RigidBody::new(platform.clone()).kinematic().position(vec3(DVec3::Y * -radius));
        let turning = turning.angular_velocity(vec3(DVec3::Y * rate));
        spawn(&mut world, turning, surfaced(collider(&platform), surface));
        let at = DQuat::from_rotation_y(draw.between(0.0, TAU)) * (DVec3::X * out);
        let spin = DVec3::Y * rate;
        let body = RigidBody::new(shape)
            .mass(draw.log_between(0.1, 1e3))
            .position(vec3(at + DVec3::Y * origin))
            .orientation(quat(DQuat::from_rotation_y(draw.between(0.0, TAU))))
            .linear_velocity(vec3(spin.cross(at)))
            .angular_velocity(vec3(spin));
        let body = spawn(&mut world, body, surfaced(touched, surface));

        let mut simulation = Simulation::new(settings_at_random(&mut draw, [4.0, 16.0])).unwrap();
        let dt = f64::from(simulation.settings().dt);
        simulation.step_many(&mut world, (1.0 / dt) as u32);
        let radial = |world: &World| {
            let at = dvec3(pose(world, body).position);
            (at.x.hypot(at.z), at.x.atan2(at.z))
        };
        let (before, angle) = radial(&world);
        let steps = (10.0 / dt) as u32;
        simulation.step_many(&mut world, steps);
        let (after, angle_after) = radial(&world);
        let crept = (after / before - 1.0).abs();
        assert!(crept < 1e-4, "case {case}: {crept} of {before} m at {rate} rad/s");
        let turned = (angle_after - angle - rate * dt * f64::from(steps)).rem_euclid(TAU);
        let behind = turned.min(TAU - turned);
        assert!(behind < 1e-3, "case {case}: {behind} rad behind at {rate} rad/s");
    }
}
