use hecs::World;

use crate::columns::for_each_chunk;
use crate::coupling::Coupling;
use crate::force_laws::ForceLaws;
use crate::kinematic::{move_kinematic_bodies, move_kinematic_bodies_a_substep};
use crate::phase_times::{Phase, PhaseTimes};
use crate::settings::Settings;
use crate::systems::{
    Wrenches, accumulate_forces_of, integrate_bodies, integrate_coupled, remember_poses, step_chunk, update_derived_of,
};

/// Advances every body of the world by `settings.dt`: the three systems, the motion of kinematic bodies, and [`PreviousPose`](crate::PreviousPose).
///
/// All systems run on a chunk of bodies while it is in cache. [`accumulate_forces`](crate::accumulate_forces), [`integrate`](crate::integrate) and
/// [`update_derived`](crate::update_derived), one after the other over the whole world, give moving bodies the same bits, with one exception: what a
/// [`Spring`](crate::Spring) or [`GravityMass`](crate::GravityMass) ties to a kinematic body, since a step moves that one along in every substep.
///
/// The settings are not [validated](Settings::validate) here; [`Simulation`](crate::Simulation) does that once, and knows the force
/// laws and the time.
///
/// ```
/// # use tumble::{step, prelude::*};
/// # let mut world = hecs::World::new();
/// let stone = RigidBody::new(Shape::Point).mass(2.0).build()?.spawn(&mut world);
/// step(&mut world, &Settings::default().with_dt(0.5));
/// assert!((world.get::<&Pose>(stone)?.position.y + 0.5 * 9.81 * 0.25).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn step(world: &mut World, settings: &Settings) {
    steps_under_laws(world, settings, &ForceLaws::default(), &mut None, 1, |_| 0.0, None);
}

/// So many [`step`]s under force laws, starting at times \[s\], adding to `times` how long each phase took.
pub(crate) fn steps_under_laws(
    world: &mut World,
    settings: &Settings,
    laws: &ForceLaws,
    coupling: &mut Option<Box<Coupling>>,
    steps: u32,
    time_of_step: impl Fn(u32) -> f64 + Sync,
    times: Option<&PhaseTimes>,
) {
    crate::scope::scope!("tumble::step");
    if Coupling::is_in(world) {
        let coupling = coupling.get_or_insert_default();
        coupling.find(world);
        coupled_steps(world, settings, laws, coupling, steps, time_of_step, times);
    } else {
        if let Some(coupling) = coupling {
            coupling.pass(world, steps);
        }
        for_each_chunk(world, laws, |bodies| {
            if bodies.work.is_none() && times.is_none() {
                return step_chunk(bodies, settings, steps, &time_of_step);
            }
            for step in 0..steps {
                remember_poses(bodies);
                let mut stopwatch = PhaseTimes::start(times);
                accumulate_forces_of(bodies, settings);
                stopwatch.end_of(Phase::AccumulateForces);
                integrate_bodies(bodies, settings, time_of_step(step), Wrenches::Consumed);
                stopwatch.end_of(Phase::Integrate);
                update_derived_of(bodies);
                stopwatch.end_of(Phase::UpdateDerived);
            }
        });
        move_kinematic_bodies(world, settings.dt, steps);
    }
}

/// Steps of a world where bodies act on each other: the whole world goes from one kick to the next together, kinematic bodies too.
fn coupled_steps(
    world: &mut World,
    settings: &Settings,
    laws: &ForceLaws,
    coupling: &mut Coupling,
    steps: u32,
    time_of_step: impl Fn(u32) -> f64 + Sync,
    times: Option<&PhaseTimes>,
) {
    for step in 0..steps {
        let mut stopwatch = PhaseTimes::start(times);
        for_each_chunk(world, laws, |bodies| {
            remember_poses(bodies);
            accumulate_forces_of(bodies, settings);
        });
        stopwatch.end_of(Phase::AccumulateForces);
        integrate_coupled(world, settings, laws, coupling, time_of_step(step), |world, substep| {
            move_kinematic_bodies_a_substep(world, settings.substep(), substep);
        });
        stopwatch.end_of(Phase::Integrate);
        for_each_chunk(world, laws, update_derived_of);
        stopwatch.end_of(Phase::UpdateDerived);
    }
}
