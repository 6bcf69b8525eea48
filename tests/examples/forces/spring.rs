//! The frequency at which two bodies on a stiff spring oscillate.

use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;

use hecs::World;
use tumble::math::{Real, Vec3};
use tumble::{Pose, RigidBody, Settings, Shape, Simulation, Spring};
use tumble_record::{Plot, Scale, SeriesStyle};
use tumble_tests::seconds;

use crate::{Failure, Findings};

/// Oscillations a step of a spring that in truth makes `frequency` of them, with a step of one
/// second and a reduced mass of one kilogram; `None` where it explodes.
fn measured(frequency: f64) -> Result<Option<f64>, Failure> {
    let mut world = World::new();
    let ball = |x: Real| RigidBody::new(Shape::sphere(0.1)).without_collider().mass(2.0).position(Vec3::X * x).build();
    let (left, right) = (ball(-1.1)?.spawn(&mut world), ball(1.1)?.spawn(&mut world));
    let stiffness = (TAU * frequency).powi(2);
    world.spawn((Spring::between(left, right).with_rest_length(2.0).with_stiffness(stiffness as Real),));
    let mut simulation = Simulation::new(Settings::default().with_gravity(Vec3::ZERO).with_dt(1.0))?;
    let mut lengths = Vec::new();
    for _ in 0..1000 {
        let (a, b) = (world.get::<&Pose>(left)?.position.x, world.get::<&Pose>(right)?.position.x);
        lengths.push(seconds(b) - seconds(a) - 2.0);
        simulation.step(&mut world);
    }
    // Equal steps of an oscillation: x(n + 1) + x(n - 1) = 2 cos(angle) x(n).
    let (mut product, mut square) = (0.0, 0.0);
    for window in lengths.windows(3) {
        product += window[1] * (window[0] + window[2]);
        square += 2.0 * window[1] * window[1];
    }
    let largest = lengths.iter().fold(0.0_f64, |most, length| most.max(length.abs()));
    Ok((largest < 1.0).then(|| (product / square).clamp(-1.0, 1.0).acos() / TAU))
}

pub(crate) fn find() -> Result<Findings, Failure> {
    let mut text = String::from("\nA spring between two bodies, oscillations a step\n\n");
    text.push_str("| in truth | measured | relative error | kick and drift without more |\n|---|---|---|---|\n");
    let (mut ours, mut plain) = (Vec::new(), Vec::new());
    for hundredths in [1_u32, 5, 10, 15, 20, 25, 30, 35, 40, 45, 50, 60, 80, 100] {
        let frequency = f64::from(hundredths) * 0.01;
        let without = PI * frequency;
        let without = (without <= 1.0).then(|| 2.0 * without.asin() / TAU);
        let found = measured(frequency)?;
        let (shown, error) = match found {
            Some(found) => (format!("{found:.6}"), format!("{:.1e}", found / frequency - 1.0)),
            None => ("explodes".to_owned(), String::new()),
        };
        let shown_without = without.map_or("explodes".to_owned(), |without| format!("{without:.6}"));
        writeln!(text, "| {frequency:.2} | {shown} | {error} | {shown_without} |")?;
        ours.extend(found.map(|found| (frequency, found)));
        plain.extend(without.map(|without| (frequency, without)));
    }
    let plot = Plot::new("Frequency of a stiff spring")
        .x_axis("oscillations a step in truth", Scale::Linear)
        .y_axis("oscillations a step as simulated", Scale::Linear)
        .series("tumble", SeriesStyle::Dots, ours)
        .series("kick and drift without more", SeriesStyle::Line, plain);
    Ok((text, vec![("spring-frequency", plot)]))
}
