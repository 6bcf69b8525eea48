//! Promise: joints under loads of up to a thousand times their bodies' weights stay closed, or
//! close where they begin apart, beside a limit, in a loop and a kilometre from the origin; in a
//! loop that does not fit up to ten thousand times. A limit of a geared joint that begins past it
//! acts. What a joint presses on the ground is not thrown when the joint goes.
//!
//! Why: a weight behind light links responds to an impulse by as little as what joints that
//! contradict each other lock. It fails if its joint is taken for one that contradicts others and
//! gives way, by hundreds of metres, or if the contact of a held body takes a load without bound.

use glam::{DQuat, DVec3};
use hecs::Entity;
use tumble::math::{Quat, Real};
use tumble::{Axes, Breakable, Cone, Gain, Gear, Joint, Limit, Limits, Material, RigidBody, Shape};
use tumble_tests::touching::ground;
use tumble_tests::{Draw, by_precision, cases};

use crate::direct_contacts::cuboid;
use crate::jointed::*;

/// A limit of the first joint of a chain that hangs: its cone or its twist, hard or soft.
fn limits(draw: &mut Draw) -> Limits {
    let gain = Gain::Frequency { hertz: 10.0, damping_ratio: 1.0 };
    match draw.between(0.0, 3.0) as u32 {
        0 => Limits::cone(1.5),
        1 => Limits::along(Axes::ANGULAR_X, Limit::new(-0.5, 0.5)),
        _ => Limits { cone: Some(Cone { half_angles: [1.5; 2], gain }), ..Limits::default() },
    }
}

/// Links that hang from a point with a weight at the end, and the joints.
fn weighted_chain(rig: &mut Rig, draw: &mut Draw, (size, at, gap): (f64, DVec3, f64)) -> Vec<Entity> {
    let links = 2 + draw.between(0.0, 8.0) as usize;
    let heavy = draw.log_between(1.0, 1e3);
    let shape = Shape::cuboid(DVec3::new(0.1, 0.5, 0.1) * size);
    let mut above = rig.spawn(RigidBody::new(Shape::Point).fixed().position(real(at)));
    let mut joints = Vec::new();
    for i in 0..=links {
        let is_last = i == links;
        let joint_at = at + DVec3::NEG_Y * i as f64 * size;
        let center = joint_at + DVec3::NEG_Y * (0.5 * size + if is_last { gap } else { 0.0 });
        let mass = if is_last { heavy } else { 1.0 };
        let body = RigidBody::new(shape.clone()).without_collider().mass(mass).position(real(center));
        let body = rig.spawn(body.linear_velocity(real(DVec3::X * if is_last { size } else { 0.0 })));
        let mut joint = Joint::ball(above, body).at(&rig.world, real(joint_at), real(DVec3::NEG_Y)).unwrap();
        joint.frames[1].position = real(DVec3::Y * 0.5 * size);
        joints.push(rig.join(joint));
        above = body;
    }
    joints
}

#[test]
fn chains_with_weights_and_a_limit_stay_closed() {
    for case in 0..u64::from(cases(40)) {
        let mut draw = Draw::new(0x10AD, case);
        let size = draw.log_between(0.05, 5.0);
        let gap = if draw.often(0.5) { draw.log_between(1e-3, 0.1) * size } else { 0.0 };
        // The rounding of a place counts as a gap there.
        let far = if draw.often(0.5) { draw.log_between(1.0, 1e3) } else { 0.0 };
        let at = DVec3::new(far, 0.3 * far, -far);
        let mut rig = Rig::new(down(), 1.0 / 60.0, 4 + draw.between(0.0, 12.0) as u32);
        let joints = weighted_chain(&mut rig, &mut draw, (size, at, gap));
        rig.world.insert_one(joints[0], limits(&mut draw)).unwrap();
        // What is apart is closed at 3 m/s.
        rig.run_to(1.0 + gap / 3.0);
        let most = 1e-4 * size + by_precision(4e-7, 1e-12) * far;
        for _ in 0..120 {
            rig.step();
            let found = rig.largest_gap();
            assert!(found < most, "case {case}: {found} m of {most}, size {size} m, {far} m away");
        }
    }
}

/// A row of planks between two cliffs, with hinges or balls, and a box that falls on its middle.
fn loaded_bridge(case: u64) -> (f64, f64) {
    let mut draw = Draw::new(0x10AE, case);
    let size = draw.log_between(0.1, 3.0);
    let planks = 4 + draw.between(0.0, 17.0) as usize;
    let mut rig = Rig::new(down(), 1.0 / 60.0, 4 + draw.between(0.0, 12.0) as u32);
    let material = Material::new(0.6, 0.0);
    let half = DVec3::new(0.48, 0.05, 0.6) * size;
    let sag = draw.between(0.02, 0.1) * size * planks as f64;
    let height = |i: f64| -sag * (1.0 - (2.0 * i / planks as f64 - 1.0).powi(2));
    let point = |i: usize| DVec3::new(i as f64 * size, height(i as f64), 0.0);
    let is_hinge = draw.often(0.7);
    let cliff = rig.ground();
    let mut last = cliff;
    for i in 0..=planks {
        let next = if i == planks {
            cliff
        } else {
            let (from, to) = (point(i), point(i + 1));
            let turn = DQuat::from_rotation_arc(DVec3::X, (to - from).normalize());
            cuboid(&mut rig, half, 5.0, (from + to) * 0.5, turn, material)
        };
        let kind = if is_hinge { Joint::hinge } else { Joint::ball };
        rig.join_at(kind(last, next), point(i), DVec3::Z);
        last = next;
    }
    let up = height(0.5 * planks as f64) + draw.between(0.6, 1.5) * size;
    let at = DVec3::new(0.5 * planks as f64 * size, up, 0.0);
    cuboid(&mut rig, DVec3::splat(0.4 * size), draw.log_between(5.0, 500.0), at, DQuat::IDENTITY, material);
    let mut most = 0.0_f64;
    for _ in 0..300 {
        rig.step();
        most = most.max(rig.largest_gap());
    }
    (most / size, rig.largest_gap() / size)
}

#[test]
fn bridges_with_boxes_stay_closed() {
    for case in 0..u64::from(cases(40)) {
        let (most, end) = loaded_bridge(case);
        println!("case {case}: {most:e}, in the end {end:e}");
        assert!(most < 0.05 && end < 5e-3, "case {case}: a gap of {most} sizes, and {end} in the end");
    }
}

/// A crate that a joint at its centre, or through its middle, holds a little too low.
fn pressed(case: u64, how_it_ends: u32) -> f64 {
    let mut draw = Draw::new(0x10AF, case);
    let size = draw.log_between(0.02, 5.0);
    let depth = draw.log_between(2e-4, 1e-2) * size;
    let mut rig = Rig::new(down(), 1.0 / 60.0, 1 + draw.between(0.0, 16.0) as u32);
    ground(&mut rig.world, Material::default(), Quat::IDENTITY);
    let half = DVec3::new(0.5, draw.between(0.1, 0.5), draw.between(0.2, 0.5)) * size;
    let center = DVec3::Y * (half.y - depth);
    let body = cuboid(&mut rig, half, draw.log_between(0.1, 100.0), center, DQuat::IDENTITY, Material::default());
    let base = rig.ground();
    let kind = [Joint::ball, Joint::universal, Joint::hinge, Joint::fixed][case as usize % 4];
    let joint = rig.join_at(kind(base, body), center, DVec3::X);
    rig.run_to(1.0);
    match how_it_ends {
        0 => rig.world.despawn(joint).unwrap(),
        1 => rig.world.despawn(base).unwrap(),
        _ => rig.world.insert_one(joint, Breakable { is_broken: true, ..Breakable::at_force(1e9 as Real) }).unwrap(),
    }
    let mut fastest = 0.0_f64;
    for _ in 0..60 {
        rig.step();
        fastest = fastest.max(rig.velocity(body).length());
    }
    fastest
}

/// Overlap is pushed out at 3 m/s at most.
#[test]
fn what_a_joint_presses_on_the_ground_is_not_thrown_when_it_goes() {
    for case in 0..u64::from(cases(48)) {
        let fastest = pressed(case, case as u32 % 3);
        println!("case {case}: {fastest} m/s");
        assert!(fastest < 3.0, "case {case}: {fastest} m/s");
    }
}

/// A light beam on two joints to fixed bodies that do not fit, with a weight on a third.
#[test]
fn a_weight_on_a_loop_that_does_not_fit_is_held() {
    let kinds: [fn(Entity, Entity) -> Joint; 3] = [Joint::ball, Joint::hinge, Joint::fixed];
    for case in 0..u64::from(cases(150)) {
        let mut draw = Draw::new(0x10B0, case);
        let size = draw.log_between(0.05, 5.0);
        let misfit = draw.log_between(1e-4, 1e-2) * size;
        let weight = draw.log_between(1.0, 1e4);
        let mut rig = Rig::new(down(), 1.0 / draw.log_between(60.0, 240.0), 4 << (case % 3));
        let ends = [-1.0, 1.0].map(|side| DVec3::X * side * size);
        let held = ends.map(|at| rig.spawn(RigidBody::new(Shape::Point).fixed().position(real(at))));
        let beam = RigidBody::new(Shape::cuboid(DVec3::new(1.0, 0.1, 0.1) * size)).without_collider().mass(1.0);
        let beam = rig.spawn(beam);
        for (number, at) in ends.into_iter().enumerate() {
            rig.join_at(kinds[draw.between(0.0, 3.0) as usize](held[number], beam), at, DVec3::Z);
        }
        let apart = draw.direction() * misfit;
        rig.world.get::<&mut tumble::Pose>(held[1]).unwrap().position += real(apart);
        let at = DVec3::X * draw.between(-0.9, 0.9) * size;
        let hanging = RigidBody::new(Shape::sphere(0.2 * size)).without_collider().mass(weight);
        let hanging = rig.spawn(hanging.position(real(at - DVec3::Y * 0.5 * size)));
        let joint = rig.join_at(kinds[draw.between(0.0, 3.0) as usize](beam, hanging), at, DVec3::Z);
        rig.run_to(2.0);
        let (gap, load) = (rig.largest_gap(), f64::from(rig.load(joint).force.length()) / (weight * G));
        println!("case {case}: {:.3} misfits, load {load:.4}", gap / misfit);
        assert!(gap < 3.0 * misfit + 1e-5 * size, "case {case}: {gap} m of {misfit} m, 1 : {weight}");
        assert!((load - 1.0).abs() < 0.05, "case {case}: {load} of the weight, 1 : {weight}");
    }
}

/// Two sliders that are geared, of which one has a limit and begins past it, at rest.
#[test]
fn limits_of_geared_joints_act_from_beyond() {
    for case in 0..u64::from(cases(60)) {
        let mut draw = Draw::new(0x10B1, case);
        let masses = [1.0, draw.log_between(1.0, 1e3)];
        let (ratio, past) = (draw.log_between(0.3, 3.0), draw.log_between(1e-4, 0.1));
        let mut rig = Rig::new(down(), 1.0 / draw.log_between(60.0, 240.0), 4);
        let frame = rig.ground();
        let mut joints = Vec::new();
        for (number, mass) in masses.into_iter().enumerate() {
            let at = DVec3::X * 3.0 * number as f64;
            let way = if number == 0 { 1.0 } else { ratio } * -(1.0 + past);
            let shape = Shape::cuboid([0.3, 0.2, 0.1]);
            let body = RigidBody::new(shape).without_collider().mass(mass).position(real(at + DVec3::Y * way));
            let body = rig.spawn(body);
            let mut joint = Joint::slider(frame, body).at(&rig.world, real(at), real(DVec3::Y)).unwrap();
            joint.frames[1].position = real(DVec3::ZERO);
            joints.push(rig.join(joint));
        }
        rig.world.spawn((Gear::new(joints[0], joints[1], ratio as Real),));
        rig.world.insert_one(joints[0], Limits::along(Axes::LINEAR_X, Limit::new(-1.0, 1.0))).unwrap();
        rig.run_to(4.0);
        let value = f64::from(rig.load(joints[0]).values[0]);
        println!("case {case}: {value}");
        assert!((value + 1.0).abs() < 1e-3, "case {case}: {value}, from {past} beyond, 1 : {} by {ratio}", masses[1]);
    }
}
