//! The rows of a mechanism's joints: right sides, impulses and errors, of four joints at a time
//! where these are alike, with the same numbers as of one joint after the other.

use tumble_math::lane::Vec3;

use crate::integrators::derived::symmetric_product;
use crate::simd::{Four, FourKernel, FourLane, dispatch_fours};
use crate::solver::mechanism::fours::{by_place, four_of, of_each, row_of, rows_of, vector, vectors};
use crate::solver::mechanism::free_axis::FreeAxis;
use crate::solver::mechanism::free_row::FreeRow;
use crate::solver::mechanism::joint_rows::{JointRows, OfRows, length};
use crate::solver::mechanism::mechanism_body::MechanismBody;
use crate::solver::mechanism::mechanism_solver::{MechanismSolver, SIGNS};
use crate::solver::mechanism::pinned_joints::{PinnedJoints, plan_pinned};
use crate::solver::mechanism::pinned_kind::PinnedKind;

/// Impulses of all rows.
#[derive(Clone, Copy)]
pub(super) enum Impulses {
    OnRightSide,
    OfSolution,
}

/// Goes through joints in fours, by the kind that four of them have in common: as a constant, or
/// one joint after the other where they have none.
macro_rules! in_fours {
    ($alike:ident => |$first:ident, $kind:ident| $pinned:expr, $joints:expr => |$number:ident, $joint:ident| $mixed:expr) => {
        for ($first, alike) in (0..).step_by(4).zip(&*$alike) {
            match alike {
                Some(PinnedKind::BALL) => {
                    let $kind = PinnedKind::BALL;
                    $pinned
                }
                Some(PinnedKind::HINGE) => {
                    let $kind = PinnedKind::HINGE;
                    $pinned
                }
                Some(PinnedKind::DRIVEN_HINGE) => {
                    let $kind = PinnedKind::DRIVEN_HINGE;
                    $pinned
                }
                Some(PinnedKind::WELD) => {
                    let $kind = PinnedKind::WELD;
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
            |first, kind| {
                let four = PinnedJoints::<T>::of(joints, first, kind);
                let speeds = four.speeds(bodies);
                four.set_right_side(speeds, matrix, right, (bend, rate));
                if kind.has_free_row {
                    PinnedJoints::take_free_speeds(joints, first, speeds);
                    for (number, joint) in joints.iter().enumerate().skip(first).take(4) {
                        set_free_right_side(joint, &mut right.as_flattened_mut()[matrix.place(number)..], rate);
                    }
                }
            },
            joints.iter_mut() => |number, joint| {
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
                Some(kind) => {
                    for joint in joints {
                        plan_pinned::<T>(joint, *kind, h);
                        joint.plan_free_correction(h);
                    }
                }
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
            |first, kind| {
                let four = PinnedJoints::<T>::of(joints, first, kind);
                let (left, largest) = four.errors_left(bodies);
                most_of_fours = largest.max(most_of_fours);
                four.set_remaining(left, matrix, right, rate);
                if kind.has_free_row {
                    let speeds = four.speeds(bodies);
                    PinnedJoints::take_free_speeds(joints, first, speeds);
                    for (number, joint) in joints.iter().enumerate().skip(first).take(4) {
                        let begin = matrix.place(number);
                        let is_at_bound = joint.free_rows.iter().any(FreeRow::is_at_bound);
                        let errors = if is_at_bound { joint.errors(bodies) } else { OfRows::default() };
                        let (right, impulses) = (&mut right.as_flattened_mut()[begin..], &impulses.as_flattened()[begin..]);
                        most = most.max(set_free_remaining(joint, bodies, &errors, (right, impulses), rate));
                    }
                }
            },
            joints.iter_mut() => |number, joint| {
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
            |first, kind| {
                let four = PinnedJoints::<T>::of(joints, first, kind);
                let impulses = four.impulses(matrix, right);
                four.push(bodies, impulses);
            },
            joints.iter() => |number, joint| {
                push_by(joint, bodies, &right.as_flattened()[matrix.place(number)..]);
            }
        );
    }

    /// Sets how the impulses on the right side change the speeds of rows and bodies.
    pub(crate) fn set_response(&mut self) {
        dispatch_fours(SetResponse { solver: self });
    }

    #[inline(always)]
    fn set_all_responses<T: FourLane>(&mut self) {
        let Self { joints, bodies, matrix, right, velocities, response, alike_fours, .. } = self;
        velocities.fill([[0.0; 4]; 2]);
        in_fours!(alike_fours =>
            |first, kind| {
                let four = PinnedJoints::<T>::of(joints, first, kind);
                let impulses = four.impulses(matrix, right);
                four.add_impulses(impulses, velocities);
            },
            joints.iter() => |number, joint| {
                add_impulses_of(joint, &right.as_flattened()[matrix.place(number)..], velocities);
            }
        );
        give_velocities::<T>(bodies, velocities);
        in_fours!(alike_fours =>
            |first, kind| {
                let four = PinnedJoints::<T>::of(joints, first, kind);
                four.store_rows(four.speeds_of(velocities), matrix, response);
            },
            joints.iter() => |number, joint| {
                let speeds = joint.speeds_by(|body| velocities[body].map(|v| vector(&v)));
                let response = &mut response.as_flattened_mut()[matrix.place(number)..];
                response[..joint.count].copy_from_slice(&speeds.as_flattened()[..joint.count]);
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
        for (number, joint) in joints.iter().enumerate().filter(|(_, joint)| !joint.free_rows.is_empty()) {
            let impulses = &mut impulses.as_flattened_mut()[matrix.place(number)..][..joint.count];
            for (impulse, row) in impulses[joint.locked..].iter_mut().zip(&joint.free_rows) {
                *impulse += row.pushed;
            }
        }
        in_fours!(alike_fours =>
            |first, kind| {
                let four = PinnedJoints::<T>::of(joints, first, kind);
                let along = four.impulses(matrix, impulses);
                four.note(along, done);
            },
            joints.iter() => |number, joint| {
                let impulses = &impulses.as_flattened()[matrix.place(number)..][..joint.count];
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
            |first, kind| {
                let four = PinnedJoints::<T>::of(joints, first, kind);
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
            |first, kind| PinnedJoints::<T>::update(joints, first, kind, bodies),
            joints.iter_mut() => |_number, joint| joint.update(bodies)
        );
    }
}

fn set_right_side_of(joint: &mut JointRows, bodies: &[MechanismBody], right: &mut [f64], bend: &[f64], rate: f64) {
    let speeds = joint.speeds(bodies);
    joint.take_free_speeds(&speeds);
    let (speeds, errors, wanted) = (speeds.as_flattened(), joint.errors.as_flattened(), joint.wanted.as_flattened());
    for row in 0..joint.locked {
        let correction = (errors[row] - wanted[row]) * rate;
        right[row] = -(speeds[row] + correction);
    }
    if rate != 0.0 {
        right.iter_mut().zip(bend).take(joint.locked).for_each(|(right, bend)| *right += bend);
    }
    set_free_right_side(joint, right, rate);
}

/// Sets the right side of rows of free axes, of which the speeds have been taken.
fn set_free_right_side(joint: &JointRows, right: &mut [f64], rate: f64) {
    let (errors, wanted) = (joint.errors.as_flattened(), joint.wanted.as_flattened());
    for (row, it) in (joint.locked..).zip(&joint.free_rows) {
        right[row] = it.right_side((errors[row] - wanted[row]) * rate);
    }
}

fn set_remaining_of(
    joint: &mut JointRows,
    bodies: &[MechanismBody],
    right: &mut [f64],
    impulses: &[f64],
    rate: f64,
) -> f64 {
    let mut most = 0.0_f64;
    let size = joint.size();
    let all_errors = joint.errors(bodies);
    let (errors, wanted) = (all_errors.as_flattened(), joint.wanted.as_flattened());
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
    joint.take_free_speeds(&joint.speeds(bodies));
    most.max(set_free_remaining(joint, bodies, &all_errors, (right, impulses), rate))
}

/// Sets what is left of the laws of rows of free axes, of which the speeds have been taken, and of
/// these errors of those at a bound; returns the largest of these.
fn set_free_remaining(
    joint: &JointRows,
    bodies: &[MechanismBody],
    errors: &OfRows,
    (right, impulses): (&mut [f64], &[f64]),
    rate: f64,
) -> f64 {
    let (errors, wanted, size) = (errors.as_flattened(), joint.wanted.as_flattened(), joint.size());
    let mut most = 0.0_f64;
    for (row, it) in (joint.locked..).zip(&joint.free_rows) {
        right[row] = if it.is_at_bound() {
            let left = errors[row] - wanted[row];
            most = most.max(left.abs() / if it.axis.is_linear() { size } else { 1.0 });
            if it.axis == FreeAxis::Distance {
                most = most.max(joint.missed_distance(row, it, bodies) / size);
            }
            left * rate
        } else {
            it.remaining(impulses[row])
        };
    }
    most
}

fn push_by(joint: &JointRows, bodies: &mut [MechanismBody], along: &[f64]) {
    for_each_end(joint, along, |body, arm, impulse, angular| bodies[body].push(impulse, arm, angular));
}

/// Adds linear and angular impulses of a joint to those of its bodies.
fn add_impulses_of(joint: &JointRows, along: &[f64], impulses: &mut [[Four; 2]]) {
    for_each_end(joint, along, |body, arm, impulse, angular| {
        let [linear, turning] = &mut impulses[body];
        *linear = row_of(vector(linear) + impulse, 0.0);
        *turning = row_of(vector(turning) + (arm.cross(impulse) + angular), 0.0);
    });
}

/// What impulses along the rows of a joint are to each of its bodies: the arm, the impulse and the
/// angular impulse beside that of the arm.
fn for_each_end(joint: &JointRows, along: &[f64], mut visit: impl FnMut(usize, Vec3<f64>, Vec3<f64>, Vec3<f64>)) {
    let [impulse, angular] = joint.impulse(&along[..joint.count]);
    for ((body, arm), sign) in joint.bodies.into_iter().zip(joint.arms()).zip(SIGNS) {
        visit(body, arm, impulse * sign, angular * sign);
    }
    if let Some(gear) = &joint.gear {
        gear.for_each_end(along[0], visit);
    }
}

/// Has linear and angular impulses of bodies be the velocities that they give.
#[inline(always)]
fn give_velocities<T: FourLane>(bodies: &[MechanismBody], impulses: &mut [[Four; 2]]) {
    for first in (0..bodies.len()).step_by(4) {
        let four = four_of(first, bodies.len());
        let (linear, _) = vectors::<T>(of_each!(four, i => &impulses[i][0]));
        let (torque, _) = vectors::<T>(of_each!(four, i => &impulses[i][1]));
        let (_, inverse_mass) = vectors::<T>(of_each!(four, i => &bodies[i].linear));
        let (diagonal, _) = vectors::<T>(of_each!(four, i => &bodies[i].inverse_inertia[0]));
        let (off_diagonal, _) = vectors::<T>(of_each!(four, i => &bodies[i].inverse_inertia[1]));
        let linear = rows_of(linear * inverse_mass, T::splat(0.0));
        let angular = rows_of(symmetric_product(diagonal, off_diagonal, torque), T::splat(0.0));
        by_place!(k of 4 {
            linear[k].store(&mut impulses[four[k]][0]);
            angular[k].store(&mut impulses[four[k]][1]);
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

pub(super) use kernel;

kernel!(RightSide { rate: f64 } => |solver| solver.set_right_sides::<T>(rate));
kernel!(Remaining { h: f64, most: &'a mut f64 } => |solver| *most = solver.set_all_remaining::<T>(h));
kernel!(PlanCorrections { h: f64 } => |solver| solver.plan_all_corrections::<T>(h));
kernel!(Push {} => |solver| solver.push_all::<T>());
kernel!(SetResponse {} => |solver| solver.set_all_responses::<T>());
kernel!(NoteImpulses {} => |solver| solver.note_all_impulses::<T>());
kernel!(SetPulls { impulses: Impulses } => |solver| solver.set_all_pulls::<T>(impulses));
kernel!(UpdateRows {} => |solver| solver.update_all_rows::<T>());
