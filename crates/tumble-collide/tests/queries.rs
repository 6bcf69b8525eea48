//! Promise: rays, points, overlaps and casts against every shape say what its surface says, near
//! misses included.
//!
//! Why: a shot that slips between two triangles, or is stopped by air, is the fault that people
//! see. Lines have closed forms, distances come from another method, and both are tested against
//! each other and against what is furthest in a direction. `TUMBLE_RAYS=1000000` draws as many of
//! each shape; without it some thousands.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

mod shapes_at_random;

use shapes_at_random::{Random, SOLID, Vector, compound, hills, length, solid};
use tumble_collide::{ColliderShape, Isometry, Ray};
use tumble_math::lane::Vec3;

/// Part of the size and the distance that rounding may be.
const ROUNDING: f64 = 1e-9;
/// The same of distances to what is nearly touched: they are roots of squares.
const ROUNDING_OF_DISTANCE: f64 = 2e-7;

fn rays() -> u64 {
    std::env::var("TUMBLE_RAYS").ok().and_then(|count| count.parse().ok()).unwrap_or(4000)
}

/// A point on the surface of a solid shape, and the normal there, world frame.
fn on_surface(shape: &ColliderShape<f64>, at: &Isometry<f64>, random: &mut Random) -> (Vector, Vector) {
    let direction = random.direction();
    let local = shape.furthest(at.orientation.rotate_back(direction)).unwrap();
    (at.position + at.orientation.rotate(local), direction)
}

/// A ray at a shape: anywhere near it, grazing it, along an axis, or from inside.
fn aimed(shape: &ColliderShape<f64>, at: &Isometry<f64>, size: f64, random: &mut Random) -> Ray {
    let (point, normal) = on_surface(shape, at, random);
    let far = size * random.log_between(1e-3, 1e3);
    let (target, direction) = match random.below(4) {
        0 => (at.position + random.vector(size), random.direction()),
        1 => {
            // Past the surface, or through a little of it.
            let along = random.direction();
            let tangent = along - normal * along.dot(normal);
            (point + normal * (size * random.between(-1e-4, 1e-4)), tangent)
        }
        2 => {
            let mut axis = [0.0; 3];
            axis[random.below(3)] = if random.often(0.5) { 1.0 } else { -1.0 };
            (
                point - normal * (size * random.between(0.0, 0.1)),
                at.orientation.rotate(Vec3::new(axis[0], axis[1], axis[2])),
            )
        }
        _ => (at.position, random.direction()),
    };
    let begin = if random.often(0.1) { 0.0 } else { far };
    let max = if random.often(0.2) { far } else { f64::INFINITY };
    Ray::new(target - direction * (begin / length(direction)), direction, max).unwrap()
}

/// How far a ray is from a convex shape where it is nearest: distances along it are convex.
fn nearest_along(shape: &ColliderShape<f64>, at: &Isometry<f64>, ray: &Ray, most: f64) -> (f64, Vector) {
    let distance = |t: f64| shape.nearest_point(at, ray.at(t), f64::INFINITY).unwrap().distance;
    let (mut low, mut high) = (0.0, most);
    for _ in 0..200 {
        let third = (high - low) / 3.0;
        let (a, b) = (low + third, high - third);
        if distance(a) <= distance(b) { high = b } else { low = a }
    }
    (distance(0.5 * (low + high)), ray.at(0.5 * (low + high)))
}

/// Whether a point is inside by more than a length.
fn is_deep(shape: &ColliderShape<f64>, at: &Isometry<f64>, point: Vector, by: f64) -> bool {
    (0..26).all(|i| {
        let d = [i % 3, i / 3 % 3, i / 9].map(|k| f64::from(k) - 1.0);
        shape.contains(at, point + Vec3::new(d[0], d[1], d[2]) * by)
    })
}

fn check_rays(kind: &str) {
    let (mut hits, mut misses) = (0, 0);
    for case in 0..rays() {
        let mut random = Random::new(case);
        let (shape, size) = solid(kind, &mut random);
        let world = size * random.log_between(1.0, 1e4);
        let at = random.placement(world);
        let ray = aimed(&shape, &at, size, &mut random);
        let scale = size + length(ray.origin() - at.position);
        let tolerance = ROUNDING * scale;
        let label = || format!("{kind}, case {case}: {shape:?} {at:?} {ray:?}");
        let Some(hit) = shape.cast_ray(&at, &ray) else {
            misses += 1;
            let most = ray.max_distance().min(10.0 * scale);
            let (distance, point) = nearest_along(&shape, &at, &ray, most);
            assert!(distance > 0.0 || !is_deep(&shape, &at, point, tolerance), "got through: {}", label());
            continue;
        };
        hits += 1;
        assert!(hit.distance >= 0.0 && hit.distance <= ray.max_distance(), "{}", label());
        assert!((length(hit.normal) - 1.0).abs() < 1e-12, "{}", label());
        if hit.distance == 0.0 {
            let found = shape.nearest_point(&at, ray.origin(), f64::INFINITY).unwrap();
            assert!(found.distance <= tolerance, "not inside: {}", label());
            assert_eq!(hit.normal, ray.direction() * -1.0);
            continue;
        }
        // On the surface, from outside, along the normal of a plane that nothing is beyond.
        let point = ray.at(hit.distance);
        let found = shape.nearest_point(&at, point, f64::INFINITY).unwrap();
        assert!(found.distance <= ROUNDING_OF_DISTANCE * scale, "{} m off: {}", found.distance, label());
        assert!(hit.normal.dot(ray.direction()) <= 1e-9, "{}", label());
        let furthest = shape.furthest(at.orientation.rotate_back(hit.normal)).unwrap();
        let furthest = at.position + at.orientation.rotate(furthest);
        let over = hit.normal.dot(furthest - point);
        assert!(over.abs() <= 1e-6 * scale, "normal of a plane {over} m inside: {}", label());
        for _ in 0..8 {
            let before = ray.at(hit.distance * random.between(0.0, 1.0 - 1e-6));
            assert!(!is_deep(&shape, &at, before, tolerance), "inside before: {}", label());
        }
    }
    // The class is drawn as meant.
    assert!(hits > rays() / 10 && misses > rays() / 20, "{kind}: {hits} hits, {misses} misses");
}

#[test]
fn rays_meet_round_shapes_where_they_are() {
    ["sphere", "capsule", "tapered", "ellipsoid"].into_iter().for_each(check_rays);
}

#[test]
fn rays_meet_shapes_with_caps_where_they_are() {
    ["cylinder", "cone", "frustum"].into_iter().for_each(check_rays);
}

#[test]
fn rays_meet_boxes_and_hulls_where_they_are() {
    ["cuboid", "hull"].into_iter().for_each(check_rays);
}

/// The nearest point of a shape, and that nothing of it is nearer: all of it is beyond the plane
/// through that point.
#[test]
fn the_nearest_point_is_the_nearest() {
    for kind in SOLID {
        for case in 0..rays() / 4 {
            let mut random = Random::new(case);
            let (shape, size) = solid(kind, &mut random);
            let at = random.placement(size * 10.0);
            let (surface, normal) = on_surface(&shape, &at, &mut random);
            let off = size * random.log_between(1e-3, 1e2);
            let point =
                if random.often(0.5) { surface + normal * off } else { at.position + random.vector(2.0 * size) };
            let found = shape.nearest_point(&at, point, f64::INFINITY).unwrap();
            let label = || format!("{kind}, case {case}: {shape:?} {at:?} {point:?}");
            assert!(
                (length(point - found.point) - found.distance).abs() <= ROUNDING * (size + found.distance),
                "{}",
                label()
            );
            assert_eq!(shape.contains(&at, point), found.distance == 0.0, "{}", label());
            if found.distance > 1e-6 * size {
                let away = (point - found.point) * (1.0 / found.distance);
                let furthest = shape.furthest(at.orientation.rotate_back(away)).unwrap();
                let furthest = at.position + at.orientation.rotate(furthest);
                let nearer = away.dot(furthest - found.point);
                assert!(nearer <= 1e-6 * (size + found.distance), "{nearer} m nearer: {}", label());
                assert!(shape.nearest_point(&at, point, 0.99 * found.distance).is_none());
            }
        }
    }
}

/// A height field, the mesh of its triangles, and each of them by itself.
#[test]
fn rays_meet_the_first_triangle_of_surfaces() {
    let mut hits = 0;
    for case in 0..rays() {
        let mut random = Random::new(case);
        let (field, mesh, size) = hills(&mut random);
        let ColliderShape::Mesh(triangles) = &mesh else { unreachable!() };
        let at = random.placement(size);
        let to_world = |point: Vector| at.position + at.orientation.rotate(point);
        // At an edge or a corner as often as anywhere.
        let [a, b, c] = triangles.triangles()[random.below(triangles.triangles().len())];
        let corners = [a, b, c].map(|corner| triangles.points()[corner as usize]);
        let kind = random.below(3);
        let target = match kind {
            0 => corners[0],
            1 => corners[0] + (corners[1] - corners[0]) * random.unit(),
            _ => random.vector(size),
        };
        let direction =
            if random.often(0.2) { at.orientation.rotate(Vec3::new(0.0, -1.0, 0.0)) } else { random.direction() };
        let far = random.log_between(1e-2, 1e2) * size;
        let ray = Ray::new(to_world(target) - direction * far, direction, f64::INFINITY).unwrap();
        let by_itself = triangles.triangles().iter().filter_map(|corners| {
            let [a, b, c] = corners.map(|corner| to_world(triangles.points()[corner as usize]));
            // S. Moller, B. Trumbore: the volume of the triangle and the ray, and its parts.
            let normal = (b - a).cross(c - a);
            let t = normal.dot(a - ray.origin()) / normal.dot(ray.direction());
            let p = ray.at(t);
            let inside =
                [(a, b), (b, c), (c, a)].iter().all(|(from, to)| normal.dot((*to - *from).cross(p - *from)) >= 0.0);
            (inside && t >= 0.0).then_some(t)
        });
        let expected = by_itself.reduce(f64::min);
        let (of_field, of_mesh) = (field.cast_ray(&at, &ray), mesh.cast_ray(&at, &ray));
        let label = || format!("case {case}: {of_field:?} {of_mesh:?} {expected:?}");
        // Where the surface ends, or bends away, rounding decides.
        assert!(kind < 2 || of_field.is_some() == of_mesh.is_some(), "{}", label());
        let (Some(of_field), Some(of_mesh)) = (of_field, of_mesh) else {
            continue;
        };
        hits += 1;
        // Of two triangles at an edge it may be either.
        assert!(kind < 2 || of_field.triangle == of_mesh.triangle, "{}", label());
        assert!((of_field.distance - of_mesh.distance).abs() <= 1e-12 * (size + far), "{}", label());
        assert!(of_mesh.normal.dot(ray.direction()) <= 0.0);
        if let Some(expected) = expected.filter(|_| kind == 2) {
            assert!((of_mesh.distance - expected).abs() <= 1e-9 * (size + far), "{}", label());
        }
    }
    assert!(hits > rays() / 4, "{hits} hits");
}

/// No ray slips through a closed surface, however it is aimed at edges and corners.
#[test]
fn closed_surfaces_are_watertight() {
    for case in 0..rays() {
        let mut random = Random::new(case);
        let (hull, size) = solid("hull", &mut random);
        let ColliderShape::Hull(hull_of) = &hull else { unreachable!() };
        let points: Vec<_> = hull_of.points().iter().map(|point| (*point).into()).collect();
        let surface = tumble_math::convex_hull(&points).unwrap();
        let positions: Vec<Vector> = surface.positions().iter().map(|position| (*position).into()).collect();
        let mesh = tumble_collide::Mesh::new(&positions, surface.triangles()).unwrap();
        let mesh = ColliderShape::<f64>::Mesh(std::sync::Arc::new(mesh));
        let at = random.placement(size);
        let edges: Vec<_> = hull_of.edges().collect();
        let [a, b] = edges[random.below(edges.len())];
        let share = if random.often(0.3) { 0.0 } else { random.unit() };
        let target = at.position + at.orientation.rotate(a + (b - a) * share);
        let inside = hull_of.points().iter().fold(Vec3::zero(), |sum: Vector, point| sum + *point)
            * (1.0 / hull_of.points().len() as f64);
        let inside = at.position + at.orientation.rotate(inside);
        // From inside out through an edge.
        let out = Ray::new(inside, target - inside, f64::INFINITY).unwrap();
        let hit = mesh.cast_ray(&at, &out);
        let hit = hit.unwrap_or_else(|| panic!("case {case}: got out through an edge"));
        assert!((hit.distance - length(target - inside)).abs() <= 1e-9 * size, "case {case}: {hit:?}");
        // And from far away back to the middle.
        let far = target + (target - inside) * random.log_between(1.0, 1e3);
        let back = Ray::new(far, inside - far, f64::INFINITY).unwrap();
        let (of_mesh, of_hull) = (mesh.cast_ray(&at, &back), hull.cast_ray(&at, &back));
        let (of_mesh, of_hull) = (of_mesh.unwrap(), of_hull.unwrap());
        // Faces of a hull that lie in one plane to 1.4e-5 rad are one.
        let apart = (of_mesh.distance - of_hull.distance) * of_mesh.normal.dot(back.direction());
        assert!(apart.abs() <= 3e-5 * size, "case {case}: {apart}");
    }
}

/// The nearest point of a surface is that of the nearest of its triangles.
#[test]
fn the_nearest_point_of_surfaces_is_on_the_nearest_triangle() {
    for case in 0..rays() / 4 {
        let mut random = Random::new(case);
        let (field, mesh, size) = hills(&mut random);
        let ColliderShape::Mesh(triangles) = &mesh else { unreachable!() };
        let at = random.placement(size);
        let point = at.position + random.vector(size);
        let one = |corners: [u32; 3]| {
            let points = corners.map(|corner| triangles.points()[corner as usize]);
            let mesh = tumble_collide::Mesh::new(&points, &[[0, 1, 2]]).unwrap();
            let mesh = ColliderShape::<f64>::Mesh(std::sync::Arc::new(mesh));
            mesh.nearest_point(&at, point, f64::INFINITY).unwrap().distance
        };
        let expected = triangles.triangles().iter().map(|corners| one(*corners)).fold(f64::INFINITY, f64::min);
        for surface in [&field, &mesh] {
            let found = surface.nearest_point(&at, point, f64::INFINITY).unwrap();
            assert!((found.distance - expected).abs() <= 1e-9 * size, "case {case}: {found:?} {expected}");
            assert!((length(found.point - point) - expected).abs() <= 1e-9 * size);
            assert!(surface.nearest_point(&at, point, 0.999 * expected).is_none());
        }
    }
}

/// Two shapes overlap where a point of one is in the other, and do not where a plane parts them;
/// what is cast stops where it touches.
#[test]
fn what_is_cast_stops_where_it_touches() {
    let (mut hits, mut misses, mut overlaps) = (0, 0, 0);
    for case in 0..rays() {
        let mut random = Random::new(case);
        let ((still, size), (moved, other)) = (
            solid(SOLID[random.below(SOLID.len())], &mut random),
            solid(SOLID[random.below(SOLID.len())], &mut random),
        );
        let reach = size + other;
        let apart = if random.often(0.2) { 0.3 } else { 2.0 };
        let (at, from) = (random.placement(reach), random.placement(apart * reach));
        let from = if apart < 1.0 { Isometry { position: at.position + from.position, ..from } } else { from };
        let direction = if random.often(0.5) { at.position - from.position } else { random.direction() };
        let ray = Ray::new(from.position, direction, 6.0 * reach).unwrap();
        let label = || format!("case {case}: {still:?} {at:?} {moved:?} {from:?} {direction:?}");
        let moved_by = |distance: f64| Isometry { position: from.position + ray.direction() * distance, ..from };
        let overlap = still.overlap(&at, &moved, &from).is_some();
        assert_eq!(overlap, moved.overlap(&from, &still, &at).is_some(), "{}", label());
        let cast = still.cast_shape(&at, &moved, &from, &ray);
        let tolerance = 1e-6 * reach;
        let Some(hit) = cast else {
            misses += 1;
            assert!(!overlap, "{}", label());
            for _ in 0..64 {
                let here = moved_by(random.between(0.0, ray.max_distance()));
                let deep = Isometry { position: here.position, ..here };
                assert!(
                    still.overlap(&at, &moved, &deep).is_none() || is_grazing(&still, &at, &moved, &here, reach),
                    "got through: {}",
                    label()
                );
            }
            continue;
        };
        if overlap {
            overlaps += 1;
            assert_eq!(hit.distance, 0.0, "{}", label());
            continue;
        }
        hits += 1;
        assert!(
            still.overlap(&at, &moved, &moved_by(hit.distance - tolerance.min(hit.distance))).is_none()
                || is_grazing(&still, &at, &moved, &moved_by(hit.distance - tolerance.min(hit.distance)), reach),
            "too far: {}",
            label()
        );
        // It touches: pressed against the normal by a little, they overlap.
        let pressed = moved_by(hit.distance);
        let pressed = Isometry { position: pressed.position - hit.normal * tolerance, ..pressed };
        assert!(still.overlap(&at, &moved, &pressed).is_some(), "not there yet: {hit:?} {}", label());
        assert!(hit.normal.dot(ray.direction()) <= 1e-6, "{}", label());
        for (shape, place) in [(&still, at), (&moved, moved_by(hit.distance))] {
            let off = shape.nearest_point(&place, hit.point, f64::INFINITY).unwrap().distance;
            assert!(off <= 10.0 * tolerance, "the point is {off} m off: {}", label());
        }
    }
    assert!(hits > rays() / 10 && misses > rays() / 10 && overlaps > rays() / 20, "{hits} {misses} {overlaps}");
}

/// Whether two shapes overlap by rounding only: apart by a millionth they do not.
fn is_grazing(
    still: &ColliderShape<f64>,
    at: &Isometry<f64>,
    moved: &ColliderShape<f64>,
    moved_at: &Isometry<f64>,
    reach: f64,
) -> bool {
    (0..26).any(|i| {
        let d = [i % 3, i / 3 % 3, i / 9].map(|k| f64::from(k) - 1.0);
        let apart = Vec3::new(d[0], d[1], d[2]) * (1e-6 * reach);
        still.overlap(at, moved, &Isometry { position: moved_at.position + apart, ..*moved_at }).is_none()
    })
}

/// What is cast at a surface stops at the first of its triangles.
#[test]
fn what_is_cast_at_surfaces_stops_at_the_first_triangle() {
    let mut hits = 0;
    for case in 0..rays() / 4 {
        let mut random = Random::new(case);
        let (field, mesh, size) = hills(&mut random);
        let ColliderShape::Mesh(triangles) = &mesh else { unreachable!() };
        let (moved, _) = solid(SOLID[random.below(SOLID.len())], &mut random);
        let at = random.placement(size);
        let from =
            Isometry { position: at.position + random.direction() * (2.0 * size), orientation: random.rotation() };
        let target = at.position + random.vector(0.3 * size);
        let ray = Ray::new(from.position, target - from.position, f64::INFINITY).unwrap();
        let one = |corners: [u32; 3]| {
            let points = corners.map(|corner| triangles.points()[corner as usize]);
            let mesh = tumble_collide::Mesh::new(&points, &[[0, 1, 2]]).unwrap();
            ColliderShape::Mesh(std::sync::Arc::new(mesh)).cast_shape(&at, &moved, &from, &ray)
        };
        let all = triangles.triangles().iter().filter_map(|corners| one(*corners)).map(|hit| hit.distance);
        let expected = all.reduce(f64::min);
        for surface in [&field, &mesh] {
            let hit = surface.cast_shape(&at, &moved, &from, &ray);
            let distance = hit.map(|hit| hit.distance);
            assert_eq!(distance, expected, "case {case}");
            let overlap = surface.overlap(&at, &moved, &from).is_some();
            assert!(!overlap || distance == Some(0.0), "case {case}");
            // The surface that is moved the other way meets the shape where that would meet it.
            let back = Ray::new(at.position, ray.direction() * -1.0, f64::INFINITY).unwrap();
            let mirrored = moved.cast_shape(&from, surface, &at, &back);
            assert_eq!(mirrored.is_some(), hit.is_some(), "case {case}");
            let Some((hit, mirrored)) = hit.zip(mirrored).filter(|_| !overlap) else { continue };
            assert!((mirrored.distance - hit.distance).abs() <= 1e-5 * size, "case {case}");
            let along = ray.direction() * hit.distance;
            let off = mirrored.point + along - hit.point;
            assert!(hit.triangle != mirrored.triangle || off.dot(off).sqrt() <= 1e-3 * size, "case {case}: {off:?}");
            assert!(mirrored.normal.dot(ray.direction()) >= -1e-6, "case {case}");
        }
        hits += usize::from(expected.is_some());
    }
    assert!(hits as u64 > rays() / 16, "{hits} hits");
}

/// Compounds give what the nearest of their parts gives.
#[test]
fn compounds_are_their_parts() {
    for case in 0..rays() {
        let mut random = Random::new(case);
        let (shape, size) = compound(&mut random);
        let ColliderShape::Compound(parts) = &shape else { unreachable!() };
        let at = random.placement(size);
        let target = at.position + random.vector(size);
        let ray = Ray::new(target + random.direction() * (3.0 * size), random.direction(), f64::INFINITY).unwrap();
        let placed = || (0_u32..).zip(parts.parts()).map(|(part, (inner, shape))| (part, at.then(inner), shape));
        let first = placed().filter_map(|(part, at, shape)| shape.cast_ray(&at, &ray).map(|hit| (hit.distance, part)));
        let first = first.fold(None, |first: Option<(f64, u32)>, hit| {
            Some(first.map_or(hit, |first| if hit.0 < first.0 { hit } else { first }))
        });
        let found = shape.cast_ray(&at, &ray);
        assert_eq!(found.map(|hit| hit.part), first.map(|(_, part)| part), "case {case}");
        if let (Some(found), Some((distance, _))) = (found, first) {
            assert!((found.distance - distance).abs() <= ROUNDING * size, "case {case}: {found:?} {distance}");
        }
        let nearest = placed()
            .filter_map(|(_, at, shape)| shape.nearest_point(&at, target, f64::INFINITY))
            .map(|found| found.distance);
        let nearest = nearest.fold(f64::INFINITY, f64::min);
        let found = shape.nearest_point(&at, target, f64::INFINITY).unwrap();
        assert!((found.distance - nearest).abs() <= ROUNDING * size, "case {case}: {found:?} {nearest}");
        assert_eq!(
            shape.contains(&at, target),
            placed().any(|(_, at, shape)| shape.contains(&at, target)),
            "case {case}"
        );
    }
}

/// The half-space against its plane.
#[test]
fn half_spaces_end_at_their_plane() {
    for case in 0..rays() {
        let mut random = Random::new(case);
        let at = random.placement(100.0);
        let up = at.orientation.rotate(Vec3::new(0.0, 1.0, 0.0));
        let ground = ColliderShape::<f64>::HalfSpace;
        let ray = Ray::new(random.vector(100.0), random.direction(), random.log_between(1.0, 1e3)).unwrap();
        let (height, rate) = (up.dot(ray.origin() - at.position), up.dot(ray.direction()));
        let expected = if height <= 0.0 {
            Some(0.0)
        } else {
            Some(-height / rate).filter(|t| rate < 0.0 && *t <= ray.max_distance())
        };
        let hit = ground.cast_ray(&at, &ray);
        assert_eq!(hit.is_some(), expected.is_some(), "case {case}");
        if let (Some(hit), Some(expected)) = (hit, expected) {
            assert!((hit.distance - expected).abs() <= 1e-9 * (1.0 + expected), "case {case}");
            assert!(height <= 0.0 || length(hit.normal - up) < 1e-12);
        }
        let (shape, size) = solid(SOLID[random.below(SOLID.len())], &mut random);
        let body = random.placement(100.0);
        let lowest = shape.furthest(body.orientation.rotate_back(up * -1.0)).unwrap();
        let lowest = up.dot(body.position + body.orientation.rotate(lowest) - at.position);
        assert_eq!(ground.overlap(&at, &shape, &body).is_some(), lowest <= 0.0, "case {case}");
        let down = Ray::new(body.position, up * -1.0, f64::INFINITY).unwrap();
        let hit = ground.cast_shape(&at, &shape, &body, &down).unwrap();
        assert!((hit.distance - lowest.max(0.0)).abs() <= 1e-9 * (100.0 + size), "case {case}");
        assert!(
            ground.cast_shape(&at, &shape, &body, &Ray::new(body.position, up, f64::INFINITY).unwrap()).is_none()
                || lowest <= 0.0
        );
    }
}

#[test]
fn numbers_that_are_none_meet_nothing() {
    let zero = Vec3::<f64>::zero();
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert!(Ray::new(Vec3::new(bad, 0.0, 0.0), Vec3::new(1.0, 0.0, 0.0), 1.0).is_none());
        assert!(Ray::new(zero, Vec3::new(bad, 1.0, 0.0), 1.0).is_none());
    }
    assert!(Ray::new(zero, Vec3::new(1.0, 0.0, 0.0), f64::NAN).is_none());
    assert!(Ray::new(zero, Vec3::new(1.0, 0.0, 0.0), -1.0).is_none());
    for size in [1e-300, 1e-30, 1e30, 1e300] {
        let ray = Ray::new(zero, Vec3::new(size, 0.0, 0.0), 1.0).unwrap();
        assert_eq!(ray.direction(), Vec3::new(1.0, 0.0, 0.0));
    }
    let ray = Ray::new(zero, Vec3::new(1.0, 0.0, 0.0), f64::INFINITY).unwrap();
    for kind in SOLID {
        let (shape, _) = solid(kind, &mut Random::new(1));
        let nowhere = Isometry::at(Vec3::new(f64::NAN, 0.0, 0.0));
        assert_eq!(shape.cast_ray(&nowhere, &ray), None, "{kind}");
        assert!(!shape.contains(&nowhere, zero), "{kind}");
        assert_eq!(shape.overlap(&nowhere, &shape, &Isometry::at(zero)), None, "{kind}");
    }
}
