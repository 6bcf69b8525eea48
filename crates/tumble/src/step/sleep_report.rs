//! Which bodies of a simulation sleep.

use hecs::Entity;

use crate::collision::pipeline::CollisionPipeline;
use crate::step::simulation::Simulation;
use crate::storage::body_index::Slot;

impl Simulation {
    /// Whether a body sleeps: it does not move, and is left out of the steps until something
    /// disturbs it. See [`Sleep`](crate::Sleep).
    #[must_use]
    pub fn is_asleep(&self, body: Entity) -> bool {
        self.collision().is_some_and(|it| it.slot_of(body).is_some_and(|slot| it.sleepers.asleep.has(slot)))
    }

    /// The bodies that sleep, in the order of [`BodyOrder`](crate::BodyOrder).
    ///
    /// ```
    /// # use tumble::{Settings, Simulation};
    /// let simulation = Simulation::new(Settings::default())?;
    /// assert_eq!(simulation.sleeping_bodies().count(), 0);
    /// # Ok::<(), tumble::SettingsError>(())
    /// ```
    pub fn sleeping_bodies(&self) -> impl Iterator<Item = Entity> + '_ {
        self.collision()
            .into_iter()
            .flat_map(|it| it.sleepers.asleep.slots().map(|slot| it.cache.body_keys.entity(slot)))
    }

    /// Wakes a body when the next step begins, and all that hang together with it. Steps wake what
    /// is changed or touched by themselves; this is for what they cannot see, such as a
    /// [contact hook](Self::set_contact_hook) that decides otherwise from now on.
    #[doc(alias = "wake_up")]
    pub fn wake(&mut self, body: Entity) {
        let Some(collision) = self.interactions.as_mut().and_then(|it| it.collision.as_mut()) else { return };
        if let Some(slot) = collision.slot_of(body) {
            collision.sleepers.disturbed.push(slot);
        }
    }

    /// Wakes all bodies when the next step begins.
    pub fn wake_all(&mut self) {
        let Some(collision) = self.interactions.as_mut().and_then(|it| it.collision.as_mut()) else { return };
        collision.sleepers.disturb_all();
    }
}

impl CollisionPipeline {
    /// The slot of a body that was in the world in the last step.
    fn slot_of(&self, body: Entity) -> Option<Slot> {
        let slot = self.body_index.slot(body.id())?;
        (slot.index() < self.cache.body_keys.len() && self.cache.body_keys.entity(slot) == body).then_some(slot)
    }
}
