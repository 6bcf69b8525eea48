//! The energy ledger: totals of energy and momentum, and work by source, recorded over a run.

use hecs::{Entity, World};

use crate::components::{Mass, Momentum, Pose, Work, Wrench};
use crate::energy::totals::Totals;
use crate::forces::force_context::ForceContext;
use crate::forces::force_law::BodyState;
use crate::integrators::state::{State, moving_body};
use crate::step::simulation::Simulation;
use crate::storage::body_order::BodyOrder;

/// Keeps the books of a simulation: energy and momentum, and the work that each source of force has
/// done.
///
/// While it is attached, every step adds up the work on each body, so that the change of kinetic
/// energy in steps is the sum of works, to rounding; whatever no force did is the integrator's own
/// error. What changes between steps, by an impulse or another mass, has an entry of its own,
/// [`LedgerEntry::between_steps`]. Sums over bodies are taken in [`BodyOrder`]. A world that no
/// ledger was attached to pays nothing.
///
/// ```
/// use tumble::prelude::*;
/// use tumble::Ledger;
///
/// let mut world = hecs::World::new();
/// RigidBody::new(Shape::sphere(0.1)).mass(2.0).build()?.spawn(&mut world);
/// let mut simulation = Simulation::new(Settings::default())?;
/// let mut ledger = Ledger::attach(&mut world, &simulation);
/// for _ in 0..60 {
///     simulation.step(&mut world);
/// }
/// let entry = ledger.record(&world, &simulation);
/// // A second of fall: kinetic energy m (g t)^2/2, all of it gravity's work.
/// assert!((entry.work.gravity - 9.81 * 9.81).abs() < 1e-3);
/// assert!((entry.totals.energy() + entry.law_potential).abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Ledger {
    order: BodyOrder,
    laws: Vec<&'static str>,
    keeps_work: bool,
    entries: Vec<LedgerEntry>,
}

/// The books at one moment.
///
/// ```
/// # use tumble::prelude::*;
/// # let mut world = hecs::World::new();
/// RigidBody::new(Shape::sphere(0.1)).mass(1.0).build()?.spawn(&mut world);
/// let mut simulation = Simulation::new(Settings::default())?;
/// let mut ledger = Ledger::watch(&world, &simulation);
/// simulation.step_many(&mut world, 60);
/// let entry = ledger.record(&world, &simulation);
/// assert_eq!(entry.step, 60);
/// assert!((entry.kinetic() - 0.5 * 9.81 * 9.81).abs() < 1e-3 && entry.energy().abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct LedgerEntry {
    /// Steps taken.
    pub step: u64,
    /// Simulated time \[s\].
    pub time: f64,
    /// Energy in gravity, momentum, and the first body whose state is not finite.
    pub totals: Totals,
    /// Potential energy in the force laws \[J\].
    pub law_potential: f64,
    /// Work done since the ledger was attached \[J\].
    pub work: Work,
    /// What changed the kinetic energy since then between steps \[J\]: impulses on [`Momentum`],
    /// other [mass properties](crate::change_mass_properties), bodies that are gone. It is the
    /// change of kinetic energy that no work accounts for, so the roundings of all sums are in it.
    /// Zero in books without work.
    pub between_steps: f64,
}

impl LedgerEntry {
    /// Kinetic energy \[J\].
    pub fn kinetic(&self) -> f64 {
        self.totals.kinetic()
    }

    /// Kinetic and potential energy \[J\], with the laws' potentials.
    pub fn energy(&self) -> f64 {
        self.totals.energy() + self.law_potential
    }
}

impl Ledger {
    /// Opens the books: every moving body gets a [`Work`] component of zeros, and the first entry
    /// is made.
    ///
    /// Bodies spawned later are not in the books. A world has one ledger at a time: attaching
    /// another ends the first one's sums.
    pub fn attach(world: &mut World, simulation: &Simulation) -> Self {
        type Moving<'a> = (&'a Pose, &'a Momentum, &'a Mass, &'a Wrench);
        let moving: Vec<Entity> =
            world.query_mut::<(Entity, Moving<'_>)>().into_iter().map(|(entity, _)| entity).collect();
        for entity in moving {
            // The entity was found in this world a moment ago, so inserting cannot fail.
            let inserted = world.insert_one(entity, Work::default());
            debug_assert!(inserted.is_ok());
        }
        Self::open(world, simulation, true)
    }

    /// Opens books in which energy and momentum are entered but no work: the world stays as it is,
    /// and steps cost what they did.
    pub fn watch(world: &World, simulation: &Simulation) -> Self {
        Self::open(world, simulation, false)
    }

    fn open(world: &World, simulation: &Simulation, keeps_work: bool) -> Self {
        let laws = simulation.laws().names().collect();
        let mut ledger = Self { order: BodyOrder::of(world), laws, keeps_work, entries: Vec::new() };
        ledger.record(world, simulation);
        ledger
    }

    /// Takes the [`Work`] components away, so that steps cost what they did before.
    pub fn detach(&self, world: &mut World) {
        for &entity in self.order.entities() {
            // A body that is gone or was never booked has none to take.
            let _ = world.remove_one::<Work>(entity);
        }
    }

    /// Makes an entry of how things stand now.
    pub fn record(&mut self, world: &World, simulation: &Simulation) -> LedgerEntry {
        let work = self.work(world);
        let law_potential = self.law_potential(world, simulation);
        let totals = Totals::of(world, simulation.settings(), &self.order);
        let first = self.entries.first().filter(|_| self.keeps_work);
        let entry = LedgerEntry {
            step: simulation.steps(),
            time: simulation.time(),
            totals,
            law_potential,
            work,
            between_steps: first.map_or(0.0, |first| totals.kinetic() - first.kinetic() - work.total()),
        };
        self.entries.push(entry);
        entry
    }

    /// The work on all bodies; one that is not finite is named in the totals and left out of all
    /// sums.
    fn work(&self, world: &World) -> Work {
        let mut query = world.query::<(&Pose, &Momentum, &Mass, &Work)>();
        let bodies = query.view();
        let blocks = self.order.in_blocks(|block| {
            let mut sum = Work::default();
            for (pose, momentum, _, work) in block.iter().filter_map(|&entity| bodies.get(entity)) {
                if State::new(pose, momentum).is_finite() {
                    sum += *work;
                }
            }
            sum
        });
        let mut sum = Work::default();
        blocks.into_iter().for_each(|block| sum += block);
        sum
    }

    /// The energy \[J\] in the laws that were added.
    fn law_potential(&self, world: &World, simulation: &Simulation) -> f64 {
        let mut sum = 0.0;
        if simulation.laws().is_empty() {
            return sum;
        }
        for body in self.order.entities().iter().filter_map(|&entity| world.entity(entity).ok()) {
            if let Some((constants, state)) = moving_body(body).filter(|(_, state)| state.is_finite()) {
                let context = ForceContext::of_body(body, simulation.settings());
                let seen = BodyState::new((simulation.time(), 0.0), (&constants, &context), &state);
                sum += simulation.laws().potential(body, &seen);
            }
        }
        sum
    }

    /// All entries, the first from when the ledger was attached.
    pub fn entries(&self) -> &[LedgerEntry] {
        &self.entries
    }

    /// The type names of the force laws, in the order of [`Work::laws`].
    pub fn laws(&self) -> &[&'static str] {
        &self.laws
    }
}
