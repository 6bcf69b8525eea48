//! A step taken phase by phase, with the caller's systems between them.

use std::fmt;

use hecs::World;

use crate::components::Wrenches;
use crate::forces::under_laws::for_each_chunk_under;
use crate::step::interacting::{SubstepHalf, SubstepIndex};
use crate::step::population::Population;
use crate::step::simulation::Simulation;
use crate::step::systems::{
    accumulate_forces, integrate_bodies, move_kinematic_bodies, remember_poses, update_derived,
};
use crate::threads::Effort;

/// A phase of a step, in the order in which they run.
///
/// Where bodies have colliders or act on each other by forces, all phases run, and those from
/// [`PairForcesBefore`](Self::PairForcesBefore) to [`PairForcesAfter`](Self::PairForcesAfter) once
/// in each of [`Settings::substeps`](crate::Settings::substeps). Elsewhere
/// there are no pair forces and contacts, and each of the other phases runs once.
///
/// ```
/// use tumble::prelude::*;
/// use tumble::StepPhase;
///
/// let mut world = hecs::World::new();
/// RigidBody::new(Shape::sphere(0.1)).mass(2.0).build()?.spawn(&mut world);
/// let mut simulation = Simulation::new(Settings::default())?;
/// let mut step = simulation.begin_step(&mut world);
/// assert_eq!(step.next_phase(), Some(StepPhase::RememberPoses));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum StepPhase {
    /// Copies the [`Pose`](crate::Pose) of each moving body to its
    /// [`PreviousPose`](crate::PreviousPose); those of kinematic bodies follow when they move.
    RememberPoses,
    /// Adds gravity to each [`Wrench`](crate::Wrench): [`accumulate_forces`].
    AccumulateForces,
    /// Changes momenta by springs and the gravity of bodies, for the first half of the substep; for
    /// all of it with [`SemiImplicitEuler`](crate::Integrator::SemiImplicitEuler).
    PairForcesBefore,
    /// Finds the contacts of the substep.
    FindContacts,
    /// Advances momenta and poses of the bodies that have contacts or joints, under these and all
    /// forces.
    SolveContacts,
    /// Advances momenta and poses of the other moving bodies: [`integrate`](crate::integrate).
    Integrate,
    /// Moves the kinematic bodies: [`move_kinematic_bodies`].
    MoveKinematic,
    /// Finds out what is in [sensors](crate::Collider::sensor), and changes momenta by springs and
    /// the gravity of bodies, for the second half of the substep.
    PairForcesAfter,
    /// Derives [`Velocity`](crate::Velocity) and [`InverseInertia`](crate::InverseInertia):
    /// [`update_derived`].
    UpdateDerived,
}

impl StepPhase {
    pub(crate) const COUNT: usize = Self::UpdateDerived as usize + 1;
}

/// A step that is taken phase by phase: [`Simulation::begin_step`].
///
/// Between two phases the world can be read, and the values of components changed, through
/// [`world`](Self::world); what is spawned, despawned, inserted or removed waits for the end of the
/// step. A changed [`Collider`](crate::Collider), [`CenterOfMass`](crate::CenterOfMass) of a
/// collider's body, [`Spring`](crate::Spring), [`Joint`](crate::Joint),
/// [`GravityMass`](crate::GravityMass) or [`BodyId`](crate::BodyId) counts from the next step on.
/// Forces of this step are to be added before [`SolveContacts`](StepPhase::SolveContacts); after
/// it, bodies with contacts or joints take no more. Phases that are left when it is dropped run
/// then, unless a panic drops it. One that is cut off by a panic or leaked leaves the world between
/// two phases: restore a snapshot, or set what forces have added to each [`Wrench`](crate::Wrench)
/// to zero.
///
/// The bits are those of [`Simulation::step`]; it takes longer, since each phase looks up the
/// components again.
///
/// ```
/// # use tumble::prelude::*;
/// # let mut world = hecs::World::new();
/// # RigidBody::new(Shape::sphere(0.1)).mass(2.0).build()?.spawn(&mut world);
/// # let mut simulation = Simulation::new(Settings::default())?;
/// let mut step = simulation.begin_step(&mut world);
/// while let Some(phase) = step.run_phase() {
///     println!("after {phase:?}: {} bodies", step.world().len());
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use = "a step that is dropped at once is taken as a whole"]
pub struct Step<'a> {
    simulation: &'a mut Simulation,
    world: &'a mut World,
    effort: Effort,
    population: Population,
    next: Option<StepPhase>,
    substep: u32,
    /// Whether the thread was unwinding when the step began.
    began_unwinding: bool,
}

impl Simulation {
    /// Begins a step that the caller takes phase by phase, to put systems of its own in between.
    ///
    /// ```
    /// use tumble::prelude::*;
    /// use tumble::StepPhase;
    ///
    /// let mut world = hecs::World::new();
    /// let stone = RigidBody::new(Shape::sphere(0.1)).mass(2.0).build()?.spawn(&mut world);
    /// let mut simulation = Simulation::new(Settings::default())?;
    ///
    /// let mut step = simulation.begin_step(&mut world);
    /// while let Some(phase) = step.run_phase() {
    ///     if phase == StepPhase::AccumulateForces {
    ///         // A system of one's own: nothing falls.
    ///         for wrench in step.world().query::<&mut Wrench>().iter() {
    ///             wrench.force = Vec3::ZERO;
    ///         }
    ///     }
    /// }
    /// drop(step);
    /// assert_eq!(world.get::<&Momentum>(stone)?.linear, Vec3::ZERO);
    /// assert_eq!(simulation.steps(), 1);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn begin_step<'a>(&'a mut self, world: &'a mut World) -> Step<'a> {
        self.forget_events();
        self.has_stepped = false;
        let population = Population::of(world, self.laws());
        let effort = population.effort(self.collision(), 1);
        if population.interacts() {
            let interactions = self.interactions.get_or_insert_default();
            interactions.update(world);
            interactions.begin_step();
        } else if let Some(interactions) = &mut self.interactions {
            interactions.pass(world, 1);
        }
        Step {
            simulation: self,
            world,
            effort,
            population,
            next: Some(StepPhase::RememberPoses),
            substep: 0,
            began_unwinding: std::thread::panicking(),
        }
    }
}

impl fmt::Debug for Step<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Step").field("next", &self.next).field("substep", &self.substep).finish_non_exhaustive()
    }
}

impl Step<'_> {
    /// The phase that is next; `None` where the step is done.
    pub fn next_phase(&self) -> Option<StepPhase> {
        self.next
    }

    /// Runs the next phase, and returns which it was; `None` where the step was done.
    pub fn run_phase(&mut self) -> Option<StepPhase> {
        let phase = self.next?;
        let Self { simulation, world, population, substep, .. } = self;
        let (simulation, world, substep) = (&mut **simulation, &mut **world, *substep);
        if population.interacts() {
            self.effort.run(|| run_interacting(simulation, world, phase, substep));
        } else {
            self.effort.run(|| run_without_interactions(simulation, world, (population, phase)));
        }
        self.next = self.after(phase);
        if self.next.is_none() {
            self.simulation.has_stepped = true;
            self.simulation.count_steps(1);
        }
        Some(phase)
    }

    /// The substep that the next phase belongs to, from 0.
    pub fn substep(&self) -> u32 {
        self.substep
    }

    /// The world as the last phase left it. Components can be changed through
    /// [`World::query`](hecs::World::query) and [`World::get`](hecs::World::get).
    pub fn world(&self) -> &World {
        self.world
    }

    /// The simulation. [`contacts`](Simulation::contacts) are those of this substep from
    /// [`FindContacts`](StepPhase::FindContacts) on; until
    /// [`SolveContacts`](StepPhase::SolveContacts) their impulses are those that they begin with,
    /// so whether they touch is not known. There are no events until the step is done.
    pub fn simulation(&self) -> &Simulation {
        self.simulation
    }

    /// Runs the phases that are left.
    pub fn finish(mut self) {
        self.run_all();
    }

    fn run_all(&mut self) {
        while self.run_phase().is_some() {}
    }

    /// The phase after a phase; counts the substeps.
    fn after(&mut self, phase: StepPhase) -> Option<StepPhase> {
        Some(match phase {
            StepPhase::RememberPoses => StepPhase::AccumulateForces,
            StepPhase::AccumulateForces if self.population.interacts() => StepPhase::PairForcesBefore,
            StepPhase::AccumulateForces => StepPhase::Integrate,
            StepPhase::PairForcesBefore => StepPhase::FindContacts,
            StepPhase::FindContacts => StepPhase::SolveContacts,
            StepPhase::SolveContacts => StepPhase::Integrate,
            StepPhase::Integrate => StepPhase::MoveKinematic,
            StepPhase::MoveKinematic if self.population.interacts() => StepPhase::PairForcesAfter,
            StepPhase::MoveKinematic => StepPhase::UpdateDerived,
            StepPhase::PairForcesAfter if self.substep + 1 < self.simulation.settings().substeps => {
                self.substep += 1;
                StepPhase::PairForcesBefore
            }
            StepPhase::PairForcesAfter => StepPhase::UpdateDerived,
            StepPhase::UpdateDerived => return None,
        })
    }
}

impl Drop for Step<'_> {
    fn drop(&mut self) {
        if self.began_unwinding || !std::thread::panicking() {
            self.run_all();
        }
    }
}

/// Of a world in which bodies act on each other.
fn run_interacting(simulation: &mut Simulation, world: &mut World, phase: StepPhase, substep: u32) {
    let index = SubstepIndex { step: 0, substep };
    let mut it = simulation.interacting_as_known(world);
    match phase {
        StepPhase::RememberPoses => {
            it.update_sleep();
            it.remember_poses();
        }
        StepPhase::AccumulateForces => it.accumulate_forces(),
        StepPhase::PairForcesBefore => it.apply_pair_forces(SubstepHalf::First),
        StepPhase::FindContacts => it.find_contacts(),
        StepPhase::SolveContacts => it.solve(index),
        StepPhase::Integrate => it.integrate(index),
        StepPhase::MoveKinematic => it.move_kinematic(index),
        StepPhase::PairForcesAfter => {
            it.stop_crossings();
            it.update_sensors();
            it.apply_pair_forces(SubstepHalf::Second);
            it.hold_locked();
        }
        StepPhase::UpdateDerived => it.update_derived(),
    }
}

/// Of a world in which they do not.
fn run_without_interactions(simulation: &Simulation, world: &mut World, (population, phase): (&Population, StepPhase)) {
    let (settings, laws, time) = (simulation.settings(), simulation.laws(), simulation.time());
    match phase {
        StepPhase::RememberPoses => remember_poses(world),
        StepPhase::AccumulateForces => accumulate_forces(world, settings.gravity),
        StepPhase::Integrate => for_each_chunk_under(world, (laws, population.are_under_laws()), |bodies, laws| {
            integrate_bodies(bodies, laws, settings, time, Wrenches::Consumed);
        }),
        StepPhase::MoveKinematic => move_kinematic_bodies(world, settings.dt),
        StepPhase::UpdateDerived => update_derived(world),
        StepPhase::PairForcesBefore
        | StepPhase::FindContacts
        | StepPhase::SolveContacts
        | StepPhase::PairForcesAfter => {}
    }
}
