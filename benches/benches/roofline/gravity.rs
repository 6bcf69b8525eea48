//! Gravity among bodies, against the operations that every pull takes.

use std::time::Instant;

use hecs::World;
use rayon::ThreadPool;
use tumble::math::Vec3;
use tumble::{BodyId, GravityMass, RigidBody, Settings, Shape, Simulation};
use tumble_benches::Rng;
use tumble_math::lane::{Lane, Vec3 as LaneVec3};

use crate::counted::{Counted, Operations, count};
use crate::machine::{Arithmetic, Effort};

/// The pull of one body on one, by the formula of `GravityMass`, and its addition to the sum.
fn pull<L: Lane>(x: LaneVec3<L>, other: LaneVec3<L>, mu: L, softening: [L; 2], sum: LaneVec3<L>) -> LaneVec3<L> {
    let away = other - x;
    let inverse = L::splat(1.0) / (away.dot(away) + (softening[0] + softening[1])).sqrt();
    sum + (away * inverse) * (mu * inverse * inverse)
}

/// What one pull takes.
pub(crate) fn operations() -> Operations {
    let (number, vector) = (Counted(1.0), LaneVec3::splat(Counted(2.0)));
    count(|| pull(LaneVec3::splat(number), vector, number, [number; 2], vector))
}

fn cloud(bodies: usize) -> Result<World, Box<dyn std::error::Error>> {
    let (mut world, mut rng) = (World::new(), Rng::new(7));
    for i in 0..bodies {
        let place = rng.vector(-100.0, 100.0);
        let body = RigidBody::new(Shape::Point).mass(1.0).id(BodyId(i as u64)).position(place).build()?;
        let body = body.spawn(&mut world);
        world.insert_one(body, GravityMass { mu: 1.0, softening: 0.1 })?;
    }
    Ok(world)
}

/// A row of the table: a whole step of a cloud, divided by its pulls.
pub(crate) fn print_row(
    bodies: usize,
    needed: Operations,
    rates: Arithmetic,
    pool: &ThreadPool,
    effort: Effort,
) -> Result<(), Box<dyn std::error::Error>> {
    let mut world = cloud(bodies)?;
    let mut simulation = Simulation::new(Settings::default().with_gravity(Vec3::ZERO).with_dt(1e-3))?;
    let mut step = || {
        let start = Instant::now();
        pool.install(|| simulation.step(&mut world));
        start.elapsed().as_secs_f64()
    };
    let once = step();
    let mut times: Vec<f64> = (0..(effort.block / once) as usize + effort.blocks as usize).map(|_| step()).collect();
    times.sort_by(f64::total_cmp);
    let pulls = (bodies * bodies) as f64;
    let (simple, slow) = (needed.simple / rates.simple * 1e9, needed.slow / rates.slow * 1e9);
    let taken = times[times.len() / 2] * 1e9 / pulls;
    let (rate, of_limit) = (1e3 / taken, 100.0 * simple.max(slow) / taken);
    println!("| {bodies} | {simple:.3} | {slow:.3} | {taken:.3} | {rate:.0} | {of_limit:.0} % |");
    Ok(())
}
