//! Simulations as most tests need them.

use hecs::World;
use tumble::math::{Real, Vec3};
use tumble::{BodyOrder, Integrator, Settings, Simulation, state_hash};

use crate::comparison::real;
use crate::draw::Draw;

/// With one gravity everywhere, and a step \[s\] of one substep.
pub fn simulation(integrator: Integrator, gravity: Vec3, dt: Real) -> Simulation {
    let settings = Settings::default().with_gravity(gravity).with_dt(dt).with_integrator(integrator);
    Simulation::new(settings).expect("possible settings")
}

/// Without gravity.
pub fn weightless(integrator: Integrator, dt: Real) -> Simulation {
    simulation(integrator, Vec3::ZERO, dt)
}

/// Of 60 to 240 steps a second, with a number of contact substeps in this range.
pub fn settings_at_random(draw: &mut Draw, [least, most]: [f64; 2]) -> Settings {
    let rate = draw.log_between(60.0, 240.0);
    let substeps = draw.log_between(least, most).round();
    Settings::default().with_dt(real(1.0 / rate)).with_contact_substeps(substeps as u32)
}

/// Step by step, as a game does, and not many at once.
pub fn run(simulation: &mut Simulation, world: &mut World, steps: u32) {
    for _ in 0..steps {
        simulation.step(world);
    }
}

/// How far an energy has risen above the least that it had been \[J\].
pub struct Rise {
    least: f64,
    most: f64,
}

impl Rise {
    /// From this energy on.
    pub fn from(energy: f64) -> Self {
        Self { least: energy, most: 0.0 }
    }

    /// The energy is this now.
    pub fn note(&mut self, energy: f64) {
        self.most = self.most.max(energy - self.least);
        self.least = self.least.min(energy);
    }

    /// The highest rise.
    pub fn most(&self) -> f64 {
        self.most
    }
}

/// The hash of the state of all bodies there are now.
pub fn hash(world: &World) -> u64 {
    state_hash(world, &BodyOrder::of(world))
}
