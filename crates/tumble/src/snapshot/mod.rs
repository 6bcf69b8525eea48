//! The state of all bodies at one moment, to come back to; rollback, hashes, states as arrays.

pub(crate) mod bytes;
pub(crate) mod contact_bytes;
pub(crate) mod error;
pub(crate) mod of_simulation;
pub(crate) mod rollback;
pub(crate) mod row_map;
pub(crate) mod saved_joints;
#[cfg(feature = "serde")]
mod serialize;
pub(crate) mod state_arrays;
pub(crate) mod state_hash;
pub(crate) mod state_rates;

pub use crate::clock::Clock;
pub use crate::snapshot::error::{ContactDefect, SnapshotError};
pub use crate::snapshot::rollback::{Rollback, RollbackError};
pub use crate::snapshot::state_arrays::{
    STATE_SIZE, StateArrayError, array_to_derived_state, array_to_state, state_to_array,
};
pub use crate::snapshot::state_hash::state_hash;
pub use crate::snapshot::state_rates::derivative_to_array;
pub use crate::storage::body_order::BodyOrder;

use crate::components::BodyKind;
pub(crate) use crate::snapshot::row_map::Matching;

use std::ops::Range;

use hecs::{Archetype, Entity, World};

use crate::collision::saved_contacts::SavedContacts;
use crate::components::{BodyId, Momentum, Pose, PreviousPose, Velocity, Wrench};
use crate::math::Real;
use crate::snapshot::row_map::Run;
use crate::snapshot::saved_joints::SavedJoints;
use crate::snapshot::state_hash::{Fnv, canonical};

/// The state of all bodies of a world at one moment, by [`BodyId`].
///
/// It holds the [`Pose`] of every body that has a [`BodyId`], the [`Momentum`] of those that forces
/// move and the [`Velocity`] of kinematic ones: 64 bytes a body in single precision, 112 in double;
/// and which [`Breakable`](crate::Breakable) joints are broken. With a [`Clock`] and, where bodies
/// touch or are jointed, the contacts and the loads of joints, that is all that a run continues
/// from, to the bit: [`Simulation::snapshot`](crate::Simulation::snapshot) takes all of it. What is
/// no state is not in it: masses, laws, joints and other components, the settings, the caller's
/// own.
///
/// A joint is known by the [`BodyId`] of its entity, which may be that of a body too, or without
/// one by the entity; in another world that is the one that was spawned at the same place in the
/// sequence.
///
/// Bodies may be spawned and despawned, and gain and lose components, between capture and
/// [`restore`](Self::restore).
///
/// ```
/// use tumble::prelude::*;
/// use tumble::{BodyOrder, Snapshot, state_hash};
///
/// let mut world = hecs::World::new();
/// RigidBody::new(Shape::sphere(0.1)).mass(2.0).id(BodyId(7)).build()?.spawn(&mut world);
/// let mut simulation = Simulation::new(Settings::default())?;
///
/// let start = simulation.snapshot(&world)?;
/// simulation.step_many(&mut world, 10);
/// let there = Snapshot::capture(&world)?;
///
/// simulation.restore(&start, &mut world)?;
/// simulation.step_many(&mut world, 10);
/// assert_eq!(state_hash(&world, &BodyOrder::of(&world)), there.state_hash());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias("save", "serialize", "load"))]
#[derive(Clone, Debug, Default)]
pub struct Snapshot {
    /// One identity a row: moving bodies, then kinematic ones, then fixed ones. No two are the
    /// same.
    ids: Vec<BodyId>,
    /// One pose a row.
    poses: Vec<Pose>,
    /// Of the moving bodies, which are the first rows.
    momenta: Vec<Momentum>,
    /// Of the kinematic bodies, which come after.
    velocities: Vec<Velocity>,
    /// Where in the world the rows were, by archetype.
    segments: Vec<Segment>,
    clock: Option<Clock>,
    contacts: SavedContacts,
    joints: SavedJoints,
}

/// The rows of one archetype.
#[derive(Clone, Copy, Debug)]
struct Segment {
    /// The archetype's place among those of the world, which does not change while the world lives;
    /// `usize::MAX` where it is not known.
    archetype: usize,
    start: usize,
    len: usize,
}

impl Snapshot {
    /// The state of the world's bodies now, without the clock, contacts and loads of joints, which
    /// are the simulation's: see [`Simulation::snapshot`](crate::Simulation::snapshot). Take it
    /// between steps, before the [`Wrench`]es of the next are added: those are inputs, and not in
    /// it.
    ///
    /// Fixed bodies without a [`BodyId`] are scenery and left out. Like every query of hecs, it
    /// panics while the caller holds a mutable reference to one of the components.
    ///
    /// # Errors
    /// [`SnapshotError::Unidentified`] where a body that steps move has no [`BodyId`],
    /// [`SnapshotError::Duplicate`] where two have the same, and
    /// [`SnapshotError::DuplicateJoint`] where two breakable joints do.
    pub fn capture(world: &World) -> Result<Self, SnapshotError> {
        let mut snapshot = Self::default();
        snapshot.recapture(world)?;
        Ok(snapshot)
    }

    /// [`capture`](Self::capture) in the place of what it held, without a clock and contacts. It
    /// allocates nothing where it has held as many bodies before, and only checks identities that
    /// have changed.
    ///
    /// # Errors
    /// As [`capture`](Self::capture); the snapshot is empty then.
    pub fn recapture(&mut self, world: &World) -> Result<(), SnapshotError> {
        let captured = self.record(world);
        if captured.is_err() {
            self.ids.clear();
            self.forget_state();
        }
        captured
    }

    fn forget_state(&mut self) {
        self.poses.clear();
        self.momenta.clear();
        self.velocities.clear();
        self.segments.clear();
        self.clock = None;
        self.contacts.clear();
        self.joints.clear();
    }

    fn record(&mut self, world: &World) -> Result<(), SnapshotError> {
        refuse_unidentified(world)?;
        self.forget_state();
        self.reserve_for(world);
        let mut known = true;
        for kind in BodyKind::ALL {
            for (index, archetype) in world.archetypes().enumerate() {
                if BodyKind::of(archetype) == Some(kind) {
                    known &= self.record_archetype(index, archetype);
                }
            }
        }
        self.ids.truncate(self.poses.len());
        self.segments.sort_unstable_by_key(|segment| segment.archetype);
        // Identities that are where they were in the last capture were checked then.
        let duplicate = if known { None } else { first_duplicate(&self.ids) };
        duplicate.map_or(Ok(()), |id| Err(SnapshotError::Duplicate { id }))?;
        self.joints.record(world)
    }

    /// Room for exactly as many bodies as there are: growing by doubling would hold twice the
    /// memory for archetype after archetype.
    fn reserve_for(&mut self, world: &World) {
        let mut counts = [0; 3];
        for archetype in world.archetypes().filter(|archetype| archetype.has::<BodyId>()) {
            if let Some(kind) = BodyKind::of(archetype) {
                counts[kind as usize] += archetype.len() as usize;
            }
        }
        let bodies = counts.iter().sum();
        self.ids.reserve_exact(usize::saturating_sub(bodies, self.ids.len()));
        self.poses.reserve_exact(bodies);
        self.momenta.reserve_exact(counts[BodyKind::Moving as usize]);
        self.velocities.reserve_exact(counts[BodyKind::Kinematic as usize]);
    }

    /// Adds the rows of an archetype; whether their identities are those that were in their place
    /// before.
    fn record_archetype(&mut self, index: usize, archetype: &Archetype) -> bool {
        let (Some(ids), Some(poses)) = (archetype.get::<&BodyId>(), archetype.get::<&Pose>()) else { return true };
        let (start, len) = (self.poses.len(), ids.len());
        let known = self.ids.get(start..).is_some_and(|before| equal_from_the_start(before, &ids) == len);
        if !known {
            self.ids.truncate(start);
            self.ids.extend_from_slice(&ids);
        }
        self.poses.extend_from_slice(&poses);
        match BodyKind::of(archetype) {
            Some(BodyKind::Moving) => {
                archetype.get::<&Momentum>().into_iter().for_each(|column| self.momenta.extend_from_slice(&column));
            }
            Some(BodyKind::Kinematic) => {
                archetype.get::<&Velocity>().into_iter().for_each(|column| self.velocities.extend_from_slice(&column));
            }
            Some(BodyKind::Fixed) | None => {}
        }
        self.segments.push(Segment { archetype: index, start, len });
        known
    }

    /// Puts the world's bodies back to where they were, and returns those that were spawned since,
    /// by [`BodyId`]: they are left as they are, and it is the caller's to despawn them.
    ///
    /// Breakable joints break and hold again as they were; those that were spawned since are left
    /// as they are, and those that were despawned stay away.
    ///
    /// Pending [`Wrench`]es are zeroed and [`PreviousPose`] becomes the pose. As after every change
    /// of a momentum, the derived quantities follow with the next step, or with
    /// [`update_derived`](crate::update_derived) where something looks at them before. The
    /// [`clock`](Self::clock), contacts and loads of joints are the simulation's and not set here,
    /// but by [`Simulation::restore`](crate::Simulation::restore). The world need not be the one
    /// that was captured, if it has the same bodies.
    ///
    /// # Errors
    /// The world is unchanged where a body of the snapshot is not in it ([`SnapshotError::Missing`]
    /// names all), is of another kind, two bodies have the same [`BodyId`], or one that steps move
    /// has none.
    pub fn restore(&self, world: &mut World) -> Result<Vec<Entity>, SnapshotError> {
        self.restore_with(world, &mut Matching::default())
    }

    /// [`restore`](Self::restore) with buffers to use again.
    pub(crate) fn restore_with(
        &self,
        world: &mut World,
        matching: &mut Matching,
    ) -> Result<Vec<Entity>, SnapshotError> {
        refuse_unidentified(world)?;
        matching.find(self, world)?;
        let mut runs = matching.runs();
        for (index, archetype) in world.archetypes().enumerate() {
            let here = runs.iter().take_while(|run| run.archetype == index).count();
            let (of_archetype, rest) = runs.split_at(here);
            self.write(archetype, of_archetype);
            runs = rest;
        }
        self.joints.write(world);
        Ok(matching.newcomers(world))
    }

    /// Writes back rows of one archetype.
    fn write(&self, archetype: &Archetype, runs: &[Run]) {
        let Some(first) = runs.first() else { return };
        let Some(mut poses) = archetype.get::<&mut Pose>() else { return };
        for run in runs {
            poses[run.there()].copy_from_slice(&self.poses[run.here()]);
        }
        if let Some(mut previous) = archetype.get::<&mut PreviousPose>() {
            for row in runs.iter().flat_map(Run::there) {
                previous[row] = PreviousPose(poses[row]);
            }
        }
        match self.kind(first.row) {
            BodyKind::Moving => {
                if let Some(mut momenta) = archetype.get::<&mut Momentum>() {
                    for run in runs {
                        momenta[run.there()].copy_from_slice(&self.momenta[run.here()]);
                    }
                }
                if let Some(mut wrenches) = archetype.get::<&mut Wrench>() {
                    for run in runs {
                        wrenches[run.there()].fill(Wrench::default());
                    }
                }
            }
            BodyKind::Kinematic => {
                if let Some(mut velocities) = archetype.get::<&mut Velocity>() {
                    let moving = self.momenta.len();
                    for run in runs {
                        let here = run.here();
                        velocities[run.there()]
                            .copy_from_slice(&self.velocities[here.start - moving..here.end - moving]);
                    }
                }
            }
            BodyKind::Fixed => {}
        }
    }

    /// How many bodies.
    pub fn len(&self) -> usize {
        self.ids.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.ids.is_empty()
    }

    /// Which bodies, in no particular order.
    pub fn ids(&self) -> &[BodyId] {
        &self.ids
    }

    /// Bytes of memory that it holds, with the room that it keeps for the next
    /// [`recapture`](Self::recapture).
    pub fn memory(&self) -> usize {
        size_of::<Self>()
            + self.ids.capacity() * size_of::<BodyId>()
            + self.poses.capacity() * size_of::<Pose>()
            + self.momenta.capacity() * size_of::<Momentum>()
            + self.velocities.capacity() * size_of::<Velocity>()
            + self.segments.capacity() * size_of::<Segment>()
            + self.contacts.memory()
            + self.joints.memory()
    }

    /// The moment that it is of, where one was set.
    pub fn clock(&self) -> Option<Clock> {
        self.clock
    }

    /// Says which moment it is of: [`Simulation::clock`](crate::Simulation::clock) when it was
    /// captured.
    pub fn set_clock(&mut self, clock: Clock) {
        self.clock = Some(clock);
    }

    /// The same, of this moment.
    #[must_use]
    pub fn with_clock(self, clock: Clock) -> Self {
        Self { clock: Some(clock), ..self }
    }

    /// The hash that [`state_hash`](crate::state_hash()) gives the world when it is as it
    /// was, if all its bodies have a [`BodyId`]. It is of bodies and broken joints, as that is:
    /// clock and contacts are not in it.
    ///
    /// What peers compare: each has the snapshot of a past step at hand, whatever step its world is
    /// at now.
    pub fn state_hash(&self) -> u64 {
        let mut hash = Fnv::default();
        for row in self.rows_by_id(0..self.len()) {
            hash.add_pose(&self.poses[row]);
            if let Some(momentum) = self.momenta.get(row) {
                hash.add_momentum(momentum);
            }
        }
        self.joints.add_to(&mut hash);
        hash.value()
    }

    /// The body with the smallest [`BodyId`] that is in only one of the two, or whose kind or state
    /// is not the same to the bit: where to look first when two peers differ. Clock,
    /// contacts and broken joints are not compared; what differs in them shows in bodies once it
    /// moves them.
    pub fn first_difference(&self, other: &Self) -> Option<BodyId> {
        let (ours, theirs) = (self.rows_by_id(0..self.len()), other.rows_by_id(0..other.len()));
        let same = ours.iter().zip(&theirs).take_while(|&(&a, &b)| {
            let alike = self.ids[a] == other.ids[b] && self.kind(a) == other.kind(b);
            let bits = |number: Real| canonical(number).to_bits();
            alike && self.numbers(a).map(bits).eq(other.numbers(b).map(bits))
        });
        let same = same.count();
        let next = [ours.get(same).map(|&row| self.ids[row]), theirs.get(same).map(|&row| other.ids[row])];
        next.into_iter().flatten().min()
    }

    /// The rows of a kind.
    fn rows(&self, kind: BodyKind) -> Range<usize> {
        let (moving, unfixed) = (self.momenta.len(), self.momenta.len() + self.velocities.len());
        match kind {
            BodyKind::Moving => 0..moving,
            BodyKind::Kinematic => moving..unfixed,
            BodyKind::Fixed => unfixed..self.len(),
        }
    }

    fn kind(&self, row: usize) -> BodyKind {
        let kinds = [BodyKind::Moving, BodyKind::Kinematic];
        kinds.into_iter().find(|&kind| self.rows(kind).contains(&row)).unwrap_or(BodyKind::Fixed)
    }

    fn rows_by_id(&self, rows: Range<usize>) -> Vec<usize> {
        let mut rows: Vec<usize> = rows.collect();
        rows.sort_unstable_by_key(|&row| self.ids[row]);
        rows
    }

    /// The numbers of a row: position, orientation x y z w and, if it moves, momenta or velocities.
    fn numbers(&self, row: usize) -> impl Iterator<Item = Real> {
        let pose = &self.poses[row];
        let momentum = self.momenta.get(row).map(|momentum| [momentum.linear, momentum.angular]);
        let velocity = || self.velocities.get(row.checked_sub(self.momenta.len())?);
        let motion = momentum.or_else(|| velocity().map(|velocity| [velocity.linear, velocity.angular]));
        let motion = motion.into_iter().flatten().flat_map(|vector| vector.to_array());
        pose.position.to_array().into_iter().chain(pose.orientation.to_array()).chain(motion)
    }
}

/// Bodies that a step moves need an identity.
fn refuse_unidentified(world: &World) -> Result<(), SnapshotError> {
    let moved = |archetype: &&Archetype| {
        let kind = BodyKind::of(archetype);
        matches!(kind, Some(BodyKind::Moving | BodyKind::Kinematic)) && !archetype.has::<BodyId>()
    };
    match world.archetypes().filter(moved).map(|archetype| archetype.len() as usize).sum() {
        0 => Ok(()),
        bodies => Err(SnapshotError::Unidentified { bodies }),
    }
}

/// The smallest identity that is there twice.
fn first_duplicate(ids: &[BodyId]) -> Option<BodyId> {
    if ids.is_sorted_by(|a, b| a < b) || are_close_and_distinct(ids) {
        return None;
    }
    let mut sorted = ids.to_vec();
    sorted.sort_unstable();
    sorted.windows(2).find(|pair| pair[0] == pair[1]).map(|pair| pair[0])
}

/// Whether identities that lie close together, as counted ones do, are all different: a mark for
/// each that there could be is faster than sorting.
fn are_close_and_distinct(ids: &[BodyId]) -> bool {
    /// Most numbers between the smallest and the largest, as a multiple of how many there are.
    const SPREAD: u64 = 8;
    let (smallest, largest) = ids.iter().fold((u64::MAX, 0), |(low, high), id| (low.min(id.0), high.max(id.0)));
    let last = largest.saturating_sub(smallest);
    if last / SPREAD >= ids.len() as u64 {
        return false;
    }
    let mut seen = vec![false; last as usize + 1];
    let mut twice = false;
    for id in ids {
        twice |= std::mem::replace(&mut seen[(id.0 - smallest) as usize], true);
    }
    !twice
}

/// How many identities are the same from the start on.
fn equal_from_the_start(a: &[BodyId], b: &[BodyId]) -> usize {
    /// Compared at a time, without a branch for each.
    const BLOCK: usize = 32;
    let differ = |(a, b): &(&[BodyId], &[BodyId])| a.iter().zip(*b).fold(0, |bits, (a, b)| bits | (a.0 ^ b.0)) != 0;
    let common = a.len().min(b.len());
    let blocks = a[..common].chunks(BLOCK).zip(b[..common].chunks(BLOCK));
    let same = blocks.take_while(|blocks| !differ(blocks)).count() * BLOCK;
    let rest = a.iter().zip(b).skip(same).take_while(|(a, b)| a == b);
    // The last block may be a short one.
    (same + rest.count()).min(common)
}
