//! Which free balls meet each other and nothing else that would stop them.

use crate::collision::collider_state::ColliderState;
use crate::collision::contact::ContactRecord;
use crate::collision::contact_ways::{Way, nearest};
use crate::storage::body_index::Slot;

/// How many contacts with other free bodies each body has, by slot. Empty where no free balls meet
/// that have to be followed.
#[derive(Clone, Default)]
pub(crate) struct Partners(Vec<u8>);

impl Partners {
    /// Counts those of contacts. Bodies that joints hold, or that something else stops, have many.
    pub(crate) fn count(
        &mut self,
        contacts: &[ContactRecord],
        ways: &[Way],
        states: &[ColliderState],
        jointed: impl Iterator<Item = Slot>,
    ) {
        let Self(counts) = self;
        counts.clear();
        let is_free = |slot: &Slot| states[slot.index()].is_dynamic;
        let are_free = |contact: &ContactRecord| contact.slots.iter().all(is_free);
        let is_followed = |(contact, way): (&ContactRecord, &Way)| {
            !matches!(way, Way::Plain | Way::Passed) && contact.is_between_centers() && are_free(contact)
        };
        if !contacts.iter().zip(ways).any(is_followed) {
            return;
        }
        counts.resize(states.len(), 0);
        for slot in jointed {
            if let Some(count) = counts.get_mut(slot.index()) {
                *count = u8::MAX;
            }
        }
        for (contact, _) in contacts.iter().zip(ways).filter(|(_, way)| **way != Way::Passed) {
            let more = match are_free(contact) {
                true => 1,
                false if is_rest(contact, contact.slots.map(|slot| &states[slot.index()])) => 0,
                false => u8::MAX,
            };
            for slot in contact.slots {
                counts[slot.index()] = counts[slot.index()].saturating_add(more);
            }
        }
    }

    /// Whether two free bodies have contacts with no free body but each other, and nothing else
    /// stops them.
    pub(crate) fn are_alone(&self, pair: [Slot; 2]) -> bool {
        pair.iter().all(|slot| self.0.get(slot.index()) == Some(&1))
    }
}

/// Whether bodies lie or roll on each other: in the step they come no nearer than by the margin.
fn is_rest(contact: &ContactRecord, [first, second]: [&ColliderState; 2]) -> bool {
    let closing = contact.geometry.normal.dot(first.motion.way - second.motion.way);
    nearest(contact).max(closing) <= contact.margin()
}
