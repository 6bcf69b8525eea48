//! What joints cost: chains, pendulums, nets, a rope bridge, an arm with drives and limits, such
//! arms in a batch, and a heap of ragdolls. A step of 1/60 s in four substeps.
//!
//! `cargo bench --bench joints`; with `--features peers` the same scenes are run in Rapier in the
//! same process: its impulse joints with its default of four iterations, and where there are no
//! loops and not too many bodies its multibody joints. `1 thread` is a pool of one thread, `as
//! called` is from a thread that is in no pool, as a game calls, with each engine's own choice of
//! threads. What joints are worth beside their time is printed by
//! `cargo run --release -p tumble-benches --features peers --example joint_quality`.
//!
//! Under `--features f64` tumble is in double precision and Rapier, a crate of single precision, is
//! not.

#![allow(clippy::expect_used, reason = "a bench without what it measures is to fail")]

mod setup;

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, BenchmarkId, Criterion, SamplingMode, Throughput, criterion_group, criterion_main};
use hecs::World;
use rayon::ThreadPool;
use tumble::{Batch, Joint, Settings, Trial};
use tumble_benches::{JointKind, OnDemand, arm, bridge, chain, label, net, pendulums, pool, pools, ragdolls};
#[cfg(feature = "peers")]
use tumble_benches::{RapierJoints, RapierWorld};

/// The size of a scene, and how many joints it has.
struct Size(usize, usize);

/// The same scene in both engines; `with_multibody` where Rapier's take less than a second a step.
#[cfg_attr(not(feature = "peers"), allow(unused_variables, reason = "there is no other engine"))]
fn scene(
    group: &mut BenchmarkGroup<'_, WallTime>,
    Size(size, joints): Size,
    with_multibody: bool,
    made: impl Fn() -> World,
) {
    let pool = pool(1);
    let made = || {
        let world = made();
        assert_eq!(world.query::<&Joint>().iter().count(), joints, "the throughput is in joints");
        world
    };
    group.throughput(Throughput::Elements(joints as u64));
    for pool in [Some(&pool), None] {
        let ours = || Trial::new(Settings::default(), made()).expect("a possible world");
        run(group, "tumble", size, pool, ours, |trial| trial.simulation.step(&mut trial.world));
        #[cfg(feature = "peers")]
        for (name, joints) in [("Rapier", RapierJoints::Impulse), ("Rapier multibody", RapierJoints::Multibody)] {
            if joints == RapierJoints::Multibody && !with_multibody {
                continue;
            }
            let theirs = || RapierWorld::new(&made(), &Settings::default(), joints).expect("joints that Rapier has");
            run(group, name, size, pool, theirs, RapierWorld::step);
        }
    }
}

/// Steps in a pool, or as a game calls.
fn run<S: Send>(
    group: &mut BenchmarkGroup<'_, WallTime>,
    name: &str,
    size: usize,
    pool: Option<&ThreadPool>,
    make: impl Fn() -> S,
    step: fn(&mut S),
) {
    let threads = pool.map_or_else(|| "as called".to_owned(), label);
    let mut made = OnDemand::new(make);
    group.bench_function(BenchmarkId::new(format!("{name}/{threads}"), size), |bencher| {
        let state = made.get();
        match pool {
            Some(pool) => pool.install(|| bencher.iter(|| step(state))),
            None => bencher.iter(|| step(state)),
        }
    });
}

/// An element is a joint.
fn chains(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("chain of balls");
    for links in [100, 1_000, 10_000] {
        scene(&mut group, Size(links, links), links == 100, || chain(links, JointKind::Ball));
    }
    group.finish();
    let mut group = criterion.benchmark_group("chain of hinges");
    scene(&mut group, Size(100, 100), true, || chain(100, JointKind::Hinge));
}

/// Each of ten links.
fn many_pendulums(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("pendulums");
    scene(&mut group, Size(300, 3000), true, || pendulums(300));
}

/// Of planks between two fixed ends.
fn bridges(criterion: &mut Criterion) {
    for (name, kind, joints) in [("bridge on balls", JointKind::Ball, 102), ("bridge on hinges", JointKind::Hinge, 51)]
    {
        let mut group = criterion.benchmark_group(name);
        scene(&mut group, Size(50, joints), false, || bridge(50, kind));
    }
}

/// Of balls joined to their neighbours, as many to a side.
fn nets(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("net of balls");
    group.sampling_mode(SamplingMode::Flat);
    scene(&mut group, Size(30, 2 * 30 * 29), false, || net(30));
}

/// Hinges with a drive and limits each.
fn arms(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("arm with drives and limits");
    scene(&mut group, Size(10, 10), true, || arm(10));
}

/// Arms of seven links in worlds of their own; an element is a substep of one.
fn arms_in_a_batch(criterion: &mut Criterion) {
    const ARMS: u64 = 4096;
    let settings = Settings::default();
    let mut made = OnDemand::new(|| -> Batch {
        (0..ARMS).map(|_| Trial::new(settings, arm(7)).expect("a possible world")).collect()
    });
    let mut group = criterion.benchmark_group("arms of seven hinges in a batch");
    group.sampling_mode(SamplingMode::Flat);
    group.throughput(Throughput::Elements(ARMS * u64::from(settings.contact_substeps)));
    for pool in pools() {
        let id = BenchmarkId::new(label(&pool), ARMS);
        group.bench_function(id, |bencher| {
            let batch = made.get();
            pool.install(|| bencher.iter(|| batch.step_many(1)));
        });
    }
}

/// As they fall and land: a step is one of the first seconds.
fn heaps(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("heap of ragdolls");
    group.sampling_mode(SamplingMode::Flat);
    scene(&mut group, Size(160, 160 * 22), false, || ragdolls(160));
}

criterion_group! {
    name = benches;
    config = setup::criterion();
    targets = chains, many_pendulums, bridges, nets, arms, arms_in_a_batch, heaps
}
criterion_main!(benches);
