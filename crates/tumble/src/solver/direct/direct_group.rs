//! The direct contacts of all mechanisms: their geometry, which follows the bodies as that of
//! others.

use crate::collision::contact::ContactRecord;
use crate::collision::contact_materials::Extras;
use crate::math::Real;
use crate::solver::contact::restitution::SubstepMoment;
use crate::solver::contact::round_contacts::RoundConstraint;
use crate::solver::direct::direct_contact::DirectContact;
use crate::solver::solver_bodies::SolverBodies;
use crate::solver::stages::{ContactConstraints, SolverStage};
use crate::solver::substeps::GroupContact;

/// Contacts in blocks that no pass goes over.
#[derive(Clone, Default)]
pub(crate) struct DirectGroup {
    pub(crate) contacts: Vec<GroupContact>,
    pub(crate) rounds: Vec<RoundConstraint>,
    constraints: ContactConstraints,
}

impl DirectGroup {
    pub(crate) fn clear(&mut self) {
        self.contacts.clear();
        self.rounds.clear();
    }

    /// Lays out the contacts at the start of a step.
    pub(crate) fn lay_out(&mut self, all: &[ContactRecord], bodies: &mut SolverBodies, extras: Extras) {
        let Self { contacts, rounds, constraints } = self;
        if contacts.is_empty() {
            return;
        }
        constraints.lay_out(all, contacts, bodies, extras);
        constraints.locate(all.len(), rounds);
        constraints.make_room_for_lags();
        constraints.place_all(all.len());
        bodies.with_poses(|bodies, poses| constraints.run(SolverStage::Prepare(all, poses), bodies));
        bodies.clear_warm_start();
    }

    /// Records how fast points come together before anything pushes.
    pub(crate) fn record_approach(&mut self, bodies: &mut SolverBodies, h: Real, moment: SubstepMoment) {
        if !self.contacts.is_empty() {
            self.constraints.run(SolverStage::RecordApproachSpeed(h, moment), bodies);
        }
    }

    /// Has the contacts follow their bodies, which moved for `h` \[s\].
    pub(crate) fn follow(&mut self, bodies: &mut SolverBodies, h: Real, extras: Extras) {
        if self.contacts.is_empty() {
            return;
        }
        self.constraints.update_round_contacts(&self.rounds, &bodies.delta_pose);
        let stage = if extras.bounces {
            SolverStage::RecordApproachSpeed(h, SubstepMoment::Motion)
        } else {
            SolverStage::Follow(h)
        };
        self.constraints.run(stage, bodies);
    }

    /// Reads how a contact stands, and its impulses in this substep.
    pub(crate) fn read(&mut self, contact: &mut DirectContact) {
        self.constraints.read_direct(contact);
    }

    /// Writes the impulses of a contact in this substep.
    pub(crate) fn write(&mut self, contact: &DirectContact) {
        self.constraints.write_direct(contact);
    }

    /// Adds what a contact does along the normal to its total of the step.
    pub(crate) fn add_to_total(&mut self, contact: &DirectContact) {
        self.constraints.add_to_total(contact);
    }

    /// Stores the impulses in the contacts.
    pub(crate) fn store_impulses(&mut self, all: &mut [ContactRecord]) {
        if !self.contacts.is_empty() {
            self.constraints.store_impulses(all);
        }
    }
}
