//! Promise: a chain of a hundred links carries a thousand times a link's mass without stretching:
//! every joint has the load that hangs below it, gaps stay within a fifth of a millimetre while it
//! swings, and at a hundred thousand times the mass it still makes no energy.
//!
//! Why: ropes and chains that give, or explode, are what joints in passes are known for. It fails
//! if a link turns faster under its load than a substep can follow, if inertia that is raised for
//! that makes energy, or if the direct solution loses digits along the chain.

use crate::jointed::*;
use glam::DVec3;
use hecs::Entity;
use tumble::{Damping, Joint, Pose};
use tumble_tests::{by_precision, dvec3};

const LINKS: usize = 100;
const LINK: f64 = 0.1;

/// Links of 1 kg that hang from the ground by ball joints, with a mass at the end that goes
/// sideways. Returns the joints from above and what hangs at the end.
fn chain(load: f64, speed: f64) -> (Rig, Vec<Entity>, Entity) {
    let mut rig = Rig::new(down(), 1.0 / 60.0, 4);
    let mut above = rig.ground();
    let mut joints = Vec::new();
    for i in 0..LINKS {
        let top = DVec3::NEG_Y * (LINK * i as f64);
        let link = turned(rod(1.0, LINK, top + DVec3::NEG_Y * (0.5 * LINK)), DVec3::Z, -std::f64::consts::FRAC_PI_2);
        let link = rig.spawn(link);
        joints.push(rig.join_at(Joint::ball(above, link), top, DVec3::X));
        above = link;
    }
    let end = DVec3::NEG_Y * (LINK * LINKS as f64);
    // A ball of the density of water.
    let radius = (load / 4190.0_f64).cbrt();
    let weight = body(load, DVec3::splat(0.4 * load * radius * radius), end);
    let weight = rig.spawn(weight.linear_velocity(real(DVec3::X * speed)));
    joints.push(rig.join_at(Joint::ball(above, weight), end, DVec3::X));
    (rig, joints, weight)
}

/// In single precision the gaps of joints are roundings of the places of their bodies, of one sign
/// as often as of the other: a hundred joints sink by less than one of them.
#[test]
fn a_hanging_chain_carries_its_weight() {
    for load in [1.0, 1e3, 1e5] {
        let (mut rig, joints, weight) = chain(load, 0.0);
        let start = rig.position(weight);
        rig.run_to(2.0);
        let mut worst = 0.0_f64;
        for (i, joint) in joints.iter().enumerate() {
            let below = (LINKS - i) as f64 + load;
            worst = worst.max((dvec3(rig.load(*joint).force) / (below * G) - DVec3::Y).length());
        }
        let (gap, sunk) = (rig.largest_gap(), (rig.position(weight) - start).length());
        println!("1 : {load}: loads off by {worst:.1e}, gaps {gap:.1e} m, sunk by {sunk:.1e} m");
        assert!(worst <= by_precision(1e-6, 1e-12), "{load}: {worst:e}");
        assert!(gap <= by_precision(2e-6, 1.4e-11) && sunk <= by_precision(2e-8, 1.4e-9), "{load}: {gap:e}, {sunk:e}");
    }
}

/// The weight is pushed at 5 m/s while the links are at rest, and swings for ten seconds.
#[test]
fn a_swung_chain_does_not_stretch() {
    for load in [1.0, 1e3] {
        let (mut rig, _, weight) = chain(load, 5.0);
        let (mut gap, mut stretch) = (0.0_f64, f64::MIN);
        let (start, mut energy) = (rig.energy(), [0.0_f64; 2]);
        for _ in 0..600 {
            rig.step();
            gap = gap.max(rig.largest_gap());
            stretch = stretch.max(rig.position(weight).length() / (LINK * LINKS as f64) - 1.0);
            let change = (rig.energy() - start) / (0.5 * load * 25.0);
            energy = [energy[0].min(change), energy[1].max(change)];
        }
        println!("1 : {load}: gaps {gap:.1e} m, stretch {stretch:.1e}, energy {energy:?} of the swing's");
        assert!(gap <= by_precision(4e-6, 4e-7) && stretch <= 1e-6, "{load}: {gap:e} m, {stretch:e}");
        assert!(energy[1] <= 1e-3, "{load}: {energy:?}");
    }
}

#[test]
fn a_chain_with_a_hundred_thousand_links_mass_makes_no_energy() {
    let (mut rig, ..) = chain(1e5, 5.0);
    let (start, mut most, mut gap) = (rig.energy(), f64::MIN, 0.0_f64);
    for _ in 0..600 {
        rig.step();
        let totals = rig.totals();
        assert_eq!(totals.non_finite, None);
        most = most.max((totals.energy() - start) / (0.5 * 1e5 * 25.0));
        gap = gap.max(rig.largest_gap());
    }
    println!("energy at most {most:.1e} of the swing's above the start, gaps {gap:.1e} m");
    assert!(most <= 1e-3 && gap <= by_precision(4e-6, 3e-9), "{most:e}, {gap:e}");
}

/// Links under load are given more inertia within a step; what joints tell is of the bodies as they
/// are.
#[test]
fn the_speeds_of_a_loaded_joint_are_those_of_its_bodies() {
    let (mut rig, joints, _) = chain(1e3, 5.0);
    let mut fastest = 0.0_f64;
    for _ in 0..60 {
        rig.step();
        for joint in &joints[1..] {
            let [a, b] = rig.world.get::<&Joint>(*joint).unwrap().bodies;
            let turning = (rig.angular_velocity(b) - rig.angular_velocity(a)).length();
            let load = rig.load(*joint);
            let told = load.speeds[3..].iter().map(|speed| f64::from(*speed).powi(2)).sum::<f64>().sqrt();
            assert!((told - turning).abs() <= by_precision(2e-5, 1e-12) * (1.0 + turning), "{told} of {turning} rad/s");
            assert!(load.speeds[..3].iter().all(|speed| f64::from(speed.abs()) <= by_precision(1e-4, 1e-6)));
            fastest = fastest.max(turning);
        }
    }
    assert!(fastest > 1.0, "{fastest} rad/s");
}

/// Links of two lengths, at rest between two points of one height, two metres apart: their joints
/// are on `y = a cosh(x / a)` to the square of a link's length.
#[test]
fn a_chain_between_two_points_hangs_along_a_catenary() {
    let a = 0.8_f64;
    let errors = [20, 40].map(|links| {
        let mut rig = Rig::new(down(), 1.0 / 60.0, 4);
        let ground = rig.ground();
        let reach = a * (1.0 / a).sinh();
        let points: Vec<_> = (0..=links)
            .map(|number| {
                let x = a * (reach * (2.0 * f64::from(number) / f64::from(links) - 1.0) / a).asinh();
                DVec3::new(x, a * (x / a).cosh(), 0.0)
            })
            .collect();
        let (mut last, mut joints) = (ground, Vec::new());
        for ends in points.windows(2) {
            let apart = ends[1] - ends[0];
            let link = turned(rod(1.0, apart.length(), 0.5 * (ends[0] + ends[1])), DVec3::Z, apart.y.atan2(apart.x));
            let link = rig.spawn(link);
            rig.world.insert_one(link, Damping { linear: 1.0, angular: 1.0 }).unwrap();
            joints.push(rig.join_at(Joint::ball(last, link), ends[0], DVec3::X));
            last = link;
        }
        joints.push(rig.join_at(Joint::ball(last, ground), points[points.len() - 1], DVec3::X));
        rig.run_to(20.0);
        let mut worst = 0.0_f64;
        for joint in &joints {
            let joint = *rig.world.get::<&Joint>(*joint).unwrap();
            let pose = *rig.world.get::<&Pose>(joint.bodies[0]).unwrap();
            let at = dvec3(pose.transform_point(joint.frames[0].position));
            worst = worst.max((at.y - a * (at.x / a).cosh()).abs());
        }
        // Half the weight of all hangs on each end, less what damping of 1/s takes of gravity's
        // impulse in half a substep.
        let load = f64::from(rig.load(joints[0]).force.y) / (0.5 * f64::from(links) * G * (1.0 - 0.25 / 240.0));
        println!("{links} links: off the catenary by {worst:.1e} m, load {load}");
        assert!((load - 1.0).abs() < 1e-5, "{load}");
        worst
    });
    let link = 2.0 * a * (1.0 / a).sinh() / 20.0;
    assert!(errors[0] <= link * link, "{errors:?}");
    assert!((errors[0] / errors[1] - 4.0).abs() < 0.3, "{errors:?}");
}
