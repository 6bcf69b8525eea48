//! Promise: at rest wheels carry what statics says, and springs give way by load over stiffness.

use tumble::math::{Vec3, dvec3};
use tumble::{Pose, Settings, Simulation};
use tumble_vehicle::{Vehicle, VehiclePlan};

use crate::course::{Course, Draw, GRAVITY, assert_near, settling};

/// Of any plan, at any step: the weight by the lever of each axle, and the compression of its
/// spring.
#[test]
fn each_wheel_carries_its_part_of_the_weight() {
    for case in 0..60 {
        let (_, plan, mut course) = Course::drawn(1, case);
        course.run(settling(&plan));
        let settings = plan.settings().unwrap();
        let weight = GRAVITY * f64::from(plan.mass);
        for (wheel, state) in course.wheels().iter().enumerate() {
            let of_axle = if wheel < 2 {
                plan.front_load
            } else {
                (1.0 - plan.front_load) / (plan.axles as f32 as tumble::math::Real - 1.0)
            };
            let expected = 0.5 * f64::from(of_axle) * weight;
            assert_near(state.load.into(), expected, 2e-3, &format!("case {case}, load of wheel {wheel}"));
            let deflection = expected / f64::from(settings.wheels[wheel].suspension.stiffness);
            assert_near(state.compression.into(), deflection, 2e-3, &format!("case {case}, compression of {wheel}"));
        }
    }
}

/// A load that is not in the middle: forces and moments are in balance, and each spring and bar has
/// the force of its compression.
#[test]
fn forces_and_moments_of_a_crooked_load_are_in_balance() {
    for case in 0..40 {
        let mut draw = Draw::new(2, case);
        let (plan, dt) = (draw.plan(), draw.dt());
        let (body, vehicle) = plan.build(Pose::default()).unwrap();
        let shift = Vec3::new(draw.real(-0.15, 0.15) * plan.track, 0.0, draw.real(-0.1, 0.1) * plan.wheelbase);
        let plain = body.clone().build().unwrap();
        let center = plain.properties().unwrap().center_of_mass() + dvec3(shift);
        let mut course = Course::flat(&plan, dt);
        course.world.despawn(course.vehicle).unwrap();
        let body = body.center_of_mass(center).build().unwrap();
        course.vehicle = body.spawn_with(&mut course.world, vehicle.components());
        course.drive(|input| input.hand_brake = 1.0);
        course.run(2.0 * settling(&plan));

        let (weight, wheels) = (GRAVITY * f64::from(plan.mass), course.wheels());
        let loads: f64 = wheels.iter().map(|wheel| f64::from(wheel.load)).sum();
        assert_near(loads, weight, 1e-3, &format!("case {case}, the weight"));
        let center = dvec3(course.pose().position);
        for (axis, size) in [(Vec3::X, plan.track), (Vec3::Z, plan.wheelbase)] {
            let lever = |wheel: &tumble_vehicle::WheelState| {
                let point = dvec3(wheel.contact.unwrap().point);
                dvec3(axis).dot(point - center) * f64::from(wheel.load)
            };
            let moment: f64 = wheels.iter().map(lever).sum();
            assert!(moment.abs() < 2e-3 * weight * f64::from(size), "case {case}: a moment of {moment} N m");
        }
        let vehicle = course.world.get::<&Vehicle>(course.vehicle).unwrap();
        for bar in &vehicle.settings().anti_roll_bars {
            let [a, b] = bar.wheels.map(|wheel| &wheels[wheel]);
            let spring = vehicle.settings().wheels[bar.wheels[0]].suspension.stiffness;
            let expected = spring * a.compression + bar.stiffness * (a.compression - b.compression);
            assert_near(a.suspension_force.into(), expected.into(), 5e-3, &format!("case {case}, spring and bar"));
        }
    }
}

/// Nothing hangs on gravity being along y: in a frame that falls as the vehicle does there is no
/// load.
#[test]
fn what_floats_carries_nothing() {
    let plan = VehiclePlan::car(4.5, 1500.0);
    let mut course = Course::flat(&plan, 1.0 / 60.0);
    course.simulation = Simulation::new(Settings::default().with_gravity(Vec3::ZERO)).unwrap();
    course.run(5.0);
    assert!(course.wheels().iter().all(|wheel| wheel.load == 0.0));
    assert!(course.velocity().linear.y > 0.0, "the springs have pushed it off");
}
