//! Snapshots with what the simulation knows beside the world: the time, and the contacts.

use hecs::{Entity, World};

use crate::collision;
use crate::snapshot::Snapshot;
use crate::snapshot::error::SnapshotError;
use crate::snapshot::row_map::Matching;
use crate::solver::mechanism::mechanisms::Mechanisms;
use crate::step::interactions::Interactions;
use crate::step::simulation::Simulation;

impl Simulation {
    /// The state of the world's bodies, the [`clock`](Self::clock) and the contacts now: all that a
    /// run goes on from, to the bit. To be taken between steps, as [`Snapshot::capture`].
    ///
    /// ```
    /// use tumble::{BodyOrder, Snapshot, prelude::*, state_hash};
    ///
    /// let mut world = tumble::hecs::World::new();
    /// spawn_ground(&mut world);
    /// let crate_of_tea = RigidBody::new(Shape::cuboid([0.5, 0.5, 0.5])).mass(2.0).id(BodyId(1));
    /// crate_of_tea.position(Vec3::Y * 0.51).build()?.spawn(&mut world);
    /// let mut simulation = Simulation::new(Settings::default())?;
    /// simulation.step_many(&mut world, 30);
    ///
    /// let file = simulation.snapshot(&world)?.to_bytes();
    /// simulation.step_many(&mut world, 30);
    /// let there = state_hash(&world, &BodyOrder::of(&world));
    ///
    /// simulation.restore(&Snapshot::from_bytes(&file)?, &mut world)?;
    /// simulation.step_many(&mut world, 30);
    /// assert_eq!(state_hash(&world, &BodyOrder::of(&world)), there);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`Snapshot::capture`].
    pub fn snapshot(&self, world: &World) -> Result<Snapshot, SnapshotError> {
        let mut snapshot = Snapshot::default();
        self.take_snapshot(world, &mut snapshot)?;
        Ok(snapshot)
    }

    /// Puts back the world's bodies as [`Snapshot::restore`] does, the contacts, and the
    /// [`clock`](Self::clock) where the snapshot has one. Returns the bodies that were spawned
    /// since.
    ///
    /// Contacts belong to bodies by their [`BodyId`](crate::BodyId)s; fixed bodies without one,
    /// which are scenery, go by the numbers of their entities. Contacts with scenery that is not
    /// there are dropped. A snapshot without contacts, as [`Snapshot::capture`] takes it, empties
    /// the simulation's: the next step begins with no impulse between bodies, and so with other
    /// bits than the run that was captured where anything touched.
    ///
    /// # Errors
    /// As [`Snapshot::restore`]; world and simulation are unchanged then.
    pub fn restore(&mut self, snapshot: &Snapshot, world: &mut World) -> Result<Vec<Entity>, SnapshotError> {
        self.restore_with(snapshot, world, &mut Matching::default())
    }

    /// [`snapshot`](Self::snapshot) in the place of what one held.
    pub(crate) fn take_snapshot(&self, world: &World, snapshot: &mut Snapshot) -> Result<(), SnapshotError> {
        snapshot.recapture(world)?;
        snapshot.set_clock(self.clock());
        if let Some(interactions) = &self.interactions
            && let Some(collision) = &interactions.collision
        {
            let Mechanisms { loads, passed, .. } = &interactions.mechanisms;
            collision.save((loads, &passed.held), &mut snapshot.contacts);
        }
        Ok(())
    }

    /// [`restore`](Self::restore) with buffers to use again.
    pub(crate) fn restore_with(
        &mut self,
        snapshot: &Snapshot,
        world: &mut World,
        matching: &mut Matching,
    ) -> Result<Vec<Entity>, SnapshotError> {
        let spawned_since = snapshot.restore_with(world, matching)?;
        self.forget_events();
        if let Some(clock) = snapshot.clock() {
            self.set_clock(clock);
        }
        if !snapshot.contacts.is_empty() {
            let settings = *self.settings();
            let Interactions { collision, mechanisms, .. } = &mut **self.interactions.get_or_insert_default();
            let collision = collision.get_or_insert_default();
            collision.put_back(&snapshot.contacts, world);
            collision.sleepers.settings = collision.sleepers.are_restored.then_some(settings);
            mechanisms.loads.clone_from(&snapshot.contacts.loads);
            mechanisms.passed.held.joints.clone_from(&snapshot.contacts.held);
        } else if self.interactions.is_some() || collision::are_in(world) {
            let Interactions { collision, mechanisms, .. } = &mut **self.interactions.get_or_insert_default();
            mechanisms.loads.clear();
            mechanisms.passed.held.clear();
            collision.get_or_insert_default().forget();
        }
        Ok(spawned_since)
    }
}
