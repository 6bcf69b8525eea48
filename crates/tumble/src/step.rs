use hecs::World;

use crate::columns::for_each_chunk;
use crate::force_laws::ForceLaws;
use crate::kinematic::move_kinematic_bodies;
use crate::phase_times::{Phase, PhaseTimes};
use crate::settings::Settings;
use crate::systems::{
    accumulate_forces_of, integrate_bodies, remember_poses, step_under_constant_forces, update_derived_of,
};

/// Advances every body of the world by `settings.dt`.
///
/// The systems of a step use only a body's own components, so all of them run on a chunk of bodies while it is in cache. Running
/// [`accumulate_forces`](crate::accumulate_forces), [`integrate`](crate::integrate) and [`update_derived`](crate::update_derived)
/// one after the other over the whole world gives moving bodies the same bits. A step also moves the kinematic bodies, one after the
/// other, and keeps [`PreviousPose`](crate::PreviousPose) up to date.
///
/// The settings are not [validated](Settings::validate) here; [`Simulation`](crate::Simulation) does that once, and knows the force
/// laws and the time.
pub fn step(world: &mut World, settings: &Settings) {
    steps_under_laws(world, settings, &ForceLaws::default(), 1, |_| 0.0, None);
}

/// So many [`step`]s under force laws, starting at times \[s\], adding to `times` how long each phase took.
pub(crate) fn steps_under_laws(
    world: &mut World,
    settings: &Settings,
    laws: &ForceLaws,
    steps: u32,
    time_of_step: impl Fn(u32) -> f64 + Sync,
    times: Option<&PhaseTimes>,
) {
    crate::scope::scope!("tumble::step");
    for_each_chunk(world, laws, |bodies| {
        if bodies.have_constant_forces() && times.is_none() {
            return step_under_constant_forces(bodies, settings, steps);
        }
        for step in 0..steps {
            remember_poses(bodies);
            let mut stopwatch = PhaseTimes::start(times);
            accumulate_forces_of(bodies, settings);
            stopwatch.end_of(Phase::AccumulateForces);
            integrate_bodies(bodies, settings, time_of_step(step));
            stopwatch.end_of(Phase::Integrate);
            update_derived_of(bodies);
            stopwatch.end_of(Phase::UpdateDerived);
        }
    });
    move_kinematic_bodies(world, settings.dt, steps);
}
