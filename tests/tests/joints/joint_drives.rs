//! Promise: motors, servos, springs and friction of joints do what the closed forms say: they hold
//! if and only if they are strong enough, swing at their frequency, sag by load over stiffness,
//! slow down by torque over inertia, stick and slide; any stiffness is stable; momentum is kept.
//!
//! Why: drives of other engines do not hold, or ring. It fails if a drive pulls with the wrong
//! sign or for half the time, or where friction is taken for a damper.

use std::f64::consts::{PI, TAU};

use crate::jointed::*;
use glam::DVec3;
use hecs::Entity;
use tumble::math::Real;
use tumble::{
    Axes, Breakable, Drive, Drives, Joint, JointEvent, JointFriction, Limit, Limits, RigidBody, Shape, Spring,
};
use tumble_tests::{Draw, by_precision, dvec3};

/// A driven rod in a world of its own, with steps of 1/60 s.
fn rig_of_rod(mass: f64, gravity: DVec3, substeps: u32, drives: Vec<Drive>) -> (Rig, Entity, Entity) {
    let mut rig = Rig::new(gravity, 1.0 / 60.0, substeps);
    let (rod, joint) = driven_rod(&mut rig.world, mass, drives);
    (rig, rod, joint)
}

/// Of such a rod about its hinge [kg m^2].
fn moment(mass: f64) -> f64 {
    mass / 3.0
}

#[test]
fn a_motor_holds_if_and_only_if_it_is_strong_enough() {
    for (strength, holds) in [(1.01, true), (0.99, false), (100.0, true)] {
        for mass in [1e-3, 1.0, 1e4] {
            let most = (strength * mass * G * 0.5) as Real;
            let motor = Drive::velocity(Axes::ANGULAR_X, 0.0).with_max_force(most);
            let (mut rig, _, joint) = rig_of_rod(mass, down(), 4, vec![motor]);
            rig.run_to(1.0);
            let load = rig.load(joint);
            println!("{strength} of {mass} kg: {} rad, {} N m", load.values[3], load.torque.z);
            if holds {
                assert!(load.values[3].abs() < 1e-5);
                assert!((f64::from(load.torque.z) / (mass * G * 0.5) - 1.0).abs() < by_precision(2e-5, 1e-9));
            } else {
                // It falls like a rod of a hundredth of its weight, at first: 3 g t^2 / 4.
                let fallen = 0.01 * 0.75 * G;
                assert!((f64::from(load.values[3]) + fallen).abs() < 0.05 * fallen, "{}", load.values[3]);
            }
        }
    }
}

#[test]
fn a_motor_speeds_up_by_its_torque() {
    let motor = Drive::velocity(Axes::ANGULAR_X, 10.0).with_max_force(2.0);
    let (mut rig, rod, _) = rig_of_rod(3.0, DVec3::ZERO, 4, vec![motor]);
    // 2 N m on 1 kg m^2: 10 rad/s after 5 s.
    for step in 1..=290 {
        rig.step();
        let expected = 2.0 * f64::from(step) / 60.0;
        let speed = rig.angular_velocity(rod).z;
        assert!((speed - expected).abs() < by_precision(2e-4, 1e-7), "{speed} of {expected}");
    }
    rig.run_to(6.0);
    assert!((rig.angular_velocity(rod).z - 10.0).abs() < 1e-4);
}

#[test]
fn a_spring_swings_at_its_frequency_and_keeps_its_energy() {
    for hertz in [0.5, 2.0, 8.0] {
        let spring = Drive::position(Axes::ANGULAR_X, 0.0).with_frequency(hertz, 0.0);
        let (mut rig, rod, joint) = rig_of_rod(2.0, DVec3::ZERO, 16, vec![spring]);
        rig.world.get::<&mut tumble::Momentum>(rod).unwrap().linear = real(DVec3::Y * 0.1 * 2.0 * 0.5);
        rig.world.get::<&mut tumble::Momentum>(rod).unwrap().angular = real(DVec3::Z * 0.1 * 2.0 / 12.0);
        let (mut crossings, mut before) = (Vec::new(), 0.0);
        let [mut first, mut last] = [0.0_f64; 2];
        rig.step();
        while crossings.len() < 41 {
            rig.step();
            let now = f64::from(rig.load(joint).values[3]);
            if before < 0.0 && now >= 0.0 {
                crossings.push(rig.simulation.time() - now / (now - before) / 60.0);
            }
            let peak = if crossings.len() < 5 { &mut first } else { &mut last };
            if crossings.len() < 5 || crossings.len() >= 36 {
                *peak = peak.max(now);
            }
            before = now;
        }
        let period = (crossings[40] - crossings[0]) / 40.0;
        // The midpoint rule swings more slowly by (w h)^2 / 12.
        let h = 1.0 / 960.0;
        let slower = (TAU * f64::from(hertz) * h).powi(2) / 12.0;
        println!("{hertz} Hz: period times frequency {}, amplitudes {first} and {last}", period * f64::from(hertz));
        assert!((period * f64::from(hertz) - 1.0 - slower).abs() < 2e-4, "{period}");
        assert!((last / first - 1.0).abs() < 0.02, "{first} {last}");
    }
}

/// An arm of four links of any mass and bend; the outer ones are held by fixed joints or by rigid
/// drives of their hinges. Its inertia about the first hinge is what the frequency is of.
#[test]
fn a_frequency_is_that_of_all_links_that_hang_on_it() {
    for case in 0..12 {
        let mut draw = Draw::new(31, case);
        let hertz = draw.log_between(0.5, 6.0);
        let mut rig = Rig::new(DVec3::ZERO, 1.0 / 60.0, 16);
        let (mut last, mut end, mut joints) = (rig.ground(), ORIGIN, Vec::new());
        for link in 0..4 {
            let length = draw.between(0.2, 0.6);
            let along = DVec3::X * draw.between(0.3, 1.0) + DVec3::Y * draw.between(-1.0, 1.0);
            let along = along.normalize() * length;
            let angle = along.y.atan2(along.x);
            let this = turned(rod(draw.log_between(0.05, 20.0), length, end + along * 0.5), DVec3::Z, angle);
            // All turn about the first hinge at 0.2 rad/s.
            let this = rig.spawn(turning_about(this, end + along * 0.5, ORIGIN, DVec3::Z * 0.2));
            let kind = if link > 0 && case % 2 == 0 { Joint::fixed } else { Joint::hinge };
            joints.push(rig.join_at(kind(last, this), end, DVec3::Z));
            (last, end) = (this, end + along);
        }
        for (link, joint) in joints.iter().enumerate() {
            let servo = Drive::position(Axes::ANGULAR_X, 0.0);
            let spring = servo.with_frequency(hertz as Real, 0.0);
            rig.world.insert_one(*joint, Drives::from(if link == 0 { spring } else { servo })).unwrap();
        }
        let (mut crossings, mut before) = (Vec::new(), 0.0);
        rig.step();
        while crossings.len() < 11 {
            rig.step();
            let now = f64::from(rig.load(joints[0]).values[3]);
            if before < 0.0 && now >= 0.0 {
                crossings.push(rig.simulation.time() - now / (now - before) / 60.0);
            }
            before = now;
        }
        let found = (crossings[10] - crossings[0]) / 10.0 * hertz;
        // The midpoint rule swings more slowly by (w h)^2 / 12.
        let slower = (TAU * hertz / 960.0).powi(2) / 12.0;
        println!("{case}: {hertz:.2} Hz, off by {:.1e}", found - 1.0 - slower);
        assert!((found - 1.0 - slower).abs() < 1e-3, "case {case}, {hertz} Hz: {found}");
    }
}

/// Against its weight, at the speed at which errors are closed, and never past the target.
#[test]
fn a_rigid_servo_goes_straight_there_at_ten_radians_a_second() {
    for (start, target) in [(0.0, 1.0), (0.0, -2.5), (0.0, 0.05), (2.0, -1.0), (-3.0, 3.0)] {
        let servo = Drive::position(Axes::ANGULAR_X, start as Real);
        let (mut rig, _, joint) = rig_of_rod(2.0, down(), 4, vec![servo]);
        rig.run_to(1.0);
        rig.world.insert_one(joint, Drives::from(Drive::position(Axes::ANGULAR_X, target as Real))).unwrap();
        // The shorter way round.
        let way = (target - start + PI).rem_euclid(TAU) - PI;
        for step in 1..=30 {
            rig.step();
            let done = (10.0 * f64::from(step) / 60.0).min(way.abs()) * way.signum();
            let off = (f64::from(rig.load(joint).values[3]) - start - done + PI).rem_euclid(TAU) - PI;
            assert!(off.abs() < by_precision(1e-5, 1e-8), "{start} to {target}, step {step}: off by {off:e}");
        }
    }
}

#[test]
fn a_servo_sags_by_load_over_stiffness() {
    for stiffness in [50.0, 1e3, 1e6] {
        let servo = Drive::position(Axes::ANGULAR_X, 0.3).with_stiffness(stiffness, stiffness * 0.2);
        let (mut rig, _, joint) = rig_of_rod(2.0, down(), 4, vec![servo]);
        rig.run_to(8.0);
        let angle = f64::from(rig.load(joint).values[3]);
        let expected = -2.0 * G * 0.5 * angle.cos() / f64::from(stiffness);
        println!("{stiffness} N m/rad: {} of {expected}", angle - 0.3);
        assert!((angle - 0.3 - expected).abs() < by_precision(3e-6, 1e-9), "{angle}");
    }
}

#[test]
fn any_stiffness_is_stable() {
    let mut draw = Draw::new(11, 0);
    for _ in 0..200 {
        let (stiffness, damping) = (draw.log_between(1e-3, 1e14), draw.log_between(1e-6, 1e12));
        let most = if draw.often(0.3) { draw.log_between(1e-3, 1e6) } else { f64::INFINITY };
        let target = draw.between(-3.0, 3.0);
        let servo = Drive::position(Axes::ANGULAR_X, target as Real);
        let servo = servo.with_stiffness(stiffness as Real, damping as Real).with_max_force(most as Real);
        let mass = draw.log_between(1e-3, 1e3);
        let (mut rig, rod, _) = rig_of_rod(mass, DVec3::ZERO, 4, vec![servo]);
        // There is no more energy than the spring had at first, or the motor's strength over its
        // way.
        let whole = (0.5 * stiffness * target * target).min(most * PI);
        for _ in 0..120 {
            rig.step();
            let kinetic = 0.5 * moment(mass) * rig.angular_velocity(rod).length_squared();
            assert!(kinetic <= whole * 1.001 + 1e-9, "{stiffness} {damping} {most} {mass}: {kinetic} of {whole}");
        }
    }
}

#[test]
fn a_rigid_servo_goes_there_and_limits_have_the_last_word() {
    for (target, limit, expected) in [(1.0, 3.0, 1.0), (2.0, 0.5, 0.5), (-2.5, 1.0, -1.0)] {
        let servo = Drive::position(Axes::ANGULAR_X, target);
        let (mut rig, _, joint) = rig_of_rod(2.0, down(), 4, vec![servo]);
        rig.world.insert_one(joint, Limits::along(Axes::ANGULAR_X, Limit::new(-limit, limit))).unwrap();
        rig.run_to(2.0);
        let load = rig.load(joint);
        assert!((load.values[3] - expected).abs() < 1e-5, "{} of {expected}", load.values[3]);
        assert!(load.speeds[3].abs() < 1e-4, "{}", load.speeds[3]);
        // A motor of finite strength does not move the limit either, and can be turned back.
        let motor = Drive::velocity(Axes::ANGULAR_X, 3.0 * expected.signum()).with_max_force(500.0);
        rig.world.insert_one(joint, Drives::from(motor)).unwrap();
        rig.run_to(4.0);
        let place = rig.load(joint).values[3];
        assert!((place.abs() - limit).abs() < 1e-5, "{place} of {limit}");
        rig.world.insert_one(joint, Drives::from(Drive::velocity(Axes::ANGULAR_X, -place.signum()))).unwrap();
        rig.run_to(4.5);
        let moved = (rig.load(joint).values[3] - place).abs();
        assert!((moved - 0.5).abs() < 1e-4, "{moved}");
    }
}

#[test]
fn what_is_driven_and_flies_keeps_its_momentum() {
    let mut draw = Draw::new(29, 0);
    for _ in 0..40 {
        let mut rig = Rig::new(DVec3::ZERO, 1.0 / 60.0, 4);
        let ratio = draw.log_between(1e-2, 1e2);
        let bodies = [1.0, ratio].map(|mass| {
            let at = draw.vector(1.0);
            rig.spawn(
                rod(mass, 1.0, at).angular_velocity(real(draw.vector(3.0))).linear_velocity(real(draw.vector(1.0))),
            )
        });
        let at = draw.vector(1.0);
        let axis = draw.direction();
        let joint = rig.join_at(Joint::hinge(bodies[0], bodies[1]), at, axis);
        let motor = Drive::velocity(Axes::ANGULAR_X, draw.between(-5.0, 5.0) as Real).with_max_force(3.0);
        let spring = Drive::position(Axes::ANGULAR_X, 0.5).with_frequency(2.0, 0.3);
        rig.world.insert(joint, (Drives(vec![motor, spring]), JointFriction::along(Axes::ANGULAR_X, 0.2))).unwrap();
        let before = rig.totals();
        rig.run_to(2.0);
        let after = rig.totals();
        let linear = (before.linear_momentum - after.linear_momentum).length();
        let angular = (before.angular_momentum - after.angular_momentum).length();
        let size = before.linear_momentum.length() + before.angular_momentum.length() + ratio;
        assert!(linear < by_precision(3e-6, 1e-13) * size, "{linear}");
        assert!(angular < by_precision(2e-5, 1e-12) * size, "{angular}");
    }
}

#[test]
fn three_springs_of_a_ball_pull_straight_back() {
    // Isotropic: a sphere turned about any axis swings about that axis alone.
    let mut draw = Draw::new(2, 0);
    for _ in 0..20 {
        let mut rig = Rig::new(DVec3::ZERO, 1.0 / 60.0, 8);
        let ground = rig.ground();
        let sphere = rig.spawn(body(2.0, DVec3::splat(0.5), ORIGIN));
        let joint = rig.join(Joint::ball(ground, sphere));
        let target = draw.vector(1.0);
        let drives = [Axes::ANGULAR_X, Axes::ANGULAR_Y, Axes::ANGULAR_Z].map(|axis| {
            let place = match axis {
                Axes::ANGULAR_X => target.x,
                Axes::ANGULAR_Y => target.y,
                _ => target.z,
            };
            // Of 1 Hz on 0.5 kg m^2.
            Drive::position(axis, place as Real).with_stiffness((0.5 * TAU * TAU) as Real, 0.0)
        });
        rig.world.insert_one(joint, Drives(drives.to_vec())).unwrap();
        for _ in 0..25 {
            rig.step();
            let along = rig.angular_velocity(sphere);
            assert!(along.cross(target).length() < 1e-4 * target.length(), "{along} of {target}");
        }
        // After half a period it is as far on the other side: twice the target.
        rig.run_to(0.5);
        let turned = tumble_tests::dquat(tumble::math::Quat::from_scaled_axis(real(target * 2.0)));
        assert!(rig.orientation(sphere).angle_between(turned) < 0.01);
    }
}

#[test]
fn friction_slows_down_by_torque_over_inertia_and_then_holds() {
    for mass in [1e-2, 1.0, 1e3] {
        let (mut rig, rod, joint) = rig_of_rod(mass, DVec3::ZERO, 4, Vec::new());
        let torque = moment(mass) * 4.0;
        rig.world.insert_one(joint, JointFriction::along(Axes::ANGULAR_X, torque as Real)).unwrap();
        rig.world.get::<&mut tumble::Momentum>(rod).unwrap().linear = real(DVec3::Y * 3.0 * mass);
        rig.world.get::<&mut tumble::Momentum>(rod).unwrap().angular = real(DVec3::Z * 6.0 * mass / 12.0);
        // From 6 rad/s by 4 rad/s^2.
        for step in 1..=88 {
            rig.step();
            let expected = 6.0 - 4.0 * f64::from(step) / 60.0;
            let speed = rig.angular_velocity(rod).z;
            assert!((speed - expected).abs() < 2e-4, "{mass} kg: {speed} of {expected}");
        }
        rig.run_to(1.6);
        let place = rig.load(joint).values[3];
        rig.run_to(8.0);
        assert!(rig.angular_velocity(rod).z.abs() < 1e-6);
        assert!((rig.load(joint).values[3] - place).abs() < 1e-6);
    }
}

#[test]
fn a_slide_sticks_and_slides_on_a_slope() {
    // On a slope of 30 degrees a block of 2 kg weighs 9.81 N along it.
    let slope = DVec3::new(0.75_f64.sqrt(), -0.5, 0.0);
    for (friction, acceleration) in [(9.9, 0.0), (9.7, 0.055), (5.0, 2.405), (0.0, 4.905)] {
        let mut rig = Rig::new(down(), 1.0 / 60.0, 4);
        let ground = rig.ground();
        let block = rig.spawn(RigidBody::new(Shape::cuboid([0.1; 3])).without_collider().mass(2.0));
        let joint = rig.join_at(Joint::slider(ground, block), ORIGIN, slope);
        rig.world.insert_one(joint, JointFriction::along(Axes::LINEAR_X, friction)).unwrap();
        rig.run_to(2.0);
        let way = f64::from(rig.load(joint).values[0]);
        println!("{friction} N: {way} m of {}", 2.0 * acceleration);
        assert!((way - 2.0 * acceleration).abs() < 1e-4 + 2e-3 * acceleration, "{way}");
        assert!((f64::from(rig.load(joint).speeds[0]) - 2.0 * acceleration).abs() < 1e-4 + 1e-4 * acceleration);
    }
}

#[test]
fn a_rope_breaks_by_the_load_of_the_swing() {
    // From level the load at the lowest point is 3 m g.
    for (strength, breaks) in [(2.97, true), (3.03, false)] {
        let mut rig = Rig::new(down(), 1.0 / 60.0, 8);
        let ground = rig.ground();
        let ball = rig.spawn(RigidBody::new(Shape::sphere(0.05)).without_collider().mass(2.0).position(real(DVec3::X)));
        let joint = rig.join(Joint::free(ground, ball));
        let rope = (Limits::rope(1.0), Breakable::at_force((strength * 2.0 * G) as Real));
        rig.world.insert(joint, rope).unwrap();
        let mut broke_at = None;
        for _ in 0..60 {
            rig.step();
            let events: Vec<_> = rig.simulation.joint_events().collect();
            if !events.is_empty() {
                assert_eq!(events, [JointEvent::Broke(joint)]);
                assert!(broke_at.replace(rig.position(ball)).is_none(), "it broke twice");
            }
        }
        assert_eq!(broke_at.is_some(), breaks, "{strength}");
        assert_eq!(rig.world.get::<&Breakable>(joint).unwrap().is_broken, breaks);
        if let Some(at) = broke_at {
            assert!((angle_from_down(at)).abs() < 0.25, "{at}");
            assert!(rig.position(ball).length() > 1.2);
        } else {
            assert!(rig.position(ball).length() < 1.001);
        }
    }
}

#[test]
fn a_broken_joint_can_be_mended_and_many_steps_are_single_steps() {
    let run = |at_once: bool| {
        let mut rig = Rig::new(down(), 1.0 / 60.0, 4);
        let ground = rig.ground();
        let ball = rig.spawn(RigidBody::new(Shape::sphere(0.05)).without_collider().mass(2.0).position(real(DVec3::X)));
        let joint = rig.join_at(Joint::ball(ground, ball), ORIGIN, DVec3::X);
        rig.world.insert_one(joint, Breakable::at_force((2.5 * 2.0 * G) as Real)).unwrap();
        if at_once {
            rig.simulation.step_many(&mut rig.world, 60);
        } else {
            (0..60).for_each(|_| rig.step());
        }
        assert!(rig.world.get::<&Breakable>(joint).unwrap().is_broken);
        (rig, ball, joint)
    };
    let (mut rig, ball, joint) = run(false);
    let (other, same, _) = run(true);
    assert_eq!(rig.position(ball), other.position(same));
    // Mended it pulls the ball back, as a joint that does not fit.
    rig.world.get::<&mut Breakable>(joint).unwrap().is_broken = false;
    rig.world.get::<&mut Breakable>(joint).unwrap().max_force = Real::INFINITY;
    rig.run_to(6.0);
    assert!((rig.position(ball).length() - 1.0).abs() < 1e-4, "{}", rig.position(ball).length());
}

#[test]
fn what_a_drive_does_is_booked() {
    // The works of joints over all bodies are the change of kinetic energy: nothing else acts.
    let motor = Drive::velocity(Axes::ANGULAR_X, 4.0).with_max_force(3.0);
    let (mut rig, rod, _) = rig_of_rod(3.0, DVec3::ZERO, 4, vec![motor]);
    rig.world.insert_one(rod, tumble::Work::default()).unwrap();
    rig.run_to(2.0);
    let work = f64::from(rig.world.get::<&tumble::Work>(rod).unwrap().joints);
    let kinetic = 0.5 * rig.angular_velocity(rod).z.powi(2);
    assert!((work - kinetic).abs() < by_precision(1e-4, 1e-10) * kinetic, "{work} of {kinetic}");
    assert!((dvec3(rig.world.get::<&tumble::Velocity>(rod).unwrap().angular).z - 4.0).abs() < 1e-4);
}

/// Infinite friction beside a motor of a finite force: nothing moves, and no impulse is infinite.
#[test]
fn infinite_friction_holds_against_a_motor() {
    for most in [0.0, 3.0, 1e6] {
        let motor = Drive::velocity(Axes::ANGULAR_X, 4.0).with_max_force(most);
        let (mut rig, rod, joint) = rig_of_rod(3.0, down(), 4, vec![motor]);
        let mut friction = JointFriction::default();
        friction.max[3] = Real::INFINITY;
        rig.world.insert_one(joint, friction).unwrap();
        rig.run_to(1.0);
        let load = rig.load(joint);
        assert!(load.values[3].abs() < 1e-4 && rig.angular_velocity(rod).length() < 1e-4, "{load:?}");
        assert!((f64::from(load.torque.z) / (3.0 * G * 0.5) - 1.0).abs() < 1e-4, "{load:?}");
    }
}

/// What is read of joints that do nothing is forgotten with the last joint, in a world that has
/// other things to solve.
#[test]
fn the_last_joint_breaks_and_goes() {
    let mut rig = Rig::new(down(), 1.0 / 60.0, 4);
    let ground = rig.ground();
    let ball = |at: f64| RigidBody::new(Shape::sphere(0.05)).without_collider().mass(2.0).position(real(DVec3::X * at));
    let (held, other) = (rig.spawn(ball(1.0)), rig.spawn(ball(3.0)));
    rig.world.spawn((Spring::between(ground, other).with_stiffness(100.0).with_rest_length(1.0),));
    let joint = rig.join_at(Joint::ball(ground, held), ORIGIN, DVec3::X);
    rig.world.insert_one(joint, Breakable::at_force(1e-3)).unwrap();
    rig.run_to(0.1);
    assert!(rig.world.get::<&Breakable>(joint).unwrap().is_broken);
    rig.world.despawn(joint).unwrap();
    rig.run_to(1.0);
    assert!(rig.position(held).is_finite() && rig.position(held).y < -1.0);
}
