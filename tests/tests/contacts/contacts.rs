//! Promise: bodies that touch do what mechanics says: they rest, slide, stop, roll and bounce as
//! closed forms have it, and no contact makes energy or momentum.
//!
//! Why: a solver that only looks right lets boxes creep, balls gain height and stacks jitter. Each
//! test has its closed form beside it.

use hecs::{Entity, World};
use tumble::math::{Quat, Real, Vec3};
use tumble::prelude::*;
use tumble::{BodyOrder, Collider, Material, Totals};
use tumble_tests::touching::{collider, cube, ground, pose, spawn, surfaced, velocity};
use tumble_tests::{EPSILON, dvec3};

const G: f64 = 9.81;

fn settings(dt: Real) -> Settings {
    Settings::default().with_dt(dt)
}

fn body(world: &mut World, body: RigidBody, shape: &Shape, material: Material) -> Entity {
    spawn(world, body, surfaced(collider(shape), material))
}

fn run(world: &mut World, settings: Settings, steps: u32) {
    let mut simulation = Simulation::new(settings).unwrap();
    (0..steps).for_each(|_| simulation.step(world));
}

/// At rest the spring of a contact carries the weight. With the mass scale `m = a2/(1 + a2)`, the
/// impulse scale `i = 1/(1 + a2)` and the rate `w/a1`, nothing changes when `m (w/a1) s / K = i l`,
/// where `l = M g h` is the impulse of a substep and `1/K = M`: `s = -g/w^2`.
#[test]
fn a_resting_box_sinks_in_by_the_closed_form() {
    let mut world = World::new();
    ground(&mut world, Material::default(), Quat::IDENTITY);
    let shape = cube(0.5);
    let lying =
        body(&mut world, RigidBody::new(shape.clone()).mass(3.0).position(Vec3::Y * 0.5), &shape, Material::default());
    run(&mut world, settings(1.0 / 60.0), 600);
    let depth = 0.5 - f64::from(pose(&world, lying).position.y);
    let omega = std::f64::consts::TAU * 60.0;
    // Positions of half a metre are known to 6e-8 m in single precision.
    assert!((depth - G / omega.powi(2)).abs() < 2e-6, "{depth} for {}", G / omega.powi(2));
    assert!(dvec3(velocity(&world, lying).linear).length() < 1e-5);
}

/// Friction takes `mu g` from the speed until nothing is left: `v^2/(2 mu g)`.
#[test]
fn a_sliding_box_stops_where_it_should() {
    let mut world = World::new();
    let surface = Material::new(0.5, 0.0);
    ground(&mut world, surface, Quat::IDENTITY);
    let shape = cube(0.25);
    let start = RigidBody::new(shape.clone()).mass(1.0).position(Vec3::Y * 0.25).linear_velocity(Vec3::X * 5.0);
    let sliding = body(&mut world, start, &shape, surface);
    run(&mut world, settings(1e-3), 1500);
    let distance = f64::from(pose(&world, sliding).position.x);
    let expected = 25.0 / (2.0 * 0.5 * G);
    assert!((distance / expected - 1.0).abs() < 5e-3, "{distance} for {expected}");
    assert!(dvec3(velocity(&world, sliding).linear).length() < 1e-4);
}

/// Down a slope of 20 degrees in one second: `g (sin - mu cos)/2`, and nowhere from `mu = tan` on.
#[test]
fn an_inclined_box_slides_or_holds() {
    let slope = 20.0_f64.to_radians();
    for mu in [0.0, 0.1, 0.2, 0.3, 0.35, 0.37, 0.4, 0.6] {
        let mut world = World::new();
        let tilt = Quat::from_rotation_z(-slope as Real);
        let rough = Material::new(1.0, 0.0);
        let slide = ground(&mut world, rough, tilt);
        let shape = cube(0.25);
        let start = RigidBody::new(shape.clone()).mass(1.0).orientation(tilt).position(tilt * (Vec3::Y * 0.25));
        let sliding = body(&mut world, start, &shape, rough);
        let mut simulation = Simulation::new(settings(1e-3)).unwrap();
        // It is held until it lies as deep as its weight presses it in, and then let go.
        let along = |world: &World| f64::from((tilt.conjugate() * pose(world, sliding).position).x);
        simulation.step_many(&mut world, 500);
        let from = along(&world);
        for entity in [slide, sliding] {
            let mut collider = world.get::<&mut Collider>(entity).unwrap();
            *collider = collider.clone().with_material(Material::new(mu as Real, 0.0)).unwrap();
        }
        simulation.step_many(&mut world, 1000);
        let distance = along(&world) - from;
        let expected = (0.5 * G * (slope.sin() - mu * slope.cos())).max(0.0);
        let speed = dvec3(velocity(&world, sliding).linear).length();
        if expected > 0.0 {
            assert!((distance / expected - 1.0).abs() < 1e-2, "{mu}: {distance} for {expected}");
        } else {
            assert!(speed < 1e-4 && distance < 1e-3, "{mu}: {distance} at {speed}");
        }
    }
}

/// A ball that slides begins to roll at `5/7` of its speed, at the time `2 v/(7 mu g)`.
#[test]
fn a_sliding_ball_comes_to_roll() {
    let mut world = World::new();
    let surface = Material::new(0.3, 0.0);
    ground(&mut world, surface, Quat::IDENTITY);
    let shape = Shape::sphere(0.1);
    let start = RigidBody::new(shape.clone()).mass(1.0).position(Vec3::Y * 0.1).linear_velocity(Vec3::X * 2.0);
    let ball = body(&mut world, start, &shape, surface);
    run(&mut world, settings(1e-3), 194);
    let at_roll = f64::from(pose(&world, ball).position.x);
    assert!((at_roll / 0.33285485448 - 1.0).abs() < 5e-3, "{at_roll}");
    run(&mut world, settings(1e-3), 200);
    let Velocity { linear, angular } = velocity(&world, ball);
    assert!((f64::from(linear.x) / 1.42857142857 - 1.0).abs() < 5e-3, "{linear}");
    assert!((f64::from(angular.z) / -14.2857142857 - 1.0).abs() < 5e-3, "{angular}");
}

/// The heights of a bouncing ball fall by the square of the restitution, and it stands at them at
/// times that follow.
#[test]
fn a_ball_bounces_as_high_as_it_should() {
    let mut world = World::new();
    let surface = Material::new(0.5, 0.8);
    ground(&mut world, surface, Quat::IDENTITY);
    let shape = Shape::sphere(0.1);
    let ball = body(&mut world, RigidBody::new(shape.clone()).mass(1.0).position(Vec3::Y * 1.1), &shape, surface);
    let settings = settings(1e-3).with_restitution_threshold(0.1);
    let mut simulation = Simulation::new(settings).unwrap();
    let (mut apexes, mut impacts) = (Vec::new(), Vec::new());
    let (mut before, mut height) = (0.0, 1.0);
    while apexes.len() < 6 && simulation.steps() < 10_000 {
        simulation.step(&mut world);
        let speed = velocity(&world, ball).linear.y;
        if before < 0.0 && speed > 0.0 {
            impacts.push(simulation.time());
        }
        if before > 0.0 && speed <= 0.0 {
            apexes.push(height);
        }
        (before, height) = (speed, f64::from(pose(&world, ball).position.y) - 0.1);
    }
    let expected = [0.64, 0.4096, 0.262144, 0.16777216, 0.1073741824];
    for (apex, expected) in apexes.iter().zip(expected) {
        assert!((apex / expected - 1.0).abs() < 1e-2, "{apexes:?}");
    }
    let expected = [0.451523640986, 1.17396146656, 1.75191172702, 2.21427193539, 2.58416010209];
    for (impact, expected) in impacts.iter().zip(expected) {
        assert!((impact / expected - 1.0).abs() < 1e-2, "{impacts:?}");
    }
}

/// In a head-on collision momentum is kept and the speed of parting is the restitution times that
/// of meeting.
#[test]
fn balls_collide_head_on() {
    for (m1, m2, v1, v2, e, out) in [
        (1.0, 1.0, 5.0, 0.0, 1.0, [0.0, 5.0]),
        (1.0, 1.0, 5.0, 0.0, 0.0, [2.5, 2.5]),
        (1.0, 1.0, 5.0, 0.0, 0.5, [1.25, 3.75]),
        (100.0, 1.0, 5.0, 0.0, 0.0, [4.950_495_049_5, 4.950_495_049_5]),
        (100.0, 1.0, 5.0, 0.0, 1.0, [4.900_990_099_01, 9.900_990_099_01]),
        (2.0, 3.0, 4.0, -1.0, 0.7, [-1.1, 2.4]),
        (3.0, 1.0, 2.0, -2.0, 1.0, [0.0, 4.0]),
    ] {
        let mut world = World::new();
        let surface = Material::new(0.0, e);
        let shape = Shape::sphere(0.5);
        let ball = |mass: f64, x: Real, v: Real| {
            RigidBody::new(shape.clone()).mass(mass).position(Vec3::X * x).linear_velocity(Vec3::X * v)
        };
        let first = body(&mut world, ball(m1, -1.0, v1), &shape, surface);
        let second = body(&mut world, ball(m2, 1.0, v2), &shape, surface);
        run(&mut world, settings(1e-3).with_gravity(Vec3::ZERO), 1000);
        for (entity, expected) in [first, second].into_iter().zip(out) {
            let v = f64::from(velocity(&world, entity).linear.x);
            assert!((v - expected).abs() < 1e-2, "{m1} {m2} {e}: {v} for {expected}");
        }
    }
}

/// A cluster of bodies in free fall together keeps its momentum and its angular momentum whatever
/// they do to each other.
#[test]
fn a_cluster_keeps_its_momenta() {
    let mut world = World::new();
    let shapes = [cube(0.3), Shape::sphere(0.4), Shape::cuboid([0.5, 0.2, 0.3])];
    let surface = Material::new(0.6, 0.3);
    for i in 0..27_u32 {
        let shape = &shapes[i as usize % 3];
        let at = Vec3::new((i % 3) as Real, (i / 3 % 3) as Real, (i / 9) as Real) - Vec3::ONE;
        let body_i = RigidBody::new(shape.clone())
            .density(500.0)
            .position(at * 1.4)
            .linear_velocity(at * -1.5 + Vec3::new(at.y, -at.x, 0.0))
            .angular_velocity(Vec3::new(at.z, 3.0 * at.x, -at.y));
        body(&mut world, body_i, shape, surface);
    }
    let settings = settings(1.0 / 60.0).with_gravity(Vec3::ZERO);
    let totals = |world: &World| Totals::of(world, &settings, &BodyOrder::of(world));
    let start = totals(&world);
    let mut before = start.energy();
    let mut simulation = Simulation::new(settings).unwrap();
    for _ in 0..120 {
        simulation.step(&mut world);
        // Bodies go on turning while contacts hold them as they were when the step began: a little
        // work is done on them by that.
        let now = totals(&world).energy();
        assert!(now < before * (1.0 + 1e-4), "{before} J became {now} J");
        before = now;
    }
    let end = totals(&world);
    assert!(before < 0.7 * start.energy(), "they did collide: {before} of {} J", start.energy());
    // Some thousand impulses, each rounded against momenta of about a thousand kg m/s.
    let size = (2.0 * start.energy() * 27.0 * 60.0).sqrt();
    assert!((end.linear_momentum - start.linear_momentum).length() < 100.0 * EPSILON * size);
    assert!(
        (end.angular_momentum - start.angular_momentum).length() < 400.0 * EPSILON * size,
        "{}",
        (end.angular_momentum - start.angular_momentum).length() / size / EPSILON
    );
}

/// A pyramid of boxes stands.
#[test]
fn a_pyramid_stands() {
    let mut world = World::new();
    ground(&mut world, Material::default(), Quat::IDENTITY);
    let shape = cube(0.5);
    let mut top = None;
    for row in 0..8 {
        for i in 0..8 - row {
            let x = (i as Real) * 1.1 - (8 - row) as Real * 0.55;
            let at = Vec3::new(x, 0.5 + row as Real, 0.0);
            top = Some((
                body(&mut world, RigidBody::new(shape.clone()).density(1.0).position(at), &shape, Material::default()),
                at,
            ));
        }
    }
    let (top, at) = top.unwrap();
    run(&mut world, settings(1.0 / 60.0), 600);
    let moved = dvec3(pose(&world, top).position) - dvec3(at);
    assert!(moved.length() < 0.015, "{moved}");
    assert!(dvec3(velocity(&world, top).linear).length() < 1e-3);
}

/// Single precision has its limits, of which impulses are squared: these are the masses up to which
/// friction is what it should be.
#[test]
fn moons_and_grains_slide_as_far_as_boxes() {
    for mass in [1e-15, 1e-6, 1.0, 1e6, 1e18] {
        let mut world = World::new();
        let surface = Material::new(0.5, 0.0);
        ground(&mut world, surface, Quat::IDENTITY);
        let sliding = RigidBody::new(cube(0.5)).mass(mass).position(Vec3::Y * 0.5).linear_velocity(Vec3::X * 2.0);
        let sliding = body(&mut world, sliding, &cube(0.5), surface);
        run(&mut world, settings(1.0 / 60.0), 120);
        let way = f64::from(pose(&world, sliding).position.x);
        let expected = 4.0 / (2.0 * 0.5 * G);
        assert!((way - expected).abs() < 0.05 * expected, "{mass} kg: {way} for {expected}");
    }
}

/// What has no velocity that is a number touches nothing, so it spoils nothing else.
#[test]
fn one_body_gone_wrong_does_not_spoil_a_pile() {
    let mut world = World::new();
    let surface = Material::new(0.5, 0.0);
    ground(&mut world, surface, Quat::IDENTITY);
    let boxes = [0.5, 1.5, 2.5].map(|y| {
        let upright = RigidBody::new(cube(0.5)).mass(1.0).position(Vec3::Y * y);
        body(&mut world, upright, &cube(0.5), surface)
    });
    run(&mut world, settings(1.0 / 60.0), 30);
    world.get::<&mut Momentum>(boxes[2]).unwrap().linear.x = Real::NAN;
    run(&mut world, settings(1.0 / 60.0), 30);
    for entity in &boxes[..2] {
        let (pose, velocity) = (pose(&world, *entity), velocity(&world, *entity));
        assert!(pose.position.is_finite() && velocity.linear.length() < 0.05, "{pose:?} {velocity:?}");
    }
}
