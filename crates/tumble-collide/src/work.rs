//! Work done on pairs of shapes, counted in tests and nowhere else.

#[cfg(test)]
use std::cell::Cell;

#[cfg(test)]
thread_local! {
    static DONE: Cell<[usize; 2]> = const { Cell::new([0; 2]) };
}

/// One more point that is furthest in some direction.
#[inline(always)]
pub(crate) fn reached() {
    #[cfg(test)]
    DONE.with(|done| done.set([done.get()[0] + 1, done.get()[1]]));
}

/// Faces looked at and sides compared.
#[inline(always)]
pub(crate) fn compared(_count: usize) {
    #[cfg(test)]
    DONE.with(|done| done.set([done.get()[0], done.get()[1] + _count]));
}

/// Points reached and faces and sides compared since it was last asked.
#[cfg(test)]
pub(crate) fn taken() -> [usize; 2] {
    DONE.with(Cell::take)
}
