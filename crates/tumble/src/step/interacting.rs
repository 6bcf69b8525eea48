//! Steps of worlds in which bodies act on each other: of one, or of several whose contacts are
//! solved together.

use hecs::World;

use crate::clock::Clock;
use crate::components::Wrenches;
use crate::forces::registry::ForceLaws;
use crate::integrator::Integrator;
use crate::math::Real;
use crate::settings::Settings;
use crate::solver::multi_world::{MultiWorld, PackKey};
use crate::step::interactions::Interactions;
use crate::step::phase_times::{Phase, PhaseTimes, Stopwatch};
use crate::step::systems::{accumulate_forces_of, integrate_bodies, remember_poses, update_derived_of};
use crate::storage::world_columns::WorldColumns;

/// A world in which bodies act on each other, and what it is stepped with.
pub(crate) struct InteractingWorld<'a> {
    columns: WorldColumns<'a>,
    settings: &'a Settings,
    laws: &'a ForceLaws,
    interactions: &'a mut Interactions,
    /// At the first step.
    clock: Clock,
}

/// What worlds that go step by step together are packed in, and what they have in common.
pub(crate) type Together<'a> = (&'a mut MultiWorld, PackKey);

/// Steps: a whole world goes from one kick to the next together, kinematic bodies too. Of several
/// worlds contacts are packed, and they have the same [`PackKey`].
pub(crate) fn step_interacting(
    worlds: &mut [InteractingWorld<'_>],
    mut together: Option<Together<'_>>,
    steps: u32,
    times: Option<&PhaseTimes>,
) {
    for step in 0..steps {
        let mut stopwatch = PhaseTimes::start(times);
        for InteractingWorld { columns, settings, .. } in &mut *worlds {
            columns.for_each_chunk(|_, bodies| {
                remember_poses(bodies);
                accumulate_forces_of(bodies, settings);
            });
        }
        stopwatch.end_of(Phase::AccumulateForces);
        let beside = |columns: &mut WorldColumns<'_>, settings: &Settings, substep| {
            columns.move_kinematic_bodies(settings.substep(), substep);
        };
        integrate_interacting(worlds, together.as_mut(), step, beside, &mut stopwatch);
        for InteractingWorld { columns, .. } in &mut *worlds {
            columns.for_each_chunk(|_, bodies| update_derived_of(bodies));
        }
        stopwatch.end_of(Phase::UpdateDerived);
    }
}

/// The integration of a step, this many after the clocks: kicks between bodies before and after
/// each substep, all of it before where the integrator is of first order, and contacts in the place
/// of the integrator where something touches. `beside` is called for what else moves in a substep,
/// with its number.
pub(crate) fn integrate_interacting(
    worlds: &mut [InteractingWorld<'_>],
    mut together: Option<&mut Together<'_>>,
    step: u32,
    beside: impl Fn(&mut WorldColumns<'_>, &Settings, u32),
    stopwatch: &mut Stopwatch<'_>,
) {
    for contacts in worlds.iter_mut().filter_map(|it| it.interactions.contacts.as_mut()) {
        contacts.begin_step();
    }
    let substeps = worlds.first().map_or(0, |it| it.settings.substeps);
    debug_assert!(worlds.iter().all(|it| it.settings.substeps == substeps));
    let pull = worlds.iter().any(|it| it.interactions.pairs.is_some());
    let touch = worlds.iter().any(|it| it.interactions.contacts.is_some());
    for substep in 0..substeps {
        for it in &mut *worlds {
            it.kick(it.kicks().0);
        }
        stopwatch.end_if(pull, Phase::Pairs);
        match &mut together {
            Some((multi_world, pack_key)) => solve_together(worlds, multi_world, pack_key, (step, substep)),
            None => worlds.iter_mut().for_each(|it| it.solve_alone(it.time_of(step, substep))),
        }
        stopwatch.end_if(touch, Phase::Contacts);
        for it in &mut *worlds {
            it.integrate(it.time_of(step, substep), substep);
            beside(&mut it.columns, it.settings, substep);
        }
        stopwatch.end_of(Phase::Integrate);
        for it in &mut *worlds {
            it.write_constrained(together.as_deref());
        }
        stopwatch.end_if(touch, Phase::Contacts);
        for it in &mut *worlds {
            if let Some(after) = it.kicks().1 {
                it.kick(after);
            }
        }
        stopwatch.end_if(pull, Phase::Pairs);
    }
}

/// Solves the contacts of all worlds at the same time.
fn solve_together(
    worlds: &mut [InteractingWorld<'_>],
    multi_world: &mut MultiWorld,
    pack_key: &PackKey,
    (step, substep): (u32, u32),
) {
    crate::scope::scope!("tumble::contacts");
    let Some(settings) = worlds.first().map(|it| it.settings) else { return };
    let mut touching = [0; 2];
    for it in &mut *worlds {
        if let Some(contacts) = &mut it.interactions.contacts {
            let [dynamic, non_dynamic] = contacts.find_touching(&it.columns, it.settings);
            touching = [touching[0] + dynamic, touching[1] + non_dynamic];
        }
    }
    multi_world.begin(touching);
    for it in &mut *worlds {
        let time = it.time_of(step, substep);
        if let Some(contacts) = &mut it.interactions.contacts {
            multi_world.add(contacts, &mut it.columns, it.settings, it.laws, time);
        }
    }
    multi_world.solve_substeps(settings, pack_key);
    for contacts in worlds.iter_mut().filter_map(|it| it.interactions.contacts.as_mut()) {
        multi_world.return_impulses(contacts);
    }
}

impl<'a> InteractingWorld<'a> {
    /// Of a world, of which it finds out what acts between which bodies, and holds these until it
    /// is dropped.
    pub(crate) fn new(
        world: &'a mut World,
        settings: &'a Settings,
        laws: &'a ForceLaws,
        interactions: &'a mut Interactions,
        clock: Clock,
    ) -> Self {
        interactions.find(world);
        Self { columns: laws.columns_of(world), settings, laws, interactions, clock }
    }

    /// When a substep begins \[s\].
    fn time_of(&self, step: u32, substep: u32) -> f64 {
        self.clock.time_after(step) + f64::from(substep) * f64::from(self.settings.substep())
    }

    /// How long the kicks before and after a substep act \[s\].
    fn kicks(&self) -> (Real, Option<Real>) {
        let h = self.settings.substep();
        match self.settings.integrator {
            Integrator::SemiImplicitEuler => (h, None),
            Integrator::RungeKutta4 | Integrator::MoserVeselov => (h * 0.5, Some(h * 0.5)),
        }
    }

    fn kick(&mut self, duration: Real) {
        if let Some(pairs) = &mut self.interactions.pairs {
            crate::scope::scope!("tumble::pairs");
            pairs.kick(&mut self.columns, duration, self.settings.substep());
        }
    }

    fn solve_alone(&mut self, time: f64) {
        if let Some(contacts) = &mut self.interactions.contacts {
            crate::scope::scope!("tumble::contacts");
            let contact_solver = self.interactions.contact_solver.get_or_insert_default();
            contact_solver.solve_world(contacts, &mut self.columns, (self.settings, self.laws, time));
        }
    }

    /// Integrates all bodies over a substep.
    fn integrate(&mut self, time: f64, substep: u32) {
        let one = Settings { dt: self.settings.substep(), substeps: 1, ..*self.settings };
        let wrenches = if substep + 1 == self.settings.substeps { Wrenches::Consumed } else { Wrenches::Kept };
        self.laws.for_each_chunk_of(&mut self.columns, |bodies, laws| {
            integrate_bodies(bodies, laws, &one, time, wrenches);
        });
    }

    /// Puts the bodies that touch something where contacts have pushed them.
    fn write_constrained(&mut self, together: Option<&Together<'_>>) {
        let contact_solver = together
            .map(|(multi_world, _)| multi_world.contact_solver())
            .or(self.interactions.contact_solver.as_deref());
        if let (Some(contacts), Some(contact_solver)) = (&self.interactions.contacts, contact_solver) {
            contacts.write(&mut self.columns, contact_solver);
        }
    }
}
