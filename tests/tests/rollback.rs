//! Promise: two peers that hear of each other's inputs late end in the state of a run that knew all
//! in time, to the bit. A `Rollback` goes back to any of the saves it keeps, sets time back with
//! the state, changes nothing where it cannot, and once it is full takes no more memory.
//!
//! Why: it is what rollback netcode is built on; a part of the state that is not set back shows as
//! a desync that no one finds. The peers are those of the example `rollback`.

#[path = "../examples/rollback/game.rs"]
mod game;
#[path = "../examples/rollback/peer.rs"]
mod peer;
#[path = "../examples/rollback/play.rs"]
mod play;
#[path = "../examples/rollback/wire.rs"]
mod wire;

use hecs::{Entity, World};
use tumble::math::{Real, Vec3};
use tumble::{
    BodyId, BodyOrder, BodyState, ForceLaw, Integrator, Rollback, RollbackError, Settings, Simulation, SnapshotError,
    Velocity, Wrench,
};
use tumble_benches::{mixed_bodies, mixed_body};
use tumble_tests::hash;

#[test]
fn two_peers_with_late_inputs_end_in_the_same_state() {
    for steps in [1, 8, 300] {
        let outcome = play::play(steps).unwrap();
        assert_eq!(outcome.peers, [outcome.referee; 2], "{steps} steps");
        for corrections in outcome.corrections {
            assert!(corrections.longest <= wire::Wire::LONGEST_DELAY);
            assert_eq!(corrections.checks, steps);
            // Guesses were wrong, and corrected, in bodies that came and went too.
            if steps == 300 {
                assert!(corrections.rewinds > 20 && corrections.steps_again > corrections.rewinds, "{corrections:?}");
                assert!(corrections.despawned > 0 && corrections.respawned > 0, "{corrections:?}");
            }
        }
    }
}

/// Depends on time.
struct Tide;

impl ForceLaw for Tide {
    fn wrench(&self, state: &BodyState<'_>) -> Wrench {
        Wrench { force: Vec3::Z * ((state.time * 3.0 % 1.0) as Real * state.mass), torque: Vec3::ZERO }
    }
}

fn simulation(integrator: Integrator) -> Simulation {
    let mut simulation = Simulation::new(Settings::default().with_integrator(integrator)).unwrap();
    simulation.add_global_law(Tide);
    simulation
}

/// State and time, and the velocities that are derived from the state.
type Moment = (u64, f64, u64, Vec<Velocity>);

fn moment(world: &mut World, simulation: &Simulation) -> Moment {
    let velocities = world.query_mut::<&Velocity>().into_iter().copied().collect();
    (simulation.steps(), simulation.time(), hash(world), velocities)
}

/// Takes a step, saved before.
fn step(world: &mut World, simulation: &mut Simulation, rollback: &mut Rollback) -> Moment {
    let before = moment(world, simulation);
    rollback.save(world, simulation).unwrap();
    simulation.step(world);
    before
}

/// Back and forth by every distance: from each moment on all is as it was.
#[test]
fn every_kept_moment_comes_back_to_the_bit() {
    for integrator in Integrator::ALL {
        let (mut world, mut simulation) = (mixed_bodies(64), simulation(integrator));
        let mut rollback = Rollback::new(6);
        // Velocities are derived by the first step.
        simulation.step(&mut world);
        let first: Vec<Moment> = (0..20).map(|_| step(&mut world, &mut simulation, &mut rollback)).collect();
        let end = moment(&mut world, &simulation);
        for back in (0..6).chain((0..6).rev()) {
            assert_eq!(rollback.rewind(back, &mut world, &mut simulation).unwrap(), [], "{integrator}");
            assert_eq!(rollback.len(), 6 - back);
            for expected in &first[19 - back..] {
                assert_eq!(step(&mut world, &mut simulation, &mut rollback), *expected, "{integrator}, {back} back");
            }
            assert_eq!(moment(&mut world, &simulation), end);
        }
    }
}

#[test]
fn only_what_is_kept_can_be_gone_back_to() {
    let (mut world, mut simulation) = (mixed_bodies(32), simulation(Integrator::default()));
    let mut rollback = Rollback::new(4);
    assert!(rollback.is_empty());
    let error = rollback.rewind_to_step(0, &mut world, &mut simulation).unwrap_err();
    assert_eq!(error, RollbackError::NoSuchStep { step: 0, kept: None });
    assert_eq!(error.to_string(), "step 0 is not kept; nothing is");
    for _ in 0..10 {
        step(&mut world, &mut simulation, &mut rollback);
    }
    let now = moment(&mut world, &simulation);
    let error = rollback.rewind(4, &mut world, &mut simulation).unwrap_err();
    assert_eq!(error, RollbackError::NotKept { saves: 4, kept: 4 });
    assert_eq!(
        rollback.rewind(usize::MAX, &mut world, &mut simulation).unwrap_err().to_string(),
        format!("cannot go {} saves back with 4 kept", usize::MAX)
    );
    for gone in [5, 10] {
        let error = rollback.rewind_to_step(gone, &mut world, &mut simulation).unwrap_err();
        assert_eq!(error, RollbackError::NoSuchStep { step: gone, kept: Some((6, 9)) });
    }
    assert_eq!(moment(&mut world, &simulation), now);
    assert_eq!((rollback.len(), rollback.snapshot(3).unwrap().clock().unwrap().steps()), (4, 6));
    rollback.rewind_to_step(7, &mut world, &mut simulation).unwrap();
    assert_eq!((rollback.len(), simulation.steps()), (2, 7));
    assert!(rollback.at_step(8).is_none() && rollback.at_step(6).is_some());

    let mut nothing = Rollback::new(0);
    nothing.save(&world, &simulation).unwrap();
    assert!(nothing.is_empty() && nothing.snapshot(0).is_none());
}

/// A second save of a step, as at the start of a replay or after the caller changed something,
/// takes the place of the first.
#[test]
fn a_step_is_kept_once() {
    let (mut world, mut simulation) = (mixed_bodies(32), simulation(Integrator::default()));
    let mut rollback = Rollback::new(4);
    for _ in 0..3 {
        step(&mut world, &mut simulation, &mut rollback);
    }
    rollback.save(&world, &simulation).unwrap();
    world.query_mut::<&mut tumble::Momentum>().into_iter().for_each(|momentum| momentum.linear += Vec3::X);
    rollback.save(&world, &simulation).unwrap();
    assert_eq!(rollback.len(), 4);
    assert_eq!(rollback.at_step(3).unwrap().state_hash(), hash(&world));
    // The clock was set back by other means: what was saved of the future goes.
    let clock = rollback.at_step(1).unwrap().clock().unwrap();
    simulation.set_clock(clock);
    rollback.save(&world, &simulation).unwrap();
    assert_eq!(rollback.len(), 2);
    assert_eq!(rollback.at_step(1).unwrap().state_hash(), hash(&world));
}

#[test]
fn a_failed_rewind_changes_nothing() {
    let (mut world, mut simulation) = (mixed_bodies(32), simulation(Integrator::default()));
    let mut rollback = Rollback::new(4);
    let start = hash(&world);
    for _ in 0..3 {
        step(&mut world, &mut simulation, &mut rollback);
    }
    let gone = BodyOrder::of(&world).entities()[11];
    world.despawn(gone).unwrap();
    simulation.step(&mut world);
    let now = moment(&mut world, &simulation);
    let error = rollback.rewind_to_step(0, &mut world, &mut simulation).unwrap_err();
    assert_eq!(error, RollbackError::Snapshot(SnapshotError::Missing { ids: vec![BodyId(11)] }));
    assert_eq!((moment(&mut world, &simulation), rollback.len()), (now, 3));
    mixed_body(11).spawn(&mut world);
    let new = mixed_body(77).spawn(&mut world);
    assert_eq!(rollback.rewind_to_step(0, &mut world, &mut simulation).unwrap(), [new]);
    world.despawn(new).unwrap();
    assert_eq!((hash(&world), simulation.steps(), simulation.time()), (start, 0, 0.0));
}

/// A save that fails leaves the others, and the next is as any.
#[test]
fn a_failed_save_is_not_kept() {
    let (mut world, mut simulation) = (mixed_bodies(32), simulation(Integrator::default()));
    let mut rollback = Rollback::new(3);
    for _ in 0..5 {
        step(&mut world, &mut simulation, &mut rollback);
    }
    let double = mixed_body(3).spawn(&mut world);
    assert_eq!(rollback.save(&world, &simulation), Err(SnapshotError::Duplicate { id: BodyId(3) }));
    assert_eq!(rollback.len(), 2);
    world.despawn(double).unwrap();
    rollback.save(&world, &simulation).unwrap();
    assert_eq!((rollback.len(), rollback.at_step(5).unwrap().state_hash()), (3, hash(&world)));
}

/// All buffers are counted; saving and rewinding in any pattern takes no more than it did once, and
/// that is what is stated.
#[test]
fn a_full_ring_takes_no_more_memory() {
    const BODIES: usize = 2000;
    let (mut world, mut simulation) = (mixed_bodies(BODIES), simulation(Integrator::default()));
    let mut rollback = Rollback::new(8);
    let round = |world: &mut World, simulation: &mut Simulation, rollback: &mut Rollback| {
        for back in [0, 7, 3, 1] {
            for _ in 0..9 {
                step(world, simulation, rollback);
            }
            rollback.rewind(back, world, simulation).unwrap();
        }
    };
    round(&mut world, &mut simulation, &mut rollback);
    let warm = rollback.memory();
    let a_body = if size_of::<Real>() == 4 { 64 } else { 112 };
    // 8 KB for what does not grow with the bodies: the snapshots themselves and where the rows of
    // each archetype are.
    assert!(warm <= 8 * (BODIES * a_body + 8192), "{warm} bytes");
    for _ in 0..5 {
        round(&mut world, &mut simulation, &mut rollback);
        assert_eq!(rollback.memory(), warm);
    }
    // Bodies that change places in memory need room to be matched, once.
    let flip = |world: &mut World| {
        let entities: Vec<Entity> = BodyOrder::of(world).entities().iter().step_by(10).copied().collect();
        for entity in entities {
            if world.remove_one::<char>(entity).is_err() {
                world.insert_one(entity, 'x').unwrap();
            }
        }
    };
    let mut memories = Vec::new();
    for _ in 0..6 {
        flip(&mut world);
        rollback.rewind(0, &mut world, &mut simulation).unwrap();
        round(&mut world, &mut simulation, &mut rollback);
        memories.push(rollback.memory());
    }
    assert_eq!(memories[2..], [memories[5]; 4], "{memories:?}");
}
