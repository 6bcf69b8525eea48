//! Contact events: which bodies begin and end to touch.

use hecs::Entity;

use crate::collision::body_key::BodyKey;
use crate::collision::contact::ContactRecord;
use crate::collision::contact_cache::ContactCache;
use crate::collision::narrow_phase::LaneKind;
use crate::storage::body_index::Slot;

/// The begin or end of the contact of two bodies with colliders in a step; see
/// [`Simulation::contact_events`](crate::Simulation::contact_events).
///
/// ```
/// use tumble::{Collider, ContactEvent, prelude::*};
///
/// let mut world = hecs::World::new();
/// let ground = RigidBody::new(Shape::Point).fixed().build()?.spawn_with(&mut world, (Collider::half_space(),));
/// let shape = Shape::sphere(0.5);
/// let collider = Collider::new(&shape)?;
/// let ball = RigidBody::new(shape).mass(2.0).position(Vec3::Y).build()?.spawn_with(&mut world, (collider,));
///
/// let mut simulation = Simulation::new(Settings::default())?;
/// let mut events = Vec::new();
/// for _ in 0..60 {
///     simulation.step(&mut world);
///     events.extend(simulation.contact_events());
/// }
/// assert_eq!(events, [ContactEvent::Begin([ground, ball])]);
/// world.despawn(ball)?;
/// simulation.step(&mut world);
/// assert_eq!(simulation.contact_events().collect::<Vec<_>>(), [ContactEvent::End([ground, ball])]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactEvent {
    /// They touch, and did not before the step. Both bodies, in the order of
    /// [`Contact::bodies`](crate::Contact::bodies).
    Begin([Entity; 2]),
    /// They touched before the step, and do not any more. One of them may be gone.
    End([Entity; 2]),
}

impl ContactEvent {
    /// The bodies, in the order of [`Contact::bodies`](crate::Contact::bodies).
    pub fn bodies(&self) -> [Entity; 2] {
        let (Self::Begin(bodies) | Self::End(bodies)) = *self;
        bodies
    }
}

/// The sort key of contacts without the part.
type Pair = (LaneKind, [Slot; 2]);

impl ContactCache {
    /// Keeps the events of the last step beside those of the steps before it, as long as nothing
    /// was spawned or despawned since.
    pub(crate) fn keep_events(&mut self, contacts: &[ContactRecord]) {
        let events = self.events_of_step(contacts);
        self.events.extend(events);
    }

    /// The events of the last step, in the order of the bodies; `contacts` are those after it.
    pub(crate) fn events_of_step(&self, contacts: &[ContactRecord]) -> impl Iterator<Item = ContactEvent> + use<> {
        let Self { body_keys, ended, .. } = self;
        let mut events: Vec<([BodyKey; 2], ContactEvent)> = Vec::new();
        if let Some(before) = self.before_the_step() {
            let keys = |slots: [Slot; 2]| slots.map(|slot| body_keys.key(slot));
            let entities = |slots: [Slot; 2]| slots.map(|slot| body_keys.entity(slot));
            for_each_change(touching_pairs(before), touching_pairs(contacts), |change| {
                events.push(match change {
                    Change::Begun((_, slots)) => (keys(slots), ContactEvent::Begin(entities(slots))),
                    Change::Ended((_, slots)) => (keys(slots), ContactEvent::End(entities(slots))),
                });
            });
            events.extend(ended.iter().map(|ended| (ended.body_keys, ContactEvent::End(ended.entities))));
            events.sort_by_key(|(keys, _)| *keys);
            // Of a pair with several contacts each has parted.
            events.dedup();
        }
        events.into_iter().map(|(_, event)| event)
    }
}

enum Change {
    Begun(Pair),
    Ended(Pair),
}

/// Goes along both lists, which are in order, and shows what is in one of them only.
fn for_each_change(
    before: impl Iterator<Item = Pair>,
    now: impl Iterator<Item = Pair>,
    mut change: impl FnMut(Change),
) {
    let mut before = before.peekable();
    for pair in now {
        while let Some(ended) = before.next_if(|other| *other < pair) {
            change(Change::Ended(ended));
        }
        if before.next_if_eq(&pair).is_none() {
            change(Change::Begun(pair));
        }
    }
    before.for_each(|ended| change(Change::Ended(ended)));
}

/// The pairs that touch, in order. The contacts of a pair lie next to each other.
fn touching_pairs(contacts: &[ContactRecord]) -> impl Iterator<Item = Pair> + '_ {
    let pair = |contact: &ContactRecord| (contact.kind, contact.pair());
    contacts
        .chunk_by(move |a, b| pair(a) == pair(b))
        .filter(|contacts| contacts.iter().any(ContactRecord::touches))
        .map(move |contacts| pair(&contacts[0]))
}
