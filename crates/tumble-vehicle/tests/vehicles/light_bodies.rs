//! Promise: what wheels drive over is not thrown, whatever its mass, and neither it nor the
//! vehicle has energy from nowhere.

use tumble::hecs::Entity;
use tumble::math::{Real, Vec3};
use tumble::prelude::*;
use tumble_vehicle::VehiclePlan;

use crate::course::{Course, Draw, GRAVITY};

/// The group of loose bodies.
const LOOSE: u32 = 2;

/// Planks, balls and boxes before the wheels, of 0.05 to 30 kg for a car of 4.5 m.
fn scatter(course: &mut Course, draw: &mut Draw, plan: &VehiclePlan, count: usize) -> Vec<Entity> {
    let size = f64::from(plan.length) / 4.5;
    let mass = draw.log_between(0.05, 30.0) * f64::from(plan.mass) / 1500.0;
    let kind = draw.one_of(&[0, 1, 2]);
    let mut at = |draw: &mut Draw, index: usize| {
        let radius = draw.between(0.02, 0.1) * size;
        let (shape, height) = match kind {
            0 => (Shape::cuboid([0.3 * size, 0.02 * size, 0.05 * size]), 0.02 * size),
            1 => (Shape::sphere(radius), radius),
            _ => (Shape::cuboid([radius; 3]), radius),
        };
        let place = [draw.between(-1.2, 1.2), height / size, 5.0 + 0.5 * index as f64].map(|it| (it * size) as Real);
        let turned = Quat::from_rotation_y(draw.real(0.0, 6.0));
        // The chassis goes through them: it is the wheels that are asked about.
        let collider = tumble::Collider::new(&shape).unwrap().with_groups(LOOSE, u32::MAX);
        let body = RigidBody::new(shape).mass(mass).position(Vec3::from(place)).orientation(turned);
        body.collider(collider).build().unwrap().spawn(&mut course.world)
    };
    (0..count).map(|index| at(draw, index)).collect()
}

/// Without throttle, and at any time: no body is faster than twice the vehicle at the start, all
/// of them and the vehicle have no more energy than then, and the vehicle stays near the ground.
#[test]
fn no_body_is_thrown_by_more_than_the_vehicle_has() {
    for case in 0..60 {
        let mut draw = Draw::new(80, case);
        let length = draw.log_between(0.3, 20.0);
        let mass = 1500.0 * (length / 4.5).powi(3);
        let mut plan = VehiclePlan::car(length as Real, mass as Real);
        plan.probe = draw.probe();
        let dt = draw.dt();
        let scale = (length / 4.5).sqrt();
        let mut course = Course::flat(&plan, dt);
        let chassis = (*course.world.get::<&tumble::Collider>(course.vehicle).unwrap()).clone().with_groups(1, !LOOSE);
        course.world.insert_one(course.vehicle, chassis).unwrap();
        let bodies = scatter(&mut course, &mut draw, &plan, 30);
        let speed = draw.between(4.0, 15.0) * scale;
        course.run(0.1 * scale);
        course.launch(&plan, speed as Real);
        course.drive(|input| input.steering = 0.02);
        course.step();
        let unit = mass * GRAVITY * length;
        let start = course.energy() + bodies.iter().map(|it| course.energy_of(*it)).sum::<f64>();
        for step in 0..course.steps(2.5 * scale) {
            course.step();
            let speeds = bodies.iter().map(|it| course.world.get::<&Velocity>(*it).unwrap().linear.length());
            let fastest = f64::from(speeds.fold(0.0, Real::max));
            let most = 2.0 * speed + 3.0 * scale;
            assert!(fastest < most, "case {case}, step {step}: {fastest} m/s of a car of {speed} m/s");
            let now = course.energy() + bodies.iter().map(|it| course.energy_of(*it)).sum::<f64>();
            let gained = (now - start) / unit;
            assert!(gained < 0.01, "case {case}, step {step}: gained {gained} of weight times length");
            let height = f64::from(course.pose().position.y) / length;
            assert!(height < 0.4, "case {case}, step {step}: is at {height} lengths");
        }
    }
}

/// A vehicle that is put on a body of any mass stands on it, and rolls off it.
#[test]
fn a_light_floor_carries_what_the_ground_below_carries() {
    for case in 0..24 {
        let mut draw = Draw::new(81, case);
        let (plan, dt) = (VehiclePlan::car(4.5, 1500.0), draw.dt());
        let mut course = Course::flat(&plan, dt);
        let half = draw.between(0.01, 0.05);
        let floor = RigidBody::new(Shape::cuboid([1.5, half, 3.0])).mass(draw.log_between(0.05, 30.0));
        let floor = floor.position(Vec3::Y * half as Real).build().unwrap().spawn(&mut course.world);
        course.world.get::<&mut Pose>(course.vehicle).unwrap().position.y += 2.0 * half as Real;
        course.run(2.0);
        let wheels = course.wheels();
        assert!(wheels.iter().all(|wheel| wheel.contact.is_some_and(|it| it.ground == floor)), "case {case}");
        let carried: Real = wheels.iter().map(|wheel| wheel.load).sum();
        assert!((carried / (1500.0 * 9.81) - 1.0).abs() < 0.01, "case {case}: {carried} N");
        course.drive(|input| input.throttle = 0.5);
        for step in 0..course.steps(3.0) {
            course.step();
            let speed = course.world.get::<&Velocity>(floor).unwrap().linear.length();
            assert!(speed < 2.0, "case {case}, step {step}: the floor has {speed} m/s");
        }
        assert!(course.pose().position.z > 5.0, "case {case}: has not gone off");
    }
}
