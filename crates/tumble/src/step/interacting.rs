//! Steps of worlds in which bodies act on each other: of one, or of several whose contacts are
//! solved together.

use hecs::World;

use crate::clock::Clock;
use crate::components::Wrenches;
use crate::forces::registry::ForceLaws;
use crate::joints::breakable::Breakable;
use crate::joints::joint_load::JointLoad;
use crate::settings::Settings;
use crate::solver::gather_scatter::{Constraints, hold_locked, scatter};
use crate::solver::multi_world::MultiWorld;
use crate::solver::substeps::Solver;
use crate::step::interactions::Interactions;
use crate::step::pack_key::PackKey;
use crate::step::phase_times::{PhaseTimes, Stopwatch};
use crate::step::phased_step::StepPhase;
use crate::step::systems::{
    accumulate_forces_of, accumulate_forces_where, integrate_unconstrained, remember_poses_of, update_derived_of,
};
use crate::storage::body_index::{RowPlace, Slot};
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

/// The memory in which packed worlds are stepped together, and their common key.
pub(crate) type Together<'a> = (&'a mut MultiWorld, PackKey);

/// A step of several, and a substep of it.
#[derive(Clone, Copy)]
pub(crate) struct SubstepIndex {
    pub(crate) step: u32,
    pub(crate) substep: u32,
}

/// What kinematic bodies do in the substeps of a step.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum KinematicBodies {
    Move,
    Stay,
}

/// Before or after what else happens in a substep.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum SubstepHalf {
    First,
    Second,
}

/// Steps of whole worlds, kinematic bodies too. Several worlds have the same [`PackKey`], and their
/// contacts are solved together.
pub(crate) fn step_interacting(
    worlds: &mut [InteractingWorld<'_>],
    mut together: Option<Together<'_>>,
    steps: u32,
    times: Option<&PhaseTimes>,
) {
    for step in 0..steps {
        let mut stopwatch = PhaseTimes::start(times);
        if step > 0 {
            worlds.iter_mut().for_each(|it| it.interactions.begin_next_step());
        }
        worlds.iter_mut().for_each(|it| it.interactions.begin_step());
        worlds.iter_mut().for_each(InteractingWorld::update_sleep);
        worlds.iter_mut().for_each(InteractingWorld::remember_poses);
        worlds.iter_mut().for_each(InteractingWorld::accumulate_forces);
        stopwatch.end_of(StepPhase::AccumulateForces);
        integrate_interacting(worlds, together.as_mut(), step, KinematicBodies::Move, &mut stopwatch);
        worlds.iter_mut().for_each(InteractingWorld::update_derived);
        stopwatch.end_of(StepPhase::UpdateDerived);
    }
}

/// The integration of a step that was begun, this many after the clocks.
pub(crate) fn integrate_interacting(
    worlds: &mut [InteractingWorld<'_>],
    mut together: Option<&mut Together<'_>>,
    step: u32,
    kinematic: KinematicBodies,
    stopwatch: &mut Stopwatch<'_>,
) {
    let substeps = worlds.first().map_or(0, |it| it.settings.substeps);
    debug_assert!(worlds.iter().all(|it| it.settings.substeps == substeps));
    let pull = worlds.iter().any(|it| it.interactions.pairs.is_some());
    let touch = worlds.iter().any(|it| it.interactions.collision.is_some());
    for substep in 0..substeps {
        let index = SubstepIndex { step, substep };
        worlds.iter_mut().for_each(|it| it.apply_pair_forces(SubstepHalf::First));
        stopwatch.end_if(pull, StepPhase::PairForcesBefore);
        worlds.iter_mut().for_each(InteractingWorld::find_contacts);
        stopwatch.end_if(touch, StepPhase::FindContacts);
        match &mut together {
            Some(together) => solve_together(worlds, together, index),
            None => worlds.iter_mut().for_each(|it| it.solve(index)),
        }
        stopwatch.end_if(touch, StepPhase::SolveContacts);
        worlds.iter_mut().for_each(|it| it.integrate(index));
        if kinematic == KinematicBodies::Move {
            worlds.iter_mut().for_each(|it| it.move_kinematic(index));
        }
        worlds.iter_mut().for_each(InteractingWorld::stop_crossings);
        worlds.iter_mut().for_each(InteractingWorld::update_sensors);
        stopwatch.end_of(StepPhase::Integrate);
        worlds.iter_mut().for_each(|it| it.apply_pair_forces(SubstepHalf::Second));
        worlds.iter_mut().for_each(InteractingWorld::hold_locked);
        stopwatch.end_if(pull, StepPhase::PairForcesAfter);
    }
}

/// Solves the constraints of all worlds at the same time.
fn solve_together(
    worlds: &mut [InteractingWorld<'_>],
    (multi_world, pack_key): &mut Together<'_>,
    index: SubstepIndex,
) {
    crate::scope::scope!("tumble::solve");
    let Some(settings) = worlds.first().map(|it| it.settings) else { return };
    let counts = worlds.iter().map(|it| it.interactions.constrained.counts());
    multi_world.begin(counts.fold([0; 2], |[a, b], [c, d]| [a + c, b + d]));
    for InteractingWorld { columns, settings, laws, interactions, clock } in &mut *worlds {
        let Interactions { collision, constrained, mechanisms, pairs, .. } = &mut **interactions;
        if let Some(collision) = collision {
            let inputs = (*settings, *laws, time_of(clock, settings, index));
            let (contacts, pairs) = (&mut collision.contacts, pairs.as_ref());
            let constraints = Constraints { bodies: constrained, contacts, mechanisms, pairs };
            multi_world.add(constraints, &collision.body_index, columns, inputs);
        }
    }
    multi_world.solve_substeps(settings, pack_key.extras);
    for it in worlds {
        if let Some(collision) = &mut it.interactions.collision {
            multi_world.return_impulses(&mut collision.contacts.records);
        }
        it.scatter(multi_world.solver());
    }
}

/// When a substep begins \[s\].
fn time_of(clock: &Clock, settings: &Settings, SubstepIndex { step, substep }: SubstepIndex) -> f64 {
    clock.time_after(step) + f64::from(substep) * f64::from(settings.substep())
}

/// Adds gravity to the wrench of a body that woke within a step.
fn accumulate_forces_of_one(columns: &mut WorldColumns<'_>, place: RowPlace, settings: &Settings) {
    if let Some(columns) = columns.dynamic_mut(place) {
        columns.chunk().accumulate_gravity(place.row as usize, settings.gravity);
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
        interactions.update(world);
        Self::of_known(world, settings, laws, interactions, clock)
    }

    /// The same of a world in which nothing was spawned, despawned or changed but component values
    /// since.
    pub(crate) fn of_known(
        world: &'a World,
        settings: &'a Settings,
        laws: &'a ForceLaws,
        interactions: &'a mut Interactions,
        clock: Clock,
    ) -> Self {
        Self { columns: laws.columns_of(world), settings, laws, interactions, clock }
    }

    /// Wakes what was disturbed since the last step, and puts to sleep what is at rest.
    pub(crate) fn update_sleep(&mut self) {
        let Self { columns, settings, laws, interactions, .. } = self;
        let Interactions { collision, mechanisms, pairs, .. } = &mut **interactions;
        if let Some(collision) = collision {
            let is_pulled = |entity: u32| pairs.as_ref().is_some_and(|pairs| pairs.act_on(entity));
            collision.update_sleep(columns, (settings, laws), &mechanisms.list, is_pulled);
        }
    }

    /// Copies the poses before the step.
    pub(crate) fn remember_poses(&mut self) {
        self.columns.for_each_chunk(|_, bodies| remember_poses_of(bodies));
    }

    /// Adds gravity to the wrenches.
    pub(crate) fn accumulate_forces(&mut self) {
        let gravity = self.settings.gravity;
        let collision = self.interactions.collision.as_ref();
        match collision.map(|it| (&it.body_index, &it.sleepers.asleep)).filter(|(_, asleep)| !asleep.is_empty()) {
            Some((body_index, asleep)) => self.columns.for_each_chunk(|archetype, bodies| {
                let slots = body_index.slots_in(archetype);
                let first = bodies.first_row;
                let is_awake = |i: usize| slots.get(first + i).is_none_or(|slot| !asleep.has(*slot));
                accumulate_forces_where(bodies, gravity, is_awake);
            }),
            None => self.columns.for_each_chunk(|_, bodies| accumulate_forces_of(bodies, gravity)),
        }
    }

    /// Changes momenta by the forces between bodies, over half of a substep; over all of it in the
    /// first half where the integrator is of first order.
    pub(crate) fn apply_pair_forces(&mut self, half: SubstepHalf) {
        let h = self.settings.substep();
        let kicks = self.settings.integrator.pair_kicks(h);
        let Some(duration) = kicks[usize::from(half == SubstepHalf::Second)] else { return };
        if let Some(pairs) = &mut self.interactions.pairs {
            crate::scope::scope!("tumble::pairs");
            pairs.apply(&mut self.columns, duration, h);
        }
    }

    /// Finds the contacts, and the bodies that they constrain.
    pub(crate) fn find_contacts(&mut self) {
        let Interactions { collision, constrained, mechanisms, .. } = &mut *self.interactions;
        match collision {
            Some(collision) => {
                crate::scope::scope!("tumble::find_contacts");
                for slot in collision.find_contacts(&self.columns, self.settings, &mechanisms.list) {
                    accumulate_forces_of_one(&mut self.columns, collision.body_index.place(slot), self.settings);
                }
                let (body_index, asleep) = (&collision.body_index, &collision.sleepers.asleep);
                let pairs = collision.contacts.records.iter().map(|contact| contact.slots);
                let pairs = pairs.chain(mechanisms.pairs(body_index, &self.columns, asleep));
                constrained.find(pairs, body_index, &self.columns, asleep);
            }
            None => constrained.clear(),
        }
    }

    /// Advances the constrained bodies over a substep.
    pub(crate) fn solve(&mut self, index: SubstepIndex) {
        let Interactions { collision, constrained, solver, mechanisms, pairs, .. } = &mut *self.interactions;
        if let Some(collision) = collision.as_mut().filter(|_| !constrained.is_empty()) {
            crate::scope::scope!("tumble::solve");
            let inputs = (self.settings, self.laws, time_of(&self.clock, self.settings, index));
            let mut taken = solver.take().unwrap_or_default();
            let (contacts, pairs) = (&mut collision.contacts, pairs.as_ref());
            let constraints = Constraints { bodies: constrained, contacts, mechanisms, pairs };
            taken.solve_world(constraints, &collision.body_index, &mut self.columns, inputs);
            self.scatter(&taken);
            self.interactions.solver = Some(taken);
        }
    }

    /// Writes the constrained bodies back to the world.
    fn scatter(&mut self, solver: &Solver) {
        let Interactions { collision, constrained, .. } = &*self.interactions;
        if let Some(collision) = collision {
            scatter(constrained, &collision.body_index, &mut self.columns, solver.results());
        }
    }

    /// Integrates the bodies that nothing constrains over a substep, and in the last one consumes
    /// the wrenches of all.
    pub(crate) fn integrate(&mut self, index: SubstepIndex) {
        let one = Settings { dt: self.settings.substep(), substeps: 1, ..*self.settings };
        let (time, wrenches) = (time_of(&self.clock, self.settings, index), self.wrenches(index));
        let Self { columns, laws, interactions, .. } = self;
        let Interactions { collision, constrained, .. } = &**interactions;
        let constraints = collision.as_ref().map(|collision| (constrained, &collision.body_index));
        laws.for_each_chunk_of(columns, |archetype, bodies, laws| {
            let constrained =
                constraints.map(|(constrained, body_index)| (constrained, body_index.slots_in(archetype)));
            integrate_unconstrained(bodies, laws, &one, (time, wrenches), constrained);
        });
    }

    /// Wrenches act in all substeps of a step, and are consumed by the last.
    fn wrenches(&self, index: SubstepIndex) -> Wrenches {
        if index.substep + 1 == self.settings.substeps { Wrenches::Consumed } else { Wrenches::Kept }
    }

    /// Writes what joints carry to those that want to know, and which of them broke.
    fn write_joint_loads(&mut self) {
        let Interactions { mechanisms, collision, .. } = &mut *self.interactions;
        let of_idle = mechanisms.list.idle_loads.iter().map(|place| (*place, JointLoad::default()));
        // Those that sleep carry what they did.
        let sleeps = |slot: &Slot| collision.as_ref().is_some_and(|it| it.sleepers.asleep.has(*slot));
        let of_others = mechanisms.joint_loads(self.settings.dt);
        let of_others = of_others.filter(|(joint, _)| !joint.slots.iter().any(sleeps));
        let of_others = of_others.map(|(joint, load)| (joint.place, load));
        for (place, load) in of_idle.chain(of_others) {
            let column = self.columns.archetype(place).get::<&mut JointLoad>();
            column.into_iter().for_each(|mut column| column[place.row as usize] = load);
        }
        if mechanisms.mark_broken(self.settings.dt) {
            let breakable =
                mechanisms.list.joints.iter().filter_map(|joint| joint.breakable.map(|it| (joint.place, it)));
            for (place, it) in breakable.filter(|(_, it)| it.is_broken) {
                let column = self.columns.archetype(place).get::<&mut Breakable>();
                column.into_iter().for_each(|mut column| column[place.row as usize] = it);
            }
            let same_pairs = mechanisms.list.leave_out_broken();
            if let Some(collision) = collision.as_mut().filter(|_| !same_pairs) {
                collision.broad_phase.reset();
            }
        }
    }

    pub(crate) fn move_kinematic(&mut self, index: SubstepIndex) {
        self.columns.move_kinematic_bodies(self.settings.substep(), index.substep);
    }

    /// Puts back what would be through something else.
    pub(crate) fn stop_crossings(&mut self) {
        let Interactions { collision, mechanisms, .. } = &mut *self.interactions;
        if let Some(collision) = collision {
            collision.stop_crossings(&mut self.columns, &mechanisms.list, self.settings);
        }
    }

    /// Takes from momenta what locked axes do not let be.
    pub(crate) fn hold_locked(&mut self) {
        let Interactions { collision, constrained, .. } = &*self.interactions;
        if let Some(collision) = collision {
            hold_locked(constrained, &collision.body_index, &mut self.columns);
        }
    }

    /// Finds out what is in sensors.
    pub(crate) fn update_sensors(&mut self) {
        if let Some(collision) = &mut self.interactions.collision {
            collision.update_sensors(&self.columns, self.settings.substep());
        }
    }

    /// The end of a step.
    pub(crate) fn update_derived(&mut self) {
        if let Some(collision) = &mut self.interactions.collision {
            collision.notice_ways(&self.columns, self.settings.dt);
        }
        self.write_joint_loads();
        self.columns.for_each_chunk(|_, bodies| update_derived_of(bodies));
    }
}
