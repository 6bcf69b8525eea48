//! The forces on bodies where force laws act: on a tile of them, and on one with an account of their work.

use tumble_math::lane::Vec3 as LaneVec3;

use crate::components::{Pose, Velocity, Work, Wrench};
use crate::force_law::BodyState;
use crate::force_laws::Laws;
use crate::integrators::{Account, Forces, Mean};
use crate::math::{Real, Vec3, double, dvec3};
use crate::simd::{MOST_BODIES, Tile};
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
                sum.add(law.wrench(self.row, &seen));
            }
        }
        sum.into()
    }

    fn depends_on_velocity(&self) -> Option<bool> {
        self.laws.into_iter().any(|(_, law)| law.depends_on_velocity(self.row)).then_some(true)
    }
}

/// All that pushes a tile of bodies during a substep.
pub(crate) struct TileLawForces<'a, T: Tile> {
    pub(crate) constants: &'a Constants<T>,
    /// The same of each body that is not only there to fill up the tile.
    pub(crate) of_bodies: &'a [Constants<Real>],
    /// Gravity and what the caller applied, constant over the step.
    pub(crate) constant: Force<T>,
    pub(crate) laws: Laws<'a>,
    /// The first body's row among the laws' rows.
    pub(crate) row: usize,
    /// Time at the start of the substep \[s\].
    pub(crate) time: f64,
    pub(crate) depends_on_velocity: Option<T::Mask>,
}

impl<T: Tile> Forces<T> for TileLawForces<'_, T> {
    const VARY: bool = true;

    #[inline(always)]
    fn constant(&self) -> Force<T> {
        self.constant
    }

    #[inline(always)]
    fn varying(&self, offset: T, state: &State<T>) -> Force<T> {
        let orientation = state.orientation.normalize();
        let v = self.constants.velocity(state.linear);
        let w = self.constants.angular_velocity(&State { orientation, ..*state });
        let (q, x) = (orientation, state.position);
        let mut seen = Seen::default();
        T::store([offset], &mut seen.offsets);
        T::store([q.x, q.y, q.z, q.w, x.x, x.y, x.z], &mut seen.poses);
        T::store([v.x, v.y, v.z, w.x, w.y, w.z], &mut seen.velocities);
        let [x, y, z, a, b, c] = T::load(&seen.wrenches(self.laws, self.row, self.time, self.of_bodies));
        Force { force: LaneVec3::new(x, y, z), torque: LaneVec3::new(a, b, c) }
    }

    #[inline(always)]
    fn depends_on_velocity(&self) -> Option<T::Mask> {
        self.depends_on_velocity
    }
}

/// For which bodies of a tile from a row on some law depends on velocity; `None` for none.
#[inline(always)]
pub(crate) fn depend_on_velocity<T: Tile>(laws: Laws<'_>, row: usize) -> Option<T::Mask> {
    let mut depend: [Real; MOST_BODIES] = [0.0; MOST_BODIES];
    for (i, depends) in depend[..T::WIDTH].iter_mut().enumerate() {
        if laws.into_iter().any(|(_, law)| law.depends_on_velocity(row + i)) {
            *depends = 1.0;
        }
    }
    let [depend] = T::load(&depend);
    let mask = T::splat(0.0).lt(depend);
    if T::any(mask) { Some(mask) } else { None }
}

/// What laws see of a tile of bodies.
#[derive(Default)]
struct Seen {
    offsets: [Real; MOST_BODIES],
    poses: [Pose; MOST_BODIES],
    velocities: [Velocity; MOST_BODIES],
}

impl Seen {
    /// The sum of the laws' wrenches on each body; none on those that only fill up a tile.
    fn wrenches(&self, laws: Laws<'_>, row: usize, time: f64, constants: &[Constants<Real>]) -> [Wrench; MOST_BODIES] {
        /// Bodies that a law is asked for at a time.
        const BLOCK: usize = 8;
        let mut wrenches = [Wrench::default(); MOST_BODIES];
        for (block, constants) in constants.chunks(BLOCK).enumerate() {
            let first = block * BLOCK;
            let states: [BodyState<'_>; BLOCK] = std::array::from_fn(|i| {
                let i = i.min(constants.len() - 1);
                let (pose, velocity) = (&self.poses[first + i], &self.velocities[first + i]);
                BodyState::seen(time + f64::from(self.offsets[first + i]), &constants[i], pose, velocity)
            });
            let wrenches = &mut wrenches[first..first + constants.len()];
            for (_, law) in laws {
                law.add_wrenches(row + first, &states, wrenches);
            }
        }
        wrenches
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
