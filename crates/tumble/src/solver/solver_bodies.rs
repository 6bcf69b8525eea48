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
use crate::simd::block_lanes::{put_two_vectors, two_vectors};
use crate::simd::{BLOCK, Eight, Kernel, Tile, dispatch_in_blocks};
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

/// The constrained bodies, as the solver sees them: momentum is what it changes, and the
/// rest says what that does.
///
/// First those that impulses move, in whole blocks of which the last is filled up with points
/// without mass that nothing acts on, and one more such point; then those that stay or move as they
/// are told.
#[derive(Clone, Default)]
pub(crate) struct SolverBodies {
    /// Linear and angular momentum, and one over the mass; of what impulses do not move the
    /// velocities.
    pub(crate) motion: Vec<Eight>,
    /// What contacts do when the next substep begins, by the impulses that the last ended with:
    /// where nothing changes they are what that needs. Impulse and angular impulse.
    pub(crate) warm_start: Vec<Eight>,
    /// Inverse inertia in the world: `xx yy zz`, `yz zx xy`; of what impulses do not move one.
    pub(crate) inv_inertia: Vec<Eight>,
    /// What forces do in a substep: impulse, angular impulse, and what is left of linear and
    /// angular momentum under damping.
    force_impulse: Vec<Eight>,
    /// Principal moments, their inverses, whether it turns, and the square of half the angle
    /// \[rad\] that it may turn in a step before contacts are turned with it.
    inertia: Vec<Eight>,
    /// Position when the step began, and orientation of the principal frame now.
    pose: Vec<Eight>,
    /// Since the start of the step: how far the centre went \[m\], the rotation as a unit
    /// quaternion, and whether that is or was more than is left out of account.
    pub(crate) delta_pose: Vec<Eight>,
    /// How many impulses move.
    free: usize,
}

/// Bodies that one thread advances at a time.
const PART: usize = 256;
/// Fewest parts that are shared: one takes some microseconds.
const MIN_PARTS: usize = 2;

/// Nowhere, and not turned.
const UNMOVED: Eight = Eight([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
/// Angle \[rad\] that a cube may turn in a step before its contacts turn with it: what that leaves
/// out is 1e-4 of an arm. What a body of another shape may turn is less as its radii of gyration
/// differ, since they say by how much its response to impulses changes.
const TURN: Real = 1e-4;

/// The unit matrix: the diagonal, and what is beside it.
const ONE: Eight = Eight([1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);

impl SolverBodies {
    /// Makes room for those that impulses move and those that they do not; all are nowhere at
    /// first.
    pub(crate) fn reset(&mut self, free: usize, non_dynamic: usize) {
        self.free = free;
        let (in_blocks, dynamic) = (free.next_multiple_of(BLOCK), self.first_non_dynamic());
        for (rows, empty) in [(&mut self.motion, Eight::ZERO), (&mut self.delta_pose, UNMOVED)] {
            rows.clear();
            rows.resize(dynamic + non_dynamic, empty);
        }
        self.warm_start.clear();
        self.warm_start.resize(dynamic, Eight::ZERO);
        self.inv_inertia.clear();
        self.inv_inertia.resize(dynamic, Eight::ZERO);
        self.inv_inertia.resize(dynamic + non_dynamic, ONE);
        self.force_impulse.clear();
        self.force_impulse.resize(in_blocks, Eight::ZERO);
        self.pose.clear();
        self.pose.resize(dynamic + non_dynamic, Eight([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0]));
        self.inertia.clear();
        self.inertia.resize(in_blocks, Eight([1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]));
    }

    /// How many rows.
    pub(crate) fn len(&self) -> usize {
        self.motion.len()
    }

    /// The row of the first that impulses do not move. The one before it is nobody's.
    pub(crate) fn first_non_dynamic(&self) -> usize {
        self.free.next_multiple_of(BLOCK) + 1
    }

    /// Rows of bodies that forces move, to be set.
    pub(crate) fn free_rows(&mut self, rows: Range<usize>) -> FreeRows<'_> {
        let Self { motion, inv_inertia, force_impulse, inertia, pose, .. } = self;
        FreeRows {
            motion: &mut motion[rows.clone()],
            inv_inertia: &mut inv_inertia[rows.clone()],
            force_impulse: &mut force_impulse[rows.clone()],
            inertia: &mut inertia[rows.clone()],
            pose: &mut pose[rows],
        }
    }

    /// Sets what moves with given velocities.
    pub(crate) fn set_non_dynamic(&mut self, row: usize, x: Vec3<Real>, linear: Vec3<Real>, angular: Vec3<Real>) {
        self.pose[row].0[..3].copy_from_slice(&[x.x, x.y, x.z]);
        self.motion[row] = Eight([linear.x, linear.y, linear.z, angular.x, angular.y, angular.z, 1.0, 0.0]);
    }

    /// Where the centre of mass of a body was when the step began \[m\].
    pub(crate) fn center(&self, row: SolverRow) -> Vec3<Real> {
        let Eight([x, y, z, ..]) = self.pose[row.index()];
        Vec3::new(x, y, z)
    }

    /// Whether impulses move a body.
    pub(crate) fn is_dynamic(&self, row: SolverRow) -> bool {
        row.index() < self.first_non_dynamic()
    }

    /// What a body that impulses move has become.
    pub(crate) fn state(&self, row: usize, axes: Option<Quat<Real>>) -> State<Real> {
        let Eight([px, py, pz, lx, ly, lz, ..]) = self.motion[row];
        let Eight([x, y, z, i, j, k, w, _]) = self.pose[row];
        let Eight([dx, dy, dz, ..]) = self.delta_pose[row];
        let orientation = Quat { x: i, y: j, z: k, w };
        State {
            // Rounded once a step: rounded in each of many short substeps, it would creep.
            position: Vec3::new(x, y, z) + Vec3::new(dx, dy, dz),
            orientation: axes.map_or(orientation, |axes| (orientation * axes.conjugate()).normalize()),
            linear: Vec3::new(px, py, pz),
            angular: Vec3::new(lx, ly, lz),
        }
    }

    /// The least inverse moment of inertia over the greatest; one of what impulses do not turn.
    pub(crate) fn inertia_ratio(&self, row: SolverRow) -> Real {
        self.inertia.get(row.index()).map_or(1.0, |Eight([_, _, _, x, y, z, ..])| {
            let (least, most) = (x.min(*y).min(*z), x.max(*y).max(*z));
            if most > 0.0 { least / most } else { 1.0 }
        })
    }

    /// Of what impulses move: one over the mass, the inverse inertia about two directions, and what
    /// is beside them.
    pub(crate) fn mobility(&self, row: SolverRow, [u, v]: [Vec3<Real>; 2]) -> [Real; 4] {
        let (Eight([.., mass, _]), Eight([xx, yy, zz, yz, zx, xy, ..])) =
            (self.motion[row.index()], self.inv_inertia[row.index()]);
        let times = |v| symmetric_product(Vec3::new(xx, yy, zz), Vec3::new(yz, zx, xy), v);
        [mass, u.dot(times(u)), v.dot(times(v)), u.dot(times(v))]
    }

    /// Whether what forces do to a body is in range, as to be gathered before.
    pub(crate) fn is_kicked_in_range(&self, row: usize) -> bool {
        let Eight([px, py, pz, lx, ly, lz, linear, angular]) = self.force_impulse[row];
        let impulses = within(Vec3::new(px, py, pz), MAX_IMPULSE) && within(Vec3::new(lx, ly, lz), MAX_IMPULSE);
        let kept = |part: Real| (0.0..=1.0).contains(&part);
        let Eight([.., inverse_mass, _]) = self.motion[row];
        let change = within(Vec3::new(px, py, pz) * inverse_mass, MAX_SPEED);
        let Eight([.., ix, iy, iz, _, _]) = self.inertia[row];
        let turn = within(Vec3::new(lx, ly, lz) * ix.max(iy).max(iz), MAX_SPEED);
        impulses && change && turn && kept(linear) && kept(angular)
    }

    /// Hands out the poses beside the rest.
    pub(crate) fn with_poses(&mut self, then: impl FnOnce(&mut Self, &[Eight])) {
        let poses = std::mem::take(&mut self.pose);
        then(self, &poses);
        self.pose = poses;
    }

    /// Takes over the bodies of these rows of others, those that impulses move first; forces act as
    /// in substeps halved so often.
    pub(crate) fn copy(&mut self, others: &Self, rows: &[SolverRow], halvings: u8) {
        let first_non_dynamic = others.first_non_dynamic();
        let free = rows.iter().take_while(|row| row.index() < first_non_dynamic).count();
        self.reset(free, rows.len() - free);
        for (place, row) in self.places(rows) {
            self.motion[place] = others.motion[row];
            self.inv_inertia[place] = others.inv_inertia[row];
            self.pose[place] = others.pose[row];
            if place < free {
                self.inertia[place] = others.inertia[row];
                self.force_impulse[place] = halved(others.force_impulse[row], halvings);
            }
        }
    }

    /// Copies the dynamic bodies back to the rows that they were taken from.
    pub(crate) fn copy_back(&self, others: &mut Self, rows: &[SolverRow]) {
        for (place, row) in self.places(rows).take(self.free) {
            others.motion[row] = self.motion[place];
            others.inv_inertia[row] = self.inv_inertia[place];
            others.pose[row] = self.pose[place];
            others.delta_pose[row] = self.delta_pose[place];
        }
    }

    /// The rows here of copies of these rows.
    pub(crate) fn places<'a>(&self, rows: &'a [SolverRow]) -> impl Iterator<Item = (usize, usize)> + use<'a> {
        let (free, first_non_dynamic) = (self.free, self.first_non_dynamic());
        let place = move |i: usize| if i < free { i } else { first_non_dynamic + i - free };
        rows.iter().enumerate().map(move |(i, row)| (place(i), row.index()))
    }

    /// Adds what forces do in a substep.
    pub(crate) fn integrate_velocities(&mut self) {
        let rows = self.force_impulse.len();
        let parts = self.motion[..rows].par_chunks_mut(PART).zip(self.force_impulse.par_chunks(PART));
        parts
            .by_at_least(MIN_PARTS)
            .for_each(|(motion, force_impulse)| dispatch_in_blocks(&mut IntegrateVelocities { motion, force_impulse }));
    }

    /// Adds the impulses of the warm start, and clears them.
    pub(crate) fn apply_warm_start(&mut self) {
        let rows = self.force_impulse.len();
        let parts = self.motion[..rows].par_chunks_mut(PART).zip(self.warm_start[..rows].par_chunks_mut(PART));
        parts
            .by_at_least(MIN_PARTS)
            .for_each(|(motion, warm_start)| dispatch_in_blocks(&mut ApplyWarmStart { motion, warm_start }));
    }

    /// Moves all by the velocities there are, which stay, for `h` \[s\]. Free rotation is exact, so
    /// a body spins on as it does without contacts.
    pub(crate) fn integrate_positions(&mut self, h: Real) {
        for row in self.first_non_dynamic()..self.motion.len() {
            let (Eight([x, y, z, u, v, w, ..]), Eight(delta_pose)) = (&self.motion[row], &mut self.delta_pose[row]);
            for (coordinate, velocity) in delta_pose.iter_mut().zip([x, y, z]) {
                *coordinate += velocity * h;
            }
            if [*u, *v, *w] != [0.0; 3] {
                let before = Quat { x: delta_pose[3], y: delta_pose[4], z: delta_pose[5], w: delta_pose[6] };
                let q = tumble_math::rotate_exactly(before, Vec3::new(*u, *v, *w), h);
                delta_pose[3..].copy_from_slice(&[q.x, q.y, q.z, q.w, 1.0]);
            }
        }
        let Self { motion, inv_inertia, pose, inertia, delta_pose, .. } = self;
        let rows = inertia.len();
        let (inv_inertia, pose, delta_pose) = (&mut inv_inertia[..rows], &mut pose[..rows], &mut delta_pose[..rows]);
        let changed =
            inv_inertia.par_chunks_mut(PART).zip(pose.par_chunks_mut(PART)).zip(delta_pose.par_chunks_mut(PART));
        let parts = changed.zip(motion[..rows].par_chunks(PART).zip(inertia.par_chunks(PART)));
        parts.by_at_least(MIN_PARTS).for_each(|(((inv_inertia, pose), delta_pose), (motion, inertia))| {
            dispatch_in_blocks(&mut IntegratePositions { motion, inv_inertia, pose, inertia, delta_pose, h });
        });
    }
}

/// Rows of bodies that forces move.
pub(crate) struct FreeRows<'a> {
    motion: &'a mut [Eight],
    inv_inertia: &'a mut [Eight],
    force_impulse: &'a mut [Eight],
    inertia: &'a mut [Eight],
    pose: &'a mut [Eight],
}

impl FreeRows<'_> {
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

    /// Sets what forces move, for substeps of `h` \[s\].
    pub(crate) fn set(
        &mut self,
        row: usize,
        constants: &Constants<Real>,
        state: &State<Real>,
        force: Force<Real>,
        h: Real,
    ) {
        let (p, l, x) = (state.linear, state.angular, state.position);
        let mut orientation = state.orientation.normalize();
        if let Some(inertia) = &constants.inertia {
            let (d, o) = inertia.inverse_in_world(orientation);
            self.inv_inertia[row] = Eight([d.x, d.y, d.z, o.x, o.y, o.z, 0.0, 0.0]);
            let (m, i) = (inertia.moments, inertia.inverse_moments);
            let tolerance = turn_tolerance(i);
            self.inertia[row] = Eight([m.x, m.y, m.z, i.x, i.y, i.z, 1.0, tolerance]);
            orientation = inertia.axes.map_or(orientation, |axes| orientation * axes);
        }
        let q = orientation;
        self.motion[row] = Eight([p.x, p.y, p.z, l.x, l.y, l.z, 1.0 / constants.mass, 0.0]);
        self.pose[row] = Eight([x.x, x.y, x.z, q.x, q.y, q.z, q.w, 0.0]);
        let kick = Kick::new(constants, h);
        let still = State { linear: Vec3::zero(), angular: Vec3::zero(), ..*state };
        let State { linear: p, angular: l, .. } = kick.kicked(still, force);
        let (linear, angular) = kick.kept();
        self.force_impulse[row] = Eight([p.x, p.y, p.z, l.x, l.y, l.z, linear, angular]);
    }
}

struct IntegrateVelocities<'a> {
    motion: &'a mut [Eight],
    force_impulse: &'a [Eight],
}

impl Kernel for IntegrateVelocities<'_> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.force_impulse.len()
    }

    #[inline(always)]
    fn tile<T: Tile>(&mut self, i: usize) {
        let (p, l) = two_vectors::<T>(&self.motion[i..]);
        let [px, py, pz, lx, ly, lz, linear, angular] = T::load(&self.force_impulse[i..]);
        let (p, l) = (p * linear + Vec3::new(px, py, pz), l * angular + Vec3::new(lx, ly, lz));
        put_two_vectors(p, l, &mut self.motion[i..]);
    }
}

struct ApplyWarmStart<'a> {
    motion: &'a mut [Eight],
    warm_start: &'a mut [Eight],
}

impl Kernel for ApplyWarmStart<'_> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.warm_start.len()
    }

    #[inline(always)]
    fn tile<T: Tile>(&mut self, i: usize) {
        let (p, l) = two_vectors::<T>(&self.motion[i..]);
        let (linear, angular) = two_vectors(&self.warm_start[i..]);
        put_two_vectors(p + linear, l + angular, &mut self.motion[i..]);
        put_two_vectors(Vec3::<T>::zero(), Vec3::zero(), &mut self.warm_start[i..]);
    }
}

struct IntegratePositions<'a> {
    motion: &'a [Eight],
    inv_inertia: &'a mut [Eight],
    pose: &'a mut [Eight],
    inertia: &'a [Eight],
    delta_pose: &'a mut [Eight],
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
        let [px, py, pz, lx, ly, lz, inverse_mass] = T::load(&self.motion[i..]);
        let [x, y, z, qx, qy, qz, qw] = T::load(&self.pose[i..]);
        let [a, b, c, inverse_a, inverse_b, inverse_c, turns, tolerance] = T::load(&self.inertia[i..]);
        let [dx, dy, dz, ti, tj, tk, tw, had_turned] = T::load(&self.delta_pose[i..]);

        let l = Vec3::new(lx, ly, lz);
        let way = Vec3::new(px, py, pz) * inverse_mass * h;
        let inverse_moments = Vec3::new(inverse_a, inverse_b, inverse_c);
        let moments = Moments { moments: Vec3::new(a, b, c), inverse_moments, axes: None };
        let rotation = FreeRotation::new(moments.moments, moments.inverse_moments, None, h);
        let before = Quat { x: qx, y: qy, z: qz, w: qw };
        let q = rotation.rotate(before, l * turns);
        T::store([x, y, z, q.x, q.y, q.z, q.w], &mut self.pose[i..]);
        let (zero, one) = (T::splat(0.0), T::splat(1.0));
        // The product of the two would be rounded to the grid of one in every substep, and what
        // lies would creep.
        let change = Quat { x: q.x - before.x, y: q.y - before.y, z: q.z - before.z, w: q.w - before.w };
        let turn = change * before.conjugate();
        let t = Quat { w: one + turn.w, ..turn } * Quat { x: ti, y: tj, z: tk, w: tw };
        let turned = T::select(tolerance.lt(t.vector().dot(t.vector())), one, had_turned);
        T::store([dx + way.x, dy + way.y, dz + way.z, t.x, t.y, t.z, t.w, turned], &mut self.delta_pose[i..]);
        // Otherwise contacts go on with the masses that they have, which belong to this response.
        if T::any(zero.lt(turned)) {
            let (diagonal, off_diagonal) = moments.inverse_in_world(q);
            let (d, o) = two_vectors::<T>(&self.inv_inertia[i..]);
            let turned = zero.lt(turned);
            let (d, o) = (Vec3::select(turned, diagonal, d), Vec3::select(turned, off_diagonal, o));
            put_two_vectors(d, o, &mut self.inv_inertia[i..]);
        }
    }
}

/// What forces do in substeps that are halved so often: twice it does what the kick of the substep
/// before does.
fn halved(force_impulse: Eight, halvings: u8) -> Eight {
    (0..halvings).fold(force_impulse, |Eight([px, py, pz, lx, ly, lz, linear, angular]), _| {
        let (linear, angular) = (linear.sqrt(), angular.sqrt());
        let (p, l) = (1.0 / (1.0 + linear), 1.0 / (1.0 + angular));
        Eight([px * p, py * p, pz * p, lx * l, ly * l, lz * l, linear, angular])
    })
}

/// Square of half the angle that a body with these inverse moments may turn before contacts turn
/// with it.
fn turn_tolerance(inverse: Vec3<Real>) -> Real {
    let most = inverse.x.max(inverse.y).max(inverse.z);
    let least = inverse.x.min(inverse.y).min(inverse.z);
    0.25 * TURN * TURN * (least / most)
}
