//! Promise: the convex hull of any points is a closed convex mesh around all of them, the same
//! whatever their order, or says why there is none.
//!
//! It fails if points on a face or an edge, or at one place, give triangles without area, holes or
//! points outside.

use std::f64::consts::PI;

use glam::{DAffine3, DQuat, DVec3};
use proptest::prelude::*;
use tumble_math::{HullError, MeshDefect, TriangleMesh, convex_hull};
use tumble_tests::meshes::sphere;

/// Closed, and no point further out of a face than is promised on the grid: two steps. Point and
/// corners are moved to the grid by up to half a step on each axis, and beyond its corners the
/// face's plane tilts with that, the more the narrower the face. Returns the volume.
fn check(points: &[DVec3], hull: &TriangleMesh) -> f64 {
    let solid = hull.solid().unwrap_or_else(|error| panic!("{error}"));
    assert!(hull.audit().problems().iter().all(MeshDefect::is_harmless));
    assert_eq!(hull.triangles().len(), 2 * hull.positions().len() - 4, "a sphere by Euler's formula");
    let (low, high) = hull.audit().extents;
    let extent = (high - low).max_element();
    let step = extent * 2.0_f64.powi(-37);
    for corners in hull.triangles() {
        let [a, b, c] = corners.map(|corner| hull.positions()[corner as usize]);
        let normal = (b - a).cross(c - a);
        let longest = (b - a).length().max((c - a).length()).max((c - b).length());
        let narrowest = normal.length() / longest;
        for point in points {
            let height = normal.dot(*point - a) / normal.length();
            let tilt = 1.0 + (*point - a).length() / narrowest;
            assert!(height <= (2.0 + tilt) * step, "{point} is {height:e} above {a} {b} {c}");
        }
    }
    solid.volume()
}

fn hull(points: &[DVec3]) -> TriangleMesh {
    convex_hull(points).unwrap()
}

/// The points in some other order.
fn shuffled(points: &[DVec3], seed: u64) -> Vec<DVec3> {
    let mut points = points.to_vec();
    let mut rng = seed;
    for i in (1..points.len()).rev() {
        rng = rng.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        points.swap(i, (rng >> 33) as usize % (i + 1));
    }
    points
}

fn grid(steps: i32) -> Vec<DVec3> {
    let axis = move || (0..=steps).map(move |i| f64::from(i) / f64::from(steps));
    axis().flat_map(|x| axis().flat_map(move |y| axis().map(move |z| DVec3::new(x, y, z)))).collect()
}

#[test]
fn a_cube_of_points_has_eight_corners() {
    let points = grid(8);
    for seed in 0..20 {
        let points = shuffled(&points, seed);
        let hull = hull(&points);
        assert_eq!((hull.positions().len(), hull.triangles().len()), (8, 12));
        assert_eq!(check(&points, &hull), 1.0);
    }
    // Turned, the sides are planes only to the grid's steps, and some points on edges may remain as
    // corners.
    for (scale, offset) in [(1.0, 0.0), (1e-30, 0.0), (1e40, 0.0), (1.0, 1e3)] {
        let transform = DAffine3::from_scale_rotation_translation(
            DVec3::splat(scale),
            DQuat::from_axis_angle(DVec3::new(0.48, 0.6, 0.64), 0.7),
            DVec3::splat(offset),
        );
        let points: Vec<DVec3> = points.iter().map(|p| transform.transform_point3(*p)).collect();
        let hull = hull(&points);
        assert!(hull.positions().len() < 8 + 12 * 7, "{} corners", hull.positions().len());
        let volume = check(&points, &hull);
        assert!((volume / scale.powi(3) - 1.0).abs() <= 1e-10, "{volume:e}");
    }
}

#[test]
fn a_sphere_keeps_all_its_points() {
    let ball = sphere(2.0, 4);
    let points = shuffled(ball.positions(), 7);
    let hull = hull(&points);
    assert_eq!(hull.positions(), &points[..], "every point is a corner, in the order given");
    let volume = check(&points, &hull);
    // Of all surfaces over these points the convex one holds the most, and less than the ball.
    assert!(volume >= ball.solid().unwrap().volume() && volume < 32.0 / 3.0 * PI);
}

/// Quadratic work would take minutes: 1e10 determinants.
#[test]
fn a_hundred_thousand_points_of_a_sphere_take_seconds() {
    // A spiral (golden angle), so that no four points are special.
    let count = 100_000;
    let golden = PI * (3.0 - 5.0_f64.sqrt());
    let points: Vec<DVec3> = (0..count)
        .map(|i| {
            let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
            let (sin, cos) = (golden * f64::from(i)).sin_cos();
            DVec3::new(cos * (1.0 - z * z).sqrt(), sin * (1.0 - z * z).sqrt(), z)
        })
        .collect();
    let hull = hull(&points);
    assert_eq!(hull.positions().len(), count as usize);
    let volume = hull.solid().unwrap().volume();
    // With n points the gap of a facet is about 2 pi / n of its radius, half of it on average,
    // thrice in volume.
    assert!((volume / (4.0 / 3.0 * PI) - 1.0).abs() <= 20.0 / f64::from(count));
}

#[test]
fn what_has_no_hull_says_why() {
    let line: Vec<DVec3> = (0..10).map(|i| DVec3::new(1.0, 2.0, -3.0) * f64::from(i)).collect();
    let plane: Vec<DVec3> = grid(3).into_iter().filter(|p| p.z == 0.0).collect();
    let tilted: Vec<DVec3> = plane.iter().map(|p| DQuat::from_rotation_x(0.3) * *p).collect();
    for points in [vec![DVec3::ONE; 6], line, plane, tilted, vec![DVec3::ZERO, DVec3::X * 1e-300, DVec3::Y, DVec3::X]] {
        assert_eq!(convex_hull(&points).unwrap_err(), HullError::Flat { count: points.len() });
    }
    assert_eq!(convex_hull(&[DVec3::X, DVec3::Y, DVec3::Z]).unwrap_err(), HullError::TooFew { count: 3 });
    let error = convex_hull(&[DVec3::X, DVec3::Y, DVec3::Z, DVec3::NAN]).unwrap_err();
    assert_eq!(error.to_string(), "point 3 at (NaN, NaN, NaN) is not finite or beyond 1e90 m");
}

fn points() -> impl Strategy<Value = Vec<DVec3>> {
    // Coordinates of a few values make many points coplanar, collinear and equal.
    let coordinate = || prop_oneof![(-2..3_i32).prop_map(f64::from), -2.0..2.0_f64];
    let smooth = (-1.0..1.0_f64, -1.0..1.0_f64, -1.0..1.0_f64).prop_map(DVec3::from);
    prop_oneof![
        proptest::collection::vec((coordinate(), coordinate(), coordinate()).prop_map(DVec3::from), 4..60),
        proptest::collection::vec(smooth, 4..60),
    ]
}

proptest! {
    #[test]
    fn any_points_have_a_closed_convex_hull_or_none(points in points(), seed in any::<u64>()) {
        let again = convex_hull(&shuffled(&points, seed));
        match convex_hull(&points) {
            Err(error) => {
                prop_assert_eq!(error, HullError::Flat { count: points.len() });
                prop_assert!(again.is_err());
            }
            Ok(hull) => {
                let volume = check(&points, &hull);
                let again = again.unwrap();
                // Which of points in one plane are taken for corners may differ, which moves faces
                // by no more than some steps.
                prop_assert!((check(&points, &again) - volume).abs() <= hull.audit().area * 2.0_f64.powi(-37) * 4.0);
            }
        }
    }
}
