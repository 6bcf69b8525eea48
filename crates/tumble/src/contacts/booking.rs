//! The works of bodies that touch something, for those who keep account of them.

use glam::DVec3;
use tumble_math::lane::{Quat, Vec3};

use super::solver_bodies::SolverBodies;
use crate::components::{Work, Wrench};
use crate::force_law::BodyState;
use crate::integrators::Kick;
use crate::law_forces::LawForces;
use crate::math::{Real, Vec3 as WorldVec3, double, dvec3};
use crate::simd::Eight;
use crate::state::{Constants, State};
use crate::totals::KineticEnergy;

/// Accounts of the bodies that have [`Work`] and touch something, opened at the start of a step.
///
/// Forces are constant over a step of such bodies, and act in kicks. What a kick `dP` from `P` to `P'` does is `dP.(P + P')/2M`, exactly, and likewise for rotation; so the work of each
/// force is its impulse times the sum of the mean velocities. What contacts do is the change of kinetic energy in their passes, which is measured, and what is left is the free motion's, the
/// integrator's error.
#[derive(Clone, Default)]
pub(super) struct Bookings {
    bookings: Vec<Booking>,
    /// Of all bookings, one after the other.
    forces: Vec<(Source, Wrench)>,
}

/// One body's account.
#[derive(Clone)]
struct Booking {
    /// Among the solver's bodies.
    row: usize,
    slot: usize,
    /// As it was before the step.
    work: Work,
    constants: Constants<Real>,
    axes: Option<Quat<Real>>,
    /// How much is left of linear and angular momentum in a kick, and for how long \[s\] a force counts in it.
    kept: (Real, Real),
    weights: (Real, Real),
    /// The end of its forces among all.
    forces_end: usize,
    /// Before the last kick.
    momenta: (DVec3, DVec3),
    /// Mean velocities in kicks, summed up.
    linear: DVec3,
    angular: DVec3,
    /// Kinetic energy \[J\]: at the start, and when it was last looked at.
    start: f64,
    last: f64,
    damping: f64,
    contacts: f64,
}

/// What a force comes from.
#[derive(Clone, Copy, Debug)]
enum Source {
    Gravity,
    Applied,
    /// By its index among all laws.
    Law(usize),
}

/// What has just been done to the bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Done {
    /// Contacts have pushed.
    Pushed,
    /// Bodies have moved on.
    Moved,
}

impl Bookings {
    pub(super) fn clear(&mut self) {
        self.bookings.clear();
        self.forces.clear();
    }

    /// Opens the account of a body that had done so much work, under these forces of which so much is gravity, for kicks of `h` \[s\].
    pub(super) fn open(
        &mut self,
        (slot, row): (usize, u32),
        work: Work,
        (forces, gravity): (&LawForces<'_>, WorldVec3),
        state: &State<Real>,
        h: Real,
    ) {
        let LawForces { constants, surroundings, wrench, laws, row: law_row, time } = forces;
        let applied = Wrench { force: wrench.force - gravity, torque: wrench.torque };
        self.forces.push((Source::Gravity, Wrench { force: gravity, torque: WorldVec3::ZERO }));
        self.forces.push((Source::Applied, applied));
        let seen = BodyState::new((*time, 0.0), (constants, surroundings), state);
        self.forces.extend((*laws).into_iter().map(|(index, law)| (Source::Law(index), law.wrench(*law_row, &seen))));
        let kick = Kick::new(constants, h);
        let start = KineticEnergy::of(constants, state).sum();
        self.bookings.push(Booking {
            row: row as usize,
            slot,
            work,
            constants: **constants,
            axes: constants.inertia.and_then(|inertia| inertia.axes),
            kept: kick.kept(),
            weights: kick.weights(),
            forces_end: self.forces.len(),
            momenta: (double(state.linear), double(state.angular)),
            linear: DVec3::ZERO,
            angular: DVec3::ZERO,
            start,
            last: start,
            damping: 0.0,
            contacts: 0.0,
        });
    }

    /// Notes momenta before a kick.
    pub(super) fn before_kick(&mut self, bodies: &SolverBodies) {
        for booking in &mut self.bookings {
            booking.momenta = momenta(&bodies.motion[booking.row]);
        }
    }

    /// Notes what a kick did.
    pub(super) fn after_kick(&mut self, bodies: &SolverBodies) {
        for booking in &mut self.bookings {
            booking.kicked(&bodies.motion[booking.row], &bodies.response[booking.row]);
            booking.last = booking.energy(bodies);
        }
    }

    /// Notes what has been done since energies were last looked at.
    pub(super) fn after(&mut self, done: Done, bodies: &SolverBodies) {
        for booking in &mut self.bookings {
            let energy = booking.energy(bodies);
            if done == Done::Pushed {
                booking.contacts += energy - booking.last;
            }
            booking.last = energy;
        }
    }

    /// The works of all, by slot in the order they were opened, those of before the step among them.
    pub(super) fn close<'a>(&'a self, bodies: &'a SolverBodies) -> impl Iterator<Item = (usize, Work)> + 'a {
        let mut begin = 0;
        self.bookings.iter().map(move |booking| {
            let forces = &self.forces[begin..booking.forces_end];
            begin = booking.forces_end;
            (booking.slot, booking.closed(forces, booking.energy(bodies)))
        })
    }
}

impl Booking {
    fn energy(&self, bodies: &SolverBodies) -> f64 {
        KineticEnergy::of(&self.constants, &bodies.state(self.row, self.axes)).sum()
    }

    /// Notes the kick that led to this momentum of a body with this inverse inertia: damping takes its part first, then forces act.
    fn kicked(&mut self, motion: &Eight, response: &Eight) {
        let (before, after) = (self.momenta, momenta(motion));
        let damped = (before.0 * f64::from(self.kept.0), before.1 * f64::from(self.kept.1));
        let inverse_mass = 1.0 / f64::from(self.constants.mass);
        let Eight([xx, yy, zz, yz, zx, xy, ..]) = *response;
        let [diagonal, off_diagonal] = [Vec3::new(xx, yy, zz), Vec3::new(yz, zx, xy)].map(double);
        let spin = |l: DVec3| crate::derived::symmetric_product(diagonal.into(), off_diagonal.into(), l.into()).into();
        let halfway = |a: (DVec3, DVec3), b: (DVec3, DVec3)| -> (DVec3, DVec3) {
            ((a.0 + b.0) * (0.5 * inverse_mass), spin((a.1 + b.1) * 0.5))
        };
        let mean = halfway(before, damped);
        self.damping += (damped.0 - before.0).dot(mean.0) + (damped.1 - before.1).dot(mean.1);
        let mean = halfway(damped, after);
        self.linear += mean.0;
        self.angular += mean.1;
    }

    fn closed(&self, forces: &[(Source, Wrench)], end: f64) -> Work {
        let mut work = Work { damping: self.damping, contacts: self.contacts, ..Work::default() };
        let (linear, angular) = (self.linear * f64::from(self.weights.0), self.angular * f64::from(self.weights.1));
        for (source, wrench) in forces {
            let done = dvec3(wrench.force).dot(linear) + dvec3(wrench.torque).dot(angular);
            match source {
                Source::Gravity => work.gravity += done,
                Source::Applied => work.applied += done,
                Source::Law(index) => *work.of_law_mut(*index) += done,
            }
        }
        work.integrator = end - self.start - work.total();
        work += self.work;
        work
    }
}

fn momenta(motion: &Eight) -> (DVec3, DVec3) {
    let Eight([px, py, pz, lx, ly, lz, ..]) = *motion;
    (double(Vec3::new(px, py, pz)), double(Vec3::new(lx, ly, lz)))
}
