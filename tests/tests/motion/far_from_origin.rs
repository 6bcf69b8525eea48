//! Promise: how much of a slow motion single precision loses far from the origin is what the table
//! in `docs/scenes.md` says, and double precision loses nothing that could be seen.
//!
//! Why: a position is rounded to the grid of its floats in every step, always the same way for a
//! steady motion, so the loss does not average out: a kilometre out a body at 1 cm/s goes a quarter
//! less far, and one at 1 mm/s does not move. It would fail if positions were advanced in more or
//! smaller pieces than a step, which lose more, or if the table were of another machine's or
//! another version's figures.

use hecs::World;
use tumble::math::{Real, Vec3};
use tumble::{Integrator, Pose, RigidBody, Shape};
use tumble_tests::{DOUBLE, weightless};

const DT: f64 = 1.0 / 60.0;
const INTEGRATORS: [Integrator; 3] = [Integrator::SemiImplicitEuler, Integrator::RungeKutta4, Integrator::MoserVeselov];

/// How far a free body gets that starts at a distance and goes on away from the origin \[m\].
fn way(integrator: Integrator, distance: f64, speed: f64, steps: u32) -> f64 {
    let mut world = World::new();
    let body = RigidBody::new(Shape::sphere(0.5))
        .without_collider()
        .mass(1.0)
        .position(Vec3::X * distance as Real)
        .linear_velocity(Vec3::X * speed as Real)
        .build()
        .unwrap()
        .spawn(&mut world);
    let start = f64::from(world.get::<&Pose>(body).unwrap().position.x);
    weightless(integrator, DT as Real).step_many(&mut world, steps);
    let end = f64::from(world.get::<&Pose>(body).unwrap().position.x);
    end - start
}

/// Half of what a float of this size and the next differ by, at 60 steps a second: slower than this
/// nothing moves \[m/s\].
fn slowest(distance: f64) -> f64 {
    let grid = f64::from((distance as f32).next_up()) - distance;
    0.5 * grid / DT
}

/// What `docs/scenes.md` has, row by row.
fn row(distance: f64) -> String {
    let share = |speed: f64| {
        let share = way(Integrator::MoserVeselov, distance, speed, 600) / (speed * 600.0 * DT);
        format!("{:.0} %", 100.0 * share)
    };
    let grid = 2.0 * slowest(distance) * DT;
    let shares = [0.001, 0.01, 0.1, 1.0].map(share).join(" | ");
    format!("| {distance} m | {:.2e} m | {:.1e} m/s | {shares} |", grid, slowest(distance))
}

#[test]
fn the_table_of_the_guide_is_what_happens() {
    let guide = include_str!("../../../docs/scenes.md");
    let rows = [1.0, 10.0, 100.0, 1000.0, 10_000.0, 100_000.0].map(row);
    println!("{}", rows.join("\n"));
    let missing: Vec<_> = rows.iter().filter(|row| !DOUBLE && !guide.contains(row.as_str())).collect();
    assert!(missing.is_empty(), "{missing:#?}");
}

/// In how many times the slowest step an integrator begins to move. Runge and Kutta's adds a sixth,
/// two thirds and a sixth of a step one by one.
fn edge(integrator: Integrator) -> f64 {
    if integrator == Integrator::RungeKutta4 { 3.0 } else { 1.0 }
}

/// The speed of half a grid in a step is a sharp edge, for every integrator and both sides of the
/// origin.
#[test]
fn below_half_a_grid_in_a_step_nothing_moves() {
    for integrator in INTEGRATORS {
        for distance in [3.0, 70.0, 1000.0, 30_000.0] {
            let slowest = slowest(distance);
            let edge = edge(integrator) * slowest;
            for side in [-1.0, 1.0] {
                let go = |speed: f64| way(integrator, side * distance, side * speed, 600).abs();
                if DOUBLE {
                    // Of a way of at least a hundred grids of single precision, double has six
                    // digits at least.
                    let expected = 0.9 * edge * 600.0 * DT;
                    assert!((go(0.9 * edge) / expected - 1.0).abs() < 1e-6, "{integrator:?} {distance}");
                } else {
                    assert_eq!(go(0.9 * edge), 0.0, "{integrator:?} {distance}");
                    // Rounded up it is a whole grid in every step, or in each of two thirds of one.
                    let grids = 2.0 * slowest * DT * 600.0 * if edge > slowest { 2.0 } else { 1.0 };
                    assert!((go(1.1 * edge) / grids - 1.0).abs() < 1e-6, "{integrator:?} {distance}");
                }
            }
        }
    }
}

/// At most half a grid of a step is lost or won, so at n times the slowest speed one nth of the
/// way; four times that with four additions.
#[test]
fn at_a_multiple_of_the_slowest_speed_a_fraction_is_lost() {
    for integrator in INTEGRATORS {
        let additions = if integrator == Integrator::RungeKutta4 { 4.0 } else { 1.0 };
        for distance in [2.5, 300.0, 1000.0, 5000.0] {
            for multiple in [1.3, 2.7, 10.4, 77.3, 1000.6] {
                let speed = multiple * slowest(distance);
                let share = way(integrator, distance, speed, 200) / (speed * 200.0 * DT);
                // Velocity and step are rounded as well, to one in ten million each.
                let lost = if DOUBLE { 1e-7 } else { additions / multiple + 1e-6 };
                assert!((share - 1.0).abs() <= lost, "{integrator:?} {distance} {multiple}: {share}");
            }
        }
    }
}

/// Nine hours at a centimetre a second.
#[test]
fn a_kilometre_out_a_quarter_of_a_slow_way_is_lost() {
    let gone = way(Integrator::MoserVeselov, 1000.0, 0.01, 2_000_000);
    println!("{gone} m of 333.3");
    // Up to 1024 m three grids of 1/16384 m for the 2.73 that it should be, beyond that one of
    // 1/8192 m for 1.37.
    let expected = if DOUBLE { 2e6 * 0.01 * DT } else { 24.0 + (2e6 - 24.0 * 16384.0 / 3.0) / 8192.0 };
    assert!((gone - expected).abs() < if DOUBLE { 1e-5 } else { 1e-3 }, "{gone} for {expected}");
}
