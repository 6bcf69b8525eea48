//! What contacts keep from step to step: saved, put back, and compared for what began and ended.

use hecs::World;

use crate::collision::body_key::{BodyKeys, EndedPair};
use crate::collision::contact::ContactRecord;
use crate::collision::contact_events::ContactEvent;
use crate::collision::find_contacts::{ColliderState, Contacts};
use crate::collision::saved_contacts::SavedContacts;
use crate::math::Real;

/// What the contacts of before the last step are compared by.
#[derive(Clone, Debug, Default)]
pub(crate) struct PreviousContacts {
    /// How often contacts were found since the step began: once a substep of the settings.
    pub(crate) found: u32,
    /// As they were before the step, once its second substep has overwritten what the first
    /// replaced.
    pub(crate) contacts: Vec<ContactRecord>,
    /// What touched and has lost one of two bodies between the steps.
    pub(crate) ended: Vec<EndedPair>,
    /// Of the steps before the last that were taken in the same call.
    pub(crate) events: Vec<ContactEvent>,
    /// No step has been taken since names were compared.
    is_next: bool,
}

/// No place among the names.
const NONE: u32 = u32::MAX;

impl Contacts {
    /// Gives the contacts that there were the slots that their bodies have now, and drops those of
    /// bodies that are gone.
    pub(crate) fn renumber(&mut self, world: &World) {
        let Self { body_index, body_keys, contacts, previous, .. } = self;
        previous.ended.clear();
        previous.is_next = true;
        if body_keys.renew(world, body_index, contacts, &mut previous.ended) {
            self.broad_phase.reset();
        }
        // Colliders may be others than they were, and contacts that were put back lie as they did
        // elsewhere.
        let colliders = &self.colliders;
        for contact in &mut self.contacts {
            contact.set_kind(contact.slots.map(|slot| colliders[slot as usize].as_ref().map(|(it, _)| it)));
        }
        if !self.contacts.is_sorted_by_key(ContactRecord::key) {
            self.contacts.sort_unstable_by_key(ContactRecord::key);
        }
    }

    /// To be called before the first substep of every step.
    pub(crate) fn begin_step(&mut self) {
        if !std::mem::take(&mut self.previous.is_next) {
            self.keep_events();
            self.previous.ended.clear();
        }
        self.previous.found = 0;
    }

    /// A step, or several, in which nothing has a collider.
    pub(crate) fn pass(&mut self, world: &World, steps: u32) {
        self.find(world);
        for _ in 0..steps.min(2) {
            self.begin_step();
            self.last.clear();
            self.previous.found = 1;
        }
    }

    /// Whether nothing touches nor has just parted.
    pub(crate) fn are_over(&self) -> bool {
        self.contacts.is_empty() && self.previous.ended.is_empty()
    }

    /// Keeps the contacts of before the step, which those of a second substep would overwrite.
    pub(crate) fn keep_previous(&mut self) {
        if self.previous.found == 1 {
            std::mem::swap(&mut self.last, &mut self.previous.contacts);
        }
        self.previous.found += 1;
    }

    /// The contacts of before the last step; `None` where none has been taken.
    pub(crate) fn before_the_step(&self) -> Option<&[ContactRecord]> {
        match self.previous.found {
            0 => None,
            1 => Some(&self.last),
            _ => Some(&self.previous.contacts),
        }
    }

    /// Forgets all contacts, so that the next step begins without.
    pub(crate) fn forget(&mut self) {
        self.body_keys.clear();
        self.contacts.clear();
        self.previous.ended.clear();
        self.previous.events.clear();
        self.previous.found = 0;
    }

    /// Copies what decides the next step.
    pub(crate) fn save(&self, into: &mut SavedContacts) {
        into.clear();
        let SavedContacts { body_keys, centers, contacts, places } = into;
        places.clear();
        places.resize(self.body_keys.len(), NONE);
        for slot in self.contacts.iter().flat_map(|contact| contact.slots) {
            places[slot as usize] = 0;
        }
        for (slot, place) in places.iter_mut().enumerate().filter(|(_, place)| **place != NONE) {
            let name = self.body_keys.name(slot as u32);
            // A world in which two bodies have one name has no snapshot; here one of them may be
            // gone since the step.
            *place = if body_keys.last() == Some(&name) { NONE } else { body_keys.len() as u32 };
            if *place != NONE {
                body_keys.push(name);
                centers.push(self.shapes.get(slot).map_or([0.0; 3], ColliderState::center));
            }
        }
        contacts.extend(self.contacts.iter().filter_map(|contact| {
            let slots = contact.slots.map(|slot| places[slot as usize]);
            (!slots.contains(&NONE)).then(|| ContactRecord { slots, ..contact.clone() })
        }));
    }

    /// Puts back what was saved, between the bodies that have the same names in this world.
    pub(crate) fn put_back(&mut self, saved: &SavedContacts, world: &World) {
        self.forget();
        self.body_keys.set(&saved.body_keys, world);
        self.contacts.extend_from_slice(&saved.contacts);
        let body_keys = &self.body_keys;
        self.contacts.retain(|contact| contact.slots.iter().all(|slot| body_keys.is_here(*slot)));
        self.shapes.clear();
        self.shapes.extend(saved.centers.iter().copied().map(ColliderState::at_center));
    }

    /// Where the centre of mass of a slot was when the step began \[m\].
    pub(crate) fn center(&self, slot: u32) -> [Real; 3] {
        self.shapes.get(slot as usize).map_or([0.0; 3], ColliderState::center)
    }

    pub(crate) fn body_keys(&self) -> &BodyKeys {
        &self.body_keys
    }
}
