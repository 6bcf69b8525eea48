//! Promise: `Damping` makes momentum decay as `e^(-c t)`, exactly, at any rate, step and
//! integrator; under a constant force a body tends to its terminal velocity, and no rate, however
//! stiff, makes anything grow or change sign.
//!
//! Why: the usual `v *= 1 - c dt` depends on the step and blows up at `c dt > 2`. It fails if the
//! decay is taken to first order, applied twice, or if force and decay are split in a way that
//! shifts the balance.

use hecs::{Entity, World};
use tumble::math::{Real, Vec3};
use tumble::{Damping, Integrator, Momentum, Pose, RigidBody, Shape, Velocity};
use tumble_tests::{EPSILON, dquat, dvec3, seconds, simulation};

fn brick(damping: Damping) -> RigidBody {
    RigidBody::new(Shape::cuboid([0.1, 0.2, 0.3])).without_collider().mass(2.0).damping(damping)
}

fn spawn(world: &mut World, body: RigidBody) -> Entity {
    body.build().unwrap().spawn(world)
}

/// `e^(-c dt)` as the engine is to multiply with it, from the step and rate in the precision of the
/// build.
fn kept(rate: Real, dt: Real) -> f64 {
    (-seconds(rate) * seconds(dt)).exp()
}

/// From the momentum before each step to the one after: the factor is right to a few units in the
/// last place, at 12 orders of magnitude of `c dt`. `MoserVeselov` multiplies twice, with factors
/// that are off by two units each, and `c dt` itself is rounded, which is `c dt EPSILON` of the
/// factor. Below `e^-80` there is nothing left to compare.
#[test]
fn decay_is_exact_at_any_rate_and_step() {
    for integrator in Integrator::ALL {
        for dt in [1e-4, 1.0 / 60.0, 1.0] {
            for rate in [1e-6, 1e-3, 0.1, 1.0, 10.0, 60.0, 1e3, 1e6] {
                let mut world = World::new();
                let body = brick(Damping { linear: rate, angular: 0.5 * rate });
                let body = body.linear_velocity(Vec3::new(1.0, -2.0, 3.0)).angular_velocity(Vec3::new(3.0, 2.0, 1.0));
                let entity = spawn(&mut world, body);
                let mut simulation = simulation(integrator, Vec3::ZERO, dt);
                for _ in 0..3 {
                    let before = *world.get::<&Momentum>(entity).unwrap();
                    simulation.step(&mut world);
                    let after = *world.get::<&Momentum>(entity).unwrap();
                    let check = |before: Vec3, after: Vec3, rate: Real| {
                        let exponent = seconds(rate) * seconds(dt);
                        let expected = dvec3(before) * kept(rate, dt);
                        let error = (dvec3(after) - expected).length();
                        let allowed = EPSILON * (8.0 + exponent) * expected.length() + (-75.0_f64).exp();
                        assert!(error <= allowed, "{integrator}, c dt {exponent}: {after} not {expected}");
                    };
                    check(before.linear, after.linear, rate);
                    check(before.angular, after.angular, 0.5 * rate);
                }
            }
        }
    }
}

/// In 10 s at 0.3/s; the result of one step of 10 s and of 1000 of 10 ms, each with its roundings.
#[test]
fn decay_does_not_depend_on_the_step() {
    for integrator in Integrator::ALL {
        for (dt, steps) in [(10.0, 1_u32), (0.01, 1000)] {
            let mut world = World::new();
            let body = brick(Damping { linear: 0.3, angular: 0.3 }).linear_velocity(Vec3::X * 5.0);
            let entity = spawn(&mut world, body);
            let mut simulation = simulation(integrator, Vec3::ZERO, dt);
            for _ in 0..steps {
                simulation.step(&mut world);
            }
            let expected = 5.0 * kept(0.3, 10.0);
            let v = f64::from(world.get::<&Velocity>(entity).unwrap().linear.x);
            // Up to eight units in the last place in a step, and the steps add up to 10 s up to
            // their rounding.
            let allowed = expected * EPSILON * (8.0 * f64::from(steps) + 8.0);
            assert!((v - expected).abs() <= allowed, "{integrator}, {steps} steps: {v} not {expected}");
        }
    }
}

/// Damping turns no momentum: a damped tumbling body keeps the direction of its angular momentum,
/// and still tumbles.
#[test]
fn damping_keeps_the_direction_of_angular_momentum() {
    for integrator in Integrator::ALL {
        let mut world = World::new();
        let body = brick(Damping { linear: 0.0, angular: 0.5 }).angular_velocity(Vec3::new(1.0, 5.0, 2.0));
        let entity = spawn(&mut world, body);
        let start = dvec3(world.get::<&Momentum>(entity).unwrap().angular).normalize();
        let mut simulation = simulation(integrator, Vec3::ZERO, 0.01);
        for _ in 0..1000 {
            simulation.step(&mut world);
        }
        let end = dvec3(world.get::<&Momentum>(entity).unwrap().angular);
        // Each component is rounded up to twice a step.
        assert!(start.cross(end.normalize()).length() <= EPSILON * 2.0 * 1000.0, "{integrator}: {start} to {end}");
        assert!(dquat(world.get::<&Pose>(entity).unwrap().orientation).w.abs() < 0.999, "{integrator}: did not turn");
    }
}

/// The relative error of the velocity after a fall of `steps` from rest under damping,
/// `v = g/c (1 - e^(-c t))`.
fn fall(integrator: Integrator, rate: Real, dt: Real, steps: u32) -> f64 {
    let mut world = World::new();
    let entity = spawn(&mut world, brick(Damping { linear: rate, angular: 0.0 }));
    let mut simulation = simulation(integrator, Vec3::NEG_Y * 9.81, dt);
    for _ in 0..steps {
        simulation.step(&mut world);
    }
    let gravity = seconds(9.81 as Real);
    let exact = -gravity / seconds(rate) * -(-seconds(rate) * seconds(dt) * f64::from(steps)).exp_m1();
    f64::from(world.get::<&Velocity>(entity).unwrap().linear.y) / exact - 1.0
}

/// The whole fall and the terminal velocity, from rates that hardly act to ones that stop a body
/// within a thousandth of the step.
///
/// Each step rounds force, impulse and momentum by a few units in the last place. The error of one
/// step is forgotten as the momentum is, so what is left is that of the last `1/(c dt)` steps or of
/// all.
#[test]
fn a_falling_body_reaches_its_terminal_velocity() {
    for integrator in Integrator::ALL {
        for rate in [0.01, 0.5, 5.0, 60.0, 600.0, 5000.0, 1e5] {
            for steps in [1, 10, 1000] {
                let error = fall(integrator, rate, 1.0 / 64.0, steps).abs();
                let remembered = (64.0 / seconds(rate)).clamp(1.0, f64::from(steps));
                assert!(
                    error <= 8.0 * EPSILON * (1.0 + remembered),
                    "{integrator}, {rate}/s, {steps} steps: {error:e}"
                );
            }
        }
    }
}

/// However stiff, a damped body without forces only ever slows down, and never turns round.
#[test]
fn stiff_damping_is_stable() {
    for integrator in Integrator::ALL {
        for rate in [100.0, 1e4, 1e8, 1e30] {
            let mut world = World::new();
            let body = brick(Damping { linear: rate, angular: rate });
            let entity = spawn(&mut world, body.linear_velocity(Vec3::X * 1e3).angular_velocity(Vec3::Y * 1e3));
            let mut simulation = simulation(integrator, Vec3::ZERO, 0.1);
            let mut before = *world.get::<&Momentum>(entity).unwrap();
            for _ in 0..100 {
                simulation.step(&mut world);
                let after = *world.get::<&Momentum>(entity).unwrap();
                assert!((0.0..=before.linear.x).contains(&after.linear.x), "{integrator}, {rate}/s: {}", after.linear);
                assert!(
                    (0.0..=before.angular.y).contains(&after.angular.y),
                    "{integrator}, {rate}/s: {}",
                    after.angular
                );
                before = after;
            }
            let pose = *world.get::<&Pose>(entity).unwrap();
            assert!(pose.position.is_finite() && pose.orientation.is_finite());
            // From 1000 m/s, the way to rest is v/c or, where a whole first step is taken before
            // the decay, v dt.
            assert!(pose.position.x <= 1e3 * 0.1, "{integrator}, {rate}/s: {}", pose.position);
        }
    }
}

/// A body without the component, and one with rates of zero, are not damped at all.
#[test]
fn no_damping_is_no_damping() {
    for integrator in Integrator::ALL {
        let mut world = World::new();
        let moving = |body: RigidBody| body.linear_velocity(Vec3::ONE).angular_velocity(Vec3::ONE);
        let zero = spawn(&mut world, moving(brick(Damping::default())));
        let without =
            spawn(&mut world, moving(RigidBody::new(Shape::cuboid([0.1, 0.2, 0.3])).without_collider().mass(2.0)));
        let mut simulation = simulation(integrator, Vec3::NEG_Y, 0.01);
        for _ in 0..100 {
            simulation.step(&mut world);
        }
        let momentum = |entity| *world.get::<&Momentum>(entity).unwrap();
        let error = (dvec3(momentum(zero).linear) - dvec3(momentum(without).linear)).length();
        assert_eq!(momentum(zero).angular, momentum(without).angular, "{integrator}");
        // Force times (1 times the step) and force times the step are the same; weighing in halves
        // or thirds rounds otherwise.
        assert!(error <= EPSILON * 100.0 * 3.0, "{integrator}: {error:e}");
    }
}
