//! Where a line meets triangles: between two with a common side nothing gets through.

use crate::query::line::{Line, component};
use crate::support_map::Vector;
use crate::surface::Surface;

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
        let [sx, sy, sz] = self.shear;
        let [a, b, c] = corners.map(|corner| {
            let from = corner - self.line.point;
            let [x, y, z] = self.axes.map(|axis| component(from, axis));
            [x - sx * z, y - sy * z, sz * z]
        });
        // Of a side that two triangles share both have the same number, but for its sign.
        let side = |p: [f64; 3], q: [f64; 3]| q[0] * p[1] - q[1] * p[0];
        let (u, v, w) = (side(b, c), side(c, a), side(a, b));
        let is_outside = (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0);
        let whole = u + v + w;
        if is_outside || whole == 0.0 {
            return None;
        }
        let distance = (u * a[2] + v * b[2] + w * c[2]) / whole;
        (0.0 <= distance && distance <= most).then_some(distance)
    }
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
