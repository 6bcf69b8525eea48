//! Promise: worlds in which bodies touch can be put in a batch in any mixture, and each gets the
//! state, the contacts, the events and the snapshot that it gets alone.
//!
//! Why: small worlds are pushed together there, contacts of several in one vector. It fails if a
//! row, a colour, an impulse or a setting of one world gets into another, or if what a world
//! carries on to its next step is left in what was shared.

use hecs::World;
use tumble::math::Vec3;
use tumble::prelude::*;
use tumble::{Batch, Integrator, Ledger, Spring, Trial};
use tumble_benches::{eight_boxes, pool, tumbling_boxes};

use crate::pile;

/// Nine packs on one thread or two, of which the first seven are of one kind each but for every
/// fourth world, and a part of another.
const WORLDS: u64 = 150;

/// Worlds of seven kinds, in runs that can be pushed together and with others between them.
fn trial(index: u64) -> Trial {
    let settings = Settings::default();
    let boxes = || eight_boxes(index);
    let kind = if index % 4 == 3 { index } else { index / 16 };
    let (settings, mut world) = match kind % 7 {
        0 | 1 => (settings, boxes()),
        2 => (settings.with_dt(1.0 / 120.0), boxes()),
        3 => (settings.with_gravity(Vec3::Y * -1.6).with_integrator(Integrator::RungeKutta4), boxes()),
        4 => (settings, tumbling_boxes(5)),
        // What bounces, rolls badly, is damped, off its centre, and a paddle.
        5 => (settings, pile::scene(&pile::identities()[..20 + index as usize % 12])),
        _ => (settings.with_substeps(2), boxes()),
    };
    if index % 9 == 8 {
        let bodies: Vec<_> = tumble::BodyOrder::moving(&world).entities().to_vec();
        world.spawn((Spring::between(bodies[0], bodies[1]).with_stiffness(20.0),));
    }
    if index == 11 {
        world = World::new();
    }
    let mut trial = Trial::new(settings, world).unwrap();
    if index % 5 == 4 {
        Ledger::attach(&mut trial.world, &trial.simulation);
    }
    trial
}

/// All that can be known of a world.
fn known(trial: &Trial) -> (u64, u64, String, Vec<u8>) {
    let Trial { simulation, world } = trial;
    let contacts: Vec<_> = simulation.contacts().collect();
    let events: Vec<_> = simulation.contact_events().collect();
    // Worlds of boxes without identity have no snapshot.
    let snapshot = simulation.snapshot(world).map_or(Vec::new(), |snapshot| snapshot.to_bytes());
    (trial.state_hash(), simulation.steps(), format!("{contacts:?} {events:?}"), snapshot)
}

#[test]
fn each_world_is_as_it_is_alone() {
    for threads in [1, 2] {
        let mut batch: Batch = (0..WORLDS).map(trial).collect();
        let mut alone: Vec<Trial> = (0..WORLDS).map(trial).collect();
        for steps in [1, 30, 1, 40] {
            pool(threads).install(|| batch.step_many(steps));
            for (index, (together, alone)) in batch.trials().iter().zip(&mut alone).enumerate() {
                alone.step_many(steps);
                assert_eq!(known(together), known(alone), "world {index}, {threads} threads");
            }
        }
        let touching = |trial: &Trial| trial.simulation.contacts().filter(tumble::Contact::touches).count();
        assert!(batch.trials().iter().filter(|trial| touching(trial) > 6).count() > 90);
    }
}

/// What is changed between the steps is changed in its own world, and goes on: a body that goes,
/// one that comes, other settings.
/// What counts as an impact follows from gravity where steps are long.
#[test]
fn worlds_of_different_gravity_are_as_they_are_alone() {
    let trial = |index: u64| {
        let gravity = Vec3::Y * -(1.0 + 6.0 * index as tumble::math::Real);
        let settings = Settings::default().with_dt(1.0 / 20.0).with_gravity(gravity);
        Trial::new(settings, eight_boxes(index)).unwrap()
    };
    let mut batch: Batch = (0..16).map(trial).collect();
    let mut alone: Vec<Trial> = (0..16).map(trial).collect();
    for step in 0..60 {
        batch.step_many(1);
        for (index, (together, alone)) in batch.trials().iter().zip(&mut alone).enumerate() {
            alone.step_many(1);
            assert_eq!(known(together), known(alone), "world {index}, step {step}");
        }
    }
}

#[test]
fn worlds_may_change_between_steps() {
    let mut batch: Batch = (0..20).map(|index| trial(4 * index)).collect();
    let mut alone: Vec<Trial> = (0..20).map(|index| trial(4 * index)).collect();
    let change = |round: usize, index: usize, trial: &mut Trial| {
        let bodies: Vec<_> = tumble::BodyOrder::moving(&trial.world).entities().to_vec();
        match (index + round) % 4 {
            0 if bodies.len() > 1 => trial.world.despawn(bodies[index % bodies.len()]).unwrap(),
            1 => {
                let settings = trial.simulation.settings().with_contact_substeps(2 + round as u32);
                trial.simulation.set_settings(settings).unwrap();
            }
            2 if !bodies.is_empty() => {
                trial.world.get::<&mut Momentum>(bodies[0]).unwrap().apply_impulse(Vec3::new(1.0, 4.0, -2.0));
            }
            _ => {}
        }
    };
    for round in 0..5 {
        pool(2).install(|| batch.step_many(25));
        for (index, (together, alone)) in batch.trials_mut().iter_mut().zip(&mut alone).enumerate() {
            alone.step_many(25);
            assert_eq!(known(together), known(alone), "world {index}, round {round}");
            change(round, index, together);
            change(round, index, alone);
        }
    }
}
