//! Events of the steps of a call, in their order.

/// The events of the steps that one call has taken, and which of them are the last step's.
#[derive(Clone, Debug)]
pub(crate) struct EventLog<E> {
    events: Vec<E>,
    /// How many are of steps before the last.
    earlier: usize,
}

impl<E> Default for EventLog<E> {
    fn default() -> Self {
        Self { events: Vec::new(), earlier: 0 }
    }
}

impl<E> EventLog<E> {
    pub(crate) fn push(&mut self, event: E) {
        self.events.push(event);
    }

    pub(crate) fn extend(&mut self, events: impl IntoIterator<Item = E>) {
        self.events.extend(events);
    }

    /// To be called before each step of a call but the first.
    pub(crate) fn begin_next_step(&mut self) {
        self.earlier = self.events.len();
    }

    /// Forgets those of steps before the last.
    pub(crate) fn forget_earlier(&mut self) {
        self.events.drain(..self.earlier);
        self.earlier = 0;
    }

    pub(crate) fn clear(&mut self) {
        self.events.clear();
        self.earlier = 0;
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = &E> {
        self.events.iter()
    }
}
