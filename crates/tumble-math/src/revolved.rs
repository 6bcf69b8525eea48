//! Solids of revolution about y, put together from frusta of cones and segments of spheres.

use std::f64::consts::PI;

/// A homogeneous solid of revolution about y. Moments are those of one kilogram of it, [m^2], so
/// that nothing but the volume has a higher power of a length than two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Revolved {
    pub(crate) volume: f64,
    /// Height of the centre of mass.
    pub(crate) center: f64,
    /// Moment about y.
    pub(crate) axial: f64,
    /// Moment about any axis across y through the centre of mass.
    pub(crate) transverse: f64,
}

impl Revolved {
    /// A frustum of a cone between the radii `bottom` at `-half_height` and `top` at
    /// `+half_height`. One of the radii may be zero. The formulas are those of
    /// [`MassProperties::frustum`](crate::MassProperties::frustum).
    pub(crate) fn frustum(bottom: f64, top: f64, half_height: f64) -> Self {
        // In units of the larger radius: fourth powers of the radii themselves could leave the
        // range of f64.
        let unit = bottom.max(top);
        let (a, b, height) = (bottom / unit, top / unit, 2.0 * half_height);
        let (a2, ab, b2) = (a * a, a * b, b * b);
        let s2 = a2 + ab + b2;
        let s4 = a2 * a2 + a2 * ab + a2 * b2 + ab * b2 + b2 * b2;
        let spread = a2 * a2 + 4.0 * a2 * ab + 10.0 * a2 * b2 + 4.0 * ab * b2 + b2 * b2;
        let volume = PI / 3.0 * height * s2 * unit * unit;
        let axial = 0.3 * (s4 / s2) * unit * unit;
        let transverse = 0.5 * axial + 3.0 / 80.0 * height * height * (spread / s2 / s2);
        Self { volume, center: 0.25 * height * (b - a) * (a + b) / s2, axial, transverse }
    }

    /// What a plane across y cuts off a sphere of this radius about the origin: the part below,
    /// `height` times the radius high, with `height` from 0 to 2.
    ///
    /// At `w` radii above the pole the section has the radius `sqrt(w (2 - w))`. With k the height,
    /// in radii,
    ///
    /// ```text
    /// V = pi k^2 (1 - k/3)    F = pi k^3 (2/3 - k/4)    S = pi k^4 (1/2 - k/5):  of 1, w, w^2
    /// I_yy = pi/2 k^3 (4/3 - k + k^2/5)      I_xx = I_zz = I_yy/2 + S - F^2/V
    /// ```
    ///
    /// From the pole, as only that keeps the digits of a shallow segment; at worst, in `S - F^2/V`,
    /// a factor of nine is lost.
    pub(crate) fn segment(radius: f64, height: f64) -> Self {
        let (k, r2) = (height, radius * radius);
        // All but the volume itself as multiples of the volume, so that no power of a small k is
        // lost.
        let volume = 1.0 - k / 3.0;
        let center = k * (2.0 / 3.0 - 0.25 * k) / volume;
        let second = k * k * (0.5 - 0.2 * k) / volume;
        let axial = 0.5 * k * (4.0 / 3.0 - k + 0.2 * k * k) / volume;
        let transverse = 0.5 * axial + (second - center * center);
        Self {
            volume: PI * k * k * r2 * radius * volume,
            center: radius * (center - 1.0),
            axial: r2 * axial,
            transverse: r2 * transverse,
        }
    }

    /// The convex hull of two spheres of the radii `bottom` and `top` about `-half_height` and
    /// `+half_height`.
    ///
    /// The cone that touches both does so in circles which, seen from the centres, lie at the sine
    /// `s = (bottom - top)/(2 half_height)` above the equators. Below the lower one is a segment of
    /// the bottom sphere, `1 + s` radii high, above the upper one a segment of the top sphere,
    /// `1 - s` radii high, and between them a frustum, with the cosine of that angle in its radii
    /// and the cosine's square in its height. If one sphere holds the other, it is all.
    pub(crate) fn tapered_capsule(bottom: f64, top: f64, half_height: f64) -> Self {
        let (distance, difference) = (2.0 * half_height, bottom - top);
        if distance <= difference.abs() {
            let sign = if bottom > top { -1.0 } else { 1.0 };
            return Self::segment(bottom.max(top), 2.0).raised(sign * half_height);
        }
        // 1 + s and 1 - s from the lengths themselves: where the spheres nearly hold each other one
        // of them is small.
        let (low, high) = ((distance + difference) / distance, (distance - difference) / distance);
        let (sine, cosine) = (difference / distance, (low * high).sqrt());
        let bottom_segment = Self::segment(bottom, low).raised(-half_height);
        let top_segment = Self::segment(top, high).upside_down().raised(half_height);
        let middle = 0.5 * (bottom + top) * sine; // of the circles' heights, -h + bottom s and h + top s
        let frustum = Self::frustum(bottom * cosine, top * cosine, half_height * low * high).raised(middle);
        frustum.with(&bottom_segment).with(&top_segment)
    }

    fn raised(self, height: f64) -> Self {
        Self { center: self.center + height, ..self }
    }

    fn upside_down(self) -> Self {
        Self { center: -self.center, ..self }
    }

    /// Both together, by the parallel-axis theorem for two.
    fn with(&self, other: &Self) -> Self {
        let volume = self.volume + other.volume;
        let (share, distance) = (other.volume / volume, other.center - self.center);
        let rest = self.volume / volume;
        Self {
            volume,
            center: self.center + distance * share,
            axial: rest * self.axial + share * other.axial,
            transverse: rest * self.transverse + share * other.transverse + rest * share * distance * distance,
        }
    }
}
