//! Rows that lie anywhere in a table: as tiles, and changed by threads at the same time, each its
//! own. What makes that sound is checked when the rows are listed.

#![allow(
    unsafe_code,
    reason = "rows that are checked when they are listed, and a shared pointer; see the SAFETY notes"
)]

use std::marker::PhantomData;
use std::ops::Range;

use crate::math::Real;

use super::{BLOCK, Octet, Tile, gather_rows, scatter_rows, store_rows};

/// Rows anywhere in a table.
///
/// # Panics
/// Where there is no such row.
#[inline(always)]
pub(crate) fn gather<T: Tile, R: Octet>(table: &[R], indices: &[u32; BLOCK], lane: usize) -> R::Lanes<T> {
    assert!(greatest::<T>(indices, lane) < table.len());
    let mut rows = [R::zero(); BLOCK];
    let mut i = 0;
    while i < T::WIDTH {
        // SAFETY: no index is greater than the greatest, and all rows of a slice may be read.
        rows[i] = unsafe { &*table.as_ptr().add(indices[lane + i] as usize) };
        i += 1;
    }
    gather_rows(&rows)
}

/// Rows of the table that begins at `base`, by the [places](place) of their first numbers.
///
/// # Safety
/// The rows that a tile asks for are there and may be read.
#[inline(always)]
unsafe fn gather_from<T: Tile, R: Octet>(base: *const R, places: &[u32; BLOCK], lane: usize) -> R::Lanes<T> {
    let mut rows = [R::zero(); BLOCK];
    let mut i = 0;
    while i < T::WIDTH {
        // SAFETY: the caller's promise.
        rows[i] = unsafe { &*base.cast::<Real>().add(places[lane + i] as usize).cast() };
        i += 1;
    }
    gather_rows(&rows)
}

/// Where the first number of a row is among all: an address follows from it without a shift.
///
/// # Panics
/// Where there are more rows than have one.
fn place(row: u32) -> u32 {
    assert!(row <= u32::MAX / 8, "there is no place for row {row}");
    8 * row
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

/// Blocks of pairs of rows, in colors: within a color no row that is changed occurs twice.
#[derive(Clone, Debug, Default)]
pub(crate) struct RowColors {
    blocks: Vec<RowPairs>,
    colors: Vec<RowColor>,
    /// By row that may be changed, the last color in which it is.
    last: Vec<usize>,
    /// One more than the greatest row that is listed.
    end: usize,
}

/// The pairs of rows of a block.
#[derive(Clone, Copy, Debug)]
struct RowPairs {
    /// The [places](place) of the first and of the second rows.
    places: [[u32; BLOCK]; 2],
    /// How many lanes have a pair of their own; the others are not changed.
    count: usize,
}

#[derive(Clone, Debug)]
struct RowColor {
    /// Whether the first rows are only read.
    has_non_dynamic: bool,
    blocks: Range<usize>,
}

impl RowColors {
    /// No blocks, of rows of which the first `changing` may be changed, but for the last of these:
    /// it stands for no row.
    pub(crate) fn reset(&mut self, changing: usize) {
        self.blocks.clear();
        self.colors.clear();
        self.last.clear();
        self.last.resize(changing, usize::MAX);
        // The row that stands for none is listed wherever a block is not full.
        self.end = changing;
    }

    /// Begins a color. Where it is `has_non_dynamic`, the first rows of its pairs are ones that are
    /// never changed, else both are changed.
    pub(crate) fn begin(&mut self, has_non_dynamic: bool) {
        let end = self.blocks.len();
        self.colors.push(RowColor { has_non_dynamic, blocks: end..end });
    }

    /// Adds a block of pairs, as many as it has room for, to the color that was begun last.
    ///
    /// # Panics
    /// Where a row that is changed was in this color before, or a row is not of the kind that the
    /// color is for: the threads would not be safe from each other.
    pub(crate) fn push(&mut self, pairs: impl Iterator<Item = [u32; 2]>) {
        let nobody = self.last.len() - 1;
        let mut block = RowPairs { places: [[place(nobody as u32); BLOCK]; 2], count: 0 };
        let index = self.colors.len() - 1;
        let color = &mut self.colors[index];
        for [first, second] in pairs.take(BLOCK) {
            let changed = if color.has_non_dynamic { &[second][..] } else { &[first, second][..] };
            for row in changed {
                assert!((*row as usize) < nobody, "row {row} is not to be changed");
                let last = std::mem::replace(&mut self.last[*row as usize], index);
                assert!(last != index, "row {row} is changed twice in a color");
            }
            assert!(!color.has_non_dynamic || first as usize > nobody, "row {first} is only read, but may be changed");
            self.end = self.end.max(first.max(second) as usize + 1);
            (block.places[0][block.count], block.places[1][block.count]) = (place(first), place(second));
            block.count += 1;
        }
        self.blocks.push(block);
        color.blocks.end += 1;
    }

    /// The blocks of a color, to change rows with.
    ///
    /// # Panics
    /// Where there are fewer rows than may be changed.
    pub(crate) fn rows<'a, R: Octet>(&'a self, color: usize, rows: &'a mut [R]) -> Rows<'a, R> {
        assert!(rows.len() >= self.last.len(), "too few rows");
        let RowColor { has_non_dynamic, blocks } = self.colors[color].clone();
        Rows {
            blocks: &self.blocks[blocks],
            has_non_dynamic,
            base: rows.as_mut_ptr(),
            count: rows.len(),
            end: self.end,
            rows: PhantomData,
        }
    }
}

/// Some of the blocks of one color: nothing else has access to the rows that they change, and
/// nothing changes those that they only read.
pub(crate) struct Rows<'a, R> {
    blocks: &'a [RowPairs],
    has_non_dynamic: bool,
    base: *mut R,
    /// How many rows there are: those that may be changed at the least.
    count: usize,
    /// One more than the greatest row that is listed.
    end: usize,
    rows: PhantomData<&'a mut [R]>,
}

// SAFETY: blocks of one color change different rows, and each block is in one `Rows`: it is made
// from the only reference and split into disjoint parts. Rows that are only read may be shared.
unsafe impl<R: Send + Sync> Send for Rows<'_, R> {}

impl<R: Octet> Rows<'_, R> {
    /// The first `middle` blocks, and the others.
    pub(crate) fn split_at(self, middle: usize) -> (Self, Self) {
        let (first, second) = self.blocks.split_at(middle);
        (Self { blocks: first, ..self }, Self { blocks: second, ..self })
    }

    /// Whether no lane of a block has a pair from `lane` on.
    #[inline(always)]
    pub(crate) fn is_empty(&self, block: usize, lane: usize) -> bool {
        self.blocks[block].count <= lane
    }

    /// Whether the first rows are only read.
    #[inline(always)]
    pub(crate) fn has_non_dynamic(&self) -> bool {
        self.has_non_dynamic
    }

    /// The first or the second rows of a tile from `lane` on. Lanes without a pair have the row
    /// that stands for none, which nothing changes.
    ///
    /// # Panics
    /// Where the first rows are only read, and there are fewer rows than are listed.
    #[inline(always)]
    pub(crate) fn gather<T: Tile>(&self, block: usize, which: usize, lane: usize) -> R::Lanes<T> {
        assert!(which == 1 || !self.has_non_dynamic || self.end <= self.count);
        // SAFETY: rows that may be changed are there, as was checked when they were listed and this
        // was made. Nothing changes these rows: see the type; nor the one that stands for none.
        unsafe { gather_from(self.base, &self.blocks[block].places[which], lane) }
    }

    /// Those of both in a table beside this one.
    ///
    /// # Panics
    /// Where it has fewer rows than are listed.
    #[inline(always)]
    pub(crate) fn gather_beside<T: Tile, S: Octet>(&self, table: &[S], block: usize, lane: usize) -> [S::Lanes<T>; 2] {
        assert!(self.end <= table.len());
        let [first, second] = &self.blocks[block].places;
        // SAFETY: no row that is listed is beyond the end, and all rows of a slice may be read.
        unsafe { [gather_from(table.as_ptr(), first, lane), gather_from(table.as_ptr(), second, lane)] }
    }

    /// Overwrites the first or the second rows of a tile from `lane` on. First rows that are only
    /// read stay as they are, and so does the row that stands for none.
    #[inline(always)]
    pub(crate) fn scatter<T: Tile>(&mut self, lanes: R::Lanes<T>, block: usize, which: usize, lane: usize) {
        let RowPairs { places, count } = &self.blocks[block];
        let base: *mut Real = self.base.cast();
        let count = if self.has_non_dynamic && which == 0 { 0 } else { *count };
        let mut aside = [R::ZERO; BLOCK];
        if lane + T::WIDTH <= count {
            let mut all = aside.each_mut();
            let mut i = 0;
            while i < T::WIDTH {
                // SAFETY: rows that may be changed are there, as was checked when they were listed
                // and this was made; none is listed twice, and nothing else has access.
                all[i] = unsafe { &mut *base.add(places[which][lane + i] as usize).cast() };
                i += 1;
            }
            return scatter_rows::<T, R>(lanes, &mut all);
        }
        store_rows::<T, R>(lanes, &mut aside);
        let mut i = 0;
        while i < T::WIDTH && lane + i < count {
            // SAFETY: as before.
            unsafe { *base.add(places[which][lane + i] as usize).cast() = aside[i] };
            i += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Real;
    use crate::simd::record::sample::Sample;

    fn colors() -> RowColors {
        let mut colors = RowColors::default();
        // Rows 0 to 2 may be changed, 3 stands for none, those from 4 on are only read.
        colors.reset(4);
        colors
    }

    #[test]
    fn rows_are_changed_once_a_color() {
        let mut colors = colors();
        colors.begin(false);
        colors.push([[0, 1]].into_iter());
        colors.begin(true);
        colors.push([[4, 1], [4, 2]].into_iter());
        let mut rows = [1.0, 2.0, 3.0, 4.0, 5.0].map(Sample::of);
        let mut of_color = colors.rows(1, &mut rows);
        assert_eq!(of_color.gather::<Real>(0, 1, 1).number, 3.0);
        of_color.scatter::<Real>(Sample::of(9.0), 0, 1, 1);
        of_color.scatter::<Real>(Sample::of(9.0), 0, 0, 0);
        // A lane without a pair.
        of_color.scatter::<Real>(Sample::of(9.0), 0, 1, 5);
        assert_eq!(rows.map(|row| row.number), [1.0, 2.0, 9.0, 4.0, 5.0]);
    }

    /// A color of blocks of one pair each.
    fn push_each(has_non_dynamic: bool, pairs: &[[u32; 2]]) {
        let mut colors = colors();
        colors.begin(has_non_dynamic);
        pairs.iter().for_each(|pair| colors.push([*pair].into_iter()));
    }

    #[test]
    #[should_panic(expected = "row 1 is changed twice")]
    fn a_row_is_not_changed_twice() {
        push_each(false, &[[0, 1], [1, 2]]);
    }

    #[test]
    #[should_panic(expected = "row 2 is only read")]
    fn what_is_only_read_is_never_changed() {
        push_each(true, &[[2, 1]]);
    }

    #[test]
    #[should_panic(expected = "row 3 is not to be changed")]
    fn what_stands_for_none_is_never_changed() {
        push_each(true, &[[4, 3]]);
    }

    /// The first row in all lanes but the second.
    fn second_is(row: u32) -> [u32; BLOCK] {
        std::array::from_fn(|lane| if lane == 1 { row } else { 0 })
    }

    #[test]
    fn a_row_is_found_where_it_is() {
        let table = [1.0, 2.0, 3.0].map(|x| Sample { number: 10.0 * x, ..Sample::of(x) });
        let found = gather::<Real, _>(&table, &second_is(2), 1);
        assert_eq!((found.vector.x, found.number), (3.0, 30.0));
    }

    #[test]
    #[should_panic(expected = "assertion")]
    fn a_row_that_is_not_there_is_not_read() {
        let _ = gather::<Real, _>(&[Sample::ZERO; 3], &second_is(3), 1);
    }
}
