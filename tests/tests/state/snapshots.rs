//! Promise: a world put back to a snapshot goes on from there as it did before, to the bit, step
//! after step, whatever was spawned, despawned or moved between archetypes in between, and so does
//! another world with the same bodies. What cannot be restored is refused with a typed error, and
//! the world is as it was. A snapshot takes at most 64 bytes a body in single precision.
//!
//! Why: rollback netcode, replays and searches live from it. It fails if a part of the state is
//! forgotten, the time that force laws see is not set back, a body gets the state of its neighbour,
//! or a failed restore leaves half of it behind.

use std::collections::BTreeMap;

use hecs::{Entity, World};
use proptest::prelude::{ProptestConfig, Strategy, any, prop, prop_oneof, proptest};
use tumble::math::{Real, Vec3};
use tumble::{
    BodyId, BodyKind, BodyOrder, BodyState, ForceLaw, Integrator, InverseInertia, Momentum, Pose, PreviousPose,
    PrincipalAxes, RigidBody, Settings, Shape, Simulation, Snapshot, SnapshotError, Velocity, Wrench, update_derived,
};
use tumble_benches::mixed_body;
use tumble_tests::hash;

const BODIES: u64 = 96;

/// Pulls in alternating directions: depends on time.
#[derive(Clone)]
struct Tide;

impl ForceLaw for Tide {
    fn wrench(&self, state: &BodyState<'_>) -> Wrench {
        let phase = (state.time - state.time.floor() - 0.5) as Real;
        Wrench { force: Vec3::X * (phase * state.mass), torque: Vec3::ZERO }
    }
}

/// Drags and twists, on bodies that have it.
struct Honey(Real);

impl ForceLaw for Honey {
    fn wrench(&self, state: &BodyState<'_>) -> Wrench {
        Wrench { force: state.linear_velocity * -self.0, torque: state.to_world(Vec3::Z * (self.0 * 1e-3)) }
    }
}

fn simulation(integrator: Integrator) -> Simulation {
    let mut simulation = Simulation::new(Settings::default().with_integrator(integrator).with_substeps(2)).unwrap();
    simulation.add_global_law(Tide);
    simulation.add_law::<Honey>();
    simulation
}

/// A body of every kind there is: shapes, own principal axes, damping, kinematic and fixed ones;
/// some are interpolated, some in honey.
fn spawn(world: &mut World, id: u64) -> Entity {
    let entity = mixed_body(id).spawn(world);
    if id.is_multiple_of(3) {
        let pose = *world.get::<&Pose>(entity).unwrap();
        world.insert_one(entity, PreviousPose(pose)).unwrap();
    }
    if id.is_multiple_of(5) {
        world.insert_one(entity, Honey(0.1)).unwrap();
    }
    entity
}

fn scene(ids: impl IntoIterator<Item = u64>) -> World {
    let mut world = World::new();
    for id in ids {
        spawn(&mut world, id);
    }
    world
}

/// Everything of a body that a step writes.
type Written = (Pose, Option<Momentum>, Option<Velocity>, Option<InverseInertia>, Option<PreviousPose>, Option<Wrench>);

/// All that steps write, body by body.
fn written(world: &World) -> BTreeMap<BodyId, Written> {
    let bodies = BodyOrder::of(world);
    let of = |&entity: &Entity| {
        let body = world.entity(entity).unwrap();
        let written = (
            *body.get::<&Pose>().unwrap(),
            body.get::<&Momentum>().map(|c| *c),
            body.get::<&Velocity>().map(|c| *c),
            body.get::<&InverseInertia>().map(|c| *c),
            body.get::<&PreviousPose>().map(|c| *c),
            body.get::<&Wrench>().map(|c| *c),
        );
        (*body.get::<&BodyId>().unwrap(), written)
    };
    bodies.entities().iter().map(of).collect()
}

fn entity(world: &World, id: u64) -> Entity {
    let mut query = world.query::<(Entity, &BodyId)>();
    query.iter().find(|(_, found)| **found == BodyId(id)).unwrap().0
}

/// A moment of a run: time, hash, and all that was written.
type Moment = (u64, f64, u64, BTreeMap<BodyId, Written>);

/// Steps under forces that are different in each.
fn run(world: &mut World, simulation: &mut Simulation, steps: u64) -> Vec<Moment> {
    let mut moments = Vec::new();
    for _ in 0..steps {
        let step = simulation.steps();
        for (id, wrench) in world.query_mut::<(&BodyId, &mut Wrench)>() {
            let push = ((id.0 * 7 + step * 3) % 11) as Real - 5.0;
            wrench.add_force(Vec3::new(push, 0.0, -push));
        }
        simulation.step(world);
        moments.push((simulation.steps(), simulation.time(), hash(world), written(world)));
    }
    moments
}

/// Fails with the first body that differs.
fn assert_same(found: &[Moment], expected: &[Moment]) {
    for (found, expected) in found.iter().zip(expected) {
        assert_eq!((found.0, found.1), (expected.0, expected.1), "step and time");
        assert_same_bodies(&found.3, &expected.3);
        assert_eq!(found.2, expected.2, "hash of step {}", found.0);
    }
    assert_eq!(found.len(), expected.len());
}

fn assert_same_bodies(found: &BTreeMap<BodyId, Written>, expected: &BTreeMap<BodyId, Written>) {
    assert!(found.keys().eq(expected.keys()));
    for (id, state) in found {
        assert_eq!(*state, expected[id], "{id:?}");
    }
}

#[test]
fn a_restored_run_goes_on_to_the_bit() {
    for integrator in Integrator::ALL {
        let (mut world, mut simulation) = (scene(0..BODIES), simulation(integrator));
        run(&mut world, &mut simulation, 10);
        // From here on time is not a multiple of dt alone.
        let settings = simulation.settings().with_dt(0.011);
        simulation.set_settings(settings).unwrap();
        run(&mut world, &mut simulation, 7);
        simulation.advance(&mut world, 0.004);
        let snapshot = Snapshot::capture(&world).unwrap().with_clock(simulation.clock());
        assert_eq!(snapshot.state_hash(), hash(&world), "{integrator}");

        let first = run(&mut world, &mut simulation, 40);
        assert_eq!(snapshot.restore(&mut world).unwrap(), []);
        simulation.set_clock(snapshot.clock().unwrap());
        assert_eq!(simulation.clock(), snapshot.clock().unwrap());
        assert_eq!(snapshot.state_hash(), hash(&world), "{integrator}");
        assert_same(&run(&mut world, &mut simulation, 40), &first);
        assert_ne!(first[0].2, first[39].2);
    }
}

/// The bodies of a snapshot that was written and read again, in a world that spawned them the other
/// way round and never had those states.
#[test]
fn another_world_goes_on_to_the_bit() {
    for integrator in Integrator::ALL {
        let (mut world, mut first) = (scene(0..BODIES), simulation(integrator));
        run(&mut world, &mut first, 12);
        let bytes = Snapshot::capture(&world).unwrap().with_clock(first.clock()).to_bytes();
        let snapshot = Snapshot::from_bytes(&bytes).unwrap();
        let (mut other, mut second) = (scene((0..BODIES).rev()), simulation(integrator));
        assert_eq!(snapshot.restore(&mut other).unwrap(), []);
        second.set_clock(snapshot.clock().unwrap());
        assert_same(&run(&mut other, &mut second, 40), &run(&mut world, &mut first, 40));
        // The same bodies in another order are the same bytes.
        let taken = [&world, &other].map(|world| Snapshot::capture(world).unwrap().to_bytes());
        assert_eq!(taken[0], taken[1]);
    }
}

/// Others spawn, leave, come back and change archetype; hecs fills their rows with the last ones of
/// the archetype.
#[test]
fn bodies_may_come_go_and_move_in_memory() {
    let (mut world, mut simulation) = (scene(0..BODIES), simulation(Integrator::default()));
    run(&mut world, &mut simulation, 5);
    let snapshot = Snapshot::capture(&world).unwrap().with_clock(simulation.clock());
    let expected = run(&mut world, &mut simulation, 20);

    for id in (0..BODIES).step_by(7) {
        let old = entity(&world, id);
        world.despawn(old).unwrap();
        spawn(&mut world, BODIES + id);
        spawn(&mut world, id);
    }
    for id in (0..BODIES).step_by(4) {
        let moved = entity(&world, id);
        world.insert(moved, ("red", 3_u8)).unwrap();
    }
    for id in (0..BODIES).step_by(8) {
        let moved = entity(&world, id);
        world.remove_one::<&str>(moved).unwrap();
    }
    run(&mut world, &mut simulation, 3);
    let spawned_since = snapshot.restore(&mut world).unwrap();
    let ids: Vec<u64> = spawned_since.iter().map(|&entity| world.get::<&BodyId>(entity).unwrap().0).collect();
    assert_eq!(ids, (0..BODIES).step_by(7).map(|id| BODIES + id).collect::<Vec<_>>());
    for entity in spawned_since {
        world.despawn(entity).unwrap();
    }
    simulation.set_clock(snapshot.clock().unwrap());
    assert_same(&run(&mut world, &mut simulation, 20), &expected);
}

/// Spawns, despawns and changes of archetype at random: each body of the snapshot has its state of
/// then, each other its state of now.
#[derive(Clone, Debug)]
enum Change {
    Spawn,
    Respawn(usize),
    SeriesStyle(usize),
    Unmark(usize),
}

fn changes() -> impl Strategy<Value = Vec<Change>> {
    let which = any::<usize>();
    let change = prop_oneof![
        proptest::strategy::Just(Change::Spawn),
        which.prop_map(Change::Respawn),
        which.prop_map(Change::SeriesStyle),
        which.prop_map(Change::Unmark),
    ];
    prop::collection::vec(change, 0..60)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(200) })]
    #[test]
    fn every_body_gets_its_own_state(before in changes(), after in changes()) {
        let mut world = scene(0..40);
        let mut next = 40;
        apply(&mut world, &before, &mut next);
        let snapshot = Snapshot::capture(&world).unwrap();
        let then = written(&world);
        apply(&mut world, &after, &mut next);
        Simulation::new(Settings::default()).unwrap().step(&mut world);
        let mut expected = written(&world);
        let newcomers: Vec<BodyId> = expected.keys().filter(|id| !then.contains_key(id)).copied().collect();
        for (id, state) in then {
            let previous = state.4.map(|_| PreviousPose(state.0));
            expected.insert(id, (state.0, state.1, state.2, state.3, previous, state.5));
        }
        let spawned_since = snapshot.restore(&mut world).unwrap();
        update_derived(&mut world);
        assert_same_bodies(&written(&world), &expected);
        let reported: Vec<BodyId> =
            spawned_since.into_iter().map(|entity| *world.get::<&BodyId>(entity).unwrap()).collect();
        assert_eq!(reported, newcomers);
    }
}

fn apply(world: &mut World, changes: &[Change], next: &mut u64) {
    for change in changes {
        let bodies = BodyOrder::of(world);
        let pick = |which: usize| bodies.entities()[which % bodies.len()];
        match *change {
            Change::Spawn => {
                spawn(world, *next);
                *next += 1;
            }
            Change::Respawn(which) => {
                let id = world.get::<&BodyId>(pick(which)).unwrap().0;
                world.despawn(pick(which)).unwrap();
                spawn(world, id);
            }
            Change::SeriesStyle(which) => world.insert_one(pick(which), 'm').unwrap(),
            Change::Unmark(which) => {
                let _ = world.remove_one::<char>(pick(which));
            }
        }
    }
}

#[test]
fn a_snapshot_takes_64_bytes_a_body() {
    let most = if size_of::<Real>() == 4 { 64 } else { 112 };
    for bodies in [1_000, 10_000] {
        let world = scene(0..bodies);
        let snapshot = Snapshot::capture(&world).unwrap();
        assert_eq!(snapshot.len() as u64, bodies);
        let archetypes = world.archetypes().count();
        // What does not grow with the bodies: the snapshot itself, and where each archetype's rows
        // are. Fixed bodies take less.
        let fixed_part = size_of::<Snapshot>() + 4 * archetypes.next_power_of_two() * 24;
        let most = bodies as usize * most + fixed_part;
        assert!(snapshot.memory() <= most, "{} bytes for {bodies} bodies, more than {most}", snapshot.memory());
        assert!(snapshot.memory() > bodies as usize * 48);
        let loaded = Snapshot::from_bytes(&snapshot.to_bytes()).unwrap();
        assert!(loaded.memory() <= most, "{} bytes when loaded", loaded.memory());
    }
}

/// A body that is gone cannot be made again from its state: all that are missing are named, and
/// nothing is changed.
#[test]
fn missing_bodies_are_named_and_the_world_stays() {
    let (mut world, mut simulation) = (scene(0..BODIES), simulation(Integrator::default()));
    let snapshot = Snapshot::capture(&world).unwrap();
    let start = hash(&world);
    run(&mut world, &mut simulation, 4);
    for id in [40, 3, 15] {
        let gone = entity(&world, id);
        world.despawn(gone).unwrap();
    }
    let before = written(&world);
    let error = snapshot.restore(&mut world).unwrap_err();
    assert_eq!(error, SnapshotError::Missing { ids: [3, 15, 40].map(BodyId).to_vec() });
    assert_eq!(error.to_string(), "3 bodies of the snapshot are not in the world, the first is BodyId 3");
    assert_same_bodies(&written(&world), &before);
    for id in [3, 15, 40] {
        spawn(&mut world, id);
    }
    assert_eq!(snapshot.restore(&mut world).unwrap(), []);
    assert_eq!(hash(&world), start);
    let error = snapshot.restore(&mut World::new()).unwrap_err();
    assert_eq!(error, SnapshotError::Missing { ids: (0..BODIES).map(BodyId).collect() });
}

/// One archetype of the same place among those of another world has bodies of another kind.
#[test]
fn a_body_of_another_kind_is_refused() {
    let body = || RigidBody::new(Shape::sphere(0.5)).without_collider().id(BodyId(9));
    let bodies = [
        (BodyKind::Moving, body().mass(1.0).build().unwrap()),
        (BodyKind::Kinematic, body().kinematic().build().unwrap()),
        (BodyKind::Fixed, body().fixed().build().unwrap()),
    ];
    for (was, body) in &bodies {
        let mut captured = World::new();
        body.spawn(&mut captured);
        let snapshot = Snapshot::capture(&captured).unwrap();
        for (is, other) in &bodies {
            let mut world = World::new();
            let other = other.spawn(&mut world);
            world.get::<&mut Pose>(other).unwrap().position = Vec3::ONE;
            let before = written(&world);
            let (was, is) = (*was, *is);
            match snapshot.restore(&mut world) {
                Ok(_) => assert_eq!(was, is),
                Err(error) => {
                    assert_eq!(error, SnapshotError::Changed { id: BodyId(9), was, is });
                    assert_same_bodies(&written(&world), &before);
                }
            }
        }
    }
}

#[test]
fn two_bodies_with_one_identity_are_refused() {
    // Close to each other and far apart, next to each other in memory and in different archetypes.
    for far in [0, u64::MAX / 2] {
        for (first, second) in [(0, 16), (0, 1), (3, 14), (15, 31)] {
            let mut world = scene(0..32);
            for id in world.query_mut::<&mut BodyId>() {
                id.0 += if id.0 == 5 { far } else { 0 };
            }
            let snapshot = Snapshot::capture(&world).unwrap();
            let moved = world.query_mut::<&mut BodyId>().into_iter().find(|id| id.0 == second).unwrap();
            moved.0 = first;
            let before = hash(&world);
            let expected = SnapshotError::Duplicate { id: BodyId(first) };
            assert_eq!(Snapshot::capture(&world).unwrap_err(), expected);
            let mut used = snapshot.clone();
            assert_eq!(used.recapture(&world).unwrap_err(), expected);
            assert!(used.is_empty() && used.recapture(&world).unwrap_err() == expected);
            // One is missing too; that both are there is what is wrong.
            let error = snapshot.restore(&mut world).unwrap_err();
            assert!([expected, SnapshotError::Missing { ids: vec![BodyId(second)] }].contains(&error), "{error}");
            spawn(&mut world, second);
            let error = snapshot.restore(&mut world).unwrap_err();
            assert_eq!(error, SnapshotError::Duplicate { id: BodyId(first) });
            world.despawn(entity(&world, second)).unwrap();
            assert_eq!(hash(&world), before);
        }
    }
    // Two newcomers.
    let mut world = scene(0..4);
    let snapshot = Snapshot::capture(&world).unwrap();
    spawn(&mut world, 7);
    spawn(&mut world, 7);
    assert_eq!(snapshot.restore(&mut world).unwrap_err(), SnapshotError::Duplicate { id: BodyId(7) });
}

#[test]
fn bodies_that_move_need_an_identity_and_scenery_does_not() {
    let mut world = scene(0..8);
    let anonymous = RigidBody::new(Shape::sphere(0.5)).without_collider();
    let scenery = anonymous.clone().fixed().position(Vec3::X).build().unwrap().spawn(&mut world);
    let snapshot = Snapshot::capture(&world).unwrap();
    assert_eq!(snapshot.len(), 8);
    world.get::<&mut Pose>(scenery).unwrap().position = Vec3::Y;
    assert_eq!(snapshot.restore(&mut world).unwrap(), []);
    assert_eq!(world.get::<&Pose>(scenery).unwrap().position, Vec3::Y);

    anonymous.clone().mass(1.0).build().unwrap().spawn(&mut world);
    let error = SnapshotError::Unidentified { bodies: 1 };
    assert_eq!(Snapshot::capture(&world).unwrap_err(), error);
    assert_eq!(snapshot.restore(&mut world).unwrap_err(), error);
    anonymous.kinematic().build().unwrap().spawn(&mut world);
    assert_eq!(Snapshot::capture(&world).unwrap_err(), SnapshotError::Unidentified { bodies: 2 });
}

/// What was pending is gone, what is drawn does not jump, and what is derived follows.
#[test]
fn a_restored_world_has_no_leftovers() {
    let (mut world, mut simulation) = (scene(0..BODIES), simulation(Integrator::default()));
    run(&mut world, &mut simulation, 9);
    let (snapshot, then) = (Snapshot::capture(&world).unwrap(), written(&world));
    run(&mut world, &mut simulation, 9);
    for wrench in world.query_mut::<&mut Wrench>() {
        wrench.add_torque(Vec3::ONE);
    }
    for (_, velocity) in world.query_mut::<(&BodyId, &mut Velocity)>() {
        velocity.linear += Vec3::ONE;
    }
    snapshot.restore(&mut world).unwrap();
    update_derived(&mut world);
    for (id, (pose, momentum, velocity, inverse, previous, wrench)) in written(&world) {
        let old = then[&id];
        assert_eq!((pose, momentum, velocity, inverse), (old.0, old.1, old.2, old.3), "{id:?}");
        assert_eq!(previous, old.4.map(|_| PreviousPose(pose)), "{id:?}");
        assert_eq!(wrench, old.5.map(|_| Wrench::default()), "{id:?}");
    }
    assert!(world.query::<(&PreviousPose, &PrincipalAxes)>().iter().count() > 0);
}

/// A clock read under another step keeps its time and counts on with the present one.
#[test]
fn a_clock_keeps_its_time_under_other_settings() {
    let mut world = World::new();
    let mut simulation = Simulation::new(Settings::default().with_dt(0.5)).unwrap();
    simulation.step_many(&mut world, 3);
    simulation.advance(&mut world, 0.25);
    let clock = simulation.clock();
    assert_eq!((clock.steps(), clock.time()), (3, 1.5));
    simulation.set_settings(Settings::default().with_dt(0.125)).unwrap();
    simulation.advance(&mut world, 0.3);
    simulation.set_clock(clock);
    assert_eq!((simulation.steps(), simulation.time()), (3, 1.5));
    simulation.step(&mut world);
    assert_eq!((simulation.steps(), simulation.time()), (4, 1.625));
    // What a frame had owed is owed again: two steps of it.
    simulation.advance(&mut world, 0.0);
    assert_eq!(simulation.steps(), 6);
}

#[test]
fn nothing_is_a_snapshot_too() {
    let mut world = World::new();
    world.spawn((BodyId(3), "no body"));
    let snapshot = Snapshot::capture(&world).unwrap();
    assert!(snapshot.is_empty() && snapshot.ids().is_empty());
    assert_eq!(snapshot.state_hash(), hash(&world));
    assert_eq!(snapshot.restore(&mut world).unwrap(), []);
    let new = spawn(&mut world, 1);
    assert_eq!(snapshot.restore(&mut world).unwrap(), [new]);
}

#[test]
fn the_first_difference_is_found() {
    let mut world = scene(0..BODIES);
    let snapshot = |world: &World| Snapshot::capture(world).unwrap();
    let start = snapshot(&world);
    assert_eq!(start.first_difference(&snapshot(&scene((0..BODIES).rev()))), None);
    let one = entity(&world, 46);
    world.get::<&mut Velocity>(one).unwrap().angular.y += 1e-3;
    // A kinematic body, whose velocity no state hash sees.
    assert!(!world.satisfies::<&Momentum>(one));
    assert_eq!(start.first_difference(&snapshot(&world)), Some(BodyId(46)));
    let other = entity(&world, 17);
    world.get::<&mut Momentum>(other).unwrap().linear.z += 1.0;
    assert_eq!(start.first_difference(&snapshot(&world)), Some(BodyId(17)));
    let gone = entity(&world, 5);
    world.despawn(gone).unwrap();
    assert_eq!(start.first_difference(&snapshot(&world)), Some(BodyId(5)));
    assert_eq!(snapshot(&world).first_difference(&start), Some(BodyId(5)));
    assert_eq!(start.first_difference(&Snapshot::default()), Some(BodyId(0)));
}
