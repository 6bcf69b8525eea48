//! The bodies of a world that constraints act on in a substep, each with its row in the solver.

use crate::collision::sleep_mask::SleepMask;
use crate::joints::axis_lock::{AxisLock, LockedSlot};
use crate::solver::solver_bodies::SolverRow;
use crate::storage::body_index::{BodyIndex, Slot};
use crate::storage::world_columns::WorldColumns;

/// Which bodies of a world the solver moves, or reads. All others are the integrator's.
#[derive(Clone, Default)]
pub(crate) struct ConstrainedBodies {
    /// By slot; [`NONE`] where no constraint acts on the body.
    rows: Vec<SolverRow>,
    /// How many are dynamic and awake, and how many are not.
    counts: [usize; 2],
    /// Those that are dynamic and sleep: they are not moved.
    pub(crate) sleepers: SleepMask,
    /// Bodies with locked axes: constraints act on them in any case.
    pub(crate) locked: Vec<LockedSlot>,
}

const NONE: SolverRow = SolverRow(u32::MAX);
/// In the place of a row that is still to be given.
const MARKED: SolverRow = SolverRow(u32::MAX - 1);

impl ConstrainedBodies {
    /// Those of the constraints between `pairs` of slots, without rows.
    pub(crate) fn find(
        &mut self,
        pairs: impl Iterator<Item = [Slot; 2]>,
        body_index: &BodyIndex,
        columns: &WorldColumns<'_>,
        asleep: &SleepMask,
    ) {
        let Self { rows, counts, locked, sleepers } = self;
        sleepers.copy_from(asleep);
        let is_awake = |slot: &Slot| !sleepers.has(*slot);
        rows.clear();
        rows.resize(body_index.len(), NONE);
        let locked = locked.iter().map(|it| it.slot).filter(is_awake);
        pairs.flatten().chain(locked).for_each(|slot| rows[slot.index()] = MARKED);
        *counts = [0; 2];
        for (archetype, is_dynamic) in columns.kinds() {
            let slots = body_index.slots_in(archetype).iter();
            for slot in slots.filter(|slot| rows[slot.index()] != NONE) {
                counts[usize::from(!is_dynamic || !is_awake(slot))] += 1;
            }
        }
    }

    /// None.
    pub(crate) fn clear(&mut self) {
        self.rows.clear();
        self.sleepers.clear();
        self.counts = [0; 2];
    }

    /// How many are dynamic and awake, and how many are not.
    pub(crate) fn counts(&self) -> [usize; 2] {
        self.counts
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.counts == [0; 2]
    }

    pub(crate) fn contains(&self, slot: Slot) -> bool {
        self.rows[slot.index()] != NONE
    }

    /// The row of a body that does not sleep.
    pub(crate) fn awake_row(&self, slot: Slot) -> Option<SolverRow> {
        self.row(slot).filter(|_| !self.sleepers.has(slot))
    }

    pub(crate) fn row(&self, slot: Slot) -> Option<SolverRow> {
        Some(self.rows[slot.index()]).filter(|row| *row != NONE)
    }

    /// The rows of a constraint's bodies.
    pub(crate) fn rows_of(&self, slots: [Slot; 2]) -> [SolverRow; 2] {
        slots.map(|slot| self.rows[slot.index()])
    }

    /// The rows of bodies with locked axes that have no joints.
    pub(crate) fn locks(&self) -> impl Iterator<Item = (SolverRow, AxisLock)> + '_ {
        let without_joint = self.locked.iter().filter(|it| !it.has_joint);
        without_joint.filter_map(|it| Some((self.awake_row(it.slot)?, it.lock)))
    }

    /// The bodies with locked axes that have joints, and their rows.
    pub(crate) fn jointed_locks(&self) -> impl Iterator<Item = (Slot, SolverRow, AxisLock)> + Clone + '_ {
        let with_joint = self.locked.iter().filter(|it| it.has_joint);
        with_joint.filter_map(|it| Some((it.slot, self.awake_row(it.slot)?, it.lock)))
    }

    /// By slot.
    pub(crate) fn rows(&self) -> impl ExactSizeIterator<Item = Option<SolverRow>> + '_ {
        self.rows.iter().map(|row| Some(*row).filter(|row| *row != NONE))
    }

    pub(crate) fn set_row(&mut self, slot: Slot, row: SolverRow) {
        self.rows[slot.index()] = row;
    }

    /// Drops the bodies that no constraint between `pairs` of slots acts on any more. All have
    /// rows, of which those of dynamic bodies are given.
    pub(crate) fn retain(&mut self, pairs: impl Iterator<Item = [Slot; 2]>, is_dynamic: impl Fn(SolverRow) -> bool) {
        let mut is_constrained = vec![false; self.rows.len()];
        pairs.flatten().for_each(|slot| is_constrained[slot.index()] = true);
        for (row, is_constrained) in self.rows.iter_mut().zip(is_constrained) {
            if *row != NONE && !is_constrained {
                self.counts[usize::from(!is_dynamic(*row))] -= 1;
                *row = NONE;
            }
        }
    }
}
