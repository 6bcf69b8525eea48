//! The step, whole, phase by phase or as single systems; contacts and times that it reports.

pub(crate) mod advance;
pub(crate) mod body_forces;
pub(crate) mod body_slices;
pub(crate) mod contact_report;
pub(crate) mod interacting;
pub(crate) mod interactions;
pub(crate) mod joint_report;
#[cfg(feature = "tracing")]
pub(crate) mod mistakes;
pub(crate) mod pack_key;
pub(crate) mod phase_times;
pub(crate) mod phased_step;
pub(crate) mod population;
pub(crate) mod sensor_report;
pub(crate) mod simulation;
pub(crate) mod sleep_report;
pub(crate) mod systems;

pub use crate::step::body_slices::{BodySlices, LengthMismatch};
pub use crate::step::contact_report::{Contact, ContactPoint};
pub use crate::step::phase_times::PhaseTimes;
pub use crate::step::phased_step::{Step, StepPhase};
pub use crate::step::simulation::{Simulation, StepHooks};
pub use crate::step::systems::{
    accumulate_forces, integrate, integrate_under_laws, move_kinematic_bodies, remember_poses, update_derived,
};

use hecs::World;

use crate::clock::Clock;
use crate::components::Wrenches;
use crate::forces::registry::ForceLaws;
use crate::forces::under_laws::for_each_chunk_under;
use crate::integrators::kinematic;
use crate::settings::Settings;
use crate::step::interacting::{InteractingWorld, step_interacting};
use crate::step::interactions::Interactions;
use crate::step::population::Population;
use crate::step::systems::{accumulate_forces_of, integrate_bodies, remember_poses_of, step_chunk, update_derived_of};

/// Advances every body of the world by `settings.dt`: the three systems, the motion of kinematic
/// bodies, and [`PreviousPose`](crate::PreviousPose).
///
/// All systems run on a chunk of bodies while it is in cache.
/// [`accumulate_forces`], [`integrate`] and
/// [`update_derived`], one after the other over the whole world, give moving
/// bodies the same bits, with one exception: what a [`Spring`](crate::Spring) or
/// [`GravityMass`](crate::GravityMass) ties to a kinematic body, since a step moves that one along
/// in every substep.
///
/// Nothing is kept for the next step here: contacts begin each without the impulses that held
/// bodies in the last, so piles sink and creep. A [`Simulation`] keeps them.
///
/// The settings are not [validated](Settings::validate) here; [`Simulation`]
/// does that once, and knows the force laws and the time.
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
    steps_under_laws(world, settings, &ForceLaws::default(), &mut None, 1, Clock::at(0.0), None);
}

/// Several [`step`]s under force laws, from a time on, adding to `times` how long each phase took.
pub(crate) fn steps_under_laws(
    world: &mut World,
    settings: &Settings,
    laws: &ForceLaws,
    interactions: &mut Option<Box<Interactions>>,
    steps: u32,
    clock: Clock,
    times: Option<&PhaseTimes>,
) {
    crate::scope::scope!("tumble::step");
    let collision = interactions.as_ref().and_then(|interactions| interactions.collision.as_ref());
    let population = Population::of(world, laws);
    let effort = population.effort(collision, steps);
    effort.run(|| steps_here(world, (&population, settings, laws), interactions, steps, clock, times));
}

/// The same where the caller is.
fn steps_here(
    world: &mut World,
    (population, settings, laws): (&Population, &Settings, &ForceLaws),
    interactions: &mut Option<Box<Interactions>>,
    steps: u32,
    clock: Clock,
    times: Option<&PhaseTimes>,
) {
    if population.interacts() {
        let interactions = interactions.get_or_insert_default();
        step_interacting(&mut [InteractingWorld::new(world, settings, laws, interactions, clock)], None, steps, times);
    } else {
        if let Some(interactions) = interactions {
            interactions.pass(world, steps);
        }
        for_each_chunk_under(world, (laws, population.are_under_laws()), |bodies, laws| {
            if times.is_none() {
                return step_chunk(bodies, laws, settings, steps, &|step| clock.time_after(step));
            }
            for step in 0..steps {
                remember_poses_of(bodies);
                let mut stopwatch = PhaseTimes::start(times);
                accumulate_forces_of(bodies, settings.gravity);
                stopwatch.end_of(StepPhase::AccumulateForces);
                integrate_bodies(bodies, laws, settings, clock.time_after(step), Wrenches::Consumed);
                stopwatch.end_of(StepPhase::Integrate);
                update_derived_of(bodies);
                stopwatch.end_of(StepPhase::UpdateDerived);
            }
        });
        if population.has_kinematic {
            kinematic::move_kinematic_bodies(world, settings.dt, steps);
        }
    }
}
