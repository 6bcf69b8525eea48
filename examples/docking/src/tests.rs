//! Promise: the game can be won with a player's keys, loses no momentum when two bodies become one, and plays the same again from a
//! snapshot.

use tumble::{BodyOrder, Totals, measure, state_hash};

use super::*;

/// Docks within this time or not at all [s].
const LIMIT: f64 = 240.0;

fn hash(game: &Game) -> u64 {
    state_hash(&game.world, &BodyOrder::of(&game.world))
}

fn totals(game: &Game) -> Totals {
    measure(&game.world, game.simulation.settings(), &BodyOrder::of(&game.world))
}

fn fuel(game: &Game) -> Real {
    game.world.query::<&Fuel>().iter().next().map_or(0.0, |fuel| fuel.0)
}

/// Flies one step after the other until they are docked or the time is over, and returns fuel and momenta before the last step.
fn fly(game: &mut Game) -> (Real, Totals) {
    let mut last = (fuel(game), totals(game));
    let dt = f64::from(game.simulation.settings().dt);
    while game.outcome != Outcome::Docked && game.simulation.time() < LIMIT {
        last = (fuel(game), totals(game));
        game.update(dt, pilot::fly);
    }
    last
}

#[test]
fn look() {
    for level in 0..3 {
        for seed in 0..20 {
            let mut game = Game::new(level, seed).unwrap();
            let (fuel, _) = fly(&mut game);
            println!("{level} {seed} {:?} {:.1} s, {fuel:.2} kg", game.outcome, game.simulation.time());
        }
    }
}
