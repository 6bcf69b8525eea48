//! Simulations as most tests need them.

use hecs::World;
use tumble::math::{Real, Vec3};
use tumble::{BodyOrder, Integrator, Settings, Simulation, state_hash};

/// With one gravity everywhere, and a step \[s\] of one substep.
pub fn simulation(integrator: Integrator, gravity: Vec3, dt: Real) -> Simulation {
    let settings = Settings::default().with_gravity(gravity).with_dt(dt).with_integrator(integrator);
    Simulation::new(settings).expect("possible settings")
}

/// Without gravity.
pub fn weightless(integrator: Integrator, dt: Real) -> Simulation {
    simulation(integrator, Vec3::ZERO, dt)
}

/// Step by step, as a game does, and not many at once.
pub fn run(simulation: &mut Simulation, world: &mut World, steps: u32) {
    for _ in 0..steps {
        simulation.step(world);
    }
}

/// The hash of the state of all bodies there are now.
pub fn hash(world: &World) -> u64 {
    state_hash(world, &BodyOrder::of(world))
}
