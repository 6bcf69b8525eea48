//! Promise: a heap that is let alone comes to rest.
//!
//! Why: friction that was extrapolated from substep to substep alternated in heaps and grew:
//! nothing lay still, and now and then a body was thrown off.

use crate::pile;

use tumble::math::Real;
use tumble::prelude::*;
use tumble_tests::run;

const PILES: u64 = 32;

/// Twenty seconds after the fall of sixty random bodies, with damping, the fastest of a pile moves
/// at less than a sixteenth of what gravity adds in one substep, in half of all piles: balls roll
/// as long as they find a way.
#[test]
fn piles_come_to_rest() {
    let settings = pile::settings();
    let substep = settings.dt / settings.contact_substeps as Real;
    let mut fastest: Vec<Real> = (0..PILES).map(|pile| speed_at_rest(pile, settings)).collect();
    fastest.sort_by(Real::total_cmp);
    println!("{fastest:?} m/s");
    assert!(fastest[PILES as usize / 2] < 9.81 * substep / 16.0, "{fastest:?} m/s");
}

/// The greatest speed of a body of a pile in the last of twenty seconds \[m/s\].
fn speed_at_rest(pile: u64, settings: Settings) -> Real {
    let mut world = pile::settling_scene(1911 + pile);
    let mut simulation = Simulation::new(settings).unwrap();
    run(&mut simulation, &mut world, 19 * 64);
    let mut fastest: Real = 0.0;
    for _ in 0..64 {
        simulation.step(&mut world);
        for velocity in world.query::<&Velocity>().iter() {
            fastest = fastest.max(velocity.linear.length());
        }
    }
    fastest
}
