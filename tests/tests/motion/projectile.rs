//! Promise: a dropped and a thrown body follow the parabola `x + v t + g t^2/2`. `RungeKutta4` and
//! `MoserVeselov` are on it to rounding; `SemiImplicitEuler` is off by exactly `g dt t/2`, since it
//! moves with the velocity at the end of each step. Rotation does not disturb the flight.
//!
//! Why: the first thing anyone simulates. It fails if gravity acts twice, on momentum without the
//! mass, or a half kick is missing.

use glam::DVec3;
use hecs::World;
use tumble::math::{Real, Vec3};
use tumble::{Integrator, Pose, RigidBody, Settings, Shape, Simulation, Velocity};
use tumble_tests::references::real_vec3;
use tumble_tests::{DOUBLE, EPSILON, FreeBody, dvec3, run, seconds, simulation};

/// Steps a second: a power of two, so times are exact. In single precision few enough for the known
/// offset of the first-order scheme to stand above the rounding of every step.
const RATE: u32 = if DOUBLE { 1024 } else { 64 };
const DT: Real = 1.0 / RATE as Real;

/// Rounding of the position and the momentum in every step, if all of it goes one way. The position
/// is rounded by `EPSILON/2` of its size, twice, and so are momentum and velocity, which move it
/// for the rest of the time.
fn rounding(steps: u32, farthest: f64, fastest: f64) -> f64 {
    let steps = f64::from(steps);
    EPSILON * steps * (farthest + fastest * steps * seconds(DT))
}

/// Flies a body and compares it with the closed form at the end.
fn fly(integrator: Integrator, body: RigidBody, start: (DVec3, DVec3), gravity: DVec3, steps: u32) -> DVec3 {
    let mut world = World::new();
    let entity = body.build().unwrap().spawn(&mut world);
    let gravity_real = real_vec3(gravity);
    let mut simulation = simulation(integrator, gravity_real, DT);
    run(&mut simulation, &mut world, steps);
    let time = f64::from(steps) * seconds(DT);
    assert_eq!(simulation.time(), time);
    let (pose, velocity) = (world.get::<&Pose>(entity).unwrap(), world.get::<&Velocity>(entity).unwrap());
    let (position, linear) = start;
    let gravity = dvec3(gravity_real);

    let fastest = linear.length() + gravity.length() * time;
    let speed_error = (dvec3(velocity.linear) - (linear + gravity * time)).length();
    // The momentum is rounded once a step.
    assert!(speed_error <= EPSILON * f64::from(steps) * fastest, "{integrator}: {speed_error:e} m/s");
    dvec3(pose.position) - (position + linear * time + gravity * (time * time / 2.0))
}

fn assert_offset(integrator: Integrator, error: DVec3, gravity: DVec3, steps: u32, allowed: f64) {
    let time = f64::from(steps) * seconds(DT);
    let known = match integrator {
        Integrator::SemiImplicitEuler => gravity * (seconds(DT) * time / 2.0),
        _ => DVec3::ZERO,
    };
    println!(
        "{integrator}: off by {error} m, of which {known} is known; the rest {:.1e}, allowed {allowed:.1e}",
        (error - known).length()
    );
    assert!((error - known).length() <= allowed, "{integrator}: off by {error} m, not by {known} m");
}

#[test]
fn a_dropped_body_falls_half_g_t_squared() {
    let gravity = DVec3::new(0.0, -9.81, 0.0);
    for integrator in Integrator::ALL {
        let body = RigidBody::new(Shape::sphere(0.5)).without_collider().density(1000.0);
        let error = fly(integrator, body, (DVec3::ZERO, DVec3::ZERO), gravity, 2 * RATE);
        assert_offset(integrator, error, gravity, 2 * RATE, rounding(2 * RATE, 20.0, 20.0));
    }
}

/// Drake's cylinder and Gazebo's box, both thrown while they tumble, for 10 s.
#[test]
fn thrown_bodies_are_on_their_parabola() {
    for body in [FreeBody::drake_cylinder(), FreeBody::gazebo_boxes()] {
        let thrown = body.translation.unwrap();
        for integrator in Integrator::ALL {
            let start = (thrown.position, thrown.linear_velocity);
            let error = fly(integrator, body.rigid_body(), start, thrown.gravity, 10 * RATE);
            let allowed = rounding(10 * RATE, 500.0, 110.0);
            assert_offset(integrator, error, thrown.gravity, 10 * RATE, allowed);
        }
    }
}

/// The Gazebo benchmark publishes 0.049 m for engines with this scheme, at a step of 1 ms after 10
/// s: `9.8 * 10 * 0.001/2`.
#[cfg(feature = "f64")]
#[test]
fn the_offset_is_the_one_the_benchmark_publishes() {
    let body = FreeBody::gazebo_boxes();
    let settings = Settings::default().with_gravity(Vec3::Z * -9.8).with_dt(1e-3);
    let mut simulation = Simulation::new(settings.with_integrator(Integrator::SemiImplicitEuler)).unwrap();
    let mut world = World::new();
    let entity = body.spawn(&mut world);
    for _ in 0..10_000 {
        simulation.step(&mut world);
    }
    let exact = 8.0 * 10.0 - 9.8 * 10.0 * 10.0 / 2.0;
    let error = world.get::<&Pose>(entity).unwrap().position.z - exact;
    // Ten thousand roundings of 400 m.
    assert!((error + 0.049).abs() <= EPSILON * 1e4 * 400.0, "{error}");
}

/// The fall does not depend on the mass, the spin, or how many substeps a step has, up to rounding.
#[test]
fn mass_spin_and_substeps_do_not_change_the_fall() {
    for substeps in [1, 4] {
        let mut world = World::new();
        for (mass, spin) in [(1e-3, 0.0), (1.0, 3.0), (1e6, 30.0)] {
            let body = RigidBody::new(Shape::cuboid([0.1, 0.2, 0.3]))
                .without_collider()
                .mass(mass)
                .angular_velocity(Vec3::splat(spin));
            body.build().unwrap().spawn(&mut world);
        }
        let mut simulation = Simulation::new(Settings::default().with_dt(DT).with_substeps(substeps)).unwrap();
        for _ in 0..RATE {
            simulation.step(&mut world);
        }
        for pose in world.query_mut::<&Pose>() {
            let expected = -0.5 * f64::from(Settings::default().gravity.y).abs();
            assert!((f64::from(pose.position.y) - expected).abs() <= rounding(RATE * substeps, 5.0, 10.0));
        }
    }
}
