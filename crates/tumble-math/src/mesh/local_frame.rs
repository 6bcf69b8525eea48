//! Coordinates in which a mesh is neither far away nor large nor small.

use glam::DVec3;

/// The box around a mesh, and coordinates from its middle in units of a power of two, in which the
/// box fits into -1 to 1.
///
/// Scaling is exact. So is the shift for a mesh far from the origin, whose coordinates are within a
/// factor of two of the middle's (P. H. Sterbenz, "Floating-Point Computation", 1974, theorem
/// 4.3.1); near the origin it rounds to eps of the local coordinate. Either way a mesh far away
/// loses nothing against one near.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LocalFrame {
    pub(crate) low: DVec3,
    pub(crate) high: DVec3,
    origin: DVec3,
    pub(crate) unit: f64,
}

impl LocalFrame {
    /// Around these points; at the origin if there are none.
    pub(crate) fn around(points: impl Iterator<Item = DVec3>) -> Self {
        let (low, high) =
            points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
        let (low, high) = if low.x <= high.x { (low, high) } else { (DVec3::ZERO, DVec3::ZERO) };
        let (_, exponent) = libm::frexp((high - low).max_element());
        Self { low, high, origin: low * 0.5 + high * 0.5, unit: libm::ldexp(1.0, exponent) }
    }

    /// The longest side of the box \[m\].
    pub(crate) fn extent(&self) -> f64 {
        (self.high - self.low).max_element()
    }

    pub(crate) fn local(&self, position: DVec3) -> DVec3 {
        (position - self.origin) / self.unit
    }

    /// A difference of positions in local units.
    pub(crate) fn difference(&self, from: DVec3, to: DVec3) -> DVec3 {
        (to - from) / self.unit
    }

    pub(crate) fn global(&self, local: DVec3) -> DVec3 {
        self.origin + local * self.unit
    }
}
