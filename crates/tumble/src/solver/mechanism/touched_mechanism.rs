//! Mechanisms that contacts act on: solutions for their joints, between those of contacts.

use crate::solver::mechanism::free_row::Phase;
use crate::solver::mechanism::mechanism_solver::{Half, MechanismSolver};

impl MechanismSolver {
    /// Finds the impulses that meet the joints at the end of a substep of `h` \[s\] to first order,
    /// where others move the bodies.
    pub(crate) fn solve_once(&mut self, h: f64) {
        let half = Half { phase: Phase::Positions, h, before: 1.0 };
        self.begin_half(half);
        self.factor();
        self.plan_corrections(h);
        self.solve_half(half);
        self.impulses.copy_from_slice(&self.right);
        self.push();
        self.note_springs();
        self.note_impulses(true);
        self.take_loads(h);
    }

    /// Takes back what [`solve_once`](Self::solve_once) has found along free axes, of which the
    /// laws say what acts there in all of a substep.
    pub(crate) fn take_back(&mut self) {
        let Self { joints, matrix, impulses, right, .. } = self;
        let impulses = impulses.as_flattened_mut();
        for (number, joint) in joints.iter_mut().enumerate() {
            let begin = matrix.place(number);
            impulses[begin..begin + joint.locked].fill(0.0);
            impulses[begin + joint.locked..begin + joint.count].iter_mut().for_each(|impulse| *impulse *= -1.0);
            joint.free_rows.iter_mut().for_each(|row| row.pushed = 0.0);
        }
        right.copy_from_slice(&self.impulses);
        self.push();
        self.note_impulses(false);
    }

    /// Forgets what was not finite.
    pub(crate) fn forget_impulses(&mut self) {
        self.impulses.fill([0.0; 4]);
        self.done.fill([[0.0; 4]; 2]);
        self.joints.iter_mut().flat_map(|joint| &mut joint.free_rows).for_each(|row| row.pushed = 0.0);
    }

    /// Takes out the velocities against the joints, where others have moved the bodies for `h`
    /// \[s\].
    pub(crate) fn solve_velocities_once(&mut self, h: f64) {
        self.solve_velocities(Half { phase: Phase::Velocities, h, before: 1.0 });
    }
}
