//! Promise: how far any two convex shapes are apart is what their own reach along the normal says,
//! no other direction parts them sooner, and the points lie on both; whatever the frame, the order
//! and the precision.
//!
//! Why: shapes of many kinds meet in one piece of code that searches. It would fail with a
//! direction that is not the shortest way out, with points beside the surfaces, or where it stops
//! too early. All is checked against reaches and insides written down here a second time.

use std::sync::Arc;

use proptest::prelude::*;
use tumble_collide::{ColliderShape, ConvexHull, Isometry, Manifold, Scalar, contact_manifold};
use tumble_math::lane::{Quat, Vec3};

const MARGIN: f64 = 0.02;
/// Faces are taken for edges that separate by no more than this.
const HYSTERESIS: f64 = 5e-4;
/// What is round and overlaps is cut with planes until they are this near, times a few metres.
const ROUND: f64 = 1e-7;

type Vector = Vec3<f64>;

fn vector(range: std::ops::Range<f64>) -> impl Strategy<Value = Vector> {
    [range.clone(), range.clone(), range].prop_map(|[x, y, z]| Vec3::new(x, y, z))
}

fn rotation() -> impl Strategy<Value = Quat<f64>> {
    let any = (vector(-1.0..1.0), -1.0..1.0).prop_filter_map("no axis", |(v, w): (Vector, f64)| {
        let quat = Quat { x: v.x, y: v.y, z: v.z, w };
        (quat.length_squared() > 1e-2).then(|| quat.normalize())
    });
    let half = std::f64::consts::FRAC_1_SQRT_2;
    prop_oneof![
        3 => any,
        1 => Just(Quat { x: 0.0, y: 0.0, z: 0.0, w: 1.0 }),
        1 => Just(Quat { x: 0.0, y: half, z: 0.0, w: half }),
        1 => Just(Quat { x: half, y: 0.0, z: 0.0, w: half }),
    ]
}

fn placement() -> impl Strategy<Value = Isometry<f64>> {
    (vector(-1.2..1.2), rotation()).prop_map(|(position, orientation)| Isometry { position, orientation })
}

fn shape() -> impl Strategy<Value = ColliderShape<f64>> {
    let length = || 0.1..1.0;
    prop_oneof![
        length().prop_map(|radius| ColliderShape::Sphere { radius }),
        vector(0.1..1.0).prop_map(|half_extents| ColliderShape::Cuboid { half_extents }),
        [length(), length()].prop_map(|[radius, half_height]| ColliderShape::Capsule { radius, half_height }),
        [length(), length()].prop_map(|[radius, half_height]| ColliderShape::Cylinder { radius, half_height }),
        [length(), length()].prop_map(|[radius, half_height]| ColliderShape::Cone { radius, half_height }),
        [length(), length(), length()].prop_map(|[radius_bottom, radius_top, half_height]| ColliderShape::Frustum {
            radius_bottom,
            radius_top,
            half_height
        }),
        [length(), length(), length()].prop_map(|[radius_bottom, radius_top, half_height]| {
            ColliderShape::TaperedCapsule { radius_bottom, radius_top, half_height }
        }),
        vector(0.1..1.0).prop_map(|radii| ColliderShape::Ellipsoid { radii }),
        prop::collection::vec(vector(-1.0..1.0), 4..20).prop_filter_map("flat", |points| {
            ConvexHull::new(&points).ok().map(|hull| ColliderShape::Hull(Arc::new(hull)))
        }),
    ]
}

fn length(v: Vector) -> f64 {
    v.dot(v).sqrt()
}

/// How far a shape reaches along a unit vector, from its origin.
fn reach(shape: &ColliderShape<f64>, d: Vector) -> f64 {
    let around = (d.x * d.x + d.z * d.z).sqrt();
    match shape {
        ColliderShape::Sphere { radius } => *radius,
        ColliderShape::Cuboid { half_extents: h } => d.x.abs() * h.x + d.y.abs() * h.y + d.z.abs() * h.z,
        ColliderShape::Capsule { radius, half_height } => d.y.abs() * half_height + radius,
        ColliderShape::Cylinder { radius, half_height } => d.y.abs() * half_height + around * radius,
        ColliderShape::Cone { radius, half_height } => (d.y * half_height).max(around * radius - d.y * half_height),
        ColliderShape::Frustum { radius_bottom, radius_top, half_height } => {
            (around * radius_top + d.y * half_height).max(around * radius_bottom - d.y * half_height)
        }
        ColliderShape::TaperedCapsule { radius_bottom, radius_top, half_height } => {
            (radius_top + d.y * half_height).max(radius_bottom - d.y * half_height)
        }
        ColliderShape::Ellipsoid { radii } => length(radii.scale(d)),
        ColliderShape::Hull(hull) => hull.points().iter().map(|point| point.dot(d)).fold(f64::NEG_INFINITY, f64::max),
        _ => f64::NAN,
    }
}

/// How far two shapes are apart along a unit vector from the first to the second.
fn separation(
    a: &ColliderShape<f64>,
    at: &Isometry<f64>,
    b: &ColliderShape<f64>,
    bt: &Isometry<f64>,
    d: Vector,
) -> f64 {
    let local = |at: &Isometry<f64>, d| at.orientation.rotate_back(d);
    d.dot(bt.position - at.position) - reach(a, local(at, d)) - reach(b, local(bt, d * -1.0))
}

/// Directions spread evenly over the sphere, along a spiral.
fn directions(count: usize) -> impl Iterator<Item = Vector> {
    (0..count).map(move |i| {
        let z = 1.0 - 2.0 * (i as f64 + 0.5) / count as f64;
        let (sin, cos) = (2.399_963 * i as f64).sin_cos();
        let around = (1.0 - z * z).sqrt();
        Vec3::new(around * cos, around * sin, z)
    })
}

fn least<R: Scalar>(manifold: &Manifold<R>) -> Option<f64> {
    manifold.points().iter().map(|point| point.separation.into()).reduce(f64::min)
}

/// Two boxes have tests of their own: how far apart they are is only computed near each other.
fn are_boxes(a: &ColliderShape<f64>, b: &ColliderShape<f64>) -> bool {
    matches!((a, b), (ColliderShape::Cuboid { .. }, ColliderShape::Cuboid { .. }))
}

fn has_lines(shape: &ColliderShape<f64>) -> bool {
    !is_faceted(shape) && !matches!(shape, ColliderShape::Sphere { .. } | ColliderShape::Ellipsoid { .. })
}

fn is_faceted(shape: &ColliderShape<f64>) -> bool {
    matches!(shape, ColliderShape::Cuboid { .. } | ColliderShape::Hull(_))
}

/// How much lower the lowest point may be than those that are shown: of a box, which keeps the same
/// corners, a twentieth of the margin; of what is round, what a rim is lower than places fixed on
/// it before it is taken to roll; of few points out of many, a part of the margin again.
fn as_low(shape: &ColliderShape<f64>) -> f64 {
    let low = match shape {
        ColliderShape::Cuboid { .. } => 0.05 * MARGIN,
        _ if has_rim(shape) => f64::max(1e-4, 0.05 * MARGIN),
        _ => 1e-4,
    };
    low + 1e-12
}

fn has_rim(shape: &ColliderShape<f64>) -> bool {
    matches!(shape, ColliderShape::Cylinder { .. } | ColliderShape::Cone { .. } | ColliderShape::Frustum { .. })
}

/// How much lower again where a load may have pressed a face in and tilted it: its points stay.
fn pressed(separation: f64, margin: f64) -> f64 {
    0.41 * (-separation).max(0.0).min(4.0 * margin)
}

/// What may be between the best direction and the one that is found.
fn lead(a: &ColliderShape<f64>, b: &ColliderShape<f64>) -> f64 {
    let own_code = |x: &ColliderShape<f64>| matches!(x, ColliderShape::Cuboid { .. } | ColliderShape::Capsule { .. });
    if is_faceted(a) && is_faceted(b) || own_code(a) && own_code(b) { HYSTERESIS } else { 10.0 * ROUND }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20_000))]

    /// Asked from far enough away, any two shapes answer, with a separation that is theirs along
    /// the normal and that no direction beats.
    #[test]
    fn no_direction_parts_them_sooner(a in shape(), at in placement(), b in shape(), bt in placement()) {
        prop_assume!(!are_boxes(&a, &b));
        let manifold = contact_manifold(&a, &at, &b, &bt, 10.0);
        let normal = manifold.normal;
        prop_assert!((length(normal) - 1.0).abs() < 1e-12, "{normal:?}");
        let along = separation(&a, &at, &b, &bt, normal);
        let found = least(&manifold).unwrap();
        // Some point is as near as the shapes are, within the tolerance of reduction. Triangles of
        // a hull within 1.4e-5 are one face, and hulls are up to two metres across.
        let flat = if matches!(a, ColliderShape::Hull(_)) || matches!(b, ColliderShape::Hull(_)) { 3e-5 } else { 1e-6 };
        prop_assert!(found > along - flat && found <= along + 0.005 * 10.0 + HYSTERESIS + pressed(along, 10.0), "{found} along {along}");
        // So far from each other only the nearest points count, and the normal need not be better
        // than along a face.
        let slack = lead(&a, &b) + 1e-4 * (-along).max(0.0);
        for d in directions(200).chain(directions(40).map(|d| {
            let beside = normal + d * 0.02;
            beside * (1.0 / length(beside))
        })) {
            let other = separation(&a, &at, &b, &bt, d);
            prop_assert!(other <= along + slack, "{other} along {d:?}, {along} along {normal:?}");
        }
        // A smaller margin leaves out what is further and nothing else.
        let near = contact_manifold(&a, &at, &b, &bt, MARGIN);
        prop_assert!(near.points().is_empty() || along <= MARGIN + 1e-9);
        prop_assert!(!near.points().is_empty() || along > MARGIN - 1e-9, "{along}");
    }

    /// Half the separation from a point, along the normal, are points of either shape, on its
    /// surface or within the margin of it.
    #[test]
    fn points_are_on_both_shapes(a in shape(), at in placement(), b in shape(), bt in placement()) {
        prop_assume!(!are_boxes(&a, &b));
        let manifold = contact_manifold(&a, &at, &b, &bt, MARGIN);
        prop_assert!(manifold.points().len() <= 4);
        prop_assert!((0.0..=1.0).contains(&manifold.carried));
        // Where both are round the place is as uncertain as the normal: the square root of 1e-11,
        // times a few metres.
        let mut slack = if lead(&a, &b) > 1e-5 { MARGIN } else { 3e-5 };
        if has_lines(&a) && has_lines(&b) {
            // Lines at an angle of up to a hundredth count as parallel, and these are up to two
            // metres long.
            slack = 0.01;
        }
        for point in manifold.points() {
            prop_assert!(point.separation <= MARGIN);
            let half = manifold.normal * (0.5 * point.separation);
            for (on, shape, place) in [(point.position - half, &a, &at), (point.position + half, &b, &bt)] {
                let local = place.orientation.rotate_back(on - place.position);
                for d in directions(100) {
                    prop_assert!(local.dot(d) <= reach(shape, d) + slack, "{} beyond {shape:?}", local.dot(d) - reach(shape, d));
                }
            }
        }
        let mut features: Vec<u32> = manifold.points().iter().map(|point| point.feature).collect();
        features.sort_unstable();
        features.dedup();
        prop_assert_eq!(features.len(), manifold.points().len());
    }

    #[test]
    fn either_may_come_first(a in shape(), at in placement(), b in shape(), bt in placement()) {
        let (forth, back) = (contact_manifold(&a, &at, &b, &bt, MARGIN), contact_manifold(&b, &bt, &a, &at, MARGIN));
        let slack = lead(&a, &b) + 1e-4;
        match (least(&forth), least(&back)) {
            (Some(x), Some(y)) => prop_assert!((x - y).abs() <= slack + pressed(x.min(y), MARGIN), "{x} and {y}"),
            (x, y) => prop_assert!(x.or(y).is_none_or(|apart| apart > MARGIN - slack), "{x:?} and {y:?}"),
        }
        if std::mem::discriminant(&a) != std::mem::discriminant(&b) && !forth.points().is_empty() {
            prop_assert_eq!(forth.normal, back.normal * -1.0);
            prop_assert_eq!(forth.points(), back.points());
            prop_assert!((forth.carried + back.carried - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn space_has_no_favourite_frame(a in shape(), at in placement(), b in shape(), bt in placement(), frame in placement()) {
        let place = |p: &Isometry<f64>| frame.then(p);
        let (here, there) = (contact_manifold(&a, &at, &b, &bt, MARGIN), contact_manifold(&a, &place(&at), &b, &place(&bt), MARGIN));
        let slack = lead(&a, &b) + 1e-4;
        match (least(&here), least(&there)) {
            (Some(x), Some(y)) => prop_assert!((x - y).abs() <= slack + pressed(x.min(y), MARGIN), "{x} and {y}"),
            (x, y) => prop_assert!(x.or(y).is_none_or(|apart| apart > MARGIN - slack), "{x:?} and {y:?}"),
        }
    }

    /// A half-space touches what reaches below its surface, as far as it does.
    #[test]
    fn ground_touches_what_reaches_it(a in shape(), at in placement(), ground in placement()) {
        let manifold = contact_manifold(&ColliderShape::HalfSpace, &ground, &a, &at, MARGIN);
        let up = ground.orientation.rotate(Vec3::new(0.0, 1.0, 0.0));
        let height = up.dot(at.position - ground.position) - reach(&a, at.orientation.rotate_back(up * -1.0));
        match least(&manifold) {
            Some(found) => {
                prop_assert!(length(manifold.normal - up) < 1e-12);
                prop_assert!((found - height).abs() < as_low(&a) + pressed(height, MARGIN), "{found} and {height}");
                for point in manifold.points() {
                    let on_shape = at.orientation.rotate_back(point.position + up * (0.5 * point.separation) - at.position);
                    for d in directions(100) {
                        prop_assert!(on_shape.dot(d) <= reach(&a, d) + 1e-9);
                    }
                    let on_ground = up.dot(point.position - up * (0.5 * point.separation) - ground.position);
                    prop_assert!(on_ground.abs() < 1e-12);
                }
            }
            None => prop_assert!(height > MARGIN - as_low(&a), "{height}"),
        }
    }

    /// What is not finite touches nothing, and nothing stops.
    #[test]
    fn nonsense_touches_nothing(a in shape(), at in placement(), b in shape(), bt in placement(), which in 0..7, what in 0..3) {
        let bad = [f64::NAN, f64::INFINITY, 1e300][what as usize];
        let mut at = at;
        *[
            &mut at.position.x, &mut at.position.y, &mut at.position.z,
            &mut at.orientation.x, &mut at.orientation.y, &mut at.orientation.z, &mut at.orientation.w,
        ][which as usize] = bad;
        for manifold in [contact_manifold(&a, &at, &b, &bt, MARGIN), contact_manifold(&b, &bt, &a, &at, MARGIN)] {
            for point in manifold.points() {
                prop_assert!(point.separation.is_finite() && length(point.position).is_finite() && length(manifold.normal).is_finite(), "{manifold:?}");
            }
        }
    }
}
