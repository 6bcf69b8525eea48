//! Contacts of capsules that cross, found again in lanes where their bodies have moved.

use tumble_math::lane::Vec3;

use crate::collision::crossed_axes::CrossedAxes;
use crate::simd::block_lanes::{Lanes, at, put_vector, vector_at};
use crate::simd::{BLOCK, Tile};
use crate::solver::contact::constraint::{Block, Rolling};
use crate::solver::contact::contact_frame::DeltaPoses;
use crate::solver::contact::effective_mass::put_where;
use crate::solver::contact::update_geometry::move_point;

/// Axes nearer than this part of what they are computed from touch: the direction between them is
/// lost.
const TOUCHING: f64 = 1e-5;
/// What a square is at least, for divisions.
const TINY: f64 = 1e-30;

/// Of a block: where contacts have axes.
#[derive(Clone, Copy)]
#[repr(C)]
pub(crate) struct CapsuleAxes {
    /// One where a contact has any, else zero.
    are_there: Lanes,
    middles: [[Lanes; 3]; 2],
    halves: [[Lanes; 3]; 2],
    radii: [Lanes; 2],
    share: Lanes,
}

impl CapsuleAxes {
    pub(crate) const NONE: Self = Self {
        are_there: [0.0; BLOCK],
        middles: [[[0.0; BLOCK]; 3]; 2],
        halves: [[[0.0; BLOCK]; 3]; 2],
        radii: [[0.0; BLOCK]; 2],
        share: [0.0; BLOCK],
    };

    /// Puts those of a contact in a lane.
    pub(crate) fn set(&mut self, lane: usize, axes: &CrossedAxes) {
        self.are_there[lane] = 1.0;
        for which in 0..2 {
            put_vector(axes.middles[which], &mut self.middles[which], lane);
            put_vector(axes.halves[which], &mut self.halves[which], lane);
            self.radii[which][lane] = axes.radii[which];
        }
        self.share[lane] = axes.share;
    }

    /// Moves the contacts of a tile to where the axes are nearest now, with the second body's
    /// centre of mass from the first's \[m\].
    #[inline(always)]
    pub(crate) fn find<T: Tile, const P: usize, const C: usize>(
        &self,
        (block, rolling): (&mut Block<P, C>, Option<&mut Rolling>),
        lane: usize,
        (delta_pose, apart): (&DeltaPoses<T>, Vec3<T>),
    ) {
        let (one, half) = (T::splat(1.0), T::splat(0.5));
        let which: T = at(&self.are_there, lane);
        let [p, q] = delta_pose.rotation;
        let (first, second): (Vec3<T>, Vec3<T>) =
            (vector_at(&self.middles[0], lane), vector_at(&self.middles[1], lane));
        let middles = [p.rotate(first) - apart, q.rotate(second)];
        let (first, second): (Vec3<T>, Vec3<T>) = (vector_at(&self.halves[0], lane), vector_at(&self.halves[1], lane));
        let halves = [p.rotate(first), q.rotate(second)];
        let radii: [T; 2] = [at(&self.radii[0], lane), at(&self.radii[1], lane)];
        let [s, t] = nearest(middles, halves);
        let on_axes = [middles[0] + halves[0] * s, middles[1] + halves[1] * t];
        let between = on_axes[1] - on_axes[0];
        let distance = between.dot(between).sqrt();
        let touching = (halves[0].dot(halves[0]) + halves[1].dot(halves[1])).sqrt() * T::splat(TOUCHING);
        let are_apart = touching.lt(distance);
        let normal = Vec3::select(are_apart, between * (one / distance), vector_at(&block.normal, lane));
        let separation = distance - (radii[0] + radii[1]);
        let half_way = (on_axes[0] + normal * radii[0] + on_axes[1] - normal * radii[1]) * half;
        let place = half_way + normal * (separation * (at::<T>(&self.share, lane) - half));
        // The arm changes in any case.
        put_where(which, T::splat(-1.0), &mut block.start.slide, lane);
        move_point((block, rolling), (which, lane), (normal, separation), [place + apart, place]);
    }
}

/// Within a segment, from -1 to 1.
#[inline(always)]
fn clamped<T: Tile>(x: T) -> T {
    x.max(T::splat(-1.0)).min(T::splat(1.0))
}

/// Where two segments, each given by its middle and from there to its end, are nearest to each
/// other, from -1 to 1 (C. Ericson, "Real-Time Collision Detection", 2005, 5.1.9).
#[inline(always)]
fn nearest<T: Tile>([first, second]: [Vec3<T>; 2], [half, other]: [Vec3<T>; 2]) -> [T; 2] {
    let (zero, tiny) = (T::splat(0.0), T::splat(TINY));
    let apart = first - second;
    let (a, e, b) = (half.dot(half).max(tiny), other.dot(other).max(tiny), half.dot(other));
    let (c, f) = (half.dot(apart), other.dot(apart));
    let determinant = a * e - b * b;
    let s = T::select(zero.lt(determinant), clamped((b * f - c * e) / determinant.max(tiny)), zero);
    let t = clamped((b * s + f) / e);
    [clamped((b * t - c) / a), t]
}

#[cfg(test)]
mod tests {
    use tumble_collide::{ColliderShape, Isometry, contact_manifolds};
    use tumble_math::lane::Quat;

    use super::*;
    use crate::Rng;
    use crate::math::{PRECISION, Real};
    use crate::solver::body_rows::DeltaPose;

    fn vector(rng: &mut Rng, most: Real) -> Vec3<Real> {
        rng.vector(-most, most).into()
    }

    fn rotation(rng: &mut Rng, most: Real) -> Quat<Real> {
        let Vec3 { x, y, z } = vector(rng, most);
        Quat { x, y, z, w: 1.0 }.normalize()
    }

    fn shape(rng: &mut Rng) -> ColliderShape<Real> {
        match (rng.range(0.02, 0.3), rng.range(0.0, 1.0)) {
            (radius, half_height) if half_height < 0.2 => ColliderShape::Sphere { radius },
            (radius, half_height) => ColliderShape::Capsule { radius, half_height },
        }
    }

    /// Capsules and balls at random, whose bodies then move by up to a third of their size and turn
    /// by up to half a radian: as the narrow phase finds them there.
    #[test]
    fn contacts_are_where_the_narrow_phase_finds_them() {
        let (mut rng, mut crossed) = (Rng::new(57), 0);
        for case in 0..4000 {
            let shapes = [shape(&mut rng), shape(&mut rng)];
            let placements =
                [0, 1].map(|_| Isometry { position: vector(&mut rng, 0.2), orientation: rotation(&mut rng, 2.0) });
            let apart = vector(&mut rng, 1.0);
            let deltas = [0, 1].map(|_| DeltaPose {
                translation: vector(&mut rng, 0.3),
                rotation: rotation(&mut rng, 0.15),
                has_turned: 1.0,
            });
            let axes = CrossedAxes::of([&shapes[0], &shapes[1]], placements, [0.05; 2], 0.5);
            let now = apart + deltas[1].translation - deltas[0].translation;
            let [first, second] = [0, 1].map(|which: usize| {
                let turn = deltas[which].rotation;
                let Isometry { position, orientation } = placements[which];
                Isometry { position: turn.rotate(position), orientation: turn * orientation }
            });
            let first = Isometry { position: first.position - now, ..first };
            let mut found = None;
            contact_manifolds(&shapes[0], &first, &shapes[1], &second, 10.0, &mut |_, manifold| {
                found = Some(*manifold);
            });
            let (Some(axes), Some(found)) = (axes, found) else { continue };
            crossed += 1;
            let (mut block, mut all) = (Block::<1, 0>::empty(), CapsuleAxes::NONE);
            all.set(3, &axes);
            all.find::<Real, 1, 0>((&mut block, None), 3, (&DeltaPoses::new(deltas), now));
            // Seen along the normal axes may be parallel that cross: the far end is a point then.
            let nearest = found.points().iter().min_by(|a, b| a.separation.total_cmp(&b.separation));
            let Some(point) = nearest else { panic!("case {case}: no point") };
            let [normal, place]: [Vec3<Real>; 2] = [vector_at(&block.normal, 3), vector_at(&block.arms[1], 3)];
            let first_place: Vec3<Real> = vector_at(&block.arms[0], 3);
            let separation = block.points[0].separation[3];
            // Where axes nearly touch, the direction between them is rounded.
            let rounding = if PRECISION == "f64" { 1e-13 } else { 1e-5 };
            let distance = separation + axes.radii[0] + axes.radii[1];
            let most = rounding * (1.0 + 1.0 / distance);
            let off = |a: Vec3<Real>, b: Vec3<Real>| (a - b).dot(a - b).sqrt();
            assert!((separation - point.separation).abs() < rounding, "case {case}: {separation} {point:?}");
            assert!(off(normal, found.normal) < most, "case {case}: {normal:?} {found:?}");
            let is_one = found.points().len() == 1;
            assert!(!is_one || off(place, point.position) < most, "case {case}: {place:?} {point:?}");
            assert!(off(first_place, place + now) < rounding, "case {case}");
            // What is in another lane stays as it was.
            assert_eq!(block.points[0].separation[2], 0.0);
        }
        assert!(crossed > 3000, "{crossed}");
    }
}
