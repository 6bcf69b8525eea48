//! Promise: the memory in which pairs that are near each other are listed goes with the number of bodies, however many are in one place.
//!
//! Why: a list of all pairs of ten thousand bodies in one place has 600 MB. It fails if pairs are listed before those that count are chosen.
//!
//! The whole process is looked at, so there is one test in this file.

#![allow(clippy::unwrap_used, reason = "a test without what it tests is to fail")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

use hecs::World;
use tumble::math::{Quat, Real, Vec3};
use tumble::prelude::*;
use tumble_tests::touching::{collider, spawn};

/// The system's, with the largest piece of memory that was asked for.
struct Largest;

static LARGEST: AtomicUsize = AtomicUsize::new(0);

// SAFETY: all is handed on to the system's allocator as it came.
#[allow(unsafe_code, reason = "an allocator cannot be written without")]
unsafe impl GlobalAlloc for Largest {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        LARGEST.fetch_max(layout.size(), Ordering::Relaxed);
        // SAFETY: the caller's promise is the same.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's promise is the same.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        LARGEST.fetch_max(size, Ordering::Relaxed);
        // SAFETY: the caller's promise is the same.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Largest = Largest;

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

/// Lists of all pairs would have 8 bytes or more a pair in one piece: 64 MB and more of four thousand.
#[test]
fn memory_goes_with_the_number() {
    for count in [1000, 2000, 4000_u64] {
        let mut world = rods(count);
        let mut simulation = Simulation::new(Settings::default().with_gravity(Vec3::ZERO)).unwrap();
        LARGEST.store(0, Ordering::Relaxed);
        simulation.step(&mut world);
        let largest = LARGEST.load(Ordering::Relaxed);
        let left_out = simulation.pairs_left_out() as u64;
        println!("{count} bodies: {largest} bytes at most in one piece, {left_out} pairs left out");
        let all = count * (count - 1) / 2;
        assert!(left_out < all && left_out >= all - 128 * count, "{left_out}");
        // Twice 128 pairs a body, for a list that grows by doubling, of a dozen bytes each.
        assert!(largest <= count as usize * 256 * 12, "{largest} bytes for {count}");
    }
}
