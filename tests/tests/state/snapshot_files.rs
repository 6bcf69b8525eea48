//! Promise: a snapshot written and read again is the same to the bit, as bytes, in postcard within
//! 10 % of the raw size, and in JSON. Every single flipped bit, every cut, and every state that no
//! world can have is refused with a typed error; no bytes whatever make it panic or take more
//! memory than they are long.
//!
//! Why: files are damaged and peers lie. It fails if a field is not covered by the checksum, a
//! count is trusted, or a number is not checked.

use hecs::World;
use proptest::prelude::{Just, ProptestConfig, any, prop, prop_oneof, proptest};
use tumble::math::Real;
use tumble::{BodyId, BodyOrder, Breakable, Joint, Settings, Simulation, Snapshot, SnapshotError, state_hash};
use tumble_benches::{mixed_bodies, mixed_body};
use tumble_tests::forged;

/// Bytes of a number.
const NUMBER: usize = size_of::<Real>();
const HEADER: usize = 144;

/// Bodies 13 to 15, of which one is moving, one kinematic and one fixed, two steps into a run.
fn three_bodies() -> (World, Vec<u8>) {
    let mut world = World::new();
    for id in 13..16 {
        mixed_body(id).spawn(&mut world);
    }
    let mut simulation = Simulation::new(Settings::default().with_dt(0.125)).unwrap();
    simulation.step_many(&mut world, 2);
    let bytes = Snapshot::capture(&world).unwrap().with_clock(simulation.clock()).to_bytes();
    (world, bytes)
}

fn error_of(bytes: &[u8]) -> SnapshotError {
    Snapshot::from_bytes(bytes).unwrap_err()
}

#[test]
fn what_is_read_is_what_was_written() {
    let mut world = mixed_bodies(500);
    let mut simulation = Simulation::new(Settings::default()).unwrap();
    simulation.step_many(&mut world, 5);
    let without = Snapshot::capture(&world).unwrap();
    for snapshot in [without.clone(), without.with_clock(simulation.clock()), Snapshot::default()] {
        let bytes = snapshot.to_bytes();
        let read = Snapshot::from_bytes(&bytes).unwrap();
        assert_eq!(read.first_difference(&snapshot), None);
        assert_eq!((read.len(), read.clock()), (snapshot.len(), snapshot.clock()));
        assert_eq!(read.state_hash(), snapshot.state_hash());
        assert_eq!(read.to_bytes(), bytes);
    }
}

/// The format, byte by byte: files of today are read by the versions of tomorrow, or refused by
/// number.
#[test]
fn the_format_is_as_documented() {
    let (world, bytes) = three_bodies();
    assert_eq!(bytes.len(), HEADER + 3 * 8 + (3 * 7 + 2 * 6) * NUMBER + 8);
    assert_eq!(&bytes[..8], b"TUMBLE-S");
    let word = |place: usize| u64::from_le_bytes(*bytes[place..].first_chunk().unwrap());
    assert_eq!(word(8), 9 | (NUMBER as u64) << 32);
    assert_eq!([16, 24, 32].map(word), [1, 1, 1]);
    assert_eq!([40, 48, 56, 64].map(word), [1, 2, 0, 0]);
    assert_eq!(f64::from_bits(word(72)), 0.125);
    // No contacts, of which `contact_snapshots.rs` is about, and no joints in passes.
    assert_eq!([88, 96, 104, 112, 120].map(word), [0; 5]);
    // No breakable joints.
    assert_eq!([128, 136].map(word), [0; 2]);
    assert_eq!([144, 152, 160].map(word), [13, 14, 15]);
    let first = BodyOrder::of(&world).entities()[0];
    let x = world.get::<&tumble::Pose>(first).unwrap().position.x;
    assert_eq!(&bytes[168..168 + NUMBER], x.to_le_bytes());
    assert_eq!(forged(&bytes, 0, b"TUMBLE-S"), bytes);
}

#[test]
fn every_flipped_bit_is_refused() {
    let (_, bytes) = three_bodies();
    assert!(Snapshot::from_bytes(&bytes).is_ok());
    for bit in 0..bytes.len() * 8 {
        let mut damaged = bytes.clone();
        damaged[bit / 8] ^= 1 << (bit % 8);
        let error = error_of(&damaged);
        let fits = match bit / 8 {
            0..8 => error == SnapshotError::NotASnapshot,
            8..12 => matches!(error, SnapshotError::Version { .. }),
            12..16 => matches!(error, SnapshotError::Precision { .. }),
            16..40 | 88..144 => matches!(error, SnapshotError::Length { .. }),
            _ => error == SnapshotError::Checksum,
        };
        assert!(fits, "bit {bit}: {error}");
    }
}

#[test]
fn every_cut_is_refused() {
    let (_, bytes) = three_bodies();
    for end in 0..bytes.len() {
        let error = error_of(&bytes[..end]);
        let fits =
            if end < 8 { error == SnapshotError::NotASnapshot } else { matches!(error, SnapshotError::Length { .. }) };
        assert!(fits, "{end} bytes: {error}");
    }
    let longer = [bytes.as_slice(), &[0]].concat();
    let expected = bytes.len() as u64;
    assert_eq!(error_of(&longer), SnapshotError::Length { found: longer.len(), expected });
}

#[test]
fn foreign_versions_and_precisions_are_refused() {
    let (_, bytes) = three_bodies();
    let version = Snapshot::VERSION + 1;
    let error = error_of(&forged(&bytes, 8, &version.to_le_bytes()));
    assert_eq!(error, SnapshotError::Version { found: version, expected: Snapshot::VERSION });
    let other = 12 - NUMBER as u32;
    assert_eq!(error_of(&forged(&bytes, 12, &other.to_le_bytes())), SnapshotError::Precision { found: other });
    for counts in [[u64::MAX; 3], [1 << 61, 0, 0], [u64::MAX / 60, 1, 1]] {
        let error = error_of(&forged(&bytes, 16, &counts.map(u64::to_le_bytes).concat()));
        assert!(matches!(error, SnapshotError::Length { expected, .. } if expected > 1 << 60), "{error}");
    }
}

/// States that no world can have, under a checksum that fits.
#[test]
fn impossible_states_are_refused() {
    let (_, bytes) = three_bodies();
    let (ids, poses) = (HEADER, HEADER + 3 * 8);
    let motions = poses + 3 * 7 * NUMBER;
    for place in [ids, ids + 16] {
        let error = error_of(&forged(&bytes, place, &14_u64.to_le_bytes()));
        assert_eq!(error, SnapshotError::Duplicate { id: BodyId(14) });
    }
    for bad in [Real::NAN, Real::INFINITY, Real::NEG_INFINITY] {
        for (start, numbers, first) in [(poses, 7, 13), (motions, 6, 13)] {
            for place in 0..12 {
                let id = BodyId(first + place as u64 / numbers);
                let error = error_of(&forged(&bytes, start + place * NUMBER, &bad.to_le_bytes()));
                assert_eq!(error, SnapshotError::NotFinite { id }, "{bad} in place {place}");
            }
        }
    }
    let orientation = |w: Real| forged(&bytes, poses + 3 * NUMBER, &[0.0, 0.0, 0.0, w].map(Real::to_le_bytes).concat());
    for good in [1.0, -1.0, 0.9995, 1.0005] {
        assert!(Snapshot::from_bytes(&orientation(good)).is_ok());
    }
    for bad in [0.0, 0.5, 0.998, 1.002, Real::MAX] {
        let error = error_of(&orientation(bad));
        assert!(matches!(error, SnapshotError::NotUnit { id: BodyId(13), .. }), "{error}");
    }
}

/// Clocks that no simulation leaves and none can go on from: the next step would overflow, or time
/// stand still.
#[test]
fn impossible_clocks_are_refused() {
    let (_, bytes) = three_bodies();
    let number = |x: f64| x.to_bits();
    let clocks = [
        (40, 0),
        (40, 2),
        (48, u64::MAX),
        (48, (1 << 53) + 1),
        (56, 3),
        (64, number(f64::NAN)),
        (64, number(f64::INFINITY)),
        (72, number(0.0)),
        (72, number(-0.125)),
        (72, number(f64::NAN)),
        (80, number(-1.0)),
        (80, number(f64::INFINITY)),
    ];
    for (place, field) in clocks {
        let error = error_of(&forged(&bytes, place, &u64::to_le_bytes(field)));
        assert_eq!(error, SnapshotError::Clock, "byte {place}: {field:#x}");
    }
    // The longest run there can be still steps.
    let longest = Snapshot::from_bytes(&forged(&bytes, 48, &(1_u64 << 53).to_le_bytes())).unwrap();
    let mut simulation = Simulation::new(Settings::default()).unwrap();
    simulation.set_clock(longest.clock().unwrap());
    simulation.step(&mut World::new());
    assert_eq!(simulation.steps(), (1 << 53) + 1);
}

/// Breakable joints that are named twice, out of order, or half broken.
#[test]
fn impossible_joints_are_refused() {
    let mut world = World::new();
    let body = mixed_body(13).spawn(&mut world);
    for id in [Some(3), None, Some(1)] {
        let joint =
            world.spawn((Joint::free(body, body), Breakable { is_broken: id == Some(3), ..Breakable::at_force(1.0) }));
        id.into_iter().for_each(|id| world.insert_one(joint, BodyId(id)).unwrap());
    }
    let bytes = Snapshot::capture(&world).unwrap().to_bytes();
    let (flags, keys) = (bytes.len() - 8 - 3, bytes.len() - 8 - 3 * 9);
    assert_eq!(bytes[flags..flags + 3], [0, 1, 0]);
    assert_eq!([&bytes[keys..keys + 8], &bytes[keys + 8..keys + 16]], [1, 3].map(u64::to_le_bytes));
    for joint in 0..3 {
        assert!(Snapshot::from_bytes(&forged(&bytes, flags + joint, &[1])).is_ok());
        assert_eq!(error_of(&forged(&bytes, flags + joint, &[2])), SnapshotError::Joint { joint });
    }
    for first in [3_u64, 4] {
        let error = error_of(&forged(&bytes, keys, &first.to_le_bytes()));
        assert_eq!(error, SnapshotError::Joint { joint: 1 });
    }
    let too_many = error_of(&forged(&bytes, 120, &u64::MAX.to_le_bytes()));
    assert_eq!(too_many, SnapshotError::Length { found: bytes.len(), expected: u64::MAX });
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(2000) })]
    #[test]
    fn no_bytes_make_it_panic(
        place in 8_usize..348,
        other in prop::collection::vec(any::<u8>(), 1..64),
        cut in prop_oneof![Just(0_usize), 1_usize..40],
    ) {
        let (mut world, bytes) = three_bodies();
        let mut damaged = forged(&bytes, place.min(bytes.len() - other.len()), &other);
        // Most are whole, so that what stands behind a forged checksum is read.
        damaged.truncate(damaged.len() - cut);
        let before = state_hash(&world, &BodyOrder::of(&world));
        // What is let in under a forged checksum is a state that a world can have, or bodies that
        // this one lacks.
        if let Ok(snapshot) = Snapshot::from_bytes(&damaged) {
            if snapshot.restore(&mut world).is_err() {
                assert_eq!(state_hash(&world, &BodyOrder::of(&world)), before);
            } else {
                assert_eq!(state_hash(&world, &BodyOrder::of(&world)), snapshot.state_hash());
            }
        }
        assert!(Snapshot::from_bytes(&other).is_err());
    }
}

#[test]
fn a_postcard_file_is_as_small_as_the_numbers() {
    for bodies in [100, 10_000] {
        let mut world = mixed_bodies(bodies);
        // Identities of all sizes: in postcard's own integers a large one would take ten bytes.
        for id in world.query_mut::<&mut BodyId>() {
            id.0 = id.0.wrapping_mul(0x9e37_79b9_7f4a_7c15);
        }
        let snapshot = Snapshot::capture(&world).unwrap();
        let moved = world.query::<&tumble::Velocity>().iter().count();
        let raw = bodies * (8 + 7 * NUMBER) + moved * 6 * NUMBER;
        let file = postcard::to_stdvec(&snapshot).unwrap();
        assert!(file.len() >= raw && file.len() * 10 <= raw * 11, "{} bytes for {raw}", file.len());
        let read: Snapshot = postcard::from_bytes(&file).unwrap();
        assert_eq!(read.to_bytes(), snapshot.to_bytes());
    }
}

#[test]
fn any_format_of_serde_takes_it() {
    let (_, bytes) = three_bodies();
    let snapshot = Snapshot::from_bytes(&bytes).unwrap();
    let text = serde_json::to_string(&snapshot).unwrap();
    let read: Snapshot = serde_json::from_str(&text).unwrap();
    assert_eq!(read.to_bytes(), bytes);
    // What is wrong is said in the format's own error, where it has one for words.
    let error = serde_json::from_str::<Snapshot>("[84, 85]").unwrap_err();
    assert!(error.to_string().contains("this is not a snapshot"), "{error}");
    let mut file = postcard::to_stdvec(&snapshot).unwrap();
    file[182] ^= 1;
    assert!(postcard::from_bytes::<Snapshot>(&file).is_err());
    assert!(serde_json::from_str::<Snapshot>("[1, 2, 300]").is_err());
    assert!(serde_json::from_str::<Snapshot>("{}").is_err());
}
