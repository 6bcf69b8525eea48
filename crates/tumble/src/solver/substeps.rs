//! The substep loop of the contact solver, with islands on shorter substeps in separate groups.

use crate::collision::contact::ContactRecord;
use crate::collision::contact_materials::Extras;
use crate::collision::find_contacts::{Contacts, rows_of};
use crate::forces::registry::ForceLaws;
use crate::math::Real;
use crate::settings::Settings;
use crate::solver::contact::restitution::SubstepMoment;
use crate::solver::contact::round_contacts;
use crate::solver::contact::round_contacts::RoundContact;
use crate::solver::contact_work::ContactWorks;
use crate::solver::halved_substeps::HalvedGroup;
use crate::solver::solver_bodies::SolverBodies;
use crate::solver::stack_stiffness::Stacks;
use crate::solver::stages::{Solver, SolverStage};
use crate::storage::world_columns::WorldColumns;

/// The bodies that touch something and what is done to them in a substep of the settings: those of
/// one world, or of several.
#[derive(Clone, Default)]
pub(crate) struct ContactSolver {
    /// At first all bodies; where some have shorter substeps, in the end too.
    pub(crate) group: SolverGroup,
    /// By contact, how often its substeps are halved.
    pub(crate) halvings: Vec<u8>,
    halved_groups: Vec<HalvedGroup>,
    pub(crate) stacks: Stacks,
}

/// Bodies that are advanced in substeps of the same length, and the contacts among them.
#[derive(Clone, Default)]
pub(crate) struct SolverGroup {
    pub(crate) bodies: SolverBodies,
    pub(crate) contact_works: ContactWorks,
    /// Contacts that are found again in each substep.
    pub(crate) rounds: Vec<RoundContact>,
    /// The numbers of its contacts.
    pub(crate) selected: Vec<u32>,
    solver: Solver,
}

/// What a free fall over this many substeps of the settings gives is no impact yet: it may rest,
/// and shake.
const FALLS: Real = 4.0;

/// How contacts are solved in a substep of the settings.
#[derive(Clone, Copy)]
pub(crate) struct SubstepSettings {
    substeps: u32,
    /// Their length \[s\].
    h: Real,
    extras: Extras,
    /// Slower points do not bounce [m/s].
    threshold: Real,
    /// What comes faster is an impact \[m/s\].
    impact_speed: Real,
}

impl ContactSolver {
    /// Makes room for the bodies that impulses move and for those that they do not.
    pub(crate) fn reset(&mut self, [dynamic, non_dynamic]: [usize; 2]) {
        self.group.contact_works.clear();
        self.group.rounds.clear();
        self.halvings.clear();
        self.group.bodies.reset(dynamic, non_dynamic);
    }

    /// Works out where the bodies of one world that touch something will be after one substep of
    /// the settings, starting from the world as it is.
    pub(crate) fn solve_world(
        &mut self,
        found: &mut Contacts,
        columns: &mut WorldColumns<'_>,
        (settings, laws, time): (&Settings, &ForceLaws, f64),
    ) {
        let touching = found.find_touching(columns, settings);
        self.reset(touching);
        let first = [0, self.group.bodies.first_non_dynamic()];
        found.gather(columns, (settings, laws, time), &mut self.group, first);
        found.add_round_contacts(0, &mut self.group.rounds);
        self.stacks.add_halvings(found, settings, &self.group.bodies, &mut self.halvings);
        let Contacts { contacts, rows, materials, .. } = found;
        self.solve_substeps(contacts, |contact| rows_of(contact, rows), settings, materials.extras());
    }

    /// Solves the contacts between these rows over one substep of the settings. Bodies are left
    /// where they end up, and contacts with the impulses of their last substep.
    pub(crate) fn solve_substeps(
        &mut self,
        contacts: &mut [ContactRecord],
        rows: impl Fn(&ContactRecord) -> [u32; 2],
        settings: &Settings,
        extras: Extras,
    ) {
        let Self { group, halvings, halved_groups, .. } = self;
        let (substeps, h) = (settings.contact_substeps_each(), settings.contact_substep());
        let threshold = settings.restitution_threshold;
        let impact_speed = threshold.max(FALLS * settings.gravity.length() * settings.substep());
        let solving = SubstepSettings { substeps, h, extras, threshold, impact_speed };
        let mut parts = 0;
        let numbers = 0..contacts.len() as u32;
        group.selected.clear();
        match halvings.iter().max() {
            None | Some(0) => group.selected.extend(numbers),
            Some(most) => {
                for times in (1..=*most).filter(|times| halvings.contains(times)) {
                    halved_groups.resize_with(halved_groups.len().max(parts + 1), HalvedGroup::default);
                    halved_groups[parts].take((times, halvings), contacts, &rows, group);
                    parts += 1;
                }
                group.selected.extend(numbers.filter(|contact| halvings[*contact as usize] == 0));
            }
        }
        group.solve_substeps(contacts, &rows, solving);
        for part in &mut halved_groups[..parts] {
            part.solve_substeps(contacts, &rows, solving);
            part.return_results(contacts, group);
        }
    }
}

impl SubstepSettings {
    /// The same in substeps halved so often.
    pub(crate) fn halved(self, times: u8) -> Self {
        Self { substeps: self.substeps << times, h: self.h / (1u32 << times) as Real, ..self }
    }
}

impl SolverGroup {
    /// Advances the bodies under their chosen contacts; `rows` are those of a contact here.
    pub(crate) fn solve_substeps(
        &mut self,
        contacts: &mut [ContactRecord],
        rows: impl Fn(&ContactRecord) -> [u32; 2],
        SubstepSettings { substeps, h, extras, threshold, impact_speed }: SubstepSettings,
    ) {
        let (Self { bodies, contact_works, rounds, selected, solver }, solve) =
            (self, SolverStage::solve(h, impact_speed));
        solver.lay_out((contacts, selected), rows, bodies, extras);
        round_contacts::drop_needles(rounds, bodies);
        solver.locate(contacts.len(), rounds);
        bodies.with_poses(|bodies, poses| solver.run(SolverStage::Prepare(contacts, poses), bodies));
        for substep in 0..substeps {
            contact_works.before_forces(bodies);
            bodies.integrate_velocities();
            contact_works.before_solve(bodies);
            // Before the impulses of the last step act: bodies that those push together have not
            // come together, and to bounce them would make energy.
            if extras.bounces {
                let moment = if substep == 0 { SubstepMoment::FirstForces } else { SubstepMoment::Forces };
                solver.run(SolverStage::RecordApproachSpeed(h, moment), bodies);
            }
            bodies.apply_warm_start();
            solver.run(solve, bodies);
            contact_works.before_motion(bodies);
            bodies.integrate_positions(h);
            solver.update_round_contacts(rounds, &bodies.delta_pose);
            contact_works.after_motion(bodies);
            if extras.bounces {
                solver.run(SolverStage::RecordApproachSpeed(h, SubstepMoment::Motion), bodies);
            }
            solver.run(SolverStage::Relax { h, impact_speed, stores_warm_start: substep + 1 < substeps }, bodies);
            contact_works.after_substep(bodies);
        }
        if extras.bounces {
            solver.run(SolverStage::ApplyRestitution(threshold), bodies);
        }
        solver.store_impulses(contacts);
    }
}
