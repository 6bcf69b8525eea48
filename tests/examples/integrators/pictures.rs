//! What tumbling looks like, right and wrong.

use hecs::{Entity, World};
use tumble::math::Vec3;
use tumble::{Integrator, Momentum, Pose, Settings, Simulation};
use tumble_record::{Plot, Scale, SeriesStyle};
use tumble_tests::references::Tumbler;
use tumble_tests::{dquat, dvec3};

use crate::Picture;

/// The T-handle at 60 steps a second: its flips over half a minute, its energy over ten.
pub(crate) fn draw() -> Vec<Picture> {
    let body = Tumbler::t_handle();
    let precision = tumble::math::PRECISION;
    let mut flips = Plot::new(format!("A handle that flips, 60 steps a second, {precision}"))
        .x_axis("time [s]", Scale::Linear)
        .y_axis("spin about the middle axis [rad/s]", Scale::Linear);
    let mut energy = Plot::new(format!("Energy of the handle, 60 steps a second, {precision}"))
        .x_axis("time [s]", Scale::Log)
        .y_axis("relative energy error", Scale::Log);
    for (integrator, mark) in [
        (Integrator::SemiImplicitEuler, SeriesStyle::Line),
        (Integrator::RungeKutta4, SeriesStyle::Line),
        (Integrator::MoserVeselov, SeriesStyle::Line),
    ] {
        let history = history(&body, integrator, 36_000);
        let start = history.first().map_or(f64::NAN, |moment| moment.energy);
        if integrator != Integrator::RungeKutta4 {
            let spins = history.iter().take(30 * 60 + 1).map(|moment| (moment.time, moment.spin));
            flips = flips.series(integrator.name(), mark, spins);
        }
        let errors = history.iter().map(|moment| (moment.time, (moment.energy / start - 1.0).abs()));
        energy = energy.series(integrator.name(), mark, errors);
    }
    vec![("handle-flips".to_owned(), flips), ("handle-energy".to_owned(), energy)]
}

struct Moment {
    time: f64,
    /// About the middle axis [rad/s].
    spin: f64,
    energy: f64,
}

fn history(body: &Tumbler, integrator: Integrator, steps: u32) -> Vec<Moment> {
    let mut world = World::new();
    let entity = body.spawn(&mut world);
    let settings = Settings::default().with_gravity(Vec3::ZERO).with_integrator(integrator);
    let Ok(mut simulation) = Simulation::new(settings) else { return Vec::new() };
    let mut history: Vec<Moment> = moment(body, &world, entity, 0.0).into_iter().collect();
    for _ in 0..steps {
        simulation.step(&mut world);
        history.extend(moment(body, &world, entity, simulation.time()));
    }
    history
}

fn moment(body: &Tumbler, world: &World, entity: Entity, time: f64) -> Option<Moment> {
    let orientation = dquat(world.get::<&Pose>(entity).ok()?.orientation);
    let momentum = orientation.conjugate() * dvec3(world.get::<&Momentum>(entity).ok()?.angular);
    let spin = momentum / body.moments;
    Some(Moment { time, spin: spin.y, energy: 0.5 * momentum.dot(spin) })
}
