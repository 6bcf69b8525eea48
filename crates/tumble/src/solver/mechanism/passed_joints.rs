//! Which joints of a world are solved in passes, and what they are read from and written to.

use crate::joint_solver::JointSolver;
use crate::joints::held_impulses::{HeldImpulse, HeldImpulses};
use crate::math::double;
use crate::solver::constrained_bodies::ConstrainedBodies;
use crate::solver::joint_passes::pass_stages::{JointPasses, PassedJoint};
use crate::solver::mechanism::joint_anchor::anchor;
use crate::solver::mechanism::joint_rows::JointRows;
use crate::solver::mechanism::mechanism_body::MechanismBody;
use crate::solver::mechanism::mechanism_solver::MechanismSolver;
use crate::solver::mechanism::mechanisms::Mechanisms;
use crate::solver::mechanism::rotations::Rotations;
use crate::solver::solver_bodies::SolverBodies;
use crate::storage::body_index::{BodyIndex, Slot};
use crate::storage::world_columns::WorldColumns;

/// The joints of a world that are solved in passes.
#[derive(Clone, Debug, Default)]
pub(crate) struct PassedJoints {
    /// What they were chosen for.
    pub(super) solver: JointSolver,
    /// As numbers of active joints, in order.
    pub(super) numbers: Vec<u32>,
    /// By mechanism, its bodies.
    pub(super) mechanisms: Vec<Vec<Slot>>,
    pub(crate) held: HeldImpulses,
}

impl PassedJoints {
    /// Forgets them all.
    pub(super) fn clear(&mut self) {
        self.numbers.clear();
        self.mechanisms.clear();
        self.held.clear();
    }

    /// The solver of a mechanism that is solved directly; `None` of one in passes. One with locked
    /// axes, with rows along free axes or with joints of other kinds is not in passes.
    pub(super) fn direct(
        &self,
        joints: &[JointRows],
        moves: &[bool],
        is_free_of_locks: bool,
    ) -> Option<(MechanismSolver, Vec<u32>)> {
        let is_fit = |joint: &JointRows| joint.is_rigid_pin() && !matches!(joint.rotations, Rotations::AboutBoth(..));
        let may_pass = self.solver != JointSolver::Direct && is_free_of_locks && joints.iter().all(is_fit);
        if may_pass && self.solver == JointSolver::Passes {
            return None;
        }
        MechanismSolver::new(joints, moves, may_pass)
    }
}

impl Mechanisms {
    /// Adds the joints in passes to those of a group, and their bodies.
    pub(super) fn add_passed(
        &mut self,
        constrained: &ConstrainedBodies,
        body_index: &BodyIndex,
        columns: &WorldColumns<'_>,
        bodies: &SolverBodies,
        passes: &mut JointPasses,
    ) {
        let Self { list, active, passed, loads, is_touched, .. } = self;
        let PassedJoints { numbers, mechanisms, held, .. } = passed;
        let mut impulses = held.in_order();
        for number in numbers {
            let number = active[*number as usize];
            let joint = &list.joints[number as usize];
            let [Some(first), Some(second)] = joint.slots.map(|slot| constrained.row(slot)) else { continue };
            let anchors = [0, 1].map(|end| anchor(joint, end, body_index, columns));
            let rotations = Rotations::of(joint.joint.free);
            let rows = ([first, second], bodies);
            let Some(joint) = PassedJoint::new(number, rotations, rows, anchors, impulses(joint)) else { continue };
            passes.add(joint);
        }
        for slots in mechanisms {
            let is_any_touched = slots.iter().any(|slot| is_touched[slot.index()]);
            let with_load = |slot: &Slot| Some((constrained.row(*slot)?, *slot, loads[slot.index()]));
            passes.bodies.add_mechanism(slots.iter().filter_map(with_load), is_any_touched, bodies);
        }
    }

    /// Notes the loads of joints in passes, the impulses that they begin the next step with, what
    /// they have done, and how they stand. Those that are not finite are forgotten.
    pub(crate) fn write_passed(
        &mut self,
        passes: &JointPasses,
        (constrained, bodies): (&ConstrainedBodies, &SolverBodies),
        body_index: &BodyIndex,
        columns: &WorldColumns<'_>,
    ) {
        let Self { list, loads, done, values_and_speeds, passed: PassedJoints { held, .. }, .. } = self;
        passes.bodies.loads().for_each(|(slot, load)| loads[slot.index()] = load);
        // Those of bodies that sleep are what they fell asleep with.
        held.joints.retain(|joint| joint.slots.iter().any(|slot| constrained.sleepers.has(*slot)));
        let are_any_asleep = !held.joints.is_empty();
        for (number, impulses, [impulse, angular]) in passes.results() {
            let (number, joint) = (number as usize, &list.joints[number as usize]);
            held.joints.push(HeldImpulse { slots: joint.slots, impulses });
            let [impulse, angular] = [impulse, angular].map(|it| double(it).into());
            done[number] = [done[number][0] + impulse, done[number][1] + angular];
            let rows = joint.slots.map(|slot| constrained.row(slot));
            if let (true, [Some(first), Some(second)]) = (joint.has_load, rows) {
                let mut rows = JointRows::new(
                    [0, 1],
                    [0, 1].map(|end| anchor(joint, end, body_index, columns)),
                    joint.joint.free,
                    None,
                );
                let mut ends = [first, second].map(|row| MechanismBody::read(bodies, row, 0.0));
                rows.begin_step(&ends);
                ends.iter_mut().for_each(|body| body.read_motion(bodies));
                values_and_speeds[number] = rows.values_and_speeds(&ends);
            }
        }
        if are_any_asleep {
            held.joints.sort_by_key(|joint| joint.slots);
        }
        if !held.are_finite() {
            held.clear();
        }
    }
}
