//! Promise: what stands, stands. On level ground and on a slope of 15 degrees a vehicle with the
//! hand brake on stays to a millimetre for ten minutes, and does not shake.
//!
//! Half a minute of each is simulated, or `TUMBLE_VEHICLE_SECONDS`.

use tumble::math::{Quat, Real, Vec3};

use tumble_vehicle::VehiclePlan;

use crate::course::{Course, Draw, settling};

fn seconds() -> f64 {
    std::env::var("TUMBLE_VEHICLE_SECONDS").ok().and_then(|it| it.parse().ok()).unwrap_or(30.0)
}

#[test]
fn it_stays_where_it_stands() {
    for case in 0..16 {
        let mut draw = Draw::new(10, case);
        let (mut plan, dt) = (draw.plan(), draw.dt());
        plan.probe = draw.probe();
        let slope: Real = if case % 4 == 0 { 0.0 } else { (15.0 as Real).to_radians() };
        let mut course = Course::on_plane(&plan, dt, Quat::from_rotation_x(slope), draw.real(-3.0, 3.0));
        course.drive(|input| input.hand_brake = 1.0);
        course.run(2.0 * settling(&plan));
        let before = course.pose();
        for _ in 0..course.steps(seconds()) {
            course.step();
            let speed = course.velocity().linear.length();
            assert!(speed < 2e-4, "case {case}: shakes at {speed} m/s");
        }
        let moved = (course.pose().position - before.position).length();
        assert!(moved < 1e-3, "case {case}: went {moved} m");
        assert!(course.wheels().iter().skip(2).all(|wheel| wheel.spin == 0.0), "case {case}: a wheel turns");
    }
}

/// A push that lasts, which the tyres learn of by their shear alone: below the friction it is held,
/// above it is not. Of cars, from 60 steps a second on.
#[test]
fn a_push_is_held_up_to_the_friction() {
    for case in 0..16 {
        let mut draw = Draw::new(12, case);
        let length = draw.real(3.0, 6.0);
        let plan = VehiclePlan { friction: draw.real(0.6, 1.1), ..VehiclePlan::car(length, 20.0 * length.powi(3)) };
        let dt = draw.dt().min(1.0 / 60.0);
        for (part, holds) in [(0.6, true), (1.2, false)] {
            let mut course = Course::on_plane(&plan, dt, Quat::IDENTITY, draw.real(-3.0, 3.0));
            course.drive(|input| (input.brake, input.hand_brake) = (1.0, 1.0));
            // Brakes that hold more than the tyres do.
            let mut vehicle = course.world.get::<&mut tumble_vehicle::Vehicle>(course.vehicle).unwrap();
            let mut settings = vehicle.settings().clone();
            settings.wheels.iter_mut().for_each(|wheel| wheel.hand_brake_torque *= 10.0);
            settings.wheels.iter_mut().for_each(|wheel| wheel.brake_torque *= 10.0);
            vehicle.set_settings(settings).unwrap();
            drop(vehicle);
            // Low, so that it does not turn over.
            let force = Vec3::X * (part * 9.81 * plan.friction * plan.mass);
            let torque = Vec3::Z * (force.x * plan.center_height);
            course
                .world
                .insert_one(course.vehicle, tumble::ConstantWrench { force, torque, ..Default::default() })
                .unwrap();
            course.run(2.0 * settling(&plan));
            let before = course.pose().position;
            let time = 3.0 * settling(&plan);
            course.run(time);
            let moved = (course.pose().position - before).x.abs();
            let fall = 0.5 * 9.81 * (time * time) as Real;
            assert_eq!(moved < 1e-3 * plan.length, holds, "case {case}: went {moved} m at {part} of the friction");
            assert!(holds || moved > 0.1 * plan.friction * fall, "case {case}: went {moved} m only");
        }
    }
}

/// What rolls down a slope without brakes does so with the acceleration of its mass and its wheels.
#[test]
fn without_brakes_it_rolls() {
    for case in 0..20 {
        let mut draw = Draw::new(11, case);
        let (plan, dt) = (draw.plan(), draw.dt());
        let slope = draw.real(0.05, 0.2);
        let mut course = Course::on_plane(&plan, dt, Quat::from_rotation_x(slope), 0.0);
        let mut vehicle = course.world.get::<&mut tumble_vehicle::Vehicle>(course.vehicle).unwrap();
        let mut settings = vehicle.settings().clone();
        settings.motor.drag = 0.0;
        vehicle.set_settings(settings).unwrap();
        drop(vehicle);
        course.drive(|input| input.hand_brake = 1.0);
        course.run(settling(&plan));
        course.drive(|input| input.hand_brake = 0.0);
        let time = 3.0 * settling(&plan);
        let along = Quat::from_rotation_x(slope) * Vec3::Z;
        let before = f64::from(course.velocity().linear.dot(along));
        course.run(time);
        let gained = f64::from(course.velocity().linear.dot(along)) - before;
        let wheels = 0.5 * f64::from(plan.wheel_mass) * 2.0 * plan.axles as f64;
        let slope = f64::from(slope);
        let force = 9.81 * f64::from(plan.mass) * (slope.sin() - 0.012 * slope.cos());
        let expected = force / (f64::from(plan.mass) + wheels) * time;
        crate::course::assert_near(gained, expected, 0.02, &format!("case {case}, speed after {time} s"));
    }
}
