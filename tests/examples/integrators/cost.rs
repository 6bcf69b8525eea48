//! The cost of an integrator, measured in nanoseconds per body and step.

use std::time::Instant;

use hecs::World;
use tumble::{Integrator, Settings, Simulation};
use tumble_tests::FreeBody;

/// How many copies of the body are stepped together.
const COPIES: u32 = 4096;
const STEPS: u32 = 50;
const ROUNDS: u32 = 5;

/// Nanoseconds per step of one body, when 4096 copies are stepped on one thread: the best of five
/// rounds of 50 steps.
pub(crate) fn nanoseconds_per_body_step(body: &FreeBody, integrator: Integrator, settings: Settings) -> f64 {
    let mut world = World::new();
    let Ok(copy) = body.rigid_body().build() else { return f64::NAN };
    for _ in 0..COPIES {
        copy.spawn(&mut world);
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let (Ok(mut simulation), Ok(pool)) = (Simulation::new(settings.with_integrator(integrator)), pool) else {
        return f64::NAN;
    };
    pool.install(|| {
        let mut best = f64::INFINITY;
        for _ in 0..ROUNDS {
            let start = Instant::now();
            for _ in 0..STEPS {
                simulation.step(&mut world);
            }
            best = best.min(start.elapsed().as_secs_f64());
        }
        best * 1e9 / f64::from(COPIES * STEPS)
    })
}
