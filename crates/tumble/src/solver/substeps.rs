//! The solver: the substep loop over constrained bodies, with islands on shorter substeps in
//! separate groups.

use crate::collision::contact::ContactRecord;
use crate::collision::contact_materials::Extras;
use crate::collision::contact_set::ContactSet;
use crate::math::Real;
use crate::settings::Settings;
use crate::solver::contact::free_collision::FreeCollision;
use crate::solver::contact::restitution::SubstepMoment;
use crate::solver::contact::round_contacts::RoundConstraint;
use crate::solver::contact_work::ContactWorks;
use crate::solver::direct::direct_contacts::ContactStage;
use crate::solver::direct::direct_group::DirectGroup;
use crate::solver::energy_bounds::EnergyBounds;
use crate::solver::gather_scatter::{Constraints, ForceInputs, gather};
use crate::solver::halved_substeps::HalvedGroup;
use crate::solver::joint_passes::pass_stages::JointPasses;
use crate::solver::mechanism::mechanisms::Mechanisms;
use crate::solver::solver_bodies::{SolverBodies, SolverRow};
use crate::solver::stack::stack_stiffness::Stacks;
use crate::solver::stages::{ContactConstraints, SolverStage};
use crate::solver::stale_impulses::StaleImpulses;
use crate::storage::body_index::{BodyIndex, Slot};
use crate::storage::world_columns::WorldColumns;

/// Advances constrained bodies over a substep of the settings: those of one world, or of several.
#[derive(Clone, Default)]
pub(crate) struct Solver {
    /// At first all bodies; where some have shorter substeps, in the end too.
    group: SolverGroup,
    /// By contact, how often its substeps are halved.
    halvings: Vec<u8>,
    halved_groups: Vec<HalvedGroup>,
    stacks: Stacks,
    stale: StaleImpulses,
}

/// Bodies that are advanced in substeps of the same length, and the contacts among them.
#[derive(Clone, Default)]
pub(crate) struct SolverGroup {
    pub(crate) bodies: SolverBodies,
    pub(crate) contact_works: ContactWorks,
    /// Contacts that are found again in each substep.
    pub(crate) rounds: Vec<RoundConstraint>,
    pub(crate) free_collisions: Vec<FreeCollision>,
    pub(crate) contacts: Vec<GroupContact>,
    constraints: ContactConstraints,
    direct: DirectGroup,
    joints: JointPasses,
    energy_bounds: EnergyBounds,
}

/// A contact of a group.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) struct GroupContact {
    /// Its number among all.
    pub(crate) number: u32,
    /// Its bodies in the group.
    pub(crate) rows: [SolverRow; 2],
}

/// A speed up to that of a free fall over this many substeps of the settings is no impact: bodies
/// at rest may shake that fast.
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
    /// Points that approach faster are impacts [m/s].
    impact_speed: Real,
}

impl Solver {
    /// Makes room for dynamic bodies, and for others.
    pub(crate) fn reset(&mut self, [dynamic, non_dynamic]: [usize; 2]) {
        let SolverGroup { bodies, contact_works, rounds, free_collisions, contacts, direct, joints, .. } =
            &mut self.group;
        direct.clear();
        joints.clear();
        contact_works.clear();
        rounds.clear();
        free_collisions.clear();
        contacts.clear();
        bodies.reset(dynamic, non_dynamic);
        self.halvings.clear();
    }

    /// The first rows that a world's bodies can have: dynamic ones, and others.
    pub(crate) fn first_rows(&self) -> [usize; 2] {
        [0, self.group.bodies.first_non_dynamic()]
    }

    /// Adds the constrained bodies of a world, in rows from these on, and their contacts. Returns
    /// the rows after them.
    pub(crate) fn add_world(
        &mut self,
        constraints: &mut Constraints<'_>,
        body_index: &BodyIndex,
        columns: &mut WorldColumns<'_>,
        inputs: ForceInputs<'_>,
        first_rows: [usize; 2],
    ) -> [usize; 2] {
        let Self { group, halvings, stacks, stale, .. } = self;
        let SolverGroup { bodies, contact_works, rounds, free_collisions, contacts: all, direct, joints, .. } = group;
        let results = (&mut *bodies, contact_works);
        let next_rows = gather(constraints, body_index, columns, inputs, results, first_rows);
        let Constraints { bodies: constrained, contacts, mechanisms, pairs } = constraints;
        let settings = inputs.0;
        let (records, most) = (&mut contacts.records, impact_speed(settings));
        let jointed = mechanisms.list.pairs().flatten().filter_map(|slot| constrained.row(slot));
        let is_pulled = |slot: Slot| pairs.is_some_and(|pairs| pairs.act_on(body_index.key(slot).2));
        let slots = (0..).map(Slot).zip(constrained.rows());
        let pulled = slots.filter(|(slot, _)| is_pulled(*slot)).filter_map(|(_, row)| row);
        stale.drop(records, constrained, bodies, jointed.chain(pulled), most);
        let (constrained, first) = (&**constrained, all.len() as u32);
        let begin = inputs.2;
        let passes = (settings.joint_solver, &mut *joints);
        let middle = begin + 0.5 * f64::from(settings.substep());
        mechanisms.gather((constrained, contacts), body_index, columns, bodies, passes, middle);
        if constrained.jointed_locks().next().is_some() {
            mechanisms.lock(constrained, bodies);
        }
        let ContactSet { records, rounds: found, .. } = &mut **contacts;
        rounds.extend(found.drain(..).map(|round| {
            let contact = &records[round.contact as usize];
            RoundConstraint::new(round, contact, constrained.rows_of(contact.slots), first)
        }));
        all.extend((first..).zip(&*records).map(|(number, contact)| {
            let rows = constrained.rows_of(contact.slots);
            // Each has all of what happens to its bodies.
            let is_known = || free_collisions.last().is_some_and(|it| it.rows == rows);
            if contact.is_of_meeting() && !is_known() {
                free_collisions.extend(FreeCollision::new(number, contact, rows, bodies));
            }
            GroupContact { number, rows }
        }));
        stacks.add_halvings(records, constrained, settings, bodies, halvings);
        if mechanisms.are_touched() || !joints.is_empty() {
            mechanisms.keep_whole(records, constrained, bodies, &mut halvings[first as usize..]);
        }
        if mechanisms.are_touched() {
            // Worlds with joints are solved by themselves: their contacts are all that there are.
            let h = settings.contact_substep();
            mechanisms.take_direct((records, bodies, h), (all, rounds), direct, joints);
        }
        next_rows
    }

    /// Advances the bodies of one world over a substep of the settings, from where they are.
    pub(crate) fn solve_world(
        &mut self,
        mut constraints: Constraints<'_>,
        body_index: &BodyIndex,
        columns: &mut WorldColumns<'_>,
        inputs: ForceInputs<'_>,
    ) {
        self.reset(constraints.bodies.counts());
        let first_rows = self.first_rows();
        self.add_world(&mut constraints, body_index, columns, inputs, first_rows);
        let Constraints { bodies, contacts, mechanisms, .. } = constraints;
        let [dynamic, _] = bodies.counts();
        let settings = inputs.0;
        mechanisms.advance_untouched(settings.contact_substeps_each(), settings.contact_substep());
        // Bodies of mechanisms that nothing touches have been advanced.
        if mechanisms.advanced() < dynamic {
            self.solve_substeps(&mut contacts.records, settings, contacts.extras, mechanisms);
        }
        let SolverGroup { bodies: solved, contact_works, joints, .. } = &mut self.group;
        mechanisms.write(solved, contact_works);
        mechanisms.write_passed(joints, (bodies, solved), body_index, columns);
    }

    /// Solves the contacts that were added over one substep of the settings. Bodies are left where
    /// they end up, and contacts with the impulses of their last substep.
    pub(crate) fn solve_substeps(
        &mut self,
        contacts: &mut [ContactRecord],
        settings: &Settings,
        extras: Extras,
        mechanisms: &mut Mechanisms,
    ) {
        let Self { group, halvings, halved_groups, .. } = self;
        let (substeps, h) = (settings.contact_substeps_each(), settings.contact_substep());
        let (threshold, impact_speed) = (settings.restitution_threshold, impact_speed(settings));
        let solving = SubstepSettings { substeps, h, extras, threshold, impact_speed };
        let mut parts = 0;
        let most = halvings.iter().copied().max().unwrap_or(0);
        for times in (1..=most).filter(|times| halvings.contains(times)) {
            halved_groups.resize_with(halved_groups.len().max(parts + 1), HalvedGroup::default);
            halved_groups[parts].take((times, halvings), group);
            parts += 1;
        }
        group.solve_substeps(contacts, solving, Some(mechanisms));
        for part in &mut halved_groups[..parts] {
            part.solve_substeps(contacts, solving);
            part.return_results(contacts, group);
        }
    }

    /// The bodies, and the works done on those that have accounts.
    pub(crate) fn results(&self) -> (&SolverBodies, &ContactWorks) {
        (&self.group.bodies, &self.group.contact_works)
    }
}

/// Points that approach faster are impacts [m/s].
pub(crate) fn impact_speed(settings: &Settings) -> Real {
    settings.restitution_threshold.max(FALLS * settings.gravity.length() * settings.substep())
}

impl SubstepSettings {
    /// The same in substeps halved this many times.
    pub(crate) fn halved(self, times: u8) -> Self {
        Self { substeps: self.substeps << times, h: self.h / (1u32 << times) as Real, ..self }
    }
}

impl SolverGroup {
    /// Advances the bodies under their contacts, of those of all groups.
    pub(crate) fn solve_substeps(
        &mut self,
        all: &mut [ContactRecord],
        SubstepSettings { substeps, h, extras, threshold, impact_speed }: SubstepSettings,
        mechanisms: Option<&mut Mechanisms>,
    ) {
        let mut mechanisms = mechanisms.filter(|mechanisms| mechanisms.are_touched());
        let solve = SolverStage::solve(h, impact_speed);
        self.begin(all, extras, mechanisms.as_deref_mut());
        let Self { bodies, contact_works, rounds, free_collisions, constraints, direct, joints, energy_bounds, .. } =
            self;
        for substep in 0..substeps {
            contact_works.before_forces(bodies);
            bodies.integrate_velocities();
            energy_bounds.after_forces(bodies);
            contact_works.before_solve(bodies);
            let (begin, end) = (f64::from(substep) * f64::from(h), f64::from(substep + 1) * f64::from(h));
            free_collisions.iter_mut().for_each(|it| it.before_impulses(bodies));
            // Before the impulses of the last step act: bodies that those push together have not
            // come together, and to bounce them would make energy.
            if extras.bounces {
                let moment = if substep == 0 { SubstepMoment::FirstForces } else { SubstepMoment::Forces };
                constraints.run(SolverStage::RecordApproachSpeed(h, moment), bodies);
                direct.record_approach(bodies, h, moment);
            }
            bodies.apply_warm_start();
            joints.apply_warm_start(bodies, contact_works);
            if let Some(mechanisms) = &mut mechanisms {
                mechanisms.solve_stage((bodies, contact_works), direct, (ContactStage::Positions, h));
            }
            joints.solve(h, bodies, contact_works);
            constraints.run(solve, bodies);
            if let Some(mechanisms) = &mut mechanisms {
                mechanisms.solve_stage((bodies, contact_works), direct, (ContactStage::PositionsAgain, h));
            }
            bodies.settle_locked();
            free_collisions.iter_mut().for_each(|it| it.after_impulses(bodies, begin));
            contact_works.before_motion(bodies);
            bodies.integrate_positions(h);
            constraints.update_round_contacts(rounds, &bodies.delta_pose);
            contact_works.after_motion(bodies);
            if extras.bounces {
                constraints.run(SolverStage::RecordApproachSpeed(h, SubstepMoment::Motion), bodies);
            }
            direct.follow(bodies, h, extras);
            if let Some(mechanisms) = &mut mechanisms {
                mechanisms.solve_stage((bodies, contact_works), direct, (ContactStage::Velocities, h));
            }
            joints.relax(h, bodies, contact_works);
            constraints.run(SolverStage::Relax { h, impact_speed, stores_warm_start: substep + 1 < substeps }, bodies);
            energy_bounds.bound_substep(bodies);
            contact_works.after_substep(bodies);
            free_collisions.iter_mut().for_each(|it| it.after_impulses(bodies, end));
        }
        if extras.bounces {
            constraints.run(SolverStage::ApplyRestitution(threshold), bodies);
            energy_bounds.bound_step(bodies);
            if let Some(mechanisms) = &mut mechanisms {
                let stage = ContactStage::Bounce(threshold.into());
                mechanisms.solve_stage((bodies, contact_works), direct, (stage, h));
            }
        }
        self.finish(all, f64::from(substeps) * f64::from(h));
        let Self { bodies, contact_works, contacts, direct, .. } = self;
        if let Some(mechanisms) = mechanisms {
            let contacts = contacts.iter().chain(&direct.contacts);
            mechanisms.add_last_half_kick((all, contacts), (bodies, contact_works), h);
        }
    }

    /// To be called before the first substep, with the mechanisms that contacts act on.
    fn begin(&mut self, all: &mut [ContactRecord], extras: Extras, mechanisms: Option<&mut Mechanisms>) {
        let Self { bodies, contact_works, rounds, contacts, constraints, direct, joints, energy_bounds, .. } = self;
        direct.lay_out(all, bodies, extras);
        constraints.lay_out(all, contacts, bodies, extras);
        constraints.locate(all.len(), rounds);
        constraints.make_room_for_lines();
        joints.begin(bodies, contact_works);
        let bounded = if mechanisms.is_some() || !joints.is_empty() { &[][..] } else { &**contacts };
        energy_bounds.begin(all, bounded, bodies);
        bodies.with_poses(|bodies, poses| constraints.run(SolverStage::Prepare(all, poses), bodies));
        if let Some(mechanisms) = mechanisms {
            mechanisms.begin_touched((bodies, contact_works));
            mechanisms.halve_first_kick((all, contacts.iter().chain(&direct.contacts)), (bodies, contact_works));
        }
    }

    /// To be called after the last substep, at this time since the first began \[s\].
    fn finish(&mut self, all: &mut [ContactRecord], end: f64) {
        let Self { bodies, contact_works, free_collisions, constraints, direct, joints, .. } = self;
        joints.finish(bodies, contact_works);
        bodies.settle_locked();
        free_collisions.iter_mut().for_each(|it| it.finish(bodies, end));
        constraints.store_impulses(all);
        direct.store_impulses(all);
    }
}
