//! Promise: it drives and brakes as its torques and its tyres say.

use tumble::math::Real;
use tumble_vehicle::{DrivenWheels, Tyre, VehiclePlan};

use crate::course::{Course, Draw, GRAVITY, assert_near, settling};

/// The slip curve at a slip of one, as a sliding wheel has it.
fn sliding(friction: f64) -> f64 {
    let tyre = Tyre::default();
    let shape = f64::from(tyre.shape);
    (shape * (f64::from(tyre.longitudinal_stiffness) / friction / shape).atan()).sin()
}

/// With all wheels locked: `v^2 / (2 mu g)`, by the friction of sliding.
#[test]
fn the_braking_distance_is_that_of_its_friction() {
    for case in 0..24 {
        let mut draw = Draw::new(20, case);
        let (mut plan, dt) = (draw.plan(), draw.dt());
        plan.deceleration = 30.0;
        let mut course = Course::flat(&plan, dt);
        course.run(settling(&plan));
        let pace = (plan.length / 4.5).sqrt();
        let speed = draw.real(10.0, 40.0) * pace;
        course.launch(&plan, speed);
        course.drive(|input| input.brake = 1.0);
        let before = course.pose().position.z;
        let mut spins = vec![Real::INFINITY; 2 * plan.axles];
        let time = 2.0 * f64::from(speed) / (GRAVITY * f64::from(plan.friction));
        for _ in 0..course.steps(time) {
            course.step();
            for (before, wheel) in spins.iter_mut().zip(course.wheels()) {
                // A brake stops a wheel; it does not turn it back, or let go of it.
                assert!(wheel.spin >= 0.0 && wheel.spin <= *before * 1.001 + 0.01, "case {case}: spin {}", wheel.spin);
                *before = wheel.spin;
            }
        }
        let distance = f64::from(course.pose().position.z - before);
        let friction = f64::from(plan.friction);
        let expected = f64::from(speed).powi(2) / (2.0 * friction * sliding(friction) * GRAVITY);
        assert_near(distance, expected, 0.06, &format!("case {case}, from {speed} m/s"));
        assert!(course.velocity().linear.length() < 1e-3 * speed, "case {case}: stands");
    }
}

/// Below the limit of the tyres: torque over radius is force, less what rolling takes.
#[test]
fn it_accelerates_with_the_torque_at_its_wheels() {
    for case in 0..24 {
        let mut draw = Draw::new(21, case);
        let (mut plan, dt) = (draw.plan(), draw.dt());
        plan.acceleration = draw.real(0.5, 1.5);
        plan.power = 1e9;
        plan.top_speed = 1e4;
        let mut course = Course::flat(&plan, dt);
        course.run(settling(&plan));
        course.drive(|input| input.throttle = 1.0);
        course.run(settling(&plan));
        let (before, time) = (f64::from(course.velocity().linear.z), settling(&plan));
        let steps = f64::from(course.steps(time));
        course.run(time);
        let gained = f64::from(course.velocity().linear.z) - before;
        let mass = f64::from(plan.mass);
        let wheels = 0.5 * f64::from(plan.wheel_mass) * 2.0 * plan.axles as f64;
        let force = mass * (f64::from(plan.acceleration) - 0.012 * GRAVITY);
        let expected = force / (mass + wheels) * steps * f64::from(dt);
        assert_near(gained, expected, 0.02, &format!("case {case}, speed gained in {time} s"));
    }
}

/// Beyond it wheels spin, and no torque is more than the friction of the driven wheels.
#[test]
fn beyond_the_limit_wheels_spin() {
    for case in 0..30 {
        let mut draw = Draw::new(22, case);
        let (mut plan, dt) = (draw.plan(), draw.dt());
        plan.acceleration = 20.0;
        (plan.power, plan.top_speed) = (1e9, 1e4);
        plan.driven_wheels = DrivenWheels::All;
        let mut course = Course::flat(&plan, dt);
        course.run(settling(&plan));
        course.drive(|input| input.throttle = 1.0);
        course.run(settling(&plan));
        let before = f64::from(course.velocity().linear.z);
        course.run(settling(&plan));
        let steps = f64::from(course.steps(settling(&plan)));
        let gained = f64::from(course.velocity().linear.z) - before;
        let limit = f64::from(plan.friction) * GRAVITY * steps * f64::from(dt);
        let driven: Vec<_> = course.wheels();
        assert!(driven.iter().all(|wheel| wheel.slip_ratio > 0.3), "case {case}: {driven:?}");
        assert!(gained <= 1.001 * limit && gained >= 0.85 * limit, "case {case}: {gained} of {limit}");
    }
}

/// The motor ends at its top speed, forwards and backwards, and gives no more than its power.
#[test]
fn it_goes_no_faster_than_its_motor() {
    let mut plan = VehiclePlan::car(4.5, 1500.0);
    plan.top_speed = 20.0;
    let mut course = Course::flat(&plan, 1.0 / 60.0);
    course.drive(|input| input.throttle = 1.0);
    course.run(30.0);
    let speed = course.velocity().linear.z;
    assert!((18.0..20.0).contains(&speed), "{speed} m/s");
    course.drive(|input| input.throttle = -1.0);
    course.run(60.0);
    let speed = course.velocity().linear.z;
    assert!((-5.0..-4.4).contains(&speed), "{speed} m/s");

    plan.top_speed = 200.0;
    plan.power = 3e4;
    let mut course = Course::flat(&plan, 1.0 / 60.0);
    course.drive(|input| input.throttle = 1.0);
    course.run(10.0);
    let energy = 0.5 * plan.mass * course.velocity().linear.length_squared();
    assert!(energy <= plan.power * 10.0 && energy > plan.power * 7.5, "{energy} J");
}
