//! A half-space against other shapes: the normal is always that of its surface.

use tumble_math::lane::Vec3;

use crate::collider_shape::Isometry;
use crate::manifold::{ContactPoint, Manifold, Points};
use crate::scalar::Scalar;

impl<R: Scalar> Isometry<R> {
    /// Out of the half-space placed here.
    pub(crate) fn up(&self) -> Vec3<R> {
        let [_, up, _] = self.orientation.axes();
        up
    }
}

pub(crate) fn half_space_and_sphere<R: Scalar>(
    ground: &Isometry<R>,
    radius: R,
    center: Vec3<R>,
    margin: R,
) -> Manifold<R> {
    let up = ground.up();
    let separation = up.dot(center - ground.position) - radius;
    Manifold::of_point(up, center - up * radius, separation, 0, margin)
}

/// The corners that are near enough of the face that looks down most: those above them hold
/// nothing. A feature is the number of a corner.
pub(crate) fn half_space_and_cuboid<R: Scalar>(
    ground: &Isometry<R>,
    half_extents: Vec3<R>,
    at: &Isometry<R>,
    margin: R,
) -> Manifold<R> {
    let up = ground.up();
    let along = at.orientation.axes().map(|axis| up.dot(axis));
    let mut down = 0;
    for axis in 1..3 {
        if along[axis].abs() > along[down].abs() {
            down = axis;
        }
    }
    let face = u32::from(along[down] < R::splat(0.0)) << down;
    let mut points = Points::none();
    for corner in (0..8).filter(|corner| corner & 1 << down == face) {
        let sign = |bit: u32| R::splat(if corner & bit == 0 { -1.0 } else { 1.0 });
        let vertex = at.to_world(half_extents.scale(Vec3::new(sign(1), sign(2), sign(4))));
        let separation = up.dot(vertex - ground.position);
        if separation <= margin {
            let position = vertex - up * (separation * R::splat(0.5));
            points.push(ContactPoint { position, separation, feature: corner });
        }
    }
    Manifold::new(up, R::splat(1.0), points)
}

/// Both ends that are near enough. A feature is the number of an end, the lower one on its axis
/// first.
pub(crate) fn half_space_and_capsule<R: Scalar>(
    ground: &Isometry<R>,
    radius: R,
    half_height: R,
    at: &Isometry<R>,
    margin: R,
) -> Manifold<R> {
    let up = ground.up();
    let mut points = Points::none();
    for (feature, end) in [-half_height, half_height].into_iter().enumerate() {
        let center = at.to_world(Vec3::new(R::splat(0.0), end, R::splat(0.0)));
        let separation = up.dot(center - ground.position) - radius;
        if separation <= margin {
            let position = center - up * (radius + separation * R::splat(0.5));
            points.push(ContactPoint { position, separation, feature: feature as u32 });
        }
    }
    Manifold::new(up, R::splat(1.0), points)
}
