//! Axis-aligned bounding boxes and their overlap tests.

use tumble_math::lane::Vec3;

use crate::scalar::Scalar;

/// A box along the world's axes \[m\].
///
/// ```
/// use tumble_collide::Aabb;
/// use tumble_math::lane::Vec3;
///
/// let cube = Aabb::about(Vec3::zero(), Vec3::splat(0.5));
/// assert!(cube.meets(&Aabb::about(Vec3::new(0.9, 0.0, 0.0), Vec3::splat(0.5))));
/// assert!(!cube.meets(&Aabb::about(Vec3::new(1.1, 0.0, 0.0), Vec3::splat(0.5))));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb<R> {
    /// Its corner where all coordinates are least.
    pub low: Vec3<R>,
    /// Its corner where all coordinates are greatest.
    pub high: Vec3<R>,
}

impl<R: Scalar> Aabb<R> {
    /// The box that reaches `half` \[m\] from its centre to all sides.
    pub fn about(center: Vec3<R>, half: Vec3<R>) -> Self {
        Self { low: center - half, high: center + half }
    }

    /// Nothing: it meets no box, and with another it makes the other.
    pub(crate) fn empty() -> Self {
        let end = R::splat(f64::INFINITY);
        Self { low: Vec3::splat(end), high: Vec3::splat(-end) }
    }

    /// Whether the boxes have a point in common. One that is not a number has none.
    #[inline]
    pub fn meets(&self, other: &Self) -> bool {
        at_most(self.low, other.high) & at_most(other.low, self.high)
    }

    /// Whether all of the other is in this one, its surface included.
    #[inline]
    pub(crate) fn holds(&self, other: &Self) -> bool {
        at_most(self.low, other.low) & at_most(other.high, self.high)
    }

    /// The smallest box that holds both.
    ///
    /// ```
    /// use tumble_collide::Aabb;
    /// use tumble_math::lane::Vec3;
    ///
    /// let [a, b] = [-1.0, 2.0].map(|x| Aabb::about(Vec3::new(x, 0.0, 0.0), Vec3::splat(0.5)));
    /// assert_eq!(a.union(&b), Aabb::about(Vec3::new(0.5, 0.0, 0.0), Vec3::new(2.0, 0.5, 0.5)));
    /// ```
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        let least = |a: Vec3<R>, b: Vec3<R>| Vec3::new(a.x.min(b.x), a.y.min(b.y), a.z.min(b.z));
        let most = |a: Vec3<R>, b: Vec3<R>| Vec3::new(a.x.max(b.x), a.y.max(b.y), a.z.max(b.z));
        Self { low: least(self.low, other.low), high: most(self.high, other.high) }
    }

    /// The box that is larger to every side \[m\].
    ///
    /// ```
    /// use tumble_collide::Aabb;
    /// use tumble_math::lane::Vec3;
    ///
    /// let about_origin = |half: f64| Aabb::about(Vec3::zero(), Vec3::splat(half));
    /// assert_eq!(about_origin(0.5).grown(0.25), about_origin(0.75));
    /// ```
    #[must_use]
    pub fn grown(&self, by: R) -> Self {
        let by = Vec3::splat(by);
        Self { low: self.low - by, high: self.high + by }
    }

    /// How far a point is from it \[m\]; zero inside.
    pub(crate) fn distance(&self, point: Vec3<R>) -> R {
        let zero = R::splat(0.0);
        let out = |low: R, high: R, at: R| (low - at).max(at - high).max(zero);
        let out = Vec3::new(
            out(self.low.x, self.high.x, point.x),
            out(self.low.y, self.high.y, point.y),
            out(self.low.z, self.high.z, point.z),
        );
        out.dot(out).sqrt()
    }

    /// Whether it is a box with an end on all sides, and not turned inside out.
    #[inline]
    pub(crate) fn is_finite(&self) -> bool {
        let end = R::splat(f64::INFINITY);
        let within = |low: R, high: R| (-end < low) & (low <= high) & (high < end);
        within(self.low.x, self.high.x) & within(self.low.y, self.high.y) & within(self.low.z, self.high.z)
    }

    /// Half-way between its corners \[m\].
    #[inline]
    pub(crate) fn center(&self) -> Vec3<R> {
        // Halved first: the sum of the corners may be more than there are numbers for.
        self.low * R::splat(0.5) + self.high * R::splat(0.5)
    }

    /// Whether any of it is below a plane through `point` with the unit normal `up`.
    pub fn reaches_below(&self, point: Vec3<R>, up: Vec3<R>) -> bool {
        let pick = |normal: R, low: R, high: R| if normal > R::splat(0.0) { low } else { high };
        let lowest = Vec3::new(
            pick(up.x, self.low.x, self.high.x),
            pick(up.y, self.low.y, self.high.y),
            pick(up.z, self.low.z, self.high.z),
        );
        (lowest - point).dot(up) <= R::splat(0.0)
    }
}

/// Whether no component is greater than that of the other. Compared without branches, which for
/// neighbours are taken as often as not.
#[inline]
fn at_most<R: Scalar>(a: Vec3<R>, b: Vec3<R>) -> bool {
    (a.x <= b.x) & (a.y <= b.y) & (a.z <= b.z)
}
