//! The same scene in Rapier and in tumble, in one process: boxes without colliders that tumble and
//! fall, on one and on two threads.
//!
//! `cargo bench --bench peers --features peers`, with `-- 100000` for another number of boxes. Both
//! begin with the same masses, moments, poses and velocities, step by 1/60 s, and never sleep;
//! Rapier is built with its threads and its default vector code, keeps the gyroscopic term that it
//! has by default, and runs with its default of four solver iterations and with one. Blocks of
//! steps of both alternate, so that what else the machine does hits both; medians over the blocks
//! are printed. Before that, it is checked that both moved every body the same way.
//!
//! With `-- worlds` it is 4096 worlds of eight such boxes over 120 steps, a part of Rapier's on
//! each thread.
//!
//! Under `--features f64` tumble is in double precision and Rapier, a crate of single precision, is
//! not.

#![allow(
    clippy::unnecessary_cast,
    clippy::useless_conversion,
    reason = "Rapier is in single precision, Real in that of the build"
)]

use std::time::{Duration, Instant};

use hecs::World;
use rapier3d::prelude as rapier;
use rayon::ThreadPool;
use tumble::math::{PRECISION, Quat, Real, Vec3};
use tumble::{Batch, Inertia, Mass, Pose, Settings, Simulation, Trial, Velocity, simd_name};
use tumble_benches::{Arguments, in_pools_of_one, pool, tumbling_boxes};

const BODIES: usize = 10_000;
/// Whether or not `-- worlds` is given, this is what lists and filters call it.
const BOXES_NAME: &str = "peers/boxes";
const WORLDS_NAME: &str = "peers/worlds";
const ROUNDS: usize = 21;
/// Steps in a block: Rapier takes tens of times as long.
const STEPS: u32 = 200;
const RAPIER_STEPS: u32 = 10;
/// Steps after which the bodies are compared.
const COMPARED: u32 = 10;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments = Arguments::of_program();
    let number: Option<usize> = arguments.filters.iter().find_map(|filter| filter.parse().ok());
    if arguments.is_list {
        arguments.print_list(&[BOXES_NAME, WORLDS_NAME]);
        return Ok(());
    }
    if arguments.name("worlds") || arguments.name(WORLDS_NAME) {
        return worlds(arguments.is_test);
    }
    if number.is_none() && !arguments.select(BOXES_NAME) {
        return Ok(());
    }
    let (bodies, rounds) = if arguments.is_test { (100, 1) } else { (number.unwrap_or(BODIES), ROUNDS) };
    println!("{bodies} free boxes, dt 1/60 s, medians of {rounds} interleaved blocks, ns per body-step");
    println!("tumble: moser-veselov, {PRECISION}, {}; Rapier: f32, parallel\n", simd_name());
    println!(
        "| threads | Rapier's iterations | tumble | Rapier | Rapier / tumble | tumble, million body-steps a second |"
    );
    println!("|---|---|---|---|---|---|");
    for threads in [1, 2] {
        let pool = pool(threads);
        for iterations in [rapier::IntegrationParameters::default().num_solver_iterations, 1] {
            let [ours, theirs] = contest(bodies, rounds, iterations, threads, &pool)?;
            let (ratio, rate) = (theirs / ours, 1e3 / ours);
            println!("| {threads} | {iterations} | {ours:.2} | {theirs:.1} | {ratio:.1} | {rate:.1} |");
        }
    }
    Ok(())
}

/// Many small worlds: a batch of ours, and Rapier's with four iterations, interleaved.
fn worlds(is_test: bool) -> Result<(), Box<dyn std::error::Error>> {
    const BOXES: usize = 8;
    const STEPS: u32 = 120;
    let count = if is_test { 16 } else { 4096 };
    println!("{count} worlds of {BOXES} free boxes, {STEPS} steps, medians of 3, million body-steps a second\n");
    let rate = |time: Duration| (count * BOXES) as f64 * f64::from(STEPS) * 1e-6 / time.as_secs_f64();
    for threads in [1, 2] {
        let pool = pool(threads);
        let (mut ours, mut theirs) = (Vec::new(), Vec::new());
        for _ in 0..3 {
            let settings = Settings::default();
            let trials = (0..count).map(|_| Trial::new(settings, tumbling_boxes(BOXES)));
            let mut batch: Batch = trials.collect::<Result<_, _>>()?;
            let mut rapier: Vec<_> =
                batch.trials_mut().iter_mut().map(|trial| rapier_world(&mut trial.world, &settings)).collect();
            let start = Instant::now();
            pool.install(|| batch.step_many(STEPS));
            ours.push(rate(start.elapsed()));
            let start = Instant::now();
            in_pools_of_one(&mut rapier, threads, |world| (0..STEPS).for_each(|_| world.step()));
            theirs.push(rate(start.elapsed()));
        }
        let [ours, theirs] = [ours, theirs].map(median);
        println!("{threads} threads: tumble {ours:.1}, Rapier {theirs:.2}; ours is {:.0} times that", ours / theirs);
    }
    Ok(())
}

/// The median times of a body-step \[ns\], tumble's first.
fn contest(
    bodies: usize,
    rounds: usize,
    iterations: usize,
    threads: usize,
    pool: &ThreadPool,
) -> Result<[f64; 2], Box<dyn std::error::Error>> {
    let mut world = tumbling_boxes(bodies);
    let mut simulation = Simulation::new(Settings::default())?;
    let mut rapier = rapier_world(&mut world, simulation.settings());
    rapier.integration_parameters.num_solver_iterations = iterations;
    rapier.configure_thread_pool(threads)?;

    pool.install(|| simulation.step_many(&mut world, COMPARED));
    (0..COMPARED).for_each(|_| rapier.step());
    compare(&mut world, &rapier, simulation.settings());

    let (mut ours, mut theirs) = (Vec::new(), Vec::new());
    for _ in 0..rounds {
        ours.push(nanoseconds(STEPS, bodies, || pool.install(|| simulation.step(&mut world))));
        theirs.push(nanoseconds(RAPIER_STEPS, bodies, || rapier.step()));
    }
    Ok([ours, theirs].map(median))
}

/// What a body-step takes, over a block of steps.
fn nanoseconds(steps: u32, bodies: usize, mut step: impl FnMut()) -> f64 {
    let start = Instant::now();
    (0..steps).for_each(|_| step());
    start.elapsed().as_secs_f64() * 1e9 / (f64::from(steps) * bodies as f64)
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

fn vector(v: Vec3) -> rapier::Vector {
    let [x, y, z] = v.to_array().map(|x| x as f32);
    rapier::Vector::new(x, y, z)
}

/// The bodies of our world, in its order.
fn rapier_world(world: &mut World, settings: &Settings) -> rapier::PhysicsWorld {
    let mut theirs = rapier::PhysicsWorld::new();
    theirs.gravity = vector(settings.gravity);
    theirs.integration_parameters.dt = settings.dt as f32;
    for (pose, mass, inertia, velocity) in world.query_mut::<(&Pose, &Mass, &Inertia, &Velocity)>() {
        let moments = vector(inertia.moments());
        let properties = rapier::MassProperties::new(vector(Vec3::ZERO), mass.kilograms() as f32, moments);
        let [x, y, z, w] = pose.orientation.to_array().map(|x| x as f32);
        let orientation = rapier::Rotation::from_xyzw(x, y, z, w);
        let body = rapier::RigidBodyBuilder::dynamic()
            .pose(rapier::Pose::from_parts(vector(pose.position), orientation))
            .linvel(vector(velocity.linear))
            .angvel(vector(velocity.angular))
            .can_sleep(false)
            .additional_mass_properties(properties);
        theirs.insert_body(body);
    }
    theirs
}

/// # Panics
/// Where a body is not where Rapier's scheme of first order may have it: then one of the two did
/// not do the work that is measured.
fn compare(world: &mut World, rapier: &rapier::PhysicsWorld, settings: &Settings) {
    let (time, gravity) = (COMPARED as Real * settings.dt, settings.gravity.length());
    let substep = settings.dt / rapier.integration_parameters.num_solver_iterations as Real;
    let mut compared = 0;
    for ((pose, velocity), (_, body)) in world.query_mut::<(&Pose, &Velocity)>().into_iter().zip(rapier.bodies.iter()) {
        let [x, y, z] = body.translation().to_array().map(Real::from);
        let distance = (Vec3::new(x, y, z) - pose.position).length();
        // Velocity before position: it falls g t h/2 further than is right. What is left is
        // rounding, within 60 m of the origin.
        let allowed = 0.5 * gravity * time * substep * 1.01 + 60.0 * COMPARED as Real * 4.0 * Real::from(f32::EPSILON);
        assert!(distance <= allowed, "a body is {distance} m away from Rapier's, at most {allowed} m was expected");

        let [x, y, z, w] = body.rotation().to_array().map(Real::from);
        let angle = Quat::from_xyzw(x, y, z, w).angle_between(pose.orientation);
        // Each substep turns at a rate up to dw/dt h/2 off, |dw/dt| <= |w|^2/sqrt 3 (triangle
        // inequality); sqrt 3 is for |w| changing. glam's single-precision angle is good to 1e-3.
        let rate = velocity.angular.length();
        let allowed = 0.5 * time * substep * rate * rate + 2e-3;
        assert!(angle <= allowed, "a body is turned {angle} rad from Rapier's, at most {allowed} rad was expected");
        compared += 1;
    }
    assert_eq!((compared, rapier.bodies.len()), (world.len(), world.len() as usize), "a body is missing");
}
