//! Bodies that get and lose components while a world runs.

use hecs::{Entity, World};
use tumble::Simulation;

/// Takes steps, before each of which some bodies change their archetype.
pub(crate) fn run_changing_archetypes(simulation: &mut Simulation, world: &mut World, steps: u32) {
    struct Blue;
    struct Heavy;
    let all: Vec<Entity> = world.query::<Entity>().iter().collect();
    for step in 0..steps as usize {
        for (i, &entity) in all.iter().enumerate() {
            if (i * 7 + step) % 30 == 0 {
                world.insert(entity, (Blue, Heavy)).unwrap();
            } else if (i + step) % 20 == 0 {
                let _ = world.remove_one::<Blue>(entity);
            }
        }
        simulation.step(world);
    }
}
