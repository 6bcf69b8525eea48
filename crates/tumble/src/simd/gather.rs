//! Rows of a table that lie anywhere in it, as tiles.

#![allow(unsafe_code, reason = "one comparison in the place of eight; see the SAFETY note")]

use super::{BLOCK, Octet, Tile, gather_rows};

/// Rows anywhere in a table.
///
/// # Panics
/// Where there is no such row.
#[inline(always)]
pub(crate) fn gather<T: Tile, R: Octet>(table: &[R], indices: &[u32; BLOCK], lane: usize) -> R::Lanes<T> {
    // SAFETY: all rows of a slice may be read.
    unsafe { gather_from(table.as_ptr(), table.len(), indices, lane) }
}

/// The same from a table of `count` rows that begins at `base`.
///
/// # Safety
/// The rows that a tile asks for, where there are any, may be read.
///
/// # Panics
/// Where there is no such row.
#[inline(always)]
pub(super) unsafe fn gather_from<T: Tile, R: Octet>(
    base: *const R,
    count: usize,
    indices: &[u32; BLOCK],
    lane: usize,
) -> R::Lanes<T> {
    assert!(greatest::<T>(indices, lane) < count);
    let mut rows = [R::zero(); BLOCK];
    let mut i = 0;
    while i < T::WIDTH {
        // SAFETY: no index is greater than the greatest; and the caller's promise.
        rows[i] = unsafe { &*base.add(indices[lane + i] as usize) };
        i += 1;
    }
    gather_rows(&rows)
}

/// The greatest index of a tile: one comparison with it is cheaper than one with each.
#[inline(always)]
fn greatest<T: Tile>(indices: &[u32; BLOCK], lane: usize) -> usize {
    let (mut greatest, mut i) = (0, 0);
    while i < T::WIDTH {
        greatest = greatest.max(indices[lane + i]);
        i += 1;
    }
    greatest as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Real;
    use crate::simd::octet::sample::Sample;

    #[test]
    fn a_row_is_found_where_it_is() {
        let table = [1.0, 2.0, 3.0].map(|x| Sample { number: 10.0 * x, ..Sample::of(x) });
        let found = gather::<Real, _>(&table, &[0, 2, 1, 0, 0, 0, 0, 0], 1);
        assert_eq!((found.vector.x, found.number), (3.0, 30.0));
    }

    #[test]
    #[should_panic(expected = "assertion")]
    fn a_row_that_is_not_there_is_not_read() {
        let _ = gather::<Real, _>(&[Sample::ZERO; 3], &[0, 3, 0, 0, 0, 0, 0, 0], 1);
    }
}
