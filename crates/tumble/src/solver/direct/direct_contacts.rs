//! The direct contacts of a mechanism: its part in the solution of a substep.

use tumble_math::lane::Vec3;

use crate::simd::Four;
use crate::solver::contact::softness::MAX_PUSH;
use crate::solver::direct::contact_problem::ContactProblem;
use crate::solver::direct::direct_contact::{DirectContact, MAX_CONTACT_ROWS, Push};
use crate::solver::mechanism::contact_responses::JointsByContacts;
use crate::solver::mechanism::mechanism_body::MechanismBody;
use crate::solver::mechanism::mechanism_solver::{Half, MatrixChange, MechanismSolver};

/// What contacts are solved for.
#[derive(Clone, Copy, Debug)]
pub(crate) enum ContactStage {
    /// Before bodies move on: no point comes nearer than it may, and overlaps are pushed apart.
    Positions,
    /// The same after contacts in passes have pushed too.
    PositionsAgain,
    /// After they have moved: no point comes, and the velocity of the push is taken out.
    Velocities,
    /// At the end of a step: points that came faster than this leave with their restitution
    /// \[m/s\].
    Bounce(f64),
}

impl ContactStage {
    /// Whether bodies are to move on.
    fn is_of_positions(self) -> bool {
        matches!(self, Self::Positions | Self::PositionsAgain)
    }

    fn is_bounce(self) -> bool {
        matches!(self, Self::Bounce(_))
    }
}

/// Contacts that are solved with the joints of a mechanism.
#[derive(Clone, Debug, Default)]
pub(crate) struct DirectContacts {
    pub(crate) contacts: Vec<DirectContact>,
    /// Bodies that belong to no mechanism: their numbers follow on those of the mechanism's.
    pub(crate) beside: Vec<MechanismBody>,
    problem: ContactProblem,
    /// By contact and row, the speed that it is to have, and the impulse where the stage began.
    goals: Vec<[f64; MAX_CONTACT_ROWS]>,
    begun: Vec<[f64; MAX_CONTACT_ROWS]>,
    /// By contact and row, the impulse before it was solved for last.
    before: Vec<[f64; MAX_CONTACT_ROWS]>,
    /// Overlaps up to this are rounding \[m\].
    pub(crate) rounding: f64,
    /// Whether its bodies have other contacts, in passes.
    pub(crate) has_passes: bool,
    /// Whether a contact of its bodies, of these or in passes, pushed when that was noted.
    pub(crate) is_held: bool,
    /// Whether work is booked.
    pub(crate) has_accounts: bool,
    /// By contact, work in the last stage.
    pub(crate) works: Vec<DirectWork>,
    by_contacts: JointsByContacts,
    /// Memory for the work: velocities by contact and end, impulses, and those of the joints.
    after: Vec<[[Vec3<f64>; 2]; 2]>,
    pushes: Vec<Push>,
    right: Vec<Four>,
}

/// What the impulses of a contact did, together with what joints did because of them \[J\].
#[derive(Clone, Copy, Debug)]
pub(crate) struct DirectWork {
    /// On each of its bodies.
    pub(crate) of_ends: [f64; 2],
    /// On both, of the impulses along the normal.
    of_points: f64,
}

/// How often contacts are solved again where joints have changed with them, and where a change of
/// impulses was too large for the joints as they are then.
const MAX_REPEATS: u32 = 2;
const MAX_REPEATS_OF_EXCESS: u32 = 8;
/// How often such a change is halved.
const MAX_HALVINGS: u32 = 4;
/// The part of what a change of impulses does to the speeds along them that is no excess.
const EXCESS: f64 = 1e-3;
/// What is slower moves less than this many roundings of a place in a substep, and is at rest.
const REST: f64 = 1e-2;
/// The part of an overlap that is pushed out in a substep.
pub(crate) const PUSHED: f64 = 0.2;

impl DirectContacts {
    /// Finds the impulses of contacts together with those of the joints, which are on the right
    /// side in the end; those of the contacts act already.
    pub(crate) fn solve(&mut self, solver: &mut MechanismSolver, half: Half, stage: ContactStage) {
        if self.contacts.is_empty() {
            solver.solve_half(half);
            return;
        }
        self.begin(solver, stage);
        solver.solve_half(half);
        // Beside passes the positions are solved again anyway.
        let repeats = if self.has_passes || stage.is_bounce() { 1 } else { MAX_REPEATS };
        for repeat in 1..=MAX_REPEATS_OF_EXCESS {
            self.before.clear();
            self.before.extend(self.contacts.iter().map(|contact| contact.impulses));
            self.set_problem(solver, (half, stage), repeat == 1);
            self.problem.solve();
            if stage.is_bounce() {
                self.limit_bounce();
            }
            self.take_solution(solver);
            // Further solutions than these do not raise inertia: it would add up.
            let change = if repeat <= repeats { solver.solve_half(half) } else { solver.solve_half_again(half) };
            if change == MatrixChange::None {
                break;
            }
            // With other inertia a shorter step is no better: it is solved again from there.
            let mut halvings = 0;
            while change == MatrixChange::Rows && halvings < MAX_HALVINGS && self.is_excess(solver, stage) {
                halvings += 1;
                self.halve(solver);
                solver.solve_half_again(half);
            }
            if halvings == 0 && repeat >= repeats {
                break;
            }
        }
        self.finish(solver, stage);
    }

    /// Whether the last change of impulses was too large for the joints with it: a limit that held
    /// them has let go. Points tell: friction that slides has speed against it in any case.
    fn is_excess(&self, solver: &mut MechanismSolver, stage: ContactStage) -> bool {
        let Self { contacts, problem, beside, goals, before, .. } = self;
        solver.set_response();
        let (mut left, mut added) = (0.0, 0.0);
        let n = problem.len();
        let change = |number: usize, row: usize| contacts[number].impulses[row] - before[number][row];
        for (number, (contact, shape)) in contacts.iter().zip(&problem.contacts).enumerate() {
            let speeds = contact.speeds(|end| velocities_to_be(solver, beside, end));
            for row in (0..contact.points).filter(|row| problem.may_push[shape.first + row]) {
                let responses = &problem.responses[(shape.first + row) * n..][..n];
                let of_all = problem.contacts.iter().enumerate().map(|(number, shape)| {
                    let of_it = responses[shape.first..][..shape.rows()].iter().enumerate();
                    of_it.map(|(row, by)| by * change(number, row)).sum::<f64>()
                });
                let given = problem.speed_given(number, row, |row| match stage.is_of_positions() {
                    true => contact.impulses[row],
                    false => change(number, row),
                });
                left += change(number, row) * (speeds[row] - goals[number][row] + given);
                added += change(number, row) * of_all.sum::<f64>();
            }
        }
        left > EXCESS * added.abs()
    }

    /// Takes half of the last change of impulses back.
    fn halve(&mut self, solver: &mut MechanismSolver) {
        let Self { contacts, beside, before, .. } = self;
        for (contact, before) in contacts.iter_mut().zip(before) {
            let mut changes = [0.0; MAX_CONTACT_ROWS];
            for ((change, impulse), before) in changes.iter_mut().zip(&mut contact.impulses).zip(before) {
                *change = 0.5 * (*before - *impulse);
                *impulse += *change;
            }
            push(contact, &changes, (&mut solver.bodies, beside));
        }
    }

    /// Whether none of them pushes, and none in passes did when that was noted.
    pub(crate) fn push_nothing(&self) -> bool {
        !(self.has_passes && self.is_held)
            && self.contacts.iter().all(|contact| contact.impulses == [0.0; MAX_CONTACT_ROWS])
    }

    /// Whether any of them may bounce.
    pub(crate) fn bounces(&self) -> bool {
        self.contacts.iter().any(|contact| contact.restitution > 0.0)
    }

    /// Notes where the stage begins.
    fn begin(&mut self, solver: &mut MechanismSolver, stage: ContactStage) {
        let Self { contacts, begun, beside, .. } = self;
        begun.clear();
        for contact in contacts.iter_mut() {
            match stage {
                ContactStage::Positions => {
                    begun.push([0.0; MAX_CONTACT_ROWS]);
                    push(contact, &contact.impulses, (&mut solver.bodies, beside));
                }
                ContactStage::PositionsAgain | ContactStage::Velocities => begun.push(contact.impulses),
                ContactStage::Bounce(_) => {
                    contact.impulses = [0.0; MAX_CONTACT_ROWS];
                    begun.push(contact.impulses);
                }
            }
        }
    }

    /// Sets speeds, goals and responses to where the bodies and the joints' impulses are.
    fn set_problem(&mut self, solver: &mut MechanismSolver, (half, stage): (Half, ContactStage), is_first: bool) {
        let Self { contacts, problem, beside, goals, .. } = self;
        let mut first = 0;
        problem.contacts.clear();
        for contact in &*contacts {
            let shape = contact.shape(first);
            first += shape.rows();
            problem.contacts.push(shape);
        }
        problem.resize();
        problem.rest = REST * self.rounding / half.h;
        solver.set_response();
        if is_first {
            goals.clear();
        }
        for (number, contact) in contacts.iter().enumerate() {
            let shape = problem.contacts[number];
            let speeds = contact.speeds(|end| velocities_to_be(solver, beside, end));
            if is_first {
                goals.push(contact.goals(&speeds, (half.h, stage), self.rounding));
            }
            let rows = shape.first..shape.first + shape.rows();
            problem.impulses[rows.clone()].copy_from_slice(&contact.impulses[..shape.rows()]);
            for (at, (speed, goal)) in rows.zip(speeds.iter().zip(&goals[number])) {
                problem.may_push[at] = *goal > -f64::INFINITY;
                problem.speeds[at] = if problem.may_push[at] { speed - goal } else { 0.0 };
            }
        }
        self.set_responses(solver);
        let mass: f64 =
            solver.bodies.iter().chain(&self.beside).filter(|body| body.is_moved()).map(MechanismBody::mass).sum();
        self.problem.soften(mass, stage.is_of_positions());
    }

    /// Sets what an impulse along each row does to the speeds of all, with what joints do because
    /// of it.
    fn set_responses(&mut self, solver: &MechanismSolver) {
        let count = solver.bodies.len();
        let Self { contacts, problem, beside, by_contacts, .. } = self;
        let n = problem.len();
        solver.begin_responses(n, by_contacts);
        for (contact, shape) in contacts.iter().zip(&problem.contacts) {
            for row in 0..shape.rows() {
                let velocities = contact.pushes(contact.row(row)).map(|Push { body, linear, torque }| {
                    let of_body = solver.bodies.get(body).unwrap_or_else(|| &beside[body - count]);
                    (body, of_body.response_to([linear, torque]))
                });
                let at = shape.first + row;
                for (other, of_other) in contacts.iter().zip(&problem.contacts) {
                    if other.ends.iter().any(|end| contact.ends.contains(end)) {
                        let speeds = other.speeds(|end| {
                            let pushed = velocities.iter().find(|pushed| pushed.0 == end);
                            pushed.map_or([Vec3::zero(); 2], |pushed| pushed.1)
                        });
                        let begin = at * n + of_other.first;
                        problem.responses[begin..begin + of_other.rows()].copy_from_slice(&speeds[..of_other.rows()]);
                    }
                }
                // What is beside the mechanism has no joints.
                solver.set_push(at, &velocities, by_contacts);
            }
        }
        solver.subtract_joints(by_contacts, &mut problem.responses, n);
        for i in 0..n {
            for j in 0..i {
                problem.responses[j * n + i] = problem.responses[i * n + j];
            }
        }
    }

    /// Has impulses give no more energy than the restitution lets come back of what was taken.
    fn limit_bounce(&mut self) {
        let Self { contacts, problem, goals, .. } = self;
        let n = problem.len();
        // With the speeds before, and what the impulses add to them.
        let (mut before, mut between) = (0.0, 0.0);
        for (number, shape) in problem.contacts.iter().enumerate() {
            for (at, goal) in (shape.first..shape.first + shape.rows()).zip(&goals[number]) {
                let responses = &problem.responses[at * n..(at + 1) * n];
                let added: f64 = responses.iter().zip(&problem.impulses).map(|(response, by)| response * by).sum();
                // A point that may not push has no goal.
                let goal = if problem.may_push[at] { *goal } else { 0.0 };
                before += problem.impulses[at] * (problem.speeds[at] + goal - added);
                between += 0.5 * problem.impulses[at] * added;
            }
        }
        let returned = |contact: &DirectContact| contact.restitution * contact.restitution * contact.absorbed.max(0.0);
        let most: f64 = contacts.iter().map(returned).sum();
        if before + between > most && between > 0.0 {
            // The part with which `before s + between s^2` is the most.
            let root = (before * before + 4.0 * between * most).sqrt();
            let part = ((root - before) / (2.0 * between)).clamp(0.0, 1.0);
            problem.impulses.iter_mut().for_each(|impulse| *impulse *= part);
        }
    }

    /// Has the impulses of the solution act on the bodies.
    fn take_solution(&mut self, solver: &mut MechanismSolver) {
        let Self { contacts, problem, beside, .. } = self;
        for (contact, shape) in contacts.iter_mut().zip(&problem.contacts) {
            let mut changes = [0.0; MAX_CONTACT_ROWS];
            let solved = &problem.impulses[shape.first..shape.first + shape.rows()];
            for ((change, impulse), solved) in changes.iter_mut().zip(&mut contact.impulses).zip(solved) {
                *change = solved - *impulse;
                *impulse = *solved;
            }
            contact.slides = shape.slides;
            push(contact, &changes, (&mut solver.bodies, beside));
        }
    }

    /// Notes what contacts did in the stage.
    fn finish(&mut self, solver: &mut MechanismSolver, stage: ContactStage) {
        let bounces = self.bounces() && !stage.is_bounce();
        self.works.clear();
        if !(self.has_accounts || bounces) {
            return;
        }
        let Self { contacts, beside, begun, works, after, pushes, right, .. } = self;
        solver.set_response();
        after.clear();
        after.extend(contacts.iter().map(|contact| contact.ends.map(|end| velocities_to_be(solver, beside, end))));
        // From here on what was begun with is what was changed.
        pushes.clear();
        for (contact, change) in contacts.iter().zip(&mut *begun) {
            change.iter_mut().zip(&contact.impulses).for_each(|(change, impulse)| *change = impulse - *change);
            pushes.extend(contact.pushes(contact.impulse(&change[..contact.rows()])));
        }
        right.clear();
        right.extend_from_slice(solver.right_side());
        solver.respond(pushes);
        // What joints and contacts would have left without these impulses, and with them.
        let added = |end: usize| match end.checked_sub(solver.bodies.len()) {
            Some(place) => {
                let of_it = pushes.iter().filter(|push| push.body == end);
                let [linear, torque] =
                    of_it.fold([Vec3::zero(); 2], |sum, push| [sum[0] + push.linear, sum[1] + push.torque]);
                beside[place].response_to([linear, torque])
            }
            None => solver.response_of(end),
        };
        for ((contact, change), after) in contacts.iter().zip(&*begun).zip(after) {
            let added = contact.ends.map(added);
            let mean = |end: usize, which: usize| after[end][which] - added[end][which] * 0.5;
            let work = |along: &[f64], end: usize| contact.work_on(end, along, [mean(end, 0), mean(end, 1)]);
            let along = &change[..contact.rows()];
            let of_points = work(&along[..contact.points], 0) + work(&along[..contact.points], 1);
            works.push(DirectWork { of_ends: [work(along, 0), work(along, 1)], of_points });
        }
        solver.set_right_side_to(right);
        if bounces {
            self.note_impacts();
        }
    }

    /// Notes what points have taken of the energy, and how fast they came.
    fn note_impacts(&mut self) {
        for (contact, work) in self.contacts.iter_mut().zip(&self.works) {
            contact.absorbed -= work.of_points;
            for j in 0..contact.points {
                if contact.impulses[j] > 0.0 {
                    contact.approach[j] = contact.approach[j].min(contact.met[j]);
                }
            }
        }
    }
}

impl DirectContact {
    /// The speeds that its rows are to have, or more along the normal; minus infinity of a point
    /// that may not push.
    fn goals(
        &self,
        speeds: &[f64; MAX_CONTACT_ROWS],
        (h, stage): (f64, ContactStage),
        rounding: f64,
    ) -> [f64; MAX_CONTACT_ROWS] {
        let mut goals = [0.0; MAX_CONTACT_ROWS];
        // Velocities are to vanish in the middle of a substep.
        let sign = if stage.is_of_positions() { -1.0 } else { 1.0 };
        let rows = self.rows();
        for (row, goal) in goals.iter_mut().enumerate().take(rows).skip(self.points) {
            let [push, _] = self.row(row);
            *goal = push.dot(self.slip_reference) + (sign - 1.0) * push.dot(self.lag);
        }
        for (j, goal) in goals.iter_mut().enumerate().take(self.points) {
            let (separation, near) = (self.separations[j], (self.separations[j] - rounding).max(0.0) / h);
            let lag = sign * self.normal.dot(self.lag);
            *goal = match stage {
                ContactStage::Positions | ContactStage::PositionsAgain if separation > 0.0 => lag - near,
                ContactStage::Positions | ContactStage::PositionsAgain => {
                    let overlap = (-separation - rounding).max(0.0);
                    lag + (PUSHED * overlap / h).min(MAX_PUSH) * self.steady
                }
                ContactStage::Velocities if self.is_of_ball && separation > 0.0 && self.impulses[j] <= 0.0 => {
                    -f64::INFINITY
                }
                ContactStage::Velocities if self.impulses[j] > 0.0 => lag - near.min((lag - speeds[j]).max(0.0)),
                ContactStage::Velocities => lag - near,
                ContactStage::Bounce(threshold) if self.approach[j] < -threshold && self.restitution > 0.0 => {
                    -self.restitution * self.approach[j]
                }
                // What came slowly is not to be pushed in.
                ContactStage::Bounce(_) => (-near).min(speeds[j]),
            };
        }
        goals
    }
}

/// The velocities of a body once the joints' impulses act, of which the response is set.
fn velocities_to_be(solver: &MechanismSolver, beside: &[MechanismBody], end: usize) -> [Vec3<f64>; 2] {
    match end.checked_sub(solver.bodies.len()) {
        Some(place) => [beside[place].linear_velocity(), beside[place].angular_velocity()],
        None => solver.velocities_to_be(end),
    }
}

/// Has impulses along the rows of a contact act on its bodies.
fn push(
    contact: &DirectContact,
    along: &[f64; MAX_CONTACT_ROWS],
    (bodies, beside): (&mut [MechanismBody], &mut [MechanismBody]),
) {
    for Push { body, linear, torque } in contact.pushes(contact.impulse(&along[..contact.rows()])) {
        let body = match body.checked_sub(bodies.len()) {
            Some(place) => &mut beside[place],
            None => &mut bodies[body],
        };
        body.push(linear, Vec3::zero(), torque);
    }
}
