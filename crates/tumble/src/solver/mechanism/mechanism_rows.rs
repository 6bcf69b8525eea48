//! The rows of a mechanism's joints: right sides, impulses and errors, of four joints at a time
//! where these are alike, with the same numbers as of one joint after the other.

use crate::simd::{FourKernel, FourLane, dispatch_fours};
use crate::solver::mechanism::fours::{row_of, vector};
use crate::solver::mechanism::free_axis::FreeAxis;
use crate::solver::mechanism::joint_rows::{JointRows, length};
use crate::solver::mechanism::mechanism_body::MechanismBody;
use crate::solver::mechanism::mechanism_solver::{MechanismSolver, SIGNS};
use crate::solver::mechanism::pinned_joints::{PinnedJoints, plan_pinned};
use crate::solver::mechanism::rotations::Rotations;

/// The rotations that joints lock if they lock the same, and all translations, and nothing acts
/// along a free axis.
pub(super) fn alike(joints: &[JointRows]) -> Option<Rotations> {
    let rotations = joints.first()?.rotations;
    let is_alike = |joint: &JointRows| joint.is_rigid_pin() && joint.rotations == rotations;
    joints.iter().all(is_alike).then_some(rotations)
}

/// Impulses of all rows.
#[derive(Clone, Copy)]
pub(super) enum Impulses {
    OnRightSide,
    OfSolution,
}

/// Goes through joints in fours, by the rotations that four of them lock alike: as a constant, or
/// one joint after the other where they are not alike, or as universal joints.
macro_rules! in_fours {
    ($alike:ident => |$first:ident, $rotations:ident| $pinned:expr, $joints:expr => |$number:ident, $joint:ident| $mixed:expr) => {
        for ($first, alike) in (0..).step_by(4).zip(&*$alike) {
            match alike {
                Some(Rotations::Free) => {
                    let $rotations = Rotations::Free;
                    $pinned
                }
                Some(Rotations::About(0)) => {
                    let $rotations = Rotations::About(0);
                    $pinned
                }
                Some(Rotations::Locked) => {
                    let $rotations = Rotations::Locked;
                    $pinned
                }
                _ => {
                    for ($number, $joint) in $joints.enumerate().skip($first).take(4) {
                        $mixed
                    }
                }
            }
        }
    };
}

impl MechanismSolver {
    /// Makes the right side of what the rows' speeds are to become: zero, or what the law of a free
    /// axis says, and beside it what takes the errors out at a rate [1/s].
    pub(super) fn set_right_side(&mut self, rate: f64) {
        dispatch_fours(RightSide { solver: self, rate });
    }

    #[inline(always)]
    fn set_right_sides<T: FourLane>(&mut self, rate: f64) {
        let Self { joints, bodies, matrix, right, bend, alike_fours, .. } = self;
        in_fours!(alike_fours =>
            |first, rotations| {
                let four = PinnedJoints::<T>::of(joints, first, rotations);
                four.set_right_side(four.speeds(bodies), matrix, right, (bend, rate));
            },
            joints.iter() => |number, joint| {
                let begin = matrix.place(number);
                set_right_side_of(joint, bodies, &mut right.as_flattened_mut()[begin..], &bend.as_flattened()[begin..], rate);
            }
        );
    }

    /// Sets what is left of the errors after a substep of `h` \[s\].
    pub(super) fn plan_corrections(&mut self, h: f64) {
        dispatch_fours(PlanCorrections { solver: self, h });
    }

    #[inline(always)]
    fn plan_all_corrections<T: FourLane>(&mut self, h: f64) {
        let Self { joints, alike_fours, .. } = self;
        for (joints, alike) in joints.chunks_mut(4).zip(&*alike_fours) {
            match alike {
                Some(rotations) => joints.iter_mut().for_each(|joint| plan_pinned::<T>(joint, *rotations, h)),
                None => joints.iter_mut().for_each(|joint| joint.plan_correction(h)),
            }
        }
    }

    /// Makes the right side of what is left of the errors; returns the largest, of the size of the
    /// arms or \[rad\].
    pub(super) fn set_remaining(&mut self, h: f64) -> f64 {
        let mut most = 0.0;
        dispatch_fours(Remaining { solver: self, h, most: &mut most });
        most
    }

    #[inline(always)]
    fn set_all_remaining<T: FourLane>(&mut self, h: f64) -> f64 {
        let Self { joints, bodies, matrix, right, impulses, alike_fours, .. } = self;
        let rate = -1.0 / h;
        let mut most = 0.0_f64;
        let mut most_of_fours = T::splat(0.0);
        in_fours!(alike_fours =>
            |first, rotations| {
                let four = PinnedJoints::<T>::of(joints, first, rotations);
                let (left, largest) = four.errors_left(bodies);
                most_of_fours = largest.max(most_of_fours);
                four.set_remaining(left, matrix, right, rate);
            },
            joints.iter() => |number, joint| {
                let begin = matrix.place(number);
                let right = &mut right.as_flattened_mut()[begin..];
                let left = set_remaining_of(joint, bodies, right, &impulses.as_flattened()[begin..], rate);
                most = most.max(left);
            }
        );
        let mut of_fours = [0.0; 4];
        most_of_fours.store(&mut of_fours);
        of_fours.into_iter().fold(most, f64::max)
    }

    /// Adds the impulses on the right side to the momenta.
    pub(super) fn push(&mut self) {
        dispatch_fours(Push { solver: self });
    }

    #[inline(always)]
    fn push_all<T: FourLane>(&mut self) {
        let Self { joints, bodies, matrix, right, alike_fours, .. } = self;
        in_fours!(alike_fours =>
            |first, rotations| {
                let four = PinnedJoints::<T>::of(joints, first, rotations);
                let impulses = four.impulses(matrix, right);
                four.push(bodies, impulses);
            },
            joints.iter() => |number, joint| {
                push_by(joint, bodies, &right.as_flattened()[matrix.place(number)..]);
            }
        );
    }

    /// Adds the impulses of a solution to what joints have done, and where they `pull`, sets what
    /// that loads the bodies with.
    pub(super) fn note_impulses(&mut self, pull: bool) {
        dispatch_fours(NoteImpulses { solver: self });
        if pull {
            self.set_pulls(Impulses::OfSolution);
        }
    }

    #[inline(always)]
    fn note_all_impulses<T: FourLane>(&mut self) {
        let Self { joints, matrix, impulses, done, alike_fours, .. } = self;
        in_fours!(alike_fours =>
            |first, rotations| {
                let four = PinnedJoints::<T>::of(joints, first, rotations);
                let along = four.impulses(matrix, impulses);
                four.note(along, done);
            },
            joints.iter() => |number, joint| {
                let impulses = &mut impulses.as_flattened_mut()[matrix.place(number)..][..joint.count];
                for (impulse, row) in impulses[joint.locked..].iter_mut().zip(&joint.free_rows) {
                    *impulse += row.pushed;
                }
                let [impulse, angular] = joint.impulse(impulses);
                let [linear, turning] = &mut done[number];
                *linear = row_of(vector(linear) + impulse, 0.0);
                let moment = vector(&joint.from_anchor).cross(impulse);
                *turning = row_of(vector(turning) + angular + moment, 0.0);
            }
        );
    }

    /// Sets by body the sum over its joints of impulse times arm.
    pub(super) fn set_pulls(&mut self, impulses: Impulses) {
        dispatch_fours(SetPulls { solver: self, impulses });
    }

    #[inline(always)]
    fn set_all_pulls<T: FourLane>(&mut self, of: Impulses) {
        let Self { joints, matrix, impulses, right, pulls, alike_fours, .. } = self;
        let impulses = match of {
            Impulses::OnRightSide => &*right,
            Impulses::OfSolution => &*impulses,
        };
        pulls.fill(0.0);
        in_fours!(alike_fours =>
            |first, rotations| {
                let four = PinnedJoints::<T>::of(joints, first, rotations);
                let along = four.impulses(matrix, impulses);
                four.pull(along, pulls);
            },
            joints.iter() => |number, joint| {
                let along = &impulses.as_flattened()[matrix.place(number)..][..joint.count];
                let strength = length(joint.impulse(along)[0]);
                for end in 0..2 {
                    pulls[joint.bodies[end]] += strength * joint.arms[end][3];
                }
            }
        );
    }

    /// Sets the rows to where the bodies are.
    pub(crate) fn update_rows(&mut self) {
        // What nothing touches has moved since.
        if !self.is_touched || self.made_of.take_poses(&self.bodies) {
            dispatch_fours(UpdateRows { solver: self });
        }
        self.soften();
    }

    #[inline(always)]
    fn update_all_rows<T: FourLane>(&mut self) {
        let Self { joints, bodies, alike_fours, .. } = self;
        in_fours!(alike_fours =>
            |first, rotations| PinnedJoints::<T>::update(joints, first, rotations, bodies),
            joints.iter_mut() => |_number, joint| joint.update(bodies)
        );
    }
}

fn set_right_side_of(joint: &JointRows, bodies: &[MechanismBody], right: &mut [f64], bend: &[f64], rate: f64) {
    let speeds = joint.speeds(bodies);
    let (speeds, errors, wanted) = (speeds.as_flattened(), joint.errors.as_flattened(), joint.wanted.as_flattened());
    let right = &mut right[..joint.count];
    for row in 0..joint.count {
        let correction = (errors[row] - wanted[row]) * rate;
        right[row] = -(speeds[row] + correction);
    }
    if rate != 0.0 {
        right.iter_mut().zip(bend).take(joint.locked).for_each(|(right, bend)| *right += bend);
    }
    for (right, row) in right[joint.locked..].iter_mut().zip(&joint.free_rows) {
        *right = if row.constant.is_some() { 0.0 } else { *right - row.bias };
    }
}

fn set_remaining_of(
    joint: &JointRows,
    bodies: &[MechanismBody],
    right: &mut [f64],
    impulses: &[f64],
    rate: f64,
) -> f64 {
    let mut most = 0.0_f64;
    let size = joint.size();
    let errors = joint.errors(bodies);
    let (errors, wanted) = (errors.as_flattened(), joint.wanted.as_flattened());
    let linear = joint.linear_count();
    let mut most_linear = 0.0_f64;
    for (row, right) in right[..joint.locked].iter_mut().enumerate() {
        let left = errors[row] - wanted[row];
        let is_linear = joint.gear.as_ref().map_or(row < linear, |gear| gear.is_linear());
        let of_kind = if is_linear { &mut most_linear } else { &mut most };
        *of_kind = of_kind.max(left.abs());
        *right = left * rate;
    }
    most = most.max(most_linear / size);
    if joint.free_rows.is_empty() {
        return most;
    }
    let speeds = joint.speeds(bodies);
    let speeds = speeds.as_flattened();
    for (row, it) in (joint.locked..).zip(&joint.free_rows) {
        right[row] = if it.is_at_bound() {
            let left = errors[row] - wanted[row];
            most = most.max(left.abs() / if it.axis.is_linear() { size } else { 1.0 });
            if it.axis == FreeAxis::Distance {
                most = most.max(joint.missed_distance(row, it, bodies) / size);
            }
            left * rate
        } else if it.constant.is_some() {
            0.0
        } else {
            -(speeds[row] + it.bias + it.gamma * impulses[row])
        };
    }
    most
}

fn push_by(joint: &JointRows, bodies: &mut [MechanismBody], along: &[f64]) {
    let [impulse, angular] = joint.impulse(&along[..joint.count]);
    for end in 0..2 {
        let sign = SIGNS[end];
        bodies[joint.bodies[end]].push(impulse * sign, joint.arm(end), angular * sign);
    }
    if let Some(gear) = &joint.gear {
        gear.for_each_end(along[0], |body, arm, impulse, angular| {
            bodies[body].push(impulse, arm, angular);
        });
    }
}

/// Declares a kernel that calls a method of the solver with fours.
macro_rules! kernel {
    ($Kernel:ident { $($field:ident: $Type:ty),* } => |$solver:ident| $call:expr) => {
        struct $Kernel<'a> {
            solver: &'a mut MechanismSolver,
            $($field: $Type,)*
        }

        impl FourKernel for $Kernel<'_> {
            #[inline(always)]
            fn run<T: FourLane>(self) {
                let Self { solver: $solver, $($field),* } = self;
                $call
            }
        }
    };
}

kernel!(RightSide { rate: f64 } => |solver| solver.set_right_sides::<T>(rate));
kernel!(Remaining { h: f64, most: &'a mut f64 } => |solver| *most = solver.set_all_remaining::<T>(h));
kernel!(PlanCorrections { h: f64 } => |solver| solver.plan_all_corrections::<T>(h));
kernel!(Push {} => |solver| solver.push_all::<T>());
kernel!(NoteImpulses {} => |solver| solver.note_all_impulses::<T>());
kernel!(SetPulls { impulses: Impulses } => |solver| solver.set_all_pulls::<T>(impulses));
kernel!(UpdateRows {} => |solver| solver.update_all_rows::<T>());
