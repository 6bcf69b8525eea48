//! Promise: a body that swings on a joint and strikes or scrapes the ground gains no energy: after
//! seconds of it there is no more than 1 % of its weight by its size beyond what it began with. At
//! no time is there more beyond the least so far than 2.5 `g h / v` of that, with the substep `h`
//! and the speed `v` of a fall by its size.
//!
//! Over ground that it does not touch it moves as without.
//!
//! Why: free, a mechanism has half of the kick of forces before it moves on and half after; with
//! contacts, all before. Where it goes from one to the other without the half that is between, it
//! is faster by that half on its way down, and again on its way up.

use glam::{DQuat, DVec3};
use tumble::math::{Quat, Real};
use tumble::{Joint, Material, RigidBody, Shape};
use tumble_tests::references::real_quat;
use tumble_tests::touching::{collider, ground, surfaced};
use tumble_tests::{Draw, cases};

use crate::jointed::*;

#[test]
fn what_scrapes_the_ground_gains_no_energy() {
    let kinds: [fn(hecs::Entity, hecs::Entity) -> Joint; 3] = [Joint::hinge, Joint::universal, Joint::ball];
    for case in 0..u64::from(cases(160)) {
        let mut draw = Draw::new(0x5C4A, case);
        let (size, kind) = (draw.log_between(0.02, 2.0), case as usize % 3);
        let (rate, substeps) = (draw.log_between(60.0, 240.0), 4 << (case / 3 % 3));
        let mut rig = Rig::new(down(), 1.0 / rate, substeps);
        let material = Material::new(draw.between(0.0, 1.0) as Real, 0.0);
        ground(&mut rig.world, material, Quat::IDENTITY);
        let shape = match case % 4 {
            0 => Shape::sphere(0.2 * size),
            1 => Shape::cylinder(0.25 * size, 0.1 * size),
            _ => Shape::cuboid([0; 3].map(|_| draw.between(0.06, 0.26) * size)),
        };
        let at = DVec3::Y * (size * draw.between(0.55, 1.0));
        let arm = draw.direction();
        let arm = DVec3::new(arm.x, arm.y.abs(), arm.z) * (0.5 * size);
        let axis = draw.direction();
        let about = if kind == 0 { axis } else { draw.direction() };
        let turning = about * (2.0 * draw.between(0.0, 1.0) * (G / size).sqrt());
        let base = rig.ground();
        let body = RigidBody::new(shape.clone()).mass(1.0).position(real(at + arm));
        let body = body.orientation(real_quat(DQuat::from_rotation_arc(DVec3::Y, draw.direction())));
        let body = body.linear_velocity(real(turning.cross(arm))).angular_velocity(real(turning));
        let body = body.build().unwrap().spawn_with(&mut rig.world, (surfaced(collider(&shape), material),));
        rig.join_at(kinds[kind](base, body), at, axis);
        rig.step();
        let begin = rig.energy();
        let (mut least, mut rise) = (begin, 0.0_f64);
        while rig.simulation.time() < 8.0 * size.sqrt() {
            rig.step();
            let energy = rig.energy();
            least = least.min(energy);
            rise = rise.max(energy - least);
        }
        let scale = G * size;
        let most = 2.5 * (G / size).sqrt() / (rate * f64::from(substeps));
        let gained = (rig.energy() - begin) / scale;
        println!("case {case}: {:.3} of the most, {gained:.1e} at the end", rise / (most * scale));
        assert!(rise < most * scale, "case {case}, {size} m: {} of {most}", rise / scale);
        assert!(gained < 0.01, "case {case}, {size} m: {gained}");
    }
}

/// Two rods on hinges that swing through their lowest place, over ground or none: the widest gap of
/// the joints, of the size, and how far the energy is from that of the start, of weight and size;
/// nothing where they touch.
fn swings(case: u64, has_ground: bool) -> Option<[f64; 2]> {
    let mut draw = Draw::new(0x5C4B, case);
    let size = draw.log_between(0.1, 5.0);
    let (clear, ratio) = (draw.between(0.05, 0.3) * size, draw.log_between(1.0, 100.0));
    let mut rig = Rig::new(down(), 1.0 / draw.log_between(60.0, 240.0), 4 << (case % 3));
    let up = DVec3::Y * (2.0 * size + clear);
    if has_ground {
        ground(&mut rig.world, Material::default(), Quat::IDENTITY);
    }
    let mut last = rig.ground();
    for number in 0..2 {
        let left = up + DVec3::X * size * f64::from(number);
        let shape = Shape::cuboid(DVec3::new(0.49, 0.02, 0.02) * size);
        let body = RigidBody::new(shape).mass(if number == 0 { ratio } else { 1.0 });
        let body = rig.spawn(body.position(real(left + DVec3::X * 0.5 * size)));
        rig.join_at(Joint::hinge(last, body), left, DVec3::Z);
        last = body;
    }
    rig.step();
    let (start, scale) = (rig.energy(), (1.0 + ratio) * G * size);
    let [mut gap, mut off] = [0.0_f64; 2];
    while rig.simulation.time() < 6.0 * size.sqrt() {
        rig.step();
        gap = gap.max(rig.largest_gap() / size);
        off = off.max((rig.energy() - start).abs() / scale);
        if rig.simulation.contacts().any(|contact| contact.points().iter().any(|point| point.impulse > 0.0)) {
            return None;
        }
    }
    Some([gap, off])
}

#[test]
fn ground_that_is_not_touched_changes_nothing() {
    let mut count = 0;
    for case in 0..u64::from(cases(60)) {
        let (Some(over), Some(free)) = (swings(case, true), swings(case, false)) else { continue };
        println!("case {case}: gap and energy {over:?}, without ground {free:?}");
        assert!(over[0] < 2e-6 + 2.0 * free[0], "case {case}: gap {over:?}, without ground {free:?}");
        assert!(over[1] < 2e-4 + 2.0 * free[1], "case {case}: energy {over:?}, without ground {free:?}");
        count += 1;
    }
    assert!(count > cases(60) * 9 / 10, "{count}");
}
