//! Promise: the closed forms of a triangle with a ball's centre, a capsule's axis and a box find
//! the distance or the shortest way out that GJK and EPA find, for any sizes and shapes of either.
//!
//! Why: contacts with ground stand on them. A distance is proved from both sides: the direction
//! separates the shapes by it, and a point of the triangle is no further from the shape; a way out
//! is compared with all there are. A normal of the wrong sign separates by less.

use proptest::prelude::*;
use tumble_math::lane::{Quat, Vec3};

use crate::collider_shape::Isometry;
use crate::convex_pair::{Approach, approach, difference};
use crate::minkowski::Difference;
use crate::support_map::{Convex, Vector, unit};
use crate::surface::normal_of;
use crate::triangle_approach::triangle_approach;

/// Part of the size of both by which lengths may differ: what GJK and EPA leave.
const ROUNDING: f64 = 1e-9;

/// From a centimetre to a hundred metres.
fn length() -> impl Strategy<Value = f64> {
    (-2.0..2.0).prop_map(|exponent: f64| 10.0_f64.powf(exponent))
}

/// Up to 1:500.
fn aspect() -> impl Strategy<Value = f64> {
    (-2.7..0.0).prop_map(|exponent: f64| 10.0_f64.powf(exponent))
}

fn vector() -> impl Strategy<Value = Vector> {
    [-1.0..1.0, -1.0..1.0, -1.0..1.0].prop_map(|[x, y, z]: [f64; 3]| Vec3::new(x, y, z))
}

/// Any, or such that edges lie along one another.
fn turn() -> impl Strategy<Value = Quat<f64>> {
    let any = (vector(), -1.0..1.0).prop_filter_map("no axis", |(v, w): (Vector, f64)| {
        let quat = Quat { x: v.x, y: v.y, z: v.z, w };
        (quat.length_squared() > 1e-2).then(|| quat.normalize())
    });
    let nearly = (vector(), -12.0..-2.0).prop_map(|(v, exponent): (Vector, f64)| {
        let v = v * 10.0_f64.powf(exponent);
        Quat { x: v.x, y: v.y, z: v.z, w: 1.0 }.normalize()
    });
    prop_oneof![3 => any, 1 => nearly, 1 => Just(Quat { x: 0.0, y: 0.0, z: 0.0, w: 1.0 })]
}

fn body() -> impl Strategy<Value = Convex<'static>> {
    prop_oneof![
        Just(Convex::Point),
        length().prop_map(|half_height| Convex::Segment { half_height }),
        (length(), aspect(), aspect(), 0..3_u32).prop_map(|(most, a, b, order)| {
            let [x, y, z] = [most, most * a, most * b];
            Convex::Cuboid { half: [Vec3::new(x, y, z), Vec3::new(z, x, y), Vec3::new(y, z, x)][order as usize] }
        }),
    ]
}

/// One side along x, and the third corner beside it, near or far: slivers too.
fn triangle() -> impl Strategy<Value = [Vector; 3]> {
    let place = prop_oneof![Just([0.0; 3]), [-1e4..1e4, -1e4..1e4, -1e4..1e4]];
    (length(), aspect(), -0.5..1.5, turn(), place).prop_map(|(size, narrow, along, turn, [x, y, z])| {
        let corners = [Vec3::zero(), Vec3::new(size, 0.0, 0.0), Vec3::new(size * along, 0.0, -size * narrow)];
        corners.map(|corner| turn.rotate(corner) + Vec3::new(x, y, z))
    })
}

fn size_of(body: &Convex<'_>) -> f64 {
    match *body {
        Convex::Segment { half_height } => half_height,
        Convex::Cuboid { half } => half.dot(half).sqrt(),
        _ => 0.0,
    }
}

/// A pair with a point of the triangle, given by its weights, and one of the body at one place, but
/// for a gap.
#[derive(Debug)]
struct Pair {
    body: Convex<'static>,
    corners: [Vector; 3],
    at: Isometry<f64>,
    size: f64,
}

impl Pair {
    fn shapes(&self) -> Difference<'static> {
        let here = Isometry::at(Vec3::zero());
        difference(Convex::Triangle(self.corners), &here, self.body, &self.at).unwrap()
    }

    /// How far a point is from the body.
    fn distance(&self, point: Vector) -> f64 {
        let local = self.at.to_local(point);
        let nearest = match self.body {
            Convex::Segment { half_height } => Vec3::new(0.0, local.y.clamp(-half_height, half_height), 0.0),
            Convex::Cuboid { half: h } => {
                Vec3::new(local.x.clamp(-h.x, h.x), local.y.clamp(-h.y, h.y), local.z.clamp(-h.z, h.z))
            }
            _ => Vec3::zero(),
        };
        let apart = local - nearest;
        apart.dot(apart).sqrt()
    }

    /// The directions of the faces of the set of all differences.
    fn ways_out(&self) -> Vec<Vector> {
        let [a, b, c] = self.corners;
        let edges = match self.body {
            Convex::Segment { .. } => vec![self.at.orientation.axes()[1]],
            Convex::Cuboid { .. } => self.at.orientation.axes().to_vec(),
            _ => Vec::new(),
        };
        let across = [b - a, c - b, a - c].into_iter().flat_map(|side| edges.iter().map(move |edge| side.cross(*edge)));
        let mut all: Vec<Vector> = across.filter(|way| way.dot(*way) > 1e-12).map(unit).collect();
        all.push(normal_of(&self.corners));
        if matches!(self.body, Convex::Cuboid { .. }) {
            all.extend(&edges);
        }
        all.into_iter().flat_map(|way| [way, way * -1.0]).collect()
    }
}

fn pair() -> impl Strategy<Value = Pair> {
    let weights = prop_oneof![[0.0..1.0, 0.0..1.0, 0.0..1.0], Just([1.0, 1.0, 0.0]), Just([1.0, 0.0, 0.0])];
    // Apart or overlapping by any part of the size, and not at all.
    let gap = prop_oneof![
        4 => (-12.0..0.0, prop::bool::ANY).prop_map(|(exponent, sign): (f64, bool)| {
            10.0_f64.powf(exponent) * if sign { 1.0 } else { -1.0 }
        }),
        1 => Just(0.0),
    ];
    (body(), triangle(), turn(), weights, vector(), vector(), gap, 0..3_u32).prop_map(
        |(body, corners, orientation, weights, on_body, way, gap, kind)| {
            let sum: f64 = weights.iter().sum::<f64>().max(1e-3);
            let on_triangle =
                corners.iter().zip(weights).fold(Vec3::zero(), |at, (corner, weight)| at + *corner * (weight / sum));
            let long = corners[1] - corners[0];
            let size = size_of(&body) + long.dot(long).sqrt();
            let on_body = match kind {
                0 => body.support(on_body + Vec3::new(1e-9, 0.0, 0.0)),
                _ => match body {
                    Convex::Cuboid { half } => half.scale(on_body),
                    Convex::Segment { half_height } => Vec3::new(0.0, half_height * on_body.y, 0.0),
                    _ => Vec3::zero(),
                },
            };
            let way = if kind == 2 { normal_of(&corners) } else { way };
            let position = on_triangle - orientation.rotate(on_body) + way * (gap * size);
            Pair { body, corners, at: Isometry { position, orientation }, size }
        },
    )
}

/// Proves an approach, as far as the numbers allow.
fn check(pair: &Pair, found: &Approach) -> Result<(), TestCaseError> {
    let shapes = pair.shapes();
    let far = pair.corners[0].dot(pair.corners[0]).sqrt();
    let slack = ROUNDING * pair.size + 1e-14 * far;
    prop_assert!((found.normal.dot(found.normal) - 1.0).abs() < 1e-9, "{found:?}");
    let along = shapes.separation(found.normal);
    // Points that are known to rounding give a direction to that part of how far they are apart.
    let turned = f64::EPSILON * (pair.size + far) / found.between.max(1e-11 * pair.size);
    // Squares say what is nearest, and have no more digits: places across have half of these.
    let noise = if found.between > 0.0 { (16.0 * turned + 4.0 * turned.sqrt()) * pair.size } else { 0.0 };
    prop_assert!((along - found.between).abs() <= slack + noise, "{along} along {found:?}");
    if found.between > slack {
        let distance = pair.distance(found.on_first);
        prop_assert!(distance <= found.between + slack, "{distance} from the body: {found:?}");
        let [a, b, c] = pair.corners.map(|corner| corner - found.on_first);
        let off = crate::gjk::on_triangle([a, b, c]);
        let nearest = a * off[0] + b * off[1] + c * off[2];
        prop_assert!(nearest.dot(nearest).sqrt() <= slack, "{found:?} is off the triangle");
    } else {
        for way in pair.ways_out() {
            let other = shapes.separation(way);
            prop_assert!(other <= along + slack + noise, "{other} along {way:?}, {along} along {found:?}");
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20_000))]

    #[test]
    fn closed_forms_find_the_distance_and_the_shortest_way_out(pair in pair()) {
        let shapes = pair.shapes();
        let normal = normal_of(&pair.corners);
        let found = triangle_approach(&shapes, normal, f64::INFINITY);
        let Some(found) = found else { return Err(TestCaseError::fail("no answer")) };
        check(&pair, &found)?;
        let known = approach(&shapes, f64::INFINITY);
        let Some(known) = known else { return Err(TestCaseError::fail("no answer of GJK")) };
        let far = pair.corners[0].dot(pair.corners[0]).sqrt();
        // To six digits of the direction where they are apart, as GJK and EPA have it; what they
        // find for shapes that just touch may be a longer way out.
        let slack = 1e-6 * (pair.size + known.between.abs()) + 1e-13 * far;
        let touch = found.between.abs() <= ROUNDING * pair.size + 1e-14 * far;
        prop_assert!(known.between <= found.between + slack, "{found:?}, {known:?}");
        prop_assert!(touch || known.between >= found.between - slack, "{found:?}, {known:?}");
        // No nearer than asked for.
        let limit = found.between;
        prop_assert!(triangle_approach(&shapes, normal, limit - 1e-6 * pair.size).is_none());
        prop_assert!(triangle_approach(&shapes, normal, limit + 1e-6 * pair.size).is_some());
    }
}
