//! Volume integrals over what a closed surface of triangles bounds.

use glam::{DMat3, DVec3};

use super::local_frame::LocalFrame;

/// A sum that keeps what its additions round off, and adds it at the end: its error does not grow
/// with the number of terms.
///
/// A. Neumaier, "Rundungsfehleranalyse einiger Verfahren zur Summation endlicher Summen", Z. Angew.
/// Math. Mech. 54 (1974).
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    sum: f64,
    lost: f64,
}

impl Sum {
    fn add(&mut self, term: f64) {
        let next = self.sum + term;
        let (large, small) = if self.sum.abs() >= term.abs() { (self.sum, term) } else { (term, self.sum) };
        self.lost += (large - next) + small;
        self.sum = next;
    }

    fn value(self) -> f64 {
        self.sum + self.lost
    }
}

#[derive(Clone, Copy, Debug, Default)]
struct VectorSum([Sum; 3]);

impl VectorSum {
    fn add(&mut self, term: DVec3) {
        for (sum, term) in self.0.iter_mut().zip(term.to_array()) {
            sum.add(term);
        }
    }

    fn value(self) -> DVec3 {
        self.0.map(Sum::value).into()
    }
}

/// A volume, positive if the surface is wound outwards, and the most by which rounding can have
/// changed it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct SignedVolume {
    pub(crate) value: f64,
    pub(crate) rounding: f64,
}

impl SignedVolume {
    /// Whether even the sign is unknown.
    pub(crate) fn is_lost_in_rounding(&self) -> bool {
        self.value.abs() <= self.rounding
    }
}

/// The volume within a surface, in local units, about its own first corner. See [`moments`] for the
/// formula.
pub(crate) fn signed_volume(triangles: impl Iterator<Item = [DVec3; 3]>, frame: &LocalFrame) -> SignedVolume {
    let (mut volume, mut terms) = (Sum::default(), 0.0);
    let mut first = None;
    for corners in triangles {
        let origin = *first.get_or_insert(corners[0]);
        let (determinant, bound) = determinant(corners, frame.difference(origin, corners[0]), frame);
        volume.add(determinant);
        terms += bound;
    }
    SignedVolume { value: volume.value() / 6.0, rounding: ROUNDING * terms / 6.0 }
}

/// What rounding can change in `a . (u x v)`, relative to `|a| |u| |v|`: `a`, `u` and `v` are
/// rounded differences (half an eps each), and the six products of three factors with their sum
/// cost another three eps at most. Twice that, for the bound is rounded itself.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// `a . (u x v)` with the edges `u`, `v` of the triangle from its first corner `a`, which is six
/// times the volume of the tetrahedron it makes with the origin; and `|a| |u| |v|`. Edges are
/// differences of the given positions, so that a small triangle far out is as exact as one near.
fn determinant([p, q, r]: [DVec3; 3], a: DVec3, frame: &LocalFrame) -> (f64, f64) {
    let (u, v) = (frame.difference(p, q), frame.difference(p, r));
    (a.dot(u.cross(v)), a.length() * u.length() * v.length())
}

/// Moments of a homogeneous solid of density one, in local units: volume, centre, and the integral
/// of `r r^T` about the centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Moments {
    pub(crate) volume: SignedVolume,
    pub(crate) center: DVec3,
    pub(crate) second: DMat3,
}

/// Moments of the solid within a closed surface.
///
/// By the divergence theorem the integral over a solid is the sum, over its triangles, of integrals
/// over the tetrahedra between triangle and origin, each with the sign of its determinant
/// `d = a . (b x c)`: what the surface bounds is covered once, everything else as often with either
/// sign. Over one tetrahedron with corners 0, a, b, c and `s = a + b + c`
///
/// ```text
/// integral of 1 = d/6      of r = d/24 s      of r r^T = d/120 (s s^T + a a^T + b b^T + c c^T)
/// ```
///
/// A first pass about the middle of the box finds volume and centre, a second about the centre the
/// second moments, so that no parallel-axis shift has to be taken away from them.
///
/// Sources: B. Mirtich, "Fast and accurate computation of polyhedral mass properties", J. Graphics
/// Tools 1 (1996), and D. Eberly, "Polyhedral mass properties (revisited)", 2009, for surface
/// integrals of the same; F. Tonon, J. Math. Stat. 1 (2005) for the tetrahedron.
pub(crate) fn moments<I: Iterator<Item = [DVec3; 3]>>(triangles: impl Fn() -> I, frame: &LocalFrame) -> Moments {
    let (mut volume, mut first, mut terms) = (Sum::default(), VectorSum::default(), 0.0);
    for corners in triangles() {
        let [a, b, c] = corners.map(|p| frame.local(p));
        let (d, bound) = determinant(corners, a, frame);
        volume.add(d);
        first.add((a + b + c) * d);
        terms += bound;
    }
    let volume = SignedVolume { value: volume.value() / 6.0, rounding: ROUNDING * terms / 6.0 };
    let center = if volume.value == 0.0 { DVec3::ZERO } else { first.value() / (24.0 * volume.value) };
    let (mut diagonal, mut off_diagonal) = (VectorSum::default(), VectorSum::default());
    for corners in triangles() {
        let [a, b, c] = corners.map(|p| frame.local(p) - center);
        let (d, _) = determinant(corners, a, frame);
        let s = a + b + c;
        diagonal.add((s * s + a * a + b * b + c * c) * d);
        let mixed = |v: DVec3| DVec3::new(v.y * v.z, v.z * v.x, v.x * v.y);
        off_diagonal.add((mixed(s) + mixed(a) + mixed(b) + mixed(c)) * d);
    }
    let (d, o) = (diagonal.value() / 120.0, off_diagonal.value() / 120.0);
    let second = DMat3::from_cols(DVec3::new(d.x, o.z, o.y), DVec3::new(o.z, d.y, o.x), DVec3::new(o.y, o.x, d.z));
    Moments { volume, center, second }
}

/// Area of a surface in local units, and how many of its triangles have none: the cross product of
/// two edges, each known to half an eps and with three roundings of its own, is no longer than its
/// rounding.
pub(crate) fn surface_area(triangles: impl Iterator<Item = [DVec3; 3]>, frame: &LocalFrame) -> (f64, usize) {
    let (mut area, mut collinear) = (Sum::default(), 0);
    for [p, q, r] in triangles {
        let (u, v) = (frame.difference(p, q), frame.difference(p, r));
        let twice = u.cross(v).length();
        area.add(0.5 * twice);
        collinear += usize::from(twice <= 4.0 * f64::EPSILON * u.length() * v.length());
    }
    (area.value(), collinear)
}
