//! Promise: closed loops of hinges, of which every one in a plane has redundant rows, keep their
//! geometry, whether driven or free: a slider-crank at every angle of its crank, and in both
//! precisions a parallelogram through the positions in which all its links lie in one line. Energy
//! has no drift beyond 3e-5 of what the parallelogram swings with, to 200 m from the origin but for
//! rounding there, and no force stands across the plane, where nothing pulls. Friction in the
//! joints of a loop opens none of them.
//!
//! Why: loops make the matrix of the joints singular, for good and at single positions. It fails if
//! redundant rows push against each other, if what they push raises inertia, if the solution leaves
//! the branch that the links move on, or if rounding of poses counts as joints that do not fit.

use std::f64::consts::{FRAC_PI_2, TAU};

use crate::jointed::*;
use glam::{DQuat, DVec3};
use hecs::Entity;
use tumble::math::Real;
use tumble::{Axes, Joint, JointFriction, Pose, RigidBody, Shape};
use tumble_tests::references::real_quat;
use tumble_tests::{DOUBLE, Draw, EPSILON, by_precision, cases};

/// Crank and connecting rod \[m\].
const CRANK: f64 = 0.3;
const LINK: f64 = 0.8;

/// What goes wrong with a slider-crank in 20 s.
#[derive(Default)]
struct Worst {
    /// Of the slider, and of the joints \[m\].
    place: f64,
    gap: f64,
    /// Of the start's energy.
    energy: f64,
    /// Across the plane \[N\].
    across: f64,
}

/// Runs a slider-crank from the crank's angle of 90 degrees, where the rod moves along without
/// turning. The crank is a kinematic body at 8 rad/s, or a flywheel on a hinge.
fn slider_crank(is_driven: bool) -> Worst {
    let mut rig = Rig::new(down(), 1.0 / 60.0, 4);
    let ground = rig.ground();
    let turn = DVec3::Z * 8.0;
    let mut joints = Vec::new();
    let crank = if is_driven {
        rig.spawn(RigidBody::new(Shape::Point).kinematic().angular_velocity(real(turn)))
    } else {
        let crank = rig.spawn(body(5.0, DVec3::new(0.1, 0.1, 0.2), ORIGIN).angular_velocity(real(turn)));
        joints.push(rig.join_at(Joint::hinge(ground, crank), ORIGIN, DVec3::Z));
        crank
    };
    let (foot, pin) = (DVec3::X * (LINK * LINK - CRANK * CRANK).sqrt(), DVec3::Y * CRANK);
    let along = DQuat::from_rotation_arc(DVec3::X, (foot - pin).normalize());
    let velocity = turn.cross(pin);
    let link = rod(1.0, LINK, 0.5 * (foot + pin)).orientation(real_quat(along));
    let link = rig.spawn(link.linear_velocity(real(velocity)));
    let block = rig.spawn(body(2.0, DVec3::splat(0.01), foot).linear_velocity(real(velocity)));
    joints.push(rig.join_at(Joint::hinge(crank, link), pin, DVec3::Z));
    joints.push(rig.join_at(Joint::hinge(link, block), foot, DVec3::Z));
    joints.push(rig.join_at(Joint::slider(ground, block), foot, DVec3::X));
    let (start, mut worst) = (rig.energy(), Worst::default());
    for _ in 0..1200 {
        rig.step();
        let pin = rig.orientation(crank) * (DVec3::Y * CRANK);
        let exact = DVec3::X * (pin.x + (LINK * LINK - pin.y * pin.y).sqrt());
        worst.place = worst.place.max((rig.position(block) - exact).length());
        worst.gap = worst.gap.max(rig.largest_gap());
        worst.energy = worst.energy.max((rig.energy() / start - 1.0).abs());
        let across = joints.iter().map(|joint| f64::from(rig.load(*joint).force.z).abs());
        worst.across = across.fold(worst.across, f64::max);
    }
    let Worst { place, gap, energy, across } = worst;
    println!("driven {is_driven}: slider off by {place:.1e} m, gaps {gap:.1e} m, energy {energy:.1e}, {across:.1e} N");
    worst
}

/// `r cos f + sqrt(l^2 - r^2 sin^2 f)` of the angle at which the crank is.
#[test]
fn a_driven_slider_crank_keeps_its_geometry() {
    let worst = slider_crank(true);
    assert!(worst.place <= by_precision(2e-6, 2e-10), "{:e}", worst.place);
    assert!(worst.gap <= by_precision(2e-6, 1e-10), "{:e}", worst.gap);
}

/// 20 rows for 17 degrees of freedom. All forces are in the plane: across it may be what takes a
/// tenth of a rounding of the 0.8 m long rod of 1 kg out within a substep.
#[test]
fn a_flywheel_drives_a_slider_crank() {
    let worst = slider_crank(false);
    assert!(worst.place <= by_precision(2e-6, 2e-8), "{:e}", worst.place);
    assert!(worst.gap <= by_precision(2e-6, 2e-8), "{:e}", worst.gap);
    assert!(worst.energy <= 1e-3, "{:e}", worst.energy);
    let rounding = EPSILON * LINK * 240.0 * 240.0;
    assert!(worst.across <= 0.1 * rounding, "{:e} N", worst.across);
}

/// The angle of a parallelogram's cranks by the classical fourth-order method.
fn exact_crank(mut angle: f64, mut rate: f64, time: f64) -> f64 {
    let acceleration = |angle: f64| -1.2 * G * angle.cos();
    let steps = (time / 2e-4).ceil();
    let h = time / steps;
    for _ in 0..steps as u32 {
        let (a1, r1) = (acceleration(angle), rate);
        let (a2, r2) = (acceleration(angle + 0.5 * h * r1), rate + 0.5 * h * a1);
        let (a3, r3) = (acceleration(angle + 0.5 * h * r2), rate + 0.5 * h * a2);
        let (a4, r4) = (acceleration(angle + h * r3), rate + h * a3);
        angle += h / 6.0 * (r1 + 2.0 * r2 + 2.0 * r3 + r4);
        rate += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
    }
    angle
}

/// Three rods of 1 m and 1 kg in a parallelogram whose cranks go all the way round for ten seconds,
/// from their lowest position at a rate [rad/s]. Four hinges have 20 rows for 17 degrees of
/// freedom, and 20 for 16 where all lie in one line and the linkage could fold. Its energy is
/// `5/6 f'^2 + 2 g sin f`. The whole is moved by an offset \[m\], to whose rounding joints are met.
/// Returns how far off the coupler is \[m\].
fn parallelogram(rate: f64, substeps: u32, offset: DVec3) -> f64 {
    let mut rig = Rig::new(down(), 1.0 / 60.0, substeps);
    let ground = rig.ground();
    let turn = DVec3::Z * rate;
    let center = DVec3::Y * -0.5;
    let cranks: [Entity; 2] = [0.0, 1.0].map(|x| {
        let pivot = DVec3::X * x;
        let crank = turned(rod(1.0, 1.0, center + pivot), DVec3::Z, -FRAC_PI_2);
        let crank = rig.spawn(turning_about(crank, center, ORIGIN, turn));
        rig.join_at(Joint::hinge(ground, crank), pivot, DVec3::Z);
        crank
    });
    let coupler = rod(1.0, 1.0, DVec3::new(0.5, -1.0, 0.0)).linear_velocity(real(turn.cross(DVec3::NEG_Y)));
    let coupler = rig.spawn(coupler);
    for (x, crank) in [0.0, 1.0].into_iter().zip(cranks) {
        rig.join_at(Joint::hinge(crank, coupler), DVec3::new(x, -1.0, 0.0), DVec3::Z);
    }
    rig.world.query_mut::<&mut Pose>().into_iter().for_each(|pose| pose.position += real(offset));
    let start = rig.energy();
    let (mut off, mut gap, mut drift) = (0.0_f64, 0.0_f64, 0.0_f64);
    for _ in 0..600 {
        rig.step();
        let angle = exact_crank(-FRAC_PI_2, rate, rig.simulation.time());
        let pin = DVec3::new(angle.cos(), angle.sin(), 0.0);
        off = off.max((rig.position(coupler) - offset - DVec3::X * 0.5 - pin).length());
        gap = gap.max(rig.largest_gap());
        drift = drift.max((rig.energy() - start).abs() / (4.0 * G));
    }
    let far = offset.length();
    println!("{far:.0} m, {rate} rad/s, {substeps} substeps: off by {off:.1e} m, gaps {gap:.1e}, energy {drift:.1e}");
    let finer = f64::from(substeps) / 16.0;
    assert!(gap <= by_precision(1e-6, 1e-8) + 2.0 * EPSILON * far, "{far} m, {rate} rad/s, {substeps}: {gap:e}");
    // Twice what 600 steps that begin with such a rounding of poses are measured to do.
    let most = by_precision(3e-5, 3e-5 / (finer * finer)) + 20.0 * EPSILON * far;
    assert!(drift <= most, "{far} m, {rate} rad/s, {substeps}: {drift:e}");
    off
}

#[test]
fn a_parallelogram_goes_through_its_singular_positions() {
    for rate in [8.0, 8.274, 8.548] {
        let errors = [16, 32].map(|substeps| parallelogram(rate, substeps, ORIGIN));
        assert!(!DOUBLE || (errors[0] / errors[1] - 4.0).abs() <= 0.4, "{rate} rad/s: {errors:?}");
        // Three times what is measured; a coupler that folds is off by metres.
        assert!(errors[0] <= 3e-3 && errors[1] <= by_precision(1.1e-3, 8e-4), "{rate} rad/s: {errors:?}");
    }
}

#[test]
fn a_parallelogram_far_from_the_origin_keeps_its_energy() {
    for case in 0..u64::from(cases(12)) {
        let mut draw = Draw::new(0xE4, case);
        let offset = draw.direction() * draw.log_between(1.0, 200.0);
        parallelogram(draw.between(8.0, 8.6), 16 + draw.between(0.0, 16.0) as u32, offset);
    }
}

/// Bars in a polygon that turns freely, joined at its corners by balls or hinges with friction.
#[test]
fn loops_with_friction_stay_closed() {
    for case in 0..u64::from(cases(120)) {
        let mut draw = Draw::new(0x10F5, case);
        let (size, sides) = (draw.log_between(0.01, 100.0), 3 + case as usize % 4);
        let (rate, substeps) = (draw.log_between(30.0, 240.0), 1 << draw.between(1.0, 4.99) as u32);
        let mut rig = Rig::new(DVec3::ZERO, 1.0 / rate, substeps);
        // Less than 0.1 rad in a substep.
        let turning = draw.log_between(0.01, 0.1) * rate * f64::from(substeps);
        let turning = turning.min(20.0) * DVec3::new(0.3, draw.between(0.0, 1.0), 1.0).normalize();
        let corner = |k: usize| size * DQuat::from_rotation_z(TAU * k as f64 / sides as f64).mul_vec3(DVec3::X);
        let bars: Vec<Entity> = (0..sides)
            .map(|k| {
                let (along, at) = (corner(k + 1) - corner(k), 0.5 * (corner(k) + corner(k + 1)));
                let turn = DQuat::from_rotation_arc(DVec3::X, along.normalize());
                let half = 0.45 * along.length();
                let bar = RigidBody::new(Shape::cuboid([half, 0.1 * half, 0.1 * half])).without_collider();
                let bar = bar.mass(size.powi(3)).position(real(at)).orientation(real_quat(turn));
                rig.spawn(bar.linear_velocity(real(turning.cross(at))).angular_velocity(real(turning)))
            })
            .collect();
        let kind = [Joint::ball, Joint::hinge][case as usize / 4 % 2];
        let torque = draw.log_between(1e-2, 1e2) * size.powi(5) * turning.length_squared();
        for k in 0..sides {
            let joint = rig.join_at(kind(bars[k], bars[(k + 1) % sides]), corner(k + 1), DVec3::Z);
            rig.world.insert_one(joint, JointFriction::along(Axes::ANGULAR, torque as Real)).unwrap();
        }
        let mut gap = 0.0_f64;
        for _ in 0..200 {
            rig.step();
            gap = gap.max(rig.largest_gap());
        }
        println!("case {case}: {:.1e} of the size", gap / size);
        assert!(gap < 3e-5 * size, "case {case}, {sides} sides of {size} m: {gap}");
    }
}
