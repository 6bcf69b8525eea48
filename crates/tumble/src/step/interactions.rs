//! Pairwise forces and contacts of a world, kept between steps.

use std::fmt;

use hecs::World;

use crate::collision;
use crate::collision::find_contacts::Contacts;
use crate::forces::pairwise;
use crate::forces::pairwise::PairForces;
use crate::solver::substeps::ContactSolver;

/// What bodies do to each other, kept from step to step.
#[derive(Clone, Default)]
pub(crate) struct Interactions {
    pub(crate) pairs: Option<PairForces>,
    pub(crate) contacts: Option<Contacts>,
    /// Solves the contacts, where they are not solved together with those of other worlds; no
    /// state.
    pub(crate) contact_solver: Option<Box<ContactSolver>>,
}

impl fmt::Debug for Interactions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { pairs, contacts, contact_solver: _ } = self;
        f.debug_struct("Interactions").field("pairs", pairs).field("contacts", contacts).finish_non_exhaustive()
    }
}

impl Interactions {
    /// Whether bodies of a world may act on each other.
    pub(crate) fn is_in(world: &World) -> bool {
        pairwise::are_in(world) || collision::are_in(world)
    }

    /// Finds out what acts between which bodies. To be called again when anything was spawned,
    /// despawned or changed but momentum and pose.
    pub(crate) fn find(&mut self, world: &World) {
        if pairwise::are_in(world) {
            self.pairs.get_or_insert_default().find(world);
        } else {
            self.pairs = None;
        }
        if collision::are_in(world) || self.contacts.as_ref().is_some_and(|contacts| !contacts.are_over()) {
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
