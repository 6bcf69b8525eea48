//! Effective masses of contacts: what impulses at them do to the velocities there.

use tumble_math::lane::Vec3;

use crate::simd::Tile;
use crate::simd::block_lanes::{Lanes, at, put};
use crate::solver::contact::constraint::{Block, Rolling};
use crate::solver::contact::contact_frame::{ContactFrame, InverseInertias, TileLocks};
use crate::solver::contact::solve::coupling;

/// How the bodies of a tile's contacts answer to impulses.
pub(crate) struct Mobility<'a, T> {
    /// Inverse inertias, zero for non-dynamic bodies.
    pub(crate) inv_inertia: InverseInertias<T>,
    /// Sum of the inverse masses [1/kg].
    pub(crate) inverse_mass: T,
    /// The same of each, zero for non-dynamic bodies.
    pub(crate) inverse_masses: [T; 2],
    pub(crate) locks: TileLocks<'a>,
}

/// A body answers to impulses along a normal where it does at least this part of what it would
/// without locks: within six degrees of a locked axis it would be moved nine times as far sideways.
const MIN_FREE: f64 = 0.01;

/// Of a matrix of trace one that answers in two directions.
const MIN_DETERMINANT: f64 = 1e-5;

impl<T: Tile> Mobility<'_, T> {
    /// The velocity along a unit vector that translation has of a unit impulse along it [1/kg].
    #[inline(always)]
    fn along(&self, n: Vec3<T>) -> T {
        match self.locks.load() {
            Some(locks) => {
                let (one, [first, second]) = (T::splat(1.0), self.inverse_masses);
                first * (one - n.dot(n.scale(locks[0]))) + second * (one - n.dot(n.scale(locks[1])))
            }
            None => self.inverse_mass,
        }
    }

    /// That of a contact along its normal, of a unit impulse at a point; `turning` is what the
    /// rotation of both bodies adds.
    #[inline(always)]
    fn at_point(&self, n: Vec3<T>, turning: [T; 2]) -> T {
        let Some(locks) = self.locks.load::<T>() else {
            return self.inverse_mass + (turning[0] + turning[1]);
        };
        let (zero, one, least) = (T::splat(0.0), T::splat(1.0), T::splat(MIN_FREE));
        let mut sum = zero;
        let mut which = 0;
        while which < 2 {
            let free = (one - n.dot(n.scale(locks[which]))) * self.inverse_masses[which] + turning[which];
            sum = sum + T::select((self.inverse_masses[which] * least).lt(free), free, zero);
            which += 1;
        }
        sum
    }

    /// The velocity along the second of two orthogonal unit vectors that translation has of a unit
    /// impulse along the first.
    #[inline(always)]
    fn across(&self, s: Vec3<T>, t: Vec3<T>) -> T {
        match self.locks.load() {
            Some(locks) => {
                let [first, second] = self.inverse_masses;
                -(s.dot(t.scale(locks[0])) * first + s.dot(t.scale(locks[1])) * second)
            }
            None => T::splat(0.0),
        }
    }

    /// Inverse of a symmetric 2x2 matrix `xx, xy, yy`: where locked axes leave one direction that
    /// answers, within that.
    #[inline(always)]
    fn inverse(&self, [a, b, c]: [T; 3]) -> [T; 3] {
        let whole = inverse([a, b, c]);
        if !self.locks.are_there() {
            return whole;
        }
        let (zero, one) = (T::splat(0.0), T::splat(1.0));
        let scale = T::select(zero.lt(a + c), one / (a + c), zero);
        let [x, y, z] = [a * scale, b * scale, c * scale];
        let is_one = (x * z - y * y).lt(T::splat(MIN_DETERMINANT));
        let in_one = [x * scale, y * scale, z * scale];
        let mut chosen = whole;
        let mut i = 0;
        while i < chosen.len() {
            chosen[i] = T::select(is_one, in_one[i], whole[i]);
            i += 1;
        }
        chosen
    }
}

/// Which part of the impulses a substep begins with where effective masses are this steady: none
/// where they have changed by more than a sixteenth. Impulses of a body that turned under them
/// would do something else: a rod that slaps the ground would take off.
#[inline(always)]
pub(crate) fn warm_start_factor<T: Tile>(steady: T) -> T {
    let one = T::splat(1.0);
    (one - (one - steady) * T::splat(16.0)).max(T::splat(0.0))
}

/// Computes the effective masses of a tile where `changed` is above zero. A point without mass
/// keeps none. Returns how steady they are: one less the greatest relative change, but not below
/// zero.
#[inline(always)]
pub(crate) fn compute<T: Tile, const P: usize, const C: usize>(
    block: &mut Block<P, C>,
    rolling: Option<&mut Rolling>,
    lane: usize,
    mobility: &Mobility<'_, T>,
    changed: T,
) -> T {
    let frame = ContactFrame::<T>::load(block, lane);
    let change = of_points(block, lane, &frame, mobility, changed);
    let change = change.max(of_friction(block, rolling, lane, &frame, mobility, changed));
    let (zero, one) = (T::splat(0.0), T::splat(1.0));
    T::select(zero.lt(changed), (one - change).max(zero), one)
}

#[inline(always)]
fn of_points<T: Tile, const P: usize, const C: usize>(
    block: &mut Block<P, C>,
    lane: usize,
    frame: &ContactFrame<T>,
    mobility: &Mobility<'_, T>,
    changed: T,
) -> T {
    let (zero, one) = (T::splat(0.0), T::splat(1.0));
    let (inv_inertia, moving) = (&mobility.inv_inertia, mobility.along(frame.normal));
    let mut most = zero;
    let levers = [frame.arms[0].cross(frame.normal), frame.arms[1].cross(frame.normal)];
    let mut turnings = [levers; P];
    let mut j = 0;
    while j < P {
        let offset = &block.points[j].offset;
        let (a, b) = (at(&offset[0], lane), at(&offset[1], lane));
        let from_middle = frame.tangents[0] * b - frame.tangents[1] * a;
        turnings[j] = [levers[0] + from_middle, levers[1] + from_middle];
        j += 1;
    }
    let mut j = 0;
    while j < P {
        let responses = [inv_inertia.of_first(turnings[j][0]), inv_inertia.of_second(turnings[j][1])];
        let mut k = j;
        while k < P {
            let turning = [turnings[k][0].dot(responses[0]), turnings[k][1].dot(responses[1])];
            if k == j {
                let between = mobility.at_point(frame.normal, turning);
                let before: T = at(&block.points[j].mass, lane);
                let there = T::select(zero.lt(before), between, zero);
                let mass = T::select(zero.lt(there), one / between, zero);
                let ratio = (mass * one / before).max(before * between);
                most = T::select(zero.lt(there), most.max(ratio - one), most);
                put_where(changed, mass, &mut block.points[j].mass, lane);
            } else {
                let between = moving + (turning[0] + turning[1]);
                put_where(changed, between, &mut block.couplings[coupling::<P>(j, k)], lane);
            }
            k += 1;
        }
        j += 1;
    }
    most
}

#[inline(always)]
fn of_friction<T: Tile, const P: usize, const C: usize>(
    block: &mut Block<P, C>,
    rolling: Option<&mut Rolling>,
    lane: usize,
    frame: &ContactFrame<T>,
    mobility: &Mobility<'_, T>,
    changed: T,
) -> T {
    let inv_inertia = &mobility.inv_inertia;
    let (zero, one) = (T::splat(0.0), T::splat(1.0));
    let ([s, t], [first, second]) = (frame.tangents, frame.arms);
    let (s_first, t_first) = (first.cross(s), first.cross(t));
    let (s_second, t_second) = (second.cross(s), second.cross(t));
    let (s_on_first, s_on_second) = (inv_inertia.of_first(s_first), inv_inertia.of_second(s_second));
    let ss = mobility.along(s) + s_first.dot(s_on_first) + s_second.dot(s_on_second);
    let st = mobility.across(s, t) + t_first.dot(s_on_first) + t_second.dot(s_on_second);
    let (t_on_first, t_on_second) = (inv_inertia.of_first(t_first), inv_inertia.of_second(t_second));
    let tt = mobility.along(t) + t_first.dot(t_on_first) + t_second.dot(t_on_second);
    let m = &block.friction.mass;
    let before: [T; 3] = [at(&m[0], lane), at(&m[1], lane), at(&m[2], lane)];
    let mass = mobility.inverse([ss, st, tt]);
    let [of_ss, of_st, of_tt] = [mass[0] - before[0], mass[1] - before[1], mass[2] - before[2]];
    let change = of_ss.abs().max(of_tt.abs()).max(of_st.abs()) / (mass[0] + mass[2]);
    put_all_where(changed, mass, &mut block.friction.mass, lane);

    let n = frame.normal;
    let about_normal = n.dot(inv_inertia.of_first(n)) + n.dot(inv_inertia.of_second(n));
    let twisting_mass = T::select(zero.lt(about_normal), one / about_normal, zero);
    put_where(changed, twisting_mass, &mut block.friction.twisting_mass, lane);
    if P > 1 {
        let couplings = [n.dot(s_on_first + s_on_second), n.dot(t_on_first + t_on_second)];
        put_where(changed, couplings[0], &mut block.friction.twist_couplings[0], lane);
        put_where(changed, couplings[1], &mut block.friction.twist_couplings[1], lane);
    }

    if let Some(rolling) = rolling {
        let (s_first, t_first) = (inv_inertia.of_first(s), inv_inertia.of_first(t));
        let (s_second, t_second) = (inv_inertia.of_second(s), inv_inertia.of_second(t));
        let (ss, tt) = (s.dot(s_first) + s.dot(s_second), t.dot(t_first) + t.dot(t_second));
        let mass = mobility.inverse([ss, t.dot(s_first) + t.dot(s_second), tt]);
        put_all_where(changed, mass, &mut rolling.mass, lane);
    }
    T::select(zero.lt(change), change, zero)
}

/// Inverse of a symmetric 2x2 matrix `xx, xy, yy` with positive eigenvalues; zero where it has
/// none. Without its determinant, which has the square of the masses in it: a moon's is no number
/// in single precision.
#[inline(always)]
fn inverse<T: Tile>([a, b, c]: [T; 3]) -> [T; 3] {
    let (zero, one) = (T::splat(0.0), T::splat(1.0));
    let ratio = b / a;
    let left = c - b * ratio;
    let there = zero.lt(T::select(zero.lt(a), left, zero));
    let yy = one / left;
    let xy = -ratio * yy;
    [T::select(there, one / a - ratio * xy, zero), T::select(there, xy, zero), T::select(there, yy, zero)]
}

/// Overwrites numbers where `changed` is above zero.
#[inline(always)]
pub(crate) fn put_where<T: Tile>(changed: T, tile: T, numbers: &mut Lanes, lane: usize) {
    let before = at(numbers, lane);
    put(T::select(T::splat(0.0).lt(changed), tile, before), numbers, lane);
}

#[inline(always)]
fn put_all_where<T: Tile>(changed: T, tiles: [T; 3], numbers: &mut [Lanes; 3], lane: usize) {
    let mut i = 0;
    while i < 3 {
        put_where(changed, tiles[i], &mut numbers[i], lane);
        i += 1;
    }
}
