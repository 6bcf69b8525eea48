//! The solve and relax stages: the contacts of a color, a tile at a time.

use tumble_math::lane::Vec3;

use crate::collision::contact::UpdateRule;
use crate::math::Real;
use crate::simd::block_lanes::{Lanes, at, put, vector_at};
use crate::simd::{BLOCK, Kernel, Rows, Tile};
use crate::solver::block_parts::ColorBlocks;
use crate::solver::body_rows::{BodyMotion, DeltaPose, WarmStartImpulse, WorldInverseInertia};
use crate::solver::contact::capsule_axes::CapsuleAxes;
use crate::solver::contact::constraint::{Belt, Block, Bounce, Rolling};
use crate::solver::contact::contact_frame::{
    BodyLanes, ContactFrame, DeltaPoses, InverseInertias, Momenta, TileLocks, along_normal,
};
use crate::solver::contact::effective_mass::warm_start_factor;
use crate::solver::contact::friction::FrictionImpulse;
use crate::solver::contact::impact::{DecoupledImpulses, record_impact};
use crate::solver::contact::line::Line;
use crate::solver::contact::softness::Softness;
use crate::solver::contact::update_geometry::{follow, of_balls, of_rule};
use crate::solver::locked_bodies::BlockLocks;

/// Blocks of one color, with what only some contacts have: as many of it as there are blocks, or
/// none.
pub(crate) struct Blocks<'a, const P: usize, const C: usize> {
    pub(crate) blocks: &'a mut [Block<P, C>],
    pub(crate) rolling: &'a mut [Rolling],
    pub(crate) lines: &'a mut [Line],
    pub(crate) axes: &'a [CapsuleAxes],
    pub(crate) bounces: &'a mut [Bounce<P>],
    pub(crate) belts: &'a mut [Belt],
    pub(crate) locks: &'a [BlockLocks],
    /// Of contacts that follow their bodies in a stage of its own, by how much velocities differ in
    /// the middle of the substep \[m/s\].
    pub(crate) lags: &'a mut [[Lanes; 3]],
}

impl<const P: usize, const C: usize> ColorBlocks for Blocks<'_, P, C> {
    fn count(&self) -> usize {
        self.blocks.len()
    }

    fn parted(self, middle: usize) -> (Self, Self) {
        let of_some = |count: usize| if count == 0 { 0 } else { middle };
        let (blocks, other_blocks) = self.blocks.split_at_mut(middle);
        let (rolling, other_rolling) = self.rolling.split_at_mut(of_some(self.rolling.len()));
        let (lines, other_lines) = self.lines.split_at_mut(of_some(self.lines.len()));
        let (axes, other_axes) = self.axes.split_at(of_some(self.axes.len()));
        let (bounces, other_bounces) = self.bounces.split_at_mut(of_some(self.bounces.len()));
        let (belts, other_belts) = self.belts.split_at_mut(of_some(self.belts.len()));
        let (locks, other_locks) = self.locks.split_at(of_some(self.locks.len()));
        let (lags, other_lags) = self.lags.split_at_mut(of_some(self.lags.len()));
        let others = Self {
            blocks: other_blocks,
            rolling: other_rolling,
            lines: other_lines,
            axes: other_axes,
            bounces: other_bounces,
            belts: other_belts,
            locks: other_locks,
            lags: other_lags,
        };
        (Self { blocks, rolling, lines, axes, bounces, belts, locks, lags }, others)
    }
}

impl<const P: usize, const C: usize> Blocks<'_, P, C> {
    /// What friction takes out, as a velocity of the second body relative to the first, where that
    /// differs by a lag.
    #[inline(always)]
    pub(crate) fn slip_reference<T: Tile>(&self, index: usize, lane: usize, lag: Vec3<T>) -> Vec3<T> {
        match self.belts.get(index) {
            Some(belt) => lag + vector_at(&belt.velocity, lane),
            None => lag,
        }
    }
}

/// The bodies that a pass reads and writes.
pub(crate) struct StageBodies<'a> {
    pub(crate) motion: Rows<'a, BodyMotion>,
    pub(crate) warm_start: Rows<'a, WarmStartImpulse>,
    pub(crate) inv_inertia: &'a [WorldInverseInertia],
    pub(crate) delta_pose: &'a [DeltaPose],
}

impl StageBodies<'_> {
    /// Those of a tile from a lane of a block on.
    #[inline(always)]
    pub(crate) fn load<'l, T: Tile>(
        &self,
        index: usize,
        lane: usize,
        locks: &'l [BlockLocks],
    ) -> (BodyLanes<'l, T>, InverseInertias<T>) {
        let inv_inertia = InverseInertias::new(self.motion.gather_beside(self.inv_inertia, index, lane));
        (BodyLanes::load(&self.motion, index, lane, locks), inv_inertia)
    }

    /// How those of a tile have moved since the step began.
    #[inline(always)]
    pub(crate) fn delta_poses<T: Tile>(&self, index: usize, lane: usize) -> DeltaPoses<T> {
        DeltaPoses::new(self.motion.gather_beside(self.delta_pose, index, lane))
    }

    /// Those of the first `middle` blocks, and of the others.
    pub(crate) fn split_at(self, middle: usize) -> (Self, Self) {
        let (motion, other_motion) = self.motion.split_at(middle);
        let (warm_start, other_warm_start) = self.warm_start.split_at(middle);
        (Self { motion, warm_start, ..self }, Self { motion: other_motion, warm_start: other_warm_start, ..self })
    }
}

/// One pass over the points, in order: what overlaps is pushed apart or, where it is to relax, the
/// velocity that this gave is taken out again, and friction follows.
pub(crate) struct Solve<'a, const P: usize, const C: usize> {
    pub(crate) blocks: Blocks<'a, P, C>,
    pub(crate) bodies: StageBodies<'a>,
    /// How what overlaps is pushed apart; none where it is to relax.
    pub(crate) softness: Option<Softness>,
    /// Points that approach faster are impacts [m/s].
    pub(crate) impact_speed: Real,
    /// Whether the impulses are stored for the warm start of the next substep.
    pub(crate) stores_warm_start: bool,
    /// One over the substep [1/s].
    pub(crate) inverse_h: Real,
}

impl<const P: usize, const C: usize> Kernel for Solve<'_, P, C> {
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
        let (mut bodies, inv_inertia) = self.bodies.load::<T>(index, lane, self.blocks.locks);
        let lag = match (self.softness, self.blocks.bounces.get(index)) {
            (Some(_), _) => vector_at::<T>(&block.normal, lane) * at::<T>(&block.start.lead, lane),
            // Where bodies bounce, contacts have followed.
            (None, Some(bounce)) => vector_at(&bounce.lag, lane),
            (None, None) => {
                let delta_pose = self.bodies.delta_poses(index, lane);
                let h = T::splat(1.0) / T::splat(self.inverse_h.into());
                let (rolling, lines) = (&mut self.blocks.rolling, &mut self.blocks.lines);
                let others = (rolling.get_mut(index), lines.get_mut(index), self.blocks.axes.get(index));
                follow(block, others, (lane, h), &delta_pose, (&bodies, &inv_inertia))
            }
        };
        if self.softness.is_none() {
            put(T::splat(0.0) - lag.dot(vector_at(&block.normal, lane)), &mut block.start.lead, lane);
        }
        let frame = ContactFrame::<T>::load(block, lane);
        let arms = frame.arms;

        let parts = frame.normal_parts(&bodies.relative(&inv_inertia, arms).less(lag));
        let speeds = speeds(&self.blocks.blocks[index], lane, self.on_lines(index, lane, parts));
        let (changes, sum) = self.solve_points(index, lane, speeds);
        let block = &mut self.blocks.blocks[index];
        let (linear, angular) = along_normals(block, &frame, lane, changes);
        bodies.push(arms, linear, angular);

        if self.softness.is_none() {
            let lag = self.blocks.slip_reference(index, lane, lag);
            let block = &mut self.blocks.blocks[index];
            let total: T = at(&block.start.total_impulse, lane);
            put(total + sum, &mut block.start.total_impulse, lane);
            // What friction did to bodies that have turned right over is not taken back: it
            // would not be the same elsewhere.
            let (zero, one) = (T::splat(0.0), T::splat(1.0));
            let steady = warm_start_factor(at(&block.start.steady, lane));
            let is_same = T::select(zero.lt(steady), one, zero);
            let given = FrictionImpulse::load(&block.friction, self.blocks.rolling.get(index), lane);
            let before = given.scaled(is_same);
            let contact = (&frame, lane);
            let after = apply_friction(
                before,
                block,
                self.blocks.rolling.get(index),
                contact,
                &mut bodies,
                (&inv_inertia, arms, lag),
                sum,
            );
            let after = after.plus(&given.scaled(one - is_same));
            // The impulse of an impact is no force: a body pushed off by it would be somewhere
            // else before that is taken back.
            let lasting = T::select(zero.lt(at(&block.start.is_impact, lane)), zero, steady);
            let kept = if self.stores_warm_start { lasting } else { one };
            let after = after.scaled(kept);
            after.store(&mut block.friction, self.blocks.rolling.get_mut(index), lane);
            if self.stores_warm_start {
                scale_impulses(block, lane, kept);
                let locks = TileLocks::of(self.blocks.locks, index, lane);
                accumulate_warm_start(block, (&frame, locks), &after, &mut self.bodies.warm_start, (index, lane));
            }
        }
        bodies.store(&mut self.bodies.motion, index, lane);
    }
}

impl<const P: usize, const C: usize> Solve<'_, P, C> {
    /// The parts of a motion along the normal as lines of contact that turn have it.
    #[inline(always)]
    fn on_lines<T: Tile>(&self, index: usize, lane: usize, parts: [T; 3]) -> [T; 3] {
        match (self.blocks.lines.get(index), self.softness) {
            (Some(line), Some(_)) => line.with_lag(parts, lane),
            (Some(line), None) => line.without_lag(parts, lane),
            (None, _) => parts,
        }
    }

    /// By how much the impulse of each point changed, and the sum of the impulses.
    #[inline(always)]
    fn solve_points<T: Tile>(&mut self, index: usize, lane: usize, speeds: [T; P]) -> ([T; P], T) {
        let (zero, one) = (T::splat(0.0), T::splat(1.0));
        let to = (self.softness.as_ref(), self.inverse_h);
        let block = &mut self.blocks.blocks[index];
        let fast = T::splat((-self.impact_speed).into());
        let (mut before, mut changes) = ([zero; P], [zero; P]);
        let (mut is_impact, mut begins) = (zero, zero);
        let mut j = 0;
        while j < P {
            before[j] = at(&block.points[j].impulse, lane);
            let point = &block.points[j];
            // A point that is not there has no mass and any speed.
            let is_fast = T::select(zero.lt(at(&point.mass, lane)), T::select(speeds[j].lt(fast), one, zero), zero);
            is_impact = is_impact.max(is_fast);
            // What overlaps is pressed.
            let is_apart = T::select(zero.lt(at(&point.separation, lane)), is_fast, zero);
            begins = begins.max(T::select(zero.lt(before[j]), zero, is_apart));
            j += 1;
        }
        let (begun, mut speeds) = (speeds, speeds);
        let mut means = speeds;
        if P > 1 && T::any(zero.lt(is_impact)) {
            let mut decoupled = DecoupledImpulses::none();
            j = 0;
            while j < P {
                let aim = aim(block, (j, lane), to, (speeds[j], before[j]));
                let mass: T = at(&block.points[j].mass, lane);
                decoupled.set(j, aim.impulse(before[j], speeds[j], mass) - before[j], mass, is_impact);
                j += 1;
            }
            (changes, means) = decoupled.together(block, lane, &mut speeds);
        }

        let mut sum = zero;
        j = 0;
        while j < P {
            let aim = aim(block, (j, lane), to, (speeds[j], before[j]));
            let point = &mut block.points[j];
            let (start, mass): (T, T) = (before[j] + changes[j], at(&point.mass, lane));
            let impulse = aim.impulse(start, speeds[j], mass).max(zero);
            put(impulse, &mut point.impulse, lane);
            if let Some(bounce) = self.blocks.bounces.get_mut(index) {
                // What nothing stops does not bounce, however fast it comes.
                let met = T::select(zero.lt(impulse), at(&bounce.met[j], lane), zero);
                let approach: T = at(&bounce.approach[j], lane);
                put(met.min(approach), &mut bounce.approach[j], lane);
                let mut given = changes[j] * means[j] + work(impulse - start, speeds[j], mass);
                if self.softness.is_some() {
                    // And what the impulse did that the substep began with.
                    given = given + before[j] * (at::<T>(&bounce.coming[j], lane) + begun[j]) * T::splat(0.5);
                }
                put(at::<T>(&bounce.absorbed, lane) - given, &mut bounce.absorbed, lane);
            }
            changes[j] = impulse - before[j];
            sum = sum + impulse;
            couple(block, lane, j, impulse - start, &mut speeds);
            j += 1;
        }
        let begins = T::select(zero.lt(sum), begins, zero);
        let block = &mut self.blocks.blocks[index];
        put(
            record_impact(at(&block.start.is_impact, lane), begins, self.softness.is_some()),
            &mut block.start.is_impact,
            lane,
        );
        (changes, sum)
    }
}

/// A point is to move at `-bias` \[m/s\] along the normal; how much of that a soft contact brings
/// about, and how much of its impulse it lets go.
struct Aim<T> {
    bias: T,
    mass_scale: T,
    impulse_scale: T,
}

impl<T: Tile> Aim<T> {
    /// The impulse that a point has, alone and if it could pull.
    #[inline(always)]
    fn impulse(&self, before: T, speed: T, mass: T) -> T {
        before - (self.mass_scale * speed + self.bias) * mass - self.impulse_scale * before
    }
}

/// The target of a point with this speed along the normal [m/s] and this impulse [N s].
#[inline(always)]
fn aim<T: Tile, const P: usize, const C: usize>(
    block: &Block<P, C>,
    (j, lane): (usize, usize),
    (softness, inverse_h): (Option<&Softness>, Real),
    (speed, before): (T, T),
) -> Aim<T> {
    let (zero, one) = (T::splat(0.0), T::splat(1.0));
    let separation: T = at(&block.points[j].separation, lane);
    // What is apart may come as near in a substep as it is apart.
    let apart = zero.lt(separation);
    let near = separation * T::splat(inverse_h.into());
    match softness {
        Some(softness) => {
            // A body that turns right over is not where a push would have it go.
            let pushed: T = at(&block.start.steady, lane);
            Aim {
                bias: T::select(apart, near, softness.bias(separation) * pushed),
                mass_scale: T::select(apart, one, T::splat(softness.mass_scale.into())),
                impulse_scale: T::select(apart, zero, T::splat(softness.impulse_scale.into())),
            }
        }
        // Between coming as near as it may and leaving there is nothing to take out. A ball that is
        // apart and was not stopped in this substep is left to the next.
        None => {
            let coming = (zero - speed).max(zero);
            let rule: T = at(&block.start.update_rule, lane);
            let is_ball = if P == 1 { of_balls(rule).max(of_rule(rule, UpdateRule::Constant)) } else { zero };
            let is_left = T::select(zero.lt(before), zero, is_ball);
            let near = T::select(zero.lt(is_left), coming, near);
            let bias = T::select(apart, near, zero).min(coming);
            Aim { bias, mass_scale: one, impulse_scale: zero }
        }
    }
}

/// Energy that an impulse gives to the bodies at a point with this velocity and this effective
/// mass.
#[inline(always)]
pub(crate) fn work<T: Tile>(impulse: T, speed: T, mass: T) -> T {
    let (zero, half) = (T::splat(0.0), T::splat(0.5));
    T::select(zero.lt(mass), impulse * (speed + impulse / mass * half), zero)
}

/// Takes out what resistance to rolling and then friction can of the motion, where normal impulses
/// add up to `normal`; returns the impulses as they are then.
#[inline(always)]
pub(crate) fn apply_friction<T: Tile, const P: usize, const C: usize>(
    before: FrictionImpulse<T>,
    block: &Block<P, C>,
    rolling: Option<&Rolling>,
    contact: (&ContactFrame<T>, usize),
    bodies: &mut BodyLanes<'_, T>,
    (inv_inertia, arms, lag): (&InverseInertias<T>, [Vec3<T>; 2], Vec3<T>),
    normal: T,
) -> FrictionImpulse<T> {
    let frame = contact.0;
    let mut friction = before;
    if let Some(rolling) = rolling {
        friction = before.rolled(rolling, contact, &bodies.relative(inv_inertia, arms), normal);
        bodies.push(arms, Vec3::zero(), friction.angular(frame) - before.angular(frame));
    }
    let after = friction.slid::<P>(&block.friction, contact, &bodies.relative(inv_inertia, arms).less(lag), normal);
    let linear = after.linear(frame) - friction.linear(frame);
    bodies.push(arms, linear, after.angular(frame) - friction.angular(frame));
    after
}

/// Velocity along the normal at each point.
#[inline(always)]
pub(crate) fn speeds<T: Tile, const P: usize, const C: usize>(
    block: &Block<P, C>,
    lane: usize,
    parts: [T; 3],
) -> [T; P] {
    let mut speeds = [parts[0]; P];
    let mut j = 0;
    while j < P {
        let offset = &block.points[j].offset;
        speeds[j] = along_normal(parts, at(&offset[0], lane), at(&offset[1], lane));
        j += 1;
    }
    speeds
}

/// The coupling of an impulse at a point to the velocities at those after it.
#[inline(always)]
pub(crate) fn couple<T: Tile, const P: usize, const C: usize>(
    block: &Block<P, C>,
    lane: usize,
    j: usize,
    change: T,
    speeds: &mut [T; P],
) {
    let mut k = j + 1;
    while k < P {
        speeds[k] = speeds[k] + at::<T>(&block.couplings[coupling::<P>(j, k)], lane) * change;
        k += 1;
    }
}

/// Where the coupling of two points is, the first with a lower index than the second.
#[inline(always)]
pub(crate) const fn coupling<const P: usize>(j: usize, k: usize) -> usize {
    j * (2 * P - j - 1) / 2 + (k - j - 1)
}

/// Impulses along the normal at the points, as an impulse in the middle and an angular impulse.
#[inline(always)]
pub(crate) fn along_normals<T: Tile, const P: usize, const C: usize>(
    block: &Block<P, C>,
    frame: &ContactFrame<T>,
    lane: usize,
    impulses: [T; P],
) -> (Vec3<T>, Vec3<T>) {
    let zero = T::splat(0.0);
    let (mut sum, mut about_1, mut about_2) = (zero, zero, zero);
    let mut j = 0;
    while j < P {
        let offset = &block.points[j].offset;
        sum = sum + impulses[j];
        about_1 = about_1 + at::<T>(&offset[1], lane) * impulses[j];
        about_2 = about_2 + at::<T>(&offset[0], lane) * impulses[j];
        j += 1;
    }
    (frame.normal * sum, frame.tangents[0] * about_1 - frame.tangents[1] * about_2)
}

/// Scales the normal impulses for the warm start of the next substep.
#[inline(always)]
pub(crate) fn scale_impulses<T: Tile, const P: usize, const C: usize>(block: &mut Block<P, C>, lane: usize, kept: T) {
    let mut j = 0;
    while j < P {
        let impulse: T = at(&block.points[j].impulse, lane);
        put(impulse * kept, &mut block.points[j].impulse, lane);
        j += 1;
    }
}

/// Adds all impulses of a contact to what holds the bodies.
#[inline(always)]
pub(crate) fn accumulate_warm_start<T: Tile, const P: usize, const C: usize>(
    block: &Block<P, C>,
    (frame, locks): (&ContactFrame<T>, TileLocks<'_>),
    friction: &FrictionImpulse<T>,
    warm_start: &mut Rows<'_, WarmStartImpulse>,
    (index, lane): (usize, usize),
) {
    let mut impulses = [T::splat(0.0); P];
    let mut j = 0;
    while j < P {
        impulses[j] = at(&block.points[j].impulse, lane);
        j += 1;
    }
    let (linear, angular) = along_normals(block, frame, lane, impulses);
    let mut momenta = Momenta::of_warm_start(warm_start, (index, lane), locks);
    momenta.push(frame.arms, linear + friction.linear(frame), angular + friction.angular(frame));
    momenta.store_warm_start(warm_start, index, lane);
}
