//! How contacts of a mechanism's bodies answer each other through its joints.
//!
//! Impulses `f` along contact rows `C` and the impulses of joints `J` that go with them give the
//! speeds `(C M^-1 C^T - B^T K^-1 B) f`, with `B = J M^-1 C^T` and the joints' matrix `K = L D
//! L^T`: with `Y = L^-1 B` that is `Y^T D^-1 Y`, of all contact rows at once and without going back
//! to the bodies.

use tumble_math::lane::Vec3;

use crate::simd::{Four, FourKernel, FourLane, dispatch_fours};
use crate::solver::mechanism::block_kernels::fours;
use crate::solver::mechanism::mechanism_solver::MechanismSolver;

/// By row of the joints, a number for each row of contacts, in whole fours.
#[derive(Clone, Debug, Default)]
pub(crate) struct JointsByContacts {
    width: usize,
    numbers: Vec<Four>,
    /// The same times the inverse pivots.
    weighted: Vec<Four>,
}

impl MechanismSolver {
    /// Sets what a push that gives bodies these velocities does to the speeds of the joints.
    pub(crate) fn set_push(&self, row: usize, velocities: &[(usize, [Vec3<f64>; 2])], speeds: &mut JointsByContacts) {
        let zero = [Vec3::zero(); 2];
        let of = |body: usize| {
            let pushed = velocities.iter().filter(|pushed| pushed.0 == body);
            pushed.fold(zero, |sum, (_, by)| [sum[0] + by[0], sum[1] + by[1]])
        };
        for (number, joint) in self.joints.iter().enumerate() {
            if joint.ends().any(|body| velocities.iter().any(|pushed| pushed.0 == body)) {
                let of_joint = joint.speeds_by(of);
                for (i, speed) in of_joint.as_flattened().iter().enumerate().take(joint.count) {
                    let place = (self.matrix.place(number) + i) * speeds.width + row / 4;
                    speeds.numbers[place][row % 4] = if joint.is_off(i) { 0.0 } else { *speed };
                }
            }
        }
    }

    /// Zeros for this many rows of contacts.
    pub(crate) fn begin_responses(&self, rows: usize, speeds: &mut JointsByContacts) {
        speeds.width = fours(rows);
        speeds.numbers.clear();
        speeds.numbers.resize(4 * self.matrix.len() * speeds.width, [0.0; 4]);
    }

    /// Takes what joints do because of contacts off the responses of `n` rows, row by row.
    pub(crate) fn subtract_joints(&self, speeds: &mut JointsByContacts, responses: &mut [f64], n: usize) {
        dispatch_fours(Subtract { solver: self, speeds, responses, n });
    }
}

struct Subtract<'a> {
    solver: &'a MechanismSolver,
    speeds: &'a mut JointsByContacts,
    responses: &'a mut [f64],
    n: usize,
}

impl FourKernel for Subtract<'_> {
    #[inline(always)]
    fn run<T: FourLane>(self) {
        let Self { solver, speeds, responses, n } = self;
        let JointsByContacts { width, numbers, weighted } = speeds;
        let width = *width;
        solver.matrix.forward::<T>(numbers, width);
        weighted.clear();
        weighted.resize(numbers.len(), [0.0; 4]);
        solver.matrix.times_pivots::<T>(numbers, weighted, width);
        for (of_row, weighted) in numbers.chunks_exact(width).zip(weighted.chunks_exact(width)) {
            for (i, responses) in responses.chunks_exact_mut(n).enumerate() {
                let factor = of_row[i / 4][i % 4];
                if factor != 0.0 {
                    // The half up to the diagonal.
                    for (responses, weighted) in responses[..=i].chunks_mut(4).zip(weighted) {
                        responses.iter_mut().zip(weighted).for_each(|(response, by)| *response -= factor * by);
                    }
                }
            }
        }
    }
}
