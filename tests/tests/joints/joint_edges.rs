//! Promise: where an option of a joint has no sense, it alone does nothing: a rope at its own
//! anchor, a held twist of a ball that is bent back, a gear of a ball, a spring of a frequency at a
//! point that does not turn, limits that are far away from what a drive is to hold, and a universal
//! joint whose axes are the same.
//!
//! Why: such states are rare in tests and common in games, and one number that is not finite takes
//! a whole mechanism with it. It fails if a row acts by a value that it does not have.

use crate::jointed::*;
use glam::{DQuat, DVec3};
use tumble::math::Real;
use tumble::{
    Axes, Cone, Drive, Drives, Gain, Gear, Joint, JointFriction, JointLoad, Limit, Limits, Momentum, RigidBody, Shape,
};
use tumble_tests::references::real_quat;
use tumble_tests::{Draw, by_precision};

/// What flies through the anchor of its rope, however near, is not held by it.
#[test]
fn a_rope_lets_through_what_passes_its_anchor() {
    for case in 0..60 {
        let mut draw = Draw::new(0x94, case);
        let (length, speed) = (draw.log_between(0.1, 100.0), draw.log_between(0.01, 50.0));
        let mut rig = Rig::new(DVec3::ZERO, 1.0 / draw.between(10.0, 240.0), 4);
        let hook = rig.ground();
        let (way, miss) = (draw.direction(), draw.direction() * length * draw.between(0.0, 1e-3));
        // It comes through the middle of a substep of any step.
        let reach = (0.4 * length).min(speed);
        let flier = body(draw.log_between(1e-3, 1e3), DVec3::ONE, miss - way * reach);
        let flier = rig.spawn(flier.linear_velocity(real(way * speed)));
        let rope = Joint::free(hook, flier);
        let limits = if draw.often(0.5) { Limits::rope(length as Real) } else { soft_rope(length) };
        let joint = rig.world.spawn((rope, limits, JointLoad::default()));
        let end = rig.simulation.time() + 1.8 * reach / speed;
        let start = rig.velocity(flier);
        while rig.simulation.time() < end {
            rig.step();
            assert_eq!(rig.velocity(flier), start, "case {case}, {speed} m/s");
            assert_eq!(rig.load(joint).force, real(DVec3::ZERO), "case {case}");
        }
    }
}

/// A rope that gives way.
fn soft_rope(length: f64) -> Limits {
    let range = Limit::new(0.0, length as Real).with_stiffness(1e5, 1e3);
    Limits { distance: Some(range), ..Limits::default() }
}

/// A ball whose twist is held, bent to where it has none: the other joints of its mechanism hold.
#[test]
fn joints_hold_where_a_held_twist_has_no_value() {
    for case in 0..24 {
        let mut draw = Draw::new(0x95, case);
        let mut rig = Rig::new(down(), 1.0 / 60.0, 1 + (case as u32 % 4) * 3);
        let base = rig.ground();
        let bend = draw.between(144.0, 179.0).to_radians();
        let turn = DQuat::from_axis_angle(draw.direction().cross(DVec3::X).normalize(), bend);
        let first = rig.spawn(body(1.0, DVec3::splat(0.1), DVec3::Y).orientation(real_quat(turn)));
        let arm = turn.inverse() * DVec3::NEG_Y;
        let ball =
            Joint::ball(base, first).with_frames(frame(DVec3::ZERO, DQuat::IDENTITY), frame(arm, DQuat::IDENTITY));
        rig.world.spawn((ball, Limits::along(Axes::ANGULAR_X, Limit::new(0.3, 0.3)), JointLoad::default()));
        let second = rig.spawn(body(1.0, DVec3::splat(0.1), DVec3::Y * 2.0));
        rig.join_at(Joint::ball(first, second), DVec3::Y * 1.5, DVec3::Y);
        for step in 0..120 {
            rig.step();
            let gap = rig.largest_gap();
            assert!(gap < by_precision(2e-5, 1e-6), "case {case}: {gap:e} m apart after {step} steps");
        }
    }
}

/// Its rows have no angle to gear, whichever axis is named.
#[test]
fn a_gear_of_a_ball_does_nothing() {
    for axes in [Axes::NONE, Axes::ANGULAR_X, Axes::ANGULAR_Y, Axes::ANGULAR_Z] {
        let spins = [false, true].map(|is_geared| {
            let mut rig = Rig::new(down(), 1.0 / 60.0, 4);
            let base = rig.ground();
            let wheel = rig.spawn(rod(1.0, 1.0, DVec3::ZERO).angular_velocity(real(DVec3::Z * 3.0)));
            let hinge = rig.join_at(Joint::hinge(base, wheel), ORIGIN, DVec3::Z);
            let hung = rig.spawn(rod(2.0, 1.0, DVec3::X * 3.5));
            let ball = rig.join_at(Joint::ball(base, hung), DVec3::X * 3.0, DVec3::X);
            if is_geared {
                let gear = Gear { axes: [Axes::NONE, axes], ..Gear::new(hinge, ball, 2.0) };
                rig.world.spawn((gear,));
            }
            rig.run_to(1.0);
            (rig.angular_velocity(wheel), rig.angular_velocity(hung))
        });
        assert_eq!(spins[0], spins[1], "{axes:?}");
    }
}

/// Soft limits of a frequency have no mass to count with where nothing turns.
#[test]
fn a_point_on_a_ball_with_soft_limits_stays_on_it() {
    let soft = Gain::Frequency { hertz: 5.0, damping_ratio: 0.5 };
    let cone = Cone { half_angles: [0.2; 2], gain: soft };
    let twist = Limits::along(Axes::ANGULAR_X, Limit { gain: soft, ..Limit::new(-0.1, 0.1) });
    for limits in [Limits { cone: Some(cone), ..Limits::default() }, twist] {
        let mut rig = Rig::new(down(), 1.0 / 60.0, 4);
        let base = rig.ground();
        let point = rig.spawn(RigidBody::new(Shape::Point).mass(1.0));
        // Past both limits.
        let bent = DQuat::from_rotation_x(0.5) * DQuat::from_rotation_y(0.5);
        let frames = [DQuat::IDENTITY, bent].map(|orientation| frame(ORIGIN, orientation));
        rig.world.spawn((Joint::ball(base, point).with_frames(frames[0], frames[1]), limits));
        let hung = rig.spawn(rod(1.0, 1.0, DVec3::X * 0.5));
        rig.join_at(Joint::ball(point, hung), ORIGIN, DVec3::X);
        for _ in 0..120 {
            rig.step();
            assert!(rig.largest_gap() < by_precision(1e-6, 1e-9), "{limits:?}: {:e}", rig.largest_gap());
            // Its joint has no arms and no size of its own that rounding would be large against.
            assert_eq!(rig.simulation.joint_substeps(), 4, "{limits:?}");
        }
    }
}

/// What hangs loose on a driven link does not make it heavier for the drive, limited or not.
#[test]
fn limits_that_are_not_reached_do_not_change_a_servo() {
    let mut worst = 0.0_f64;
    for case in 0..24 {
        let mut draw = Draw::new(0x96, case);
        let (mass, hertz) = (draw.log_between(1e-2, 1e2), draw.between(0.5, 5.0));
        let [free, limited] = [false, true].map(|is_limited| {
            let mut rig = Rig::new(DVec3::ZERO, 1.0 / 120.0, 4);
            let base = rig.ground();
            let upper = rig.spawn(rod(1.0, 1.0, DVec3::X * 0.5));
            let shoulder = rig.join_at(Joint::hinge(base, upper), ORIGIN, DVec3::Z);
            let servo = Drive::position(Axes::ANGULAR_X, 0.0).with_frequency(hertz as Real, 0.0);
            rig.world.insert_one(shoulder, Drives(vec![servo])).unwrap();
            let lower = rig.spawn(rod(mass, 1.0, DVec3::X * 1.5));
            let elbow = rig.join_at(Joint::hinge(upper, lower), DVec3::X, DVec3::Z);
            if is_limited {
                let limits = Limits::along(Axes::ANGULAR_X, Limit::new(-3.0, 3.0));
                let friction = JointFriction::along(Axes::ANGULAR_X, 1e-9);
                rig.world.insert(elbow, (limits, friction)).unwrap();
            }
            rig.world.get::<&mut Momentum>(lower).unwrap().linear = real(DVec3::Y * 0.05 * mass);
            rig.run_to(1.0);
            rig.position(lower)
        });
        worst = worst.max((free - limited).length());
    }
    println!("{worst:e} m apart");
    assert!(worst < by_precision(1e-4, 1e-6), "{worst:e}");
}

/// However its axes are turned against each other, from rest it closes without throwing the body.
#[test]
fn a_universal_joint_that_does_not_fit_throws_nothing() {
    for case in 0..80 {
        let mut draw = Draw::new(0x97, case);
        let off = if case % 4 == 0 { 90.0 } else { draw.between(0.0, 90.0) };
        let turned = DQuat::from_rotation_z(f64::to_radians(off)) * DQuat::from_rotation_y(draw.between(-1.0, 1.0));
        let at = draw.direction() * draw.between(0.0, 0.5);
        let mut rig = Rig::new(ORIGIN, 1.0 / draw.between(30.0, 240.0), 4);
        let base = rig.ground();
        let it = rig
            .spawn(RigidBody::new(Shape::cuboid([0.3, 0.2, 0.1])).without_collider().mass(draw.log_between(1e-3, 1e3)));
        let joint = Joint::universal(base, it).with_frames(frame(at, turned), frame(at, DQuat::IDENTITY));
        let joint = rig.join(joint);
        let mut fastest = 0.0_f64;
        for _ in 0..400 {
            rig.step();
            fastest = fastest.max(rig.velocity(it).length());
        }
        assert!(fastest < 10.0, "case {case}, {off} degrees: {fastest} m/s");
        let cosine = rig.load(joint).values[5].abs();
        // Axes that are the same have no way to go.
        assert!(cosine < 1e-4 || off > 89.99, "case {case}, {off} degrees: {cosine}");
    }
}
