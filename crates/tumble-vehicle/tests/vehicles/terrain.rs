//! Promise: at speed over any ground it neither falls through nor breaks, and it gets over kerbs.

use tumble::hecs::World;
use tumble::math::{Quat, Real, Vec3};
use tumble::prelude::*;
use tumble_vehicle::{Probe, VehiclePlan, VehicleState};

use crate::course::{Course, Draw, settling};

/// A minute at 30 m/s over random hills, jumps included, at 30 to 240 steps a second. It keeps to
/// the middle by its steering.
#[test]
fn a_minute_over_hills_at_thirty_metres_a_second() {
    for (case, dt) in [30.0, 60.0, 60.0, 60.0, 240.0].into_iter().enumerate() {
        let mut draw = Draw::new(50, case as u64);
        let mut plan = VehiclePlan::car(4.5, 1500.0);
        plan.probe = [Probe::Ray, Probe::Sphere, Probe::Cylinder][case % 3];
        plan.power = 3e5;
        let height = [0.4, 0.3, 2.0, 4.0, 0.3][case];
        let mut course = Course::on_hills(&plan, 1.0 / dt, &mut draw, height, [60, 760]);
        course.launch(&plan, 30.0);
        let mut way = 0.0;
        for step in 0..course.steps(60.0) {
            let (pose, velocity) = (course.pose(), course.velocity());
            let ahead = pose.orientation * Vec3::Z;
            let (heading, speed) = (ahead.x, velocity.linear.dot(ahead));
            course.drive(|input| {
                input.throttle = (0.3 * (30.0 - speed)).clamp(-1.0, 1.0);
                input.steering = (-0.6 * heading - 0.01 * pose.position.x).clamp(-0.3, 0.3);
            });
            course.step();
            let place = course.pose().position;
            assert!(place.is_finite() && velocity.linear.is_finite(), "case {case}, step {step}: {place}");
            let Some(above) = course.above_ground() else { break };
            assert!(above > 0.0, "case {case}, step {step}: {above} m over the ground, at {place}");
            way += f64::from(velocity.linear.length() / dt);
        }
        // On hills of two metres and more it turns over sooner or later.
        assert!(height > 1.0 || way > 1000.0, "case {case}: went {way} m only");
    }
}

/// A kerb of a third of the wheel's radius is a bump, by any way of looking for the ground.
#[test]
fn it_gets_over_a_kerb() {
    for case in 0..24 {
        let (_, plan, mut course) = Course::drawn(51, case);
        let high = 0.33 * plan.wheel_radius;
        let kerb = Shape::cuboid([5.0, 0.5, 5.0].map(|edge| edge * f64::from(plan.length)));
        let place = Vec3::new(0.0, high - 0.5 * plan.length, 7.0 * plan.length);
        RigidBody::new(kerb).fixed().position(place).build().unwrap().spawn(&mut course.world);
        course.run(0.1);
        course.launch(&plan, 8.0 * (plan.length / 4.5).sqrt());
        course.run(3.0 * f64::from((plan.length / 4.5).sqrt()));
        course.drive(|input| input.brake = 1.0);
        course.run(2.0 * settling(&plan));
        let (place, wheels) = (course.pose().position, course.wheels());
        assert!(place.z > 3.0 * plan.length, "case {case}: at {place}");
        let heights: Vec<Real> = wheels.iter().map(|wheel| wheel.contact.unwrap().point.y).collect();
        assert!(heights.iter().all(|height| (height - high).abs() < 0.02 * high), "case {case}: {heights:?}");
    }
}

/// What a ray in the middle of the wheel does not see, a ball and a cylinder do.
#[test]
fn round_wheels_meet_what_is_before_them() {
    let highest = |probe| {
        let mut world = World::new();
        spawn_ground(&mut world);
        let plan = VehiclePlan { probe, ..VehiclePlan::car(4.5, 1500.0) };
        // A bar under the front wheels, 10 cm ahead of their middle.
        let front = plan.wheelbase * plan.front_load + 0.1;
        let bar = RigidBody::new(Shape::cuboid([2.0, 0.05, 0.01])).fixed().position(Vec3::new(0.0, 0.05, front));
        bar.build().unwrap().spawn(&mut world);
        let car = plan.spawn(&mut world, Pose::default()).unwrap();
        let simulation = Simulation::new(Settings::default()).unwrap();
        tumble_vehicle::drive_vehicles(&mut world, &simulation);
        let state = *world.get::<&VehicleState>(car).unwrap();
        state.wheels().iter().map(|wheel| wheel.compression).fold(0.0, Real::max)
    };
    let plain = VehiclePlan::car(4.5, 1500.0).static_deflection();
    assert!((highest(Probe::Ray) - plain).abs() < 1e-4);
    // The circle of the wheel over an edge that is 10 cm high, and 9 cm ahead.
    let lifted = 0.1 + (0.315_f64.powi(2) - 0.09_f64.powi(2)).sqrt() - 0.315;
    for probe in [Probe::Sphere, Probe::Cylinder] {
        let found = highest(probe) - plain;
        assert!((f64::from(found) - lifted).abs() < 1e-4, "{probe:?}: {found} and not {lifted}");
    }
}

/// A wall beside the wheels is no ground: a ball of the wheel's radius would meet it.
#[test]
fn a_wall_beside_the_wheels_is_no_ground() {
    for probe in [Probe::Ray, Probe::Sphere, Probe::Cylinder] {
        let plan = VehiclePlan { probe, ..VehiclePlan::car(4.5, 1500.0) };
        let mut course = Course::flat(&plan, 1.0 / 60.0);
        let beside = 0.5 * plan.width + 0.2;
        let wall = RigidBody::new(Shape::cuboid([0.1, 2.0, 10.0])).fixed().position(Vec3::X * (beside + 0.02));
        wall.build().unwrap().spawn(&mut course.world);
        let before = course.pose().position;
        course.run(5.0);
        assert!((course.pose().position - before).length() < 1e-3, "{probe:?}: at {}", course.pose().position);
    }
}

/// On a steep hill that nothing holds it slides, and does not climb.
#[test]
fn too_steep_a_slope_is_slid_down() {
    let plan = VehiclePlan::car(4.5, 1500.0);
    let slope: Real = 0.95;
    let mut course = Course::on_plane(&plan, 1.0 / 60.0, Quat::from_rotation_x(slope), 0.0);
    course.drive(|input| (input.brake, input.hand_brake) = (1.0, 1.0));
    course.run(2.0);
    // A slope of 0.95 rad is 1.4 to 1, more than the friction of 1.
    let along = Quat::from_rotation_x(slope) * Vec3::Z;
    assert!(course.velocity().linear.dot(along) > 3.0);
}
