//! The contacts of the last step: matched with the bodies of this one, saved and restored, and
//! compared for events.

use hecs::World;

use crate::collision::body_key::{BodyKeys, EndedPair};
use crate::collision::collider_state::ColliderState;
use crate::collision::contact::ContactRecord;
use crate::collision::contact_events::ContactEvent;
use crate::collision::contact_set::ContactSet;
use crate::collision::pipeline::{Colliders, CollisionPipeline};
use crate::collision::saved_contacts::SavedContacts;
use crate::joints::held_impulses::{HeldImpulse, HeldImpulses};
use crate::joints::joint_marks::JointMarks;
use crate::math::Real;
use crate::storage::body_index::{BodyIndex, Slot};

/// The contacts of before, and the bodies that their slots stand for.
#[derive(Clone, Debug, Default)]
pub(crate) struct ContactCache {
    pub(crate) body_keys: BodyKeys,
    /// Those of the last substep, when the next ones have been found.
    pub(crate) last: Vec<ContactRecord>,
    /// Those of before the step, once its second substep has overwritten what the first replaced.
    before_step: Vec<ContactRecord>,
    /// How often contacts were found since the step began: once a substep of the settings.
    substeps: u32,
    /// Pairs that touched and have lost a body between the steps.
    pub(crate) ended: Vec<EndedPair>,
    /// The bodies that had a contact with one that is gone, by new slot.
    pub(crate) bereaved: Vec<Slot>,
    /// Of the steps before the last that were taken in the same call.
    pub(crate) events: Vec<ContactEvent>,
    /// No step has been taken since keys were compared.
    is_next: bool,
}

impl ContactCache {
    /// Gives the contacts that there were the slots that their bodies have now, and drops those of
    /// bodies that are gone. Returns whether all slots are what they were.
    pub(crate) fn renumber(
        &mut self,
        world: &World,
        body_index: &BodyIndex,
        contacts: [&mut Vec<ContactRecord>; 2],
    ) -> bool {
        let Self { body_keys, ended, bereaved, is_next, .. } = self;
        ended.clear();
        bereaved.clear();
        *is_next = true;
        !body_keys.renew(world, body_index, contacts, (ended, bereaved))
    }

    /// Says of which shapes contacts are, and puts them in order. Where `are_same`, colliders and
    /// slots are those that the contacts were found with.
    pub(crate) fn arrange(&self, contacts: &mut [ContactRecord], colliders: &Colliders, are_same: bool) {
        if are_same {
            debug_assert!(contacts.iter().all(|contact| contact.kind == colliders.kind_of(contact.slots)));
        } else {
            // Contacts that were put back lie as they did elsewhere.
            contacts.iter_mut().for_each(|contact| contact.kind = colliders.kind_of(contact.slots));
        }
        if !contacts.is_sorted_by_key(ContactRecord::key) {
            contacts.sort_unstable_by_key(ContactRecord::key);
        }
    }

    /// Whether the next step follows the last in the same call, with the same bodies.
    pub(crate) fn goes_on(&self) -> bool {
        !self.is_next
    }

    /// To be called before the first substep of every step.
    pub(crate) fn begin_step(&mut self) {
        if !std::mem::take(&mut self.is_next) {
            self.ended.clear();
        }
        self.substeps = 0;
    }

    /// Whether contacts are found for the first time in a step.
    pub(crate) fn is_first_substep(&self) -> bool {
        self.substeps <= 1
    }

    /// A step in which nothing touches.
    pub(crate) fn pass(&mut self) {
        self.last.clear();
        self.substeps = 1;
    }

    /// Has the contacts of bodies that woke in a later substep among those of before the step too,
    /// and without impulses of this step; `woken` are in order.
    pub(crate) fn remember_woken(&mut self, woken: &[Slot]) {
        if self.is_first_substep() {
            return;
        }
        let Self { last, before_step, .. } = self;
        let woke = |contact: &&mut ContactRecord| contact.slots.iter().any(|slot| woken.binary_search(slot).is_ok());
        let known = before_step.len();
        for contact in last.iter_mut().filter(woke) {
            if before_step[..known].binary_search_by_key(&contact.key(), ContactRecord::key).is_err() {
                before_step.push(contact.clone());
                (contact.total_impulse, contact.earlier_impulse) = (0.0, 0.0);
            }
        }
        before_step.sort_by_key(ContactRecord::key);
    }

    /// Takes the contacts of before the substep, and gives back a list to overwrite.
    pub(crate) fn keep_previous(&mut self, contacts: &mut Vec<ContactRecord>) {
        if self.substeps == 1 {
            std::mem::swap(&mut self.last, &mut self.before_step);
        }
        self.substeps += 1;
        std::mem::swap(contacts, &mut self.last);
    }

    /// The contacts of before the last step; `None` where none has been taken.
    pub(crate) fn before_the_step(&self) -> Option<&[ContactRecord]> {
        match self.substeps {
            0 => None,
            1 => Some(&self.last),
            _ => Some(&self.before_step),
        }
    }

    /// Forgets all contacts.
    fn forget(&mut self) {
        self.body_keys.clear();
        self.ended.clear();
        self.events.clear();
        self.substeps = 0;
    }
}

impl CollisionPipeline {
    /// Whether nothing touches nor has just parted.
    pub(crate) fn are_over(&self) -> bool {
        let are_over = self.contacts.records.is_empty() && self.sleepers.contacts.is_empty();
        are_over && self.cache.ended.is_empty() && self.sensors.are_over()
    }

    /// Forgets all contacts, so that the next step begins without.
    pub(crate) fn forget(&mut self) {
        self.contacts.records.clear();
        self.contacts.substep = 0.0;
        self.cache.forget();
        self.sensors.forget();
        self.sleepers.forget();
        // It is not known whose they are.
        self.colliders.list.clear();
    }

    /// Copies what decides the next step, with the loads of joints by slot, and the impulses
    /// of those in passes.
    pub(crate) fn save(&self, (joint_loads, of_joints): (&[f64], &HeldImpulses), into: &mut SavedContacts) {
        into.clear();
        let SavedContacts { body_keys, centers, loads, still, contacts, held, places } = into;
        let Self { cache, contacts: ContactSet { records, .. }, sleepers, .. } = self;
        let records = || records.iter().chain(&sleepers.contacts);
        places.clear();
        places.resize(cache.body_keys.len(), Slot::NONE);
        for slot in records().flat_map(|contact| contact.slots) {
            places[slot.index()] = Slot(0);
        }
        for slot in of_joints.joints.iter().flat_map(|held| held.slots) {
            places[slot.index()] = Slot(0);
        }
        for (place, _) in places.iter_mut().zip(joint_loads).filter(|(_, load)| **load > 0.0) {
            *place = Slot(0);
        }
        for (_, place) in (0..).map(Slot).zip(&mut *places).filter(|(slot, _)| sleepers.still(*slot) != 0.0) {
            *place = Slot(0);
        }
        for (slot, place) in (0..).map(Slot).zip(&mut *places).filter(|(_, place)| **place != Slot::NONE) {
            let key = cache.body_keys.key(slot);
            // A world in which two bodies have one key has no snapshot; here one of them may be
            // gone since the step.
            *place = if body_keys.last() == Some(&key) { Slot::NONE } else { Slot(body_keys.len() as u32) };
            if *place != Slot::NONE {
                body_keys.push(key);
                centers.push(self.center(slot));
                loads.push(joint_loads.get(slot.index()).copied().unwrap_or(0.0));
                still.push(sleepers.still(slot));
            }
        }
        contacts.extend(records().filter_map(|contact| {
            let slots = contact.slots.map(|slot| places[slot.index()]);
            (!slots.contains(&Slot::NONE)).then(|| ContactRecord { slots, ..contact.clone() })
        }));
        held.extend(of_joints.joints.iter().filter_map(|joint| {
            let slots = joint.slots.map(|slot| places[slot.index()]);
            (!slots.contains(&Slot::NONE)).then_some(HeldImpulse { slots, ..*joint })
        }));
    }

    /// Puts back what was saved, between the bodies that have the same keys in this world.
    pub(crate) fn put_back(&mut self, saved: &SavedContacts, world: &World) {
        self.forget();
        let Self {
            cache: ContactCache { body_keys, .. },
            contacts: ContactSet { records, .. },
            collider_states,
            sleepers,
            joint_marks,
            are_states_known,
            ..
        } = self;
        sleepers.put_back(&saved.still);
        *joint_marks = JointMarks::default();
        *are_states_known = false;
        body_keys.set(&saved.body_keys, world);
        sleepers.take_baseline(|slot| world.entity(body_keys.entity(slot)).ok());
        records.extend_from_slice(&saved.contacts);
        records.retain(|contact| contact.slots.iter().all(|slot| body_keys.is_here(*slot)));
        collider_states.states.clear();
        collider_states.states.extend(saved.centers.iter().copied().map(ColliderState::at_center));
    }

    /// Where the centre of mass of a slot was when the step began \[m\].
    pub(crate) fn center(&self, slot: Slot) -> [Real; 3] {
        self.collider_states.states.get(slot.index()).map_or([0.0; 3], ColliderState::center)
    }
}
