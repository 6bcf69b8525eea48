//! Promise: contacts of a mechanism carry what stands on them, whatever the ratio of masses: a
//! trunk on a foot of a millionth of its mass, on a light plank, under a heavy crate. A mechanism
//! slides, falls over and bounces as a single body of its mass does.
//!
//! Why: solved alternately with the joints, a light foot under a heavy trunk sinks and sinks. It
//! fails if an impulse at a contact is answered by its own two bodies only, if contacts pull or
//! push too far, or if friction and bounces of such contacts follow other laws than those of single
//! bodies.

use crate::jointed::*;
use glam::{DQuat, DVec3};
use hecs::Entity;
use tumble::math::Real;
use tumble::{
    Axes, Collider, ContactEvent, Drive, Drives, Joint, Limit, Limits, Mass, Material, Momentum, Pose, RigidBody,
    Shape, Velocity,
};
use tumble_tests::references::real_quat;
use tumble_tests::touching::{collider, ground, surfaced};
use tumble_tests::{Draw, cases, dvec3, quat};

/// Machine epsilon of the build.
const EPSILON: f64 = Real::EPSILON as f64;

/// A box of half extents with a collider.
pub(crate) fn cuboid(rig: &mut Rig, half: DVec3, mass: f64, at: DVec3, turn: DQuat, material: Material) -> Entity {
    let shape = Shape::cuboid(half.to_array());
    let body = RigidBody::new(shape.clone()).mass(mass).position(real(at)).orientation(real_quat(turn));
    body.build().unwrap().spawn_with(&mut rig.world, (surfaced(collider(&shape), material),))
}

/// The lowest corner of a box \[m\].
pub(crate) fn lowest(rig: &Rig, body: Entity, half: DVec3) -> f64 {
    let turn = rig.orientation(body);
    let reach = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| (turn * axis).y.abs()).into();
    rig.position(body).y - DVec3::dot(reach, half)
}

/// Steps on to a time \[s\]; returns how deep a box goes below y = 0 at most \[m\].
fn deepest_until(rig: &mut Rig, (body, half): (Entity, DVec3), time: f64) -> f64 {
    let mut deepest = -f64::INFINITY;
    while rig.simulation.time() < time {
        rig.step();
        deepest = deepest.max(-lowest(rig, body, half));
    }
    deepest
}

/// A trunk that stands on a foot: how large, how heavy the foot, and what holds them together.
struct Robot {
    rig: Rig,
    size: f64,
    weight: f64,
    foot: Entity,
    half_foot: DVec3,
    trunk: Entity,
    joint: Entity,
    /// Of a substep \[s\].
    h: f64,
    /// From the origin \[m\].
    far: f64,
    /// Contacts that carry it.
    layers: f64,
}

/// What is under the foot, and on top of the trunk.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Beside {
    Nothing,
    Plank,
    Crate,
}

impl Robot {
    fn new(draw: &mut Draw, beside: Beside) -> Self {
        let size = draw.log_between(0.01, 100.0);
        let (dt, substeps) = (1.0 / draw.log_between(10.0, 240.0), 1 + draw.between(0.0, 8.0) as u32);
        // Of several layers some are not held where a free fall goes further than their size in a
        // substep.
        let least = if beside == Beside::Nothing { 1 } else { (dt * (G / size).sqrt()).ceil() as u32 };
        let substeps = substeps.max(least);
        let mut rig = Rig::new(down(), dt, substeps);
        let density = draw.log_between(1e-3, 1e3);
        let of_foot = density * size.powi(3);
        // A plank may have a tenth of the foot's mass.
        let most = if beside == Beside::Plank { 1e5 } else { 1e6 };
        let of_trunk = of_foot * draw.log_between(0.1, most);
        let far = if beside == Beside::Nothing && draw.often(0.3) { draw.log_between(1.0, 1000.0) } else { 0.0 };
        let material = Material::default();
        ground(&mut rig.world, material, quat(DQuat::IDENTITY));
        let mut at = DVec3::X * far;
        let mut put = |rig: &mut Rig, half: DVec3, mass: f64| {
            at.y += half.y;
            let body = cuboid(rig, half, mass, at, DQuat::IDENTITY, material);
            at.y += half.y;
            body
        };
        if beside == Beside::Plank {
            let mass = of_foot * draw.log_between(0.1, 10.0);
            put(&mut rig, DVec3::new(0.6, 0.05, 0.5) * size, mass);
        }
        let half_foot = DVec3::new(0.4, 0.05, 0.35) * size;
        let foot = put(&mut rig, half_foot, of_foot);
        let trunk = put(&mut rig, DVec3::new(0.2, 0.5, 0.2) * size, of_trunk);
        let mut of_crate = 0.0;
        if beside == Beside::Crate {
            of_crate = of_foot * draw.log_between(0.1, 1e4);
            put(&mut rig, DVec3::new(0.2, 0.1, 0.2) * size, of_crate);
        }
        let ankle = rig.position(foot) + DVec3::Y * half_foot.y;
        let stiffness = 1e3 * (of_trunk + of_crate) * G * size;
        let servo = Drive::position(Axes::ANGULAR_X, 0.0).with_stiffness(stiffness as Real, 0.1 * stiffness as Real);
        let rigid = |axis| Some(Drive::position(axis, 0.0));
        let (joint, axis, drive) = match draw.between(0.0, 4.0) as u32 {
            0 => (Joint::fixed(foot, trunk), DVec3::Z, None),
            1 => (Joint::hinge(foot, trunk), DVec3::Z, rigid(Axes::ANGULAR_X)),
            2 => (Joint::hinge(foot, trunk), DVec3::Z, Some(servo)),
            _ => (Joint::slider(foot, trunk), DVec3::Y, rigid(Axes::LINEAR_X)),
        };
        let joint = rig.join_at(joint, ankle, axis);
        drive.into_iter().for_each(|drive| rig.world.insert_one(joint, Drives::from(drive)).unwrap());
        let weight = (of_trunk + of_crate) * G;
        let layers = if beside == Beside::Nothing { 1.0 } else { 2.0 };
        Self { rig, size, weight, foot, half_foot, trunk, joint, h: dt / f64::from(substeps), far, layers }
    }

    /// Stands for a while, in which it is to sink by no more than contacts give way under a load.
    fn stands(&mut self, case: u64) {
        let time = (2.0 * self.size.max(0.1).sqrt()).max(10.0 * f64::from(self.rig.simulation.settings().dt));
        let before = lowest(&self.rig, self.foot, self.half_foot);
        let deepest = before + deepest_until(&mut self.rig, (self.foot, self.half_foot), time);
        // Each contact that the load goes through gives way by a hundredth of a fall in a substep
        // at most.
        let most = self.layers * 1e-2 * G * self.h * self.h + 30.0 * EPSILON * (self.far + self.size);
        assert!(deepest <= most, "case {case}: {deepest:e} m of {most:e} m");
        let up = (self.rig.orientation(self.trunk) * DVec3::Y).y;
        assert!(up > 1.0 - 1e-4, "case {case}: {up}");
        let load = dvec3(self.rig.load(self.joint).force).length() / self.weight;
        // Rounding of a place, as an acceleration over a substep of the weight's.
        let rounding = 30.0 * EPSILON * self.far / (G * self.h * self.h);
        let bound = if self.layers > 1.0 { 5e-3 } else { 1e-4 };
        assert!((load - 1.0).abs() < bound + rounding, "case {case}: {load}");
        let speed = self.rig.velocity(self.trunk).length();
        assert!(speed < 1e-3 * G * self.h + EPSILON * (self.far + self.size) / self.h, "case {case}: {speed:e} m/s");
    }
}

#[test]
fn a_trunk_stands_on_a_foot_of_a_millionth_of_its_mass() {
    for case in 0..u64::from(cases(200)) {
        Robot::new(&mut Draw::new(0xd0, case), Beside::Nothing).stands(case);
    }
}

#[test]
fn it_stands_on_a_light_plank() {
    for case in 0..u64::from(cases(200)) {
        Robot::new(&mut Draw::new(0xd1, case), Beside::Plank).stands(case);
    }
}

#[test]
fn it_carries_a_heavy_crate() {
    for case in 0..u64::from(cases(200)) {
        Robot::new(&mut Draw::new(0xd2, case), Beside::Crate).stands(case);
    }
}

/// Dropped askew, a corner strikes first and turns it within the step: none of the others goes into
/// the ground by more than a part of the way of a substep.
#[test]
fn it_lands_askew() {
    let mut deep = 0;
    for case in 0..u64::from(cases(200)) {
        let mut draw = Draw::new(0xd7, case);
        let mut it = Robot::new(&mut draw, Beside::Nothing);
        let tilt = draw.direction().with_y(0.0).normalize() * draw.between(0.01, 0.1);
        let (turn, up) = (DQuat::from_scaled_axis(tilt), DVec3::Y * draw.between(0.05, 0.5) * it.size);
        let base = it.rig.position(it.foot);
        for body in [it.foot, it.trunk] {
            let place = base + turn * (it.rig.position(body) - base) + up;
            let mut pose = it.rig.world.get::<&mut Pose>(body).unwrap();
            (pose.position, pose.orientation) = (real(place), real_quat(turn));
        }
        let time = (2.0 * it.size.sqrt()).max(10.0 * it.h);
        let deepest = deepest_until(&mut it.rig, (it.foot, it.half_foot), time);
        let way = (2.0 * G * up.y).sqrt() * it.h;
        let rounding = 30.0 * EPSILON * (it.far + it.size);
        deep += u32::from(deepest > 0.1 * way + rounding);
        assert!(deepest < 0.3 * way + rounding, "case {case}: {deepest:e} m of {way:e} m");
    }
    assert!(deep <= cases(200) / 40, "{deep} are deep");
}

/// 58 kg on half a kilogram, dropped from half a metre and tilted, on joints that hold the ankle or
/// a servo.
#[test]
fn a_robot_lands_and_stands() {
    for (name, substeps) in ["weld", "servo", "hinge"].into_iter().flat_map(|name| [(name, 4), (name, 16)]) {
        let mut rig = Rig::new(down(), 1.0 / 60.0, substeps);
        let material = Material::default();
        ground(&mut rig.world, material, quat(DQuat::IDENTITY));
        let (tilt, base) = (DQuat::from_rotation_z(0.1), DVec3::Y * 0.5);
        let (half_foot, half_trunk) = (DVec3::new(0.2, 0.03, 0.15), DVec3::new(0.15, 0.5, 0.1));
        let mut put = |half, mass, up: f64| cuboid(&mut rig, half, mass, base + tilt * DVec3::Y * up, tilt, material);
        let (foot, trunk) = (put(half_foot, 0.5, 0.03), put(half_trunk, 58.0, 0.56));
        let joint = if name == "weld" { Joint::fixed(foot, trunk) } else { Joint::hinge(foot, trunk) };
        let joint = rig.join_at(joint, base + tilt * DVec3::Y * 0.06, DVec3::Z);
        let drive = Drive::position(Axes::ANGULAR_X, 0.0);
        let drive = if name == "servo" { drive.with_stiffness(30e3, 300.0) } else { drive };
        if name != "weld" {
            rig.world.insert_one(joint, Drives::from(drive)).unwrap();
        }
        let deepest = deepest_until(&mut rig, (foot, half_foot), 4.0);
        assert!(deepest < 1e-4, "{name}, {substeps} substeps: {deepest:e} m");
        let up = (rig.orientation(trunk) * DVec3::Y).y;
        assert!(up > 0.995, "{name}, {substeps} substeps: {up}");
    }
}

/// Two halves of a box welded together, or the whole box.
fn block(rig: &mut Rig, half: DVec3, mass: f64, (at, turn): (DVec3, DQuat), material: Material, whole: bool) -> Entity {
    if whole {
        return cuboid(rig, half, mass, at, turn, material);
    }
    let part = DVec3::new(0.5 * half.x, half.y, half.z);
    let [left, right] =
        [-1.0, 1.0].map(|side| cuboid(rig, part, 0.5 * mass, at + turn * DVec3::X * (side * part.x), turn, material));
    rig.join_at(Joint::fixed(left, right), at, DVec3::X);
    left
}

/// Ground that slopes down along x by an angle.
fn slope(rig: &mut Rig, angle: f64, material: Material) {
    ground(&mut rig.world, material, quat(DQuat::from_rotation_z(-angle)));
}

#[test]
fn welded_boxes_slide_and_hold_on_a_slope() {
    for case in 0..u64::from(cases(60)) {
        let mut draw = Draw::new(0xd3, case);
        let size = draw.log_between(0.02, 20.0);
        let (friction, angle) = (draw.between(0.1, 0.8), draw.between(0.1, 0.6));
        let mut rig = Rig::new(down(), 1.0 / draw.log_between(60.0, 240.0), 1 + draw.between(0.0, 8.0) as u32);
        let material = Material::new(friction as Real, 0.0);
        slope(&mut rig, angle, material);
        let turn = DQuat::from_rotation_z(-angle);
        let half = DVec3::new(0.5, 0.1, 0.3) * size;
        let at = turn * DVec3::Y * half.y;
        let body = block(&mut rig, half, draw.log_between(1e-3, 1e3), (at, turn), material, false);
        let start = rig.position(body);
        let time = draw.between(0.5, 1.0) * size.sqrt();
        rig.run_to(time);
        let time = rig.simulation.time();
        let slid = (turn * DVec3::X).dot(rig.position(body) - start);
        let pull = G * (angle.sin() - friction * angle.cos());
        let expected = 0.5 * pull.max(0.0) * time * time;
        // Of first order in the substep; what hardly slides may begin a little later.
        let h = f64::from(rig.simulation.settings().contact_substep());
        let bound = pull.abs() * time * h + 1e-3 * expected + 1e-4 * size;
        assert!((slid - expected).abs() < bound, "case {case}: {slid} of {expected} m");
    }
}

#[test]
fn welded_boxes_move_as_the_whole_box() {
    for case in 0..u64::from(cases(60)) {
        let mut draw = Draw::new(0xd4, case);
        let size = draw.log_between(0.05, 5.0);
        let half = DVec3::new(draw.between(0.3, 1.0), draw.between(0.2, 0.5), draw.between(0.2, 0.5)) * size;
        let material = Material::new(draw.between(0.2, 0.9) as Real, 0.0);
        let (mass, along) = (draw.log_between(0.1, 100.0), draw.between(-1.0, 1.0) * (G * size).sqrt());
        // It stands on an edge and falls over.
        let turn = DQuat::from_rotation_z(draw.between(0.2, 0.6));
        let up = half.x * (turn * DVec3::X).y.abs() + half.y * (turn * DVec3::Y).y;
        let mut ends = Vec::new();
        let time = 0.4 * (size / G).sqrt();
        for whole in [false, true] {
            let mut rig = Rig::new(down(), time / 40.0, 8);
            ground(&mut rig.world, material, quat(DQuat::IDENTITY));
            let body = block(&mut rig, half, mass, (DVec3::Y * up, turn), material, whole);
            for momentum in &mut rig.world.query::<(&mut Momentum, &Mass)>() {
                momentum.0.linear.x = momentum.1.kilograms() * along as Real;
            }
            rig.run_to(time);
            let offset = if whole { 0.0 } else { 0.5 * half.x };
            ends.push((rig.position(body) + rig.orientation(body) * DVec3::X * offset, rig.orientation(body)));
        }
        let apart = (ends[0].0 - ends[1].0).length() / size;
        let turned = ends[0].1.angle_between(ends[1].1);
        assert!(apart < 0.01 && turned < 0.01, "case {case}: {apart} sizes, {turned} rad");
    }
}

#[test]
fn a_jointed_ball_bounces_as_high_as_its_restitution_has_it() {
    for case in 0..u64::from(cases(40)) {
        let mut draw = Draw::new(0xd5, case);
        let (size, bounce) = (draw.log_between(0.05, 5.0), draw.between(0.3, 0.9));
        let mut rig = Rig::new(down(), (size / G).sqrt() / draw.between(60.0, 200.0), 4);
        let material = Material::new(0.0, bounce as Real);
        ground(&mut rig.world, material, quat(DQuat::IDENTITY));
        let height = size * draw.between(3.0, 8.0);
        let shape = Shape::sphere(0.5 * size);
        let ball = RigidBody::new(shape.clone()).mass(draw.log_between(0.1, 10.0)).position(real(DVec3::Y * height));
        let ball = ball.build().unwrap().spawn_with(&mut rig.world, (surfaced(collider(&shape), material),));
        // What it carries is above its centre, and touches nothing.
        let load = RigidBody::new(Shape::sphere(0.2 * size)).without_collider().mass(draw.log_between(0.01, 100.0));
        let load = rig.spawn(load.position(real(DVec3::Y * (height + size))));
        rig.join_at(Joint::fixed(ball, load), DVec3::Y * height, DVec3::Y);
        let fall = height - 0.5 * size;
        let mut highest = 0.0_f64;
        let begin = (2.0 * fall / G).sqrt() * 1.05;
        rig.run_to(begin);
        while rig.simulation.time() < begin + bounce * (2.0 * fall / G).sqrt() {
            rig.step();
            highest = highest.max(rig.position(ball).y - 0.5 * size);
        }
        let expected = bounce * bounce * fall;
        // The speed of the blow is that of the substep in which it comes.
        assert!((highest / expected - 1.0).abs() < 0.04, "case {case}: {highest} of {expected} m");
    }
}

/// Of all bodies \[N\].
pub(crate) fn weight(rig: &Rig) -> f64 {
    rig.world.query::<&Mass>().iter().map(|mass| f64::from(mass.kilograms()) * G).sum()
}

/// Boxes of up to this ratio of masses in a chain on balls, hinges with limits and welds, from a
/// place on, that turns; with their half extents.
fn throw_chain(rig: &mut Rig, draw: &mut Draw, (size, ratio): (f64, f64), mut at: DVec3) -> Vec<(Entity, DVec3)> {
    let material = Material::new(draw.between(0.0, 1.0) as Real, 0.0);
    let (turn, count) = (draw.orientation(), 2 + draw.between(0.0, 6.0) as u32);
    let (mut bodies, mut before) = (Vec::new(), None);
    let (start, spin) = (at, draw.vector(3.0) / size.sqrt());
    for number in 0..count {
        let half = DVec3::new(draw.between(0.2, 0.5), draw.between(0.05, 0.2), draw.between(0.05, 0.2)) * size;
        at += turn * DVec3::X * half.x;
        let mass = 1e3 * size.powi(3) * draw.log_between(1.0, ratio);
        let body = cuboid(rig, half, mass, at, turn, material);
        let joint = before.map(|before| match number % 3 {
            0 => Joint::ball(before, body),
            1 => Joint::hinge(before, body),
            _ => Joint::fixed(before, body),
        });
        let end = at - turn * DVec3::X * half.x;
        if let Some(joint) = joint {
            let joint = rig.join_at(joint, end, turn * DVec3::Z);
            if number % 3 == 1 {
                let limits = Limits::along(Axes::ANGULAR_X, Limit::new(-0.5, 0.5));
                rig.world.insert_one(joint, limits).unwrap();
            }
        }
        let velocity = spin.cross(at - start);
        rig.world.get::<&mut Momentum>(body).unwrap().linear = real(velocity * mass);
        bodies.push((body, half));
        before = Some(body);
        at += turn * DVec3::X * half.x;
    }
    bodies
}

/// Lets bodies fall and come to rest; returns the energy that they gain, of their weight times the
/// size, how deep they go, and the longest way of a corner in a step, of the size.
///
/// Contacts are found once a step: what others turn in it comes in by a part of that way.
fn fall(rig: &mut Rig, bodies: &[(Entity, DVec3)], size: f64) -> [f64; 3] {
    rig.step();
    let (start, weight) = (rig.energy(), weight(rig) * size);
    let (mut gain, mut deepest, mut fastest) = (0.0_f64, 0.0_f64, 0.0_f64);
    rig.run_to(0.0);
    let until = 4.0 * size.sqrt().max(0.3);
    while rig.simulation.time() < until {
        rig.step();
        gain = gain.max((rig.energy() - start) / weight);
        for (body, half) in bodies {
            deepest = deepest.max(-lowest(rig, *body, *half) / size);
            let turning = rig.angular_velocity(*body).length() * half.length();
            fastest = fastest.max(rig.velocity(*body).length() + turning);
        }
    }
    let way = fastest * f64::from(rig.simulation.settings().dt);
    [gain, deepest, way / size]
}

fn rig_with_ground(draw: &mut Draw) -> Rig {
    let mut rig = Rig::new(down(), 1.0 / draw.log_between(60.0, 240.0), 1 + draw.between(0.0, 8.0) as u32);
    ground(&mut rig.world, Material::new(draw.between(0.0, 1.0) as Real, 0.0), quat(DQuat::IDENTITY));
    rig
}

/// Chains thrown at the ground.
#[test]
fn what_falls_gains_nothing_and_stays_above_ground() {
    let mut worst_gain = 0.0_f64;
    for case in 0..u64::from(cases(60)) {
        let mut draw = Draw::new(0xd6, case);
        let size = draw.log_between(0.02, 10.0);
        let mut rig = rig_with_ground(&mut draw);
        let ratio = draw.log_between(1.0, 1e3);
        let bodies = throw_chain(&mut rig, &mut draw, (size, ratio), DVec3::Y * size * 8.0);
        let [gain, deepest, way] = fall(&mut rig, &bodies, size);
        let most = 0.02 + 0.2 * way;
        println!("case {case}: gain {gain:e}, deepest {deepest:e} of {most:e}, {size} m");
        assert!(deepest < most, "case {case}: {deepest:e} of {most:e}");
        worst_gain = worst_gain.max(gain);
    }
    assert!(worst_gain < 1e-2, "{worst_gain:e}");
}

/// Chains that fall on each other: which of them are in passes changes from step to step.
#[test]
fn a_heap_of_chains_gains_nothing_and_stays_above_ground() {
    let mut worst_gain = 0.0_f64;
    for case in 0..u64::from(cases(30)) {
        let mut draw = Draw::new(0xd8, case);
        let size = draw.log_between(0.02, 10.0);
        let mut rig = rig_with_ground(&mut draw);
        let (mut bodies, mut up) = (Vec::new(), 0.0);
        for _ in 0..3 + draw.between(0.0, 5.0) as u32 {
            up += 8.0 * size;
            let at = draw.vector(0.5 * size).with_y(up);
            bodies.extend(throw_chain(&mut rig, &mut draw, (size, 10.0), at));
        }
        let [gain, deepest, way] = fall(&mut rig, &bodies, size);
        // In passes they sink under their load besides.
        let most = 0.05 + 0.3 * way;
        println!("case {case}: gain {gain:e}, deepest {deepest:e} of {most:e}, {size} m");
        assert!(deepest < most, "case {case}: {deepest:e} of {most:e}");
        worst_gain = worst_gain.max(gain);
    }
    assert!(worst_gain < 1e-2, "{worst_gain:e}");
}

/// Contact events tell of contacts of mechanisms as of others.
#[test]
fn events_tell_what_a_mechanism_touches() {
    let mut rig = Rig::new(down(), 1.0 / 60.0, 4);
    let material = Material::default();
    ground(&mut rig.world, material, quat(DQuat::IDENTITY));
    let half = DVec3::new(0.2, 0.1, 0.1);
    let body = block(&mut rig, half, 2.0, (DVec3::Y * 0.3, DQuat::IDENTITY), material, false);
    let (mut begun, mut pushed) = (0, 0.0);
    for _ in 0..60 {
        rig.step();
        begun += rig.simulation.contact_events().filter(|event| matches!(event, ContactEvent::Begin(..))).count();
        pushed = rig.simulation.contacts().map(|contact| f64::from(contact.impulse().length())).sum::<f64>();
    }
    assert_eq!(begun, 2, "each half begins to touch once");
    let expected = 2.0 * G / 240.0;
    assert!((pushed / expected - 1.0).abs() < 1e-4, "{pushed} of {expected} N s");
    assert!(rig.world.get::<&Velocity>(body).unwrap().linear.length() < 1e-4);
    assert!(rig.world.get::<&Collider>(body).is_ok());
}
