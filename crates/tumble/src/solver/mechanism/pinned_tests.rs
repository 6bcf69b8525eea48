//! Four joints at a time do what one after the other does, to the bit.

use tumble_math::lane::{Quat, Vec3};

use crate::Rng;
use crate::joints::axes::Axes;
use crate::joints::drives::Drive;
use crate::joints::friction::JointFriction;
use crate::joints::joint_options::JointOptions;
use crate::joints::limits::{Limit, Limits};
use crate::math::Real;
use crate::solver::mechanism::fours::{row, row_of, vector};
use crate::solver::mechanism::joint_rows::{Anchor, JointRows};
use crate::solver::mechanism::mechanism_body::MechanismBody;
use crate::solver::mechanism::mechanism_solver::MechanismSolver;

fn vector_of(rng: &mut Rng, size: f64) -> Vec3<f64> {
    Vec3::new(between(rng, -size, size), between(rng, -size, size), between(rng, -size, size))
}

fn between(rng: &mut Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * rng.unit()
}

fn below(rng: &mut Rng, count: usize) -> usize {
    (rng.unit() * count as f64) as usize
}

/// Bodies of sizes from a centimetre to ten metres and mass ratios up to a thousand, in motion.
fn bodies(rng: &mut Rng, count: usize) -> Vec<MechanismBody> {
    let size = 10.0_f64.powf(between(rng, -2.0, 1.0));
    (0..count)
        .map(|_| {
            let mass = 10.0_f64.powf(between(rng, -1.5, 1.5));
            let moment = mass * size * size * between(rng, 0.1, 1.0);
            let moments = Vec3::new(moment, moment * between(rng, 0.6, 1.0), moment * between(rng, 0.6, 1.0));
            let is_fixed = between(rng, 0.0, 1.0) < 0.1;
            let mut body =
                MechanismBody::at(vector_of(rng, 3.0 * size), if is_fixed { 0.0 } else { 1.0 / mass }, moments);
            if !is_fixed {
                let q = Quat::from_parts(1.0, vector_of(rng, 1.0)).normalize();
                body.orientation = row(q);
                body.linear = row_of(vector_of(rng, mass * size), 1.0 / mass);
                body.angular = row_of(vector_of(rng, moment), 1.0);
                body.kick = [row_of(Vec3::new(0.0, -0.04 * mass, 0.0), 0.0), [0.0; 4]];
            }
            body
        })
        .collect()
}

/// A joint that is nearly met where two bodies are.
fn joint(
    rng: &mut Rng,
    ends: [usize; 2],
    bodies: &[MechanismBody],
    free: Axes,
    options: Option<&JointOptions>,
) -> JointRows {
    let point = (bodies[ends[0]].position() + bodies[ends[1]].position()) * 0.5;
    let frame = Quat::from_parts(1.0, vector_of(rng, 1.0)).normalize();
    let anchors = ends.map(|end| {
        let body = &bodies[end];
        let position = body.orientation().rotate_back(point - body.position()) + vector_of(rng, 1e-5);
        let orientation = body.orientation().conjugate() * frame;
        Anchor { position: row_of(position, 0.0), orientation: row(orientation) }
    });
    let mut joint = JointRows::new(ends, anchors, free, options);
    options.into_iter().for_each(|options| joint.take_options(options, 0.0));
    joint
}

/// What acts about the axis of a hinge: a spring, a motor that may give all it has, a range that
/// the hinge is in, at the end of or beyond, or friction, or several of these.
fn options(rng: &mut Rng) -> JointOptions {
    let mut options = JointOptions::default();
    let x = Axes::ANGULAR_X;
    let kinds = 1 + below(rng, 15);
    if kinds & 1 != 0 {
        let drive = Drive::position(x, between(rng, -1.0, 1.0) as Real);
        options.drives.push(drive.with_frequency(between(rng, 0.5, 20.0) as Real, 1.0));
    }
    if kinds & 2 != 0 {
        let drive = Drive::velocity(x, between(rng, -2.0, 2.0) as Real);
        options.drives.push(drive.with_max_force(10.0_f64.powf(between(rng, -4.0, 4.0)) as Real));
    }
    if kinds & 4 != 0 {
        let low = between(rng, -0.02, 0.01);
        options.limits = Limits::along(x, Limit::new(low as Real, (low + between(rng, 0.0, 0.02)) as Real));
    }
    if kinds & 8 != 0 {
        options.friction = JointFriction::along(x, 10.0_f64.powf(between(rng, -4.0, 2.0)) as Real);
    }
    options
}

/// What a mechanism is after a few substeps: bodies, and what joints have done.
fn advanced(joints: &[JointRows], bodies: &[MechanismBody], by_four: bool) -> Vec<f64> {
    let moves: Vec<_> = bodies.iter().map(MechanismBody::is_moved).collect();
    let (mut solver, _) = MechanismSolver::new(joints, &moves, false).unwrap();
    solver.bodies = bodies.to_vec();
    if !by_four {
        solver.alike = None;
        solver.alike_fours.fill(None);
    }
    for _ in 0..3 {
        assert!(solver.advance(4, 1.0 / 240.0));
    }
    let of_bodies =
        solver.bodies.iter().flat_map(|body| [body.linear, body.angular, body.translation, body.orientation]);
    let of_joints = solver.done.iter().flatten().map(|row| row_of(vector(row), 0.0));
    of_bodies.chain(of_joints).flatten().collect()
}

/// Trees and loops of one to eleven joints, all of one kind or mixed, with fixed bodies among them.
#[test]
fn four_joints_at_a_time_do_what_one_after_the_other_does() {
    let kinds = [Axes::ANGULAR, Axes::ANGULAR_X, Axes::NONE, Axes::ANGULAR_Y, Axes::ANGULAR_X | Axes::ANGULAR_Y];
    let (mut rng, mut alike, mut driven, mut moved) = (Rng::new(27), 0, 0, 0);
    for case in 0..300 {
        let count = 2 + below(&mut rng, 11);
        let bodies = bodies(&mut rng, count);
        let is_driven = case % 2 == 0;
        let kind = if is_driven { 1 } else { below(&mut rng, 5) };
        let mut joints = Vec::new();
        for second in 1..count {
            let first = if below(&mut rng, 2) == 0 { second - 1 } else { below(&mut rng, second) };
            let free = if case % 3 == 0 { kinds[below(&mut rng, 5)] } else { kinds[kind] };
            let options = (is_driven && free == Axes::ANGULAR_X).then(|| options(&mut rng));
            joints.push(joint(&mut rng, [first, second], &bodies, free, options.as_ref()));
        }
        if case % 4 == 0 && count > 2 {
            joints.push(joint(&mut rng, [0, count - 1], &bodies, kinds[kind], None));
        }
        let [fours, one_by_one] = [true, false].map(|by_four| advanced(&joints, &bodies, by_four));
        let differs = fours.iter().zip(&one_by_one).position(|(a, b)| a != b);
        assert_eq!(differs, None, "case {case}: {count} bodies, kind {kind}");
        alike += usize::from(case % 3 != 0 && kind < 3);
        driven += usize::from(case % 3 != 0 && is_driven);
        moved += usize::from(fours.iter().any(|number| *number != 0.0));
    }
    assert!(alike > 120 && driven == 100 && moved == 300, "{alike} were alike, {driven} driven, {moved} moved");
}
