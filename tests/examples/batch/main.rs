//! How thick must a coin be to land on its edge as often as on either face? Hundreds of coins of
//! each thickness are tossed on the ground, each in a world of its own that ends when its coin lies
//! still.
//!
//! `cargo run --release --example batch`

use std::error::Error;
use std::ops::ControlFlow;
use std::process::ExitCode;

use tumble::hecs::World;
use tumble::prelude::*;
use tumble::{Batch, ColliderError, Rng, Trial};

const COINS: usize = 500;
const SEED: u64 = 5;
const RADIUS: f64 = 0.5;
/// Where the middle of a coin that lies still is at the most \[m\].
const LYING: Real = 0.75;

type Failure = Box<dyn Error + Send + Sync>;

#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
    Heads,
    Tails,
    Edge,
}

fn main() -> ExitCode {
    println!("{COINS} coins of each thickness\n\nthickness over diameter   heads   tails   edge   not yet at rest");
    for tenths in [1_u8, 3, 5, 6, 7, 8, 10] {
        let ratio = f64::from(tenths) / 10.0;
        match toss(ratio) {
            Ok(landed) => {
                let count = |side| landed.iter().filter(|it| **it == side).count();
                let [heads, tails, edge] = [Side::Heads, Side::Tails, Side::Edge].map(|side| count(Some(side)));
                println!("{ratio:>23.1} {heads:>7} {tails:>7} {edge:>6} {:>17}", count(None));
            }
            Err(error) => {
                eprintln!("batch: {error}");
                return ExitCode::FAILURE;
            }
        }
    }
    ExitCode::SUCCESS
}

/// On which side coins land, as thick as this part of their diameter; none for those that still
/// move after a minute.
fn toss(ratio: f64) -> Result<Vec<Option<Side>>, Failure> {
    let mut batch = Batch::from_seed(COINS, SEED, |_, rng| -> Result<Trial, Failure> {
        Ok(Trial::new(Settings::default(), table(ratio, rng)?)?)
    })?;
    // Tested every tenth of a second.
    let ends = batch.run(3600, 6, |_, trial| match resting_side(&mut trial.world) {
        Some(side) => ControlFlow::Break(side),
        None => ControlFlow::Continue(()),
    });
    Ok(ends.into_iter().map(ControlFlow::break_value).collect())
}

/// Ground, and a coin a few metres above it that spins about any axis.
fn table(ratio: f64, mut rng: Rng) -> Result<World, Failure> {
    let mut world = World::new();
    // A table of wood, which takes a part of the speed that the coin comes with.
    let wood = |collider: Collider| -> Result<Collider, ColliderError> {
        collider.with_material(Material { rolling_resistance: 0.02, ..Material::new(0.4, 0.3) })
    };
    RigidBody::new(Shape::Point).fixed().build()?.spawn_with(&mut world, (wood(Collider::half_space())?,));
    let coin = Shape::cylinder(RADIUS, RADIUS * ratio);
    RigidBody::new(coin.clone())
        .mass(1.0)
        .position(Vec3::Y * rng.range(3.0, 5.0))
        .orientation(rng.orientation())
        .linear_velocity(rng.vector(-1.0, 1.0))
        .angular_velocity(rng.vector(-10.0, 10.0))
        .build()?
        .spawn_with(&mut world, (wood(Collider::new(&coin)?)?,));
    Ok(world)
}

/// The side that the coin of a world lies on, if it lies still.
fn resting_side(world: &mut World) -> Option<Side> {
    let coins = world.query_mut::<(&Pose, &Velocity, &Momentum)>();
    let (pose, velocity, _) = coins.into_iter().next()?;
    let is_still = velocity.linear.length() < 0.02 && velocity.angular.length() < 0.05;
    // At the top of a bounce it is still for a moment too, but higher.
    if !is_still || pose.position.y > LYING {
        return None;
    }
    let upwards = (pose.orientation * Vec3::Y).y;
    match upwards {
        up if up > 0.95 => Some(Side::Heads),
        up if up < -0.95 => Some(Side::Tails),
        up if up.abs() < 0.05 => Some(Side::Edge),
        _ => None,
    }
}
