//! Promise: whatever two convex shapes are and however they lie, finding how far they overlap takes
//! no more than a stated amount of work, and the answer is a way out, the shortest there is.
//!
//! Why: the polyhedron that grows between them has faces as thin as rounding where shapes are
//! parallel, identical or of very different sizes. A tear in it once made its faces multiply for
//! seconds. Work is counted, in points reached and faces compared; the shortest way out of
//! polyhedra is found a second time by trying all there are.

use std::sync::Arc;

use proptest::prelude::*;
use tumble_math::lane::{Quat, Vec3};

use crate::collider_shape::{ColliderShape, Isometry};
use crate::convex_hull::ConvexHull;
use crate::convex_pair::{FACE_LEAD, approach, difference};
use crate::mesh::Mesh;
use crate::minkowski::Difference;
use crate::support_map::{Convex, Vector, unit};
use crate::{contact_manifold, contact_manifold_near, work};

/// Points reached of a pair: turns of the search for the nearest points, points of the polyhedron
/// and what starts it, refinements, and the choice of a face.
const MAX_REACHED: usize = 64 + 24 + 512 + 12 + 5 * 8 * 65 + 8 + TRIES * 8;
/// Of common normals, for each of some numbers of points.
const TRIES: usize = 20;
/// Faces tested and sides compared.
const MAX_COMPARED: usize = (1 << 18) + (1 << 13);

/// Part by which an overlap may be longer than the shortest where that is not certain. The most
/// that was found in some millions of pairs is 6e-4.
const UNCERTAIN: f64 = 5e-3;

/// From a millimetre to a hundred metres.
fn length() -> impl Strategy<Value = f64> {
    (-3.0..2.0).prop_map(|exponent: f64| 10.0_f64.powf(exponent))
}

fn vector(range: std::ops::Range<f64>) -> impl Strategy<Value = Vector> {
    [range.clone(), range.clone(), range].prop_map(|[x, y, z]| Vec3::new(x, y, z))
}

fn hull(points: &[Vector]) -> Option<ColliderShape<f64>> {
    ConvexHull::new(points).ok().map(|hull| ColliderShape::Hull(Arc::new(hull)))
}

/// A shape of about this size; `like` another in its proportions or not.
fn shape() -> impl Strategy<Value = ColliderShape<f64>> {
    let lengths = || [length(), length(), length()];
    // Proportions of one to ten, which most shapes have, beside any.
    let alike = (length(), [0.1..1.0, 0.1..1.0, 0.1..1.0]).prop_map(|(size, parts)| parts.map(|part: f64| size * part));
    let three = prop_oneof![alike, lengths()];
    let points = (length(), prop::collection::vec(vector(-1.0..1.0), 4..20))
        .prop_map(|(size, points)| points.into_iter().map(|point| point * size).collect::<Vec<_>>());
    let prism = (length(), length(), 3..24_u32).prop_map(|(radius, half, sides)| {
        let corner = |k: u32, y: f64| {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / f64::from(sides)).sin_cos();
            Vec3::new(radius * cos, y, radius * sin)
        };
        (0..sides).flat_map(|k| [corner(k, -half), corner(k, half)]).collect::<Vec<_>>()
    });
    prop_oneof![
        6 => (three, 0..8_u32).prop_map(|([a, b, c], kind)| match kind {
            0 => ColliderShape::Sphere { radius: a },
            1 => ColliderShape::Cuboid { half_extents: Vec3::new(a, b, c) },
            2 => ColliderShape::Capsule { radius: a, half_height: b },
            3 => ColliderShape::Cylinder { radius: a, half_height: b },
            4 => ColliderShape::Cone { radius: a, half_height: b },
            5 => ColliderShape::Frustum { radius_bottom: a, radius_top: b, half_height: c },
            6 => ColliderShape::TaperedCapsule { radius_bottom: a, radius_top: b, half_height: c },
            _ => ColliderShape::Ellipsoid { radii: Vec3::new(a, b, c) },
        }),
        2 => points.prop_filter_map("flat", |points| hull(&points)),
        1 => prism.prop_filter_map("flat", |points| hull(&points)),
    ]
}

pub(crate) fn orientation() -> impl Strategy<Value = Quat<f64>> {
    [-1.0..1.0, -1.0..1.0, -1.0..1.0, -1.0..1.0].prop_filter_map("no axis", |[x, y, z, w]: [f64; 4]| {
        let quat = Quat { x, y, z, w };
        (quat.length_squared() > 1e-2).then(|| quat.normalize())
    })
}

fn turn() -> impl Strategy<Value = Quat<f64>> {
    // As of a body in single precision that was turned back.
    let nearly = (vector(-1.0..1.0), -9.0..-5.0).prop_map(|(v, exponent): (Vector, f64)| {
        let v = v * 10.0_f64.powf(exponent);
        Quat { x: v.x, y: v.y, z: v.z, w: 1.0 }.normalize()
    });
    let half = std::f64::consts::FRAC_1_SQRT_2;
    prop_oneof![
        3 => orientation(),
        1 => nearly,
        1 => Just(Quat { x: 0.0, y: 0.0, z: 0.0, w: 1.0 }),
        1 => Just(Quat { x: 0.0, y: half, z: 0.0, w: half }),
        1 => Just(Quat { x: half, y: 0.0, z: 0.0, w: half }),
    ]
}

/// Two shapes, or the same twice, and where the second is: as far from the first as they reach
/// together, times these along each axis.
fn pair() -> impl Strategy<Value = (ColliderShape<f64>, ColliderShape<f64>, Isometry<f64>)> {
    let places = prop_oneof![
        4 => vector(-1.0..1.0),
        // A little beside each other; along an axis; one in the other.
        2 => (vector(-1.0..1.0), -12.0..0.0).prop_map(|(v, exponent): (Vector, f64)| v * 10.0_f64.powf(exponent)),
        2 => (-1.0..1.0, 0..3_usize).prop_map(|(along, axis): (f64, usize)| {
            let mut v = [0.0; 3];
            v[axis] = along;
            Vec3::new(v[0], v[1], v[2])
        }),
        1 => Just(Vec3::zero()),
    ];
    (shape(), shape(), 0..5_u32, places, turn()).prop_map(|(first, other, same, place, orientation)| {
        let second = if same == 0 { first.clone() } else { other };
        let reach = [&first, &second].map(|shape| shape.reach().unwrap_or(1.0));
        let position = place * (reach[0] + reach[1]);
        (first, second, Isometry { position, orientation })
    })
}

fn here() -> Isometry<f64> {
    Isometry::at(Vec3::zero())
}

/// All directions in which the shortest way out of two polyhedra may lead.
fn ways_out(shapes: &Difference<'_>) -> Option<Vec<Vector>> {
    let edges = |support_map: &Convex<'_>| -> Option<Vec<Vector>> {
        match support_map {
            Convex::Cuboid { .. } => {
                Some(vec![Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, 1.0)])
            }
            Convex::Hull(hull) => Some(hull.edges().map(|[a, b]| unit(b - a)).collect()),
            _ => None,
        }
    };
    let mut all = edges(&shapes.first)?;
    all.extend(edges(&shapes.second)?.into_iter().map(|edge| shapes.turn(edge)));
    let mut ways = Vec::new();
    for (index, a) in all.iter().enumerate() {
        for b in &all[..index] {
            let across = a.cross(*b);
            if across.dot(across) > 1e-12 {
                ways.extend([unit(across), unit(across) * -1.0]);
            }
        }
    }
    Some(ways)
}

/// Directions spread over the sphere, along a spiral.
fn directions(count: usize) -> impl Iterator<Item = Vector> {
    (0..count).map(move |i| {
        let z = 1.0 - 2.0 * (i as f64 + 0.5) / count as f64;
        let (sin, cos) = (2.399_963 * i as f64).sin_cos();
        let around = (1.0 - z * z).sqrt();
        Vec3::new(around * cos, around * sin, z)
    })
}

fn check(first: &ColliderShape<f64>, second: &ColliderShape<f64>, at: &Isometry<f64>) -> Result<(), TestCaseError> {
    let _ = work::taken();
    let manifold = contact_manifold(first, &here(), second, at, 0.02);
    let [reached, compared, _] = work::taken();
    prop_assert!(reached <= MAX_REACHED && compared <= MAX_COMPARED, "{reached} points, {compared} faces and sides");
    for point in manifold.points() {
        let square = point.position.dot(point.position);
        prop_assert!(square.is_finite() && point.separation.is_finite(), "{point:?}");
        prop_assert!((manifold.normal.dot(manifold.normal) - 1.0).abs() < 1e-9, "{:?}", manifold.normal);
    }
    let (Some((a, _)), Some((b, _))) = (Convex::of(first), Convex::of(second)) else { return Ok(()) };
    let is_thin = |support_map: &Convex<'_>| matches!(support_map, Convex::Point | Convex::Segment { .. });
    if is_thin(&a) && is_thin(&b) {
        // Balls and capsules have code of their own.
        return Ok(());
    }
    let Some(shapes) = difference(a, &here(), b, at) else { return Ok(()) };
    let Some(found) = approach(&shapes, f64::INFINITY) else { return Err(TestCaseError::fail("no answer")) };
    let is_certain = work::taken()[2] == 0;
    let reach = [first, second].map(|shape| shape.reach().unwrap_or(0.0));
    let size = reach[0] + reach[1];
    let along = shapes.separation(found.normal);
    // Of shapes that are apart the square of the distance is sought, to thirteen digits, so the
    // direction to six.
    let apart = if found.between > 0.0 { 1e-6 * (size + found.between) } else { 0.0 };
    prop_assert!((along - found.between).abs() <= apart + 1e-9 * size, "{along} is said to be {}", found.between);
    prop_assert!((found.normal.dot(found.normal) - 1.0).abs() < 1e-9, "{:?}", found.normal);
    let ways = ways_out(&shapes);
    // Directions of very thin shapes are good to the first part; round shapes are cut with 256
    // planes; a polyhedron that tears gives the shortest way near by, so some overlap is left.
    let left = if is_certain { 0.0 } else { UNCERTAIN * along.abs() };
    let slack = (if ways.is_some() { 1e-8 } else { 1e-7 }) * size + left;
    for way in ways.into_iter().flatten().chain(directions(100)) {
        let other = shapes.separation(way);
        prop_assert!(other <= along + slack + apart, "{other} along {way:?}, {along} along {:?}", found.normal);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(10_000))]

    #[test]
    fn any_pair_takes_bounded_work((first, second, at) in pair()) {
        check(&first, &second, &at)?;
    }
}

/// Pairs of which one is curved, apart or overlapping by 1e-4 to a tenth of what the smaller
/// reaches, and a small motion of the second.
fn curved_pair() -> impl Strategy<Value = (ColliderShape<f64>, ColliderShape<f64>, Isometry<f64>, Isometry<f64>)> {
    let is_curved = |shape: &ColliderShape<f64>| Convex::of(shape).is_some_and(|(inner, _)| inner.has_round_core());
    let gap = (prop_oneof![Just(-1.0), Just(1.0)], -4.0..-1.0)
        .prop_map(|(sign, part): (f64, f64)| sign * 10.0_f64.powf(part));
    let moves = (vector(-1.0..1.0), vector(-1.0..1.0), -4.0..-2.0_f64);
    let first = shape().prop_filter("flat", is_curved);
    (first, shape(), turn(), vector(-1.0..1.0), gap, moves).prop_filter_map(
        "nowhere",
        |(first, second, orientation, place, part, (slide, turn, exponent))| {
            let reach = [&first, &second].map(|shape| shape.reach().unwrap_or(1.0));
            let size = reach[0].min(reach[1]);
            let far = Isometry { position: unit(place) * (2.0 * (reach[0] + reach[1])), orientation };
            let ((a, of_a), (b, of_b)) = (Convex::of(&first)?, Convex::of(&second)?);
            let found = approach(&difference(a, &here(), b, &far)?, f64::INFINITY)?;
            // Along a straight way the separation need not fall by as much as it is long.
            let position = far.position - found.normal * (found.between - of_a - of_b - part * size);
            let (slide, turn) = (slide * 10.0_f64.powf(exponent), turn * 10.0_f64.powf(exponent));
            let turn = Quat { x: turn.x, y: turn.y, z: turn.z, w: 1.0 }.normalize();
            let at = Isometry { position, orientation };
            let moved = Isometry { position: position + slide * size, orientation: (turn * orientation).normalize() };
            Some((first, second, at, moved))
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(10_000))]

    /// No direction near the one that is found separates shapes by more: of those that overlap, at
    /// whatever scale.
    #[test]
    fn the_way_of_curved_shapes_is_the_best_of_those_near_it(
        (first, second, at, _) in curved_pair(), beside in vector(-1.0..1.0), exponent in -6.0..-1.0_f64,
    ) {
        let ((a, _), (b, _)) = (Convex::of(&first).unwrap(), Convex::of(&second).unwrap());
        let shapes = difference(a, &here(), b, &at).unwrap();
        let Some(found) = approach(&shapes, f64::INFINITY) else { return Err(TestCaseError::fail("no answer")) };
        let size = [&first, &second].iter().fold(0.0, |size, shape| size + shape.reach().unwrap_or(0.0));
        let near = unit(found.normal + beside * 10.0_f64.powf(exponent));
        let (along, other) = (shapes.separation(found.normal), shapes.separation(near));
        // As in `check`.
        let apart = if found.between > 0.0 { 1e-6 * size } else { 0.0 };
        prop_assert!(other <= along + apart + 1e-9 * size, "{other} beside {along}, size {size}");
        prop_assert!((along - found.between).abs() <= apart + 1e-9 * size, "{along} is said to be {}", found.between);
    }

    /// After a small motion shapes are found again, whichever is first: what is apart as if for the
    /// first time, and what overlaps along a way out that is longer than the shortest by twice what
    /// the motion may have changed at most.
    #[test]
    fn curved_shapes_are_found_again((first, second, at, moved) in curved_pair()) {
        let reach = [&first, &second].map(|shape| shape.reach().unwrap_or(0.0));
        let margin = 0.2 * (reach[0] + reach[1]);
        let before = contact_manifold(&first, &here(), &second, &at, margin);
        let found = contact_manifold(&first, &here(), &second, &moved, margin);
        prop_assume!(!before.points().is_empty() && !found.points().is_empty());
        let [forth, back] = [
            contact_manifold_near(&first, &here(), &second, &moved, margin, before.normal),
            contact_manifold_near(&second, &moved, &first, &here(), margin, before.normal * -1.0).swapped(),
        ];
        let ((a, of_a), (b, of_b)) = (Convex::of(&first).unwrap(), Convex::of(&second).unwrap());
        let shapes = difference(a, &here(), b, &moved).unwrap();
        let along = |normal: Vector| shapes.separation(normal) - of_a - of_b;
        let (slid, turned) = (moved.position - at.position, moved.orientation * at.orientation.conjugate());
        let turned = 2.0 * turned.vector().dot(turned.vector()).sqrt();
        let changed = slid.dot(slid).sqrt() + turned * reach[1];
        let best = along(found.normal);
        for again in [forth, back] {
            prop_assert!(best > 0.5 * margin || !again.points().is_empty(), "{best} is gone");
            let other = along(again.normal);
            let less = if best > 0.0 { 0.0 } else { 2.0 * changed };
            prop_assert!(
                again.points().is_empty() || other >= best - less - FACE_LEAD - 1e-6 * margin,
                "{other} for {best}, which changed by {changed}"
            );
        }
    }
}

/// Newton's method ends what the search for points would go on with: without it these are 23 on
/// average where shapes are apart, and 44 where they overlap.
#[test]
fn curved_pairs_take_few_points() {
    let mut state = 1_u64;
    let mut number = |low: f64, high: f64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let (mut reached, mut again) = ([(0, 0); 2], (0, 0));
    let corners: Vec<Vector> =
        (0..20).map(|_| Vec3::new(number(-1.0, 1.0), number(-1.0, 1.0), number(-1.0, 1.0))).collect();
    let polyhedron = hull(&corners).unwrap();
    for _ in 0..4000 {
        let [a, b, c, d] = [0; 4].map(|_| number(0.3, 1.0));
        let shapes = [
            ColliderShape::Cylinder { radius: a, half_height: b },
            ColliderShape::Cone { radius: c, half_height: d },
            ColliderShape::Frustum { radius_bottom: a, radius_top: 0.5 * c, half_height: b },
            ColliderShape::TaperedCapsule { radius_bottom: a, radius_top: 0.5 * c, half_height: d },
            ColliderShape::Ellipsoid { radii: Vec3::new(a, b, c) },
            ColliderShape::Cuboid { half_extents: Vec3::new(d, b, a) },
            ColliderShape::Capsule { radius: 0.5 * a, half_height: b },
            polyhedron.clone(),
        ];
        let [first, second] = [5.0, 8.0].map(|end| &shapes[number(0.0, end) as usize]);
        let mut turn = || number(-1.0, 1.0);
        let orientation = Quat { x: turn(), y: turn(), z: turn(), w: turn() }.normalize();
        let position = Vec3::new(turn(), turn(), turn()) * 2.0;
        let at = Isometry { position, orientation };
        let (Some((a, _)), Some((b, _))) = (Convex::of(first), Convex::of(second)) else { continue };
        let Some(shapes) = difference(a, &here(), b, &at) else { continue };
        let _ = work::taken();
        let Some(found) = approach(&shapes, f64::INFINITY) else { continue };
        let (count, points) = &mut reached[usize::from(found.between < 0.0)];
        (*count, *points) = (*count + 1, *points + work::taken()[0]);
        if found.between.abs() < 0.1 {
            contact_manifold_near(first, &here(), second, &at, 1.0, found.normal);
            again = (again.0 + 1, again.1 + work::taken()[0]);
        }
    }
    let again = again.1 as f64 / f64::from(again.0);
    let [apart, overlapping] = reached.map(|(count, points)| points as f64 / f64::from(count));
    assert!(apart < 8.0 && overlapping < 40.0, "{apart} points apart, {overlapping} overlapping");
    assert!(again < 8.0, "{again} points of what is found again");
}

/// A box deep in a cylinder, and as rounding may move them. The polyhedron tore, and its faces were
/// tested for eight seconds.
#[test]
fn a_torn_polyhedron_ends() {
    let cuboid = ColliderShape::Cuboid { half_extents: Vec3::new(0.076_981_66, 0.022_479_191, 0.043_510_687) };
    let can = ColliderShape::Cylinder { radius: 0.063_045_35, half_height: 0.353_498_37 };
    let of_box = Isometry {
        position: Vec3::new(-0.051_493_548, 0.044_589_825, -0.032_926_33),
        orientation: Quat { x: -0.122_235_596, y: -0.505_367_46, z: 0.740_855_6, w: 0.425_200_22 },
    };
    let mut most = [0; 2];
    for step in 0..4000 {
        let bit = |k: i32| f64::from((step >> (2 * k)) % 4) * 2e-9;
        let of_can = Isometry {
            position: Vec3::new(
                0.041_309_754_134_048_86 + bit(0),
                0.050_020_997_937_949_43 + bit(1),
                0.054_558_514_288_896_41 + bit(2),
            ),
            orientation: Quat {
                x: -0.763_003_23 + bit(3),
                y: -0.155_826_48 + bit(4),
                z: -0.173_586_58 + bit(5),
                w: 0.602_836_5,
            },
        };
        let _ = work::taken();
        let manifold = contact_manifold(&cuboid, &of_box, &can, &of_can, 0.02);
        let taken = work::taken();
        most = [most[0].max(taken[0]), most[1].max(taken[1])];
        assert!(!manifold.points().is_empty());
    }
    assert!(most[0] <= MAX_REACHED && most[1] <= MAX_COMPARED, "{most:?} points reached, faces and sides compared");
}

/// A fan of triangles about one corner, flat or as a cone that points up or down.
fn fan(triangles: u32, height: f64) -> ColliderShape<f64> {
    let mut points = vec![Vec3::new(0.0, height, 0.0)];
    points.extend((0..triangles).map(|k| {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / f64::from(triangles)).sin_cos();
        Vec3::new(cos, 0.0, sin)
    }));
    let corners: Vec<[u32; 3]> = (0..triangles).map(|k| [0, 1 + (k + 1) % triangles, 1 + k]).collect();
    ColliderShape::Mesh(Arc::new(Mesh::new(&points, &corners).unwrap()))
}

/// However many triangles have one corner, twice as many take twice the work, and the contact is
/// the same.
#[test]
fn a_fan_takes_work_in_proportion_to_its_triangles() {
    let bodies = [ColliderShape::Cuboid { half_extents: Vec3::splat(0.2) }, ColliderShape::Sphere { radius: 0.2 }];
    for height in [0.0, 0.5, -0.5] {
        for body in &bodies {
            for lift in [-0.01, 0.01] {
                let at = Isometry::at(Vec3::new(0.01, f64::max(height, 0.0) + 0.2 + lift, 0.02));
                let met = |triangles: u32| {
                    let ground = fan(triangles, height);
                    let _ = work::taken();
                    let manifold = contact_manifold(&ground, &here(), body, &at, 0.02);
                    let [reached, compared, _] = work::taken();
                    (reached + compared, manifold.points().len(), manifold.normal)
                };
                let (few, many) = (met(1000), met(2000));
                assert!(many.0 <= 2 * few.0 + few.0 / 4 + 100, "{} and {} for {height}, {body:?}", few.0, many.0);
                assert_eq!(few.1, many.1, "{height}, {body:?}");
                let apart = few.2 - many.2;
                assert!(apart.dot(apart).sqrt() < 0.02, "{:?} and {:?}", few.2, many.2);
            }
        }
    }
}
