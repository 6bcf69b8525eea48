//! Promise: on free bodies the attitude error falls with the first power of the step under
//! `SemiImplicitEuler`, with the fourth under `RungeKutta4` and with the sixth under
//! `MoserVeselov`, towards the exact solution.
//!
//! Why: the order is what a user chooses an integrator by, and only an exact solution shows that it
//! converges to the right thing. A wrong sign, frame or coefficient would either leave an error
//! that no step removes or lower the order.
//!
//! The references are solutions in 34 digits (`data/free_body`); all runs are those of
//! [`Simulation`] on a world.

use hecs::World;
use tumble::math::Real;
use tumble::{Integrator, Pose, Velocity};
use tumble_tests::{DOUBLE, EPSILON, FreeBody, attitude_error, by_precision, dquat, dvec3, run, weightless};

use Integrator::{MoserVeselov, RungeKutta4, SemiImplicitEuler};

fn bodies() -> [FreeBody; 4] {
    [FreeBody::van_zon_top(), FreeBody::drake_cylinder(), FreeBody::t_handle(), FreeBody::mujoco_box()]
}

/// Attitude error \[rad\] and the error of the body-frame angular velocity relative to its size
/// after `steps` to `time`.
fn errors(body: &FreeBody, integrator: Integrator, time: f64, steps: u32) -> (f64, f64) {
    let mut world = World::new();
    let entity = body.spawn(&mut world);
    let dt = (time / f64::from(steps)) as Real;
    run(&mut weightless(integrator, dt), &mut world, steps);
    let exact = body.at(time);
    let orientation = dquat(world.get::<&Pose>(entity).unwrap().orientation);
    let spin = orientation.conjugate() * dvec3(world.get::<&Velocity>(entity).unwrap().angular);
    (
        attitude_error(orientation, exact.orientation),
        (spin - exact.angular_velocity_body).length() / exact.angular_velocity_body.length(),
    )
}

fn observed_order(body: &FreeBody, integrator: Integrator, time: f64, steps: u32) -> f64 {
    let (coarse, fine) = (errors(body, integrator, time, steps).0, errors(body, integrator, time, 2 * steps).0);
    let order = (coarse / fine).log2();
    println!(
        "{integrator} on {}, {steps} and {} steps to {time} s: {coarse:.3e}, {fine:.3e}, order {order:.3}",
        body.name,
        2 * steps
    );
    order
}

fn assert_order(body: &FreeBody, integrator: Integrator, time: f64, steps: u32, expected: f64, tolerance: f64) {
    let order = observed_order(body, integrator, time, steps);
    assert!((order - expected).abs() <= tolerance, "{integrator} on {}: observed order {order}", body.name);
}

/// The error is `C h (1 + O(h))`: at these steps the second term is below one per cent, hence the
/// order within 0.02. The T-handle, all but on its separatrix, needs a short time and short steps
/// for that. All errors are far above rounding in single precision.
#[test]
fn semi_implicit_euler_is_of_first_order() {
    let [van_zon, cylinder, t_handle, mujoco] = bodies();
    for (body, time, steps) in [(van_zon, 1.0, 2048), (cylinder, 1.0, 512), (t_handle, 0.5, 4096), (mujoco, 1.0, 512)] {
        assert_order(&body, SemiImplicitEuler, time, steps, 1.0, 0.02);
    }
}

/// As above with steps at which the next term of the error is about one per cent: the order within
/// 0.04.
///
/// In single precision the steps must be coarse for the error to stand above rounding; there the
/// next terms are a quarter of the error, and the order comes out up to 0.4 too high, in double
/// precision as well.
#[test]
fn runge_kutta4_is_of_fourth_order() {
    let [van_zon, cylinder, t_handle, mujoco] = bodies();
    let (steps, tolerance) = if DOUBLE { ([512, 256, 1024, 128], 0.04) } else { ([32, 16, 32, 16], 0.4) };
    for (body, steps) in [van_zon, cylinder, t_handle, mujoco].iter().zip(steps) {
        assert_order(body, RungeKutta4, 1.0, steps, 4.0, tolerance);
    }
}

/// The largest steps that the map takes in one part; the next term of the error is a few per cent
/// there. In single precision the error at these steps is below rounding: there is nothing to
/// observe.
#[cfg(feature = "f64")]
#[test]
fn moser_veselov_is_of_sixth_order() {
    let [van_zon, cylinder, t_handle, mujoco] = bodies();
    for (body, steps) in [(van_zon, 64), (cylinder, 32), (t_handle, 128), (mujoco, 16)] {
        assert_order(&body, MoserVeselov, 1.0, steps, 6.0, 0.05);
    }
}

/// What rounding does to the attitude of a free body \[rad\].
///
/// Every step rounds the orientation about twice; the first term is all of that in one direction.
/// Rounding the components by `EPSILON/4` on average also changes the energy `T` by that much of
/// itself, at random, so by `sqrt(steps)` times it in all. At the separatrix `L^2 = 2 T I_2`, where
///
/// ```text
/// m = (I2 - I1) (2 T I3 - L^2) / ((I3 - I2) (L^2 - 2 T I1))
/// dm/m = dT/T (I3/(I3 - I2) + I1/(I2 - I1))
/// ```
///
/// and a flip takes `ln(16/(1 - m))/lambda`, so each comes late by `dm/((1 - m) lambda)` while the
/// body turns at `|w|`: the second term.
fn rounding(body: &FreeBody, time: f64, steps: u32) -> f64 {
    let attitude = 2.0 * EPSILON * f64::from(steps);
    let Some(elliptic) = body.elliptic else { return attitude };
    let mut moments = body.moments.to_array();
    moments.sort_by(f64::total_cmp);
    let [i1, i2, i3] = moments;
    let parameter = 0.25 * EPSILON * f64::from(steps).sqrt() * (i3 / (i3 - i2) + i1 / (i2 - i1));
    let late = parameter / ((1.0 - elliptic.parameter) * elliptic.frequency) * (time / elliptic.flip_interval);
    attitude + body.angular_velocity.length() * late
}

/// At 1000 steps a second the sixth-order error is below 1e-12 rad on the fastest body, so double
/// precision shows rounding only; at 100 it is below 1e-6, so single precision does. The T-handle's
/// second term is several radians in single precision: nothing that a test could hold it to.
#[test]
fn moser_veselov_agrees_with_the_exact_solution_to_rounding() {
    for body in bodies() {
        if !DOUBLE && body.name == "t_handle" {
            continue;
        }
        for sample in &body.samples {
            let steps = (sample.time * by_precision(100.0, 1000.0)).round() as u32;
            let (attitude, spin) = errors(&body, MoserVeselov, sample.time, steps);
            let allowed = rounding(&body, sample.time, steps);
            println!(
                "{} at {} s: {attitude:.1e} rad, angular velocity {spin:.1e}, allowed {allowed:.1e}",
                body.name, sample.time
            );
            assert!(attitude <= allowed, "{} at {} s: {attitude:e} rad > {allowed:e}", body.name, sample.time);
            // Where the attitude is wrong by an angle, so is the direction of the angular velocity,
            // at most twice for a body that turns about itself meanwhile.
            assert!(spin <= 2.0 * allowed, "{} at {} s: spin {spin:e} > {allowed:e}", body.name, sample.time);
        }
    }
}

/// 100 steps a second, to the end of each reference. The bounds are twice the errors measured when
/// this was written, which is what the leading term of each gives; a method one order lower would
/// miss them a hundredfold.
#[cfg(feature = "f64")]
#[test]
fn attitude_at_a_hundred_steps_a_second_is_within_bounds() {
    let [van_zon, cylinder, t_handle, mujoco] = bodies();
    let bounds = [
        (&van_zon, RungeKutta4, 10.0, 5.1e-2),
        (&cylinder, RungeKutta4, 10.0, 1.3e-5),
        (&mujoco, RungeKutta4, 5.0, 2.1e-7),
        (&van_zon, MoserVeselov, 10.0, 1.6e-6),
        (&cylinder, MoserVeselov, 10.0, 7.1e-9),
        (&t_handle, MoserVeselov, 20.0, 2.0e-5),
        (&mujoco, MoserVeselov, 5.0, 2.8e-11),
    ];
    for (body, integrator, time, bound) in bounds {
        let attitude = errors(body, integrator, time, (time * 100.0).round() as u32).0;
        println!("{integrator} on {} after {time} s: {attitude:.2e} rad", body.name);
        assert!(attitude <= bound, "{integrator} on {}: {attitude:e} rad > {bound:e}", body.name);
    }
}

/// Attitude errors \[rad\] of someone else's program for the same two methods, printed with five
/// digits. The methods are the same, so the errors are: to the digits printed, and to 1e-3 where
/// its fourth-order method does not normalise before each evaluation, which is a difference of
/// higher order.
#[test]
fn errors_are_those_of_an_independent_implementation() {
    let (van_zon, gazebo) = (FreeBody::van_zon_top(), FreeBody::gazebo_boxes());
    let single_shows_it = [
        (&van_zon, SemiImplicitEuler, 1.0, 100, 4.2061e-1, 2e-4),
        (&van_zon, SemiImplicitEuler, 1.0, 400, 1.5777e-1, 2e-4),
    ];
    let double_only = [
        (&van_zon, RungeKutta4, 1.0, 100, 1.5014e-5, 1e-3),
        (&van_zon, RungeKutta4, 1.0, 800, 3.2750e-9, 1e-3),
        (&gazebo, SemiImplicitEuler, 10.0, 1000, 2.8350, 2e-4),
        (&gazebo, RungeKutta4, 10.0, 500, 9.7301e-2, 1e-3),
        (&gazebo, RungeKutta4, 10.0, 2000, 9.2681e-5, 1e-3),
    ];
    for (body, integrator, time, steps, published, tolerance) in
        single_shows_it.into_iter().chain(double_only.into_iter().filter(|_| DOUBLE))
    {
        let attitude = errors(body, integrator, time, steps).0;
        println!("{integrator} on {}, {steps} steps to {time} s: {attitude:.5e}, published {published:.4e}", body.name);
        assert!(
            (attitude / published - 1.0).abs() <= tolerance,
            "{integrator} on {}, {steps} steps: {attitude:e} rad, published {published:e}",
            body.name
        );
    }
}
