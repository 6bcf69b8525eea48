//! Bodies that no laws act on, read into the solver a tile at a time.

use std::ops::Range;

use tumble_math::lane::Vec3;

use crate::integrators::clear_range::{are_clearly_in_range, below, size};
use crate::integrators::response_range::responds_in_range;
use crate::integrators::state::{Constants, State};
use crate::math::Real;
use crate::range::{MAX_DISTANCE_OF_CONTACTS, MAX_IMPULSE, MAX_SPEED, is_rotation, within};
use crate::simd::{Kernel, Tile, dispatch_blocks_and_rest, load_rows};
use crate::solver::body_rows::ForceImpulse;
use crate::solver::solver_bodies::{DynamicRows, SolverBodies};
use crate::storage::chunk::Chunk;

/// Reads those bodies of a chunk that are to be read, for substeps of `h` \[s\]; constant forces
/// act on them alone.
pub(crate) fn gather_tiles(
    bodies: &Chunk<'_>,
    are_read: impl Iterator<Item = bool>,
    mut dynamic: DynamicRows<'_>,
    h: Real,
) {
    let mut next = 0;
    let mut run = 0..0;
    for (row, is_read) in are_read.enumerate().chain([(bodies.len(), false)]) {
        if is_read {
            run = if run.is_empty() { row..row + 1 } else { run.start..row + 1 };
        } else if !run.is_empty() {
            let (first, count) = (run.start, run.len());
            dispatch_blocks_and_rest(&mut GatherTiles { bodies, first, count, dynamic: &mut dynamic, next, h });
            next += count;
            run = 0..0;
        }
    }
}

/// Whether a body is where contacts can be found and answers to impulses by numbers in range. It
/// is, unless the caller has changed it since contacts were found.
pub(crate) fn is_in_range(constants: &Constants<Real>, state: &State<Real>) -> bool {
    let responds = responds_in_range(constants, [state.linear, state.angular], 0.0);
    responds && within(state.position, MAX_DISTANCE_OF_CONTACTS) && is_rotation(state.orientation)
}

/// Whether what forces do to the bodies of these rows is in range.
pub(crate) fn are_kicked_in_range(bodies: &SolverBodies, rows: Range<usize>) -> bool {
    let mut kicks = Kicks { bodies, rows: rows.clone(), are_in_range: true };
    dispatch_blocks_and_rest(&mut kicks);
    kicks.are_in_range || rows.into_iter().all(|row| bodies.is_kicked_in_range(row))
}

/// Reads neighbouring bodies.
struct GatherTiles<'k, 'a, 'd> {
    bodies: &'k Chunk<'a>,
    first: usize,
    count: usize,
    dynamic: &'k mut DynamicRows<'d>,
    /// The row of the first in the solver.
    next: usize,
    h: Real,
}

impl Kernel for GatherTiles<'_, '_, '_> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.count
    }

    #[inline(always)]
    fn tile<T: Tile>(&mut self, i: usize) {
        let row = self.first + i;
        let (constants, state) = (self.bodies.constants::<T>(row), self.bodies.state::<T>(row));
        let (force, _) = self.bodies.wrenches::<T>(row);
        self.dynamic.set(self.next + i, &constants, &state, force, self.h);
        if !T::all(are_clearly_in_range(&constants, &state, T::splat(0.0))) {
            self.mark_out_of_range(i, T::WIDTH);
        }
    }
}

impl GatherTiles<'_, '_, '_> {
    #[cold]
    #[inline(never)]
    fn mark_out_of_range(&mut self, first: usize, count: usize) {
        for i in first..first + count {
            let row = self.first + i;
            if !is_in_range(&self.bodies.constants(row), &self.bodies.state(row)) {
                self.dynamic.set_out_of_range(self.next + i);
            }
        }
    }
}

/// What forces do to neighbouring bodies.
struct Kicks<'a> {
    bodies: &'a SolverBodies,
    rows: Range<usize>,
    /// Clearly so.
    are_in_range: bool,
}

impl Kernel for Kicks<'_> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.rows.len()
    }

    #[inline(always)]
    fn tile<T: Tile>(&mut self, i: usize) {
        let row = self.rows.start + i;
        let ForceImpulse { linear, angular, kept_linear, kept_angular } =
            load_rows::<T, _>(&self.bodies.force_impulse[row..]);
        let inverse_mass = load_rows::<T, _>(&self.bodies.motion[row..]).inverse_mass;
        let Vec3 { x, y, z } = load_rows::<T, _>(&self.bodies.inertia[row..]).inverse_moments;
        let (linear, angular) = (size(linear), size(angular));
        let in_range = below(linear, MAX_IMPULSE)
            * below(angular, MAX_IMPULSE)
            * below(linear * inverse_mass, MAX_SPEED)
            * below(angular * (x + y + z), MAX_SPEED)
            * is_part(kept_linear)
            * is_part(kept_angular);
        self.are_in_range &= T::all(T::splat(0.0).lt(in_range));
    }
}

/// One for a number from zero to one, else zero.
#[inline(always)]
fn is_part<T: Tile>(number: T) -> T {
    let from_zero = T::select(number.lt(T::splat(0.0)), T::splat(0.0), T::splat(1.0));
    T::select(T::splat(1.0).lt(number), T::splat(0.0), from_zero * below(number, 2.0))
}
