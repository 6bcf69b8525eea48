//! How far the engine is from bodies that are nothing but `Vec`s: the same boxes under gravity on
//! one thread, with velocities and inverse inertias written.
//!
//! `world or Vecs` measures the ECS alone: the engine's own step with each integrator, over the
//! columns of a hecs world and over `Vec`s of the same components. `reference` measures kernel and
//! layout: a step of semi-implicit Euler by the engine in a world, and over plain vectors by hand.
//!
//! The yardstick has each number in a column of its own, knows every body to have the same
//! components, and has nothing for very fast or very light bodies; its vector code is another
//! library's. Both do the same work, which is checked before anything is measured.
//!
//! `cargo bench --bench reference -- /10000`.

mod lanes;
mod plain_vectors;
mod setup;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use hecs::World;
use tumble::math::Real;
use tumble::{
    BodySlices, Inertia, Integrator, InverseInertia, Mass, Momentum, Pose, Settings, Simulation, Velocity, Wrench,
};
use tumble_benches::{OnDemand, pool, tumbling_boxes};

use crate::plain_vectors::PlainVectors;

/// Steps after which both are to be at the same place.
const COMPARED: u32 = 20;

/// Boxes in a world and in plain vectors, after steps that moved both alike.
///
/// # Panics
/// Where the yardstick does not move the bodies as the engine does; what it takes would mean
/// nothing.
fn compared(simulation: &mut Simulation, size: usize) -> (World, PlainVectors) {
    let mut world = tumbling_boxes(size);
    let mut plain = PlainVectors::of(&mut world);
    check_the_same_work(simulation, &mut world, &mut plain);
    (world, plain)
}

fn check_the_same_work(simulation: &mut Simulation, world: &mut World, plain: &mut PlainVectors) {
    let settings = *simulation.settings();
    for _ in 0..COMPARED {
        simulation.step(world);
        plain.step(settings.dt, settings.gravity);
    }
    // The two round in different orders, a few roundings a step of numbers up to 50, and the scheme
    // at worst doubles a difference within this number of steps.
    let apart = 50.0 * COMPARED as Real * 8.0 * Real::EPSILON;
    let mut compared = 0;
    let bodies = world.query_mut::<(&Pose, &Momentum, &Inertia, &Velocity, &InverseInertia)>();
    for ((pose, momentum, inertia, velocity, tensor), plain) in bodies.into_iter().zip(plain.outcomes()) {
        agree(&pose.position.to_array(), &plain.position, apart);
        agree(&pose.orientation.to_array(), &plain.orientation, apart);
        agree(&velocity.linear.to_array(), &plain.velocity, apart);
        // A quaternion that is so far apart is an angle of twice as much, on either side of the
        // inverse moments.
        let apart = 4.0 * apart * inertia.inverse_moments().max_element();
        agree(&velocity.angular.to_array(), &plain.angular_velocity, apart * momentum.angular.length());
        agree(&[tensor.diagonal.to_array(), tensor.off_diagonal.to_array()].concat(), &plain.inverse_inertia, apart);
        compared += 1;
    }
    assert_eq!(compared, world.len(), "not all bodies were compared");
}

fn agree(ours: &[Real], theirs: &[Real], apart: Real) {
    for (a, b) in ours.iter().zip(theirs) {
        assert!((a - b).abs() <= apart, "the yardstick has {b} and not {a}, more than {apart} apart");
    }
}

fn reference(criterion: &mut Criterion) {
    let one_thread = pool(1);
    let mut group = criterion.benchmark_group("reference");
    for size in [1_000, 10_000, 100_000, 1_000_000] {
        let settings = Settings::default().with_integrator(Integrator::SemiImplicitEuler);
        let Ok(mut simulation) = Simulation::new(settings) else { return };
        let mut both: Option<(World, PlainVectors)> = None;
        group.throughput(Throughput::Elements(size as u64));
        group.bench_function(BenchmarkId::new("engine in a world", size), |bencher| {
            let (world, _) = both.get_or_insert_with(|| compared(&mut simulation, size));
            one_thread.install(|| bencher.iter(|| simulation.step(world)));
        });
        group.bench_function(BenchmarkId::new("plain Vecs by hand", size), |bencher| {
            let (_, plain) = both.get_or_insert_with(|| compared(&mut simulation, size));
            bencher.iter(|| plain.step(settings.dt, settings.gravity));
        });
    }
}

/// The components of boxes in `Vec`s.
struct Vecs {
    poses: Vec<Pose>,
    momenta: Vec<Momentum>,
    wrenches: Vec<Wrench>,
    masses: Vec<Mass>,
    inertias: Vec<Inertia>,
    velocities: Vec<Velocity>,
    inverse_inertias: Vec<InverseInertia>,
}

impl Vecs {
    fn of(world: &mut World) -> Self {
        fn column<T: hecs::Component + Copy>(world: &mut World) -> Vec<T> {
            world.query_mut::<&T>().into_iter().copied().collect()
        }
        Self {
            poses: column(world),
            momenta: column(world),
            wrenches: column(world),
            masses: column(world),
            inertias: column(world),
            velocities: column(world),
            inverse_inertias: column(world),
        }
    }

    /// # Panics
    /// Where the columns are not of the same length.
    fn step(&mut self, settings: &Settings) {
        let mut bodies = BodySlices::new(&mut self.poses, &mut self.momenta, &mut self.wrenches, &self.masses);
        bodies.inertia = Some(&self.inertias);
        bodies.velocity = Some(&mut self.velocities);
        bodies.inverse_inertia = Some(&mut self.inverse_inertias);
        assert_eq!(bodies.step(settings), Ok(()));
    }
}

fn world_or_vecs(criterion: &mut Criterion) {
    let one_thread = pool(1);
    let mut group = criterion.benchmark_group("world or Vecs");
    for integrator in [Integrator::SemiImplicitEuler, Integrator::MoserVeselov] {
        for size in [1_000, 10_000, 100_000, 1_000_000] {
            let settings = Settings::default().with_integrator(integrator);
            let Ok(mut simulation) = Simulation::new(settings) else { return };
            let mut world = OnDemand::new(|| tumbling_boxes(size));
            let mut vecs = OnDemand::new(|| Vecs::of(&mut tumbling_boxes(size)));
            group.throughput(Throughput::Elements(size as u64));
            group.bench_function(BenchmarkId::new(format!("{integrator} in a world"), size), |bencher| {
                let world = world.get();
                one_thread.install(|| bencher.iter(|| simulation.step(world)));
            });
            group.bench_function(BenchmarkId::new(format!("{integrator} in Vecs"), size), |bencher| {
                let vecs = vecs.get();
                one_thread.install(|| bencher.iter(|| vecs.step(&settings)));
            });
        }
    }
}

criterion_group! {
    name = benches;
    config = setup::criterion();
    targets = world_or_vecs, reference
}
criterion_main!(benches);
