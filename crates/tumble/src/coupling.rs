use hecs::World;

use crate::contacts::{self, Contacts};
use crate::pairs::{self, PairForces};

/// What bodies do to each other, kept from step to step.
#[derive(Clone, Debug, Default)]
pub(crate) struct Coupling {
    pub(crate) pairs: Option<PairForces>,
    pub(crate) contacts: Option<Contacts>,
}

impl Coupling {
    /// Whether bodies of a world may act on each other.
    pub(crate) fn is_in(world: &World) -> bool {
        pairs::are_in(world) || contacts::are_in(world)
    }

    /// Finds out what acts between which bodies. To be called again when anything was spawned, despawned or changed but momentum and pose.
    pub(crate) fn find(&mut self, world: &World) {
        if pairs::are_in(world) {
            self.pairs.get_or_insert_default().find(world);
        } else {
            self.pairs = None;
        }
        if contacts::are_in(world) || self.contacts.as_ref().is_some_and(|contacts| !contacts.are_over()) {
            self.contacts.get_or_insert_default().find(world);
        } else {
            self.contacts = None;
        }
    }

    /// Steps of a world in which nothing acts on anything: what touched does no more.
    pub(crate) fn pass(&mut self, world: &World, steps: u32) {
        if let Some(contacts) = self.contacts.as_mut().filter(|contacts| !contacts.are_over()) {
            contacts.pass(world, steps);
        } else {
            self.contacts = None;
        }
    }
}
