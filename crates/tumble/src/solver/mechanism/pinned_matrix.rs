//! The matrix of a mechanism whose joints are all of one kind, four blocks at a time.
#![allow(clippy::needless_range_loop, reason = "rows and columns are numbers of the matrix")]

use tumble_math::lane::Vec3;

use crate::integrators::derived::symmetric_product;
use crate::simd::{Four, FourLane};
use crate::solver::mechanism::block_kernels::fours;
use crate::solver::mechanism::fours::{by_place, four_of, is_new, of_each, vectors};
use crate::solver::mechanism::free_row::FreeRow;
use crate::solver::mechanism::joint_rows::JointRows;
use crate::solver::mechanism::mechanism_matrix::Coupling;
use crate::solver::mechanism::mechanism_solver::MechanismSolver;
use crate::solver::mechanism::pinned_joints::{PinnedJoints, axes_of};
use crate::solver::mechanism::pinned_kind::PinnedKind;

/// What turns bodies of four joints at an end: the arms, and the axes of turning rows.
struct Levers<T> {
    arm: Vec3<T>,
    axes: [Vec3<T>; 3],
}

/// Inverse inertia of four bodies in the world.
type InverseInertia<T> = (Vec3<T>, Vec3<T>);

impl<T: FourLane> Levers<T> {
    #[inline(always)]
    fn of(joints: [&JointRows; 4], ends: [usize; 4], kind: PinnedKind) -> Self {
        let [e, f, g, h] = ends;
        let [a, b, c, d] = joints;
        let (arm, _) = vectors::<T>([&a.arms[e], &b.arms[f], &c.arms[g], &d.arms[h]]);
        let mut axes = [Vec3::splat(T::splat(0.0)); 3];
        by_place!(rotation of 3 {
            if rotation < kind.turning_rows() {
                axes[rotation] = axes_of(joints, rotation);
            }
        });
        Self { arm, axes }
    }

    /// The angular velocity that one newton second along a row gives.
    #[inline(always)]
    fn response(&self, row: usize, (d, o): InverseInertia<T>) -> Vec3<T> {
        let Vec3 { x, y, z } = self.arm;
        match row {
            0 => Vec3::new(o.z * z - o.y * y, d.y * z - o.x * y, o.x * z - d.z * y),
            1 => Vec3::new(o.y * x - d.x * z, o.x * x - o.z * z, d.z * x - o.y * z),
            2 => Vec3::new(d.x * y - o.z * x, o.z * y - d.y * x, o.y * y - o.x * x),
            _ => symmetric_product(d, o, self.axes[row - 3]),
        }
    }

    /// The speed along a row of bodies that turn at this angular velocity.
    #[inline(always)]
    fn speed(&self, row: usize, turn: Vec3<T>) -> T {
        let Vec3 { x, y, z } = self.arm;
        match row {
            0 => z * turn.y - y * turn.z,
            1 => x * turn.z - z * turn.x,
            2 => y * turn.x - x * turn.y,
            _ => self.axes[row - 3].dot(turn),
        }
    }
}

impl MechanismSolver {
    /// Sets the matrix where all joints are of this kind, of `N` rows.
    #[inline(always)]
    pub(super) fn assemble_alike<T: FourLane, const N: usize>(&mut self, kind: PinnedKind) {
        self.filled.iter().for_each(|block| self.matrix.clear(*block));
        for first in (0..self.joints.len()).step_by(4) {
            self.set_diagonals::<T, N>(first, kind);
        }
        for first in (0..self.couplings.len()).step_by(4) {
            self.set_couplings::<T, N>(first, kind);
        }
    }

    #[inline(always)]
    fn set_diagonals<T: FourLane, const N: usize>(&mut self, first: usize, kind: PinnedKind) {
        let Self { joints, bodies, matrix, .. } = self;
        let four = PinnedJoints::<T>::of(joints, first, kind);
        let zero = T::splat(0.0);
        let mut sums = [[zero; N]; N];
        let mut inverse_mass = zero;
        for end in 0..2 {
            let bodies = four.bodies(bodies, end);
            let levers = Levers::of(four.joints(), [end; 4], kind);
            let inertia = inverse_inertia::<T>(of_each!(bodies, body => &body.inverse_inertia));
            for row in 0..N {
                let response = levers.response(row, inertia);
                for column in 0..=row {
                    let speed = levers.speed(column, response);
                    sums[row][column] = if end == 0 { speed } else { sums[row][column] + speed };
                }
            }
            inverse_mass = inverse_mass + vectors::<T>(of_each!(bodies, body => &body.linear)).1;
        }
        if kind.has_free_row {
            let softness = softness_of_free::<T>(four.joints());
            let is_off = is_infinite(softness);
            for column in 0..N {
                let sum = sums[N - 1][column];
                let (sum, in_place) = if column == N - 1 { (sum + softness, T::splat(1.0)) } else { (sum, zero) };
                sums[N - 1][column] = T::select(is_off, in_place, sum);
            }
        }
        let softness = T::load(&of_each!(four.numbers(), number => matrix.softness(number)));
        let mut raised = [zero; N];
        for row in 0..N {
            let sum = if row < 3 { inverse_mass + sums[row][row] } else { sums[row][row] };
            raised[row] = sum * softness;
            sums[row][row] = sum * (T::splat(1.0) + softness);
        }
        let (raised, rows) = (quads(&raised), quads_of_rows(&sums));
        by_place!(k of 4 {
            let number = four.numbers()[k];
            let diagonal = &mut matrix.diagonal_mut(number)[..N * fours(N)];
            for row in 0..N {
                rows[row][0][k].store(&mut diagonal[row * fours(N)]);
                if row > 3 {
                    rows[row][1][k].store(&mut diagonal[row * fours(N) + 1]);
                }
            }
            let of_node = &mut matrix.raised_mut(number)[..fours(N)];
            raised[0][k].store(&mut of_node[0]);
            if N > 4 {
                raised[1][k].store(&mut of_node[1]);
            }
        });
    }

    #[inline(always)]
    fn set_couplings<T: FourLane, const N: usize>(&mut self, first: usize, kind: PinnedKind) {
        let Self { joints, bodies, matrix, couplings, .. } = self;
        let numbers = four_of(first, couplings.len());
        let four: [&Coupling; 4] = of_each!(numbers, number => &couplings[number]);
        let side = |side: usize| {
            (of_each!(four, it => &joints[it.joints[side] as usize]), of_each!(four, it => usize::from(it.ends[side])))
        };
        let ((of_rows, row_ends), (of_columns, column_ends)) = (side(0), side(1));
        let rows = Levers::<T>::of(of_rows, row_ends, kind);
        let columns = Levers::<T>::of(of_columns, column_ends, kind);
        let inertia = inverse_inertia::<T>(of_each!(four, it => &bodies[it.body as usize].inverse_inertia));
        let sign = T::load(&of_each!(four, it => it.sign));
        let inverse_mass = sign * T::load(&of_each!(four, it => bodies[it.body as usize].inverse_mass()));
        let zero = T::splat(0.0);
        let mut sums = [[zero; N]; N];
        for column in 0..N {
            let response = columns.response(column, inertia);
            for row in 0..N {
                let sum = sign * rows.speed(row, response);
                sums[row][column] = if row == column && row < 3 { inverse_mass + sum } else { sum };
            }
        }
        if kind.has_free_row {
            let row_is_off = is_infinite(softness_of_free::<T>(of_rows));
            let column_is_off = is_infinite(softness_of_free::<T>(of_columns));
            for k in 0..N {
                sums[N - 1][k] = T::select(row_is_off, zero, sums[N - 1][k]);
                sums[k][N - 1] = T::select(column_is_off, zero, sums[k][N - 1]);
            }
        }
        let rows = quads_of_rows(&sums);
        let blocks = matrix.blocks_mut();
        by_place!(k of 4 {
            if is_new(numbers, k) {
                let block: &mut [Four] = &mut blocks[four[k].block as usize..][..N * fours(N)];
                for (at, number) in block.iter_mut().enumerate() {
                    let sum = rows[at / fours(N)][at % fours(N)][k];
                    let sum = if four[k].adds { T::load(number) + sum } else { sum };
                    sum.store(number);
                }
            }
        });
    }
}

/// What is added to the diagonal of the free rows of joints.
#[inline(always)]
fn softness_of_free<T: FourLane>(joints: [&JointRows; 4]) -> T {
    T::load(&of_each!(joints, joint => FreeRow::softness_of_first(&joint.free_rows)))
}

/// Where a number is infinite, of those that are not negative.
#[inline(always)]
fn is_infinite<T: FourLane>(number: T) -> T::Mask {
    T::splat(f64::MAX).lt(number)
}

#[inline(always)]
fn inverse_inertia<T: FourLane>(inertias: [&[Four; 2]; 4]) -> InverseInertia<T> {
    let (diagonal, _) = vectors::<T>(of_each!(inertias, inertia => &inertia[0]));
    let (off_diagonal, _) = vectors::<T>(of_each!(inertias, inertia => &inertia[1]));
    (diagonal, off_diagonal)
}

/// The rows of four blocks, block by block, in fours.
#[inline(always)]
fn quads_of_rows<T: FourLane, const N: usize>(rows: &[[T; N]; N]) -> [[[T; 4]; 2]; N] {
    let mut all = [quads(&rows[0]); N];
    for row in 1..N {
        all[row] = quads(&rows[row]);
    }
    all
}

/// The same of one row.
#[inline(always)]
fn quads<T: FourLane, const N: usize>(row: &[T; N]) -> [[T; 4]; 2] {
    [quad_of(row, 0), quad_of(row, 1)]
}

/// Four numbers of a row in each of four blocks, block by block.
#[inline(always)]
fn quad_of<T: FourLane, const N: usize>(row: &[T; N], quad: usize) -> [T; 4] {
    let number = |k: usize| if 4 * quad + k < N { row[4 * quad + k] } else { T::splat(0.0) };
    T::transpose([number(0), number(1), number(2), number(3)])
}
