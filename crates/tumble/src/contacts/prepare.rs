use tumble_math::lane::Vec3;

use super::block::Block;
use super::contact::{Contact, HELD, POINTS, RUBBED, SHAPE};
use super::frame::{Bodies, Frame, Response};
use super::passes::{Blocks, Bodied, coupling, hold, speeds};
use super::rows::{Lanes, at, gather_two_vectors, put, put_vector};
use super::rubbing::Rubbing;
use crate::math::Real;
use crate::simd::{BLOCK, Eight, Kernel, Tile};

/// Fills blocks whose lanes know their contacts and rows.
pub(super) struct Prepare<'a, const P: usize, const C: usize> {
    pub(super) blocks: Blocks<'a, P, C>,
    pub(super) contacts: &'a [Contact],
    pub(super) bodies: Bodied<'a>,
    /// Where they are.
    pub(super) poses: &'a [Eight],
    /// How near \[m\] two surfaces are a contact.
    pub(super) margin: Real,
}

/// Weight of a point in the middle at the least, so that a middle there is.
const LEAST_WEIGHT: f64 = 1e-10;
/// Mean distance from the middle of a square under even pressure, over that of its corners: 0.3826 and 0.7071 of the side.
const FACE: f64 = 0.541;

impl<const P: usize, const C: usize> Kernel for Prepare<'_, P, C> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.blocks.blocks.len() * BLOCK
    }

    #[inline(always)]
    fn tile<T: Tile>(&mut self, i: usize) {
        let (index, lane) = (i / BLOCK, i % BLOCK);
        let (zero, one) = (T::splat(0.0), T::splat(1.0));
        let block = &mut self.blocks.blocks[index];
        let [nx, ny, nz, carried, count, rolling, restitution] = pick(self.contacts, block, SHAPE, lane);
        let normal = Vec3::new(nx, ny, nz);
        let tangents = tangents(normal);
        let [ax, ay, az, s0, bx, by, bz, s1] = pick(self.contacts, block, POINTS[0], lane);
        let [cx, cy, cz, s2, dx, dy, dz, s3] = pick(self.contacts, block, POINTS[1], lane);
        let places = [Vec3::new(ax, ay, az), Vec3::new(bx, by, bz), Vec3::new(cx, cy, cz), Vec3::new(dx, dy, dz)];
        let separations = [s0, s1, s2, s3];

        // A point that comes into reach has no weight yet, so the middle does not jump.
        let inverse_margin = T::splat(1.0 / f64::from(self.margin));
        let (mut sum, mut total) = (Vec3::zero(), zero);
        let mut j = 0;
        while j < P {
            let weight = T::splat(2.0) - separations[j] * inverse_margin;
            let weight = weight.max(T::splat(LEAST_WEIGHT)).min(one);
            let weight = T::select(T::splat(j as f64).lt(count), weight, zero);
            sum = sum + places[j] * weight;
            total = total + weight;
            j += 1;
        }
        let arm = sum * T::select(zero.lt(total), one / total, zero);
        put_vector(normal, &mut block.normal, lane);
        put_vector(tangents[0], &mut block.tangent, lane);
        put_vector(arm, &mut block.arm, lane);
        put(carried, &mut block.carried, lane);
        let rows = self.bodies.motion.pairs(index);
        let (first, _) = gather_two_vectors::<T>(self.poses, &rows[0], lane);
        let (second, _) = gather_two_vectors::<T>(self.poses, &rows[1], lane);
        put_vector(second - first, &mut block.apart, lane);
        let mut j = 0;
        while j < P {
            let from_middle = places[j] - arm;
            put(tangents[0].dot(from_middle), &mut block.points[j].offset[0], lane);
            put(tangents[1].dot(from_middle), &mut block.points[j].offset[1], lane);
            put(separations[j], &mut block.points[j].separation, lane);
            j += 1;
        }

        let response = Response::<T>::load(self.bodies.response, self.bodies.motion.pairs(index), lane);
        let bodies = Bodies::<T>::load(&self.bodies.motion, index, lane);
        let answers = response.of_what_moves(self.bodies.motion.is_grounded());
        put(bodies.least_size(&answers), &mut self.blocks.blocks[index].followed, lane);
        self.couple(index, lane, count, &answers, bodies.inverse_mass());
        self.prepare_friction(index, lane, (count, rolling), &answers, bodies.inverse_mass());
        self.prepare_bounce(index, lane, restitution, (&bodies, &response));
    }
}

impl<const P: usize, const C: usize> Prepare<'_, P, C> {
    /// Works out what impulses at the points do to the velocities there.
    #[inline(always)]
    fn couple<T: Tile>(&mut self, index: usize, lane: usize, count: T, response: &Response<T>, inverse_mass: T) {
        let (zero, one) = (T::splat(0.0), T::splat(1.0));
        let block = &mut self.blocks.blocks[index];
        let frame = Frame::<T>::load(block, lane);
        let levers = [frame.arms.first[0].cross(frame.normal), frame.arms.first[1].cross(frame.normal)];
        let mut turnings = [levers; P];
        let mut j = 0;
        while j < P {
            let offset = &block.points[j].offset;
            let (a, b) = (at(&offset[0], lane), at(&offset[1], lane));
            let from_middle = frame.tangents[0] * b - frame.tangents[1] * a;
            turnings[j] = [levers[0] + from_middle, levers[1] + from_middle];
            j += 1;
        }
        let [h0, h1, h2, h3]: [T; 4] = pick(self.contacts, block, HELD, lane);
        let held = [h0, h1, h2, h3];
        let mut j = 0;
        while j < P {
            let responses = [response.of_first(turnings[j][0]), response.of_second(turnings[j][1])];
            let mut k = j;
            while k < P {
                let turning = turnings[k][0].dot(responses[0]) + turnings[k][1].dot(responses[1]);
                let between = inverse_mass + turning;
                if k == j {
                    let there = T::select(T::splat(j as f64).lt(count), between, zero);
                    let mass = T::select(zero.lt(there), one / between, zero);
                    put(mass, &mut block.points[j].mass, lane);
                    put(held[j], &mut block.points[j].impulse, lane);
                } else {
                    put(between, &mut block.couplings[coupling::<P>(j, k)], lane);
                }
                k += 1;
            }
            j += 1;
        }
    }

    /// Notes how fast the bodies come together now.
    #[inline(always)]
    fn prepare_bounce<T: Tile>(
        &mut self,
        index: usize,
        lane: usize,
        restitution: T,
        (bodies, response): (&Bodies<T>, &Response<T>),
    ) {
        let block = &self.blocks.blocks[index];
        let Some(bounce) = self.blocks.bounces.get_mut(index) else { return };
        let frame = Frame::load(block, lane);
        let speeds = speeds(block, lane, frame.normal_parts(&bodies.relative(response, frame.arms.first)));
        put(restitution, &mut bounce.restitution, lane);
        let mut j = 0;
        while j < P {
            put(speeds[j], &mut bounce.approach[j], lane);
            put(speeds[j], &mut bounce.before[j], lane);
            put(T::splat(0.0), &mut bounce.most_impulse[j], lane);
            j += 1;
        }
    }

    /// Works out what friction in the middle does, and begins with what it did.
    #[inline(always)]
    fn prepare_friction<T: Tile>(
        &mut self,
        index: usize,
        lane: usize,
        (count, length): (T, T),
        response: &Response<T>,
        inverse_mass: T,
    ) {
        let (zero, one) = (T::splat(0.0), T::splat(1.0));
        let block = &mut self.blocks.blocks[index];
        let frame = Frame::<T>::load(block, lane);
        let [s, t] = frame.tangents;
        let arms = frame.arms.first;
        let (s_first, t_first) = (arms[0].cross(s), arms[0].cross(t));
        let (s_second, t_second) = (arms[1].cross(s), arms[1].cross(t));
        let (of_s, of_t) = (response.of_first(s_first), response.of_second(s_second));
        let ss = inverse_mass + s_first.dot(of_s) + s_second.dot(of_t);
        let st = t_first.dot(of_s) + t_second.dot(of_t);
        let tt = inverse_mass + t_first.dot(response.of_first(t_first)) + t_second.dot(response.of_second(t_second));
        put_all(inverse([ss, st, tt]), &mut block.friction.mass, lane);

        let n = frame.normal;
        let about_normal = n.dot(response.of_first(n)) + n.dot(response.of_second(n));
        let twisting_mass = T::select(zero.lt(about_normal), one / about_normal, zero);
        put(twisting_mass, &mut block.friction.twisting_mass, lane);
        let mut radius = zero;
        if P > 1 {
            let (mut sum, mut j) = (zero, 0);
            while j < P {
                let offset = &block.points[j].offset;
                let (a, b): (T, T) = (at(&offset[0], lane), at(&offset[1], lane));
                let distance = (a * a + b * b).sqrt();
                sum = sum + T::select(T::splat(j as f64).lt(count), distance, zero);
                j += 1;
            }
            let mean = sum / count.max(one);
            radius = T::select(T::splat(2.0).lt(count), mean * T::splat(FACE), mean);
        }
        put(radius, &mut block.friction.radius, lane);
        let [_, _, _, _, fixed, sliding]: [T; 6] = pick(self.contacts, block, HELD, lane);
        put(fixed, &mut block.friction.limits[0], lane);
        put(sliding, &mut block.friction.limits[1], lane);

        let [p, q, r, u, v, w] = pick(self.contacts, block, RUBBED, lane);
        let (linear, angular) = (Vec3::new(p, q, r), Vec3::new(u, v, w));
        if let Some(rolling) = self.blocks.rolling.get_mut(index) {
            put(length, &mut rolling.length, lane);
            let (s_first, t_first) = (response.of_first(s), response.of_first(t));
            let (s_second, t_second) = (response.of_second(s), response.of_second(t));
            let (ss, tt) = (s.dot(s_first) + s.dot(s_second), t.dot(t_first) + t.dot(t_second));
            put_all(inverse([ss, t.dot(s_first) + t.dot(s_second), tt]), &mut rolling.mass, lane);
        }
        let kept = Rubbing::from_world(&frame, linear, angular).of_what_rolls(length);
        kept.store(&mut block.friction, self.blocks.rolling.get_mut(index), lane);
        hold(block, (&frame, arms), &kept, &mut self.bodies.held, (index, lane));
    }
}

/// Some of the numbers of a tile's contacts.
#[inline(always)]
fn pick<T: Tile, const P: usize, const C: usize, const N: usize>(
    contacts: &[Contact],
    block: &Block<P, C>,
    which: usize,
    lane: usize,
) -> [T; N] {
    let mut picked = [&Eight::ZERO; BLOCK];
    let mut i = 0;
    while i < T::WIDTH && lane + i < block.count {
        picked[i] = &contacts[block.contacts[lane + i] as usize].numbers[which];
        i += 1;
    }
    T::gather(&picked)
}

/// Two unit vectors, each perpendicular to the other and to `n`: the first as near as it can be to the axis that `n` is farthest from.
#[inline(always)]
fn tangents<T: Tile>(n: Vec3<T>) -> [Vec3<T>; 2] {
    let (zero, one) = (T::splat(0.0), T::splat(1.0));
    let (x, y, z) = (n.x.abs(), n.y.abs(), n.z.abs());
    let least = z.min(y);
    let y_axis = Vec3::new(zero, one, zero);
    let axis = Vec3::select(z.lt(y), Vec3::new(zero, zero, one), y_axis);
    let axis = Vec3::select(least.lt(x), axis, Vec3::new(one, zero, zero));
    let across = axis - n * n.dot(axis);
    let first = across * (one / across.dot(across).sqrt());
    [first, n.cross(first)]
}

/// Inverse of a symmetric 2x2 matrix `xx, xy, yy` with positive eigenvalues; zero where it has none. Without its determinant, which has the square of the masses in it: a moon's is no number
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

#[inline(always)]
fn put_all<T: Tile>([a, b, c]: [T; 3], numbers: &mut [Lanes; 3], lane: usize) {
    put_vector(Vec3::new(a, b, c), numbers, lane);
}
