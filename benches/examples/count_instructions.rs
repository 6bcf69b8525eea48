//! Steps 4096 boxes with one integrator, for counting instructions:
//!
//! `valgrind --tool=callgrind target/release/examples/count_instructions moser-veselov 30`, then the same with 10: the difference
//! divided by 20 x 4096 is what a body costs a step.

use tumble::{Integrator, Settings, Simulation};
use tumble_benches::tumbling_boxes;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let integrator: Integrator = arguments.next().as_deref().unwrap_or("moser-veselov").parse()?;
    let steps: u32 = arguments.next().as_deref().unwrap_or("10").parse()?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let mut world = tumbling_boxes(4096);
    let mut simulation = Simulation::new(Settings::default().with_integrator(integrator))?;
    pool.install(|| {
        for _ in 0..steps {
            simulation.step(&mut world);
        }
    });
    Ok(())
}
