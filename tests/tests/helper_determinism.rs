//! Promise: what callers make of poses, and what reaches the state through them, has the same bits
//! on every machine: points and poses taken from frame to frame, offsets of colliders, frames of
//! joints, and vectors that a force law turns. The bits are pinned.
//!
//! Why: glam turns and normalises quaternions of `f32` with the instructions that the machine has,
//! in an order of their own. A helper that is glam's goes unseen on one architecture.

use glam::DVec3;
use hecs::World;
use tumble::math::{PRECISION, Quat, Real, Vec3};
use tumble::prelude::*;
use tumble::{BodyOrder, Joint, Rng, state_hash};
use tumble_tests::run;

/// In single and double precision.
const PINNED: [[u64; 4]; 2] = [
    [0x253c_61b0_2b23_e7fa, 0xca18_17d0_bfe2_274a, 0x0edf_69c2_7f87_5460, 0x0d74_f6f1_3a6f_f382],
    [0x6353_8391_0894_2b90, 0x257f_33a4_d6d3_1471, 0xf359_1513_b0e9_9e10, 0x72a8_8f6d_d556_80d1],
];

struct Draws(Rng);

impl Draws {
    fn number(&mut self) -> Real {
        (self.0.unit() * 4.0 - 2.0) as Real
    }

    fn vector(&mut self) -> Vec3 {
        Vec3::new(self.number(), self.number(), self.number())
    }

    /// Of length 1 but for rounding, made of numbers that every machine rounds alike.
    fn rotation(&mut self) -> Quat {
        let [x, y, z, w] = [0; 4].map(|_| self.0.unit() - 0.5);
        let length = (x * x + y * y + z * z + w * w).sqrt();
        Quat::from_array([x, y, z, w].map(|it| (it / length) as Real))
    }

    fn pose(&mut self) -> Pose {
        Pose { position: self.vector(), orientation: self.rotation() }
    }
}

/// FNV-1a of the bits of numbers.
fn fold(hash: u64, numbers: &[Real]) -> u64 {
    let bytes = numbers.iter().flat_map(|number| number.to_le_bytes());
    bytes.fold(hash, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

fn fold_pose(hash: u64, pose: &Pose) -> u64 {
    fold(fold(hash, &pose.position.to_array()), &pose.orientation.to_array())
}

fn poses() -> u64 {
    let mut draws = Draws(Rng::new(1));
    (0..1000).fold(1, |hash, _| {
        let (a, b, point) = (draws.pose(), draws.pose(), draws.vector());
        let offset = CenterOfMass(draws.vector());
        let points = [a.transform_point(point), a.inverse_transform_point(point), a.origin(Some(&offset))];
        let hash = points.iter().fold(hash, |hash, point| fold(hash, &point.to_array()));
        [a * b, a.inverse(), a.inverse() * b].iter().fold(hash, fold_pose)
    })
}

fn frames() -> u64 {
    let mut draws = Draws(Rng::new(2));
    (0..300).fold(1, |hash, _| {
        let mut world = World::new();
        let [a, b] = [0; 2].map(|_| world.spawn((draws.pose(),)));
        let (point, axis) = (draws.vector(), draws.vector());
        let Ok(joint) = Joint::hinge(a, b).at(&world, point, axis) else { return 0 };
        joint.frames.iter().fold(hash, fold_pose)
    })
}

/// Bodies whose colliders are off their centres, in a heap.
fn offsets() -> u64 {
    let mut draws = Draws(Rng::new(3));
    let mut world = World::new();
    spawn_ground(&mut world);
    for id in 0..40_u8 {
        let collider = Collider::new(&Shape::cuboid([0.2, 0.3, 0.4]));
        let collider = collider
            .and_then(|it| it.with_offset(Pose { position: draws.vector() * 0.1, orientation: draws.rotation() }));
        let place = Vec3::new(draws.number(), 1.0 + 0.5 * Real::from(id), draws.number());
        let body = RigidBody::new(Shape::sphere(0.3)).mass(1.0).position(place).id(BodyId(id.into()));
        body.collider(collider.unwrap()).build().unwrap().spawn(&mut world);
    }
    run(&mut Simulation::new(Settings::default()).unwrap(), &mut world, 200);
    state_hash(&world, &BodyOrder::of(&world))
}

/// Pushes along the body's own axes at a point of its own, by where it is.
struct Fins;

impl ForceLaw for Fins {
    fn wrench(&self, state: &BodyState<'_>) -> Wrench {
        let along = state.to_body(Vec3::new(1.0, 2.0, -1.0) - state.position);
        let pushed = state.wrench_from_body_frame(along, Vec3::new(0.1, 0.0, -0.2));
        let arm = state.point_to_world(Vec3::new(0.3, -0.2, 0.1)) - state.position;
        Wrench { torque: pushed.torque + arm.cross(pushed.force), ..pushed }
    }
}

fn law() -> u64 {
    let mut draws = Draws(Rng::new(4));
    let mut world = World::new();
    for id in 0..30 {
        let pose = draws.pose();
        let body = RigidBody::new(Shape::cuboid([0.2, 0.3, 0.4])).mass(1.0).position(pose.position);
        let body =
            body.orientation(pose.orientation).angular_velocity(draws.vector()).id(BodyId(id)).without_collider();
        body.build().unwrap().spawn(&mut world);
    }
    let mut simulation = Simulation::new(Settings::default()).unwrap();
    simulation.add_global_law(Fins);
    run(&mut simulation, &mut world, 200);
    let order = BodyOrder::of(&world);
    let far = world
        .query::<&Pose>()
        .iter()
        .map(|pose| DVec3::from_array(pose.position.to_array().map(f64::from)).length())
        .fold(0.0, f64::max);
    assert!(far < 100.0, "{far}");
    state_hash(&world, &order)
}

#[test]
fn the_bits_of_helpers_are_pinned() {
    let found = [poses(), frames(), offsets(), law()];
    let pinned = PINNED[usize::from(PRECISION == "f64")];
    assert_eq!(found, pinned, "in hexadecimal: {found:#018x?}");
}
