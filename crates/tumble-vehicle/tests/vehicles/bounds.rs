//! Promise: whatever is driven over, no tyre pulls harder than its friction allows, and nothing
//! but the motor makes energy.

use tumble::math::{Real, Vec3};
use tumble_vehicle::VehicleInput;

use crate::course::{Course, Draw, settling};

fn random_input(draw: &mut Draw, throttle: f64) -> VehicleInput {
    VehicleInput {
        throttle: draw.real(-throttle, throttle),
        brake: draw.real(-2.0, 1.0),
        hand_brake: draw.real(-3.0, 1.0),
        steering: draw.real(-1.0, 1.0),
    }
}

/// Each step of random drives over hills: forces within the friction ellipse of the load, loads not
/// negative, and wheels at their compressions within reach.
#[test]
fn no_force_is_more_than_friction_times_load() {
    for case in 0..24 {
        let mut draw = Draw::new(40, case);
        let (mut plan, dt) = (draw.plan(), draw.dt());
        plan.probe = draw.probe();
        let height = draw.between(0.02, 0.3) * f64::from(plan.length);
        let mut course = Course::on_hills(&plan, dt, &mut draw, height, [24, 48]);
        let friction = f64::from(plan.friction);
        for step in 0..600 {
            if step % 40 == 0 {
                let input = random_input(&mut draw, 1.0);
                course.drive(|it| *it = input);
            }
            course.step();
            for wheel in course.wheels() {
                let (along, across) = (f64::from(wheel.longitudinal_force), f64::from(wheel.lateral_force));
                let load = f64::from(wheel.load);
                let force = along.hypot(across);
                assert!(load >= 0.0 && force <= 1.000_01 * friction * load, "case {case}: {force} N at {load} N");
                assert!(wheel.spin.is_finite() && wheel.compression >= 0.0, "case {case}: {wheel:?}");
                assert_eq!(load == 0.0, wheel.contact.is_none(), "case {case}: a load is a contact");
            }
        }
    }
}

/// Without throttle, over hills and with random steering and brakes: the energy of body, wheels,
/// height and springs is never above what it was at any time before.
#[test]
fn nothing_but_the_motor_makes_energy() {
    let mut worst = 0.0_f64;
    for case in 0..32 {
        let mut draw = Draw::new(41, case);
        let (plan, dt) = (draw.plan(), draw.dt());
        let height = draw.between(0.0, 0.15) * f64::from(plan.length);
        let mut course = Course::on_hills(&plan, dt, &mut draw, height, [24, 60]);
        course.run(settling(&plan));
        course.launch(&plan, draw.real(0.0, 30.0) * (plan.length / 4.5).sqrt());
        course.step();
        let mut least = course.energy();
        let kinetic = 0.5 * f64::from(plan.mass) * f64::from(course.velocity().linear.length_squared());
        let scale = kinetic + f64::from(plan.mass * 9.81 * plan.length) * 0.1;
        for step in 0..500 {
            if step % 30 == 0 {
                let input = random_input(&mut draw, 0.0);
                course.drive(|it| *it = input);
            }
            course.step();
            if course.above_ground().is_none() {
                break;
            }
            let energy = course.energy();
            worst = worst.max((energy - least) / scale);
            least = least.min(energy);
        }
    }
    // What is in the shear of the tyres is not in the sum.
    assert!(worst < 5e-3, "gained {worst} of its energy");
}

/// Dropped from any height, at any step: no bounce higher than it fell, and no force that would
/// throw it up again.
#[test]
fn a_fall_ends_on_the_wheels() {
    for case in 0..24 {
        let (mut draw, plan, mut course) = Course::drawn(42, case);
        let fall = draw.log_between(0.05, 3.0) as Real * plan.length;
        let start = course.pose().position + Vec3::Y * fall;
        course.world.get::<&mut tumble::Pose>(course.vehicle).unwrap().position = start;
        let (mut least, mut rebound) = (start.y, 0.0 as Real);
        let time = (2.0 * f64::from(fall) / 9.81).sqrt() + 2.0 * settling(&plan);
        for _ in 0..course.steps(time) {
            course.step();
            let height = course.pose().position.y;
            least = least.min(height);
            rebound = rebound.max(height - least);
        }
        assert!(rebound < 0.5 * (start.y - least), "case {case}: fell {fall} m, bounced {rebound} m");
        let velocity = course.velocity().linear.length();
        assert!(velocity < 0.02 * plan.length, "case {case}: still moves at {velocity} m/s");
        assert!((course.pose().orientation * Vec3::Y).y > 0.999, "case {case}: does not stand");
    }
}
