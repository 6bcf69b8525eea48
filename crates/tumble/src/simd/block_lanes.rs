//! Numbers of the contacts of a block, side by side.

use tumble_math::lane::Vec3;

use crate::math::Real;
use crate::simd::{BLOCK, Tile};

/// One number of each contact of a block.
pub(crate) type Lanes = [Real; BLOCK];

/// The numbers that a tile has from `lane` on.
#[inline(always)]
pub(crate) fn at<T: Tile>(numbers: &Lanes, lane: usize) -> T {
    let [tile] = T::load(&numbers[lane..]);
    tile
}

#[inline(always)]
pub(crate) fn vector_at<T: Tile>(numbers: &[Lanes; 3], lane: usize) -> Vec3<T> {
    Vec3::new(at(&numbers[0], lane), at(&numbers[1], lane), at(&numbers[2], lane))
}

/// Writes the numbers that a tile has from `lane` on.
#[inline(always)]
pub(crate) fn put<T: Tile>(tile: T, numbers: &mut Lanes, lane: usize) {
    T::store([tile], &mut numbers[lane..]);
}

#[inline(always)]
pub(crate) fn put_vector<T: Tile>(vector: Vec3<T>, numbers: &mut [Lanes; 3], lane: usize) {
    put(vector.x, &mut numbers[0], lane);
    put(vector.y, &mut numbers[1], lane);
    put(vector.z, &mut numbers[2], lane);
}
