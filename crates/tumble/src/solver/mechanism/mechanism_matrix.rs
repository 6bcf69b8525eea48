//! The matrix of a mechanism: how impulses of all its rows change their speeds.

use tumble_math::lane::Vec3;

use crate::solver::mechanism::block_ldl::{BlockLdl, MAX_ROWS};
use crate::solver::mechanism::elimination::Elimination;
use crate::solver::mechanism::joint_rows::JointRows;
use crate::solver::mechanism::mechanism_body::MechanismBody;
use crate::solver::mechanism::mechanism_solver::{MechanismSolver, SIGNS};

/// A body that two joints share.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Coupling {
    block: usize,
    /// Row and column of the block, and which end of each joint the body is.
    joints: [usize; 2],
    ends: [usize; 2],
}

/// What one newton second along a row turns a body by: angular impulse, and angular velocity.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turning {
    pub(crate) torque: Vec3<f64>,
    pub(crate) response: Vec3<f64>,
}

impl Turning {
    pub(crate) const NONE: Self = {
        let zero = Vec3 { x: 0.0, y: 0.0, z: 0.0 };
        Self { torque: zero, response: zero }
    };

    pub(crate) fn of(body: &MechanismBody, arm: Vec3<f64>, linear: Vec3<f64>, angular: Vec3<f64>) -> Self {
        let torque = arm.cross(linear) + angular;
        Self { torque, response: body.times_inverse_inertia(torque) }
    }
}

/// The matrix of joints between bodies of which some are moved by impulses, the bodies that joints
/// share, and the order in which the matrix has the joints.
pub(crate) fn arranged(joints: &[JointRows], moves: &[bool]) -> (BlockLdl, Vec<Coupling>, Vec<u32>) {
    let mut groups: Vec<Vec<u32>> = vec![Vec::new(); moves.len()];
    for (number, joint) in (0..).zip(joints) {
        for body in joint.ends().filter(|body| moves[*body]) {
            if groups[body].last() != Some(&number) {
                groups[body].push(number);
            }
        }
    }
    let elimination = Elimination::by_minimum_degree(joints.len(), &groups);
    let order = elimination.order.clone();
    let mut couplings = Vec::new();
    for row in 0..order.len() {
        for block in elimination.blocks_of(row) {
            let column = elimination.columns[block] as usize;
            let [first, second] = [row, column].map(|place| &joints[order[place] as usize]);
            for (a, body) in first.ends().enumerate().filter(|(_, body)| moves[*body]) {
                for (b, _) in second.ends().enumerate().filter(|(_, other)| *other == body) {
                    couplings.push(Coupling { block, joints: [row, column], ends: [a, b] });
                }
            }
        }
    }
    let sizes = order.iter().map(|joint| joints[*joint as usize].count).collect();
    (BlockLdl::new(elimination, sizes), couplings, order)
}

impl MechanismSolver {
    /// Sets and factors the matrix.
    pub(super) fn factor(&mut self) {
        self.assemble();
        self.matrix.factor();
    }

    fn assemble(&mut self) {
        self.assemble_diagonal();
        let Self { joints, bodies, matrix, couplings, turning, .. } = self;
        matrix.clear();
        for &Coupling { block, joints: [first, second], ends } in &*couplings {
            let (row, column) = (&joints[first], &joints[second]);
            // Of a gear the third and fourth end have the second of its directions.
            let [pairs, ends] = [ends.map(|end| end / 2), ends.map(|end| end % 2)];
            let sign = SIGNS[ends[0]] * SIGNS[ends[1]];
            let body = if pairs[0] == 0 { row.bodies[ends[0]] } else { row.ends().nth(2 + ends[0]).unwrap_or(0) };
            let inverse_mass = sign * bodies[body].inverse_mass;
            let (of_row, of_column) = (&turning[first][ends[0]][pairs[0]..], &turning[second][ends[1]][pairs[1]..]);
            let (linear_row, linear_column) = (row.linear_of(pairs[0]), column.linear_of(pairs[1]));
            let numbers = matrix.block_mut(block);
            let add = |numbers: &mut [f64], n: usize, m: usize| {
                let (linear_row, linear_column) = (&linear_row[..n], &linear_column[..m]);
                let (of_row, of_column, numbers) = (&of_row[..n], &of_column[..m], &mut numbers[..n * m]);
                for i in 0..n {
                    for j in 0..m {
                        numbers[i * m + j] += inverse_mass * linear_row[i].dot(linear_column[j])
                            + sign * of_row[i].torque.dot(of_column[j].response);
                    }
                }
            };
            match [row.count, column.count] {
                [3, 3] => add(numbers, 3, 3),
                [5, 5] => add(numbers, 5, 5),
                [6, 6] => add(numbers, 6, 6),
                [n, m] => add(numbers, n, m),
            }
            if !(row.free_rows.is_empty() && column.free_rows.is_empty()) {
                let is_off = |place: &usize| row.is_off(place / column.count) || column.is_off(place % column.count);
                (0..numbers.len()).filter(is_off).for_each(|place| numbers[place] = 0.0);
            }
        }
    }

    fn assemble_diagonal(&mut self) {
        let Self { joints, bodies, matrix, turning, .. } = self;
        for (number, (joint, turning)) in joints.iter().zip(&mut *turning).enumerate() {
            if joint.gear.is_some() {
                matrix.diagonal_mut(number)[0] = of_gear(joint, bodies, turning);
                continue;
            }
            let (n, diagonal) = (joint.count, matrix.diagonal_mut(number));
            match n {
                3 => set_diagonal(joint, bodies, turning, diagonal, 3),
                5 => set_diagonal(joint, bodies, turning, diagonal, 5),
                6 => set_diagonal(joint, bodies, turning, diagonal, 6),
                _ => set_diagonal(joint, bodies, turning, diagonal, n),
            }
            for (row, law) in (joint.locked..n).zip(&joint.free_rows) {
                if law.constant.is_some() {
                    (0..n).for_each(|other| (diagonal[row * n + other], diagonal[other * n + row]) = (0.0, 0.0));
                    diagonal[row * n + row] = 1.0;
                } else {
                    diagonal[row * n + row] += law.gamma;
                }
            }
        }
    }
}

/// Sets what the rows of a joint turn its bodies by, and how these respond, for `n` rows.
#[inline(always)]
fn set_diagonal(
    joint: &JointRows,
    bodies: &[MechanismBody],
    turning: &mut [[Turning; MAX_ROWS]; 2],
    diagonal: &mut [f64],
    n: usize,
) {
    let diagonal = &mut diagonal[..n * n];
    let (linear, angular) = (&joint.linear[..n], &joint.angular[..n]);
    for (end, turning) in turning.iter_mut().enumerate() {
        let body = &bodies[joint.bodies[end]];
        let turning = &mut turning[..n];
        for row in 0..n {
            turning[row] = Turning::of(body, joint.arms[end], linear[row], angular[row]);
        }
    }
    let inverse_mass: f64 = joint.bodies.iter().map(|body| bodies[*body].inverse_mass).sum();
    let [first, second] = turning.each_ref().map(|turning| &turning[..n]);
    for i in 0..n {
        for j in i..n {
            let mut sum = inverse_mass * linear[i].dot(linear[j]);
            sum += first[i].torque.dot(first[j].response);
            sum += second[i].torque.dot(second[j].response);
            (diagonal[i * n + j], diagonal[j * n + i]) = (sum, sum);
        }
    }
}

/// Sets what a gear turns its bodies by, and returns how its row responds.
fn of_gear(joint: &JointRows, bodies: &[MechanismBody], turning: &mut [[Turning; MAX_ROWS]; 2]) -> f64 {
    let Some(gear) = &joint.gear else { return 0.0 };
    for (pair, of_pair) in gear.joints.iter().enumerate() {
        for (end, turning) in turning.iter_mut().enumerate() {
            let body = &bodies[of_pair.bodies[end]];
            turning[pair] = Turning::of(body, of_pair.arms[end], gear.linear[pair], gear.angular[pair]);
        }
    }
    let mut sum = 0.0;
    for (a, body) in joint.ends().enumerate() {
        for (b, _) in joint.ends().enumerate().filter(|(_, other)| *other == body) {
            let sign = SIGNS[a % 2] * SIGNS[b % 2];
            let linear = bodies[body].inverse_mass * gear.linear[a / 2].dot(gear.linear[b / 2]);
            sum += sign * (linear + turning[a % 2][a / 2].torque.dot(turning[b % 2][b / 2].response));
        }
    }
    sum
}
