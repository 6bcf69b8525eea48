//! Work done on pairs of shapes, counted in tests and nowhere else.

#[cfg(test)]
use std::cell::Cell;

#[cfg(test)]
thread_local! {
    static DONE: Cell<[usize; 3]> = const { Cell::new([0; 3]) };
}

/// One more point that is furthest in some direction.
#[inline(always)]
pub(crate) fn reached() {
    add(0, 1);
}

/// Faces looked at and sides compared.
#[inline(always)]
pub(crate) fn compared(count: usize) {
    add(1, count);
}

/// A polyhedron that tore, or had as many points as it may.
#[inline(always)]
pub(crate) fn uncertain() {
    add(2, 1);
}

#[inline(always)]
fn add(_which: usize, _count: usize) {
    #[cfg(test)]
    DONE.with(|done| {
        let mut all = done.get();
        all[_which] += _count;
        done.set(all);
    });
}

/// Points reached, faces and sides compared, and polyhedra uncertain, since it was last asked.
#[cfg(test)]
pub(crate) fn taken() -> [usize; 3] {
    DONE.with(Cell::take)
}
