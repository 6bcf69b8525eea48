//! Promise: limits of joints hold, carry what the closed form says, and make no energy: ranges of
//! hinges and sliders, ropes, rods, round and elliptic cones, twists near half a turn, soft limits,
//! and an arm of which every joint rests on its limit.
//!
//! Why: limits solved apart from joints sink or shake under load. It fails if a bound is taken with
//! the wrong sign, on the wrong side, or is met a substep late.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::jointed::*;
use glam::{DQuat, DVec3};
use hecs::Entity;
use tumble::math::Real;
use tumble::{Axes, Cone, Gain, Joint, Limit, Limits, RigidBody, Shape};
use tumble_tests::{Draw, by_precision, dvec3};

fn limit(min: f64, max: f64) -> Limit {
    Limit::new(min as Real, max as Real)
}

fn pick<T: Copy, const N: usize>(draw: &mut Draw, from: [T; N]) -> T {
    from[(draw.between(0.0, N as f64) as usize).min(N - 1)]
}

/// A rod of 1 m on a hinge about z at the origin, level at first, which may fall to an angle.
fn rod_on_a_limit(mass: f64, lower: f64) -> (Rig, Entity) {
    let mut rig = Rig::new(down(), 1.0 / 60.0, 4);
    let ground = rig.ground();
    let rod = rig.spawn(rod(mass, 1.0, DVec3::X * 0.5));
    let joint = rig.join_at(Joint::hinge(ground, rod), ORIGIN, DVec3::Z);
    rig.world.insert_one(joint, Limits::along(Axes::ANGULAR_X, limit(lower, 1.0))).unwrap();
    (rig, joint)
}

#[test]
fn a_rod_rests_on_its_limit() {
    for (mass, lower) in [(1.0, -0.4), (1e-3, -1.2), (1e5, 0.0), (40.0, -1.5)] {
        let (mut rig, joint) = rod_on_a_limit(mass, lower);
        rig.run_to(3.0);
        let load = rig.load(joint);
        let expected = mass * G * 0.5 * lower.cos();
        let off = (f64::from(load.torque.z) - expected) / (mass * G * 0.5);
        let past = f64::from(load.values[3]) - lower;
        println!("{mass} kg at {lower}: torque off by {off:.1e}, past by {past:.1e}, speed {:.1e}", load.speeds[3]);
        assert!(off.abs() < by_precision(2e-5, 1e-10), "{off}");
        assert!(past.abs() < by_precision(2e-6, 1e-9), "{past}");
        assert!(load.speeds[3].abs() < by_precision(2e-5, 1e-9) as Real);
    }
}

/// A hinge or a slider with a range, thrown about: how far past it comes, how much its energy grows
/// over the whole there is, and how far it turns in a substep \[rad\].
fn thrown_about(draw: &mut Draw, is_slider: bool) -> [f64; 3] {
    let size = draw.log_between(0.01, 100.0);
    let rate = pick(draw, [10.0, 30.0, 60.0, 240.0]);
    let mut rig = Rig::new(down() * draw.between(0.0, 2.0), 1.0 / rate, pick(draw, [1, 4, 16]));
    let ground = rig.ground();
    let mass = draw.log_between(1e-3, 1e3);
    let direction = draw.direction();
    let speed = draw.log_between(0.1, 20.0);
    let axis = draw.direction();
    let body = rod(mass, size, direction * 0.5 * size);
    let [joint, body] = if is_slider {
        let body = rig.spawn(body.linear_velocity(real(axis * speed)));
        [rig.join_at(Joint::slider(ground, body), ORIGIN, axis), body]
    } else {
        let body = rig.spawn(turning_about(body, direction * 0.5 * size, ORIGIN, axis * (speed / size)));
        [rig.join_at(Joint::hinge(ground, body), ORIGIN, axis), body]
    };
    let scale = if is_slider { size } else { 1.0 };
    let [low, high] = [-draw.between(0.0, 3.0), draw.between(0.0, 3.0)].map(|bound| bound * scale);
    let number = if is_slider { Axes::LINEAR_X } else { Axes::ANGULAR_X };
    rig.world.insert_one(joint, Limits::along(number, limit(low, high))).unwrap();
    let begin = rig.energy();
    let whole = begin.abs() + mass * speed * speed + mass * G * size * 4.0;
    let h = f64::from(rig.simulation.settings().contact_substep());
    let [mut past, mut gain, mut turn] = [0.0, 0.0, if is_slider { 0.0 } else { speed / size * h }];
    for _ in 0..(2.0 * rate) as usize {
        rig.step();
        let value = f64::from(rig.load(joint).values[if is_slider { 0 } else { 3 }]);
        past = past.max((low - value).max(value - high) / scale);
        gain = gain.max((rig.energy() - begin) / whole);
        turn = turn.max(rig.angular_velocity(body).length() * h);
        assert!(rig.position(body).is_finite());
    }
    [past, gain, turn]
}

#[test]
fn ranges_hold_at_any_size_speed_and_rate() {
    for is_slider in [false, true] {
        let mut draw = Draw::new(41, 0);
        let [mut past, mut gain] = [0.0_f64; 2];
        for _ in 0..300 {
            let [this_past, this_gain, turn] = thrown_about(&mut draw, is_slider);
            // What turns by more may go past by something of that.
            past = past.max(if turn < 0.5 { this_past } else { this_past - turn });
            gain = gain.max(this_gain);
        }
        println!("slider {is_slider}: past by {past:.1e}, energy gained {gain:.1e}");
        assert!(past < by_precision(1e-5, 1e-8), "{past}");
        assert!(gain < by_precision(1e-4, 1e-4), "{gain}");
    }
}

#[test]
fn a_twist_stops_just_short_of_half_a_turn() {
    for is_ball in [false, true] {
        for way in [1.0, -1.0] {
            let mut rig = Rig::new(DVec3::ZERO, 1.0 / 60.0, 4);
            let ground = rig.ground();
            let disc = body(2.0, DVec3::new(0.4, 0.2, 0.2), ORIGIN).angular_velocity(real(DVec3::X * 9.0 * way));
            let disc = rig.spawn(disc);
            let kind = if is_ball { Joint::ball } else { Joint::hinge };
            let joint = rig.join_at(kind(ground, disc), ORIGIN, DVec3::X);
            let bound = 179.0_f64.to_radians();
            rig.world.insert_one(joint, Limits::along(Axes::ANGULAR_X, limit(-bound, bound))).unwrap();
            rig.run_to(2.0);
            let value = f64::from(rig.load(joint).values[3]);
            assert!((value - bound * way).abs() < 1e-5, "{is_ball} {way}: {value}");
            assert!(rig.angular_velocity(disc).length() < 1e-5);
        }
    }
}

#[test]
fn ranges_of_angles_go_past_half_a_turn() {
    // Of a robot's joint, from just below zero to beyond pi; with no greatest angle; two turns
    // away.
    let turns = 4.0 * PI;
    for (min, max, way) in
        [(-0.0175, 3.7525, 3.7525), (-0.5, f64::INFINITY, PI), (-4.0, 1.0, 1.0), (12.0, 14.0, 14.0 - turns)]
    {
        for is_soft in [false, true] {
            let mut rig = Rig::new(DVec3::ZERO, 1.0 / 60.0, 4);
            let ground = rig.ground();
            let disc = rig.spawn(body(1.0, DVec3::new(0.1, 0.2, 0.25), ORIGIN).angular_velocity(real(DVec3::Z * 0.9)));
            let joint = rig.join_at(Joint::hinge(ground, disc), ORIGIN, DVec3::Z);
            let hard = limit(min, max);
            let limit = if is_soft { hard.with_stiffness(5e4, 5e3) } else { hard };
            rig.world.insert_one(joint, Limits::along(Axes::ANGULAR_X, limit)).unwrap();
            let until = (way.min(PI) - 0.1) / 0.9;
            while rig.simulation.time() < until {
                rig.step();
                let speed = rig.angular_velocity(disc).z;
                assert!((speed - 0.9).abs() < 1e-5, "{min} {max} {is_soft}: {speed}");
            }
            rig.run_to(way / 0.9 + 0.2);
            let place = f64::from(rig.load(joint).values[3]);
            let off = (place - way).abs().min((place - way + 2.0 * PI).abs());
            // A damper stops what would be past the bound in a substep of 0.9 / 240 rad, and lets
            // it go with a hundredth of its speed.
            assert!(off < if is_soft { 0.01 } else { 1e-5 }, "{min} {max} {is_soft}: {place} of {way}");
        }
    }
}

#[test]
fn a_rope_is_slack_and_taut_and_makes_no_energy() {
    let mut draw = Draw::new(5, 0);
    for _ in 0..60 {
        let length = draw.log_between(0.1, 50.0);
        let mut rig = Rig::new(down(), 1.0 / 60.0, 4);
        let ground = rig.ground();
        let begin = draw.direction() * (length * draw.between(0.1, 0.95));
        let ball = rig.spawn(
            RigidBody::new(Shape::sphere((0.05 * length) as Real)).without_collider().mass(3.0).position(real(begin)),
        );
        let joint = rig.join(Joint::free(ground, ball));
        rig.world.insert_one(joint, Limits::rope(length as Real)).unwrap();
        let (mut before, mut is_taut) = (rig.energy(), false);
        for _ in 0..600 {
            rig.step();
            let now = rig.energy();
            let scale = 3.0 * G * length;
            // A taut swing has its energy to (w h)^2 in a step.
            assert!(now < before + 3e-5 * scale, "{length}: {now} after {before}");
            let distance = rig.position(ball).length() / length;
            assert!(distance < 1.0 + by_precision(2e-6, 1e-9), "{length}: {distance}");
            is_taut |= distance > 0.999;
            before = now;
        }
        assert!(is_taut);
    }
}

#[test]
fn a_rod_of_a_limit_is_a_pendulum() {
    // As a point on a rod of 1 m from level: 4 K(1/2) sqrt(l / g).
    let mut rig = Rig::new(down(), 1.0 / 240.0, 1);
    let ground = rig.ground();
    let ball = rig.spawn(RigidBody::new(Shape::Point).mass(2.0).position(real(DVec3::X)));
    let joint = rig.join(Joint::free(ground, ball));
    rig.world.insert_one(joint, Limits::rod(1.0)).unwrap();
    let period = 4.0 * 1.854_074_677_301_372 / G.sqrt();
    rig.run_to(period);
    let off = (rig.position(ball) - DVec3::X).length();
    println!("after a period {off:.1e} m from the start");
    // A step is up to 1/480 s from the period; there the ball is at rest: g t^2 / 2.
    assert!(off < 1e-3, "{off}");
    assert!((rig.energy() / (2.0 * G)).abs() < 1e-4);
}

#[test]
fn a_rod_rests_on_a_cone() {
    // About y it may tilt by 0.6, about z by 0.9: along z and along y, and where it falls between.
    let cone = Cone { half_angles: [0.6, 0.9], gain: Gain::Rigid };
    for (fall, most) in [(DVec3::Z, 0.6_f64), (DVec3::Y, 0.9), (-DVec3::Z, 0.6), (-DVec3::Y, 0.9)] {
        let mut rig = Rig::new(fall * G, 1.0 / 60.0, 4);
        let ground = rig.ground();
        let rod = rig.spawn(rod(3.0, 2.0, DVec3::X));
        let joint = rig.join_at(Joint::ball(ground, rod), ORIGIN, DVec3::X);
        rig.world.insert_one(joint, Limits { cone: Some(cone), ..Limits::default() }).unwrap();
        rig.run_to(4.0);
        let tilt = rig.position(rod).angle_between(DVec3::X);
        let torque = dvec3(rig.load(joint).torque).length();
        let expected = 3.0 * G * most.cos();
        println!("towards {fall}: tilt {tilt} of {most}, torque {torque} of {expected}");
        assert!((tilt - most).abs() < by_precision(1e-5, 1e-7), "{tilt}");
        assert!((torque / expected - 1.0).abs() < by_precision(1e-4, 1e-6), "{torque}");
    }
}

#[test]
fn a_cone_leaves_its_middle_alone() {
    // On its axis to rounding, of which the way to the bound is any.
    for half_angles in [[0.5, 0.5], [0.2, 1.4]] {
        for tilt in [0.0, 1e-18, 1e-12, 1e-7] {
            let mut rig = Rig::new(DVec3::ZERO, 1.0 / 60.0, 4);
            let ground = rig.ground();
            let rod = rig.spawn(turned(rod(1.0, 1.0, ORIGIN), DVec3::Y, tilt).linear_velocity(real(DVec3::X)));
            let joint = rig.join(Joint::free(ground, rod));
            let cone = Cone { half_angles, gain: Gain::Rigid };
            rig.world.insert_one(joint, Limits { cone: Some(cone), ..Limits::default() }).unwrap();
            rig.run_to(1.0);
            assert!((rig.position(rod) - DVec3::X).length() < 1e-5, "{half_angles:?} {tilt}");
        }
    }
}

#[test]
fn nothing_leaves_a_cone() {
    let mut draw = Draw::new(17, 0);
    for round in 0..60 {
        let first = draw.between(0.1, 2.5);
        let is_long = round % 3 == 0;
        let half = [first, if is_long { draw.between(0.1, 2.5) } else { (first * draw.between(0.5, 2.0)).min(2.5) }];
        let mut rig = Rig::new(draw.direction() * G, 1.0 / 60.0, 4);
        let ground = rig.ground();
        let spin = draw.direction() * draw.between(0.0, 8.0);
        let rod = rig.spawn(turning_about(rod(1.0, 1.0, DVec3::X * 0.5), DVec3::X * 0.5, ORIGIN, spin));
        let joint = rig.join_at(Joint::ball(ground, rod), ORIGIN, DVec3::X);
        let half_angles = half.map(|angle| angle as Real);
        let limits = Limits { cone: Some(Cone { half_angles, gain: Gain::Rigid }), ..Limits::default() };
        rig.world.insert_one(joint, limits).unwrap();
        let begin = rig.energy();
        let mut out = 0.0_f64;
        for _ in 0..240 {
            rig.step();
            let x = rig.orientation(rod) * DVec3::X;
            let tangents = [x.y / (1.0 + x.x) / (0.5 * half[1]).tan(), x.z / (1.0 + x.x) / (0.5 * half[0]).tan()];
            out = out.max(tangents[0].hypot(tangents[1]) - 1.0);
            assert!(rig.energy() < begin + 1e-3, "{round}: {} after {begin}", rig.energy());
        }
        // Round the narrow end of a long cone the way back turns by a right angle in a substep.
        let bound = if is_long { 0.01 } else { by_precision(2e-5, 1e-6) };
        assert!(out < bound, "{round} {half:?}: {out}");
    }
}

#[test]
fn a_soft_limit_gives_by_load_over_stiffness() {
    let mut rig = Rig::new(down(), 1.0 / 60.0, 4);
    let ground = rig.ground();
    let block = rig.spawn(RigidBody::new(Shape::cuboid([0.1; 3])).without_collider().mass(50.0));
    let joint = rig.join_at(Joint::slider(ground, block), ORIGIN, DVec3::Y);
    let limits = Limits::along(Axes::LINEAR_X, limit(-0.5, 0.5).with_stiffness(2e4, 800.0));
    rig.world.insert_one(joint, limits).unwrap();
    rig.run_to(5.0);
    let expected = -0.5 - 50.0 * G / 2e4;
    let place = rig.position(block).y;
    assert!((place - expected).abs() < by_precision(1e-6, 1e-9), "{place} of {expected}");
    assert!((f64::from(rig.load(joint).force.y) / (50.0 * G) - 1.0).abs() < by_precision(1e-5, 1e-9));
}

#[test]
fn an_arm_rests_on_its_limits() {
    // Ten links of 1 kg, level, each on the lower bound of its hinge, and a hundred at the end.
    let (links, length, last) = (10, 0.2, 100.0);
    let mut rig = Rig::new(down(), 1.0 / 60.0, 4);
    let mut before = rig.ground();
    let mut root = None;
    for link in 0..links {
        let mass = if link + 1 == links { last } else { 1.0 };
        let this = rig.spawn(rod(mass, length, DVec3::X * length * (f64::from(link) + 0.5)));
        let joint = rig.join_at(Joint::hinge(before, this), DVec3::X * length * f64::from(link), DVec3::Z);
        rig.world.insert_one(joint, Limits::along(Axes::ANGULAR_X, limit(0.0, FRAC_PI_2))).unwrap();
        root.get_or_insert(joint);
        before = this;
    }
    let moment = |link: i32| length * (f64::from(link) + 0.5) * if link + 1 == links { last } else { 1.0 };
    let expected: f64 = (0..links).map(moment).sum::<f64>() * G;
    let mut lowest = 0.0_f64;
    for _ in 0..300 {
        rig.step();
        lowest = lowest.min(rig.position(before).y);
    }
    let torque = f64::from(rig.load(root.unwrap()).torque.z);
    println!("torque {torque} of {expected}, sunk by {:.1e}, now {:.1e}", -lowest, -rig.position(before).y);
    assert!((torque / expected - 1.0).abs() < by_precision(1e-3, 1e-6), "{torque} of {expected}");
    assert!(rig.position(before).y.abs() < by_precision(1e-4, 1e-7), "{}", rig.position(before).y);
}

#[test]
fn limits_work_on_frames_that_are_turned() {
    // The frames' axes differ from the world's, and the second from the first: values count.
    let mut draw = Draw::new(3, 0);
    for _ in 0..30 {
        let mut rig = Rig::new(DVec3::ZERO, 1.0 / 60.0, 4);
        let ground = rig.ground();
        let q = DQuat::from_axis_angle(draw.direction(), draw.between(0.0, PI));
        let axis = draw.direction();
        let disc = body(1.0, DVec3::new(0.1, 0.2, 0.25), ORIGIN).angular_velocity(real(axis * -3.0));
        let disc = rig.spawn(turned(disc, q.to_axis_angle().0, q.to_axis_angle().1));
        let joint = rig.join_at(Joint::hinge(ground, disc), ORIGIN, axis);
        rig.world.insert_one(joint, Limits::along(Axes::ANGULAR_X, limit(-0.7, 0.2))).unwrap();
        rig.run_to(1.0);
        let turned = rig.orientation(disc) * q.conjugate();
        let expected = DQuat::from_axis_angle(axis, -0.7);
        assert!(turned.angle_between(expected) < 2e-3, "{turned} of {expected}");
        // What is added to the diagonal leaves 1e-5 or 1e-7 of its speed, for a second.
        let off = f64::from(rig.load(joint).values[3]) + 0.7;
        assert!(off.abs() < by_precision(3e-5, 3e-7), "{off}");
    }
}

#[test]
fn a_free_joint_without_limits_does_nothing() {
    let mut rig = Rig::new(down(), 1.0 / 60.0, 4);
    let ground = rig.ground();
    let ball = rig.spawn(RigidBody::new(Shape::sphere(0.1)).without_collider().mass(3.0));
    rig.join(Joint::free(ground, ball));
    rig.run_to(1.0);
    assert!((rig.velocity(ball) + DVec3::Y * G).length() < 1e-4);
}

/// A bound alone that no angle from -pi to pi reaches is none.
#[test]
fn a_bound_alone_beyond_half_a_turn_does_nothing() {
    for (min, max) in [(4.0, f64::INFINITY), (f64::NEG_INFINITY, -4.0)] {
        let mut rig = Rig::new(DVec3::ZERO, 1.0 / 60.0, 4);
        let ground = rig.ground();
        let disc = rig.spawn(body(1.0, DVec3::new(0.1, 0.2, 0.25), ORIGIN).angular_velocity(real(DVec3::Z * 3.0)));
        let joint = rig.join_at(Joint::hinge(ground, disc), ORIGIN, DVec3::Z);
        rig.world.insert_one(joint, Limits::along(Axes::ANGULAR_X, limit(min, max))).unwrap();
        rig.run_to(3.0);
        assert!((rig.angular_velocity(disc).z - 3.0).abs() < 1e-5, "{min} {max}");
    }
}

/// What is held at one value goes there at the speed of other joints that do not fit, from either
/// side: a slider, a hinge and a rod.
#[test]
fn what_is_held_is_closed_from_both_sides_alike() {
    for case in 0..200 {
        let mut draw = Draw::new(0x2A, case);
        let dt = 1.0 / draw.log_between(30.0, 250.0);
        let kind = case % 3;
        let mut rig = Rig::new(ORIGIN, dt, pick(&mut draw, [1, 4, 16]));
        let ground = rig.ground();
        let mass = draw.log_between(1e-3, 1e3);
        let body = rig.spawn(rod(mass, 1.0, DVec3::X * 1.5));
        let off = draw.between(0.5, 1.2) * if draw.often(0.5) { 1.0 } else { -1.0 };
        let (joint, number, speed, axis) = match kind {
            0 => (Joint::slider(ground, body), 0, 3.0, DVec3::X),
            1 => (Joint::hinge(ground, body), 3, 10.0, DVec3::Z),
            _ => (Joint::free(ground, body), 0, 3.0, DVec3::X),
        };
        let joint = rig.join_at(joint, ORIGIN, axis);
        // A rod to the far end, which is 2 m away.
        let goal = if kind == 2 { 2.0 - off } else { -off };
        let limits = if kind == 2 {
            rig.world.get::<&mut Joint>(joint).unwrap().frames[1].position = real(DVec3::X * 0.5);
            Limits::rod(goal as Real)
        } else {
            Limits::along(if kind == 0 { Axes::LINEAR_X } else { Axes::ANGULAR_X }, limit(goal, goal))
        };
        rig.world.insert_one(joint, limits).unwrap();
        for step in 1..=4 {
            rig.step();
            let value = f64::from(rig.load(joint).values[number]);
            let left = (value - goal) * off.signum();
            let expected = (off.abs() - speed * dt * f64::from(step)).max(0.0);
            assert!((left - expected).abs() < 1e-4 * off.abs(), "case {case}, step {step}: {left} of {expected}");
        }
    }
}
