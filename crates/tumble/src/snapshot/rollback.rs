//! A bounded queue of recent snapshots for rollback to an earlier step.

use std::collections::VecDeque;

use hecs::{Entity, World};

use crate::snapshot::Snapshot;
use crate::snapshot::error::SnapshotError;
use crate::snapshot::row_map::Matching;
use crate::step::simulation::Simulation;
use crate::step::systems::update_derived;

/// The last snapshots of a run, to go back to when an input arrives late.
///
/// It holds the state of this many steps, 64 bytes a body and step in single precision, 112 in
/// double, 192 or 352 a contact, and 24 a joint that can break ([`memory`](Self::memory) says how
/// much it is), and uses the room of those that it drops: once it is full and while the same bodies
/// are in the world, saving allocates nothing.
///
/// Save before the inputs of a step are added and the step is taken; to correct an input, rewind to
/// its step and do the same again.
///
/// ```
/// use tumble::Rollback;
/// use tumble::prelude::*;
///
/// let mut world = hecs::World::new();
/// let ship =
///     RigidBody::new(Shape::sphere(1.0)).mass(2.0).id(BodyId(1)).build()?.spawn(&mut world);
/// let mut simulation = Simulation::new(Settings::default().with_gravity(Vec3::ZERO))?;
/// let mut rollback = Rollback::new(8);
/// let mut thrusts = [Vec3::ZERO; 5];
///
/// let mut play = |from: u64, thrusts: &[Vec3; 5]| -> Result<f32, Box<dyn std::error::Error>> {
///     if from < simulation.steps() {
///         rollback.rewind_to_step(from, &mut world, &mut simulation)?;
///     }
///     while let Some(&thrust) = thrusts.get(simulation.steps() as usize) {
///         rollback.save(&world, &simulation)?;
///         world.get::<&mut Wrench>(ship)?.add_force(thrust);
///         simulation.step(&mut world);
///     }
///     Ok(world.get::<&Momentum>(ship)?.linear.x as f32)
/// };
/// assert_eq!(play(0, &thrusts)?, 0.0);
/// thrusts[2] = Vec3::X * 60.0; // heard of only now
/// assert!((play(2, &thrusts)? - 1.0).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias("netcode", "rewind"))]
#[derive(Clone, Debug)]
pub struct Rollback {
    most: usize,
    /// The oldest first. Each has a clock, of a later step than the one before it.
    kept: VecDeque<Snapshot>,
    /// Buffers of dropped snapshots.
    spare: Vec<Snapshot>,
    matching: Matching,
}

impl Rollback {
    /// Keeps the last `most` saves; with zero none.
    pub fn new(most: usize) -> Self {
        Self { most, kept: VecDeque::new(), spare: Vec::new(), matching: Matching::default() }
    }

    /// Keeps the state, the contacts and the time as they are now. What was saved at this step or a
    /// later one is replaced, and the oldest dropped if there is no more room.
    ///
    /// # Errors
    /// As [`Snapshot::capture`]; nothing is saved then, and what had to go for it is gone.
    pub fn save(&mut self, world: &World, simulation: &Simulation) -> Result<(), SnapshotError> {
        while self.kept.back().is_some_and(|last| step_of(last) >= simulation.steps()) {
            self.spare.extend(self.kept.pop_back());
        }
        if self.kept.len() >= self.most {
            self.spare.extend(self.kept.pop_front());
        }
        if self.most == 0 {
            return Ok(());
        }
        let mut snapshot = self.spare.pop().unwrap_or_default();
        let captured = simulation.take_snapshot(world, &mut snapshot);
        match captured {
            Ok(()) => self.kept.push_back(snapshot),
            Err(_) => self.spare.push(snapshot),
        }
        captured
    }

    /// Goes `saves` saves back, 0 being the last, and drops the later ones. Time and contacts are
    /// set back too, and the derived quantities are [updated](update_derived). Returns the bodies
    /// that were spawned since, which are the caller's to despawn; see [`Snapshot::restore`].
    ///
    /// # Errors
    /// [`RollbackError`] where that many saves are not kept, or the world lacks bodies; world,
    /// simulation and saves are unchanged then, so the caller may spawn what is missing and rewind
    /// again.
    pub fn rewind(
        &mut self,
        saves: usize,
        world: &mut World,
        simulation: &mut Simulation,
    ) -> Result<Vec<Entity>, RollbackError> {
        let not_kept = RollbackError::NotKept { saves, kept: self.kept.len() };
        let snapshot = self.kept.iter().nth_back(saves).ok_or(not_kept)?;
        let spawned_since = simulation.restore_with(snapshot, world, &mut self.matching)?;
        update_derived(world);
        self.spare.extend(self.kept.drain(self.kept.len() - saves..));
        Ok(spawned_since)
    }

    /// [`rewind`](Self::rewind) to the start of a step, counted from zero: to when
    /// [`Simulation::steps`] was `step`.
    ///
    /// # Errors
    /// As [`rewind`](Self::rewind).
    pub fn rewind_to_step(
        &mut self,
        step: u64,
        world: &mut World,
        simulation: &mut Simulation,
    ) -> Result<Vec<Entity>, RollbackError> {
        let saves = self.saves_since(step).ok_or(RollbackError::NoSuchStep { step, kept: self.steps_kept() })?;
        self.rewind(saves, world, simulation)
    }

    /// The snapshot this many saves back, 0 being the last.
    pub fn snapshot(&self, saves: usize) -> Option<&Snapshot> {
        self.kept.iter().nth_back(saves)
    }

    /// The snapshot of the start of a step.
    pub fn at_step(&self, step: u64) -> Option<&Snapshot> {
        self.snapshot(self.saves_since(step)?)
    }

    /// How many are kept now.
    pub fn len(&self) -> usize {
        self.kept.len()
    }

    /// Whether nothing is kept.
    pub fn is_empty(&self) -> bool {
        self.kept.is_empty()
    }

    /// Bytes of memory that it holds, with all its buffers.
    pub fn memory(&self) -> usize {
        let snapshots: usize = self.kept.iter().chain(&self.spare).map(Snapshot::memory).sum();
        let unused = self.kept.capacity() + self.spare.capacity() - self.kept.len() - self.spare.len();
        size_of::<Self>() + snapshots + unused * size_of::<Snapshot>() + self.matching.memory()
    }

    /// How many saves there were after that of this step.
    fn saves_since(&self, step: u64) -> Option<usize> {
        let index = self.kept.binary_search_by_key(&step, step_of).ok()?;
        Some(self.kept.len() - 1 - index)
    }

    /// The first and the last step that is kept.
    fn steps_kept(&self) -> Option<(u64, u64)> {
        Some((step_of(self.kept.front()?), step_of(self.kept.back()?)))
    }
}

fn step_of(snapshot: &Snapshot) -> u64 {
    snapshot.clock().map_or(0, |clock| clock.steps())
}

/// Why a [`Rollback`] cannot go back.
///
/// ```
/// # use tumble::{Rollback, RollbackError, Settings, Simulation};
/// # let mut world = hecs::World::new();
/// let mut simulation = Simulation::new(Settings::default())?;
/// let mut rollback = Rollback::new(4);
/// rollback.save(&world, &simulation)?;
/// let error = rollback.rewind(1, &mut world, &mut simulation).unwrap_err();
/// assert_eq!(error, RollbackError::NotKept { saves: 1, kept: 1 });
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RollbackError {
    /// Fewer snapshots are kept than that.
    #[error("cannot go {saves} saves back with {kept} kept")]
    NotKept {
        /// How many saves back.
        saves: usize,
        /// How many are kept.
        kept: usize,
    },
    /// The start of this step is not kept: too long ago, or never saved.
    #[error("step {step} is not kept; {}", kept.map_or_else(|| "nothing is".to_owned(), |(first, last)| format!("steps {first} to {last} are")))]
    NoSuchStep {
        /// The step.
        step: u64,
        /// The first and the last step that is kept.
        kept: Option<(u64, u64)>,
    },
    /// The snapshot does not fit the world.
    #[error(transparent)]
    Snapshot(#[from] SnapshotError),
}

tumble_math::debug_as_display!(RollbackError);
