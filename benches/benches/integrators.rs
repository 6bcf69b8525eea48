//! What each integrator costs: 10 000 boxes under gravity on one thread, with one and with eight
//! substeps a step.
//!
//! Substeps that nothing couples run in registers, so that seven eighths of what eight of them cost
//! above one is a substep without memory. The throughput is in bodies stepped a second;
//! `--features f64` measures double precision.
//!
//! Beside each time stands what it buys: how far off a second of the same motion is, in energy and
//! in attitude, over a hundred of the boxes. Energy of rotation is to stay what it was; attitude is
//! compared with sixteen substeps of the sixth-order map, so that less than rounding in those is
//! not seen.
//!
//! `cargo bench --bench integrators -- moser-veselov`.

#![cfg_attr(feature = "f64", allow(clippy::useless_conversion, reason = "Real is f64 in this build, f32 in the other"))]

mod setup;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use tumble::glam::DQuat;
use tumble::{BodyOrder, Integrator, Pose, Settings, Simulation, Totals};
use tumble_benches::{OnDemand, pool, tumbling_boxes};

const BODIES: usize = 10_000;
/// Bodies whose error is found out.
const SAMPLE: usize = 100;
/// A second at the default step.
const STEPS: u32 = 60;
const REFERENCE_SUBSTEPS: u32 = 16;

/// Energy of rotation \[J\] and orientation of each body after some steps.
fn after(settings: Settings, steps: u32) -> Option<Vec<(f64, DQuat)>> {
    let mut world = tumbling_boxes(SAMPLE);
    Simulation::new(settings).ok()?.step_many(&mut world, steps);
    let order = BodyOrder::of(&world);
    let bodies = order.entities().iter().map(|entity| {
        let energy = Totals::of_body(world.entity(*entity).ok()?, &settings).rotational_kinetic;
        let [x, y, z, w] = world.get::<&Pose>(*entity).ok()?.orientation.to_array().map(f64::from);
        Some((energy, DQuat::from_xyzw(x, y, z, w).normalize()))
    });
    bodies.collect()
}

/// Root mean squares of the relative error of energy and of the angle \[rad\] that attitudes are
/// off by.
fn errors(settings: Settings) -> Option<[f64; 2]> {
    let exact = settings.with_integrator(Integrator::MoserVeselov).with_substeps(REFERENCE_SUBSTEPS);
    let (start, exact, found) = (after(settings, 0)?, after(exact, STEPS)?, after(settings, STEPS)?);
    let mut squares = [0.0; 2];
    for (((start, _), (_, exact)), (energy, attitude)) in start.into_iter().zip(exact).zip(found) {
        let between = exact.inverse() * attitude;
        squares[0] += (energy / start - 1.0).powi(2);
        squares[1] += (2.0 * between.xyz().length().min(1.0).asin()).powi(2);
    }
    Some(squares.map(|sum| (sum / SAMPLE as f64).sqrt()))
}

fn print_errors(settings: Settings) {
    if let Some([energy, attitude]) = errors(settings) {
        let name = format!("{}/substeps/{}", settings.integrator, settings.substeps);
        println!("{name:<32} error after 1 s: energy {energy:.1e}, attitude {attitude:.1e} rad");
    }
}

fn integrators(criterion: &mut Criterion) {
    let one_thread = pool(1);
    let mut world = OnDemand::new(|| tumbling_boxes(BODIES));
    for integrator in Integrator::ALL {
        let mut group = criterion.benchmark_group(integrator.name());
        group.throughput(Throughput::Elements(BODIES as u64));
        for substeps in [1, 8] {
            let settings = Settings::default().with_substeps(substeps).with_integrator(integrator);
            let Ok(mut simulation) = Simulation::new(settings) else { return };
            let mut errors = OnDemand::new(|| print_errors(settings));
            group.bench_function(BenchmarkId::new("substeps", substeps), |bencher| {
                errors.get();
                let world = world.get();
                one_thread.install(|| bencher.iter(|| simulation.step(world)));
            });
        }
    }
}

criterion_group! {
    name = benches;
    config = setup::criterion();
    targets = integrators
}
criterion_main!(benches);
