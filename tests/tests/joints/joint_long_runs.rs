//! Promise: Foucault's pendulum turns its plane by the sine of the latitude, and is where the
//! spherical pendulum's equation has it; a double pendulum and one in a ring with mass keep their
//! energy for a thousand periods.
//!
//! Why: what a substep loses or turns is seen only in the sum over many. It fails if a ball joint
//! drags what it holds along with a support that turns, if a support that is carried round is taken
//! at its place of another time, or if rounding or the coupling of two joints has a trend.

use std::f64::consts::PI;

use crate::jointed::*;
use glam::{DQuat, DVec3};
use tumble::{Joint, RigidBody, Shape};
use tumble_tests::references::real_quat;
use tumble_tests::{DOUBLE, by_precision};

/// How fast the support goes round [rad/s], and the sine of the latitude.
const TURN: f64 = 0.25;
const SINE: f64 = 0.7528;

/// From the axis to the pivot \[m\]: there gravity and the centrifugal force
/// are as at the latitude.
fn reach() -> f64 {
    G * (1.0 - SINE * SINE).sqrt() / SINE / (TURN * TURN)
}

/// The direction of a rod of 1 m on a ball joint that is carried round, after its rate [1/s]: no
/// torque acts along it, so it is a spherical pendulum of two thirds of a metre.
fn exact_direction([mut x, mut rate]: [DVec3; 2], time: f64) -> DVec3 {
    let acceleration = |time: f64, x: DVec3, rate: DVec3| {
        let outward = DQuat::from_rotation_y(TURN * time) * (DVec3::X * reach() * TURN * TURN);
        let pull = (down() + outward) * 1.5;
        pull - x * (x.dot(pull) + rate.length_squared())
    };
    let steps = (time * 2000.0).round();
    let h = time / steps;
    for step in 0..steps as u32 {
        let t = h * f64::from(step);
        let (a1, r1) = (acceleration(t, x, rate), rate);
        let (a2, r2) = (acceleration(t + 0.5 * h, x + r1 * (0.5 * h), rate + a1 * (0.5 * h)), rate + a1 * (0.5 * h));
        let (a3, r3) = (acceleration(t + 0.5 * h, x + r2 * (0.5 * h), rate + a2 * (0.5 * h)), rate + a2 * (0.5 * h));
        let (a4, r4) = (acceleration(t + h, x + r3 * h, rate + a3 * h), rate + a3 * h);
        x += (r1 + 2.0 * r2 + 2.0 * r3 + r4) * (h / 6.0);
        rate += (a1 + 2.0 * a2 + 2.0 * a3 + a4) * (h / 6.0);
    }
    x
}

/// Directions of the pendulum as the support sees it, by step, and how far the last is off.
fn foucault(substeps: u32, time: f64) -> (Vec<DVec3>, f64) {
    let (pivot, turn) = (DVec3::X * reach(), DVec3::Y * TURN);
    let mut rig = Rig::new(down(), 1.0 / 60.0, substeps);
    let support = RigidBody::new(Shape::Point).kinematic().angular_velocity(real(turn));
    let support = rig.spawn(support);
    // At rest as the support sees it, 0.05 rad to the side; the spin along the rod is none.
    let hanging = (down() + pivot * TURN * TURN).normalize();
    let start = DQuat::from_axis_angle(hanging.cross(DVec3::Z).normalize(), 0.05) * hanging;
    let rate = turn.cross(start);
    let it = rod(1.0, 1.0, pivot + start * 0.5).linear_velocity(real(turn.cross(pivot) + rate * 0.5));
    let it = it.angular_velocity(real(start.cross(rate)));
    let it = rig.spawn(it.orientation(real_quat(DQuat::from_rotation_arc(DVec3::X, start))));
    rig.join_at(Joint::ball(support, it), pivot, DVec3::X);
    let mut seen = Vec::new();
    let mut last = start;
    while rig.simulation.time() < time - 1e-3 {
        rig.step();
        last = rig.orientation(it) * DVec3::X;
        seen.push(rig.orientation(support).conjugate() * last);
    }
    (seen, (last - exact_direction([start, rate], rig.simulation.time())).length())
}

/// The rate at which a plane of swing turns about the way up [rad/s], by the main axes of what is
/// swept in each period, given in steps.
fn precession(seen: &[DVec3], up: DVec3, period: usize) -> f64 {
    let east = DVec3::Z;
    let north = up.cross(east);
    let angle = |part: &[DVec3]| {
        let [mut along, mut across] = [0.0; 2];
        for x in part {
            let (e, n) = (x.dot(east), x.dot(north));
            along += e * e - n * n;
            across += 2.0 * e * n;
        }
        0.5 * across.atan2(along)
    };
    let angles: Vec<f64> = seen.chunks_exact(period).map(angle).collect();
    let turned = angles.windows(2).map(|pair| (pair[1] - pair[0] + 0.5 * PI).rem_euclid(PI) - 0.5 * PI);
    turned.sum::<f64>() * 60.0 / (period * (angles.len() - 1)) as f64
}

#[test]
fn foucaults_plane_turns_by_the_sine_of_the_latitude() {
    let up = -(down() + DVec3::X * reach() * TURN * TURN).normalize();
    let period = (2.0 * PI / (1.5 * G / SINE).sqrt() * 60.0).round() as usize;
    let runs = [4, 8].map(|substeps| foucault(substeps, 60.0));
    let rate = precession(&runs[0].0, up, period);
    let off = [runs[0].1, runs[1].1];
    println!("turns at {rate} of {} rad/s, after 60 s off by {off:?} of its length", -TURN * SINE);
    // The centrifugal force changes over the swing, by the square of TURN over 4.4 rad/s.
    assert!((rate / (-TURN * SINE) - 1.0).abs() < 1e-2, "{rate}");
    assert!(off[0] < by_precision(2.5e-3, 1e-3) && (!DOUBLE || (off[0] / off[1] - 4.0).abs() < 0.3), "{off:?}");
}

/// The mean energy of each tenth of a run \[J\], from the start's, and the farthest from it.
fn energies(mut rig: Rig, steps: u32) -> ([f64; 10], f64) {
    let (start, mut farthest) = (rig.energy(), 0.0_f64);
    let means = [(); 10].map(|()| {
        let mut sum = 0.0;
        for _ in 0..steps / 10 {
            rig.step();
            let energy = rig.energy() - start;
            farthest = farthest.max(energy.abs());
            sum += energy;
        }
        sum / f64::from(steps / 10)
    });
    (means, farthest)
}

/// Two rods of 1 m and 1 kg, let go at an angle from straight down.
fn double_pendulum(angle: f64) -> Rig {
    let mut rig = Rig::new(down(), 1.0 / 60.0, 4);
    let ground = rig.ground();
    let along = DVec3::new(angle.sin(), -angle.cos(), 0.0);
    let rods = [0.5, 1.5].map(|way| turned(rod(1.0, 1.0, along * way), DVec3::Z, angle - 0.5 * PI));
    let rods = rods.map(|rod| rig.spawn(rod));
    rig.join_at(Joint::hinge(ground, rods[0]), ORIGIN, DVec3::Z);
    rig.join_at(Joint::hinge(rods[0], rods[1]), along, DVec3::Z);
    rig
}

/// A rod that hangs in a ring of half its mass, hinged across the ring's own hinge, and is pushed
/// sideways.
fn pendulum_in_a_ring() -> Rig {
    let mut rig = Rig::new(down(), 1.0 / 60.0, 4);
    let ground = rig.ground();
    let angle = 1.0_f64;
    let along = DVec3::new(angle.sin(), -angle.cos(), 0.0);
    let ring = rig.spawn(turned(body(0.5, DVec3::new(0.02, 0.03, 0.02), ORIGIN), DVec3::Z, angle));
    let push = along.cross(DVec3::Z) * 2.0;
    let it = turned(rod(1.0, 1.0, along * 0.5), DVec3::Z, angle - 0.5 * PI);
    let it = rig.spawn(turning_about(it, along * 0.5, ORIGIN, push));
    rig.join_at(Joint::hinge(ground, ring), ORIGIN, DVec3::Z);
    rig.join_at(Joint::hinge(ring, it), ORIGIN, along.cross(DVec3::Z));
    rig
}

/// At 240 substeps a second. Where the map is symplectic, energy swings by a multiple of `(w h)^2`.
#[test]
fn pendulums_of_two_joints_keep_their_energy_for_a_thousand_periods() {
    // Of small swings: the slow mode of two rods, and a rod alone.
    let periods = [2.0 * PI / (0.7322 * G).sqrt(), 2.0 * PI / (1.5 * G).sqrt()];
    let rigs = [("double", double_pendulum(0.8), 2.0 * G), ("in a ring", pendulum_in_a_ring(), 0.5 * G)];
    for ((name, rig, swing), period) in rigs.into_iter().zip(periods) {
        let (means, farthest) = energies(rig, (1000.0 * period * 60.0) as u32);
        let trend = (means[9] - means[0]) / swing;
        println!("{name}: of the swing's {means:?} J, trend {trend:.1e}, {:.1e} off at most", farthest / swing);
        // Five times what is measured; the means of a tenth are of swings that do not repeat.
        assert!(trend.abs() < by_precision(1e-4, 5e-8), "{name}: {trend:e}");
        assert!(farthest / swing < 1.5e-4, "{name}: {farthest:e}");
    }
}
