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
    /// Rows of the joints with a number for one of the contacts, and that number.
    reached: Vec<(u32, f64)>,
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

/// How many fours are summed up in one pass over the joints' rows.
const SIDE_BY_SIDE: usize = 4;

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
        let JointsByContacts { width, numbers, weighted, reached } = speeds;
        let width = *width;
        solver.matrix.forward::<T>(numbers, width);
        weighted.clear();
        weighted.resize(numbers.len(), [0.0; 4]);
        solver.matrix.times_pivots::<T>(numbers, weighted, width);
        for (i, responses) in responses.chunks_exact_mut(n).enumerate() {
            // Most joints of a tree are not reached by a contact.
            let rows = (0..).zip(numbers.chunks_exact(width));
            reached.clear();
            reached.extend(rows.map(|(row, of_row)| (row, of_row[i / 4][i % 4])).filter(|(_, factor)| *factor != 0.0));
            // The half up to the diagonal.
            let (mut four, end) = (0, i / 4 + 1);
            while four < end {
                let of_row = |row: u32| &weighted[row as usize * width + four..];
                let responses = &mut responses[4 * four..];
                if four + SIDE_BY_SIDE <= end {
                    subtract::<T, SIDE_BY_SIDE>(reached, of_row, responses);
                    four += SIDE_BY_SIDE;
                } else {
                    subtract::<T, 1>(reached, of_row, responses);
                    four += 1;
                }
            }
        }
    }
}

/// Takes the products of factors and the first fours of their rows off as many numbers as there
/// are.
#[inline(always)]
fn subtract<'a, T: FourLane, const N: usize>(
    factors: &[(u32, f64)],
    of_row: impl Fn(u32) -> &'a [Four],
    responses: &mut [f64],
) {
    let mut sums = [T::splat(0.0); N];
    for (row, factor) in factors {
        let (numbers, factor) = (&of_row(*row)[..N], T::splat(*factor));
        for (sum, number) in sums.iter_mut().zip(numbers) {
            *sum = *sum + factor * T::load(number);
        }
    }
    let mut stored = [[0.0; 4]; N];
    for (stored, sum) in stored.iter_mut().zip(sums) {
        sum.store(stored);
    }
    for (response, sum) in responses.iter_mut().zip(stored.as_flattened()) {
        *response -= sum;
    }
}
