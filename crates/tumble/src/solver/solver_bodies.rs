//! Solver bodies: momenta, inverse masses and pose changes, with their integration per substep.

use std::ops::Range;

use rayon::prelude::*;
use tumble_math::FreeRotation;
use tumble_math::lane::{Quat, Vec3};

use crate::integrators::Kick;
use crate::integrators::derived::symmetric_product;
use crate::integrators::state::{Constants, Force, Moments, State};
use crate::math::Real;
use crate::range::{MAX_IMPULSE, MAX_SPEED, within};
use crate::simd::{HALF_BLOCK, Kernel, Octet, Tile, dispatch, dispatch_in_blocks, load_rows, store_rows};
use crate::solver::body_rows::{
    BodyMotion, BodyPose, DeltaPose, ForceImpulse, PrincipalMoments, WarmStartImpulse, WorldInverseInertia,
};
use crate::solver::locked_bodies::LockedBodies;
use crate::threads::InParts;

/// The number of a body among those of the solver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub(crate) struct SolverRow(pub(crate) u32);

impl SolverRow {
    pub(crate) fn index(self) -> usize {
        self.0 as usize
    }
}

/// The constrained bodies in the layout of the solver: the momenta that it changes, and masses,
/// inertias and poses.
///
/// First the dynamic bodies, in whole blocks of which the last is filled up with points without
/// mass that nothing acts on, and one more such point; then the fixed and kinematic ones.
#[derive(Clone, Default)]
pub(crate) struct SolverBodies {
    pub(crate) motion: Vec<BodyMotion>,
    pub(crate) warm_start: Vec<WarmStartImpulse>,
    pub(crate) inv_inertia: Vec<WorldInverseInertia>,
    pub(crate) force_impulse: Vec<ForceImpulse>,
    pub(crate) inertia: Vec<PrincipalMoments>,
    pub(crate) pose: Vec<BodyPose>,
    pub(crate) delta_pose: Vec<DeltaPose>,
    pub(crate) locked: LockedBodies,
    /// How many are dynamic.
    dynamic: usize,
}

/// Bodies that one thread advances at a time.
const PART: usize = 256;
/// Fewest parts that are shared: one takes some microseconds.
const MIN_PARTS: usize = 2;

/// Not moved, and not turned.
const UNMOVED: DeltaPose = DeltaPose { rotation: NO_ROTATION, ..DeltaPose::ZERO };
/// At the origin, and not turned.
const ORIGIN: BodyPose = BodyPose { orientation: NO_ROTATION, ..BodyPose::ZERO };
const NO_ROTATION: Quat<Real> = Quat { x: 0.0, y: 0.0, z: 0.0, w: 1.0 };
/// Of a body that impulses do not turn.
const NOT_TURNING: PrincipalMoments = PrincipalMoments { moments: ONES, ..PrincipalMoments::ZERO };
/// The unit matrix.
const UNIT: WorldInverseInertia = WorldInverseInertia { diagonal: ONES, ..WorldInverseInertia::ZERO };
const ONES: Vec3<Real> = Vec3 { x: 1.0, y: 1.0, z: 1.0 };
/// Angle \[rad\] that a cube may turn in a step before its contacts turn with it: what that leaves
/// out is 1e-4 of an arm. What a body of another shape may turn is less as its radii of gyration
/// differ, since they say by how much its response to impulses changes.
const TURN: Real = 1e-4;

impl SolverBodies {
    /// Makes room for dynamic bodies and others; all are nowhere at first.
    pub(crate) fn reset(&mut self, dynamic: usize, non_dynamic: usize) {
        self.dynamic = dynamic;
        let (in_blocks, first_non_dynamic) = (dynamic.next_multiple_of(HALF_BLOCK), self.first_non_dynamic());
        self.motion.clear();
        self.motion.resize(first_non_dynamic + non_dynamic, BodyMotion::ZERO);
        self.delta_pose.clear();
        self.delta_pose.resize(first_non_dynamic + non_dynamic, UNMOVED);
        self.warm_start.clear();
        self.warm_start.resize(first_non_dynamic, WarmStartImpulse::ZERO);
        self.inv_inertia.clear();
        self.inv_inertia.resize(first_non_dynamic, WorldInverseInertia::ZERO);
        self.inv_inertia.resize(first_non_dynamic + non_dynamic, UNIT);
        self.force_impulse.clear();
        self.force_impulse.resize(in_blocks, ForceImpulse::ZERO);
        self.pose.clear();
        self.pose.resize(first_non_dynamic + non_dynamic, ORIGIN);
        self.inertia.clear();
        self.inertia.resize(in_blocks, NOT_TURNING);
        self.locked.clear();
    }

    /// How many rows.
    pub(crate) fn len(&self) -> usize {
        self.motion.len()
    }

    /// The row of the first non-dynamic body. The row before it belongs to no body.
    pub(crate) fn first_non_dynamic(&self) -> usize {
        self.dynamic.next_multiple_of(HALF_BLOCK) + 1
    }

    /// Rows of dynamic bodies, to be set.
    pub(crate) fn dynamic_rows(&mut self, rows: Range<usize>) -> DynamicRows<'_> {
        let Self { motion, inv_inertia, force_impulse, inertia, pose, .. } = self;
        DynamicRows {
            motion: &mut motion[rows.clone()],
            inv_inertia: &mut inv_inertia[rows.clone()],
            force_impulse: &mut force_impulse[rows.clone()],
            inertia: &mut inertia[rows.clone()],
            pose: &mut pose[rows],
        }
    }

    /// Sets a fixed or kinematic body.
    pub(crate) fn set_non_dynamic(
        &mut self,
        row: usize,
        (center, orientation): (Vec3<Real>, Quat<Real>),
        [linear, angular]: [Vec3<Real>; 2],
    ) {
        self.pose[row] = BodyPose { center, orientation: orientation.normalize(), _unused: 0.0 };
        self.motion[row] = BodyMotion { momentum: linear, angular_momentum: angular, inverse_mass: 1.0, _unused: 0.0 };
    }

    /// Where the centre of mass of a body was when the step began \[m\].
    pub(crate) fn center(&self, row: SolverRow) -> Vec3<Real> {
        self.pose[row.index()].center
    }

    /// The mass of a dynamic body \[kg\].
    pub(crate) fn mass(&self, row: SolverRow) -> f64 {
        1.0 / f64::from(self.motion[row.index()].inverse_mass)
    }

    /// The radius of gyration of a dynamic body about the axis where it is least \[m\].
    pub(crate) fn least_radius(&self, row: SolverRow) -> f64 {
        let Vec3 { x, y, z } = self.inertia[row.index()].moments;
        (f64::from(x.min(y).min(z)) / self.mass(row)).sqrt()
    }

    /// Whether a body is dynamic.
    pub(crate) fn is_dynamic(&self, row: SolverRow) -> bool {
        row.index() < self.first_non_dynamic()
    }

    /// The state of a dynamic body.
    #[inline]
    pub(crate) fn state(&self, row: usize, axes: Option<Quat<Real>>) -> State<Real> {
        let BodyMotion { momentum, angular_momentum, .. } = self.motion[row];
        let BodyPose { center, orientation, .. } = self.pose[row];
        State {
            // Rounded once a step: rounded in each of many short substeps, it would creep.
            position: center + self.delta_pose[row].translation,
            orientation: axes.map_or(orientation, |axes| (orientation * axes.conjugate()).normalize()),
            linear: momentum,
            angular: angular_momentum,
        }
    }

    /// Of a dynamic body: one over the mass, and the inverse inertia in two directions: `uu vv
    /// uv`.
    pub(crate) fn mobility(&self, row: SolverRow, [u, v]: [Vec3<Real>; 2]) -> (Real, [Real; 3]) {
        let WorldInverseInertia { diagonal, off_diagonal, .. } = self.inv_inertia[row.index()];
        let times = |v| symmetric_product(diagonal, off_diagonal, v);
        (self.motion[row.index()].inverse_mass, [u.dot(times(u)), v.dot(times(v)), u.dot(times(v))])
    }

    /// Whether what forces do to a body is in range, as to be gathered before.
    pub(crate) fn is_kicked_in_range(&self, row: usize) -> bool {
        let ForceImpulse { linear, angular, kept_linear, kept_angular } = self.force_impulse[row];
        let impulses = within(linear, MAX_IMPULSE) && within(angular, MAX_IMPULSE);
        let is_part = |kept: Real| (0.0..=1.0).contains(&kept);
        let change = within(linear * self.motion[row].inverse_mass, MAX_SPEED);
        let Vec3 { x, y, z } = self.inertia[row].inverse_moments;
        let turn = within(angular * x.max(y).max(z), MAX_SPEED);
        impulses && change && turn && is_part(kept_linear) && is_part(kept_angular)
    }

    /// Calls with the poses beside the rest.
    pub(crate) fn with_poses(&mut self, then: impl FnOnce(&mut Self, &[BodyPose])) {
        let poses = std::mem::take(&mut self.pose);
        then(self, &poses);
        self.pose = poses;
    }

    /// Copies the bodies of these rows of others, dynamic ones first; forces act as in substeps
    /// halved this many times.
    pub(crate) fn copy(&mut self, others: &Self, rows: &[SolverRow], halvings: u8) {
        let first_non_dynamic = others.first_non_dynamic();
        let dynamic = rows.iter().take_while(|row| row.index() < first_non_dynamic).count();
        self.reset(dynamic, rows.len() - dynamic);
        for (place, row) in self.places(rows) {
            self.motion[place] = others.motion[row];
            self.inv_inertia[place] = others.inv_inertia[row];
            self.pose[place] = others.pose[row];
            if place < dynamic {
                self.inertia[place] = others.inertia[row];
                self.force_impulse[place] = halved(others.force_impulse[row], halvings);
            }
        }
        let places = self.places(rows);
        self.locked.copy(&others.locked, places);
    }

    /// Copies the dynamic bodies back to the rows that they were taken from.
    pub(crate) fn copy_back(&self, others: &mut Self, rows: &[SolverRow]) {
        for (place, row) in self.places(rows).take(self.dynamic) {
            others.motion[row] = self.motion[place];
            others.inv_inertia[row] = self.inv_inertia[place];
            others.pose[row] = self.pose[place];
            others.delta_pose[row] = self.delta_pose[place];
        }
    }

    /// The rows here of copies of these rows.
    pub(crate) fn places<'a>(&self, rows: &'a [SolverRow]) -> impl Iterator<Item = (usize, usize)> + use<'a> {
        let (dynamic, first_non_dynamic) = (self.dynamic, self.first_non_dynamic());
        let place = move |i: usize| if i < dynamic { i } else { first_non_dynamic + i - dynamic };
        rows.iter().enumerate().map(move |(i, row)| (place(i), row.index()))
    }

    /// Adds the force impulses of a substep.
    pub(crate) fn integrate_velocities(&mut self) {
        let rows = self.force_impulse.len();
        let parts = self.motion[..rows].par_chunks_mut(PART).zip(self.force_impulse.par_chunks(PART));
        parts
            .by_at_least(MIN_PARTS)
            .for_each(|(motion, force_impulse)| dispatch_in_blocks(&mut IntegrateVelocities { motion, force_impulse }));
    }

    /// Adds the impulses of the warm start, and clears them.
    pub(crate) fn apply_warm_start(&mut self) {
        let mut warm_start = std::mem::take(&mut self.warm_start);
        self.apply(&mut warm_start);
        self.warm_start = warm_start;
    }

    /// Adds impulses by row, and clears them.
    pub(crate) fn apply(&mut self, warm_start: &mut [WarmStartImpulse]) {
        let rows = self.force_impulse.len();
        let parts = self.motion[..rows].par_chunks_mut(PART).zip(warm_start[..rows].par_chunks_mut(PART));
        parts
            .by_at_least(MIN_PARTS)
            .for_each(|(motion, warm_start)| dispatch_in_blocks(&mut ApplyWarmStart { motion, warm_start }));
    }

    /// Forgets the impulses of the warm start.
    pub(crate) fn clear_warm_start(&mut self) {
        self.warm_start.fill(WarmStartImpulse::ZERO);
    }

    /// Moves all by the velocities there are, which stay, for `h` \[s\]. Free rotation is exact, so
    /// a body spins on as it does without contacts.
    pub(crate) fn integrate_positions(&mut self, h: Real) {
        for row in self.first_non_dynamic()..self.motion.len() {
            let BodyMotion { momentum: velocity, angular_momentum: angular_velocity, .. } = self.motion[row];
            let delta = &mut self.delta_pose[row];
            delta.translation = delta.translation + velocity * h;
            if angular_velocity != Vec3::zero() {
                delta.rotation = tumble_math::rotate_exactly(delta.rotation, angular_velocity, h);
                delta.has_turned = 1.0;
            }
        }
        let Self { motion, inv_inertia, pose, inertia, delta_pose, .. } = self;
        let rows = inertia.len();
        let (inv_inertia, pose, delta_pose) = (&mut inv_inertia[..rows], &mut pose[..rows], &mut delta_pose[..rows]);
        let changed =
            inv_inertia.par_chunks_mut(PART).zip(pose.par_chunks_mut(PART)).zip(delta_pose.par_chunks_mut(PART));
        let parts = changed.zip(motion[..rows].par_chunks(PART).zip(inertia.par_chunks(PART)));
        parts.by_at_least(MIN_PARTS).for_each(|(((inv_inertia, pose), delta_pose), (motion, inertia))| {
            // The map that turns a body is a long chain of operations: in pairs tiles wait less.
            dispatch(&mut IntegratePositions { motion, inv_inertia, pose, inertia, delta_pose, h });
        });
        self.turn_locked(h);
    }
}

/// Rows of dynamic bodies.
pub(crate) struct DynamicRows<'a> {
    motion: &'a mut [BodyMotion],
    inv_inertia: &'a mut [WorldInverseInertia],
    force_impulse: &'a mut [ForceImpulse],
    inertia: &'a mut [PrincipalMoments],
    pose: &'a mut [BodyPose],
}

impl DynamicRows<'_> {
    /// The first `middle`, and the others.
    pub(crate) fn split_at(self, middle: usize) -> (Self, Self) {
        let (motion, other_motion) = self.motion.split_at_mut(middle);
        let (inv_inertia, other_inv_inertia) = self.inv_inertia.split_at_mut(middle);
        let (force_impulse, other_force_impulse) = self.force_impulse.split_at_mut(middle);
        let (inertia, other_inertia) = self.inertia.split_at_mut(middle);
        let (pose, other_pose) = self.pose.split_at_mut(middle);
        let others = Self {
            motion: other_motion,
            inv_inertia: other_inv_inertia,
            force_impulse: other_force_impulse,
            inertia: other_inertia,
            pose: other_pose,
        };
        (Self { motion, inv_inertia, force_impulse, inertia, pose }, others)
    }

    /// Sets a dynamic body, for substeps of `h` \[s\].
    #[inline(always)]
    pub(crate) fn set<T: Tile>(
        &mut self,
        row: usize,
        constants: &Constants<T>,
        state: &State<T>,
        force: Force<T>,
        h: Real,
    ) {
        let zero = T::splat(0.0);
        let mut orientation = state.orientation.normalize();
        if let Some(inertia) = &constants.inertia {
            let (diagonal, off_diagonal) = inertia.inverse_in_world(orientation);
            store_rows(
                WorldInverseInertia { diagonal, off_diagonal, _unused: [zero; 2] },
                &mut self.inv_inertia[row..],
            );
            let Moments { moments, inverse_moments, .. } = *inertia;
            let turn_tolerance = turn_tolerance(inverse_moments);
            store_rows(
                PrincipalMoments { moments, inverse_moments, turns: T::splat(1.0), turn_tolerance },
                &mut self.inertia[row..],
            );
            if let Some(axes) = inertia.axes {
                orientation = orientation * axes;
            }
        }
        let (momentum, angular_momentum, inverse_mass) = (state.linear, state.angular, T::splat(1.0) / constants.mass);
        store_rows(BodyMotion { momentum, angular_momentum, inverse_mass, _unused: zero }, &mut self.motion[row..]);
        store_rows(BodyPose { center: state.position, orientation, _unused: zero }, &mut self.pose[row..]);
        let kick = Kick::new(constants, T::splat(h.into()));
        let still = State { linear: Vec3::zero(), angular: Vec3::zero(), ..*state };
        let State { linear, angular, .. } = kick.kicked(still, force);
        let (kept_linear, kept_angular) = kick.kept();
        store_rows(ForceImpulse { linear, angular, kept_linear, kept_angular }, &mut self.force_impulse[row..]);
    }

    /// Marks a body as one that is not [kicked in range](SolverBodies::is_kicked_in_range).
    pub(crate) fn set_out_of_range(&mut self, row: usize) {
        self.force_impulse[row].kept_linear = Real::NAN;
    }
}

struct IntegrateVelocities<'a> {
    motion: &'a mut [BodyMotion],
    force_impulse: &'a [ForceImpulse],
}

impl Kernel for IntegrateVelocities<'_> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.force_impulse.len()
    }

    #[inline(always)]
    fn tile<T: Tile>(&mut self, i: usize) {
        let before = load_rows::<T, _>(&self.motion[i..]);
        let kick = load_rows::<T, _>(&self.force_impulse[i..]);
        let momentum = before.momentum * kick.kept_linear + kick.linear;
        let angular_momentum = before.angular_momentum * kick.kept_angular + kick.angular;
        store_rows(BodyMotion { momentum, angular_momentum, ..before }, &mut self.motion[i..]);
    }
}

struct ApplyWarmStart<'a> {
    motion: &'a mut [BodyMotion],
    warm_start: &'a mut [WarmStartImpulse],
}

impl Kernel for ApplyWarmStart<'_> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.warm_start.len()
    }

    #[inline(always)]
    fn tile<T: Tile>(&mut self, i: usize) {
        let before = load_rows::<T, _>(&self.motion[i..]);
        let impulse = load_rows::<T, _>(&self.warm_start[i..]);
        let momentum = before.momentum + impulse.linear;
        let angular_momentum = before.angular_momentum + impulse.angular;
        store_rows(BodyMotion { momentum, angular_momentum, ..before }, &mut self.motion[i..]);
        let mut k = 0;
        while k < T::WIDTH {
            self.warm_start[i + k] = WarmStartImpulse::ZERO;
            k += 1;
        }
    }
}

struct IntegratePositions<'a> {
    motion: &'a [BodyMotion],
    inv_inertia: &'a mut [WorldInverseInertia],
    pose: &'a mut [BodyPose],
    inertia: &'a [PrincipalMoments],
    delta_pose: &'a mut [DeltaPose],
    h: Real,
}

impl Kernel for IntegratePositions<'_> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.inv_inertia.len()
    }

    #[inline(always)]
    fn tile<T: Tile>(&mut self, i: usize) {
        let h = T::splat(self.h.into());
        let motion = load_rows::<T, _>(&self.motion[i..]);
        let pose = load_rows::<T, _>(&self.pose[i..]);
        let PrincipalMoments { moments, inverse_moments, turns, turn_tolerance } =
            load_rows::<T, _>(&self.inertia[i..]);
        let delta = load_rows::<T, _>(&self.delta_pose[i..]);

        let way = motion.momentum * motion.inverse_mass * h;
        let rotation = FreeRotation::new(moments, inverse_moments, None, h).for_resting();
        let before = pose.orientation;
        let q = rotation.rotate(before, motion.angular_momentum * turns);
        store_rows(BodyPose { orientation: q, ..pose }, &mut self.pose[i..]);
        let (zero, one) = (T::splat(0.0), T::splat(1.0));
        // The product of the two would be rounded to the grid of one in every substep, and what
        // lies would creep.
        let change = Quat { x: q.x - before.x, y: q.y - before.y, z: q.z - before.z, w: q.w - before.w };
        let turn = change * before.conjugate();
        let t = Quat { w: one + turn.w, ..turn } * delta.rotation;
        let turned = T::select(turn_tolerance.lt(t.vector().dot(t.vector())), one, delta.has_turned);
        let after = DeltaPose { translation: delta.translation + way, rotation: t, has_turned: turned };
        store_rows(after, &mut self.delta_pose[i..]);
        // Otherwise contacts go on with the masses that they have, which belong to this response.
        if T::any(zero.lt(turned)) {
            let (diagonal, off_diagonal) = Moments { moments, inverse_moments, axes: None }.inverse_in_world(q);
            let before = load_rows::<T, _>(&self.inv_inertia[i..]);
            let turned = zero.lt(turned);
            let diagonal = Vec3::select(turned, diagonal, before.diagonal);
            let off_diagonal = Vec3::select(turned, off_diagonal, before.off_diagonal);
            store_rows(WorldInverseInertia { diagonal, off_diagonal, ..before }, &mut self.inv_inertia[i..]);
        }
    }
}

/// The force impulse of a substep halved this many times: applied twice it is that of the longer
/// substep.
pub(crate) fn halved(force_impulse: ForceImpulse, halvings: u8) -> ForceImpulse {
    (0..halvings).fold(force_impulse, |ForceImpulse { linear, angular, kept_linear, kept_angular }, _| {
        let (kept_linear, kept_angular) = (kept_linear.sqrt(), kept_angular.sqrt());
        let linear = linear * (1.0 / (1.0 + kept_linear));
        let angular = angular * (1.0 / (1.0 + kept_angular));
        ForceImpulse { linear, angular, kept_linear, kept_angular }
    })
}

/// Square of half the angle that a body with these inverse moments may turn before contacts turn
/// with it.
#[inline(always)]
fn turn_tolerance<T: Tile>(inverse: Vec3<T>) -> T {
    let most = inverse.x.max(inverse.y).max(inverse.z);
    let least = inverse.x.min(inverse.y).min(inverse.z);
    T::splat((0.25 * TURN * TURN).into()) * (least / most)
}
