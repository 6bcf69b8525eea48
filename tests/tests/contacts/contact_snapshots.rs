//! Promise: a pile that is put back to a snapshot of its simulation goes on to the bit as it did,
//! step by step: in the same world and simulation, in others whose bodies were spawned in another
//! order, through bytes, and through a `Rollback`. The contacts in it are what a step needs:
//! without them the pile goes on otherwise. A file whose contacts no step leaves is refused.
//!
//! Why: contacts begin with the impulses of the step before, so they are state. It fails if
//! anything that a step keeps of contacts is not saved, goes by entity or row, or is put back to
//! other bodies.

use hecs::{Entity, World};
use tumble::math::{Real, Vec3};
use tumble::prelude::*;
use tumble::{Collider, Contact, ContactDefect, ContactEvent, Rollback, Snapshot, SnapshotError};
use tumble_tests::{forged, hash, run};

use crate::pile;
use pile::{plain_scene, scene, settings, shuffled};

fn simulation() -> Simulation {
    Simulation::new(settings()).unwrap()
}

/// Hashes after each of this many steps.
fn hashes(simulation: &mut Simulation, world: &mut World, steps: u32) -> Vec<u64> {
    let step = |_| {
        simulation.step(world);
        hash(world)
    };
    (0..steps).map(step).collect()
}

/// A pile after 100 steps, in the middle of falling together, with a snapshot of then and the
/// hashes of the 50 steps after.
fn before_and_after() -> (World, Simulation, Snapshot, Vec<u64>) {
    let (mut world, mut simulation) = (plain_scene(), simulation());
    run(&mut simulation, &mut world, 100);
    let snapshot = simulation.snapshot(&world).unwrap();
    assert!(simulation.contacts().filter(Contact::touches).count() > 60);
    let after = hashes(&mut simulation, &mut world, 50);
    (world, simulation, snapshot, after)
}

/// A contact in any world: identities in the place of entities, position, separation and impulse of
/// points, normal and friction.
type Reported = (Vec<Option<u64>>, Vec<[Real; 5]>, [Real; 6]);

fn told(simulation: &Simulation, world: &World) -> Vec<Reported> {
    let id = |entity: &Entity| world.get::<&BodyId>(*entity).ok().map(|id| id.0);
    let contact = |contact: Contact| {
        let points = contact.points().iter().map(|point| {
            let Vec3 { x, y, z } = point.position;
            [x, y, z, point.separation, point.impulse]
        });
        let [n, f] = [contact.normal, contact.friction].map(|vector| vector.to_array());
        (contact.bodies.iter().map(id).collect(), points.collect(), [n[0], n[1], n[2], f[0], f[1], f[2]])
    };
    simulation.contacts().map(contact).collect()
}

#[test]
fn a_pile_goes_on_as_it_did() {
    let (mut world, mut simulation, snapshot, after) = before_and_after();
    let clock = snapshot.clock();
    let read = Snapshot::from_bytes(&snapshot.to_bytes()).unwrap();
    for snapshot in [&snapshot, &read] {
        assert_eq!(simulation.restore(snapshot, &mut world), Ok(Vec::new()));
        assert_eq!((simulation.steps(), Some(simulation.clock())), (100, clock));
        assert_eq!(hashes(&mut simulation, &mut world, 50), after);
    }
}

/// A world of its own, where every entity but those of the scenery is another, with a simulation of
/// its own.
#[test]
fn a_pile_goes_on_in_another_world() {
    let (_, _, snapshot, after) = before_and_after();
    let read = Snapshot::from_bytes(&snapshot.to_bytes()).unwrap();
    for (seed, snapshot) in [(1, &snapshot), (2, &read)] {
        let (mut world, mut simulation) = (scene(&shuffled(seed)), simulation());
        // A past of its own, which is to be forgotten.
        run(&mut simulation, &mut world, 30);
        simulation.restore(snapshot, &mut world).unwrap();
        assert_eq!(hashes(&mut simulation, &mut world, 50), after, "seed {seed}");
    }
}

/// So the tests above can fail.
#[test]
fn without_contacts_a_pile_goes_on_otherwise() {
    let (mut world, mut simulation, _, after) = before_and_after();
    let cold = {
        let (mut world, mut simulation) = (plain_scene(), self::simulation());
        run(&mut simulation, &mut world, 100);
        Snapshot::capture(&world).unwrap()
    };
    simulation.restore(&cold, &mut world).unwrap();
    assert_eq!(simulation.contacts().count(), 0);
    let first = hashes(&mut simulation, &mut world, 50);
    assert!(first.iter().zip(&after).all(|(cold, warm)| cold != warm));
    // A cold start is one start, whatever was before.
    let (mut world, mut simulation) = (plain_scene(), self::simulation());
    simulation.restore(&cold, &mut world).unwrap();
    assert_eq!(hashes(&mut simulation, &mut world, 50), first);
}

/// A body that was respawned is the one that its identity says, with another entity.
#[test]
fn a_respawned_body_has_its_contacts() {
    let (mut world, mut simulation, snapshot, after) = before_and_after();
    for id in [0, 1, 2, 17, 40] {
        let entity = world.query::<(Entity, &BodyId)>().iter().find(|(_, it)| it.0 == id).unwrap().0;
        world.despawn(entity).unwrap();
        world.spawn(());
        pile::spawn(&mut world, id);
    }
    simulation.restore(&snapshot, &mut world).unwrap();
    assert_eq!(hashes(&mut simulation, &mut world, 50), after);
}

/// What is reported of contacts is restored with them, and so is what events are compared with.
#[test]
fn contacts_and_events_are_those_of_then() {
    let (mut world, mut simulation) = (plain_scene(), simulation());
    run(&mut simulation, &mut world, 100);
    let (snapshot, contacts) = (simulation.snapshot(&world).unwrap(), told(&simulation, &world));
    let events = |simulation: &mut Simulation, world: &mut World| -> Vec<Vec<ContactEvent>> {
        let step = |_| {
            simulation.step(world);
            simulation.contact_events().collect()
        };
        (0..20).map(step).collect()
    };
    let after = events(&mut simulation, &mut world);
    assert!(after.iter().flatten().count() > 10);
    let read = Snapshot::from_bytes(&snapshot.to_bytes()).unwrap();
    for snapshot in [&snapshot, &read] {
        simulation.restore(snapshot, &mut world).unwrap();
        assert_eq!(told(&simulation, &world), contacts);
        assert_eq!(simulation.contact_events().count(), 0);
        assert_eq!(events(&mut simulation, &mut world), after);
    }
    let (mut other, mut simulation) = (scene(&shuffled(4)), self::simulation());
    simulation.restore(&read, &mut other).unwrap();
    assert_eq!(told(&simulation, &other), contacts);
}

#[test]
fn a_rollback_has_contacts() {
    let (mut world, mut simulation) = (plain_scene(), simulation());
    let mut rollback = Rollback::new(20);
    run(&mut simulation, &mut world, 100);
    let mut after = Vec::new();
    for _ in 0..20 {
        rollback.save(&world, &simulation).unwrap();
        simulation.step(&mut world);
        after.push(hash(&world));
    }
    for step in [117, 109, 100] {
        rollback.rewind_to_step(step, &mut world, &mut simulation).unwrap();
        assert_eq!(hashes(&mut simulation, &mut world, 120 - step as u32), after[step as usize - 100..]);
    }
    // Contacts count as memory.
    let bare = {
        let mut rollback = Rollback::new(20);
        rollback.save(&world, &Simulation::new(settings()).unwrap()).unwrap();
        rollback.memory()
    };
    let mut one = Rollback::new(20);
    one.save(&world, &simulation).unwrap();
    assert!(one.memory() > bare + simulation.contacts().count() * 150);
}

/// The same pile is the same bytes, whatever the order its bodies were spawned in.
#[test]
fn the_same_pile_is_the_same_bytes() {
    let bytes = |mut world: World| {
        let mut simulation = simulation();
        run(&mut simulation, &mut world, 100);
        simulation.snapshot(&world).unwrap().to_bytes()
    };
    let plain = bytes(plain_scene());
    assert_eq!(bytes(scene(&shuffled(9))), plain);
    let read = Snapshot::from_bytes(&plain).unwrap();
    assert_eq!(read.to_bytes(), plain);
}

/// Two bodies with one identity, which steps do not refuse: each keeps its own contacts.
#[test]
fn two_bodies_of_one_name_stay_two() {
    let run_with = |ids: [u64; 2]| {
        let mut world = World::new();
        RigidBody::new(Shape::Point).fixed().build().unwrap().spawn_with(&mut world, (Collider::half_space(),));
        let shape = Shape::cuboid([0.5, 0.5, 0.5]);
        let bodies = ids.map(|id| {
            let body = RigidBody::new(shape.clone()).mass(1.0 + f64::from(world.len())).id(BodyId(id));
            let at = Vec3::new(world.len() as Real * 3.0, 0.5, 0.0);
            let collider = Collider::new(&shape).unwrap();
            body.position(at).build().unwrap().spawn_with(&mut world, (collider,))
        });
        let mut simulation = simulation();
        run(&mut simulation, &mut world, 60);
        // Something comes into the list before them, so that all are given new places.
        let other = RigidBody::new(shape.clone()).mass(1.0).id(BodyId(1)).position(Vec3::Y * 9.0);
        other.build().unwrap().spawn_with(&mut world, (Collider::new(&shape).unwrap(),));
        run(&mut simulation, &mut world, 10);
        bodies.map(|body| (*world.get::<&Pose>(body).unwrap(), *world.get::<&Momentum>(body).unwrap()))
    };
    assert_eq!(run_with([5, 5]), run_with([5, 6]));
}

/// Scenery that is not there is not touched, and whoever has the number of its entity is not taken
/// for it.
#[test]
fn contacts_with_scenery_that_is_gone_are_dropped() {
    let (_, _, snapshot, _) = before_and_after();
    let mut world = World::new();
    for id in shuffled(3) {
        pile::spawn(&mut world, id);
    }
    let mut simulation = simulation();
    simulation.restore(&snapshot, &mut world).unwrap();
    let contacts = simulation.contacts().count();
    assert!(contacts > 60);
    assert!(simulation.contacts().all(|contact| contact.bodies.iter().all(|body| world.get::<&BodyId>(*body).is_ok())));
    run(&mut simulation, &mut world, 10);
}

/// Two boxes beside each other on nameless ground: three bodies in contact, two contacts of four
/// points.
fn two_boxes() -> (World, Simulation, Vec<u8>) {
    let mut world = World::new();
    RigidBody::new(Shape::Point).fixed().build().unwrap().spawn_with(&mut world, (Collider::half_space(),));
    let shape = Shape::cuboid([0.5, 0.5, 0.5]);
    for id in [7, 9] {
        let at = Vec3::new(id as Real, 0.5, 0.0);
        let body = RigidBody::new(shape.clone()).mass(2.0).id(BodyId(id)).position(at).build().unwrap();
        body.spawn_with(&mut world, (Collider::new(&shape).unwrap(),));
    }
    let mut simulation = simulation();
    run(&mut simulation, &mut world, 20);
    let bytes = simulation.snapshot(&world).unwrap().to_bytes();
    (world, simulation, bytes)
}

const NUMBER: usize = size_of::<Real>();
/// Where the bodies in contact begin: after two moving bodies.
const NAMES: usize = 144 + 2 * (8 + 13 * NUMBER);
const CENTERS: usize = NAMES + 2 * 8 + 4;
/// Of joints, in double precision.
const LOADS: usize = CENTERS + 3 * 3 * NUMBER;
const RESTS: usize = LOADS + 3 * 8;
const CONTACTS: usize = RESTS + 3 * NUMBER;
const CONTACT: usize = 16 + 18 * NUMBER;
const POINTS: usize = CONTACTS + 2 * CONTACT;
const POINT: usize = 4 + 5 * NUMBER;

#[test]
fn contacts_are_in_the_file_as_documented() {
    let (_, simulation, bytes) = two_boxes();
    assert_eq!(bytes.len(), POINTS + 8 * POINT + 8);
    let word = |place: usize| u64::from_le_bytes(*bytes[place..].first_chunk().unwrap());
    let half = |place: usize| u32::from_le_bytes(*bytes[place..].first_chunk().unwrap());
    let number = |place: usize| Real::from_le_bytes(*bytes[place..].first_chunk().unwrap());
    assert_eq!([88, 96, 104, 112].map(word), [2, 1, 2, 8]);
    assert_eq!([NAMES, NAMES + 8].map(word), [7, 9]);
    assert_eq!(half(NAMES + 16), 0);
    assert_eq!([0, 8, 16].map(|place| word(LOADS + place)), [0; 3]);
    assert_eq!([0, 1, 2].map(|body| number(RESTS + body * NUMBER)), [0.0; 3]);
    // The ground is not moved by impulses, so it is the first of the two in both, though it comes
    // last.
    for (contact, body) in [(0, 0), (1, 1)] {
        let place = CONTACTS + contact * CONTACT;
        assert_eq!([0, 4, 8, 12].map(|half_word| half(place + half_word)), [2, body, 0, 4 + 256]);
        assert_eq!([16, 16 + NUMBER, 16 + 2 * NUMBER].map(|at| number(place + at)), [0.0, 1.0, 0.0]);
        // They were laid down; over a step gravity is held.
        let [closing, impulse] = [13, 14].map(|i| number(place + 16 + i * NUMBER));
        let weight = 2.0 * 9.81 * simulation.settings().dt;
        assert!(closing == 0.0 && (impulse - weight).abs() < 0.05 * weight, "{closing} {impulse} {weight}");
    }
    let first = simulation.contacts().next().unwrap();
    assert_eq!([3, 4].map(|i| number(POINTS + 4 + i * NUMBER)), {
        let point = first.points()[0];
        [point.separation, point.impulse]
    });
}

#[test]
fn impossible_loads_are_refused() {
    let (_, _, bytes) = two_boxes();
    for bad in [f64::NAN, f64::INFINITY, -1e-300] {
        for body in 0..3 {
            let error = Snapshot::from_bytes(&forged(&bytes, LOADS + 8 * body, &bad.to_le_bytes())).unwrap_err();
            assert_eq!(error, SnapshotError::JointLoad { body });
        }
    }
}

#[test]
fn impossible_times_at_rest_are_refused() {
    let (_, _, bytes) = two_boxes();
    for bad in [Real::NAN, Real::INFINITY, -0.5, 2e9] {
        for body in 0..3 {
            let place = RESTS + NUMBER * body;
            let error = Snapshot::from_bytes(&forged(&bytes, place, &bad.to_le_bytes())).unwrap_err();
            assert_eq!(error, SnapshotError::Rest { body });
        }
    }
}

#[test]
fn impossible_contacts_are_refused() {
    let (mut world, mut simulation, bytes) = two_boxes();
    let error = |place: usize, other: &[u8]| Snapshot::from_bytes(&forged(&bytes, place, other)).unwrap_err();
    let defect = |contact, defect| SnapshotError::Contact { contact, defect };
    for count in [0, 1] {
        let body = 1;
        assert_eq!(error(NAMES + 8, &u64::to_le_bytes(7 - count)), SnapshotError::ContactBody { body });
    }
    let bad_numbers = [Real::NAN, Real::INFINITY, Real::NEG_INFINITY];
    for bad in bad_numbers.map(Real::to_le_bytes) {
        for body in 0..3 {
            assert_eq!(error(CENTERS + body * 3 * NUMBER, &bad), SnapshotError::ContactBody { body });
        }
        for contact in 0..2 {
            for i in 0..18 {
                let found = error(CONTACTS + contact * CONTACT + 16 + i * NUMBER, &bad);
                assert_eq!(found, defect(contact, ContactDefect::NotFinite));
            }
            for i in 0..20 {
                let found = error(POINTS + (contact * 4 + i / 5) * POINT + 4 + i % 5 * NUMBER, &bad);
                assert_eq!(found, defect(contact, ContactDefect::NotFinite));
            }
        }
    }
    let second = CONTACTS + CONTACT;
    for bodies in [[1, 1], [3, 1], [2, u32::MAX], [2, 3]] {
        let bodies = bodies.map(u32::to_le_bytes).concat();
        assert_eq!(error(second, &bodies), defect(1, ContactDefect::Bodies));
    }
    for bodies in [[2, 0], [0, 2], [1, 0]] {
        let bodies = bodies.map(u32::to_le_bytes).concat();
        assert_eq!(error(second, &bodies), defect(1, ContactDefect::Order));
    }
    for points in [0_u32, 5, 256, 4 + 512, u32::MAX, 3, 1 + 256] {
        assert_eq!(error(second + 12, &points.to_le_bytes()), defect(1, ContactDefect::Points));
    }
    for up in [0.0, 0.9, 1.1, -0.5] {
        assert_eq!(error(second + 16 + NUMBER, &Real::to_le_bytes(up)), defect(1, ContactDefect::Normal));
    }
    for part in [-1e-3, 1.001] {
        for i in [9, 10] {
            assert_eq!(error(second + 16 + i * NUMBER, &Real::to_le_bytes(part)), defect(1, ContactDefect::Part));
        }
    }
    for halvings in [-1.0, 0.5, 7.0] {
        let found = error(second + 16 + 12 * NUMBER, &Real::to_le_bytes(halvings));
        assert_eq!(found, defect(1, ContactDefect::Halvings));
    }
    let pull = Real::to_le_bytes(-1e-3);
    assert_eq!(error(POINTS + POINT + 4 + 4 * NUMBER, &pull), defect(0, ContactDefect::Pull));
    for count in [0_u64, 3, 9, u64::MAX] {
        for place in [88, 96, 104, 112] {
            if u64::from_le_bytes(*bytes[place..].first_chunk().unwrap()) != count {
                assert!(matches!(error(place, &count.to_le_bytes()), SnapshotError::Length { .. }), "{place} {count}");
            }
        }
    }
    // Whatever features it says, it is only that no impulse is taken over.
    let strange = forged(&bytes, POINTS, &u32::MAX.to_le_bytes());
    simulation.restore(&Snapshot::from_bytes(&strange).unwrap(), &mut world).unwrap();
    run(&mut simulation, &mut world, 10);
}
