//! Rows of eight numbers, one row for each body of the solver, and tiles of bodies anywhere among
//! them.

use tumble_math::lane::Vec3;

use crate::math::Real;
use crate::simd::{BLOCK, Eight, Tile, gather};

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

/// Two vectors that are the first six numbers of rows.
#[inline(always)]
pub(crate) fn two_vectors<T: Tile>(rows: &[Eight]) -> (Vec3<T>, Vec3<T>) {
    let [a, b, c, d, e, f] = T::load(rows);
    (Vec3::new(a, b, c), Vec3::new(d, e, f))
}

/// Two vectors that are the first six numbers of rows anywhere in a table.
#[inline(always)]
pub(crate) fn gather_two_vectors<T: Tile>(table: &[Eight], indices: &[u32; BLOCK], lane: usize) -> (Vec3<T>, Vec3<T>) {
    let [a, b, c, d, e, f] = gather(table, indices, lane);
    (Vec3::new(a, b, c), Vec3::new(d, e, f))
}

/// Overwrites the first six numbers of rows.
#[inline(always)]
pub(crate) fn put_two_vectors<T: Tile>(first: Vec3<T>, second: Vec3<T>, rows: &mut [Eight]) {
    T::store([first.x, first.y, first.z, second.x, second.y, second.z], rows);
}
