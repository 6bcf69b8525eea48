//! An orbit of eccentricity 0.6 about a fixed mass.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use hecs::{Entity, World};
use tumble::math::{Real, Vec3};
use tumble::{PointGravity, Pose, RigidBody, Settings, Shape, Simulation, Velocity};
use tumble_record::{Plot, Scale, SeriesStyle};
use tumble_tests::dvec3;

use crate::{Failure, Findings};

const ECCENTRICITY: f64 = 0.6;

/// What a Kepler orbit keeps, with `mu` and the semi-major axis 1.
#[derive(Clone, Copy)]
struct Elements {
    energy: f64,
    angular_momentum: f64,
    eccentricity: f64,
    /// Where the body is nearest, from where it was at first \[rad\].
    periapsis: f64,
}

/// A name and a number of the elements.
type Element = (&'static str, fn(&Elements) -> f64);

struct Orbit {
    world: World,
    body: Entity,
    simulation: Simulation,
    steps: u32,
}

impl Orbit {
    fn new(steps: u32) -> Result<Self, Failure> {
        let mut world = World::new();
        let speed = ((1.0 + ECCENTRICITY) / (1.0 - ECCENTRICITY)).sqrt();
        let body = RigidBody::new(Shape::Point)
            .mass(1.0)
            .position(Vec3::X * (1.0 - ECCENTRICITY) as Real)
            .linear_velocity(Vec3::Y * speed as Real)
            .build()?
            .spawn(&mut world);
        world.insert_one(body, PointGravity { mu: 1.0, ..PointGravity::default() })?;
        let settings = Settings::default().with_gravity(Vec3::ZERO).with_dt((TAU / f64::from(steps)) as Real);
        Ok(Self { world, body, simulation: Simulation::new(settings)?, steps })
    }

    fn elements(&self) -> Result<Elements, Failure> {
        let x = dvec3(self.world.get::<&Pose>(self.body)?.position);
        let v = dvec3(self.world.get::<&Velocity>(self.body)?.linear);
        let turning = x.cross(v);
        let axis = v.cross(turning) - x / x.length();
        Ok(Elements {
            energy: 0.5 * v.length_squared() - 1.0 / x.length(),
            angular_momentum: turning.z,
            eccentricity: axis.length(),
            periapsis: axis.y.atan2(axis.x),
        })
    }

    /// The elements in each of a number of periods: means over the period, which the error that
    /// comes and goes in each does not touch.
    fn periods(&mut self, count: u32) -> Result<Vec<Elements>, Failure> {
        const SAMPLES: u32 = 50;
        let mut periods = Vec::new();
        for _ in 0..count {
            let mut sum = Elements { energy: 0.0, angular_momentum: 0.0, eccentricity: 0.0, periapsis: 0.0 };
            for _ in 0..SAMPLES {
                let now = self.elements()?;
                sum.energy += now.energy;
                sum.angular_momentum += now.angular_momentum;
                sum.eccentricity += now.eccentricity;
                sum.periapsis += now.periapsis;
                self.simulation.step_many(&mut self.world, self.steps / SAMPLES);
            }
            let mean = |sum: f64| sum / f64::from(SAMPLES);
            periods.push(Elements {
                energy: mean(sum.energy),
                angular_momentum: mean(sum.angular_momentum),
                eccentricity: mean(sum.eccentricity),
                periapsis: mean(sum.periapsis),
            });
        }
        Ok(periods)
    }
}

/// Slope of the least-squares line through values one apart, and its standard error if all but the
/// line were noise.
fn slope(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let (middle, mean) = ((n - 1.0) / 2.0, values.iter().sum::<f64>() / n);
    let (mut xx, mut xy, mut rest) = (0.0, 0.0, 0.0);
    for (i, value) in values.iter().enumerate() {
        xx += (i as f64 - middle).powi(2);
        xy += (i as f64 - middle) * (value - mean);
    }
    let slope = xy / xx;
    for (i, value) in values.iter().enumerate() {
        rest += (value - mean - slope * (i as f64 - middle)).powi(2);
    }
    (slope, (rest / (n - 2.0) / xx).sqrt())
}

pub(crate) fn find() -> Result<Findings, Failure> {
    let mut text = String::from("An orbit of eccentricity 0.6, by steps a period; 100 periods\n\n");
    text.push_str("| steps a period | precession [rad a period] | times steps^2 | largest change of the mean energy |\n|---|---|---|---|\n");
    let mut precession = Vec::new();
    for steps in [250, 500, 1000, 2000, 4000] {
        let elements = Orbit::new(steps)?.periods(100)?;
        let (rate, _) = slope(&elements.iter().map(|one| one.periapsis).collect::<Vec<_>>());
        let error = elements.iter().map(|one| (one.energy / elements[0].energy - 1.0).abs()).fold(0.0, f64::max);
        writeln!(text, "| {steps} | {rate:.4e} | {:.2} | {error:.1e} |", rate * f64::from(steps).powi(2))?;
        precession.push((f64::from(steps), rate.abs()));
    }

    let long = Orbit::new(500)?.periods(1000)?;
    let over = |value: fn(&Elements) -> f64| long.iter().map(value).collect::<Vec<_>>();
    writeln!(
        text,
        "\n1000 periods of 500 steps, means over each\n\n| element | at first | at last | slope a period | its standard error |"
    )?;
    text.push_str("|---|---|---|---|---|\n");
    let rows: [Element; 4] = [
        ("energy", |one| one.energy),
        ("angular momentum", |one| one.angular_momentum),
        ("eccentricity", |one| one.eccentricity),
        ("place of the periapsis [rad]", |one| one.periapsis),
    ];
    for (name, value) in rows {
        let values = over(value);
        let (slope, error) = slope(&values);
        writeln!(
            text,
            "| {name} | {:.12} | {:.12} | {slope:.2e} | {error:.1e} |",
            values[0],
            values[values.len() - 1]
        )?;
    }
    let errors = long.iter().enumerate().map(|(i, one)| (i as f64, one.energy / long[0].energy - 1.0));
    let energy = Plot::new("A Kepler orbit, 1000 periods of 500 steps")
        .x_axis("period", Scale::Linear)
        .y_axis("relative change of energy", Scale::Linear)
        .series("", SeriesStyle::Line, errors);
    let falling = Plot::new("How far the ellipse turns in a period")
        .x_axis("steps a period", Scale::Log)
        .y_axis("precession [rad]", Scale::Log)
        .series("", SeriesStyle::Dots, precession);
    Ok((text, vec![("kepler-energy", energy), ("kepler-precession", falling)]))
}
