//! Promise: a body that swings on a joint and strikes or scrapes the ground gains no energy: after
//! seconds of it there is no more than 1 % of its weight by its size beyond what it began with. At
//! no time is there more beyond the least so far than 2.5 `g h / v` of that, with the substep `h`
//! and the speed `v` of a fall by its size.
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
use crate::pressed_mechanisms::direction;

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
        let arm = direction(&mut draw);
        let arm = DVec3::new(arm.x, arm.y.abs(), arm.z) * (0.5 * size);
        let axis = direction(&mut draw);
        let about = if kind == 0 { axis } else { direction(&mut draw) };
        let turning = about * (2.0 * draw.between(0.0, 1.0) * (G / size).sqrt());
        let base = rig.ground();
        let body = RigidBody::new(shape.clone()).mass(1.0).position(real(at + arm));
        let body = body.orientation(real_quat(DQuat::from_rotation_arc(DVec3::Y, direction(&mut draw))));
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
