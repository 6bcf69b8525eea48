//! Promise: the files of a run have the same bytes on every machine, and are read on every machine:
//! what one has written, another goes on from. The bytes are pinned.
//!
//! Why: a saved game is sent, a record is compared with `cmp`. It fails if a number is written in
//! the order of the machine's bytes, or as long as its pointers are.

use std::io::Cursor;

use hecs::World;
use tumble::math::PRECISION;
use tumble::prelude::*;
use tumble::{BodyOrder, Snapshot};
use tumble_record::{Animation, Frame, TrajectoryWriter};
use tumble_scene::Scene;
use tumble_tests::{hash, run};

use crate::pile::{plain_scene, settings};

/// A snapshot, a record as CSV and one as glTF, in single and double precision.
const PINNED: [[u64; 3]; 2] = [
    [0x7a3f_1e7d_053f_daef, 0x45a9_5d30_1ac4_ee07, 0xc7e7_ae1e_8438_1d87],
    [0xe483_d18f_9595_4de6, 0xb837_4704_7881_2a41, 0x19ea_fa8f_3e57_d513],
];

/// FNV-1a.
fn sum(bytes: &[u8]) -> u64 {
    let step = |sum: u64, byte: &u8| (sum ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, step)
}

/// The bytes of a pile with its contacts, which the same pile has gone on from.
fn snapshot() -> Vec<u8> {
    let mut simulation = Simulation::new(settings()).unwrap();
    let mut world = plain_scene();
    run(&mut simulation, &mut world, 60);
    assert!(simulation.contacts().any(|contact| contact.touches()));
    let bytes = simulation.snapshot(&world).unwrap().to_bytes();
    run(&mut simulation, &mut world, 30);
    let there = hash(&world);

    let mut world = plain_scene();
    let mut simulation = Simulation::new(settings()).unwrap();
    simulation.restore(&Snapshot::from_bytes(&bytes).unwrap(), &mut world).unwrap();
    run(&mut simulation, &mut world, 30);
    assert_eq!(hash(&world), there);
    bytes
}

/// A second of a scene, as each writer writes it.
fn records(scene: Scene) -> [Vec<u8>; 2] {
    let mut simulation = Simulation::new(scene.settings).unwrap();
    let mut world = World::new();
    let mut csv = TrajectoryWriter::csv(Cursor::new(Vec::new())).unwrap();
    let mut glb = TrajectoryWriter::glb(Cursor::new(Vec::new()), Animation::of(&scene, 60, 20).unwrap());
    let names = scene.spawn(&mut world).unwrap();
    let order = BodyOrder::of(&world);
    for frame in 0..4 {
        if frame > 0 {
            run(&mut simulation, &mut world, 20);
        }
        csv.record(&Frame::of(&simulation, &world, &order, &names)).unwrap();
        glb.record(&Frame::of(&simulation, &world, &order, &names)).unwrap();
    }
    [csv, glb].map(|writer| writer.finish().unwrap().into_inner())
}

#[test]
fn the_bytes_of_files_are_pinned() {
    let [csv, glb] = records(Scene::open("dominoes").unwrap());
    let found = [snapshot(), csv, glb].map(|bytes| sum(&bytes));
    let pinned = PINNED[usize::from(PRECISION == "f64")];
    assert_eq!(found, pinned, "in hexadecimal: {found:#018x?}");
}
