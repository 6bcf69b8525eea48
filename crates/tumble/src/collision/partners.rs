//! Which free balls meet each other and nothing else that would stop them.

use crate::collision::collider_state::ColliderState;
use crate::collision::contact::ContactRecord;
use crate::collision::contact_ways::{Way, nearest};
use crate::storage::body_index::Slot;

/// By slot, how many contacts with other free bodies each body has, and whether joints hold it.
/// Empty where no bodies meet that have to be followed.
#[derive(Clone, Default)]
pub(crate) struct Partners(Vec<(u8, bool)>);

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
        if ways.iter().all(|way| matches!(way, Way::Plain | Way::Passed)) {
            return;
        }
        counts.resize(states.len(), (0, false));
        for slot in jointed {
            if let Some(body) = counts.get_mut(slot.index()) {
                *body = (u8::MAX, true);
            }
        }
        for (contact, _) in contacts.iter().zip(ways).filter(|(_, way)| **way != Way::Passed) {
            let more = match are_free(contact) {
                true => 1,
                false if is_rest(contact, contact.slots.map(|slot| &states[slot.index()])) => 0,
                false => u8::MAX,
            };
            for slot in contact.slots {
                let (count, _) = &mut counts[slot.index()];
                *count = count.saturating_add(more);
            }
        }
    }

    /// Whether two free bodies have contacts with no free body but each other, and nothing else
    /// stops them.
    pub(crate) fn are_alone(&self, pair: [Slot; 2]) -> bool {
        pair.iter().all(|slot| self.0.get(slot.index()) == Some(&(1, false)))
    }

    pub(crate) fn is_jointed(&self, slot: Slot) -> bool {
        self.0.get(slot.index()).is_some_and(|(_, is_jointed)| *is_jointed)
    }
}

/// Whether bodies lie or roll on each other: in the step they come no nearer than by the margin.
fn is_rest(contact: &ContactRecord, [first, second]: [&ColliderState; 2]) -> bool {
    let closing = contact.geometry.normal.dot(first.motion.way - second.motion.way);
    nearest(contact).max(closing) <= contact.margin()
}
