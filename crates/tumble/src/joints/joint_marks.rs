//! Which joints changed from one step to the next.

use hecs::Entity;

use crate::joints::joint_list::JointList;

/// A joint as it was: a number of all that it is and has, and its bodies.
type Mark = (Entity, u64, [Entity; 2]);

/// The joints of a world as they were in the last step.
#[derive(Clone, Debug, Default)]
pub(crate) struct JointMarks {
    /// By joint.
    marks: Vec<Mark>,
    before: Vec<Mark>,
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
        list.for_each_mark(|mark| marks.push(mark));
        marks.sort_unstable();
        if !std::mem::replace(are_known, true) || marks == before {
            return;
        }
        let mut old = before.iter().peekable();
        let mut both = |mark: &Mark| mark.2.into_iter().for_each(&mut changed);
        for mark in &*marks {
            while let Some(gone) = old.next_if(|it| it.0 < mark.0) {
                both(gone);
            }
            match old.next_if(|it| it.0 == mark.0) {
                Some(known) if known == mark => {}
                known => known.into_iter().chain([mark]).for_each(&mut both),
            }
        }
        old.for_each(both);
    }
}
