//! Which slots sleep.

use std::ops::Range;

use crate::storage::body_index::{Slot, by_new_slot};

/// The bodies that sleep, by slot.
#[derive(Clone, Debug, Default)]
pub(crate) struct SleepMask {
    /// Empty where none sleeps.
    asleep: Vec<bool>,
}

impl SleepMask {
    /// Of these, by slot.
    pub(crate) fn set(&mut self, asleep: impl Iterator<Item = bool>) {
        self.asleep.clear();
        self.asleep.extend(asleep);
        self.settle();
    }

    pub(crate) fn has(&self, slot: Slot) -> bool {
        self.asleep.get(slot.index()).is_some_and(|is_asleep| *is_asleep)
    }

    /// Whether none sleeps.
    pub(crate) fn is_empty(&self) -> bool {
        self.asleep.is_empty()
    }

    /// Those that sleep, in order.
    pub(crate) fn slots(&self) -> impl Iterator<Item = Slot> + '_ {
        (0..).map(Slot).zip(&self.asleep).filter(|(_, is_asleep)| **is_asleep).map(|(slot, _)| slot)
    }

    /// Of some neighbouring slots; empty where none sleeps.
    pub(crate) fn part(&self, slots: Range<usize>) -> &[bool] {
        self.asleep.get(slots).unwrap_or_default()
    }

    /// Adds a body; `count` is how many there are.
    pub(crate) fn insert(&mut self, slot: Slot, count: usize) {
        self.asleep.resize(count, false);
        self.asleep[slot.index()] = true;
    }

    /// Takes bodies out that sleep.
    pub(crate) fn remove_all(&mut self, slots: &[Slot]) {
        slots.iter().for_each(|slot| self.asleep[slot.index()] = false);
        self.settle();
    }

    /// Takes over another, in the memory of this one.
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.asleep.clone_from(&other.asleep);
    }

    pub(crate) fn clear(&mut self) {
        self.asleep.clear();
    }

    /// Gives bodies the slots that they have now; `slots` are these by slot before.
    pub(crate) fn renumber(&mut self, slots: &[Slot], count: usize) {
        if !self.is_empty() {
            self.asleep = by_new_slot(std::mem::take(&mut self.asleep), slots, count, false);
            self.settle();
        }
    }

    fn settle(&mut self) {
        if !self.asleep.contains(&true) {
            self.asleep.clear();
        }
    }
}
