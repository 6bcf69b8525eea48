//! Two peers over a slow network, and a referee who knows all inputs in time.

use tumble::{BodyOrder, Settings, Simulation, state_hash};

use crate::game::{self, script};
use crate::peer::{Corrections, Failure, Peer};
use crate::wire::Wire;

/// How a game ended.
#[derive(Debug)]
pub(crate) struct RunStatus {
    /// The hash of each peer's state.
    pub(crate) peers: [u64; 2],
    /// The hash of a run without a network.
    pub(crate) referee: u64,
    /// What it took each peer.
    pub(crate) corrections: [Corrections; 2],
}

/// Plays this many steps.
pub(crate) fn play(steps: u64) -> Result<RunStatus, Failure> {
    let mut peers = [Peer::new(0)?, Peer::new(1)?];
    // Each carries what the peer of its number gets.
    let mut wires = [Wire::default(), Wire::default()];
    for now in 0..steps + Wire::LONGEST_DELAY {
        for player in 0..2 {
            peers[player].hear(wires[player].receive(now))?;
            if now < steps {
                let message = peers[player].play(script(player, now))?;
                wires[1 - player].send(now, message);
            }
        }
    }
    let corrections = [0, 1].map(|player| peers[player].corrections);
    Ok(RunStatus { peers: peers.map(|peer| peer.hash()), referee: referee(steps)?, corrections })
}

fn referee(steps: u64) -> Result<u64, Failure> {
    let (mut world, mut simulation) = (game::start()?, Simulation::new(Settings::default())?);
    for step in 0..steps {
        game::step(&mut world, &mut simulation, &[script(0, step), script(1, step)])?;
    }
    Ok(state_hash(&world, &BodyOrder::of(&world)))
}
