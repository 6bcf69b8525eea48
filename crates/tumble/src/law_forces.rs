//! The forces on one body where force laws act, and the account of their work.

use tumble_math::lane::Vec3 as LaneVec3;

use crate::components::{Work, Wrench};
use crate::force_law::BodyState;
use crate::force_laws::Laws;
use crate::integrators::{Account, Forces, Mean};
use crate::math::{Real, Vec3, double, dvec3};
use crate::state::{Constants, Force, State};

/// All that pushes one body during a substep.
pub(crate) struct LawForces<'a> {
    pub(crate) constants: &'a Constants<Real>,
    /// Gravity and what the caller applied, constant over the step.
    pub(crate) wrench: Wrench,
    pub(crate) laws: Laws<'a>,
    /// The body's row among the laws' rows.
    pub(crate) row: usize,
    /// Time at the start of the substep \[s\].
    pub(crate) time: f64,
}

impl LawForces<'_> {
    fn seen_by_laws(&self, offset: Real, state: &State<Real>) -> BodyState<'_> {
        BodyState::new(self.time + f64::from(offset), self.constants, state)
    }
}

impl Forces<Real> for LawForces<'_> {
    const VARY: bool = true;

    fn constant(&self) -> Force<Real> {
        self.wrench.into()
    }

    fn varying(&self, offset: Real, state: &State<Real>) -> Force<Real> {
        let mut sum = Wrench::default();
        if !self.laws.is_empty() {
            let seen = self.seen_by_laws(offset, state);
            for (_, law) in self.laws {
                let wrench = law.wrench(self.row, &seen);
                sum.force += wrench.force;
                sum.torque += wrench.torque;
            }
        }
        sum.into()
    }

    fn depends_on_velocity(&self) -> bool {
        self.laws.into_iter().any(|(_, law)| law.depends_on_velocity(self.row))
    }
}

/// Adds up the work done on one body.
pub(crate) struct WorkAccount<'a> {
    pub(crate) work: &'a mut Work,
    pub(crate) forces: &'a LawForces<'a>,
    /// The part of the constant force that is gravity \[N\].
    pub(crate) gravity: Vec3,
}

impl Account<Real> for WorkAccount<'_> {
    const KEPT: bool = true;

    fn constant_impulse(&mut self, weight: (Real, Real), mean: &Mean<Real>) {
        let linear = double(mean.linear) * f64::from(weight.0);
        let angular = double(mean.angular) * f64::from(weight.1);
        let gravity = dvec3(self.gravity);
        let wrench = self.forces.wrench;
        self.work.gravity += gravity.dot(linear);
        self.work.applied += (dvec3(wrench.force) - gravity).dot(linear) + dvec3(wrench.torque).dot(angular);
    }

    fn varying_impulse(&mut self, offset: Real, at: &State<Real>, weight: (Real, Real), mean: &Mean<Real>) {
        if self.forces.laws.is_empty() {
            return;
        }
        let linear = double(mean.linear) * f64::from(weight.0);
        let angular = double(mean.angular) * f64::from(weight.1);
        let seen = self.forces.seen_by_laws(offset, at);
        for (index, law) in self.forces.laws {
            let wrench = law.wrench(self.forces.row, &seen);
            let work = dvec3(wrench.force).dot(linear) + dvec3(wrench.torque).dot(angular);
            self.work.laws[index.min(Work::LAWS - 1)] += work;
        }
    }

    fn damping(&mut self, linear: LaneVec3<Real>, angular: LaneVec3<Real>, mean: &Mean<Real>) {
        self.work.damping += double(linear).dot(double(mean.linear)) + double(angular).dot(double(mean.angular));
    }
}
