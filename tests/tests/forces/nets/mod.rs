//! Nets of bodies and springs, for the tests of forces between bodies.

#![allow(dead_code, reason = "each test uses a part of it")]

use glam::{DQuat, DVec3};
use hecs::{Entity, World};
use tumble::math::{Quat, Real, Vec3};
use tumble::{BodyId, Pose, RigidBody, Rng, Shape, Spring};
use tumble_tests::{dquat, dvec3};

/// How bodies hang together.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Net {
    /// Two.
    Pair,
    /// Twenty in a row.
    Chain,
    /// A hub that twenty hang on.
    Star,
    /// Five by five.
    Grid,
    /// Fifteen with forty springs, at random from a seed.
    Random(u64),
}

/// Where springs are attached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Attached {
    Centers,
    Anywhere,
}

/// Whether bodies spin at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Turning {
    No,
    Yes,
}

fn places_and_pairs(kind: Net, rng: &mut Rng) -> (Vec<Vec3>, Vec<(usize, usize)>) {
    let row = |count: u8| (0..count).map(|i| Vec3::X * Real::from(i));
    match kind {
        Net::Pair => (row(2).collect(), vec![(0, 1)]),
        Net::Chain => (row(20).collect(), (0..19).map(|i| (i, i + 1)).collect()),
        Net::Star => {
            let around = (0..20).map(|_| rng.vector(-1.0, 1.0).normalize() * 2.0);
            (std::iter::once(Vec3::ZERO).chain(around).collect(), (1..=20).map(|i| (0, i)).collect())
        }
        Net::Grid => {
            let places = (0..25_u8).map(|i| Vec3::new(Real::from(i % 5), Real::from(i / 5), 0.0)).collect();
            let right = (0..25).filter(|i| i % 5 < 4).map(|i| (i, i + 1));
            (places, right.chain((0..20).map(|i| (i, i + 5))).collect())
        }
        Net::Random(_) => {
            let places = (0..15).map(|_| rng.vector(-3.0, 3.0)).collect();
            let pairs = (0..40).map(|_| {
                let a = (rng.next_u64() % 15) as usize;
                (a, (a + 1 + (rng.next_u64() % 14) as usize) % 15)
            });
            (places, pairs.collect())
        }
    }
}

/// A net whose springs are stretched or pressed by up to 5 cm, of bodies from 0.5 to 4 kg that move
/// at up to 1 m/s.
pub(crate) fn net(kind: Net, stiffness: f64, damping: f64, attached: Attached, turning: Turning) -> World {
    let mut rng = Rng::new(if let Net::Random(seed) = kind { 77 + seed } else { 7 });
    let (places, pairs) = places_and_pairs(kind, &mut rng);
    let mut world = World::new();
    let bodies: Vec<Entity> = places
        .iter()
        .enumerate()
        .map(|(i, place)| {
            let shape = Shape::cuboid(dvec3(rng.vector(0.2, 0.4)));
            let mut body = RigidBody::new(shape)
                .without_collider()
                .mass(rng.range(0.5, 4.0))
                .position(*place)
                .id(BodyId(i as u64));
            body = body.linear_velocity(rng.vector(-0.5, 0.5)).orientation(rng.orientation());
            let spin = rng.vector(-4.0, 4.0);
            if turning == Turning::Yes {
                body = body.angular_velocity(spin);
            }
            body.build().unwrap().spawn(&mut world)
        })
        .collect();
    for (a, b) in pairs {
        let hooks = [rng.vector(-0.3, 0.3), rng.vector(-0.3, 0.3)].map(|hook| match attached {
            Attached::Centers => Vec3::ZERO,
            Attached::Anywhere => hook,
        });
        let end = |i: usize, hook: Vec3| world.get::<&Pose>(bodies[i]).unwrap().transform_point(hook);
        let length = (end(b, hooks[1]) - end(a, hooks[0])).length();
        let rest = (length + rng.range(-0.05, 0.05)).max(0.0);
        let spring = Spring::between(bodies[a], bodies[b]).attached_at(hooks[0], hooks[1]).with_rest_length(rest);
        world.spawn((spring.with_stiffness(stiffness as Real).with_damping(damping as Real),));
    }
    world
}

/// A pose beside another \[m\].
pub(crate) fn shifted(pose: &Pose, by: DVec3) -> Pose {
    let [x, y, z] = by.to_array().map(|number| number as Real);
    Pose { position: pose.position + Vec3::new(x, y, z), ..*pose }
}

/// How far one is from the other, as they were rounded.
pub(crate) fn shift(from: &Pose, to: &Pose) -> DVec3 {
    dvec3(to.position) - dvec3(from.position)
}

/// A pose turned about its centre by a small rotation vector, world frame \[rad\].
pub(crate) fn turned(pose: &Pose, by: DVec3) -> Pose {
    let q = DQuat::from_scaled_axis(by) * dquat(pose.orientation);
    Pose { orientation: Quat::from_xyzw(q.x as Real, q.y as Real, q.z as Real, q.w as Real), ..*pose }
}

/// The rotation vector from one to the other, as they were rounded.
pub(crate) fn turn(from: &Pose, to: &Pose) -> DVec3 {
    (dquat(to.orientation) * dquat(from.orientation).inverse()).to_scaled_axis()
}

/// A straight line through samples.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    /// Change over time.
    pub(crate) slope: f64,
    /// Standard error of the slope.
    pub(crate) error: f64,
    pub(crate) mean: f64,
    /// Standard deviation from the line.
    pub(crate) spread: f64,
}

/// The line of least squares through times and values.
pub(crate) fn fit(samples: &[(f64, f64)]) -> Line {
    let n = samples.len() as f64;
    let mean_time = samples.iter().map(|sample| sample.0).sum::<f64>() / n;
    let mean = samples.iter().map(|sample| sample.1).sum::<f64>() / n;
    let variance: f64 = samples.iter().map(|(t, _)| (t - mean_time).powi(2)).sum();
    let slope = samples.iter().map(|(t, y)| (t - mean_time) * (y - mean)).sum::<f64>() / variance;
    let rest = samples.iter().map(|(t, y)| (y - mean - slope * (t - mean_time)).powi(2)).sum::<f64>() / (n - 2.0);
    Line { slope, error: (rest / variance).sqrt(), mean, spread: rest.sqrt() }
}
