use hecs::World;

use crate::columns::for_each_chunk;
use crate::force_laws::ForceLaws;
use crate::kinematic::move_kinematic_bodies;
use crate::phase_times::{Phase, PhaseTimes};
use crate::settings::Settings;
use crate::systems::{accumulate_forces_of, integrate_bodies, remember_poses, update_derived_of};

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
    step_under_laws(world, settings, &ForceLaws::default(), 0.0, None);
}

/// [`step`] under force laws, starting at a time \[s\], adding to `times` how long each phase took.
pub(crate) fn step_under_laws(
    world: &mut World,
    settings: &Settings,
    laws: &ForceLaws,
    time: f64,
    times: Option<&PhaseTimes>,
) {
    for_each_chunk(world, laws, |mut bodies| {
        remember_poses(&mut bodies);
        let mut clock = PhaseTimes::start(times);
        accumulate_forces_of(&mut bodies, settings);
        clock.end_of(Phase::AccumulateForces);
        integrate_bodies(&mut bodies, settings, time);
        clock.end_of(Phase::Integrate);
        update_derived_of(&mut bodies);
        clock.end_of(Phase::UpdateDerived);
    });
    move_kinematic_bodies(world, settings.dt);
}
