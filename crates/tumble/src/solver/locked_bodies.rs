//! The bodies of the solver that have locked axes.

use glam::{DMat3, DVec3};
use tumble_math::lane::Vec3;

use crate::joints::axis_lock::{AxisLock, symmetric, world_inertia};
use crate::math::{Real, double, double_quat, quat, vec3};
use crate::simd::BLOCK;
use crate::simd::block_lanes::Lanes;
use crate::solver::body_rows::{DeltaPose, WorldInverseInertia};
use crate::solver::solver_bodies::{SolverBodies, SolverRow};

/// Rows of dynamic bodies with locked axes, in order.
#[derive(Clone, Debug, Default)]
pub(crate) struct LockedBodies {
    bodies: Vec<LockedBody>,
}

#[derive(Clone, Copy, Debug)]
struct LockedBody {
    row: usize,
    lock: AxisLock,
    rotation: LockedRotation,
}

/// How the locked rotations of a body are held.
#[derive(Clone, Copy, Debug, PartialEq)]
enum LockedRotation {
    /// There are none, or it does not turn.
    None,
    /// It is turned here.
    Here,
    /// By rows of its mechanism: here only its response to contacts is that of a locked body.
    InMechanism,
}

/// The locked translations of the bodies of a block's contacts.
#[derive(Clone, Copy)]
#[repr(C)]
pub(crate) struct BlockLocks {
    /// Of the first and of the second bodies: one where it is locked, else zero.
    pub(crate) translations: [[Lanes; 3]; 2],
}

impl BlockLocks {
    pub(crate) const NONE: Self = Self { translations: [[[0.0; BLOCK]; 3]; 2] };

    /// Of contacts between bodies of these rows.
    pub(crate) fn of(rows: impl Iterator<Item = [SolverRow; 2]>, locked: &LockedBodies) -> Self {
        let mut locks = Self::NONE;
        for (lane, rows) in rows.enumerate() {
            for (lanes, row) in locks.translations.iter_mut().zip(rows) {
                let Some(body) = locked.of(row.index()) else { continue };
                let translations = body.lock.translations().to_array();
                lanes.iter_mut().zip(translations).for_each(|(lanes, it)| lanes[lane] = it as Real);
            }
        }
        locks
    }
}

impl LockedBodies {
    pub(crate) fn clear(&mut self) {
        self.bodies.clear();
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.bodies.is_empty()
    }

    /// Whether a body has locked axes.
    pub(crate) fn has(&self, row: SolverRow) -> bool {
        self.of(row.index()).is_some()
    }

    fn of(&self, row: usize) -> Option<&LockedBody> {
        let place = self.bodies.binary_search_by_key(&row, |body| body.row).ok()?;
        Some(&self.bodies[place])
    }

    /// Copies those of others that have a place here.
    pub(crate) fn copy(&mut self, others: &Self, places: impl Iterator<Item = (usize, usize)>) {
        self.clear();
        if !others.is_empty() {
            self.bodies.extend(places.filter_map(|(row, other)| Some(LockedBody { row, ..*others.of(other)? })));
        }
    }
}

impl SolverBodies {
    /// Locks axes of dynamic bodies that have been set.
    pub(crate) fn lock(&mut self, locks: impl Iterator<Item = (SolverRow, AxisLock)>) {
        locks.for_each(|(row, lock)| self.lock_one(row, lock));
        self.locked.bodies.sort_unstable_by_key(|body| body.row);
    }

    /// The same of bodies whose mechanisms have rows for it.
    pub(crate) fn lock_in_mechanisms(&mut self, locks: impl Iterator<Item = (SolverRow, AxisLock)>) {
        let Self { locked: LockedBodies { bodies }, inertia, .. } = self;
        bodies.extend(locks.map(|(row, lock)| {
            let turns = lock.locks_rotation() && inertia[row.index()].turns != 0.0;
            let rotation = if turns { LockedRotation::InMechanism } else { LockedRotation::None };
            LockedBody { row: row.index(), lock, rotation }
        }));
        bodies.sort_unstable_by_key(|body| body.row);
        self.lock_responses();
    }

    fn lock_one(&mut self, row: SolverRow, lock: AxisLock) {
        let i = row.index();
        let is_turned = lock.locks_rotation() && self.inertia[i].turns != 0.0;
        let rotation = if is_turned { LockedRotation::Here } else { LockedRotation::None };
        self.locked.bodies.push(LockedBody { row: i, lock, rotation });
        let free = |vector: Vec3<Real>| vec3(lock.along_free(double(vector))).into();
        self.motion[i].momentum = free(self.motion[i].momentum);
        self.force_impulse[i].linear = free(self.force_impulse[i].linear);
        if is_turned {
            self.inertia[i].turns = 0.0;
            let inverse = lock.inverse_inertia(self.world_inertia(i));
            self.set_inverse_inertia(i, inverse);
        }
    }

    /// Gives locked bodies the angular momentum of their angular velocity.
    pub(crate) fn settle_locked(&mut self) {
        for place in 0..self.locked.bodies.len() {
            let LockedBody { row, lock, rotation } = self.locked.bodies[place];
            if rotation != LockedRotation::None {
                let inertia = self.world_inertia(row);
                let momentum = &mut self.motion[row].angular_momentum;
                *momentum = vec3(lock.settled(inertia, double(*momentum))).into();
            }
        }
    }

    /// Turns what rotates about some axes only, for `h` \[s\].
    pub(super) fn turn_locked(&mut self, h: Real) {
        for place in 0..self.locked.bodies.len() {
            let LockedBody { row, lock, rotation } = self.locked.bodies[place];
            if rotation != LockedRotation::Here {
                continue;
            }
            let (before, momentum) = (double_quat(self.pose[row].orientation), self.motion[row].angular_momentum);
            let moments = double(self.inertia[row].moments);
            let turned = lock.turn(moments, before, double(momentum), h.into());
            self.pose[row].orientation = quat(turned.orientation).into();
            self.motion[row].angular_momentum = vec3(turned.angular_momentum).into();
            let delta = &mut self.delta_pose[row];
            let turn = turned.orientation * before.conjugate();
            let rotation = turn * double_quat(delta.rotation);
            let has_turned = delta.has_turned > 0.0 || turn.xyz() != DVec3::ZERO;
            let has_turned = if has_turned { 1.0 } else { 0.0 };
            *delta = DeltaPose { rotation: quat(rotation).into(), has_turned, ..*delta };
            if has_turned > 0.0 {
                self.set_inverse_inertia(row, turned.inverse_inertia);
            }
        }
        self.lock_responses();
    }

    /// Has the bodies that mechanisms hold answer to contacts about their free axes only.
    pub(crate) fn lock_responses(&mut self) {
        for place in 0..self.locked.bodies.len() {
            let LockedBody { row, lock, rotation } = self.locked.bodies[place];
            if rotation == LockedRotation::InMechanism {
                self.set_inverse_inertia(row, lock.inverse_inertia(self.world_inertia(row)));
            }
        }
    }

    fn world_inertia(&self, row: usize) -> DMat3 {
        world_inertia(double(self.inertia[row].moments), double_quat(self.pose[row].orientation))
    }

    fn set_inverse_inertia(&mut self, row: usize, inverse: DMat3) {
        let [diagonal, off_diagonal] = symmetric(inverse).map(Vec3::from);
        self.inv_inertia[row] = WorldInverseInertia { diagonal, off_diagonal, ..self.inv_inertia[row] };
    }
}
