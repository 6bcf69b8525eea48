//! A network between two peers, with a delay that changes from message to message.

use crate::game::Input;

/// What a peer tells the other in every step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Message {
    pub(crate) step: u64,
    pub(crate) input: Input,
    /// The start of a step up to which the sender knows all inputs, and the hash of the state
    /// there: what both must agree on.
    pub(crate) check: Option<(u64, u64)>,
}

/// One direction of the network.
#[derive(Debug, Default)]
pub(crate) struct Wire {
    /// Messages and when they arrive.
    underway: Vec<(u64, Message)>,
}

impl Wire {
    /// The longest that a message is underway, in steps.
    pub(crate) const LONGEST_DELAY: u64 = 7;

    /// Sends a message `now`. It may overtake others.
    pub(crate) fn send(&mut self, now: u64, message: Message) {
        let delay = 2 + (now * now + 3 * now / 5) % (Self::LONGEST_DELAY - 1);
        self.underway.push((now + delay, message));
    }

    /// What has arrived by `now`.
    pub(crate) fn receive(&mut self, now: u64) -> Vec<Message> {
        self.underway.extract_if(.., |(arrives, _)| *arrives <= now).map(|(_, message)| message).collect()
    }
}
