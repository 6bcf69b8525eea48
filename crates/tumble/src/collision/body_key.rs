//! Persistent keys of bodies, by which contacts are matched from step to step, and in another
//! world.

use hecs::{Entity, World};

use crate::collision::collider::Collider;
use crate::collision::contact::ContactRecord;
use crate::components::{BodyId, Pose};
use crate::joints::joint::Joint;
use crate::joints::locked_axes::LockedAxes;
use crate::storage::body_index::{BodyIndex, Slot};

/// The persistent key of a body: its [`BodyId`], whatever its entity, or without one the number of
/// its entity. In the order of slots.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum BodyKey {
    Id(BodyId),
    Entity(u32),
}

impl BodyKey {
    pub(crate) fn of(id: Option<BodyId>, entity: u32) -> Self {
        id.map_or(Self::Entity(entity), Self::Id)
    }
}

/// The bodies that the slots of contacts stand for.
#[derive(Clone, Debug, Default)]
pub(crate) struct BodyKeys {
    /// In order; equal ones only where bodies of the world have the same [`BodyId`].
    body_keys: Vec<BodyKey>,
    /// By slot; the one that was in the world when it was last looked.
    entities: Vec<Entity>,
    /// By old slot, the one that its key has now.
    now: Vec<Slot>,
    /// The entities that are in the world now, by new slot.
    here: Vec<Entity>,
    /// Of which list of bodies the keys are, if of any.
    listing: Option<u64>,
}

/// Two bodies that touched, of which one is gone.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EndedPair {
    pub(crate) body_keys: [BodyKey; 2],
    pub(crate) entities: [Entity; 2],
}

impl BodyKeys {
    pub(crate) fn len(&self) -> usize {
        self.body_keys.len()
    }

    pub(crate) fn key(&self, slot: Slot) -> BodyKey {
        self.body_keys[slot.index()]
    }

    pub(crate) fn entity(&self, slot: Slot) -> Entity {
        self.entities[slot.index()]
    }

    /// Whether a slot's body was in the world when it was last looked.
    pub(crate) fn is_here(&self, slot: Slot) -> bool {
        self.entity(slot) != Entity::DANGLING
    }

    /// Gives contacts the slots that the keys of their bodies have now, and drops those of bodies
    /// that are gone; `ended` are those of them that touched. Returns whether slots are others
    /// than they were.
    pub(crate) fn renew(
        &mut self,
        world: &World,
        body_index: &BodyIndex,
        contacts: [&mut Vec<ContactRecord>; 2],
        (ended, bereaved): (&mut Vec<EndedPair>, &mut Vec<Slot>),
    ) -> bool {
        let member = |slot: usize| {
            let (_, id, entity) = body_index.key(Slot(slot as u32));
            BodyKey::of(id, entity)
        };
        let count = body_index.len();
        self.here.clear();
        self.here.resize(count, Entity::DANGLING);
        let mut with_collider = world.query::<Entity>().with::<&Collider>();
        let mut locked = world.query::<Entity>().with::<&LockedAxes>();
        for entity in with_collider.iter().chain(locked.iter()) {
            if let Some(slot) = body_index.slot(entity.id()) {
                self.here[slot.index()] = entity;
            }
        }
        for entity in world.query::<&Joint>().iter().flat_map(|joint| joint.bodies) {
            if let Some(slot) = body_index.slot(entity.id()).filter(|_| world.contains(entity)) {
                self.here[slot.index()] = entity;
            }
        }
        let are_here = self.here == self.entities;
        let listing = Some(body_index.listing());
        let has_keys = |keys: &Self| (0..count).all(|slot| keys.body_keys[slot] == member(slot));
        let same = (self.listing == listing || self.body_keys.len() == count && has_keys(self))
            && (are_here || (0..count).all(|slot| !self.is_replaced(slot, slot)));
        self.listing = listing;
        if !same {
            self.match_keys(count, member);
            let Self { body_keys, entities, now, .. } = &*self;
            let mut keep = |contact: &mut ContactRecord| {
                let old = contact.slots;
                contact.slots = old.map(|slot| now[slot.index()]);
                let stays = !contact.slots.contains(&Slot::NONE);
                if !stays {
                    bereaved.extend(contact.slots.into_iter().filter(|slot| *slot != Slot::NONE));
                }
                if !stays && contact.touches() {
                    let [a, b] = [old[0].min(old[1]), old[0].max(old[1])].map(Slot::index);
                    ended.push(EndedPair {
                        body_keys: [body_keys[a], body_keys[b]],
                        entities: [entities[a], entities[b]],
                    });
                }
                stays
            };
            contacts.into_iter().for_each(|it| it.retain_mut(&mut keep));
            self.body_keys.clear();
            self.body_keys.extend((0..count).map(member));
        }
        if !are_here {
            self.entities.clone_from(&self.here);
        }
        !same
    }

    /// By slot before the last [`renew`](Self::renew) that changed slots, the slot since.
    pub(crate) fn renumbered(&self) -> &[Slot] {
        &self.now
    }

    /// Whether what had a key by the number of its entity is gone, and that number another's: hecs
    /// gives it to the next that is spawned.
    fn is_replaced(&self, old: usize, new: usize) -> bool {
        let was = self.entities[old];
        matches!(self.body_keys[old], BodyKey::Entity(_)) && was != Entity::DANGLING && was != self.here[new]
    }

    /// Finds the new slots of keys: of equal keys the first has the first slot, and no two the
    /// same.
    fn match_keys(&mut self, count: usize, member: impl Fn(usize) -> BodyKey) {
        self.now.clear();
        let mut slot = 0;
        for (old, key) in self.body_keys.iter().enumerate() {
            while slot < count && member(slot) < *key {
                slot += 1;
            }
            let is_there = slot < count && member(slot) == *key;
            self.now.push(if is_there && !self.is_replaced(old, slot) { Slot(slot as u32) } else { Slot::NONE });
            slot += usize::from(is_there);
        }
    }

    /// Takes keys that are in order, and finds their entities in a world; what is not there is
    /// [`Entity::DANGLING`].
    pub(crate) fn set(&mut self, body_keys: &[BodyKey], world: &World) {
        self.listing = None;
        self.body_keys.clear();
        self.body_keys.extend_from_slice(body_keys);
        self.entities.clear();
        self.entities.resize(body_keys.len(), Entity::DANGLING);
        if body_keys.is_empty() {
            return;
        }
        let mut next = 0;
        for (entity, id) in world.query::<(Entity, Option<&BodyId>)>().with::<&Pose>().iter() {
            let key = BodyKey::of(id.copied(), entity.id());
            // Most worlds have their bodies in order.
            let place = if body_keys.get(next) == Some(&key) { Ok(next) } else { body_keys.binary_search(&key) };
            if let Ok(place) = place {
                self.entities[place] = entity;
                next = place + 1;
            }
        }
    }

    /// Forgets all.
    pub(crate) fn clear(&mut self) {
        self.listing = None;
        self.body_keys.clear();
        self.entities.clear();
    }
}
