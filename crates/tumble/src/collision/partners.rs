//! Which free bodies meet each other and nothing else that would stop them.

use crate::collision::collider_state::ColliderState;
use crate::collision::contact::ContactRecord;
use crate::collision::contact_ways::{Way, nearest};
use crate::storage::body_index::Slot;

/// What each body meets, by slot. Empty where no bodies meet that have to be followed.
#[derive(Clone, Default)]
pub(crate) struct Partners(Vec<Partner>);

#[derive(Clone, Copy, Default)]
struct Partner {
    /// How many contacts with other free bodies it has; many if something else stops it.
    contacts: u8,
    /// Whether it lies or rolls on something.
    rests: bool,
    is_jointed: bool,
}

impl Partners {
    /// Counts those of contacts.
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
        counts.resize(states.len(), Partner::default());
        for slot in jointed {
            if let Some(body) = counts.get_mut(slot.index()) {
                *body = Partner { contacts: u8::MAX, rests: false, is_jointed: true };
            }
        }
        for (contact, _) in contacts.iter().zip(ways).filter(|(_, way)| **way != Way::Passed) {
            let rests = !are_free(contact) && is_rest(contact, contact.slots.map(|slot| &states[slot.index()]));
            let more = match (are_free(contact), rests) {
                (true, _) => 1,
                (false, true) => 0,
                (false, false) => u8::MAX,
            };
            for slot in contact.slots {
                let body = &mut counts[slot.index()];
                body.contacts = body.contacts.saturating_add(more);
                body.rests |= rests;
            }
        }
    }

    /// Whether two free bodies have contacts with no free body but each other, and nothing else
    /// stops them. Balls may lie on something: it does not press them down when they go on from
    /// where they met beside it.
    pub(crate) fn are_alone(&self, pair: [Slot; 2], are_balls: bool) -> bool {
        let is_alone = |body: &Partner| body.contacts == 1 && (are_balls || !body.rests);
        pair.iter().all(|slot| self.0.get(slot.index()).is_some_and(is_alone))
    }

    pub(crate) fn is_jointed(&self, slot: Slot) -> bool {
        self.0.get(slot.index()).is_some_and(|body| body.is_jointed)
    }
}

/// Whether bodies lie or roll on each other: in the step they come no nearer than by the margin.
fn is_rest(contact: &ContactRecord, [first, second]: [&ColliderState; 2]) -> bool {
    let closing = contact.geometry.normal.dot(first.motion.way - second.motion.way);
    nearest(contact).max(closing) <= contact.margin()
}
