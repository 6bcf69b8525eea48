//! Cylinders, cones and what is between them: round, with two flat caps.

use tumble_math::lane::Lane;

use crate::feature::{Feature, Near};
use crate::support_map::Vector;

/// About y, from `-half_height` to `+half_height`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frustum {
    /// Of the lower and of the upper cap; one may be zero.
    pub(crate) radii: [f64; 2],
    pub(crate) half_height: f64,
}

/// Places on a rim that go with the body, so that what stands on a cap has the same points from
/// step to step: an eighth of a turn apart, counter-clockwise about y.
const RIM: [[f64; 2]; 8] = {
    let d = std::f64::consts::FRAC_1_SQRT_2;
    [[0.0, 1.0], [d, d], [1.0, 0.0], [d, -d], [0.0, -1.0], [-d, -d], [-1.0, 0.0], [-d, d]]
};
/// The lowest point of a rim takes the place of the nearest of these when it is lower by more than
/// this part of the radius: less is rounding, and would make the point run around the rim of what
/// stands still.
const LOWER: f64 = 1e-4;
/// And by more than this part of how far it is pressed in, of four places and of eight, half of
/// `1 - cos(pi/n)`: how far a load lowers it that tilts a cap until its other side parts.
const TILTED: [f64; 2] = [0.147, 0.039];
/// A cap is stood on when its normal is within about 25 degrees; further over it is the rim that
/// rolls.
const MIN_COSINE: f64 = 0.9;
/// Numbers of points: those on the rim of the upper cap begin here,
const UPPER: u32 = 16;
/// the lowest of a rim comes after eight that are fixed,
const LOWEST: u32 = 8;
/// and the ends of a line on the side have these.
const SIDE: [u32; 2] = [32, 33];

impl Frustum {
    pub(crate) fn support(&self, d: Vector) -> Vector {
        let around = (d.x * d.x + d.z * d.z).sqrt();
        let [below, above] = self.radii;
        let h = self.half_height;
        let (radius, y) = if above * around + h * d.y >= below * around - h * d.y { (above, h) } else { (below, -h) };
        if around > 0.0 {
            Vector::new(d.x / around * radius, y, d.z / around * radius)
        } else {
            Vector::new(0.0, y, 0.0)
        }
    }

    /// The normal of the cap that looks in a direction, if it is not a point.
    pub(crate) fn cap_normal(&self, d: Vector) -> Option<Vector> {
        let upper = d.y >= 0.0;
        let normal = Vector::new(0.0, if upper { 1.0 } else { -1.0 }, 0.0);
        (self.radii[usize::from(upper)] > 0.0).then_some(normal)
    }

    /// A cap, or the line on the side that looks along a unit vector.
    pub(crate) fn feature(&self, d: Vector, near: Near) -> Feature<f64> {
        self.cap::<8>(d, near).unwrap_or_else(|| self.side(d))
    }

    /// Points of a cap where it is stood on or nearly: none of its rim is higher than the lowest by
    /// more than twice the margin and how far it is pressed in \[m\].
    pub(crate) fn cap<const N: usize>(&self, d: Vector, Near { margin, pressed }: Near) -> Option<Feature<f64>> {
        let normal = self.cap_normal(d)?;
        let upper = normal.y > 0.0;
        let (radius, y) = (self.radii[usize::from(upper)], self.half_height * normal.y);
        let around = (d.x * d.x + d.z * d.z).sqrt();
        let [below, above] = self.radii;
        // How far the direction is from the normal of the cap, and from that of the side.
        let along_side = Vector::new(2.0 * self.half_height, below - above, 0.0);
        let along_side = (along_side.x * around + along_side.y * d.y) / along_side.dot(along_side).sqrt();
        let along_cap = Lane::abs(d.y);
        if along_cap < along_side || along_cap < MIN_COSINE || radius * around > margin + pressed {
            return None;
        }
        let first = if upper { UPPER } else { 0 };
        let step = RIM.len() / N;
        let place = |k: usize| RIM[if upper { k } else { N - 1 - k } * step];
        let along = |[x, z]: [f64; 2]| x * d.x + z * d.z;
        let mut nearest = 0;
        for k in 1..N {
            if along(place(k)) > along(place(nearest)) {
                nearest = k;
            }
        }
        let rolls =
            (around - along(place(nearest))) * radius > f64::max(LOWER * radius, TILTED[usize::from(N > 4)] * pressed);
        let corner = |k: usize| {
            let [x, z] = if rolls && k == nearest { [d.x / around, d.z / around] } else { place(k) };
            let id = if rolls && k == nearest { LOWEST } else { k as u32 };
            (Vector::new(x * radius, y, z * radius), first + id)
        };
        Some(Feature::new((0..N).map(corner), normal))
    }

    /// From the rim of the lower cap to that of the upper.
    pub(crate) fn side(&self, d: Vector) -> Feature<f64> {
        let around = (d.x * d.x + d.z * d.z).sqrt();
        let (x, z) = if around > 0.0 { (d.x / around, d.z / around) } else { (1.0, 0.0) };
        let [below, above] = self.radii;
        let h = self.half_height;
        let ends = [Vector::new(x * below, -h, z * below), Vector::new(x * above, h, z * above)];
        Feature::new(ends.into_iter().zip(SIDE), Vector::zero())
    }
}
