//! The substeps of one mechanism: impulses of all joints at once, and the motion of its bodies.

use tumble_math::lane::Vec3;

use crate::joints::axes::Axes;
use crate::joints::axis_lock::AxisLock;
use crate::math::Real;
use crate::simd::Four;
use crate::solver::mechanism::block_ldl::BlockLdl;
use crate::solver::mechanism::body_passes::{drift, follow, take_loads};
use crate::solver::mechanism::free_row::Phase;
use crate::solver::mechanism::joint_free_rows::has_distance;
use crate::solver::mechanism::joint_rows::JointRows;
use crate::solver::mechanism::matrix_inputs::MatrixInputs;
use crate::solver::mechanism::mechanism_body::{MechanismBody, SavedBody};
use crate::solver::mechanism::mechanism_matrix::{Coupling, RowColumns, arranged, couplings};
use crate::solver::mechanism::mechanism_rows::Impulses;
use crate::solver::mechanism::mechanism_substeps::MAX_ERROR;
use crate::solver::mechanism::pinned_kind::PinnedKind;

/// Bodies that hang together, their joints, and the matrix of these.
#[derive(Clone, Debug)]
pub(crate) struct MechanismSolver {
    pub(crate) bodies: Vec<MechanismBody>,
    /// Where the substep began.
    pub(super) saved: Vec<SavedBody>,
    /// By how much joints contradict each other at the start of this substep, of the size of the
    /// arms or \[rad\].
    pub(super) misfit: f64,
    /// How many substeps have been solved in this step, halves counted.
    pub(crate) parts: u32,
    /// Whether shorter substeps did not help in this step.
    pub(super) is_stuck: bool,
    /// In the order of elimination.
    pub(crate) joints: Vec<JointRows>,
    /// Of mechanisms whose joints are all of one kind, this.
    pub(super) alike: Option<PinnedKind>,
    /// The same of each four joints, one after the other in the order of elimination.
    pub(super) alike_fours: Vec<Option<PinnedKind>>,
    pub(super) matrix: BlockLdl,
    /// What the rows and the matrix were last made of.
    pub(super) made_of: MatrixInputs,
    pub(super) couplings: Vec<Coupling>,
    /// Blocks of joints that share no body.
    pub(super) filled: Vec<usize>,
    /// By joint, what it has done since the step began: impulse \[N s\] on the second body, and
    /// angular impulse about its anchor [N m s].
    pub(crate) done: Vec<[Four; 2]>,
    pub(super) columns: RowColumns,
    /// By row.
    pub(super) impulses: Vec<Four>,
    pub(super) right: Vec<Four>,
    /// The solution before.
    last: Vec<Four>,
    /// By row, what the bodies' paths bend by in a substep as a speed: what solutions after the
    /// first of the last substep took out.
    pub(super) bend: Vec<Four>,
    /// By body, the linear and angular velocities that impulses of all rows give.
    pub(super) velocities: Vec<[Four; 2]>,
    /// By body, velocities of pushes; zero between these.
    pub(super) pushed: Vec<[Vec3<f64>; 2]>,
    /// By body: sum of impulse times arm.
    pub(super) pulls: Vec<f64>,
    /// By row: how impulses change the speeds.
    pub(super) response: Vec<Four>,
    /// Whether a contact acts on one of the bodies in this substep.
    pub(super) is_touched: bool,
    /// Whether rows are raised by more, as joints are not met.
    pub(super) is_softened: bool,
    /// What the right side was before a solution, and a sum of solutions.
    pub(super) asked: Vec<Four>,
    pub(super) solved: Vec<Four>,
    /// How much of it no impulses give, of the size of the arms [1/s].
    pub(super) contradiction: f64,
    /// Whether joints contradicted each other in this step, and what joints did to the energy
    /// \[J\].
    pub(super) contradicts: bool,
    pub(super) gain: f64,
    pub(super) has_free_rows: bool,
    /// Whether there are ropes or rods, which may add energy where they are closed.
    pub(super) has_distances: bool,
    /// Whether no substep of this step has been solved.
    pub(super) is_first: bool,
    /// How many of the bodies are the ground of locked axes; they are the last.
    pub(super) grounds: usize,
    /// What these leave to the whole if nothing else holds it.
    pub(super) lock_of_whole: AxisLock,
}

/// Which half of a substep of `h` \[s\] is solved, and the share of forces in the first.
#[derive(Clone, Copy)]
pub(crate) struct Half {
    pub(crate) phase: Phase,
    pub(crate) h: f64,
    pub(crate) before: f64,
}

/// What a solution has changed in the matrix.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum MatrixChange {
    None,
    /// A row acts that did not, or no longer acts.
    Rows,
    /// Bodies have more inertia.
    Inertia,
}

/// Solutions for the impulses of a substep, at most.
const MAX_SOLUTIONS: u32 = 4;
/// The same where bodies went past a bound with the first of them.
const MAX_SOLUTIONS_AT_BOUNDS: u32 = 8;
/// The errors at which impulses are accepted: of the size of the arms, and \[rad\]. In single
/// precision a tenth of the rounding of the state.
const TOLERANCE: f64 = if size_of::<Real>() == size_of::<f64>() { 1e-10 } else { 1.2e-8 };
/// The same after the first solution, whose errors have one sign in all substeps of a slow swing.
const FIRST_TOLERANCE: f64 = 1e-10;
/// The error after the first solution, of the same size, beyond which the next substep is too
/// different to begin with the bend of this one.
const MAX_FIRST_ERROR: f64 = 1e-4;
/// Solutions before the first of these, with more inertia each, at most.
const MAX_RAISES: u32 = 3;
/// Solutions in which rows along free axes change between parts of their laws, at most.
const MAX_CHANGES: u32 = 6;
/// The direction of a joint's impulse on each of its bodies.
pub(crate) const SIGNS: [f64; 2] = [-1.0, 1.0];

impl MechanismSolver {
    /// Of joints between bodies that are numbered from 0; `moves` says which of these impulses
    /// move. Returns the order in which it has the joints; `None` where it `may_give_up` and their
    /// matrix would fill up.
    pub(crate) fn new(joints: &[JointRows], moves: &[bool], may_give_up: bool) -> Option<(Self, Vec<u32>)> {
        let (matrix, order) = arranged(joints, moves, may_give_up)?;
        let ordered: Vec<_> = order.iter().map(|joint| joints[*joint as usize].clone()).collect();
        let columns = RowColumns::new(&ordered);
        let (couplings, filled) = couplings(&ordered, moves, &matrix, &columns);
        let it = Self {
            done: vec![[[0.0; 4]; 2]; ordered.len()],
            alike: PinnedKind::of_all(&ordered),
            alike_fours: ordered.chunks(4).map(PinnedKind::of_all).collect(),
            columns,
            impulses: vec![[0.0; 4]; matrix.len()],
            right: vec![[0.0; 4]; matrix.len()],
            last: vec![[0.0; 4]; matrix.len()],
            bend: vec![[0.0; 4]; matrix.len()],
            pulls: vec![0.0; moves.len()],
            response: vec![[0.0; 4]; matrix.len()],
            asked: vec![[0.0; 4]; matrix.len()],
            solved: vec![[0.0; 4]; matrix.len()],
            is_touched: false,
            is_softened: false,
            contradiction: 0.0,
            contradicts: false,
            gain: 0.0,
            misfit: 0.0,
            parts: 0,
            is_first: false,
            grounds: 0,
            lock_of_whole: AxisLock(Axes::NONE),
            is_stuck: false,
            has_distances: ordered.iter().any(|joint| has_distance(&joint.free_rows)),
            has_free_rows: ordered.iter().any(|joint| !joint.free_rows.is_empty()),
            bodies: Vec::with_capacity(moves.len()),
            saved: Vec::with_capacity(moves.len()),
            velocities: vec![[[0.0; 4]; 2]; moves.len()],
            pushed: vec![[Vec3::zero(); 2]; moves.len()],
            made_of: MatrixInputs::default(),
            joints: ordered,
            matrix,
            couplings,
            filled,
        };
        Some((it, order))
    }

    /// Has the last of the bodies be the ground of these locks.
    pub(crate) fn ground(&mut self, locks: impl Iterator<Item = AxisLock>) {
        for lock in locks {
            self.grounds += 1;
            self.lock_of_whole = self.lock_of_whole.with_whole(lock);
        }
    }

    /// What leaves of motions of the whole those with which it can fly free. A body that does not
    /// turn takes up the torque of a joint that is off its centre or locks rotations.
    pub(super) fn lock_of_free(&self) -> AxisLock {
        let resists = |joint: &JointRows| joint.resists_turning(&self.bodies);
        let lock = self.lock_of_whole;
        if self.joints.iter().any(resists) { AxisLock(lock.0.with(Axes::ANGULAR)) } else { lock }
    }

    /// The bodies but for the ground of locked axes; `None` where one of them does not move.
    pub(super) fn free_bodies(&mut self) -> Option<&mut [MechanismBody]> {
        let count = self.bodies.len() - self.grounds;
        let bodies = &mut self.bodies[..count];
        bodies.iter().all(MechanismBody::is_moved).then_some(bodies)
    }

    /// To be called once the bodies have been read, before the first substep.
    pub(crate) fn begin(&mut self) {
        let Self { joints, bodies, .. } = self;
        joints.iter_mut().for_each(|joint| joint.begin_step(bodies));
        self.made_of.forget();
        self.is_first = true;
        self.bend.fill([0.0; 4]);
        if self.has_free_rows {
            self.update_rows();
            self.find_masses();
        }
        if self.joints.iter().any(JointRows::is_of_points) {
            self.size_points();
        }
    }

    /// Has errors of points that are held at their centres compared with the size of the others.
    fn size_points(&mut self) {
        self.update_rows();
        let others = self.joints.iter().filter(|joint| !joint.is_of_points());
        let size = others.map(JointRows::size).fold(0.0, f64::max);
        self.joints.iter_mut().filter(|joint| joint.is_of_points()).for_each(|joint| joint.set_gyration(size));
    }

    /// Finds the impulses with which the joints are met at the end of the substep, and moves the
    /// bodies there. Returns the largest error that is left, of the size of the arms or \[rad\].
    pub(super) fn solve_positions(&mut self, half: Half) -> f64 {
        let h = half.h;
        self.impulses.fill([0.0; 4]);
        if self.has_free_rows {
            self.begin_half(half);
            self.factor();
        }
        self.plan_corrections(h);
        self.contradiction = 0.0;
        self.solve_half(half);
        self.misfit = self.contradiction * h;
        let left = self.meet_positions(h);
        self.note_springs();
        follow(&mut self.bodies);
        left
    }

    /// Goes on from the solution on the right side until the joints are met where bodies are after
    /// `h` \[s\] from where they were saved, and moves them there. Returns the largest error left.
    pub(super) fn meet_positions(&mut self, h: f64) -> f64 {
        let (mut solution, mut most, mut worst) = (1, MAX_SOLUTIONS, f64::INFINITY);
        let mut first = f64::INFINITY;
        let last = loop {
            if solution > 1 {
                self.solve_right_side();
            }
            self.add_solution(1.0);
            drift(&mut self.bodies, &self.saved, h);
            if solution == most && !self.has_free_rows && worst <= MAX_ERROR {
                break worst;
            }
            let meets_bounds = self.has_free_rows && self.meet_bounds(h);
            if meets_bounds {
                most = MAX_SOLUTIONS_AT_BOUNDS;
            }
            if self.has_free_rows {
                self.last.copy_from_slice(&self.right);
            }
            let left = self.set_remaining(h);
            first = if solution == 1 { left } else { first };
            if left > worst && self.has_free_rows && !meets_bounds {
                // The rows have turned away: what was added leads nowhere.
                self.right.copy_from_slice(&self.last);
                self.add_solution(-1.0);
                drift(&mut self.bodies, &self.saved, h);
                self.find_free_speeds();
                break worst;
            }
            let tolerance = if solution == 1 { FIRST_TOLERANCE } else { TOLERANCE };
            if solution == most || (left <= tolerance && !meets_bounds) {
                break left;
            }
            self.note_bend();
            worst = if meets_bounds { f64::INFINITY } else { left };
            solution += 1;
        };
        // In double precision a bend gives energy a trend, of 4e-13 of a swing in a period.
        let has_bend = self.has_free_rows || size_of::<Real>() == size_of::<f32>();
        if !has_bend || first > MAX_FIRST_ERROR || last > TOLERANCE {
            self.bend.fill([0.0; 4]);
        }
        last
    }

    /// Adds what is left of the errors, on the right side, to the bend.
    fn note_bend(&mut self) {
        let (bend, right) = (self.bend.as_flattened_mut(), self.right.as_flattened());
        bend.iter_mut().zip(right).for_each(|(bend, right)| *bend += right);
    }

    /// Adds the solution on the right side, or takes it back.
    fn add_solution(&mut self, sign: f64) {
        let impulses = self.right.as_flattened_mut().iter_mut().zip(self.impulses.as_flattened_mut());
        for (impulse, sum) in impulses {
            *impulse *= sign;
            *sum += *impulse;
        }
        self.push();
    }

    /// Takes out the velocities against the joints.
    pub(super) fn solve_velocities(&mut self, half: Half) {
        self.begin_half(half);
        self.factor();
        self.solve_half(half);
        self.take_solution();
        self.note_impulses(false);
    }

    /// Has the impulses on the right side act on the bodies, as those of the solution.
    pub(super) fn take_solution(&mut self) {
        self.impulses.copy_from_slice(&self.right);
        self.push();
    }

    /// Solves for the impulses of one half: in the first those that meet the joints at the end of
    /// the substep if bodies move straight on, with as much inertia as these impulses ask for.
    pub(crate) fn solve_half(&mut self, half: Half) -> MatrixChange {
        self.solve_raising(half, MAX_RAISES)
    }

    /// The same with the inertia that bodies have.
    pub(crate) fn solve_half_again(&mut self, half: Half) -> MatrixChange {
        self.solve_raising(half, 1)
    }

    /// The same with up to this many solutions, each with more inertia.
    fn solve_raising(&mut self, half: Half, most_raises: u32) -> MatrixChange {
        let is_position = half.phase == Phase::Positions;
        let (mut changes, mut raises) = (0, 1);
        loop {
            self.set_right_side(if is_position { 1.0 / half.h } else { 0.0 });
            self.solve_right_side();
            if changes < MAX_CHANGES && self.settle(half) {
                changes += 1;
            } else if is_position && raises < most_raises && self.take_sudden_loads(half.h) {
                raises += 1;
            } else {
                break;
            }
            self.factor();
        }
        match (changes, raises) {
            (0, 1) => MatrixChange::None,
            (_, 1) => MatrixChange::Rows,
            _ => MatrixChange::Inertia,
        }
    }

    /// Raises the inertia of bodies on which the impulses of the right side are a sudden load.
    /// Returns whether there are any.
    fn take_sudden_loads(&mut self, h: f64) -> bool {
        self.set_pulls(Impulses::OnRightSide);
        let Self { bodies, pulls, .. } = self;
        let mut is_any = false;
        for (body, pull) in bodies.iter_mut().zip(&*pulls) {
            is_any |= body.take_sudden_load(*pull, h);
        }
        is_any
    }

    /// Raises the inertia of bodies to the loads of the substep.
    pub(super) fn take_loads(&mut self, h: f64) {
        take_loads(&mut self.bodies, &self.pulls, h);
    }
}
