//! The matrix of a mechanism: how impulses of all its rows change their speeds.

use tumble_math::lane::Vec3;

use crate::integrators::derived::symmetric_product;
use crate::simd::{Four, FourKernel, FourLane, dispatch_fours};
use crate::solver::mechanism::block_kernels::{UNITS, fours, sized, unrolled};
use crate::solver::mechanism::block_ldl::{BlockLdl, Dependence, ends};
use crate::solver::mechanism::elimination::Elimination;
use crate::solver::mechanism::fours::vector;
use crate::solver::mechanism::joint_rows::JointRows;
use crate::solver::mechanism::mechanism_body::MechanismBody;
use crate::solver::mechanism::mechanism_rows::kernel;
use crate::solver::mechanism::mechanism_solver::{MechanismSolver, SIGNS};
use crate::solver::mechanism::pinned_kind::PinnedKind;

/// A body that two joints share, and where the numbers are of what it does.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Coupling {
    /// Row and column of the block.
    pub(super) joints: [u32; 2],
    /// At which end of each the body is.
    pub(super) ends: [u8; 2],
    pub(super) body: u32,
    /// In the matrix.
    pub(super) block: u32,
    /// In the columns of rows: directions and angular impulses of the first joint, directions and
    /// angular velocities of the second.
    of_row: [u32; 2],
    of_column: [u32; 2],
    /// Negative where one pushes the body and the other pulls.
    pub(super) sign: f64,
    /// Whether there is something in the block already.
    pub(super) adds: bool,
}

/// What one newton second along a row turns a body by: angular impulse, and angular velocity.
pub(crate) fn turning(body: &MechanismBody, arm: Vec3<f64>, linear: Vec3<f64>, angular: Vec3<f64>) -> [Vec3<f64>; 2] {
    let torque = arm.cross(linear) + angular;
    [torque, body.times_inverse_inertia(torque)]
}

/// By joint, along what its rows push its bodies, and what that turns them by: numbers of all rows
/// side by side.
#[derive(Clone, Debug, Default)]
pub(crate) struct RowColumns {
    /// By joint, where its numbers begin; and where the last ones end.
    starts: Vec<usize>,
    /// Of each joint the directions, linear and angular, and at either end the angular impulses and
    /// the angular velocities: vectors of three columns each. A gear has that of both its pairs of
    /// bodies. What is the same in every substep is set when these are made.
    columns: Vec<Four>,
}

/// Vectors for each row: two of its direction, and two at either end.
const VECTORS: usize = 6;

impl RowColumns {
    pub(super) fn new(joints: &[JointRows]) -> Self {
        let pairs = |joint: &JointRows| if joint.gear.is_some() { 2 } else { 1 };
        let starts = ends(joints.iter().map(|joint| pairs(joint) * VECTORS * 3 * fours(joint.count)));
        let mut columns = vec![[0.0; 4]; starts.last().copied().unwrap_or(0)];
        for (start, joint) in starts.iter().zip(joints).filter(|(_, joint)| joint.is_pinned()) {
            (0..3).for_each(|axis| columns[start + axis * fours(joint.count)][axis] = 1.0);
        }
        Self { starts, columns }
    }

    /// Where the directions of the rows of a joint begin, the angular impulses at an end and the
    /// angular velocities there, for rows that take this many fours.
    fn places(&self, joint: usize, end: usize, width: usize) -> [u32; 3] {
        let begin = self.starts[joint] + end / 2 * VECTORS * 3 * width;
        [0, 2 + 2 * (end % 2), 3 + 2 * (end % 2)].map(|vector| (begin + vector * 3 * width) as u32)
    }
}

/// Operations of a factorisation for each joint beyond which it costs more than passes, and for all
/// joints of a mechanism that cost next to nothing.
const MAX_OPERATIONS: usize = 4_000;
const MIN_OPERATIONS: usize = 1_000_000;

/// The matrix of joints between bodies of which some are moved by impulses, and the order in which
/// it has the joints; `None` where it `may_give_up` and the matrix would fill up.
pub(crate) fn arranged(joints: &[JointRows], moves: &[bool], may_give_up: bool) -> Option<(BlockLdl, Vec<u32>)> {
    let mut groups: Vec<Vec<u32>> = vec![Vec::new(); moves.len()];
    for (number, joint) in (0..).zip(joints) {
        for body in joint.ends().filter(|body| moves[*body]) {
            if groups[body].last() != Some(&number) {
                groups[body].push(number);
            }
        }
    }
    let mut left = if may_give_up { MIN_OPERATIONS.max(MAX_OPERATIONS * joints.len()) } else { usize::MAX };
    let elimination = Elimination::by_minimum_degree(joints.len(), &groups, |node, neighbors| {
        let rows = joints[node as usize].count;
        let of_others: usize = neighbors.iter().map(|other| joints[*other as usize].count).sum();
        left = left.saturating_sub(rows * of_others * (of_others + 2 * rows));
        left > 0
    })?;
    let order = elimination.order.clone();
    let sizes = order.iter().map(|joint| joints[*joint as usize].count).collect();
    Some((BlockLdl::new(elimination, sizes, dependence(joints, moves)), order))
}

/// Which rows of a mechanism may depend on others: of several joints, where there are loops, or of
/// one, where more act than it has freedoms.
fn dependence(joints: &[JointRows], moves: &[bool]) -> Dependence {
    let (moving, is_held) = (moves.iter().filter(|moves| **moves).count(), moves.contains(&false));
    if joints.len() + usize::from(!is_held) > moving {
        Dependence::BetweenJoints
    } else if joints.iter().flat_map(|joint| &joint.free_rows).any(|row| row.axis.is_of_limit()) {
        Dependence::WithinJoints
    } else {
        Dependence::None
    }
}

/// The bodies that joints share, of joints in the order of a matrix, and the blocks of joints that
/// share none.
pub(crate) fn couplings(
    joints: &[JointRows],
    moves: &[bool],
    matrix: &BlockLdl,
    columns: &RowColumns,
) -> (Vec<Coupling>, Vec<usize>) {
    let mut couplings: Vec<Coupling> = Vec::new();
    let mut filled = Vec::new();
    for (row, first) in joints.iter().enumerate() {
        for block in matrix.elimination.blocks_of(row) {
            let (column, count) = (matrix.elimination.columns[block] as usize, couplings.len());
            let second = &joints[column];
            for (a, body) in first.ends().enumerate().filter(|(_, body)| moves[*body]) {
                for (b, _) in second.ends().enumerate().filter(|(_, other)| *other == body) {
                    let [of_row, torque, _] = columns.places(row, a, fours(first.count));
                    let [of_column, _, response] = columns.places(column, b, fours(second.count));
                    couplings.push(Coupling {
                        joints: [row as u32, column as u32],
                        ends: [a as u8, b as u8],
                        body: body as u32,
                        block: matrix.block_start(block) as u32,
                        of_row: [of_row, torque],
                        of_column: [of_column, response],
                        sign: SIGNS[a % 2] * SIGNS[b % 2],
                        adds: couplings.len() > count,
                    });
                }
            }
            if couplings.len() == count {
                filled.push(block);
            }
        }
    }
    (couplings, filled)
}

impl MechanismSolver {
    /// Sets and factors the matrix, unless it is that of what there is already.
    pub(super) fn factor(&mut self) {
        if !self.is_touched || self.made_of.take_laws(&self.bodies, &self.joints, &self.matrix) {
            self.assemble();
            self.matrix.factor();
        }
    }

    fn assemble(&mut self) {
        match self.alike {
            Some(PinnedKind::BALL) => dispatch_fours(AssembleBalls { solver: self }),
            Some(PinnedKind::HINGE) => dispatch_fours(AssembleHinges { solver: self }),
            Some(PinnedKind::DRIVEN_HINGE) => dispatch_fours(AssembleDrivenHinges { solver: self }),
            Some(PinnedKind::WELD) => dispatch_fours(AssembleWelds { solver: self }),
            _ => {
                dispatch_fours(AssembleDiagonal { solver: self });
                dispatch_fours(AssembleBlocks { solver: self });
            }
        }
    }

    #[inline(always)]
    fn assemble_blocks<T: FourLane>(&mut self) {
        let Self { joints, bodies, matrix, couplings, filled, columns, .. } = self;
        filled.iter().for_each(|block| matrix.clear(*block));
        let (blocks, columns) = (matrix.blocks_mut(), &columns.columns[..]);
        for coupling in &*couplings {
            let (row, column) = (&joints[coupling.joints[0] as usize], &joints[coupling.joints[1] as usize]);
            let body = &bodies[coupling.body as usize];
            let factors = [coupling.sign * body.inverse_mass(), coupling.sign];
            let numbers = &mut blocks[coupling.block as usize..];
            let of_row = coupling.of_row.map(|start| &columns[start as usize..]);
            let of_column = coupling.of_column.map(|start| &columns[start as usize..]);
            if row.is_pinned() && column.is_pinned() {
                let pinned = true;
                sized!(set_coupling(of_row, of_column, (factors, coupling.adds, pinned), numbers; [row.count, column.count]));
            } else {
                let factors = (factors, coupling.adds, false);
                set_coupling::<T>(of_row, of_column, factors, numbers, [row.count, column.count]);
            }
            let width = fours(column.count);
            row.off_rows().for_each(|i| numbers[i * width..][..width].fill([0.0; 4]));
            for j in column.off_rows() {
                (0..row.count).for_each(|i| numbers[i * width + j / 4][j % 4] = 0.0);
            }
        }
    }

    #[inline(always)]
    fn assemble_diagonal<T: FourLane>(&mut self) {
        let Self { joints, bodies, matrix, columns, .. } = self;
        for (number, joint) in joints.iter().enumerate() {
            let columns = &mut columns.columns[columns.starts[number]..columns.starts[number + 1]];
            if joint.gear.is_some() {
                matrix.diagonal_mut(number)[0][0] = of_gear(joint, bodies, columns);
                matrix.raise(number, 1);
                continue;
            }
            let (n, diagonal) = (joint.count, matrix.diagonal_mut(number));
            match n {
                0 => continue,
                3 => set_diagonal::<T>(joint, bodies, columns, diagonal, 3),
                5 => set_diagonal::<T>(joint, bodies, columns, diagonal, 5),
                6 => set_diagonal::<T>(joint, bodies, columns, diagonal, 6),
                _ => set_diagonal::<T>(joint, bodies, columns, diagonal, n),
            }
            let width = fours(n);
            for (row, law) in (joint.locked..n).zip(&joint.free_rows) {
                if law.constant.is_some() {
                    (0..row).for_each(|other| diagonal[row * width + other / 4][other % 4] = 0.0);
                    (row + 1..n).for_each(|other| diagonal[other * width + row / 4][row % 4] = 0.0);
                    diagonal[row * width + row / 4][row % 4] = 1.0;
                } else {
                    diagonal[row * width + row / 4][row % 4] += law.gamma;
                }
            }
            match n {
                3 => matrix.raise(number, 3),
                5 => matrix.raise(number, 5),
                6 => matrix.raise(number, 6),
                _ => matrix.raise(number, n),
            }
        }
    }
}

// One for each number of rows: one for all would take far longer to compile.
kernel!(AssembleBalls {} => |solver| solver.assemble_alike::<T, 3>(PinnedKind::BALL));
kernel!(AssembleHinges {} => |solver| solver.assemble_alike::<T, 5>(PinnedKind::HINGE));
kernel!(AssembleDrivenHinges {} => |solver| solver.assemble_alike::<T, 6>(PinnedKind::DRIVEN_HINGE));
kernel!(AssembleWelds {} => |solver| solver.assemble_alike::<T, 6>(PinnedKind::WELD));
kernel!(AssembleDiagonal {} => |solver| solver.assemble_diagonal::<T>());
kernel!(AssembleBlocks {} => |solver| solver.assemble_blocks::<T>());

/// Sets or adds what a body does that two joints share, of `n` and `m` rows: factors are of the
/// linear and of the angular part. Directions of two pinned joints are not read.
#[inline(always)]
fn set_coupling<T: FourLane>(
    of_row: [&[Four]; 2],
    of_column: [&[Four]; 2],
    ([inverse_mass, sign], adds, is_pinned): ([f64; 2], bool, bool),
    numbers: &mut [Four],
    [n, m]: [usize; 2],
) {
    let (w, v) = (fours(n), fours(m));
    let [linear, torque] = of_row.map(|vector| &vector[..3 * w]);
    let [linear_column, response] = of_column.map(|vector| &vector[..3 * v]);
    let numbers = &mut numbers[..n * v];
    let [inverse_mass, sign] = [T::splat(inverse_mass), T::splat(sign)];
    unrolled!(i in n {
        for j in 0..v {
            let mut sum = sign * row_by_columns::<T>(torque, i, w, response, j, v);
            if !is_pinned {
                sum = inverse_mass * row_by_columns::<T>(linear, i, w, linear_column, j, v) + sum;
            } else if i < 3 && j == 0 {
                sum = inverse_mass * T::load(&UNITS[i % 4]) + sum;
            }
            let sum = if adds { T::load(&numbers[i * v + j]) + sum } else { sum };
            sum.store(&mut numbers[i * v + j]);
        }
    });
}

/// The vector of row `i` times those of the four rows from `4 j` on; each are as many fours wide as
/// `w` and `v` say.
#[inline(always)]
fn row_by_columns<T: FourLane>(row: &[Four], i: usize, w: usize, columns: &[Four], j: usize, v: usize) -> T {
    T::splat(row[i / 4][i % 4]) * T::load(&columns[j])
        + T::splat(row[w + i / 4][i % 4]) * T::load(&columns[v + j])
        + T::splat(row[2 * w + i / 4][i % 4]) * T::load(&columns[2 * v + j])
}

/// Sets what `n` rows of a joint push along, what they turn its bodies by, and how these respond.
#[inline(always)]
fn set_diagonal<T: FourLane>(
    joint: &JointRows,
    bodies: &[MechanismBody],
    columns: &mut [Four],
    diagonal: &mut [Four],
    n: usize,
) {
    let w = fours(n);
    let (columns, diagonal) = (&mut columns[..VECTORS * 3 * w], &mut diagonal[..n * w]);
    let (directions, turning) = columns.split_at_mut(6 * w);
    // The first rows of a pinned joint are always the same.
    let first = if joint.is_pinned() { 3 } else { 0 };
    unrolled!(row in n {
        if row >= first {
            let (along, about) = (joint.linear[row], vector(&joint.angular[row]));
            let numbers = [along.x, along.y, along.z, about.x, about.y, about.z];
            for (axis, number) in numbers.into_iter().enumerate() {
                directions[axis * w + row / 4][row % 4] = number;
            }
        }
    });
    let (linear, angular) = directions.split_at(3 * w);
    for (end, turning) in turning.chunks_exact_mut(6 * w).enumerate() {
        let body = &bodies[joint.bodies[end]];
        let arm = lanes::<T>(joint.arm(end));
        let [d, o] = body.inverse_inertia().map(lanes::<T>);
        let (torques, responses) = turning.split_at_mut(3 * w);
        for j in 0..w {
            let along = Vec3::new(T::load(&linear[j]), T::load(&linear[w + j]), T::load(&linear[2 * w + j]));
            let about = Vec3::new(T::load(&angular[j]), T::load(&angular[w + j]), T::load(&angular[2 * w + j]));
            let torque = arm.cross(along) + about;
            let response = symmetric_product(d, o, torque);
            torque.x.store(&mut torques[j]);
            torque.y.store(&mut torques[w + j]);
            torque.z.store(&mut torques[2 * w + j]);
            response.x.store(&mut responses[j]);
            response.y.store(&mut responses[w + j]);
            response.z.store(&mut responses[2 * w + j]);
        }
    }
    let inverse_mass: f64 = joint.bodies.iter().map(|body| bodies[*body].inverse_mass()).sum();
    let inverse_mass = T::splat(inverse_mass);
    let is_pinned = joint.is_pinned();
    unrolled!(i in n {
        // To the left of the diagonal, and as far beyond as fours go.
        for j in 0..=i / 4 {
            let mut sum = row_by_columns::<T>(&turning[3 * w..], i, w, turning, j, w)
                + row_by_columns::<T>(&turning[9 * w..], i, w, &turning[6 * w..], j, w);
            if !is_pinned {
                sum = inverse_mass * row_by_columns::<T>(linear, i, w, linear, j, w) + sum;
            } else if i < 3 && j == 0 {
                sum = inverse_mass * T::load(&UNITS[i % 4]) + sum;
            }
            sum.store(&mut diagonal[i * w + j]);
        }
    });
}

#[inline(always)]
fn lanes<T: FourLane>(v: Vec3<f64>) -> Vec3<T> {
    Vec3::new(T::splat(v.x), T::splat(v.y), T::splat(v.z))
}

/// Sets what a gear turns its bodies by, and returns how its row responds.
fn of_gear(joint: &JointRows, bodies: &[MechanismBody], columns: &mut [Four]) -> f64 {
    let Some(gear) = &joint.gear else { return 0.0 };
    let mut turnings = [[Vec3::zero(); 2]; 4];
    for (pair, of_pair) in gear.joints.iter().enumerate() {
        let linear = gear.linear[pair];
        for end in 0..2 {
            let body = &bodies[of_pair.bodies[end]];
            turnings[2 * pair + end] = turning(body, of_pair.arm(end), linear, gear.angular[pair]);
        }
        let [first, second] = [turnings[2 * pair], turnings[2 * pair + 1]];
        let vectors = [linear, gear.angular[pair], first[0], first[1], second[0], second[1]];
        for (of_vector, v) in columns[3 * VECTORS * pair..].chunks_exact_mut(3).zip(vectors) {
            (of_vector[0][0], of_vector[1][0], of_vector[2][0]) = (v.x, v.y, v.z);
        }
    }
    let mut sum = 0.0;
    for (a, body) in joint.ends().enumerate() {
        for (b, _) in joint.ends().enumerate().filter(|(_, other)| *other == body) {
            let sign = SIGNS[a % 2] * SIGNS[b % 2];
            let linear = bodies[body].inverse_mass() * gear.linear[a / 2].dot(gear.linear[b / 2]);
            sum += sign * (linear + turnings[a][0].dot(turnings[b][1]));
        }
    }
    sum
}
