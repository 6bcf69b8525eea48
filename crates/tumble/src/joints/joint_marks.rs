//! Which joints changed from one step to the next.

use hecs::Entity;

use crate::joints::joint_list::JointList;

/// A joint as it was.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct JointMark {
    joint: Entity,
    /// Of all that it is and has.
    sum: u64,
    bodies: [Entity; 2],
}

impl JointMark {
    pub(crate) fn new(joint: Entity, bodies: [Entity; 2]) -> Self {
        Self { joint, sum: 0xcbf2_9ce4_8422_2325, bodies }
    }

    /// Adds numbers that it differs by.
    pub(crate) fn add(&mut self, numbers: impl Iterator<Item = u64>) {
        let mix = |sum: u64, number: u64| (sum ^ number).wrapping_mul(0x0100_0000_01b3).rotate_left(23);
        self.sum = numbers.fold(self.sum, mix);
    }
}

/// The joints of a world as they were in the last step.
#[derive(Clone, Debug, Default)]
pub(crate) struct JointMarks {
    /// By joint.
    marks: Vec<JointMark>,
    before: Vec<JointMark>,
    /// Whether it is known how joints were.
    are_known: bool,
}

impl JointMarks {
    /// Takes note of the joints as they are, and calls `changed` with the bodies of each that is
    /// not as it was, is there for the first time or no longer.
    pub(crate) fn update(&mut self, list: &JointList, mut changed: impl FnMut(Entity)) {
        let Self { marks, before, are_known } = self;
        std::mem::swap(marks, before);
        marks.clear();
        list.add_marks(marks);
        marks.sort_unstable();
        if !std::mem::replace(are_known, true) || marks == before {
            return;
        }
        let mut old = before.iter().peekable();
        let mut both = |mark: &JointMark| mark.bodies.into_iter().for_each(&mut changed);
        for mark in &*marks {
            while let Some(gone) = old.next_if(|it| it.joint < mark.joint) {
                both(gone);
            }
            match old.next_if(|it| it.joint == mark.joint) {
                Some(known) if known == mark => {}
                known => known.into_iter().chain([mark]).for_each(&mut both),
            }
        }
        old.for_each(both);
    }
}
