//! From a body's frame to the picture: a parallel projection.

use glam::{DMat3, DVec3};

use tumble_scene::Up;

/// The camera stands so far around the upright axis and so far above the horizon \[rad\].
const AROUND: f64 = 0.62;
const ABOVE: f64 = 0.42;

/// Where things are in the picture: x to the right, y down, as SVG has them, and z towards the
/// viewer.
pub(crate) struct Camera {
    /// Rows: to the right, up, and towards the viewer.
    rotation: DMat3,
    /// Middle of what is seen, and how many units of the picture a unit of length has.
    middle: DVec3,
    scale: f64,
    center: [f64; 2],
}

impl Camera {
    /// A camera that sees all points in the given part of the picture.
    pub(crate) fn for_points(
        points: impl Iterator<Item = DVec3>,
        up: Up,
        [left, right]: [f64; 2],
        [top, bottom]: [f64; 2],
    ) -> Self {
        let rotation = rotation(up);
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for point in points {
            let seen = rotation * point;
            (low, high) = (low.min(seen), high.max(seen));
        }
        if !(low.is_finite() && high.is_finite()) {
            (low, high) = (DVec3::ZERO, DVec3::ZERO);
        }
        let size = high - low;
        let scale =
            ((right - left) / size.x.max(f64::MIN_POSITIVE)).min((bottom - top) / size.y.max(f64::MIN_POSITIVE));
        // A point has no size; then any scale will do.
        let scale = if size.x.max(size.y) > 0.0 && scale.is_finite() { scale } else { 1.0 };
        Self { rotation, middle: 0.5 * (low + high), scale, center: [0.5 * (left + right), 0.5 * (top + bottom)] }
    }

    pub(crate) fn place(&self, point: DVec3) -> DVec3 {
        let seen = (self.rotation * point - self.middle) * self.scale;
        DVec3::new(self.center[0] + seen.x, self.center[1] - seen.y, seen.z)
    }

    /// A direction as the camera has it: right, up, towards the viewer.
    pub(crate) fn turn(&self, direction: DVec3) -> DVec3 {
        self.rotation * direction
    }

    /// Units of the picture to a unit of length.
    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }
}

fn rotation(up: Up) -> DMat3 {
    let ((sa, ca), (sb, cb)) = (libm::sincos(AROUND), libm::sincos(ABOVE));
    let towards = DVec3::new(sa * cb, sb, ca * cb);
    let right = DVec3::new(ca, 0.0, -sa);
    let rows = [right, towards.cross(right), towards];
    // With z up, x is towards the viewer and y to the right.
    let rows = rows.map(|row| if up == Up::Z { DVec3::new(row.z, row.x, row.y) } else { row });
    DMat3::from_cols_array_2d(&rows.map(|row| row.to_array())).transpose()
}
