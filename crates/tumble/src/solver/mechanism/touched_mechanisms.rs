//! The mechanisms of a world that contacts act on: which contacts are direct, and the stages of a
//! substep.

use rayon::prelude::*;

use crate::collision::contact::ContactRecord;
use crate::math::Real;
use crate::solver::contact::round_contacts::RoundConstraint;
use crate::solver::contact_work::ContactWorks;
use crate::solver::direct::direct_choice::{Candidates, Owner};
use crate::solver::direct::direct_contact::DirectContact;
use crate::solver::direct::direct_contacts::{ContactStage, DirectContacts};
use crate::solver::direct::direct_group::DirectGroup;
use crate::solver::joint_passes::pass_stages::JointPasses;
use crate::solver::mechanism::free_row::Phase;
use crate::solver::mechanism::mechanism_body::MechanismBody;
use crate::solver::mechanism::mechanism_solver::{Half, MechanismSolver};
use crate::solver::mechanism::mechanisms::{Mechanism, Mechanisms};
use crate::solver::solver_bodies::{SolverBodies, SolverRow, halved};
use crate::solver::substeps::GroupContact;
use crate::threads::InParts;

/// Overlaps up to this many roundings of a place are none.
const ROUNDINGS: f64 = 4.0;

impl Mechanisms {
    /// Takes the contacts that are solved with the joints of touched mechanisms out of those of a
    /// group, in substeps of `h` \[s\].
    pub(crate) fn take_direct(
        &mut self,
        (records, bodies, h): (&[ContactRecord], &SolverBodies, Real),
        (contacts, rounds): (&mut Vec<GroupContact>, &mut Vec<RoundConstraint>),
        direct: &mut DirectGroup,
        passes: &JointPasses,
    ) {
        let Self { mechanisms, choice, .. } = self;
        let of = Candidates { records, contacts, bodies, h: f64::from(h) };
        choice.begin(of);
        choice.own_passed(passes.rows().filter(|row| bodies.is_dynamic(*row)));
        for (number, it) in (0..).zip(&*mechanisms).filter(|(_, it)| it.solver.is_touched) {
            choice.own(number, it.jointed_bodies());
        }
        for (number, mechanism) in (0..).zip(&mut *mechanisms).filter(|(_, it)| it.solver.is_touched) {
            mechanism.begin_direct();
            choice.choose(of, number, mechanism.jointed_bodies());
            for place in &choice.chosen {
                let contact = contacts[*place as usize];
                let ends = contact.rows.map(|row| match choice.owner(row) {
                    Some(Owner { body: Some(body), .. }) => body as usize,
                    _ => mechanism.beside(row, bodies),
                });
                mechanism.direct.contacts.push(DirectContact::new(contact.number, ends));
                direct.contacts.push(contact);
            }
        }
        let mut places = 0..;
        contacts.retain(|_| places.next().is_none_or(|place| !choice.is_direct(place)));
        direct.rounds.extend(rounds.extract_if(.., |round| choice.is_number_direct(round.number())));
        for owner in contacts.iter().flat_map(|contact| contact.rows).filter_map(|row| choice.owner(row)) {
            if let Some(mechanism) = mechanisms.get_mut(owner.mechanism as usize) {
                mechanism.direct.has_passes = true;
            }
        }
    }

    /// To be called before the first substep of touched mechanisms.
    pub(crate) fn begin_touched(&mut self, (bodies, works): (&mut SolverBodies, &mut ContactWorks)) {
        works.before_joints(bodies);
        for mechanism in self.mechanisms.iter_mut().filter(|mechanism| mechanism.solver.is_touched) {
            mechanism.solver.begin();
            mechanism.solver.bodies.iter().for_each(|body| body.write_momentum(bodies));
        }
        bodies.lock_responses();
        works.after_joints(bodies);
    }

    /// Notes which touched mechanisms are held by a contact of these.
    fn note_held<'a>(&mut self, records: &[ContactRecord], contacts: impl Iterator<Item = &'a GroupContact>) {
        let Self { mechanisms, choice, .. } = self;
        mechanisms.iter_mut().for_each(|it| it.direct.is_held = false);
        let pushing = contacts.filter(|contact| records[contact.number as usize].has_impulses());
        for owner in pushing.flat_map(|contact| contact.rows).filter_map(|row| choice.owner(row)) {
            if let Some(mechanism) = mechanisms.get_mut(owner.mechanism as usize) {
                mechanism.direct.is_held = true;
            }
        }
    }

    /// Takes half of the first kick of forces back from touched mechanisms that no contact holds
    /// when the step begins: their velocities are those between two halves.
    pub(crate) fn halve_first_kick<'a>(
        &mut self,
        (records, contacts): (&[ContactRecord], impl Iterator<Item = &'a GroupContact>),
        (bodies, works): (&mut SolverBodies, &mut ContactWorks),
    ) {
        self.note_held(records, contacts);
        self.book_lag((bodies, works), 1.0);
        for it in self.mechanisms.iter().filter(|it| it.is_free()) {
            it.jointed_bodies().iter().for_each(|body| kick_by_half(body, bodies, -1.0));
        }
    }

    /// Books what velocities of held mechanisms are behind by, half a kick, to the integrator.
    fn book_lag(&self, (bodies, works): (&SolverBodies, &mut ContactWorks), sign: f64) {
        for it in self.mechanisms.iter().filter(|it| it.solver.is_touched && it.direct.is_held) {
            it.jointed_bodies().iter().for_each(|body| works.book_lag(body.row, bodies, sign));
        }
    }

    /// Gives touched mechanisms that no contact holds after the last substep, of `h` \[s\], half a
    /// kick, as those that nothing touches have it.
    pub(crate) fn add_last_half_kick<'a>(
        &mut self,
        (records, contacts): (&[ContactRecord], impl Iterator<Item = &'a GroupContact>),
        (bodies, works): (&mut SolverBodies, &mut ContactWorks),
        h: Real,
    ) {
        self.note_held(records, contacts);
        self.book_lag((bodies, works), -1.0);
        for it in self.mechanisms.iter().filter(|it| it.is_free()) {
            it.jointed_bodies().iter().for_each(|body| kick_by_half(body, bodies, 1.0));
        }
        works.before_joints(bodies);
        let from: &SolverBodies = bodies;
        let half = Half { phase: Phase::Velocities, h: f64::from(h), before: 1.0 };
        let solving = self.mechanisms.par_iter_mut().by_at_least(1).filter(|it| it.is_free());
        solving.for_each(|it| it.solve(from, |solver, _| solver.solve_velocities(half)));
        for it in self.mechanisms.iter().filter(|it| it.is_free() && it.is_sound) {
            it.jointed_bodies().iter().for_each(|body| body.write_momentum(bodies));
        }
        bodies.lock_responses();
        works.after_joints(bodies);
    }

    /// Solves joints and direct contacts of touched mechanisms, in a stage of a substep of `h`
    /// \[s\]: again for those that have contacts in passes, a bounce for those that may.
    pub(crate) fn solve_stage(
        &mut self,
        (bodies, works): (&mut SolverBodies, &mut ContactWorks),
        direct: &mut DirectGroup,
        (stage, h): (ContactStage, Real),
    ) {
        let takes_part = |it: &Mechanism| {
            it.solver.is_touched
                && match stage {
                    ContactStage::Positions | ContactStage::Velocities => true,
                    ContactStage::PositionsAgain => it.direct.has_passes,
                    ContactStage::Bounce(_) => it.direct.bounces(),
                }
        };
        for it in self.mechanisms.iter_mut().filter(|it| takes_part(it)) {
            it.direct.has_accounts = !works.is_empty();
            it.direct.contacts.iter_mut().for_each(|contact| direct.read(contact));
        }
        works.before_joints(bodies);
        let solving = self.mechanisms.par_iter_mut().by_at_least(1).filter(|it| takes_part(it));
        let from: &SolverBodies = bodies;
        solving.for_each(|it| it.solve(from, |solver, direct| solve_stage(solver, direct, stage, f64::from(h))));
        for it in self.mechanisms.iter_mut().filter(|it| takes_part(it)) {
            if !it.is_sound {
                continue;
            }
            let all = it.solver.bodies.iter().chain(&it.direct.beside);
            all.for_each(|body| body.write_momentum(bodies));
            for contact in &it.direct.contacts {
                match stage {
                    ContactStage::Positions | ContactStage::PositionsAgain => direct.write(contact),
                    ContactStage::Velocities => {
                        direct.write(contact);
                        direct.add_to_total(contact);
                    }
                    ContactStage::Bounce(_) => direct.add_to_total(contact),
                }
            }
        }
        bodies.lock_responses();
        works.after_joints(bodies);
        for it in self.mechanisms.iter().filter(|it| takes_part(it) && it.is_sound) {
            for (contact, done) in it.direct.contacts.iter().zip(&it.direct.works) {
                for (end, work) in contact.ends.into_iter().zip(done.of_ends) {
                    works.leave_to_contacts(it.row(end), work);
                }
            }
        }
    }
}

impl Mechanism {
    /// Whether it is touched, and no contact pushed when that was noted.
    fn is_free(&self) -> bool {
        self.solver.is_touched && !self.direct.is_held
    }

    /// The bodies that its joints connect, without the ground of locked axes.
    fn jointed_bodies(&self) -> &[MechanismBody] {
        &self.solver.bodies[..self.slots.len()]
    }

    /// Reads how its bodies and those beside it move.
    fn read_motion(&mut self, bodies: &SolverBodies) {
        let moving = self.solver.bodies.iter_mut().take(self.slots.len());
        moving.chain(&mut self.direct.beside).for_each(|body| body.read_motion(bodies));
    }

    /// Forgets the direct contacts of the last substep.
    fn begin_direct(&mut self) {
        let Self { direct, solver, .. } = self;
        direct.contacts.clear();
        direct.beside.clear();
        direct.works.clear();
        direct.has_passes = false;
        let farthest = solver.bodies.iter().map(|body| {
            let place = body.position();
            place.x.abs().max(place.y.abs()).max(place.z.abs())
        });
        direct.rounding = ROUNDINGS * f64::from(Real::EPSILON) * farthest.fold(0.0, f64::max);
    }

    /// The number of a body that belongs to no mechanism, among this one's.
    fn beside(&mut self, row: SolverRow, bodies: &SolverBodies) -> usize {
        let Self { direct, solver, .. } = self;
        let known = direct.beside.iter().position(|body| body.row == row);
        let place = known.unwrap_or_else(|| {
            direct.beside.push(MechanismBody::read(bodies, row, 0.0));
            direct.beside.len() - 1
        });
        solver.bodies.len() + place
    }

    /// The solver's row of a body.
    fn row(&self, end: usize) -> SolverRow {
        let bodies = &self.solver.bodies;
        bodies.get(end).unwrap_or_else(|| &self.direct.beside[end - bodies.len()]).row
    }

    /// Reads how its bodies move and solves its joints; forgets impulses that are not finite.
    fn solve(&mut self, bodies: &SolverBodies, solve: impl FnOnce(&mut MechanismSolver, &mut DirectContacts)) {
        self.read_motion(bodies);
        let Self { solver, direct, is_sound, .. } = self;
        solver.update_rows();
        solve(solver, direct);
        *is_sound = solver.bodies.iter().chain(&direct.beside).all(MechanismBody::is_finite);
        if !*is_sound {
            solver.forget_impulses();
        }
    }
}

/// Solves a stage of a substep of `h` \[s\].
fn solve_stage(solver: &mut MechanismSolver, direct: &mut DirectContacts, stage: ContactStage, h: f64) {
    match stage {
        ContactStage::Positions => solver.solve_once(h, direct, stage),
        ContactStage::PositionsAgain => {
            solver.take_back();
            solver.solve_once(h, direct, stage);
        }
        ContactStage::Velocities | ContactStage::Bounce(_) => solver.solve_velocities_once(h, direct, stage),
    }
}

/// Adds what forces do to a body in half a substep, times a sign.
fn kick_by_half(body: &MechanismBody, bodies: &mut SolverBodies, sign: Real) {
    if body.is_moved() {
        let kick = halved(bodies.force_impulse[body.row.index()], 1);
        let motion = &mut bodies.motion[body.row.index()];
        motion.momentum = motion.momentum + kick.linear * sign;
        motion.angular_momentum = motion.angular_momentum + kick.angular * sign;
    }
}
