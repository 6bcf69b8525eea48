//! The stages of joints in passes: the joints of a color, a tile at a time.

use tumble_math::lane::{Quat, Vec3};

use crate::simd::block_lanes::{Lanes, at, put, put_vector, vector_at};
use crate::simd::{BLOCK, Kernel, Tile};
use crate::solver::block_parts::ColorBlocks;
use crate::solver::body_rows::{BodyPose, WarmStartImpulse};
use crate::solver::contact::contact_frame::{BodyLanes, DeltaPoses, InverseInertias};
use crate::solver::contact::softness::Softness;
use crate::solver::contact::solve::StageBodies;
use crate::solver::joint_passes::joint_block::{BlockRotations, JointBlock};
use crate::solver::joint_passes::small_ldl::{factor, place, solve};
use crate::solver::mechanism::joint_rows::{arms_and_gap, pushed_at};
use crate::solver::mechanism::rotations::Rotations;

/// Blocks of one color, and the rotations that they lock: as many, or none.
pub(super) struct JointBlocks<'a, const R: usize, const M: usize> {
    pub(super) blocks: &'a mut [JointBlock<R, M>],
    pub(super) rotations: &'a mut [BlockRotations],
}

impl<const R: usize, const M: usize> ColorBlocks for JointBlocks<'_, R, M> {
    fn count(&self) -> usize {
        self.blocks.len()
    }

    fn parted(self, middle: usize) -> (Self, Self) {
        let (blocks, other_blocks) = self.blocks.split_at_mut(middle);
        let (rotations, other_rotations) =
            self.rotations.split_at_mut(if self.rotations.is_empty() { 0 } else { middle });
        (Self { blocks, rotations }, Self { blocks: other_blocks, rotations: other_rotations })
    }
}

/// Turns what blocks have along the axes of bodies into the world, where these have such poses.
pub(super) struct PrepareJoints<'a, const R: usize, const M: usize> {
    pub(super) blocks: JointBlocks<'a, R, M>,
    pub(super) bodies: StageBodies<'a>,
    pub(super) poses: &'a [BodyPose],
}

/// One pass over the joints of a color.
pub(super) struct PassJoints<'a, const R: usize, const M: usize> {
    pub(super) blocks: JointBlocks<'a, R, M>,
    pub(super) bodies: StageBodies<'a>,
    /// How errors are taken out; none where the velocity that this gave is to be taken out again,
    /// once bodies have moved.
    pub(super) softness: Option<Softness>,
}

impl<const R: usize, const M: usize> Kernel for PrepareJoints<'_, R, M> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.blocks.blocks.len() * BLOCK
    }

    #[inline(always)]
    fn is_empty(&self, i: usize) -> bool {
        self.bodies.motion.is_empty(i / BLOCK, i % BLOCK)
    }

    #[inline(always)]
    fn tile<T: Tile>(&mut self, i: usize) {
        let (index, lane) = (i / BLOCK, i % BLOCK);
        let block = &mut self.blocks.blocks[index];
        let [first, second] = self.bodies.motion.gather_beside::<T, _>(self.poses, index, lane);
        put_vector(second.center - first.center, &mut block.between, lane);
        let orientations = [first.orientation, second.orientation];
        let mut end = 0;
        while end < 2 {
            let anchor: Vec3<T> = vector_at(&block.anchors[end], lane);
            put_vector(orientations[end].rotate(anchor), &mut block.anchors[end], lane);
            if let Some(rotations) = self.blocks.rotations.get_mut(index) {
                let frame = quaternion_at::<T>(&rotations.frames[end], lane);
                put_quaternion(orientations[end] * frame, &mut rotations.frames[end], lane);
            }
            end += 1;
        }
        let (bodies, inv_inertia) = self.bodies.load::<T>(index, lane, &[]);
        let deltas = self.bodies.delta_poses(index, lane);
        follow(&mut self.blocks, (index, lane), &deltas, (&bodies, &inv_inertia));
        let (linear, angular) = impulse(&self.blocks, (index, lane), held::<T, R, M>(&self.blocks, (index, lane)));
        self.bodies.begin_next_with(linear, angular, arms(&self.blocks, (index, lane)), (index, lane));
    }
}

impl<const R: usize, const M: usize> Kernel for PassJoints<'_, R, M> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.blocks.blocks.len() * BLOCK
    }

    #[inline(always)]
    fn is_empty(&self, i: usize) -> bool {
        self.bodies.motion.is_empty(i / BLOCK, i % BLOCK)
    }

    #[inline(always)]
    fn tile<T: Tile>(&mut self, i: usize) {
        let here = (i / BLOCK, i % BLOCK);
        let (index, lane) = here;
        let (mut bodies, inv_inertia) = self.bodies.load::<T>(index, lane, &[]);
        if self.softness.is_none() {
            let deltas = self.bodies.delta_poses(index, lane);
            follow(&mut self.blocks, here, &deltas, (&bodies, &inv_inertia));
        }
        let arms = arms::<T, R, M>(&self.blocks, here);
        let motion = bodies.relative(&inv_inertia, arms);
        let mut speeds = along_rows(&self.blocks, here, (motion.linear, motion.angular));
        let before = held(&self.blocks, here);
        let mut kept = T::splat(1.0);
        if let Some(softness) = self.softness {
            kept = T::splat(f64::from(1.0 - softness.impulse_scale));
            self.soften(here, softness, &mut speeds);
        }
        let asked = solve(&self.blocks.blocks[index].factors, lane, speeds);
        let (mut after, mut changes) = (before, before);
        let mut row = 0;
        while row < R {
            after[row] = before[row] * kept - asked[row];
            changes[row] = after[row] - before[row];
            put(after[row], &mut self.blocks.blocks[index].impulses[row], lane);
            row += 1;
        }
        let (linear, angular) = impulse(&self.blocks, here, changes);
        bodies.push(arms, linear, angular);
        bodies.store(&mut self.bodies.motion, index, lane);
        if self.softness.is_none() {
            let (linear, angular) = impulse(&self.blocks, here, after);
            self.note_done(here, linear, angular);
            self.bodies.begin_next_with(linear, angular, arms, here);
        }
    }
}

impl<const R: usize, const M: usize> PassJoints<'_, R, M> {
    /// Adds to the speeds that a pass takes out what takes the errors out.
    #[inline(always)]
    fn soften<T: Tile>(&self, (index, lane): (usize, usize), softness: Softness, speeds: &mut [T; R]) {
        let mass_scale = T::splat(softness.mass_scale.into());
        let rate = T::splat(f64::from(softness.mass_scale * softness.bias_rate));
        let Vec3 { x, y, z } = vector_at::<T>(&self.blocks.blocks[index].gap, lane);
        let mut errors = by_row::<T, R>([x, y, z]);
        let mut row = 0;
        while row < R {
            if let (true, Some(rotations)) = (row >= 3, self.blocks.rotations.get(index)) {
                errors[row] = at(&rotations.errors[row - 3], lane);
            }
            speeds[row] = speeds[row] * mass_scale + errors[row] * rate;
            row += 1;
        }
    }

    /// Adds the impulses of a substep to those of the step, about the second anchor.
    #[inline(always)]
    fn note_done<T: Tile>(&mut self, (index, lane): (usize, usize), linear: Vec3<T>, angular: Vec3<T>) {
        let block = &mut self.blocks.blocks[index];
        let from_anchor = vector_at::<T>(&block.gap, lane) * T::splat(-0.5);
        let [before, turning] = [vector_at::<T>(&block.done[0], lane), vector_at::<T>(&block.done[1], lane)];
        put_vector(before + linear, &mut block.done[0], lane);
        put_vector(turning + angular + from_anchor.cross(linear), &mut block.done[1], lane);
    }
}

impl StageBodies<'_> {
    /// Has the bodies of a tile begin the next substep with an impulse at these arms, and notes how
    /// strongly that pulls at them.
    #[inline(always)]
    fn begin_next_with<T: Tile>(
        &mut self,
        linear: Vec3<T>,
        angular: Vec3<T>,
        arms: [Vec3<T>; 2],
        (index, lane): (usize, usize),
    ) {
        if !self.motion.has_non_dynamic() {
            let before = self.warm_start.gather::<T>(index, 0, lane);
            let minus = T::splat(-1.0);
            self.warm_start.scatter(pushed(before, linear * minus, angular * minus, arms[0]), index, 0, lane);
        }
        let before = self.warm_start.gather::<T>(index, 1, lane);
        self.warm_start.scatter(pushed(before, linear, angular, arms[1]), index, 1, lane);
    }
}

/// The impulses of a body with one more of them, at this arm.
#[inline(always)]
fn pushed<T: Tile>(
    before: WarmStartImpulse<T>,
    linear: Vec3<T>,
    angular: Vec3<T>,
    arm: Vec3<T>,
) -> WarmStartImpulse<T> {
    WarmStartImpulse {
        linear: before.linear + linear,
        angular: before.angular + (arm.cross(linear) + angular),
        pull: before.pull + linear.dot(linear).sqrt() * arm.dot(arm).sqrt(),
        ..before
    }
}

/// Numbers by row, of which these are the first, and the others zero.
#[inline(always)]
fn by_row<T: Tile, const R: usize>([x, y, z]: [T; 3]) -> [T; R] {
    let mut rows = [T::splat(0.0); R];
    (rows[0], rows[1], rows[2]) = (x, y, z);
    rows
}

/// Along or about the rows, of a linear and an angular velocity.
#[inline(always)]
fn along_rows<T: Tile, const R: usize, const M: usize>(
    blocks: &JointBlocks<'_, R, M>,
    (index, lane): (usize, usize),
    (linear, angular): (Vec3<T>, Vec3<T>),
) -> [T; R] {
    let mut along = by_row::<T, R>([linear.x, linear.y, linear.z]);
    if let Some(rotations) = blocks.rotations.get(index) {
        let mut row = 3;
        while row < R {
            along[row] = vector_at::<T>(&rotations.axes[row - 3], lane).dot(angular);
            row += 1;
        }
    }
    along
}

/// Where both bodies are pushed.
#[inline(always)]
fn arms<T: Tile, const R: usize, const M: usize>(
    blocks: &JointBlocks<'_, R, M>,
    (index, lane): (usize, usize),
) -> [Vec3<T>; 2] {
    let [first, second] = &blocks.blocks[index].arms;
    [vector_at(first, lane), vector_at(second, lane)]
}

/// The impulses of the substep.
#[inline(always)]
fn held<T: Tile, const R: usize, const M: usize>(
    blocks: &JointBlocks<'_, R, M>,
    (index, lane): (usize, usize),
) -> [T; R] {
    let mut held = [T::splat(0.0); R];
    let mut row = 0;
    while row < R {
        held[row] = at(&blocks.blocks[index].impulses[row], lane);
        row += 1;
    }
    held
}

/// The impulse and the angular impulse of impulses along the rows.
#[inline(always)]
fn impulse<T: Tile, const R: usize, const M: usize>(
    blocks: &JointBlocks<'_, R, M>,
    (index, lane): (usize, usize),
    along: [T; R],
) -> (Vec3<T>, Vec3<T>) {
    let mut angular = Vec3::zero();
    if let Some(rotations) = blocks.rotations.get(index) {
        let mut row = 3;
        while row < R {
            angular = angular + vector_at::<T>(&rotations.axes[row - 3], lane) * along[row];
            row += 1;
        }
    }
    (Vec3::new(along[0], along[1], along[2]), angular)
}

/// Has joints follow their bodies, which have moved like this since the step began: arms, errors,
/// axes, and the matrix.
#[inline(always)]
fn follow<T: Tile, const R: usize, const M: usize>(
    blocks: &mut JointBlocks<'_, R, M>,
    (index, lane): (usize, usize),
    deltas: &DeltaPoses<T>,
    (bodies, inv_inertia): (&BodyLanes<'_, T>, &InverseInertias<T>),
) {
    let block = &mut blocks.blocks[index];
    let anchors = [vector_at(&block.anchors[0], lane), vector_at(&block.anchors[1], lane)];
    let between = (vector_at(&block.between, lane), deltas.linear);
    let (anchor_arms, gap) = arms_and_gap(deltas.rotation, anchors, between);
    let [first, second, _] = pushed_at(anchor_arms, gap, gap * T::splat(0.5));
    put_vector(first, &mut block.arms[0], lane);
    put_vector(second, &mut block.arms[1], lane);
    put_vector(gap, &mut block.gap, lane);
    let zero = Vec3::zero();
    let mut axes = [zero; 3];
    if let Some(rotations) = blocks.rotations.get_mut(index) {
        let frames = [
            deltas.rotation[0] * quaternion_at(&rotations.frames[0], lane),
            deltas.rotation[1] * quaternion_at(&rotations.frames[1], lane),
        ];
        let locked = if R == 6 { Rotations::Locked } else { Rotations::About(0) };
        axes = locked.locked_axes(frames[0].axes());
        let errors = locked.errors(frames[0].conjugate() * frames[1]);
        let mut row = 0;
        while row < R - 3 {
            put_vector(axes[row], &mut rotations.axes[row], lane);
            put(errors[row], &mut rotations.errors[row], lane);
            row += 1;
        }
    }

    let mobility = bodies.mobility(inv_inertia);
    let one = T::splat(1.0);
    let units = [
        Vec3::new(one, T::splat(0.0), T::splat(0.0)),
        Vec3::new(T::splat(0.0), one, T::splat(0.0)),
        Vec3::new(T::splat(0.0), T::splat(0.0), one),
    ];
    let (mut torques, mut responses) = ([[zero; 2]; R], [[zero; 2]; R]);
    let mut row = 0;
    while row < R {
        torques[row] = if row < 3 { [first.cross(units[row]), second.cross(units[row])] } else { [axes[row - 3]; 2] };
        responses[row] =
            [mobility.inv_inertia.of_first(torques[row][0]), mobility.inv_inertia.of_second(torques[row][1])];
        row += 1;
    }
    let mut matrix = [T::splat(0.0); M];
    row = 0;
    while row < R {
        let mut column = 0;
        while column <= row {
            let turning = torques[row][0].dot(responses[column][0]) + torques[row][1].dot(responses[column][1]);
            let is_moving = row == column && row < 3;
            matrix[place(row, column)] = if is_moving { turning + mobility.inverse_mass } else { turning };
            column += 1;
        }
        row += 1;
    }
    factor::<T, R, M>(matrix, &mut blocks.blocks[index].factors, lane);
}

#[inline(always)]
fn quaternion_at<T: Tile>(numbers: &[Lanes; 4], lane: usize) -> Quat<T> {
    Quat { x: at(&numbers[0], lane), y: at(&numbers[1], lane), z: at(&numbers[2], lane), w: at(&numbers[3], lane) }
}

#[inline(always)]
fn put_quaternion<T: Tile>(q: Quat<T>, numbers: &mut [Lanes; 4], lane: usize) {
    put(q.x, &mut numbers[0], lane);
    put(q.y, &mut numbers[1], lane);
    put(q.z, &mut numbers[2], lane);
    put(q.w, &mut numbers[3], lane);
}
