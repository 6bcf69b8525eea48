//! The works of bodies that touch something, for those who keep account of them.

use glam::DVec3;
use tumble_math::lane::Quat;

use crate::components::{Work, Wrench};
use crate::forces::evaluate::LawForces;
use crate::forces::force_law::BodyState;
use crate::integrators::Kick;
use crate::integrators::derived::symmetric_product;
use crate::integrators::kinetic_energy::KineticEnergy;
use crate::integrators::state::{Constants, Moments, State};
use crate::math::{Real, Vec3 as WorldVec3, double, dvec3};
use crate::solver::body_rows::BodyMotion;
use crate::solver::solver_bodies::{SolverBodies, SolverRow};
use crate::storage::body_index::Slot;

/// Accounts of the bodies that have [`Work`] and touch something, opened at the start of a step.
///
/// Forces are constant over a step of such bodies, and do work over the way that the body goes:
/// gravity what its potential energy says, and nothing on a body that is held. (Over the velocities
/// before and after its own kick, it would do work at rest, which contacts then undo.) Damping is
/// booked kick by kick, the free motion's error is measured, and what is left of the change of
/// kinetic energy is the contacts'.
#[derive(Clone, Default)]
pub(crate) struct ContactWorks {
    bodies: Vec<BodyWork>,
    /// The forces of all bodies, one body after the other.
    forces: Vec<(WorkSource, Wrench)>,
}

/// One body's account.
#[derive(Clone)]
struct BodyWork {
    /// Among the solver's bodies.
    row: usize,
    slot: Slot,
    constants: Constants<Real>,
    axes: Option<Quat<Real>>,
    /// How much damping leaves of linear and angular momentum in a substep.
    kept: (Real, Real),
    /// The end of its forces among all.
    forces_end: usize,
    /// Linear and angular momentum when they were last read.
    momenta: (DVec3, DVec3),
    /// Whether contacts changed a momentum.
    pushed: bool,
    /// Kinetic energy \[J\]: at the start, and before the body moved on.
    start: f64,
    last: f64,
    damping: f64,
    moving: f64,
    joints: f64,
    /// Whether it belongs to a mechanism that nothing touches: what is left is the joints'.
    is_of_joints: bool,
}

/// The source of a force.
#[derive(Clone, Copy, Debug)]
enum WorkSource {
    Gravity,
    Applied,
    /// By its index among all laws.
    Law(usize),
}

impl ContactWorks {
    pub(crate) fn clear(&mut self) {
        self.bodies.clear();
        self.forces.clear();
    }

    /// Opens the account of a body under these forces, with `gravity` among them, for kicks of
    /// `h` \[s\].
    pub(crate) fn open(
        &mut self,
        (slot, row): (Slot, SolverRow),
        (forces, gravity): (&LawForces<'_>, WorldVec3),
        state: &State<Real>,
        h: Real,
    ) {
        let LawForces { constants, context, wrench, laws, row: law_row, time } = forces;
        let applied = Wrench { force: wrench.force - gravity, torque: wrench.torque };
        self.forces.push((WorkSource::Gravity, Wrench { force: gravity, torque: WorldVec3::ZERO }));
        self.forces.push((WorkSource::Applied, applied));
        let seen = BodyState::new((*time, 0.0), (constants, context), state);
        self.forces
            .extend((*laws).into_iter().map(|(index, law)| (WorkSource::Law(index), law.wrench(*law_row, &seen))));
        let start = KineticEnergy::of(constants, state).sum();
        self.bodies.push(BodyWork {
            row: row.index(),
            slot,
            constants: **constants,
            axes: constants.inertia.and_then(|inertia| inertia.axes),
            kept: Kick::new(constants, h).kept(),
            forces_end: self.forces.len(),
            momenta: (DVec3::ZERO, DVec3::ZERO),
            pushed: false,
            start,
            last: start,
            damping: 0.0,
            moving: 0.0,
            joints: 0.0,
            is_of_joints: false,
        });
    }

    /// Copies the accounts of bodies whose rows have a place here, for substeps halved
    /// this many times.
    pub(crate) fn copy(&mut self, others: &Self, place: impl Fn(usize) -> Option<usize>, halvings: u8) {
        self.clear();
        for body in &others.bodies {
            if let Some(row) = place(body.row) {
                let kept = (0..halvings).fold(body.kept, |(p, l), _| (p.sqrt(), l.sqrt()));
                self.bodies.push(BodyWork { row, kept, ..body.clone() });
            }
        }
    }

    /// Copies the accounts back to those that they were taken from.
    pub(crate) fn copy_back(&self, others: &mut Self, place: impl Fn(usize) -> Option<usize>) {
        let taken = others.bodies.iter_mut().filter(|body| place(body.row).is_some());
        for (body, here) in taken.zip(&self.bodies) {
            *body = BodyWork { row: body.row, kept: body.kept, ..here.clone() };
        }
    }

    /// Notes what damping takes from bodies that are about to be kicked.
    pub(crate) fn before_forces(&mut self, bodies: &SolverBodies) {
        for body in &mut self.bodies {
            body.begin_substep(bodies);
        }
    }

    /// Notes momenta before contacts push.
    pub(crate) fn before_solve(&mut self, bodies: &SolverBodies) {
        for body in &mut self.bodies {
            body.momenta = momenta(&bodies.motion[body.row]);
        }
    }

    /// Notes energies before bodies move on.
    pub(crate) fn before_motion(&mut self, bodies: &SolverBodies) {
        for body in &mut self.bodies {
            body.last = body.energy(bodies);
        }
    }

    /// Notes what moving on did to the energies.
    pub(crate) fn after_motion(&mut self, bodies: &SolverBodies) {
        for body in &mut self.bodies {
            body.moving += body.energy(bodies) - body.last;
        }
    }

    /// Notes energies before joints push.
    pub(crate) fn before_joints(&mut self, bodies: &SolverBodies) {
        self.before_motion(bodies);
    }

    /// Notes what joints did to the energies.
    pub(crate) fn after_joints(&mut self, bodies: &SolverBodies) {
        for body in &mut self.bodies {
            body.joints += body.energy(bodies) - body.last;
            body.momenta = momenta(&bodies.motion[body.row]);
        }
    }

    /// Whether there are any accounts.
    pub(crate) fn is_empty(&self) -> bool {
        self.bodies.is_empty()
    }

    /// Books work that counts as the joints' to the contacts of a body \[J\].
    pub(crate) fn leave_to_contacts(&mut self, row: SolverRow, work: f64) {
        for body in self.bodies.iter_mut().filter(|body| body.row == row.index()) {
            body.joints -= work;
            body.pushed = true;
        }
    }

    /// Books the work of half a kick of forces on a body at the velocity that it has, times a sign,
    /// to the integrator.
    pub(crate) fn book_lag(&mut self, row: SolverRow, bodies: &SolverBodies, sign: f64) {
        for body in self.bodies.iter_mut().filter(|body| body.row == row.index()) {
            let kick = &bodies.force_impulse[body.row];
            let (velocity, angular) = body.velocities(momenta(&bodies.motion[body.row]), bodies);
            body.moving += 0.5 * sign * (double(kick.linear).dot(velocity) + double(kick.angular).dot(angular));
        }
    }

    /// Leaves the account of a body to its joints, but for what damping did \[J\].
    pub(crate) fn leave_to_joints(&mut self, row: SolverRow, damping: f64) {
        for body in self.bodies.iter_mut().filter(|body| body.row == row.index()) {
            (body.damping, body.moving, body.is_of_joints) = (damping, 0.0, true);
        }
    }

    /// Notes whether contacts pushed in a substep.
    pub(crate) fn after_substep(&mut self, bodies: &SolverBodies) {
        for body in &mut self.bodies {
            body.end_substep(bodies);
        }
    }

    /// The works done on all in this substep, by slot in the order they were opened.
    pub(crate) fn close<'a>(&'a self, bodies: &'a SolverBodies) -> impl Iterator<Item = (Slot, Work)> + 'a {
        let mut begin = 0;
        self.bodies.iter().map(move |body| {
            let forces = &self.forces[begin..body.forces_end];
            begin = body.forces_end;
            (body.slot, body.closed(forces, bodies))
        })
    }
}

impl BodyWork {
    fn energy(&self, bodies: &SolverBodies) -> f64 {
        // Joints may have raised its moments.
        let moments = bodies.inertia[self.row].moments;
        let inertia = self.constants.inertia.map(|inertia| Moments { moments, ..inertia });
        let constants = Constants { inertia, ..self.constants };
        KineticEnergy::of(&constants, &bodies.state(self.row, self.axes)).sum()
    }

    /// Velocities at momenta, with the attitude as it is.
    fn velocities(&self, (p, l): (DVec3, DVec3), bodies: &SolverBodies) -> (DVec3, DVec3) {
        let inverse = &bodies.inv_inertia[self.row];
        let [diagonal, off_diagonal] = [inverse.diagonal, inverse.off_diagonal].map(double);
        let angular = symmetric_product(diagonal.into(), off_diagonal.into(), l.into()).into();
        (p / f64::from(self.constants.mass), angular)
    }

    fn begin_substep(&mut self, bodies: &SolverBodies) {
        let (p, l) = momenta(&bodies.motion[self.row]);
        let damped = (p * f64::from(self.kept.0), l * f64::from(self.kept.1));
        let mean = self.velocities(((p + damped.0) * 0.5, (l + damped.1) * 0.5), bodies);
        self.damping += (damped.0 - p).dot(mean.0) + (damped.1 - l).dot(mean.1);
    }

    fn end_substep(&mut self, bodies: &SolverBodies) {
        let now = momenta(&bodies.motion[self.row]);
        self.pushed |= now != self.momenta;
        self.momenta = now;
    }

    fn closed(&self, forces: &[(WorkSource, Wrench)], bodies: &SolverBodies) -> Work {
        let Self { damping, joints, .. } = *self;
        let mut work = Work { damping, joints, integrator: self.moving, ..Work::default() };
        // Twice the vector of the rotation's quaternion is the angle about its axis, to third
        // order.
        let delta = &bodies.delta_pose[self.row];
        let [way, half_turn] = [delta.translation, delta.rotation.vector()].map(double);
        let turn = half_turn * 2.0;
        for (source, wrench) in forces {
            let done = dvec3(wrench.force).dot(way) + dvec3(wrench.torque).dot(turn);
            match source {
                WorkSource::Gravity => work.gravity += done,
                WorkSource::Applied => work.applied += done,
                WorkSource::Law(index) => *work.of_law_mut(*index) += done,
            }
        }
        let rest = self.energy(bodies) - self.start - work.total();
        // What was near something and touched nothing is the integrator's alone. A bounce comes
        // after the last substep.
        if self.is_of_joints {
            work.joints += rest;
        } else if self.pushed || momenta(&bodies.motion[self.row]) != self.momenta {
            work.contacts = rest;
        } else {
            work.integrator += rest;
        }
        work
    }
}

fn momenta(motion: &BodyMotion) -> (DVec3, DVec3) {
    (double(motion.momentum), double(motion.angular_momentum))
}
