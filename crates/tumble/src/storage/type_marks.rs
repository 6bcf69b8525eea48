//! Marks of component types, in a table that takes a load for each type of an archetype.
//!
//! In a world of one body a step takes some hundred nanoseconds, and asking its archetype for ten
//! types would take eighty.

use std::any::TypeId;
use std::hash::{Hash, Hasher};

use hecs::Archetype;

/// As many as leave a type that has no mark in the place of one with a mark seldom.
const PLACES: usize = 1024;

/// The marks, by place of a type.
pub(crate) struct TypeMarks([u8; PLACES]);

impl TypeMarks {
    /// Of types with a mark each.
    pub(crate) fn of(types: impl IntoIterator<Item = (TypeId, u8)>) -> Self {
        let mut marks = [0; PLACES];
        for (id, mark) in types {
            marks[place(id)] |= mark;
        }
        Self(marks)
    }

    /// The marks of all types of an archetype together, and seldom one that none of them has.
    pub(crate) fn on(&self, archetype: &Archetype) -> u8 {
        archetype.component_types().fold(0, |marks, id| marks | self.0[place(id)])
    }
}

fn place(id: TypeId) -> usize {
    let mut hash = OwnBits(0);
    id.hash(&mut hash);
    (hash.0 % PLACES as u64) as usize
}

/// A [`TypeId`] is a hash already: of what it writes, the last is taken.
struct OwnBits(u64);

impl Hasher for OwnBits {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|byte| self.0 = self.0.rotate_left(8) ^ u64::from(*byte));
    }

    fn write_u64(&mut self, bits: u64) {
        self.0 = bits;
    }
}
