//! Energy over a million steps of bodies that pull at each other.

use std::fmt::Write as _;

use hecs::{Entity, World};
use tumble::math::{Real, Vec3};
use tumble::{BodyId, BodyOrder, GravityMass, RigidBody, Settings, Shape, Simulation, Spring, Totals};
use tumble_record::{Plot, Scale, SeriesStyle};

use crate::{Failure, Findings};

const STEPS: u32 = 1_000_000;
const SAMPLES: u32 = 1000;

/// A chain of eight bars that hang together at their ends, slack and turning.
fn chain() -> Result<World, Failure> {
    let mut world = World::new();
    let mut last: Option<Entity> = None;
    for i in 0..8_u32 {
        let turn = if i % 2 == 0 { 0.5 } else { -0.3 };
        let bar = RigidBody::new(Shape::cuboid([0.5, 0.05, 0.1]))
            .without_collider()
            .density(100.0)
            .id(BodyId(i.into()))
            .position(Vec3::X * i as Real)
            .angular_velocity(Vec3::new(1.0, turn, 0.5))
            .build()?
            .spawn(&mut world);
        if let Some(last) = last.replace(bar) {
            let spring = Spring::between(last, bar).attached_at(Vec3::X * 0.5, Vec3::X * -0.5);
            world.spawn((spring.with_stiffness(1000.0),));
        }
    }
    Ok(world)
}

/// A sun with four planets.
fn planets() -> Result<World, Failure> {
    let mut world = World::new();
    for i in 0..5_u32 {
        let (mass, distance) = if i == 0 { (1.0, 0.0) } else { (1e-3, 1.5_f64.powi(i as i32 - 1)) };
        let speed = if i == 0 { 0.0 } else { (1.0 / distance).sqrt() };
        let angle = f64::from(i) * 2.4;
        let body = RigidBody::new(Shape::Point)
            .mass(mass)
            .id(BodyId(i.into()))
            .position(Vec3::new((distance * angle.cos()) as Real, (distance * angle.sin()) as Real, 0.0))
            .linear_velocity(Vec3::new((-speed * angle.sin()) as Real, (speed * angle.cos()) as Real, 0.0))
            .build()?
            .spawn(&mut world);
        world.insert_one(body, GravityMass::new(mass as Real))?;
    }
    Ok(world)
}

/// The relative change of kinetic and potential energy together, over time in thousands of steps,
/// relative to the kinetic energy at first.
fn changes(mut world: World, dt: Real) -> Result<Vec<(f64, f64)>, Failure> {
    let mut simulation = Simulation::new(Settings::default().with_gravity(Vec3::ZERO).with_dt(dt))?;
    let order = BodyOrder::of(&world);
    let first = Totals::of(&world, simulation.settings(), &order);
    let mut changes = Vec::new();
    for sample in 0..=SAMPLES {
        let now = Totals::of(&world, simulation.settings(), &order);
        let change = (now.energy() - first.energy()) / first.kinetic();
        changes.push((f64::from(sample * (STEPS / SAMPLES)) * 1e-3, change));
        simulation.step_many(&mut world, STEPS / SAMPLES);
    }
    Ok(changes)
}

pub(crate) fn find() -> Result<Findings, Failure> {
    let mut text = String::from("\nEnergy over a million steps, relative to the kinetic energy at first\n\n");
    text.push_str(
        "| system | largest change | mean of the first tenth | mean of the last tenth |\n|---|---|---|---|\n",
    );
    let mut plot = Plot::new("Energy over a million steps")
        .x_axis("thousand steps", Scale::Linear)
        .y_axis("change, relative to the kinetic energy at first", Scale::Linear);
    for (name, world, dt) in
        [("eight bars on springs", chain()?, 1.0 / 120.0), ("a sun and four planets", planets()?, 0.01)]
    {
        let changes = changes(world, dt)?;
        let largest = changes.iter().fold(0.0_f64, |most, (_, change)| most.max(change.abs()));
        let tenth = changes.len() / 10;
        let mean = |part: &[(f64, f64)]| part.iter().map(|(_, change)| change).sum::<f64>() / part.len() as f64;
        let (start, end) = (mean(&changes[..tenth]), mean(&changes[changes.len() - tenth..]));
        writeln!(text, "| {name} | {largest:.1e} | {start:.2e} | {end:.2e} |")?;
        plot = plot.series(name, SeriesStyle::Line, changes);
    }
    Ok((text, vec![("coupled-energy", plot)]))
}
