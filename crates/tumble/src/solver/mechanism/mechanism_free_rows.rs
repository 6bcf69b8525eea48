//! Rows of free axes in the substeps of a mechanism: their laws, and which part of them applies.

use crate::solver::mechanism::free_row::{FreeRow, Phase};
use crate::solver::mechanism::mechanism_solver::{Half, MechanismSolver};

/// How much more than without other joints a spring moves, at most: beyond, a loop locks its axis,
/// and what it moves is no mass.
const MAX_MASS_RATIO: f64 = 1e5;

impl MechanismSolver {
    /// Finds what the rows of free axes move: those with springs by all joints, as if all that is
    /// driven besides were held.
    pub(crate) fn find_masses(&mut self) {
        let Self { joints, bodies, .. } = self;
        for joint in &mut *joints {
            let responses = joint.own_responses(bodies);
            let locked = joint.locked;
            for (row, it) in (locked..).zip(&mut joint.free_rows) {
                it.set_mass(1.0 / responses[row]);
                it.hold();
            }
        }
        if !joints.iter().flat_map(|joint| &joint.free_rows).any(FreeRow::moves_with_all) {
            return;
        }
        self.factor();
        let Self { joints, matrix, right, .. } = self;
        for (number, joint) in joints.iter_mut().enumerate() {
            let rows = matrix.place(number) + joint.locked..;
            for (place, row) in rows.zip(&mut joint.free_rows).filter(|(_, row)| row.moves_with_all()) {
                right.fill([0.0; 4]);
                right.as_flattened_mut()[place] = 1.0;
                matrix.solve(right);
                let mass = right.as_flattened()[place];
                let is_locked = mass > MAX_MASS_RATIO * row.mass();
                row.set_mass(if is_locked { row.mass() } else { mass });
            }
        }
    }

    /// Sets the laws of rows of free axes for one half of a substep.
    pub(crate) fn begin_half(&mut self, half: Half) {
        if !self.has_free_rows {
            return;
        }
        let is_first = half.phase == Phase::Positions && std::mem::replace(&mut self.is_first, false);
        let friction_yields = self.is_softened && self.matrix.has_loops();
        let Self { joints, bodies, .. } = self;
        for joint in &mut *joints {
            joint.friction_yields = friction_yields;
            joint.prepare(bodies, half.phase, (half.h, half.before), is_first);
        }
        joints.iter_mut().for_each(|joint| joint.push_constants(bodies));
        self.soften();
    }

    /// Corrects the laws of rows of free axes by the solution on the right side. Returns whether it
    /// has to be found again.
    pub(crate) fn settle(&mut self, half: Half) -> bool {
        if !self.has_free_rows || half.phase == Phase::Begin {
            return false;
        }
        self.set_response();
        let Self { joints, bodies, matrix, right, response, .. } = self;
        let (right, response) = (right.as_flattened(), response.as_flattened());
        let mut is_changed = false;
        for (number, joint) in joints.iter_mut().enumerate() {
            let begin = matrix.place(number);
            is_changed |= joint.settle((half.phase, half.h), (&response[begin..], &right[begin..]));
        }
        if is_changed {
            joints.iter_mut().for_each(|joint| joint.push_constants(bodies));
            self.soften();
        }
        is_changed
    }

    /// Holds rows of free axes at bounds that the bodies went past in the substep. Returns whether
    /// there are any, with a matrix that knows.
    pub(crate) fn meet_bounds(&mut self, h: f64) -> bool {
        let Self { joints, bodies, .. } = self;
        let mut is_any = false;
        for joint in &mut *joints {
            is_any |= joint.meet_bounds(bodies, h);
        }
        if is_any {
            joints.iter_mut().for_each(|joint| joint.push_constants(bodies));
            self.soften();
            self.factor();
        }
        is_any
    }

    /// Finds how fast bodies move along free axes.
    pub(crate) fn find_free_speeds(&mut self) {
        let Self { joints, bodies, .. } = self;
        for joint in joints.iter_mut().filter(|joint| !joint.free_rows.is_empty()) {
            let speeds = joint.speeds(bodies);
            joint.take_free_speeds(&speeds);
        }
    }

    /// Notes what springs of free axes give at these speeds.
    pub(crate) fn note_springs(&mut self) {
        self.joints.iter_mut().flat_map(|joint| &mut joint.free_rows).for_each(FreeRow::note_springs);
    }
}
