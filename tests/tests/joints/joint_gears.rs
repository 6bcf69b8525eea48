//! Promise: gears keep the ratio of two joints for any number of turns, at any ratio of teeth;
//! wheels on a train move as if they were one inertia; a rack moves with its pinion and carries its
//! weight; a ratio that is no fraction is kept as a speed, and with limits as a position; what is
//! geared and flies free keeps its momentum.
//!
//! Why: a gear acts on four bodies, some of which may be one. It fails if a factor has the wrong
//! sign, if two ends on one body are counted once, or if an angle that passes half a turn jumps.

use std::f64::consts::PI;

use crate::jointed::*;
use glam::DVec3;
use hecs::Entity;
use tumble::math::{Real, Vec3};
use tumble::{Axes, ConstantWrench, Drive, Drives, Gear, Joint, Limit, Limits, RigidBody, Shape};
use tumble_tests::{Draw, by_precision};

/// Wheels about z on a body, with these moments, each with its hinge.
fn wheels(rig: &mut Rig, on: Entity, moments: &[f64]) -> Vec<(Entity, Entity)> {
    let mut all = Vec::new();
    for (number, moment) in moments.iter().enumerate() {
        let at = DVec3::X * number as f64;
        let wheel = rig.spawn(body(1.0, DVec3::new(0.6 * moment, 0.6 * moment, *moment), at));
        let hinge = rig.join_at(Joint::hinge(on, wheel), at, DVec3::Z);
        all.push((wheel, hinge));
    }
    all
}

#[test]
fn a_train_of_wheels_is_one_inertia() {
    let mut draw = Draw::new(1, 0);
    for _ in 0..20 {
        let mut rig = Rig::new(DVec3::ZERO, 1.0 / 60.0, 4);
        let ground = rig.ground();
        let moments = [draw.log_between(0.01, 10.0), draw.log_between(0.01, 10.0), draw.log_between(0.01, 10.0)];
        let train = wheels(&mut rig, ground, &moments);
        let teeth = [1, 2].map(|_| (draw.between(-20.0, 20.0).round() + 0.5).round() / draw.between(1.0, 20.0).round());
        let ratios = teeth.map(|ratio| if ratio == 0.0 { -1.0 } else { ratio });
        rig.world.spawn((Gear::new(train[0].1, train[1].1, ratios[0] as Real),));
        rig.world.spawn((Gear::new(train[1].1, train[2].1, ratios[1] as Real),));
        let torque = draw.between(0.1, 1.0);
        let wrench = ConstantWrench { torque: Vec3::Z * torque as Real, ..ConstantWrench::default() };
        rig.world.insert_one(train[0].0, wrench).unwrap();
        let whole = moments[0] + moments[1] * ratios[0].powi(2) + moments[2] * (ratios[0] * ratios[1]).powi(2);
        rig.run_to(1.0);
        let speeds = [0, 1, 2].map(|wheel| rig.angular_velocity(train[wheel].0).z);
        let expected = torque / whole;
        for (speed, ratio) in speeds.into_iter().zip([1.0, ratios[0], ratios[0] * ratios[1]]) {
            let off = (speed / (expected * ratio) - 1.0).abs();
            assert!(off < by_precision(1e-4, 1e-6), "{moments:?} {ratios:?}: {speed} of {}", expected * ratio);
        }
    }
}

#[test]
fn teeth_do_not_slip_in_a_thousand_turns() {
    for (ratio, denominator) in [(-2.0_f64, 1), (3.0 / 7.0, 7), (-40.0 / 63.0, 63), (12.0, 1)] {
        // No wheel turns by half a turn in a step, so that its turns can be counted.
        let rate = if ratio.abs() > 9.0 { 120.0 } else { 60.0 };
        let mut rig = Rig::new(DVec3::ZERO, 1.0 / rate, 4);
        let ground = rig.ground();
        let train = wheels(&mut rig, ground, &[0.5, 0.2]);
        rig.world.spawn((Gear::new(train[0].1, train[1].1, ratio as Real),));
        let motor = Drive::velocity(Axes::ANGULAR_X, 20.0);
        rig.world.insert_one(train[0].1, Drives::from(motor)).unwrap();
        let mut turned = [0.0_f64; 2];
        let mut before = [0.0_f64; 2];
        let mut worst = 0.0_f64;
        while turned[0] < 1000.0 * 2.0 * PI {
            rig.step();
            for wheel in 0..2 {
                let now = f64::from(rig.load(train[wheel].1).values[3]);
                let change = now - before[wheel];
                turned[wheel] += change - 2.0 * PI * (change / (2.0 * PI)).round();
                before[wheel] = now;
            }
            let off = f64::from(rig.load(train[1].1).values[3]) - ratio * f64::from(rig.load(train[0].1).values[3]);
            let period = 2.0 * PI / f64::from(denominator);
            worst = worst.max((off - period * (off / period).round()).abs());
        }
        let slipped = turned[1] - ratio * turned[0];
        println!("{ratio}: {:.1} turns, off by {worst:.1e}, slipped by {slipped:.1e}", turned[0] / (2.0 * PI));
        assert!((rig.simulation.time() * 20.0 / turned[0] - 1.0).abs() < 1e-3, "{} s", rig.simulation.time());
        assert!(worst < by_precision(2e-5, 1e-8), "{ratio}: {worst:e}");
        // The sums are rounded forty thousand times.
        assert!(slipped.abs() < 1e-6, "{ratio}: {slipped:e}");
    }
}

#[test]
fn a_rack_carries_its_weight_on_the_pinion() {
    // A rack of 3 kg hangs on a pinion of 0.1 m and 0.05 kg m^2: like a weight on a drum.
    let mut rig = Rig::new(down(), 1.0 / 60.0, 4);
    let ground = rig.ground();
    let pinion = rig.spawn(body(1.0, DVec3::new(0.03, 0.03, 0.05), ORIGIN));
    let hinge = rig.join_at(Joint::hinge(ground, pinion), ORIGIN, DVec3::Z);
    let rack = rig.spawn(
        RigidBody::new(Shape::cuboid([0.02, 0.5, 0.02])).without_collider().mass(3.0).position(real(DVec3::X * 0.1)),
    );
    let slider = rig.join_at(Joint::slider(ground, rack), DVec3::X * 0.1, DVec3::Y);
    rig.world.spawn((Gear::new(hinge, slider, 0.1),));
    rig.run_to(2.0);
    let acceleration = 3.0 * G / (3.0 + 0.05 / 0.01);
    let fallen = -rig.position(rack).y;
    assert!((fallen / (2.0 * acceleration) - 1.0).abs() < 1e-5, "{fallen} of {}", 2.0 * acceleration);
    let turned = -rig.angular_velocity(pinion).z * 0.1 / (2.0 * acceleration);
    assert!((turned - 1.0).abs() < 1e-5, "{turned}");
    assert!((rig.energy() / (3.0 * G * fallen)).abs() < 1e-4);
}

/// Atwood's machine: two weights on a cord over a wheel without inertia.
#[test]
fn two_weights_on_a_cord_fall_by_their_difference() {
    let mut draw = Draw::new(9, 0);
    for _ in 0..40 {
        let mut rig = Rig::new(down(), 1.0 / 60.0, 4);
        let ground = rig.ground();
        let masses = [0, 1].map(|_| draw.log_between(1e-2, 1e2));
        let weights = masses.map(|mass| rig.spawn(RigidBody::new(Shape::sphere(0.1)).without_collider().mass(mass)));
        let sliders = weights.map(|weight| rig.join_at(Joint::slider(ground, weight), ORIGIN, DVec3::Y));
        rig.world.spawn((Gear::new(sliders[0], sliders[1], -1.0),));
        rig.run_to(1.0);
        let acceleration = G * (masses[1] - masses[0]) / (masses[0] + masses[1]);
        let risen = weights.map(|weight| rig.position(weight).y);
        let off = (risen[0] - 0.5 * acceleration).abs().max((risen[1] + 0.5 * acceleration).abs());
        assert!(off <= by_precision(2e-5, 1e-8), "{masses:?}: {risen:?} of {}", 0.5 * acceleration);
    }
}

#[test]
fn a_ratio_that_is_no_fraction_is_a_speed() {
    let mut rig = Rig::new(DVec3::ZERO, 1.0 / 60.0, 4);
    let ground = rig.ground();
    let train = wheels(&mut rig, ground, &[0.5, 0.2]);
    rig.world.spawn((Gear::new(train[0].1, train[1].1, PI as Real),));
    rig.world.insert_one(train[0].1, Drives::from(Drive::velocity(Axes::ANGULAR_X, 3.0))).unwrap();
    for _ in 0..2000 {
        rig.step();
        let [first, second] = [0, 1].map(|wheel| rig.angular_velocity(train[wheel].0).z);
        assert!((second / first - PI).abs() < 1e-4, "{first} {second}");
    }
}

#[test]
fn rotations_within_limits_take_any_ratio_and_offset() {
    let mut draw = Draw::new(7, 0);
    for case in 0..40 {
        let mut rig = Rig::new(DVec3::ZERO, 1.0 / 60.0, 4);
        let ground = rig.ground();
        let train = wheels(&mut rig, ground, &[draw.log_between(0.05, 2.0), draw.log_between(0.05, 2.0)]);
        let ratio = draw.log_between(0.3, 3.0) * if draw.often(0.5) { 1.0 } else { -1.0 };
        let offset = draw.between(-PI, PI);
        // Either range may be wherever it likes, up to most of a turn.
        let most = 5.8_f64.min(5.8 / ratio.abs());
        let width = draw.between(0.3, 1.0) * most;
        let least = -draw.between(0.05, 0.95) * width;
        let first = [least, least + width];
        let mut second = first.map(|bound| ratio * bound + offset);
        second.sort_unstable_by(f64::total_cmp);
        let second = [second[0] - 0.1, second[1] + 0.1];
        for ((_, joint), [min, max]) in train.iter().zip([first, second]) {
            rig.world.insert_one(*joint, Limits::along(Axes::ANGULAR_X, Limit::new(min as Real, max as Real))).unwrap();
        }
        let gear = Gear { offset: offset as Real, ..Gear::new(train[0].1, train[1].1, ratio as Real) };
        rig.world.spawn((gear,));
        let mut reached = [0.0_f64; 2];
        for way in [1.0, -1.0] {
            let motor = Drive::velocity(Axes::ANGULAR_X, way * 4.0).with_max_force(50.0);
            rig.world.insert_one(train[0].1, Drives::from(motor)).unwrap();
            for step in 0..150 {
                rig.step();
                // From the middle of its range, the shorter way round.
                let value = |wheel: usize, [min, max]: [f64; 2]| {
                    let off = f64::from(rig.load(train[wheel].1).values[3]) - 0.5 * (min + max);
                    0.5 * (min + max) + off - 2.0 * PI * (off / (2.0 * PI)).round()
                };
                let [a, b] = [value(0, first), value(1, second)];
                reached = [reached[0].min(a), reached[1].max(a)];
                // The offset at the start is closed at 10 rad/s at most.
                let off = (b - ratio * a - offset).abs();
                let most = by_precision(2e-6, 1e-9) * (1.0 + ratio.abs());
                assert!((way > 0.0 && step < 60) || off < most, "case {case}, step {step}: {a} {b} off by {off:e}");
            }
        }
        let off = (reached[0] - first[0]).abs().max((reached[1] - first[1]).abs());
        assert!(off < 1e-4, "case {case}: {reached:?} of {first:?}");
    }
}

#[test]
fn what_is_geared_and_flies_keeps_its_momentum() {
    let mut draw = Draw::new(4, 0);
    for case in 0..40 {
        let mut rig = Rig::new(DVec3::ZERO, 1.0 / 60.0, 4);
        let carrier = rig.spawn(rod(draw.log_between(0.1, 10.0), 1.0, ORIGIN).angular_velocity(real(draw.vector(3.0))));
        let mut joints = Vec::new();
        for _ in 0..2 {
            let at = draw.vector(1.0);
            let part = rig.spawn(rod(draw.log_between(0.1, 10.0), 0.7, at).angular_velocity(real(draw.vector(3.0))));
            let kind = if draw.often(0.7) { Joint::hinge } else { Joint::slider };
            let axis = draw.direction();
            joints.push(rig.join_at(kind(carrier, part), at, axis));
        }
        rig.world.spawn((Gear::new(joints[0], joints[1], draw.between(-3.0, 3.0) as Real),));
        rig.step();
        let before = rig.totals();
        rig.run_to(3.0);
        let after = rig.totals();
        let size = before.linear_momentum.length() + before.angular_momentum.length() + 1.0;
        let moved = (after.linear_momentum - before.linear_momentum).length();
        let turned = (after.angular_momentum - before.angular_momentum).length();
        assert!(moved < by_precision(1e-5, 1e-13) * size, "case {case}: {moved:e}");
        assert!(turned < by_precision(3e-5, 1e-12) * size, "case {case}: {turned:e}");
        let gain = after.energy() / before.energy() - 1.0;
        assert!(gain < by_precision(2e-3, 2e-3), "case {case}: {gain:e}");
        assert!(rig.largest_gap() < by_precision(1e-5, 1e-9));
    }
}

#[test]
fn a_gear_without_a_joint_does_nothing() {
    let mut rig = Rig::new(DVec3::ZERO, 1.0 / 60.0, 4);
    let ground = rig.ground();
    let train = wheels(&mut rig, ground, &[0.5, 0.2]);
    let gear = rig.world.spawn((Gear::new(train[0].1, train[1].1, 1.0),));
    rig.world.insert_one(train[0].1, Drives::from(Drive::velocity(Axes::ANGULAR_X, 3.0))).unwrap();
    rig.run_to(1.0);
    assert!((rig.angular_velocity(train[1].0).z - 3.0).abs() < 1e-4);
    // A joint that is gone, one joint twice, a ratio that is none.
    let wrong = [
        Gear::new(train[1].1, train[1].1, 1.0),
        Gear::new(train[0].1, ground, 1.0),
        Gear::new(train[0].1, train[1].1, Real::NAN),
        Gear { axes: [Axes::LINEAR_X, Axes::NONE], ..Gear::new(train[0].1, train[1].1, 5.0) },
    ];
    for wrong in wrong {
        *rig.world.get::<&mut Gear>(gear).unwrap() = wrong;
        rig.world.insert_one(train[0].1, Drives::from(Drive::velocity(Axes::ANGULAR_X, -1.0))).unwrap();
        rig.simulation.step_many(&mut rig.world, 30);
        assert!((rig.angular_velocity(train[1].0).z - 3.0).abs() < 1e-4, "{wrong:?}");
    }
    rig.world.despawn(train[0].1).unwrap();
    rig.step();
    assert!(rig.angular_velocity(train[0].0).is_finite());
}

/// What an offset asks for, up to whole turns of the pinion, is gone to at the speed of errors
/// along a line, whatever the ratio.
#[test]
fn a_rack_goes_to_its_offset_at_three_metres_a_second() {
    let mut draw = Draw::new(5, 0);
    for _ in 0..20 {
        let mut rig = Rig::new(DVec3::ZERO, 1.0 / 60.0, 4);
        let ground = rig.ground();
        let pinion = rig.spawn(body(1.0, DVec3::new(0.03, 0.03, 0.05), ORIGIN));
        let hinge = rig.join_at(Joint::hinge(ground, pinion), ORIGIN, DVec3::Z);
        let rack = rig.spawn(
            RigidBody::new(Shape::cuboid([0.02, 0.5, 0.02])).without_collider().mass(draw.log_between(0.1, 10.0)),
        );
        let slider = rig.join_at(Joint::slider(ground, rack), ORIGIN, DVec3::Y);
        let (ratio, offset) = (draw.between(0.05, 0.5), draw.between(0.4, 2.0));
        let gear = Gear { offset: offset as Real, ..Gear::new(hinge, slider, ratio as Real) };
        rig.world.spawn((gear,));
        // The angle, followed over whole turns.
        let (mut angle, mut left) = (0.0, offset);
        for _ in 0..90 {
            rig.step();
            let seen = f64::from(rig.load(hinge).values[3]);
            angle += (seen - angle + PI).rem_euclid(2.0 * PI) - PI;
            let now = offset + ratio * angle - rig.position(rack).y;
            assert!((left - now).abs() < 3.001 / 60.0, "{left} {now}");
            left = now;
        }
        let turn = 2.0 * PI * ratio;
        assert!((left - turn * (left / turn).round()).abs() < 1e-4, "{left} of {turn}");
    }
}
