//! Promise: a `SpringToPoint` swings, decays and turns its body as the closed forms say, under all
//! three integrators, as near as the order of the method allows; no stiffness is too much.
//!
//! Why: a spring at the wrong frequency looks plausible on a screen, and a stiff one that gains
//! energy ends a game. It fails if the stiffness is not that of the step, if the damper acts at
//! the wrong stage, or if the moment is about the wrong point.

use crate::one_body::{DT, MASS, MOMENTS, after, allowed, assert_near, body, state, world_of};
use glam::DVec3;
use tumble::Integrator::{self, MoserVeselov, RungeKutta4, SemiImplicitEuler};
use tumble::SpringToPoint;
use tumble::math::{Real, Vec3};
use tumble_tests::{EPSILON, by_precision, dvec3, seconds, weightless};

/// The angle that a spring's swing turns through in a step \[rad\].
fn angle_a_step(stiffness: f64) -> f64 {
    (stiffness / MASS).sqrt() * seconds(DT)
}

/// Without rest length, in three dimensions: `x0 cos w t + v0/w sin w t`. The splitting methods go
/// through the points of the swing at its true frequency, with `sin w dt/(w dt)` of the amplitude
/// in the part from `v0` — up to 0.45 swings a step, for they act with the stiffness that makes it
/// so.
#[test]
fn a_spring_swings_at_its_frequency() {
    let (x, v) = (Vec3::new(0.5, -0.2, 0.1), Vec3::new(-0.3, 0.4, 0.6));
    let anchor = Vec3::new(1.0, 2.0, -3.0);
    for swings_a_step in [0.01, 0.1, 0.25, 0.45] {
        let angle = std::f64::consts::TAU * swings_a_step;
        let stiffness = (MASS * (angle / seconds(DT)).powi(2)) as Real;
        let angle = angle_a_step(stiffness.into());
        let spring = SpringToPoint { anchor, stiffness, ..SpringToPoint::default() };
        for integrator in [SemiImplicitEuler, MoserVeselov] {
            for steps in [1, 2, 7, 100] {
                let ball = body().position(anchor + x).linear_velocity(v);
                let (pose, _) = after(steps, integrator, ball, (spring,));
                let (sin, cos) = (f64::from(steps) * angle).sin_cos();
                // What a step makes of the start: of the state by the full kick or by half of it.
                let kicked = if integrator == MoserVeselov { 0.0 } else { angle.cos() - 1.0 };
                let second = (dvec3(x) * kicked + dvec3(v) * seconds(DT)) / angle.sin();
                let exact = dvec3(anchor) + dvec3(x) * cos + second * sin;
                // The place, four metres away, is rounded in each step, and the stiffness has some
                // eight roundings, which turn the angle by that over its sine.
                let amplitude = dvec3(x).length() + second.length();
                let bound = EPSILON * f64::from(steps) * (4.0 + 8.0 * amplitude / angle.sin());
                let error = (dvec3(pose.position) - exact).length();
                assert!(error <= bound, "{integrator}, {swings_a_step}, {steps}: off by {error:e} of {bound:e}");
            }
        }
    }
    let ball = body().position(anchor + x).linear_velocity(v);
    let (pose, _) =
        after(128, RungeKutta4, ball, (SpringToPoint { anchor, stiffness: 50.0, ..SpringToPoint::default() },));
    let exact = dvec3(anchor) + dvec3(x) * 5.0_f64.cos() + dvec3(v) / 5.0 * 5.0_f64.sin();
    assert_near("swing", RungeKutta4, pose.position, exact, 4.0, 5.0, 128);
}

/// Decays at the rate `c/2M` and swings a little slower for it, about the rest length.
#[test]
fn a_damped_spring_decays() {
    let (stiffness, damping) = (50.0, 4.0);
    let spring = SpringToPoint { anchor: Vec3::X, rest_length: 2.0, stiffness, damping, ..SpringToPoint::default() };
    for integrator in Integrator::ALL {
        for steps in [64, 128, 256] {
            let ball = body().position(Vec3::X * 3.5);
            let (pose, _) = after(steps, integrator, ball, (spring,));
            let (decay, w) = (4.0 / (2.0 * MASS), f64::sqrt(50.0 / MASS - 1.0));
            let time = f64::from(steps) * seconds(DT);
            let swing = (-decay * time).exp() * ((w * time).cos() + decay / w * (w * time).sin());
            let exact = DVec3::X * (3.0 + 0.5 * swing);
            assert_near("swing", integrator, pose.position, exact, 3.5, 5.0, steps);
        }
    }
}

/// However strong the spring and the damper, under the methods that split a step: nothing grows.
/// Without the damper, at 0.45 swings a step, velocities of up to `1/cos(0.45 pi)`, 6.4 times the
/// amplitude over half a step, belong to the swing.
#[test]
fn no_spring_to_a_point_is_too_stiff() {
    for integrator in [SemiImplicitEuler, MoserVeselov] {
        for (stiffness, damping) in [(1e6, 0.0), (1e20, 0.0), (1e6, 1e3), (1e6, 1e20), (0.0, 1e20), (1e20, 1e20)] {
            let spring = SpringToPoint { rest_length: 0.5, stiffness, damping, ..SpringToPoint::default() };
            let (mut world, ball) = world_of(body().position(Vec3::X).linear_velocity(Vec3::X * 3.0), (spring,));
            let mut simulation = weightless(integrator, DT);
            // It starts half a metre from rest, with another 3 m/s times a step.
            let most = (0.5 + 3.0 * seconds(DT)) * 6.4;
            for _ in 0..10_000 {
                simulation.step(&mut world);
                let x = f64::from(state(&world, ball).0.position.x);
                assert!((x - 0.5).abs() <= most, "{integrator}, {stiffness:e}, {damping:e}: {x}");
            }
        }
    }
}

/// A spring that is attached off the centre turns the body too: small swings have
/// `w^2 = k (1/M + r^2/I)`. A centimetre (in double precision a tenth of a millimetre) of a metre,
/// so the frequency is off by the square of that.
#[test]
fn a_spring_off_the_centre_turns_the_body() {
    let amplitude = by_precision(1e-2, 1e-4);
    let attachment = Vec3::Y * 0.5;
    let spring = SpringToPoint {
        anchor: Vec3::new(-4.0, 0.5, 0.0),
        attachment,
        rest_length: 4.0,
        stiffness: 60.0,
        ..SpringToPoint::default()
    };
    let rate = f64::sqrt(60.0 * (1.0 / MASS + 0.25 / MOMENTS.z));
    for integrator in Integrator::ALL {
        let ball = body().position(Vec3::X * amplitude as Real);
        let (mut world, ball) = world_of(ball, (spring,));
        let mut simulation = weightless(integrator, DT);
        for step in 1..=128 {
            simulation.step(&mut world);
            let pose = state(&world, ball).0;
            let stretch = dvec3(pose.transform_point(attachment)).x;
            let exact = amplitude * (rate * f64::from(step) * seconds(DT)).cos();
            // The places are rounded where they are a metre.
            let bound = amplitude * (allowed(integrator, rate, 128) + 4.0 * amplitude) + 256.0 * EPSILON;
            assert!((stretch - exact).abs() <= bound, "{integrator}, step {step}: {stretch} for {exact}");
            let angle = 2.0 * f64::from(pose.orientation.z);
            // The centre and the turning share the stretch as their inverse masses do.
            let of_turning = -0.5 / MOMENTS.z / (1.0 / MASS + 0.25 / MOMENTS.z);
            assert!((angle - of_turning * (exact - amplitude)).abs() <= 4.0 * bound, "{integrator}: {angle}");
        }
    }
}
