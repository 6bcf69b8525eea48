//! Promise: what callers make of poses, and what reaches the state through them, has the same bits
//! on every machine: points and poses taken from frame to frame, offsets of colliders, frames of
//! joints, and vectors that a force law turns. The bits are pinned.
//!
//! Why: glam turns and normalises quaternions of `f32` with the instructions that the machine has,
//! in an order of their own. A helper that is glam's goes unseen on one architecture.

use hecs::World;
use tumble::math::{PRECISION, Real, Vec3};
use tumble::prelude::*;
use tumble::{Joint, Rng};
use tumble_tests::{hash, run};

/// In single and double precision.
const PINNED: [[u64; 4]; 2] = [
    [0xfc44_a43a_9f94_aff0, 0x25db_86d1_eeed_a90c, 0x53ad_5139_5b84_ce9a, 0x5fb3_9820_ab56_7a89],
    [0x21e1_6b5c_797c_319b, 0x6820_d91f_654a_afc7, 0x0bcf_9a86_2cfb_65e7, 0x590e_62e1_1d7d_9c78],
];

fn vector(rng: &mut Rng) -> Vec3 {
    rng.vector(-2.0, 2.0)
}

fn pose(rng: &mut Rng) -> Pose {
    Pose { position: vector(rng), orientation: rng.orientation() }
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
    let mut rng = Rng::new(1);
    (0..1000).fold(1, |hash, _| {
        let (a, b, point) = (pose(&mut rng), pose(&mut rng), vector(&mut rng));
        let offset = CenterOfMass(vector(&mut rng));
        let points = [a.transform_point(point), a.inverse_transform_point(point), a.origin(Some(&offset))];
        let hash = points.iter().fold(hash, |hash, point| fold(hash, &point.to_array()));
        [a * b, a.inverse(), a.inverse() * b].iter().fold(hash, fold_pose)
    })
}

fn frames() -> u64 {
    let mut rng = Rng::new(2);
    (0..300).fold(1, |hash, _| {
        let mut world = World::new();
        let [a, b] = [0; 2].map(|_| world.spawn((pose(&mut rng),)));
        let (point, axis) = (vector(&mut rng), vector(&mut rng));
        let joint = Joint::hinge(a, b).at(&world, point, axis).unwrap();
        joint.frames.iter().fold(hash, fold_pose)
    })
}

/// Bodies whose colliders are off their centres, in a heap.
fn offsets() -> u64 {
    let mut rng = Rng::new(3);
    let mut world = World::new();
    spawn_ground(&mut world);
    for id in 0..40_u8 {
        let collider = Collider::new(&Shape::cuboid([0.2, 0.3, 0.4]));
        let collider = collider
            .and_then(|it| it.with_offset(Pose { position: vector(&mut rng) * 0.1, orientation: rng.orientation() }));
        let place = Vec3::new(rng.range(-2.0, 2.0), 1.0 + 0.5 * Real::from(id), rng.range(-2.0, 2.0));
        let body = RigidBody::new(Shape::sphere(0.3)).mass(1.0).position(place).id(BodyId(id.into()));
        body.collider(collider.unwrap()).build().unwrap().spawn(&mut world);
    }
    run(&mut Simulation::new(Settings::default()).unwrap(), &mut world, 200);
    hash(&world)
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
    let mut rng = Rng::new(4);
    let mut world = World::new();
    for id in 0..30 {
        let pose = pose(&mut rng);
        let body = RigidBody::new(Shape::cuboid([0.2, 0.3, 0.4])).mass(1.0).position(pose.position);
        let body =
            body.orientation(pose.orientation).angular_velocity(vector(&mut rng)).id(BodyId(id)).without_collider();
        body.build().unwrap().spawn(&mut world);
    }
    let mut simulation = Simulation::new(Settings::default()).unwrap();
    simulation.add_global_law(Fins);
    run(&mut simulation, &mut world, 200);
    assert!(world.query::<&Pose>().iter().all(|pose| pose.position.length() < 100.0));
    hash(&world)
}

#[test]
fn the_bits_of_helpers_are_pinned() {
    let found = [poses(), frames(), offsets(), law()];
    let pinned = PINNED[usize::from(PRECISION == "f64")];
    assert_eq!(found, pinned, "in hexadecimal: {found:#018x?}");
}
