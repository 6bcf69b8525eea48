//! Promise: what pushes the vehicle pushes what is under its wheels, equally and the other way.

use tumble::math::{Real, Vec3, dvec3};
use tumble::prelude::*;
use tumble_vehicle::VehiclePlan;

use crate::course::{Course, Draw, settling};

/// A slab without friction under a vehicle that drives, steers and brakes on it: the momentum of
/// both together along the ground does not change, and that about the
/// vertical only by what the step does not resolve.
#[test]
fn momentum_is_kept_on_a_slab_that_slides() {
    for case in 0..24 {
        let (mut draw, plan, mut course) = Course::drawn(60, case);
        let ice = Material::new(0.0, 0.0);
        let ground = RigidBody::ground().material(ice);
        course.world.clear();
        ground.build().unwrap().spawn(&mut course.world);
        let length = f64::from(plan.length);
        let half = [8.0, 0.2, 8.0].map(|edge| edge * length);
        let slab = RigidBody::new(Shape::cuboid(half))
            .mass(f64::from(plan.mass) * draw.log_between(0.3, 30.0))
            .material(ice)
            .position(Vec3::Y * half[1] as Real);
        let slab = slab.build().unwrap().spawn(&mut course.world);
        course.vehicle = plan.spawn(&mut course.world, Pose::at(Vec3::Y * 2.0 * half[1] as Real)).unwrap();
        course.run(settling(&plan));
        let mut largest = 0.0_f64;
        let before = totals(&course, slab);
        let (mut budget, mut slab_before) = (0.0, linear_of(&course, slab));
        for step in 0..300 {
            if step % 50 == 0 {
                let (throttle, steering) = (draw.real(-1.0, 1.0), draw.real(-1.0, 1.0));
                course.drive(|input| {
                    (input.throttle, input.steering) = (throttle, steering);
                    input.brake = if step == 200 { 1.0 } else { 0.0 };
                });
            }
            course.step();
            if course.wheels().iter().any(|wheel| wheel.contact.is_none_or(|it| it.ground != slab)) {
                break;
            }
            let (linear, angular) = totals(&course, slab);
            let speed = f64::from(course.velocity().linear.length());
            largest = largest.max(speed);
            let scale = f64::from(plan.mass) * largest.max(0.1);
            let error = (linear - before.0).length() / scale;
            assert!(error < 1e-5, "case {case}, step {step}: momentum is off by {error} of that of the vehicle");
            // Bodies beside others move on in substeps, which a torque does not follow: at four of
            // them by an eighth of the way of a step. What leaning wheels spin with is left out.
            let speeds = [slab, course.vehicle].map(|it| course.world.get::<&Velocity>(it).unwrap().linear.length());
            let way = f64::from((speeds[0] + speeds[1]) * course.simulation.settings().dt);
            budget += 0.125 * way * (linear_of(&course, slab) - slab_before).length();
            slab_before = linear_of(&course, slab);
            let error = (angular - before.1).abs();
            let most = budget + 3e-3 * scale * length;
            assert!(error < most, "case {case}, step {step}: angular momentum is off by {error}, of {most}");
        }
        assert!(largest > 0.1, "case {case}: it has moved");
    }
}

fn linear_of(course: &Course, body: tumble::hecs::Entity) -> tumble::glam::DVec3 {
    dvec3(course.world.get::<&Momentum>(body).unwrap().linear)
}

/// Momentum along the ground, and about the vertical through the origin.
fn totals(course: &Course, slab: tumble::hecs::Entity) -> (tumble::glam::DVec3, f64) {
    let (mut linear, mut angular) = (tumble::glam::DVec3::ZERO, 0.0);
    for body in [course.vehicle, slab] {
        let momentum = *course.world.get::<&Momentum>(body).unwrap();
        let place = dvec3(course.world.get::<&Pose>(body).unwrap().position);
        let along = dvec3(momentum.linear) * tumble::glam::DVec3::new(1.0, 0.0, 1.0);
        linear += along;
        angular += f64::from(momentum.angular.y) + place.cross(along).y;
    }
    (linear, angular)
}

/// A light plank under the wheels: nothing shakes, and it is pressed on the ground by what the
/// wheels carry.
#[test]
fn a_light_plank_is_pressed_down() {
    for case in 0..16 {
        let mut draw = Draw::new(61, case);
        let (plan, dt) = (VehiclePlan::car(4.5, 1500.0), draw.dt());
        let mut course = Course::flat(&plan, dt);
        let plank = RigidBody::new(Shape::cuboid([1.5, 0.05, 3.0])).mass(draw.log_between(20.0, 3000.0));
        let plank = plank.position(Vec3::Y * 0.05).build().unwrap().spawn(&mut course.world);
        course.world.get::<&mut Pose>(course.vehicle).unwrap().position.y += 0.1;
        course.drive(|input| input.hand_brake = 1.0);
        course.run(3.0);
        let mut speed = 0.0 as Real;
        for _ in 0..course.steps(2.0) {
            course.step();
            let of_plank = course.world.get::<&Velocity>(plank).unwrap().linear.length();
            speed = speed.max(course.velocity().linear.length()).max(of_plank);
        }
        assert!(speed < 2e-3, "case {case}: shakes at {speed} m/s");
        let wheels = course.wheels();
        assert!(wheels.iter().all(|wheel| wheel.contact.is_some_and(|it| it.ground == plank)));
        let carried: Real = wheels.iter().map(|wheel| wheel.load).sum();
        assert!((carried / (1500.0 * 9.81) - 1.0).abs() < 0.01, "case {case}: {carried} N");
    }
}

/// On a kinematic platform the vehicle goes along.
#[test]
fn a_moving_platform_takes_it_along() {
    let plan = VehiclePlan::car(4.5, 1500.0);
    let mut course = Course::flat(&plan, 1.0 / 60.0);
    let ferry = RigidBody::new(Shape::cuboid([10.0, 0.5, 10.0])).kinematic().position(Vec3::Y * 0.5);
    let ferry = ferry.linear_velocity(Vec3::new(1.0, 0.0, 2.0)).angular_velocity(Vec3::Y * 0.2).build().unwrap();
    let ferry = ferry.spawn(&mut course.world);
    course.world.get::<&mut Pose>(course.vehicle).unwrap().position.y += 1.0;
    course.drive(|input| (input.brake, input.hand_brake) = (1.0, 1.0));
    course.run(2.0);
    let on_ferry = |course: &Course| {
        let ferry = *course.world.get::<&Pose>(ferry).unwrap();
        ferry.inverse_transform_point(course.pose().position)
    };
    let before = on_ferry(&course);
    course.run(20.0);
    let moved = (on_ferry(&course) - before).length();
    assert!(moved < 0.02, "slid {moved} m");
}
