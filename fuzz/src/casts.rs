//! A shape of bytes, which is asked: answers agree with each other and with points along the way.

use tumble_collide::{ColliderShape, Isometry, Ray};
use tumble_math::lane::Vec3;

use crate::pairs::Bytes;

/// Points along a way that are tried.
const TRIED: u32 = 64;
/// Errors, as a part of how far everything reaches: what `docs/queries.md` promises.
const ERROR: f64 = 1e-5;

/// Asks a shape of these bytes.
pub fn ask(bytes: &[u8]) {
    let mut bytes = Bytes(bytes.iter());
    let (Some(shape), Some(other)) = (bytes.shape(0), bytes.shape(1)) else { return };
    let at = Isometry { position: bytes.vector(1.0), orientation: bytes.orientation() };
    let [of_shape, of_other] = [&shape, &other].map(|it| it.reach().unwrap_or(1.0));
    let reach = of_shape + of_other;
    // From near or far, at what is asked.
    let origin = at.position + bytes.vector(1.5 * of_shape) + bytes.vector(2.0 * of_other);
    let target = at.position + bytes.vector(0.6 * of_shape);
    let Some(ray) = Ray::new(origin, target - origin, 10.0 * reach) else { return };
    let error = ERROR * (reach + 1.0);
    cast_ray(&shape, &at, &ray, error);
    let point = bytes.vector(2.0 * reach);
    if let Some(near) = shape.nearest_point(&at, point, f64::INFINITY) {
        let off = near.point - point;
        assert!((off.dot(off).sqrt() - near.distance).abs() <= error, "{near:?} of {point:?}");
        assert!(near.distance == 0.0 || !shape.contains(&at, point) || near.distance <= error, "{near:?}");
    }
    let from = Isometry { position: origin, orientation: bytes.orientation() };
    cast_shape((&shape, &at), (&other, &from), &ray, error);
}

/// Nothing of a shape is before the hit of a ray, and something is there.
fn cast_ray(shape: &ColliderShape<f64>, at: &Isometry<f64>, ray: &Ray, error: f64) {
    let hit = shape.cast_ray(at, ray);
    let end = hit.map_or(ray.max_distance(), |hit| hit.distance);
    assert!((0.0..=ray.max_distance()).contains(&end), "{hit:?}");
    if let Some(hit) = hit {
        assert!((hit.normal.dot(hit.normal) - 1.0).abs() < 1e-6, "{hit:?}");
        let near = shape.nearest_point(at, ray.at(hit.distance), f64::INFINITY);
        assert!(near.is_none_or(|near| near.distance <= error), "{hit:?} is {near:?} off");
    }
    for i in 0..TRIED {
        let distance = end * f64::from(i) / f64::from(TRIED);
        let point = ray.at(distance);
        // A point inside by less than the error may be before the hit.
        let is_deep = [Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, 1.0)]
            .iter()
            .all(|axis| [error, -error].iter().all(|by| shape.contains(at, point + *axis * (4.0 * *by))));
        assert!(!is_deep || end - distance <= 8.0 * error, "inside at {distance} of {end}: {shape:?} {at:?} {ray:?}");
    }
}

/// A shape on its way overlaps another nowhere before the hit of its cast.
fn cast_shape(
    (shape, at): (&ColliderShape<f64>, &Isometry<f64>),
    (moved, from): (&ColliderShape<f64>, &Isometry<f64>),
    ray: &Ray,
    error: f64,
) {
    let hit = shape.cast_shape(at, moved, from, ray);
    let end = hit.map_or(ray.max_distance(), |hit| hit.distance);
    assert!((0.0..=ray.max_distance()).contains(&end), "{hit:?}");
    for i in 0..TRIED / 4 {
        let distance = end * f64::from(i) / f64::from(TRIED / 4);
        let there = Isometry { position: ray.at(distance), ..*from };
        let further = Isometry { position: ray.at(distance + 4.0 * error), ..*from };
        let overlaps = |place: &Isometry<f64>| shape.overlap(at, moved, place).is_some();
        // What barely touches may pass.
        let is_through = distance + 8.0 * error < end && overlaps(&there) && overlaps(&further) && hit.is_some();
        assert!(!is_through, "overlap at {distance} of {end}: {shape:?} {at:?} {moved:?} {from:?} {ray:?}");
    }
}
