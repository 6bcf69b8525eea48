use tumble_math::lane::Vec3;

use crate::scalar::Scalar;

/// A box along the world's axes \[m\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds<R> {
    /// Its corner where all coordinates are least.
    pub low: Vec3<R>,
    /// Its corner where all coordinates are greatest.
    pub high: Vec3<R>,
}

impl<R: Scalar> Bounds<R> {
    /// The box that reaches `half` \[m\] from its centre to all sides.
    pub fn about(center: Vec3<R>, half: Vec3<R>) -> Self {
        Self { low: center - half, high: center + half }
    }

    /// Whether the boxes have a point in common. One that is not finite has none.
    #[inline]
    pub fn meets(&self, other: &Self) -> bool {
        self.low.x <= other.high.x
            && other.low.x <= self.high.x
            && self.low.y <= other.high.y
            && other.low.y <= self.high.y
            && self.low.z <= other.high.z
            && other.low.z <= self.high.z
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
