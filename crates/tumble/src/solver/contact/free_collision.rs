//! Two free bodies that meet in the middle of a substep: where they would be had the impulses acted
//! then.
//!
//! The solver's impulses act when substeps begin and end, with the arms that the bodies have when
//! they meet. Then those do not end in one point, and the angular momentum of the two changes. Had
//! an impulse `J` acted when they met, a body of mass `m` would be elsewhere: by `J (t - t_meet) /
//! m` for an impulse at a time `t`. There the two have the angular momentum that they had before.

use glam::DVec3;

use crate::collision::contact::ContactRecord;
use crate::math::{double, vec3};
use crate::solver::solver_bodies::{SolverBodies, SolverRow};

/// Two free bodies that meet nothing else that is free.
#[derive(Clone, Debug)]
pub(crate) struct FreeCollision {
    /// That of the contact among all.
    pub(crate) number: u32,
    pub(crate) rows: [SolverRow; 2],
    /// When they meet, from the begin of the step \[s\].
    moment: f64,
    /// Velocity of the second relative to the first before the next impulses \[m/s\].
    velocity: DVec3,
    /// How far the second is to be moved relative to the first \[m\].
    shift: DVec3,
}

impl FreeCollision {
    /// Of a contact; `None` where one of its bodies is not free in all directions.
    pub(crate) fn new(
        number: u32,
        contact: &ContactRecord,
        rows: [SolverRow; 2],
        bodies: &SolverBodies,
    ) -> Option<Self> {
        let are_free = rows.iter().all(|row| bodies.is_dynamic(*row) && !bodies.locked.has(*row));
        let moment = contact.meeting.time.into();
        are_free.then_some(Self { number, rows, moment, velocity: DVec3::ZERO, shift: DVec3::ZERO })
    }

    /// To be called after forces have acted in a substep.
    pub(crate) fn before_impulses(&mut self, bodies: &SolverBodies) {
        self.velocity = self.relative(bodies);
    }

    /// To be called after impulses at a time \[s\].
    pub(crate) fn after_impulses(&mut self, bodies: &SolverBodies, time: f64) {
        let after = self.relative(bodies);
        self.shift += (after - self.velocity) * (time - self.moment);
        self.velocity = after;
    }

    /// To be called after the last impulses, at the `end` of the step \[s\]: moves the bodies to
    /// where they would be.
    pub(crate) fn finish(&mut self, bodies: &mut SolverBodies, end: f64) {
        self.after_impulses(bodies, end);
        let [m, n] = self.rows.map(|row| f64::from(bodies.motion[row.index()].inverse_mass));
        let parts = [-m / (m + n), n / (m + n)];
        for (row, part) in self.rows.into_iter().zip(parts) {
            let delta = &mut bodies.delta_pose[row.index()].translation;
            *delta = vec3(double(*delta) + self.shift * part).into();
        }
    }

    /// Velocity of the second body relative to the first [m/s].
    fn relative(&self, bodies: &SolverBodies) -> DVec3 {
        let [first, second] = self.rows.map(|row| {
            let motion = &bodies.motion[row.index()];
            double(motion.momentum) * f64::from(motion.inverse_mass)
        });
        second - first
    }
}
