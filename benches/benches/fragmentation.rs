//! What archetypes cost: 10 000 boxes in 1 to 256 of them, as the caller's own components spread
//! them.
//!
//! The boxes differ by up to eight components without data; neighbours are of different
//! archetypes. `cargo bench --bench fragmentation -- "1 thread"`.

mod setup;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use hecs::{Entity, World};
use tumble::{Settings, Simulation};
use tumble_benches::{OnDemand, label, pools, tumbling_boxes};

const BODIES: usize = 10_000;

/// A component of the caller's that says nothing but that it is there.
struct Marker<const N: u8>;

fn mark<const N: u8>(world: &mut World, entity: Entity, number: usize) {
    if number >> N & 1 == 1 {
        // The entity is there: it was just spawned.
        world.insert_one(entity, Marker::<N>).ok();
    }
}

/// The boxes in this many archetypes, a power of two up to 256: those of one archetype have the
/// markers of the bits of its number.
fn fragmented_boxes(archetypes: usize) -> World {
    let mut world = tumbling_boxes(BODIES);
    let boxes: Vec<Entity> = world.iter().map(|entity| entity.entity()).collect();
    let marks = [mark::<0>, mark::<1>, mark::<2>, mark::<3>, mark::<4>, mark::<5>, mark::<6>, mark::<7>];
    for (i, entity) in boxes.into_iter().enumerate() {
        marks.iter().for_each(|mark| mark(&mut world, entity, i % archetypes));
    }
    assert_eq!(world.archetypes().filter(|archetype| !archetype.is_empty()).count(), archetypes);
    world
}

fn fragmentation(criterion: &mut Criterion) {
    let pools = pools();
    let mut group = criterion.benchmark_group("archetypes");
    group.throughput(Throughput::Elements(BODIES as u64));
    for archetypes in [1, 4, 16, 64, 256] {
        let mut world = OnDemand::new(|| fragmented_boxes(archetypes));
        for pool in &pools {
            let Ok(mut simulation) = Simulation::new(Settings::default()) else { return };
            group.bench_function(BenchmarkId::new(label(pool), archetypes), |bencher| {
                let world = world.get();
                pool.install(|| bencher.iter(|| simulation.step(world)));
            });
        }
    }
}

criterion_group! {
    name = benches;
    config = setup::criterion();
    targets = fragmentation
}
criterion_main!(benches);
