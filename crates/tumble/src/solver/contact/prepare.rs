//! Constraint setup at the start of a step: geometry, friction patch and warm-start impulses.

use tumble_math::lane::Vec3;

use crate::collision::contact::{ContactRecord, UpdateRule};
use crate::collision::contact_rows::{ContactGeometry, ContactLanes, NormalImpulses, WorldFriction};
use crate::simd::block_lanes::{at, put, put_vector};
use crate::simd::{BLOCK, Kernel, Tile};
use crate::solver::body_rows::BodyPose;
use crate::solver::contact::constraint::Block;
use crate::solver::contact::contact_frame::{BodyLanes, ContactFrame, InverseInertias, TileLocks};
use crate::solver::contact::effective_mass;
use crate::solver::contact::effective_mass::warm_start_factor;
use crate::solver::contact::friction::FrictionImpulse;
use crate::solver::contact::solve::{Blocks, StageBodies, accumulate_warm_start, speeds};
use crate::solver::contact::update_geometry::{is_rule, of_meeting, tangents};

/// Fills blocks whose lanes know their contacts and rows.
pub(crate) struct Prepare<'a, const P: usize, const C: usize> {
    pub(crate) blocks: Blocks<'a, P, C>,
    pub(crate) contacts: &'a [ContactRecord],
    pub(crate) bodies: StageBodies<'a>,
    pub(crate) poses: &'a [BodyPose],
}

/// Weight of a point in the middle at the least, so that a middle there is.
pub(crate) const MIN_WEIGHT: f64 = 1e-10;
/// An arm that changes by this part of a body's size changes the effective masses by as much.
const SLIDE: f64 = 1e-2;
/// Mean distance from the middle of a square under even pressure, over that of its corners: 0.3826
/// and 0.7071 of the side.
const FACE: f64 = 0.541;

impl<const P: usize, const C: usize> Kernel for Prepare<'_, P, C> {
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
        let (zero, one) = (T::splat(0.0), T::splat(1.0));
        let block = &mut self.blocks.blocks[index];
        let contacts = pick::<T, P, C>(self.contacts, block, lane);
        let ContactGeometry { normal, carried, count, rolling_resistance, restitution, update_rule } =
            contacts.geometry::<T>();
        let tangents = tangents(normal);
        let (places, separations) = contacts.points::<T>();

        let margin = contacts.friction::<T>().margin;
        let is_fixed = is_rule(update_rule, UpdateRule::BodyFixed);
        let patch = Patch::<T, P>::of((&places, &separations), count, margin, is_fixed);
        let arm = patch.middle;
        let [first, second] = self.bodies.motion.gather_beside::<T, _>(self.poses, index, lane);
        let (is_meeting, now) = (T::splat(0.0).lt(of_meeting(update_rule)), second.center - first.center);
        let apart = if T::any(is_meeting) { Vec3::select(is_meeting, contacts.met_apart(), now) } else { now };
        put_vector(normal, &mut block.normal, lane);
        put_vector(tangents[0], &mut block.tangent, lane);
        put_vector(arm + apart, &mut block.arms[0], lane);
        put_vector(arm, &mut block.arms[1], lane);
        put_vector(arm, &mut block.start.arm, lane);
        put_vector(apart, &mut block.start.apart, lane);
        put(carried, &mut block.start.carried, lane);
        put(contacts.core_radius::<T>(), &mut block.start.core_radius, lane);
        put(update_rule, &mut block.start.update_rule, lane);
        put_vector(normal, &mut block.start.normal, lane);
        put_vector(tangents[0], &mut block.start.tangent, lane);
        let NormalImpulses { at_points: [h0, h1, h2, h3], steady, .. } = contacts.normal_impulses::<T>();
        let kept = warm_start_factor(steady);
        let warm_start = [h0 * kept, h1 * kept, h2 * kept, h3 * kept];
        put(steady, &mut block.start.steady, lane);
        put(T::select(zero.lt(steady), zero, one), &mut block.start.is_impact, lane);
        put(zero, &mut block.start.total_impulse, lane);
        let mut j = 0;
        while j < P {
            let from_middle = places[j] - arm;
            let offset = [tangents[0].dot(from_middle), tangents[1].dot(from_middle)];
            let point = &mut block.points[j];
            put(offset[0], &mut point.offset[0], lane);
            put(offset[1], &mut point.offset[1], lane);
            put(offset[0], &mut block.start.offsets[j][0], lane);
            put(offset[1], &mut block.start.offsets[j][1], lane);
            put(separations[j], &mut point.separation, lane);
            put(separations[j], &mut block.start.separations[j], lane);
            put(warm_start[j], &mut point.impulse, lane);
            // The sign of a mass says whether there is a point.
            put(T::select(T::splat(j as f64).lt(count), one, zero), &mut point.mass, lane);
            j += 1;
        }

        let (bodies, inv_inertia) = self.bodies.load::<T>(index, lane, self.blocks.locks);
        let mobility = bodies.mobility(&inv_inertia);
        put(
            bodies.least_size(&mobility.inv_inertia) * T::splat(SLIDE),
            &mut self.blocks.blocks[index].start.slide,
            lane,
        );
        let Blocks { blocks, rolling, .. } = &mut self.blocks;
        effective_mass::compute(&mut blocks[index], rolling.get_mut(index), lane, &mobility, one);
        self.prepare_friction(index, lane, &patch, (&contacts, rolling_resistance));
        self.prepare_bounce(index, lane, restitution, (&bodies, &inv_inertia));
        self.prepare_belt::<T>(index, lane, &contacts);
    }
}

impl<const P: usize, const C: usize> Prepare<'_, P, C> {
    /// Records how fast the bodies come together now.
    #[inline(always)]
    fn prepare_bounce<T: Tile>(
        &mut self,
        index: usize,
        lane: usize,
        restitution: T,
        (bodies, inv_inertia): (&BodyLanes<'_, T>, &InverseInertias<T>),
    ) {
        let block = &self.blocks.blocks[index];
        let Some(bounce) = self.blocks.bounces.get_mut(index) else { return };
        let frame = ContactFrame::load(block, lane);
        let speeds = speeds(block, lane, frame.normal_parts(&bodies.relative(inv_inertia, frame.arms)));
        put(restitution, &mut bounce.restitution, lane);
        put(T::splat(0.0), &mut bounce.absorbed, lane);
        // Direct contacts read it before the bodies have moved.
        put_vector(Vec3::<T>::zero(), &mut bounce.lag, lane);
        let mut j = 0;
        while j < P {
            put(T::splat(0.0), &mut bounce.approach[j], lane);
            put(speeds[j], &mut bounce.before[j], lane);
            j += 1;
        }
    }

    /// Notes how the surfaces move on their bodies.
    #[inline(always)]
    fn prepare_belt<T: Tile>(&mut self, index: usize, lane: usize, contacts: &ContactLanes<'_>) {
        if let Some(belt) = self.blocks.belts.get_mut(index) {
            put_vector(contacts.surface_velocity::<T>(), &mut belt.velocity, lane);
        }
    }

    /// Sets the patch and begins with the impulses of the last step. A point that is far off makes
    /// no patch.
    #[inline(always)]
    fn prepare_friction<T: Tile>(
        &mut self,
        index: usize,
        lane: usize,
        patch: &Patch<T, P>,
        (contacts, rolling_resistance): (&ContactLanes<'_>, T),
    ) {
        let zero = T::splat(0.0);
        let Patch { weights, total, .. } = *patch;
        let block = &mut self.blocks.blocks[index];
        let frame = ContactFrame::<T>::load(block, lane);
        let mut radius = zero;
        if P > 1 {
            let (mut sum, mut j) = (zero, 0);
            while j < P {
                let offset = &block.points[j].offset;
                let (a, b): (T, T) = (at(&offset[0], lane), at(&offset[1], lane));
                // Of a point that is not there anything may be written, also what has no square.
                sum = sum + T::select(zero.lt(weights[j]), (a * a + b * b).sqrt() * weights[j], zero);
                j += 1;
            }
            let mean = sum / total.max(T::splat(1.0));
            let patch = T::select(T::splat(2.0).lt(total), mean * T::splat(FACE), mean);
            radius = T::select(T::splat(1.0 + 1e-6).lt(total), patch, zero);
        }
        put(radius, &mut block.friction.radius, lane);
        let NormalImpulses { static_friction, dynamic_friction, steady, .. } = contacts.normal_impulses::<T>();
        put(static_friction, &mut block.friction.limits[0], lane);
        put(dynamic_friction, &mut block.friction.limits[1], lane);

        let WorldFriction { linear, angular, .. } = contacts.friction();
        if let Some(rolling) = self.blocks.rolling.get_mut(index) {
            put(rolling_resistance, &mut rolling.length, lane);
        }
        let friction = FrictionImpulse::from_world(&frame, linear, angular)
            .of_what_rolls(rolling_resistance)
            .scaled(warm_start_factor(steady));
        friction.store(&mut block.friction, self.blocks.rolling.get_mut(index), lane);
        put(zero, &mut block.start.lead, lane);
        let locks = TileLocks::of(self.blocks.locks, index, lane);
        accumulate_warm_start(block, (&frame, locks), &friction, &mut self.bodies.warm_start, (index, lane));
    }
}

/// The points of a contact, weighted by how near they are.
struct Patch<T, const P: usize> {
    middle: Vec3<T>,
    weights: [T; P],
    /// Sum of the weights.
    total: T,
}

impl<T: Tile, const P: usize> Patch<T, P> {
    /// Of points at these places with these separations, of which the first `count` are there.
    #[inline(always)]
    fn of((places, separations): (&[Vec3<T>; 4], &[T; 4]), count: T, margin: T, is_fixed: T::Mask) -> Self {
        // A point that comes into reach has no weight yet, so the middle does not jump. A patch is
        // made of the nearest.
        let (zero, one) = (T::splat(0.0), T::splat(1.0));
        let inverse_margin = one / margin;
        let (mut nearest, mut j) = (separations[0], 1);
        while j < P {
            nearest = nearest.min(T::select(T::splat(j as f64).lt(count), separations[j], nearest));
            j += 1;
        }
        let nearest = nearest.max(zero);
        // Of what is round and far from all its points, the nearest have the middle; a box would be
        // spun by it in an impact.
        let from = T::select(is_fixed, zero, nearest);
        let (mut sum, mut total) = (Vec3::zero(), zero);
        let (mut of_patch, mut weights) = (zero, [zero; P]);
        let mut j = 0;
        while j < P {
            let is_point = T::splat(j as f64).lt(count);
            let weight = T::splat(2.0) - (separations[j] - from) * inverse_margin;
            let weight = T::select(is_point, weight.max(T::splat(MIN_WEIGHT)).min(one), zero);
            sum = sum + places[j] * weight;
            total = total + weight;
            let weight = T::splat(2.0) - (separations[j] - nearest) * inverse_margin;
            weights[j] = T::select(is_point, weight.max(T::splat(MIN_WEIGHT)).min(one), zero);
            of_patch = of_patch + weights[j];
            j += 1;
        }
        let middle = sum * T::select(zero.lt(total), one / total, zero);
        Self { middle, weights, total: of_patch }
    }
}

/// The contacts in the lanes of a tile.
#[inline(always)]
fn pick<'a, T: Tile, const P: usize, const C: usize>(
    contacts: &'a [ContactRecord],
    block: &Block<P, C>,
    lane: usize,
) -> ContactLanes<'a> {
    let mut picked = ContactLanes::empty();
    let mut i = 0;
    while i < T::WIDTH && lane + i < block.count {
        picked.set(i, &contacts[block.contacts[lane + i] as usize]);
        i += 1;
    }
    picked
}
