//! Attitude and energy error against what they cost.

use hecs::World;
use tumble::math::{Real, Vec3};
use tumble::{Integrator, Pose, Settings, Simulation};
use tumble_record::{Plot, Scale, SeriesStyle};
use tumble_tests::references::double_quat;
use tumble_tests::{FreeBody, attitude_error, dquat, energy_of};

use crate::Picture;
use crate::cost::nanoseconds_per_body_step;
use crate::line;

/// Steps a second, from what a game takes to what a laboratory takes.
const STEPS_A_SECOND: [u32; 7] = [30, 60, 120, 240, 480, 960, 1920];

/// One integrator at one step on one body.
pub(crate) struct Row {
    body: &'static str,
    seconds: f64,
    integrator: Integrator,
    steps_a_second: u32,
    /// \[rad\]
    attitude: f64,
    /// Largest relative error.
    energy: f64,
    /// Largest difference of the length of the orientation from one.
    unit: f64,
    /// [ns]
    cost: f64,
}

impl Row {
    /// Microseconds per simulated second of one body.
    fn work(&self) -> f64 {
        self.cost * f64::from(self.steps_a_second) * 1e-3
    }
}

fn bodies() -> [(&'static str, FreeBody, f64); 4] {
    [
        ("van Zon's top", FreeBody::van_zon_top(), 10.0),
        ("Drake's cylinder", FreeBody::drake_cylinder(), 10.0),
        ("T-handle", FreeBody::t_handle(), 20.0),
        ("MuJoCo's box", FreeBody::mujoco_box(), 5.0),
    ]
}

/// A quantity to draw: its name in the file's, its label, its value.
type Quantity = (&'static str, &'static str, fn(&Row) -> f64);

/// All rows, body by body.
pub(crate) fn measure() -> Vec<Row> {
    let mut rows = Vec::new();
    for (name, body, seconds) in bodies() {
        for integrator in Integrator::ALL {
            for steps_a_second in STEPS_A_SECOND {
                rows.extend(run(name, &body, seconds, integrator, steps_a_second));
            }
        }
    }
    rows
}

/// `None` where a body or a setting is refused, which those here are not.
fn run(name: &'static str, body: &FreeBody, seconds: f64, integrator: Integrator, steps_a_second: u32) -> Option<Row> {
    let mut world = World::new();
    let entity = body.spawn(&mut world);
    let settings = Settings::default().with_gravity(Vec3::ZERO).with_dt(1.0 / steps_a_second as Real);
    let mut simulation = Simulation::new(settings.with_integrator(integrator)).ok()?;
    let start = energy_of(&world, entity);
    let (mut energy, mut unit) = (0.0_f64, 0.0_f64);
    for _ in 0..(seconds * f64::from(steps_a_second)).round() as u64 {
        simulation.step(&mut world);
        energy = energy.max((energy_of(&world, entity) / start - 1.0).abs());
        let length = double_quat(orientation(&world, entity)?).length_squared().sqrt();
        unit = unit.max((length - 1.0).abs());
    }
    let attitude = attitude_error(dquat(orientation(&world, entity)?), body.at(seconds).orientation);
    let cost = nanoseconds_per_body_step(body, integrator, settings);
    Some(Row { body: name, seconds, integrator, steps_a_second, attitude, energy, unit, cost })
}

fn orientation(world: &World, entity: hecs::Entity) -> Option<tumble::math::Quat> {
    world.get::<&Pose>(entity).ok().map(|pose| pose.orientation)
}

/// The table.
pub(crate) fn table(rows: &[Row]) -> String {
    let mut text = String::new();
    let mut body = "";
    for row in rows {
        if row.body != body {
            body = row.body;
            line(&mut text, format_args!("\n{body}, {} s", row.seconds));
            line(
                &mut text,
                format_args!(
                    "{:>20} {:>8} {:>15} {:>10} {:>10} {:>14}",
                    "integrator", "steps/s", "attitude [deg]", "energy", "|q| - 1", "ns/body-step"
                ),
            );
        }
        line(
            &mut text,
            format_args!(
                "{:>20} {:>8} {:>15.2e} {:>10.1e} {:>10.1e} {:>14.1}",
                row.integrator.name(),
                row.steps_a_second,
                row.attitude.to_degrees(),
                row.energy,
                row.unit,
                row.cost
            ),
        );
    }
    line(&mut text, format_args!(""));
    text
}

/// Two pictures a body: attitude error and energy error against work.
pub(crate) fn draw(rows: &[Row]) -> Vec<Picture> {
    let mut pictures = Vec::new();
    for (name, _, seconds) in bodies() {
        let file = name.to_lowercase().replace("'s", "").replace(' ', "-");
        let title = format!("{name}, {seconds} s, {}", tumble::math::PRECISION);
        let quantities: [Quantity; 2] = [
            ("attitude", "attitude error at the end [deg]", |row| row.attitude.to_degrees()),
            ("energy", "largest relative energy error", |row| row.energy),
        ];
        for (quantity, label, value) in quantities {
            let mut plot =
                Plot::new(&title).x_axis("work per simulated second [\u{b5}s]", Scale::Log).y_axis(label, Scale::Log);
            for integrator in Integrator::ALL {
                let of_this = rows.iter().filter(|row| row.body == name && row.integrator == integrator);
                plot = plot.series(integrator.name(), SeriesStyle::Dots, of_this.map(|row| (row.work(), value(row))));
            }
            pictures.push((format!("{quantity}-{file}"), plot));
        }
    }
    pictures
}
