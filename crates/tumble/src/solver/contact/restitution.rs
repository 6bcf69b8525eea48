//! Restitution: approach speeds before anything is solved, and the bounce after the last substep.

use tumble_math::lane::Vec3;

use crate::math::Real;
use crate::simd::block_lanes::{at, put, put_vector};
use crate::simd::{BLOCK, Kernel, Tile};
use crate::solver::contact::constraint::{Block, Bounce};
use crate::solver::contact::contact_frame::ContactFrame;
use crate::solver::contact::friction::FrictionImpulse;
use crate::solver::contact::impact::DecoupledImpulses;
use crate::solver::contact::update_geometry::{follow, of_balls};

use crate::solver::contact::solve::{Blocks, StageBodies, along_normals, apply_friction, couple, speeds, work};

/// Notes how fast bodies come together before anything pushes them apart. Of what forces do in a
/// substep only the part until they meet counts: with the rest they would bounce with energy out of
/// nothing.
pub(crate) struct RecordApproachSpeed<'a, const P: usize, const C: usize> {
    pub(crate) blocks: Blocks<'a, P, C>,
    pub(crate) bodies: StageBodies<'a>,
    /// One over the substep [1/s].
    pub(crate) inverse_h: Real,
    pub(crate) moment: SubstepMoment,
}

/// When in a substep.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum SubstepMoment {
    /// After forces have acted for the first time in the step: what they did they do in the others
    /// too.
    FirstForces,
    Forces,
    /// After the bodies have moved, and before anything looks ahead to the next substep.
    Motion,
}

impl<const P: usize, const C: usize> Kernel for RecordApproachSpeed<'_, P, C> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.blocks.bounces.len() * BLOCK
    }

    #[inline(always)]
    fn is_empty(&self, i: usize) -> bool {
        self.bodies.motion.is_empty(i / BLOCK, i % BLOCK)
    }

    #[inline(always)]
    fn tile<T: Tile>(&mut self, i: usize) {
        let (index, lane) = (i / BLOCK, i % BLOCK);
        let block = &mut self.blocks.blocks[index];
        let (bodies, inv_inertia) = self.bodies.load::<T>(index, lane, self.blocks.locks);
        if self.moment == SubstepMoment::Motion {
            let delta_pose = self.bodies.delta_poses(index, lane);
            let h = T::splat(1.0) / T::splat(self.inverse_h.into());
            let (rolling, lines) = (&mut self.blocks.rolling, &mut self.blocks.lines);
            let others = (rolling.get_mut(index), lines.get_mut(index), self.blocks.axes.get(index));
            let lag = follow(block, others, (lane, h), &delta_pose, (&bodies, &inv_inertia));
            // An impact that is to bounce stops what comes, and adds nothing: it would come back
            // with energy out of nothing.
            let bounce = &mut self.blocks.bounces[index];
            let bounces = T::splat(0.0).lt(at(&bounce.restitution, lane));
            put_vector(Vec3::select(bounces, Vec3::zero(), lag), &mut bounce.lag, lane);
            if let Some(line) = self.blocks.lines.get_mut(index) {
                line.forget_lag_where::<T>(bounces, lane);
            }
        }
        let frame = ContactFrame::<T>::load(block, lane);
        let speeds = speeds(block, lane, frame.normal_parts(&bodies.relative(&inv_inertia, frame.arms)));
        let bounce = &mut self.blocks.bounces[index];
        let (zero, one, inverse_h) = (T::splat(0.0), T::splat(1.0), T::splat(self.inverse_h.into()));
        let mut j = 0;
        while j < P {
            if self.moment == SubstepMoment::Motion {
                put(speeds[j], &mut bounce.before[j], lane);
            } else {
                let before: T = at(&bounce.before[j], lane);
                if self.moment == SubstepMoment::FirstForces {
                    put(speeds[j] - before, &mut bounce.kick[j], lane);
                }
                let kick: T = at(&bounce.kick[j], lane);
                let speed = before + kick;
                // The part of the substep after which they meet.
                let part = (at::<T>(&block.points[j].separation, lane) * inverse_h / -speed).max(zero).min(one);
                let met = before + kick * T::select(speed.lt(zero), part, one);
                put(met, &mut bounce.met[j], lane);
                put(speeds[j], &mut bounce.coming[j], lane);
            }
            j += 1;
        }
    }
}

/// Makes points leave as fast as the restitution has it, where they came in faster than `threshold`
/// \[m/s\], with the friction that the added impulse allows.
pub(crate) struct ApplyRestitution<'a, const P: usize, const C: usize> {
    pub(crate) blocks: Blocks<'a, P, C>,
    pub(crate) bodies: StageBodies<'a>,
    pub(crate) threshold: Real,
}

impl<const P: usize, const C: usize> Kernel for ApplyRestitution<'_, P, C> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.blocks.bounces.len() * BLOCK
    }

    #[inline(always)]
    fn is_empty(&self, i: usize) -> bool {
        self.bodies.motion.is_empty(i / BLOCK, i % BLOCK)
    }

    #[inline(always)]
    fn tile<T: Tile>(&mut self, i: usize) {
        let (index, lane) = (i / BLOCK, i % BLOCK);
        let zero = T::splat(0.0);
        let (block, bounce) = (&mut self.blocks.blocks[index], &mut self.blocks.bounces[index]);
        let frame = ContactFrame::<T>::load(block, lane);
        let (mut bodies, inv_inertia) = self.bodies.load::<T>(index, lane, self.blocks.locks);
        let arms = frame.arms;
        let restitution: T = at(&bounce.restitution, lane);
        let slowest = T::splat(-f64::from(self.threshold));
        let speeds = speeds(block, lane, frame.normal_parts(&bodies.relative(&inv_inertia, arms)));
        let (mut changes, given) = leaving_impulses(block, bounce, lane, (restitution, slowest), speeds);
        // Bodies that turn while they touch come back with other effective masses, but never with
        // more energy.
        let most = restitution * restitution * at::<T>(&bounce.absorbed, lane).max(zero);
        // Balls are as hard to move as before: what each of a heap gives back may have come in
        // through another.
        let one = T::splat(1.0);
        let is_of_balls = zero.lt(of_balls(at::<T>(&block.start.update_rule, lane)));
        let most = if bodies.has_locks() { most } else { T::select(is_of_balls, given, most) };
        let part = T::select(most.lt(given), most / given, one);
        let (mut added, mut j) = (zero, 0);
        while j < P {
            changes[j] = changes[j] * part;
            added = added + changes[j];
            let impulse = at::<T>(&block.points[j].impulse, lane) + changes[j];
            put(impulse, &mut block.points[j].impulse, lane);
            j += 1;
        }
        let (linear, angular) = along_normals(block, &frame, lane, changes);
        bodies.push(arms, linear, angular);

        let total: T = at(&block.start.total_impulse, lane);
        put(total + added, &mut block.start.total_impulse, lane);
        let (contact, limit) = ((&frame, lane), added.max(zero));
        let motion = (&inv_inertia, arms, self.blocks.slip_reference(index, lane, Vec3::zero()));
        let block = &self.blocks.blocks[index];
        apply_friction(
            FrictionImpulse::none(),
            block,
            self.blocks.rolling.get(index),
            contact,
            &mut bodies,
            motion,
            limit,
        );
        bodies.store(&mut self.bodies.motion, index, lane);
    }
}

/// Changes of the impulses that make points which came in faster than `slowest` \[m/s\] leave with
/// the restitution, and the energy \[J\] that they give.
#[inline(always)]
fn leaving_impulses<T: Tile, const P: usize, const C: usize>(
    block: &Block<P, C>,
    bounce: &Bounce<P>,
    lane: usize,
    (restitution, slowest): (T, T),
    mut speeds: [T; P],
) -> ([T; P], T) {
    let zero = T::splat(0.0);
    let (mut changes, mut given) = ([zero; P], zero);
    if P > 1 {
        let mut decoupled = DecoupledImpulses::none();
        let mut j = 0;
        while j < P {
            let approach: T = at(&bounce.approach[j], lane);
            let bounces = T::select(approach.lt(slowest), restitution, zero);
            let mass: T = at(&block.points[j].mass, lane);
            decoupled.set(j, zero - (speeds[j] + restitution * approach) * mass, mass, bounces);
            j += 1;
        }
        let means;
        (changes, means) = decoupled.together(block, lane, &mut speeds);
        j = 0;
        while j < P {
            given = given + changes[j] * means[j];
            j += 1;
        }
    }
    let mut j = 0;
    while j < P {
        let approach: T = at(&bounce.approach[j], lane);
        let bounces = zero.lt(T::select(approach.lt(slowest), restitution, zero));
        let point = &block.points[j];
        let (before, mass): (T, T) = (at(&point.impulse, lane), at(&point.mass, lane));
        let start = before + changes[j];
        let wanted = start - (speeds[j] + restitution * approach) * mass;
        let change = T::select(bounces, wanted.max(zero), start) - start;
        given = given + work(change, speeds[j], mass);
        couple(block, lane, j, change, &mut speeds);
        changes[j] = changes[j] + change;
        j += 1;
    }
    (changes, given)
}
