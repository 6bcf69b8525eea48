//! Where a line meets triangles: between two with a common side nothing gets through.

use crate::query::line::{Line, component};
use crate::query::point::nearest_of_triangle;
use crate::support_map::Vector;
use crate::surface::Surface;

/// The rounding of a product of differences, as a part of the product of the distances.
const ROUNDING: f64 = 16.0 * f64::EPSILON;
/// Error of a distance that is as good as none, as a part of it.
const SURE: f64 = 1e-10;

/// Where a line meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TriangleLine {
    /// From the line's point \[m\].
    pub(crate) distance: f64,
    /// The triangle's, outward.
    pub(crate) normal: Vector,
    pub(crate) triangle: u32,
}

/// A line made ready for triangles: its greatest component goes along z of sheared space.
///
/// S. Woop, C. Benthin, I. Wald, "Watertight ray/triangle intersection", J. Computer Graphics
/// Techniques 2 (2013).
pub(crate) struct ShearedLine {
    line: Line,
    axes: [usize; 3],
    shear: [f64; 3],
}

impl ShearedLine {
    pub(crate) fn of(line: &Line) -> Self {
        let [x, y, z] = [0, 1, 2].map(|axis| component(line.along, axis).abs());
        let k = if z >= x && z >= y {
            2
        } else if y >= x {
            1
        } else {
            0
        };
        let axes = [(k + 1) % 3, (k + 2) % 3, k];
        let inverse = 1.0 / component(line.along, k);
        let [x, y] = [axes[0], axes[1]].map(|axis| component(line.along, axis) * inverse);
        Self { line: *line, axes, shear: [x, y, inverse] }
    }

    /// How far along the line a triangle is met, from both sides, if at most `most`.
    pub(crate) fn meets(&self, corners: &[Vector; 3], most: f64) -> Option<f64> {
        let sheared = self.sheared(corners, self.line.point);
        let (met, whole) = met(&sheared)?;
        // Rounding of the sides, as a part of the whole, moves it by that part of the length.
        let far = sheared.iter().flatten().fold(0.0, |far: f64, number| far.max(number.abs()));
        let [low, high] = [f64::min, f64::max].map(|f| f(f(sheared[0][2], sheared[1][2]), sheared[2][2]));
        let is_certain = ROUNDING * far * (high - low) <= SURE * whole.abs();
        let distance = if is_certain { met } else { self.meets_thin(corners)? };
        (0.0 <= distance && distance <= most).then_some(distance)
    }

    /// The corners, seen from a point of the line.
    fn sheared(&self, corners: &[Vector; 3], from: Vector) -> [[f64; 3]; 3] {
        let [sx, sy, sz] = self.shear;
        corners.map(|corner| {
            let between = corner - from;
            let [x, y, z] = self.axes.map(|axis| component(between, axis));
            [x - sx * z, y - sy * z, sz * z]
        })
    }

    /// The same as [`meets`](Self::meets) of a triangle that is little more than a line, or is seen
    /// from its side: where the line passes a side, or where it is met as seen from there.
    fn meets_thin(&self, corners: &[Vector; 3]) -> Option<f64> {
        let placed = |distance: f64| {
            let off = nearest_of_triangle(corners.map(|corner| corner - self.line.at(distance)));
            (off.dot(off).sqrt(), distance)
        };
        let nearer = |a: (f64, f64), b: (f64, f64)| if b.0 < a.0 { b } else { a };
        let [a, b, c] = *corners;
        let sides = [(a, b), (b, c), (c, a)].map(|(from, to)| placed(self.nearest_to_side(from, to)));
        let (_, near) = nearer(nearer(sides[0], sides[1]), sides[2]);
        let within = met(&self.sheared(corners, self.line.at(near))).map_or(near, |(met, _)| near + met);
        let all = [sides[0], sides[1], sides[2], placed(within)];
        let (least, at) = all.into_iter().reduce(nearer).unwrap_or(sides[0]);
        let rounding = ROUNDING * at.abs();
        let side = |from: Vector, to: Vector| (to - from).dot(to - from);
        let longest = side(a, b).max(side(b, c)).max(side(c, a)).sqrt();
        // It is passed by more than a width that is as good as none.
        if least > ROUNDING.sqrt() * longest + rounding {
            return None;
        }
        let there = all.iter().filter(|(off, _)| *off <= 2.0 * least + rounding);
        Some(there.fold(f64::INFINITY, |first, (_, distance)| first.min(*distance)))
    }

    /// How far along the line it is nearest to a segment.
    fn nearest_to_side(&self, from: Vector, to: Vector) -> f64 {
        let Line { point, along } = self.line;
        let (side, begin) = (to - from, from - point);
        // Across the line both are seen as they are.
        let across = |v: Vector| v - along * v.dot(along);
        let (of_side, of_begin) = (across(side), across(begin));
        let square = of_side.dot(of_side);
        let share = if square > 0.0 { (-of_side.dot(of_begin) / square).clamp(0.0, 1.0) } else { 0.0 };
        (begin + side * share).dot(along)
    }
}

/// How far along z of sheared space a triangle is met, and twice its area across z.
fn met([a, b, c]: &[[f64; 3]; 3]) -> Option<(f64, f64)> {
    // Of a side that two triangles share both have the same number, but for its sign.
    let side = |p: &[f64; 3], q: &[f64; 3]| q[0] * p[1] - q[1] * p[0];
    let (u, v, w) = (side(b, c), side(c, a), side(a, b));
    let is_outside = (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0);
    let whole = u + v + w;
    (!is_outside && whole != 0.0).then(|| ((u * a[2] + v * b[2] + w * c[2]) / whole, whole))
}

/// The first triangle of a surface that a line meets from its point on, at most `most` \[m\] away.
pub(crate) fn first_triangle(surface: &impl Surface, line: &Line, most: f64) -> Option<TriangleLine> {
    let sheared = ShearedLine::of(line);
    let (mut first, mut most): (Option<TriangleLine>, f64) = (None, most);
    surface.along(line, Vector::zero(), most, &mut |triangle| {
        if let Some(distance) = sheared.meets(&surface.triangle(triangle), most)
            && first.is_none_or(|first| (distance, triangle) < (first.distance, first.triangle))
        {
            let normal = surface.normal(triangle);
            // Rounding has a line meet triangles without area, somewhere along them.
            if normal.dot(normal) > 0.5 {
                first = Some(TriangleLine { distance, normal, triangle });
                most = distance;
            }
        }
        most
    });
    first
}
