//! Promise: rays, points and casts against what is as thin as rounding allows, triangles without
//! area and flat hulls, find what is there, and nothing beside it.
//!
//! Why: files are full of slivers, and a hit metres beside one is a shot that hits nothing. It
//! fails if what rounding makes of a side or of a plane is believed. `TUMBLE_RAYS=1000000` draws
//! as many.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod shapes_at_random;

use shapes_at_random::{Random, Vector, length};
use tumble_collide::{ColliderShape, Isometry, Ray};
use tumble_math::lane::Vec3;

/// Part of the size and the distance that rounding may be.
const ROUNDING: f64 = 1e-9;
/// The same of distances to what is nearly touched: they are roots of squares.
const ROUNDING_OF_DISTANCE: f64 = 2e-7;

fn rays() -> u64 {
    std::env::var("TUMBLE_RAYS").ok().and_then(|count| count.parse().ok()).unwrap_or(4000)
}

/// Hulls as flat as rounding allows, of which faces are joined: what is beside their rim is
/// outside, and what is met is there.
#[test]
fn flat_hulls_end_at_their_rim() {
    let (mut hits, mut beside) = (0, 0);
    for case in 0..rays() {
        let mut random = Random::new(case);
        let size = random.log_between(1e-3, 1e2);
        let thin = random.log_between(1e-8, 1e-2);
        let count = 4 + random.below(12);
        let turn = random.rotation();
        let points: Vec<_> =
            (0..count).map(|_| turn.rotate(random.vector(size).scale(Vec3::new(1.0, thin, 1.0)))).collect();
        let Ok(hull) = tumble_collide::ConvexHull::new(&points) else { continue };
        let hull = ColliderShape::<f64>::Hull(std::sync::Arc::new(hull));
        let at = random.placement(size);
        let turned = |at: &Isometry<f64>, v: Vector| at.orientation.rotate(turn.rotate(v));
        for _ in 0..8 {
            let target = at.position + turned(&at, random.vector(size).scale(Vec3::new(1.0, thin, 1.0)));
            let direction = match random.below(3) {
                0 => random.direction(),
                // Nearly in its plane.
                1 => turned(&at, random.direction().scale(Vec3::new(1.0, 10.0 * thin, 1.0))),
                _ => turned(&at, Vec3::new(0.0, -1.0, 0.0)),
            };
            let begin = target - direction * (size * random.log_between(1.0, 1e3));
            let ray = Ray::new(begin, direction, f64::INFINITY).unwrap();
            let far = size + length(ray.origin() - at.position);
            if let Some(hit) = hull.cast_ray(&at, &ray) {
                hits += 1;
                let off = hull.nearest_point(&at, ray.at(hit.distance), f64::INFINITY).unwrap().distance;
                // The planes of joined faces may differ by 1.42e-5 rad, over the diagonal.
                let tolerance = 1.42e-5 * 8.0_f64.sqrt() * size + ROUNDING_OF_DISTANCE * far;
                assert!(off <= tolerance, "case {case}: {off} m off {size}: {hull:?} {at:?} {ray:?}");
            }
            let point = at.position + random.vector(2.0 * size);
            let near = hull.nearest_point(&at, point, f64::INFINITY).unwrap();
            beside += usize::from(near.distance > 1e-4 * size);
            assert!(!hull.contains(&at, point) || near.distance <= 1e-4 * size, "case {case}: {near:?}");
        }
    }
    assert!(hits as u64 > rays() && beside as u64 > rays(), "{hits} hits, {beside} beside");
}

/// Triangles that are little more than a line, by rounding nothing but one or a point; and any that
/// are seen from their side. What of them is met is there, and has a normal.
#[test]
fn thin_triangles_are_met_where_they_are() {
    let mut hits = [0; 3];
    for case in 0..rays() {
        let mut random = Random::new(case);
        let size = random.log_between(1e-3, 1e3);
        // On a grid as often as not: sides along the axes are what files are made of.
        let step = if random.often(0.5) { size / 8.0 } else { size * 1e-12 };
        let place = |v: Vector| {
            Vec3::new((v.x / step).round() * step, (v.y / step).round() * step, (v.z / step).round() * step)
        };
        let (from, way) = (place(random.vector(size)), place(random.vector(size)));
        let shares = [0.0, random.unit(), if random.often(0.2) { 0.0 } else { random.between(-2.0, 2.0) }];
        let mut corners = shares.map(|share| from + way * share);
        let kind = random.below(3);
        if kind > 0 {
            let thin = if kind == 1 { random.log_between(1e-18, 1e-6) } else { random.log_between(1e-6, 1.0) };
            corners[1] = corners[1] + random.direction() * (thin * size);
        }
        let mesh = tumble_collide::Mesh::new(&corners, &[[0, 1, 2]]).unwrap();
        let mesh = ColliderShape::<f64>::Mesh(std::sync::Arc::new(mesh));
        let at = if random.often(0.5) { Isometry::at(Vec3::zero()) } else { random.placement(size) };
        let side = |from: usize, to: usize| length(corners[to] - corners[from]);
        let longest = side(0, 1).max(side(1, 2)).max(side(2, 0));
        for _ in 0..16 {
            let [a, b] = [random.unit(), random.unit()];
            let within = corners[0] + (corners[1] - corners[0]) * a + (corners[2] - corners[0]) * b;
            let target = at.position + at.orientation.rotate(within);
            let [c, d] = [random.between(-1.0, 1.0), random.between(-1.0, 1.0)];
            let aside = (corners[1] - corners[0]) * c + (corners[2] - corners[0]) * d;
            let along = match random.below(3) {
                0 => random.direction(),
                1 => at.orientation.rotate(aside) + random.direction() * (size * random.log_between(1e-18, 1e-3)),
                _ => Vec3::new(0.0, -1.0, 0.0),
            };
            // A ball on it is met at once.
            let ball = ColliderShape::Sphere { radius: size * random.log_between(1e-3, 1.0) };
            let corner = at.position + at.orientation.rotate(corners[0]);
            let target = if random.often(0.1) { corner } else { target };
            let from = Isometry { position: target, orientation: random.rotation() };
            let met = Ray::new(target, along, size).and_then(|ray| mesh.cast_shape(&at, &ball, &from, &ray));
            let overlap = mesh.overlap(&at, &ball, &from).is_some();
            assert_eq!(
                overlap,
                met.is_some_and(|met| met.distance == 0.0),
                "case {case}: {corners:?} {from:?} {met:?}"
            );
            let far = size * random.log_between(1.0, 1e3);
            let Some(ray) = Ray::new(target, along, f64::INFINITY) else { continue };
            let ray = Ray::new(target - ray.direction() * far, along, f64::INFINITY).unwrap();
            let Some(hit) = mesh.cast_ray(&at, &ray) else { continue };
            hits[kind] += 1;
            assert!((length(hit.normal) - 1.0).abs() < 1e-12, "case {case}: {hit:?}");
            let off = mesh.nearest_point(&at, ray.at(hit.distance), f64::INFINITY).unwrap().distance;
            // Where the width of a triangle is the root of its rounding, both count as much.
            let tolerance = ROUNDING * far + (16.0 * f64::EPSILON).sqrt() * longest;
            assert!(off <= tolerance, "case {case}: {off} m off, {far} m away: {hit:?} {corners:?} {at:?} {ray:?}");
        }
    }
    // What rounding makes of such triangles is drawn.
    assert!(hits.iter().all(|hits| *hits > rays() / 100), "{hits:?} hits");
}
