//! Promise: a figure of jointed bodies that falls on the ground comes to rest there, and no body
//! sinks in by more than a small part of its size.
//!
//! Why: with all contacts solved together with the joints, such figures go on to tremble. It fails
//! if what lies on many contacts is not left to passes, or if passes are left more than they carry.

use crate::direct_contacts::{cuboid, lowest, weight};
use crate::jointed::*;
use glam::DVec3;
use hecs::Entity;
use tumble::math::Real;
use tumble::{Axes, Joint, JointFriction, Limits, Material};
use tumble_tests::touching::ground;
use tumble_tests::{Draw, cases, quat};

/// Figures of a trunk and limbs on balls with cones and friction, which lie on many contacts in the
/// end: they come to rest, and no body sinks in.
#[test]
fn figures_lie_still() {
    let (all, mut restless) = (cases(20), 0);
    for case in 0..u64::from(all) {
        let mut draw = Draw::new(0xd9, case);
        let size = draw.log_between(0.02, 10.0);
        // A free fall in a substep goes a thousandth of the size at most.
        let least = (1.0 / 60.0 / (1e-3 * size / G).sqrt()).ceil() as u32;
        let mut rig = Rig::new(down(), 1.0 / 60.0, least + draw.between(0.0, 8.0) as u32);
        let material = Material::new(draw.between(0.3, 0.8) as Real, 0.0);
        ground(&mut rig.world, material, quat(glam::DQuat::IDENTITY));
        let bodies = figure(&mut rig, &mut draw, size, material);
        let weight = weight(&rig) * size;
        rig.run_to(6.0 * size.sqrt().max(0.3));
        let (moving, mut deepest) = (rig.totals().kinetic() / weight, 0.0_f64);
        for (body, half) in &bodies {
            deepest = deepest.max(-lowest(&rig, *body, *half) / half.min_element());
        }
        println!("case {case}: moving {moving:e}, deepest {deepest:e}, {size} m");
        // In passes a load presses a body in by a tenth of its radius of gyration at most.
        assert!(deepest < 0.1, "case {case}: {deepest:e}");
        restless += u32::from(moving > 1e-7);
    }
    assert!(restless <= all.div_ceil(10), "{restless} of {all}");
}

/// A trunk with four limbs of two parts, of masses up to three times apart, above the ground.
fn figure(rig: &mut Rig, draw: &mut Draw, size: f64, material: Material) -> Vec<(Entity, DVec3)> {
    let turn = draw.orientation();
    let mut mass = |volume: f64| 1e3 * volume * size.powi(3) * draw.log_between(0.6, 1.7);
    let friction = JointFriction::along(Axes::ANGULAR, (3e-3 * size.powi(4) * G) as Real);
    let at = DVec3::Y * size * 1.5;
    let half = DVec3::new(0.3, 0.15, 0.1) * size;
    let trunk = cuboid(rig, half, mass(0.036), at, turn, material);
    let mut bodies = vec![(trunk, half)];
    for (x, z) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
        let half = DVec3::new(0.15, 0.05, 0.05) * size;
        let (mut before, mut end) = (trunk, at + turn * DVec3::new(0.3 * x, 0.0, 0.05 * z) * size);
        for _ in 0..2 {
            let along = turn * DVec3::X * x * half.x;
            let body = cuboid(rig, half, mass(0.003), end + along, turn, material);
            let joint = rig.join_at(Joint::ball(before, body), end, along.normalize());
            rig.world.insert(joint, (Limits::cone(0.8), friction)).unwrap();
            bodies.push((body, half));
            (before, end) = (body, end + 2.0 * along);
        }
    }
    bodies
}
