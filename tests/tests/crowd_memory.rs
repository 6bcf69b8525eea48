//! Promise: the memory in which pairs that are near each other are listed goes with the number of
//! bodies, however many are in one place.
//!
//! Why: a list of all pairs of ten thousand bodies in one place has 600 MB. It fails if pairs are
//! listed before those that count are chosen.
//!
//! The whole process is measured, so there is one test in this file.

use alloc_tracker::{Allocator, Session};
use hecs::World;
use tumble::math::{Quat, Real, Vec3};
use tumble::prelude::*;
use tumble_tests::touching::{collider, spawn};

#[global_allocator]
static ALLOCATOR: Allocator<std::alloc::System> = Allocator::system();

/// Rods side by side, askew, so that the boxes around all of them meet and no two rods touch.
fn rods(count: u64) -> World {
    let mut world = World::new();
    let shape = Shape::capsule(0.01, 5.0);
    let (across, along) = (Vec3::new(1.0, -1.0, 0.0).normalize(), Vec3::ONE.normalize());
    let other = along.cross(across);
    let turned = Quat::from_rotation_arc(Vec3::Y, along);
    for id in 0..count {
        let place = across * (0.04 * (id % 64) as Real) + other * (0.04 * (id / 64) as Real);
        let body = RigidBody::new(shape.clone()).mass(1.0).id(BodyId(id)).position(place).orientation(turned);
        spawn(&mut world, body, collider(&shape));
    }
    world
}

/// Lists of all pairs, the broad phase's and those that come of it, are some hundred bytes a pair
/// with what they grow through: nearly a gigabyte of four thousand.
#[test]
fn memory_goes_with_the_number() {
    let session = Session::new();
    for count in [1000, 2000, 4000_u64] {
        let mut world = rods(count);
        let mut simulation = Simulation::new(Settings::default().with_gravity(Vec3::ZERO)).unwrap();
        let counted = session.operation(count.to_string());
        {
            let _counting = counted.measure_process();
            simulation.step(&mut world);
        }
        let (bytes, left_out) = (counted.total_bytes_allocated(), simulation.pairs_left_out() as u64);
        println!("{count} bodies: {bytes} bytes, {left_out} pairs left out");
        let all = count * (count - 1) / 2;
        assert!(left_out < all && left_out >= all - 128 * count, "{left_out}");
        // 128 pairs a body in some lists of eight to twenty-four bytes each, twice over while they
        // grow.
        assert!(bytes <= count * 40_000, "{bytes} bytes for {count}");
    }
}
