//! Promise: it turns as its steering and its tyres say, leans as its springs say, and turns over
//! only where statics has it.

use tumble::math::{Real, Vec3};
use tumble_vehicle::VehiclePlan;

use crate::course::{Course, Draw, GRAVITY, assert_near, settling};

/// Keeps a speed by the throttle.
fn keep_speed(course: &mut Course, speed: Real) {
    let forward = course.pose().orientation * Vec3::Z;
    let now = course.velocity().linear.dot(forward);
    // The throttle gives 5 m/s^2: a tenth of a second to the speed that is wanted.
    course.drive(|input| input.throttle = ((speed - now) * 2.0).clamp(-1.0, 1.0));
}

/// At low speed the middle of the rear axle goes round at `wheelbase / tan(steering)`.
#[test]
fn at_low_speed_it_turns_about_one_point() {
    for case in 0..24 {
        let mut draw = Draw::new(30, case);
        let (mut plan, dt) = (draw.plan(), draw.dt());
        plan.axles = 2;
        plan.power = 1e9;
        let steering = draw.real(0.2, 1.0) * if case % 2 == 0 { 1.0 } else { -1.0 };
        let radius = plan.wheelbase / (steering * plan.max_steering).tan();
        // A fortieth of gravity across.
        let speed = (0.025 * 9.81 * radius.abs()).sqrt();
        let mut course = Course::flat(&plan, dt);
        course.run(settling(&plan));
        course.launch(&plan, speed);
        course.drive(|input| input.steering = steering);
        for _ in 0..course.steps(3.0 * f64::from(radius.abs() / speed)) {
            keep_speed(&mut course, speed);
            course.step();
        }
        let (pose, velocity) = (course.pose(), course.velocity());
        let rear = pose.orientation * (Vec3::Z * (-plan.front_load * plan.wheelbase));
        let at_rear = velocity.linear + velocity.angular.cross(rear);
        let found = at_rear.dot(pose.orientation * Vec3::Z) / velocity.angular.y;
        assert_near(found.into(), radius.into(), 0.03, &format!("case {case}, radius at {speed} m/s"));
    }
}

/// On a circle that gets narrower: the most it holds is near the friction of its tyres, never
/// above, and it stays on its wheels, as `track / (2 height)` is more than that.
#[test]
fn it_holds_what_its_tyres_hold_and_stays_upright() {
    for case in 0..30 {
        let mut draw = Draw::new(31, case);
        let (mut plan, dt) = (draw.plan(), draw.dt());
        plan.center_height = plan.track / 2.0 / (plan.friction * draw.real(1.25, 2.0));
        plan.max_steering = 0.3;
        let (most, least_up) = narrow(&plan, dt);
        let limit = f64::from(plan.friction) * GRAVITY;
        assert!(most <= 1.03 * limit && most >= 0.8 * limit, "case {case}: {most} m/s^2 of {limit}");
        assert!(least_up > 0.8, "case {case}: leans to {least_up}");
    }
}

/// What is high and narrow turns over.
#[test]
fn it_turns_over_where_statics_says() {
    for case in 0..30 {
        let mut draw = Draw::new(32, case);
        let (mut plan, dt) = (draw.plan(), draw.dt());
        plan.center_height = plan.track / 2.0 / (plan.friction * draw.real(0.4, 0.6));
        plan.height = 2.0 * (plan.center_height - plan.clearance).max(0.2 * plan.height);
        plan.max_steering = 0.3;
        let (_, least_up) = narrow(&plan, dt);
        assert!(least_up < 0.5, "case {case}: leans to {least_up} only");
    }
}

/// Drives on a circle that gets narrower until it does not hold any more: the greatest mean
/// acceleration across, and the least part of its y axis that is up.
fn narrow(plan: &VehiclePlan, dt: Real) -> (f64, f64) {
    let plan = VehiclePlan { power: 1e9, anti_roll: plan.anti_roll.max(0.5), ..plan.clone() };
    let mut course = Course::flat(&plan, dt);
    course.run(settling(&plan));
    // At a fifth of full steering it is at the limit.
    let speed = (plan.friction * 9.81 * plan.wheelbase / (0.2 * plan.max_steering).tan()).sqrt();
    course.launch(&plan, speed);
    let time = 15.0 * f64::from((plan.length / 4.5).sqrt());
    let steps = course.steps(time);
    let (mut most, mut least_up, mut mean) = (0.0_f64, 1.0_f64, 0.0_f64);
    let follow = (f64::from(dt) / (0.05 * time)).min(1.0);
    for step in 0..steps {
        let part = step as Real / steps as Real;
        course.drive(|input| input.steering = 0.5 * part);
        keep_speed(&mut course, speed);
        let before = course.velocity().linear;
        course.step();
        let acceleration = (course.velocity().linear - before) / dt;
        mean += (f64::from(Vec3::new(acceleration.x, 0.0, acceleration.z).length()) - mean) * follow;
        most = most.max(mean);
        least_up = least_up.min((course.pose().orientation * Vec3::Y).y.into());
    }
    (most, least_up)
}

/// A stiffer bar, less lean: the roll of a steady turn is the moment over the stiffness of springs
/// and bars.
#[test]
fn bars_take_lean() {
    for case in 0..20 {
        let mut draw = Draw::new(33, case);
        let (mut plan, dt) = (draw.plan(), draw.dt());
        plan.axles = 2;
        plan.power = 1e9;
        let lean = |anti_roll: Real| {
            let plan = VehiclePlan { anti_roll, ..plan.clone() };
            let mut course = Course::flat(&plan, dt);
            course.run(settling(&plan));
            let steering: Real = 0.2;
            let speed = (0.3 * 9.81 * plan.wheelbase / (steering * plan.max_steering).tan()).sqrt();
            course.launch(&plan, speed);
            course.drive(|input| input.steering = steering);
            for _ in 0..course.steps(2.0 * settling(&plan)) {
                keep_speed(&mut course, speed);
                course.step();
            }
            let left = course.pose().orientation * Vec3::X;
            let across = f64::from(course.velocity().angular.y * course.velocity().linear.length());
            (f64::from(left.y).asin(), across)
        };
        let spring: f64 = plan.settings().unwrap().wheels.iter().map(|it| f64::from(it.suspension.stiffness)).sum();
        for anti_roll in [0.0, 1.0] {
            let (found, across) = lean(anti_roll);
            let (track, height) = (f64::from(plan.track), f64::from(plan.center_height));
            let weight = f64::from(plan.mass) * GRAVITY;
            let stiffness = spring * (1.0 + 2.0 * f64::from(anti_roll)) * track * track / 4.0 - weight * height;
            let expected = f64::from(plan.mass) * across * height / stiffness;
            assert_near(found, expected, 0.15, &format!("case {case}, lean with a bar of {anti_roll}"));
        }
    }
}
