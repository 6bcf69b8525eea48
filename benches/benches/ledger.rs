//! What the ledger costs: a step that no ledger is attached to, one whose work is booked, and one
//! whose ledger was taken away again.
//!
//! The first and the last are to cost the same; `cargo bench --bench ledger`. The group `totals`
//! has what it takes to sum up energy and momentum beside a step of the same bodies: as they were
//! spawned, and with numbers that scatter their order over memory.

mod setup;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use hecs::World;
use tumble::{BodyId, BodyOrder, Integrator, Ledger, Settings, Simulation, Totals};
use tumble_benches::{OnDemand, mixed_moving_bodies, pool, tumbling_boxes};

const BODIES: usize = 10_000;

/// What is done about a ledger before the steps that are measured.
type Prepare = fn(&mut World, &Simulation);

const PREPARATIONS: [(&str, Prepare); 3] = [
    ("off", |_, _| {}),
    ("attached", |world, simulation| drop(Ledger::attach(world, simulation))),
    ("detached", |world, simulation| Ledger::attach(world, simulation).detach(world)),
];

fn prepared_boxes(prepare: Prepare, simulation: &Simulation) -> World {
    let mut world = tumbling_boxes(BODIES);
    prepare(&mut world, simulation);
    world
}

fn ledger(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("ledger");
    group.throughput(Throughput::Elements(BODIES as u64));
    for integrator in Integrator::ALL {
        for (name, prepare) in PREPARATIONS {
            let Ok(mut simulation) = Simulation::new(Settings::default().with_integrator(integrator)) else { return };
            let mut prepared: Option<World> = None;
            group.bench_function(BenchmarkId::new(integrator.name(), name), |bencher| {
                let world = prepared.get_or_insert_with(|| prepared_boxes(prepare, &simulation));
                bencher.iter(|| simulation.step(world));
            });
        }
    }
}

/// Numbers the bodies so that neighbours in order are far apart in memory.
fn scattered(mut world: World) -> World {
    let entities: Vec<_> = world.query_mut::<hecs::Entity>().into_iter().collect();
    for (i, entity) in entities.into_iter().enumerate() {
        // The factor is odd, so that no number comes twice.
        let id = BodyId(u64::from((i as u32).wrapping_mul(0x9e37_79b1)));
        let inserted = world.insert_one(entity, id);
        debug_assert!(inserted.is_ok());
    }
    world
}

fn sums(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("totals");
    group.throughput(Throughput::Elements(BODIES as u64));
    type Scene = (&'static str, fn() -> World);
    let worlds: [Scene; 3] = [
        ("boxes", || tumbling_boxes(BODIES)),
        ("scattered-boxes", || scattered(tumbling_boxes(BODIES))),
        ("mixed", || mixed_moving_bodies(BODIES)),
    ];
    for (name, made) in worlds {
        let settings = Settings::default();
        let Ok(mut simulation) = Simulation::new(settings) else { return };
        let mut ordered = OnDemand::new(|| {
            let world = made();
            let order = BodyOrder::of(&world);
            (world, order)
        });
        for threads in [1, 2] {
            let pool = pool(threads);
            let label = format!("{name}/{threads}");
            group.bench_function(BenchmarkId::new("sums", &label), |bencher| {
                let (world, order) = &*ordered.get();
                pool.install(|| bencher.iter(|| Totals::of(world, &settings, order)));
            });
            group.bench_function(BenchmarkId::new("step", &label), |bencher| {
                let (world, _) = ordered.get();
                pool.install(|| bencher.iter(|| simulation.step(world)));
            });
        }
    }
}

criterion_group! {
    name = benches;
    config = setup::criterion();
    targets = ledger, sums
}
criterion_main!(benches);
