//! Promise: a vehicle that lies on its side or turns over has no energy from nowhere.

use tumble::math::{Real, Vec3};
use tumble::prelude::*;
use tumble_vehicle::drive_vehicles;

use crate::course::{Course, GRAVITY};

/// The most that energy grows over its least so far, over weight times length, without throttle.
fn growth(course: &mut Course, steps: u32, unit: f64) -> f64 {
    course.simulation.step(&mut course.world);
    // Springs that are pressed in the first step already have nothing that was put in.
    let (mut least, mut most) = (course.energy_without_springs() / unit, 0.0_f64);
    for _ in 0..steps {
        // Compressions are those at the start of the step, as is the motion before it is taken.
        let body = course.energy_without_springs() / unit;
        drive_vehicles(&mut course.world, &course.simulation);
        let energy = course.energy() / unit;
        course.simulation.step(&mut course.world);
        most = most.max(body - least);
        least = least.min(energy);
    }
    most
}

/// Puts the vehicle in an orientation on the ground, with a gap.
fn put(course: &mut Course, orientation: Quat, gap: Real) {
    let pose = Pose { position: Vec3::Y * 100.0, orientation };
    *course.world.get::<&mut Pose>(course.vehicle).unwrap() = pose;
    let filter = QueryFilter::new().without(course.vehicle);
    let fall = {
        let collider = course.world.get::<&tumble::Collider>(course.vehicle).unwrap();
        let queries = course.simulation.queries(&course.world);
        queries.cast_shape(&collider, &pose, Vec3::Y * -200.0, &filter).unwrap().distance
    };
    course.world.get::<&mut Pose>(course.vehicle).unwrap().position.y -= fall - gap;
}

/// Let go from rest, leaned to the side by 66 to 97 degrees, so that no wheel carries yet.
#[test]
fn let_go_on_its_side_it_gains_nothing() {
    for case in 0..90 {
        let (mut draw, plan, mut course) = Course::drawn(90, case);
        let lean = draw.real(1.15, 1.7) * draw.one_of(&[-1.0, 1.0]);
        put(&mut course, Quat::from_rotation_z(lean), 0.0);
        let unit = f64::from(plan.mass * plan.length) * GRAVITY;
        let steps = course.steps(3.0 * f64::from(plan.length / 4.5).sqrt());
        let grown = growth(&mut course, steps, unit);
        assert!(grown < 0.01, "case {case}: grows by {grown} of weight times length");
    }
}

/// Thrown in any orientation, with a spin.
#[test]
fn thrown_over_flat_ground_it_gains_nothing() {
    for case in 0..90 {
        let (mut draw, plan, mut course) = Course::drawn(91, case);
        let axis = Vec3::new(draw.real(-1.0, 1.0), draw.real(-1.0, 1.0), draw.real(-1.0, 1.0)).normalize();
        let gap = draw.real(0.1, 1.0) * plan.length;
        put(&mut course, Quat::from_axis_angle(axis, draw.real(0.0, 3.1)), gap);
        let scale = f64::from(plan.length / 4.5).sqrt();
        let mut random = |most: f64| Vec3::from([0; 3].map(|_| draw.real(-most, most)));
        let (linear, angular) = (random(8.0 * scale), random(2.5 / scale));
        set_linear_velocity(&mut course.world, course.vehicle, linear).unwrap();
        set_angular_velocity(&mut course.world, course.vehicle, angular).unwrap();
        course.drive(|input| input.steering = 0.5);
        let unit = f64::from(plan.mass * plan.length) * GRAVITY;
        let steps = course.steps(5.0 * scale);
        let grown = growth(&mut course, steps, unit);
        assert!(grown < 0.01, "case {case}: grows by {grown} of weight times length");
    }
}
