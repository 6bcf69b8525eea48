//! A ball against other shapes.

use tumble_math::lane::Vec3;

use crate::collider_shape::Isometry;
use crate::manifold::Manifold;
use crate::scalar::Scalar;
use crate::sphere_lanes::sphere_pair;

pub(crate) fn sphere_and_sphere<R: Scalar>(
    first: R,
    first_center: Vec3<R>,
    second: R,
    second_center: Vec3<R>,
    margin: R,
) -> Manifold<R> {
    sphere_pair(first, second, second_center - first_center, margin).of_one(second_center)
}

/// Nearer than this \[m\] two points are one: its square is a normal number in either precision.
const MIN_DISTANCE: f64 = 1e-18;

/// From the box to the ball. A ball whose centre is in the box leaves it through the nearest face.
pub(crate) fn cuboid_and_sphere<R: Scalar>(
    half_extents: Vec3<R>,
    at: &Isometry<R>,
    radius: R,
    center: Vec3<R>,
    margin: R,
) -> Manifold<R> {
    let local = at.to_local(center);
    let (h, zero) = (half_extents, R::splat(0.0));
    let clamp = |x: R, h: R| x.max(zero - h).min(h);
    let nearest = Vec3::new(clamp(local.x, h.x), clamp(local.y, h.y), clamp(local.z, h.z));
    let apart = local - nearest;
    let distance = apart.dot(apart).sqrt();
    let (normal, separation) = if distance > R::splat(MIN_DISTANCE) {
        (apart * (R::splat(1.0) / distance), distance)
    } else {
        way_out(local, h)
    };
    let normal = at.orientation.rotate(normal);
    Manifold::of_point(normal, center - normal * radius, separation - radius, 0, margin)
}

/// The normal of the face that a point inside is nearest to, and minus its distance from it.
fn way_out<R: Scalar>(point: Vec3<R>, h: Vec3<R>) -> (Vec3<R>, R) {
    let (zero, one) = (R::splat(0.0), R::splat(1.0));
    let sign = |x: R| if x < zero { zero - one } else { one };
    let mut best = (Vec3::new(sign(point.x), zero, zero), point.x.abs() - h.x);
    for (normal, separation) in [
        (Vec3::new(zero, sign(point.y), zero), point.y.abs() - h.y),
        (Vec3::new(zero, zero, sign(point.z)), point.z.abs() - h.z),
    ] {
        if separation > best.1 {
            best = (normal, separation);
        }
    }
    best
}
