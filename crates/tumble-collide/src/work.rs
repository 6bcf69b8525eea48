//! Work done on pairs of shapes, counted in tests and with the feature `count-work`, and nowhere
//! else.

#[cfg(any(test, feature = "count-work"))]
use std::cell::Cell;

#[cfg(any(test, feature = "count-work"))]
thread_local! {
    static DONE: Cell<[usize; 3]> = const { Cell::new([0; 3]) };
    static MULTIPLIED: Cell<usize> = const { Cell::new(0) };
}

/// One more point that is furthest in some direction.
#[inline(always)]
pub(crate) fn reached() {
    add(0, 1);
}

/// Faces tested and sides compared.
#[inline(always)]
pub(crate) fn compared(count: usize) {
    add(1, count);
}

/// A polyhedron that tore, or had as many points as it may.
#[inline(always)]
pub(crate) fn uncertain() {
    add(2, 1);
}

/// Scalar products in search of what is furthest.
#[inline(always)]
pub(crate) fn multiplied(_count: usize) {
    #[cfg(any(test, feature = "count-work"))]
    MULTIPLIED.with(|done| done.set(done.get() + _count));
}

#[inline(always)]
fn add(_which: usize, _count: usize) {
    #[cfg(any(test, feature = "count-work"))]
    DONE.with(|done| {
        let mut all = done.get();
        all[_which] += _count;
        done.set(all);
    });
}

/// Work done on pairs of shapes by this thread since it was last asked: points reached, faces and
/// sides compared, and scalar products in search of the furthest point or face of a hull. For
/// fuzzing, with the feature `count-work`.
///
/// ```
/// use tumble_collide::{ColliderShape, Isometry, contact_manifold, work_done};
/// use tumble_math::lane::Vec3;
///
/// let (disc, cone) = (
///     ColliderShape::Cylinder { radius: 1.0, half_height: 0.1 },
///     ColliderShape::Cone { radius: 1.0, half_height: 1.0 },
/// );
/// contact_manifold(
///     &disc,
///     &Isometry::at(Vec3::zero()),
///     &cone,
///     &Isometry::at(Vec3::new(0.3, 1.0, 0.2)),
///     0.02,
/// );
/// let [reached, ..] = work_done();
/// assert!((1..1000).contains(&reached));
/// ```
#[cfg(feature = "count-work")]
#[must_use]
pub fn work_done() -> [usize; 3] {
    let [reached, compared, _] = taken();
    [reached, compared, multiplications()]
}

/// Points reached, faces and sides compared, and polyhedra uncertain, since it was last asked.
#[cfg(any(test, feature = "count-work"))]
pub(crate) fn taken() -> [usize; 3] {
    DONE.with(Cell::take)
}

/// Scalar products since it was last asked.
#[cfg(any(test, feature = "count-work"))]
pub(crate) fn multiplications() -> usize {
    MULTIPLIED.with(Cell::take)
}
