//! Promise: springs of joints, drives and soft limits with a stiffness, have their potential energy
//! in `Totals`: half the stiffness times the square of the stretch, less beyond the greatest force.
//! Mechanisms with undamped ones keep their energy to second order in the substep, damped ones only
//! lose, and what joints did to the kinetic energy is what the springs lost.
//!
//! Why: a sum that leaves out a spring shows as drift what is none. It fails if a potential has the
//! wrong sign or factor, counts angles from elsewhere than the force does, or is there for a joint
//! that does nothing.

use glam::{DQuat, DVec3};
use hecs::{Entity, World};
use tumble::math::Real;
use tumble::{
    Axes, Breakable, Drive, Drives, Gain, Joint, Ledger, Limit, Limits, Pose, RigidBody, Settings, Shape, Simulation,
};
use tumble_tests::{Draw, by_precision};

use crate::jointed::{Rig, down, real};
use crate::mechanisms::{Class, mechanism, totals};

/// A joint of a kind at the origin, between the ground and a body that is moved and turned.
fn displaced(joint: fn(Entity, Entity) -> Joint, translation: DVec3, turn: DQuat) -> (Rig, Entity) {
    let mut rig = Rig::new(DVec3::ZERO, 1.0 / 60.0, 4);
    let ground = rig.ground();
    let body = RigidBody::new(Shape::cuboid([0.1, 0.2, 0.3])).without_collider().mass(1.0).position(real(translation));
    let turn = tumble_tests::references::real_quat(turn);
    let body = rig.spawn(body.orientation(turn));
    let joint = rig.join(joint(ground, body));
    (rig, joint)
}

/// Its potential with a drive of a position, or with limits.
fn potential(rig: &mut Rig, joint: Entity, drives: Vec<Drive>, limits: Limits) -> f64 {
    rig.world.insert(joint, (Drives(drives), limits)).unwrap();
    rig.totals().force_potential
}

fn assert_near(found: f64, expected: f64) {
    let tolerance = by_precision(2e-5, 1e-12) * (1.0 + expected.abs());
    assert!((found - expected).abs() < tolerance, "{found} J for {expected} J");
}

#[test]
fn energies_are_those_of_the_closed_forms() {
    let none = Limits::default;
    for number in 0..200 {
        let mut draw = Draw::new(0x90, number);
        let (k, at, value) = (draw.log_between(0.1, 10.0), draw.between(-1.0, 1.0), draw.between(-1.5, 1.5));
        let spring = |axes: Axes, k: f64| Drive::position(axes, at as Real).with_stiffness(k as Real, 3.0);
        let (k, at) = (f64::from(k as Real), f64::from(at as Real));
        let half = |stretch: f64| 0.5 * k * stretch * stretch;

        let (mut rig, joint) = displaced(Joint::slider, DVec3::X * value, DQuat::IDENTITY);
        let along = spring(Axes::LINEAR_X, k);
        assert_near(potential(&mut rig, joint, vec![along], none()), half(value - at));
        assert_near(potential(&mut rig, joint, vec![along, along], none()), 2.0 * half(value - at));
        // One along a locked axis does nothing, nor does a motor, nor what has no stiffness.
        let motor = Drive::velocity(Axes::LINEAR_X, 1.0).with_stiffness(5.0, 5.0);
        let without =
            vec![spring(Axes::LINEAR_Y, k), motor, along.with_frequency(1.0, 0.0), spring(Axes::LINEAR_X, 0.0)];
        assert_eq!(potential(&mut rig, joint, without, none()), 0.0);
        // Beyond its greatest force the energy grows by that.
        let most = draw.log_between(0.01, 10.0);
        let yields = (most / k).min((value - at).abs());
        let expected = half(yields) + most * ((value - at).abs() - yields);
        assert_near(potential(&mut rig, joint, vec![along.with_max_force(most as Real)], none()), expected);
        // Soft bounds, of which one may be infinite.
        let bounds = [at - 0.2, at + 0.1];
        for [min, max] in [bounds, [bounds[0], f64::INFINITY], [f64::NEG_INFINITY, bounds[1]]] {
            let limit = Limit::new(min as Real, max as Real).with_stiffness(k as Real, 1.0);
            let past = (value - value.clamp(min, max)).abs();
            let limits = Limits::along(Axes::LINEAR_X, limit);
            assert_near(potential(&mut rig, joint, vec![], limits), half(past));
            let hard = Limits::along(Axes::LINEAR_X, Limit { gain: Gain::Rigid, ..limit });
            assert_eq!(potential(&mut rig, joint, vec![], hard), 0.0);
        }

        let (mut rig, joint) = displaced(Joint::hinge, DVec3::ZERO, DQuat::from_rotation_x(value));
        let about = spring(Axes::ANGULAR_X, k);
        assert_near(potential(&mut rig, joint, vec![about], none()), half(value - at));

        let turn = draw.direction() * draw.between(0.0, 3.0);
        let (mut rig, joint) = displaced(Joint::ball, DVec3::ZERO, DQuat::from_scaled_axis(turn));
        let to_rest = Drive { position: Some(0.0), ..spring(Axes::ANGULAR, k) };
        assert_near(potential(&mut rig, joint, vec![to_rest], none()), half(turn.length()));

        let place = draw.direction() * value.abs();
        let (mut rig, joint) = displaced(Joint::free, place, draw.orientation());
        let bungee = Limit::new(0.0, 0.5).with_stiffness(k as Real, 0.0);
        let bungee = Limits { distance: Some(bungee), ..none() };
        assert_near(potential(&mut rig, joint, vec![], bungee), half((value.abs() - 0.5).max(0.0)));
    }
}

#[test]
fn joints_that_do_nothing_have_no_energy() {
    let spring = Drive::position(Axes::LINEAR_X, 0.0).with_stiffness(10.0, 0.0);
    let (mut rig, joint) = displaced(Joint::slider, DVec3::X, DQuat::IDENTITY);
    assert_near(potential(&mut rig, joint, vec![spring], Limits::default()), 5.0);
    rig.world.insert_one(joint, Breakable { is_broken: true, ..Breakable::at_force(1.0) }).unwrap();
    assert_eq!(rig.totals().force_potential, 0.0);
    rig.world.get::<&mut Breakable>(joint).unwrap().is_broken = false;
    assert_near(rig.totals().force_potential, 5.0);
    let [ground, body] = rig.world.get::<&Joint>(joint).unwrap().bodies;
    rig.world.get::<&mut Pose>(body).unwrap().position.x = Real::NAN;
    assert_eq!(rig.totals().force_potential, 0.0);
    rig.world.despawn(ground).unwrap();
    assert_eq!(rig.totals().force_potential, 0.0);
}

/// A mechanism with springs along its free axes that swing at up to this many radians a second.
fn sprung(number: u64, damping: f64, substeps: u32) -> (World, Simulation) {
    let mut draw = Draw::new(0x91, number);
    let size = draw.log_between(0.02, 5.0);
    let class = Class {
        bodies: 2 + (draw.between(0.0, 6.0) as u64),
        mass_ratio: draw.log_between(1.0, 10.0),
        size,
        aspect: 2.0,
        speed: 0.3 * size,
        is_fixed: draw.often(0.5),
        ..Class::PLAIN
    };
    let mut world = World::new();
    let plan = mechanism(class, &mut draw);
    let all = |count: usize| (0..count).collect::<Vec<_>>();
    let (_, joints) = plan.spawn(&mut world, &all(plan.bodies.len()), &all(plan.joints.len()));
    for joint in joints {
        let free = world.get::<&Joint>(joint).unwrap().free;
        let (mut drives, mut limits) = (Vec::new(), Limits::default());
        for (index, axis) in Axes::EACH.into_iter().enumerate().filter(|(_, axis)| free.contains(*axis)) {
            let scale = if index < 3 { size } else { 1.0 };
            let mass = if index < 3 { 1.0 } else { size * size };
            let stiffness = mass * draw.between(2.0, 6.0).powi(2);
            let spring = Drive::position(axis, (draw.between(-0.4, 0.4) * scale) as Real);
            let spring = spring.with_stiffness(stiffness as Real, (damping * mass) as Real);
            let most = (stiffness * scale * draw.between(0.2, 1.0)) as Real;
            drives.push(if draw.often(0.2) { spring.with_max_force(most) } else { spring });
            if draw.often(0.3) {
                let bound = (draw.between(0.05, 0.4) * scale) as Real;
                let soft = Limit::new(-bound, bound).with_stiffness(stiffness as Real, (damping * mass) as Real);
                limits.axes[index] = Some(soft);
            }
        }
        world.insert(joint, (Drives(drives), limits)).unwrap();
    }
    let settings = Settings::default().with_gravity(real(if class.is_fixed { down() * size } else { DVec3::ZERO }));
    (world, Simulation::new(settings.with_contact_substeps(substeps)).unwrap())
}

/// How far the energy goes from the first, up and down, and how much springs exchanged at most.
fn drift(number: u64, damping: f64, substeps: u32) -> ([f64; 2], f64) {
    let (mut world, mut simulation) = sprung(number, damping, substeps);
    // The joints take out what velocities do not fit.
    simulation.step(&mut world);
    let mut ledger = Ledger::attach(&mut world, &simulation);
    let start = ledger.entries()[0];
    let (mut range, mut exchanged) = ([0.0_f64; 2], 0.0_f64);
    for _ in 0..90 {
        simulation.step(&mut world);
        let entry = ledger.record(&world, &simulation);
        let change = entry.energy() - start.energy();
        range = [range[0].min(change), range[1].max(change)];
        let of_springs = entry.totals.force_potential - start.totals.force_potential;
        exchanged = exchanged.max(of_springs.abs());
        // Of the works, joints and springs balance, but for gravity that is in another account.
        let of_gravity = entry.work.gravity + entry.totals.potential - start.totals.potential;
        let by_joints = entry.work.joints + of_springs;
        let rest = change - by_joints - of_gravity - entry.work.integrator - entry.between_steps;
        let scale = entry.kinetic() + start.energy().abs() + exchanged;
        assert!(rest.abs() <= by_precision(1e-5, 1e-12) * scale, "{rest} J of {scale} J in no account");
    }
    assert_eq!(totals(&world, &simulation).non_finite, None);
    (range, exchanged)
}

#[test]
fn undamped_springs_keep_energy_to_second_order() {
    let (mut sums, mut count) = ([0.0; 3], 0.0);
    for number in 0..40 {
        let drifts = [4, 8, 16].map(|substeps| {
            let ([low, high], exchanged) = drift(number, 0.0, substeps);
            // Springs turn by up to six radians a second, times the substep.
            let bound = (6.0 / 60.0 / 4.0_f64).powi(2);
            assert!(exchanged == 0.0 || high.max(-low) <= bound * exchanged, "{number}: {low} {high} of {exchanged} J");
            high.max(-low) / exchanged
        });
        // Some mechanisms have fixed joints alone.
        if drifts.iter().all(|drift| drift.is_finite()) {
            count += 1.0;
            (0..3).for_each(|place| sums[place] += drifts[place].ln());
        }
    }
    let means = sums.map(|sum| (sum / count).exp());
    println!("drift by what springs exchanged, of {count} mechanisms: {means:?}");
    assert!(count > 30.0);
    // In single precision, rounding of positions is more in the end.
    assert!(means[0] > by_precision(2.0, 3.5) * means[1] && means[1] > by_precision(1.2, 3.5) * means[2]);
}

#[test]
fn damped_springs_only_lose() {
    for number in 0..40 {
        let ([low, high], exchanged) = drift(number, 2.0, 8);
        if exchanged > 0.0 {
            assert!(high <= 1e-6 * exchanged, "{number}: {high} J made of {exchanged} J");
            assert!(low < -0.1 * exchanged, "{number}: {low} J of {exchanged} J");
        }
    }
}
