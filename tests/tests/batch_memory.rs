//! Promise: an empty world of a batch takes at most 4 KB. A body takes at most 256 bytes all told,
//! its share of the world among them, from 64 bodies of a kind on; a world of fewer takes what one
//! of 64 does. In double precision a body takes at most 512.
//!
//! Why: what ends large batches in other engines is memory. It fails if a world gets buffers of its
//! own before it has bodies, or a body more components than it needs.
//!
//! What the process has in memory is measured, so the allocator's own overhead counts; and there is
//! only one test in this file, because tests of one file share a process.

#![cfg(target_os = "linux")]

use hecs::World;
use tumble::math::{Real, Vec3};
use tumble::{Batch, RigidBody, Settings, Shape, Trial};

/// Of the process, in memory [bytes].
fn resident() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap();
    line.trim().strip_suffix(" kB").unwrap().parse::<f64>().unwrap() * 1024.0
}

/// A batch of worlds of this many bodies that has been stepped, and the bytes that each world has.
fn measured(worlds: usize, bodies: u32) -> (Batch, f64) {
    let body = RigidBody::new(Shape::cuboid([0.1, 0.2, 0.3]))
        .without_collider()
        .mass(1.0)
        .angular_velocity(Vec3::ONE)
        .build()
        .unwrap();
    let before = resident();
    let mut batch = Batch::from_seed(worlds, 0, |_, _| {
        let mut world = World::new();
        for _ in 0..bodies {
            body.spawn(&mut world);
        }
        Trial::new(Settings::default(), world)
    })
    .unwrap();
    batch.step_many(2);
    let grown = resident() - before;
    (batch, grown / worlds as f64)
}

#[test]
fn worlds_and_bodies_are_small() {
    // Tens of megabytes each, against which the process's other pages do not count. All are kept:
    // memory that was freed would be used again unseen.
    let mut kept = Vec::new();
    let mut bytes = |worlds, bodies| {
        let (batch, bytes) = measured(worlds, bodies);
        kept.push(batch);
        println!("a world of {bodies}: {bytes:.0} bytes, {:.0} a body", bytes / f64::from(bodies.max(1)));
        bytes
    };
    let limit = if size_of::<Real>() == 4 { 256.0 } else { 512.0 };

    assert!(bytes(16_384, 0) <= 4096.0);
    // hecs makes room for 64 bodies of a kind at once, so up to there a body more costs nothing.
    assert!(bytes(2048, 1) <= 64.0 * limit);
    assert!(bytes(2048, 8) <= 64.0 * limit);
    for (worlds, bodies) in [(2048, 64), (1024, 128), (256, 1024), (32, 16_384)] {
        assert!(bytes(worlds, bodies) <= limit * f64::from(bodies), "{bodies} bodies");
    }
}
