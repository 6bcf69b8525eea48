//! Two peers simulate the same game, each in its own world. The inputs of the other arrive two to
//! seven steps late and out of order: a peer plays on with a guess and, where it was wrong, rewinds
//! and takes the steps again. Both end in the same state to the bit.
//!
//! `cargo run --release --example rollback`

mod game;
mod peer;
mod play;
mod wire;

use std::process::ExitCode;

const STEPS: u64 = 600;

fn main() -> ExitCode {
    let outcome = match play::play(STEPS) {
        Ok(outcome) => outcome,
        Err(error) => {
            eprintln!("rollback: {error}");
            return ExitCode::FAILURE;
        }
    };
    println!(
        "{STEPS} steps of two ships, 200 rocks and their shots; inputs up to {} steps late",
        wire::Wire::LONGEST_DELAY
    );
    for (player, (hash, corrections)) in outcome.peers.iter().zip(&outcome.corrections).enumerate() {
        let peer::Corrections { rewinds, longest, steps_again, despawned, respawned, checks } = corrections;
        println!("peer {player}: went back {rewinds} times, up to {longest} steps, and took {steps_again} again;");
        println!(
            "        {despawned} shots taken back, {respawned} brought back, {checks} hashes of the other compared"
        );
        println!("        ends in {hash:#018x}");
    }
    println!("without a network:  {:#018x}", outcome.referee);
    if outcome.peers == [outcome.referee; 2] { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
