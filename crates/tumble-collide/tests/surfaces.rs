//! Promise: a surface of triangles is touched where the solid inside it would be, every triangle
//! that is near is found, and compounds touch with all their parts.
//!
//! Why: contacts with triangles are thrown away where a neighbour has them, so that nothing
//! stumbles over inner edges. What is thrown away wrongly is a hole in the ground. The solid to
//! compare with is the same shape as a convex hull, the same plane as a half-space, and triangles
//! one by one.

use std::sync::Arc;

use proptest::prelude::*;
use tumble_collide::{
    ColliderShape, Compound, ConvexHull, HeightField, Isometry, Manifold, Mesh, contact_manifold, contact_manifolds,
};
use tumble_math::lane::{Quat, Vec3};

const MARGIN: f64 = 0.02;
/// Faces are taken for edges that separate by no more than this, and points for the nearest that
/// are by no more than a two-hundredth of the margin further.
const HYSTERESIS: f64 = 6e-4;

type Vector = Vec3<f64>;

fn vector(range: std::ops::Range<f64>) -> impl Strategy<Value = Vector> {
    [range.clone(), range.clone(), range].prop_map(|[x, y, z]| Vec3::new(x, y, z))
}

fn rotation() -> impl Strategy<Value = Quat<f64>> {
    (vector(-1.0..1.0), -1.0..1.0).prop_filter_map("no axis", |(v, w): (Vector, f64)| {
        let quat = Quat { x: v.x, y: v.y, z: v.z, w };
        (quat.length_squared() > 1e-2).then(|| quat.normalize())
    })
}

fn placement() -> impl Strategy<Value = Isometry<f64>> {
    (vector(-1.2..1.2), rotation()).prop_map(|(position, orientation)| Isometry { position, orientation })
}

fn support_map() -> impl Strategy<Value = ColliderShape<f64>> {
    let length = || 0.1..0.6;
    prop_oneof![
        length().prop_map(|radius| ColliderShape::Sphere { radius }),
        vector(0.1..0.6).prop_map(|half_extents| ColliderShape::Cuboid { half_extents }),
        [length(), length()].prop_map(|[radius, half_height]| ColliderShape::Capsule { radius, half_height }),
        [length(), length()].prop_map(|[radius, half_height]| ColliderShape::Cylinder { radius, half_height }),
        [length(), length()].prop_map(|[radius, half_height]| ColliderShape::Cone { radius, half_height }),
        vector(0.1..0.6).prop_map(|radii| ColliderShape::Ellipsoid { radii }),
    ]
}

/// The same solid as a hull and as a closed surface.
fn solid() -> impl Strategy<Value = (ColliderShape<f64>, ColliderShape<f64>)> {
    prop::collection::vec(vector(-1.0..1.0), 4..24).prop_filter_map("flat", |points| {
        let hull = ConvexHull::new(&points).ok()?;
        let positions: Vec<_> = points.iter().map(|point| (*point).into()).collect();
        let mesh = tumble_math::convex_hull(&positions).ok()?;
        let corners: Vec<Vector> = mesh.positions().iter().map(|corner| (*corner).into()).collect();
        let mesh = Mesh::new(&corners, mesh.triangles()).ok()?;
        Some((ColliderShape::Hull(Arc::new(hull)), ColliderShape::Mesh(Arc::new(mesh))))
    })
}

fn length(v: Vector) -> f64 {
    v.dot(v).sqrt()
}

fn least(manifold: &Manifold<f64>) -> Option<f64> {
    manifold.points().iter().map(|point| point.separation).reduce(f64::min)
}

fn all(
    a: &ColliderShape<f64>,
    at: &Isometry<f64>,
    b: &ColliderShape<f64>,
    bt: &Isometry<f64>,
) -> Vec<(u32, Manifold<f64>)> {
    let mut found = Vec::new();
    contact_manifolds(a, at, b, bt, MARGIN, &mut |part, manifold| found.push((part, *manifold)));
    found
}

fn nearest(found: &[(u32, Manifold<f64>)]) -> Option<f64> {
    found.iter().filter_map(|(_, manifold)| least(manifold)).reduce(f64::min)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20_000))]

    /// Moved to just above its surface, or just into it, a shape touches a closed surface as it
    /// touches the hull that it bounds.
    #[test]
    fn a_closed_surface_is_as_its_solid((hull, mesh) in solid(), at in placement(), shape in support_map(), bt in placement(), gap in -0.0005..0.018_f64) {
        let far = contact_manifold(&hull, &at, &shape, &bt, 10.0);
        let apart = least(&far).unwrap();
        let bt = Isometry { position: bt.position + far.normal * (gap - apart), ..bt };
        let of_hull = contact_manifold(&hull, &at, &shape, &bt, MARGIN);
        // What parted them along the normal may not have parted them; how deep it is in the solid
        // no triangle knows.
        prop_assume!(least(&of_hull).is_none_or(|separation| separation > -0.001));
        let of_mesh = all(&mesh, &at, &shape, &bt);
        match (least(&of_hull), nearest(&of_mesh)) {
            (Some(x), Some(y)) => prop_assert!((x - y).abs() < HYSTERESIS, "{x} of the hull, {y} of the surface"),
            (x, y) => prop_assert!(x.or(y).is_none_or(|apart| apart > MARGIN - HYSTERESIS), "{x:?} of the hull, {y:?} of the surface"),
        }
        // Every normal of the surface is a direction that parts them about as well, so none pushes
        // aside.
        let mut parts: Vec<u32> = of_mesh.iter().map(|(part, _)| *part).collect();
        parts.sort_unstable();
        parts.dedup();
        prop_assert_eq!(parts.len(), of_mesh.len());
        for (_, manifold) in &of_mesh {
            prop_assert!((length(manifold.normal) - 1.0).abs() < 1e-9);
            prop_assert!(manifold.points().iter().all(|point| point.separation <= MARGIN));
        }
        // From the other side the same, looking back.
        let back = all(&shape, &bt, &mesh, &at);
        prop_assert_eq!(back.len(), of_mesh.len());
        for ((part, forth), (other, back)) in of_mesh.iter().zip(&back) {
            prop_assert_eq!(part, other);
            prop_assert_eq!(forth.normal, back.normal * -1.0);
            prop_assert_eq!(forth.points(), back.points());
        }
    }

    /// Level ground of many triangles is a half-space to what is over it: one manifold, one normal,
    /// the same depth.
    #[test]
    fn level_ground_has_one_face(shape in support_map(), orientation in rotation(), place in [-1.0..1.0, -1.0..1.0_f64], gap in -0.01..0.019_f64) {
        let field = HeightField::new(vec![0.0; 225], 15, [0.4, 0.35]).unwrap();
        let ground = Isometry::at(Vec3::new(0.1, 0.2, 0.3));
        let high = Isometry { position: Vec3::new(place[0], 5.0, place[1]), orientation };
        let height = shape.aabb(&high, 0.0).unwrap().low.y - ground.position.y;
        let at = Isometry { position: high.position + Vec3::new(0.0, gap - height, 0.0), ..high };
        let plane = contact_manifold(&ColliderShape::HalfSpace, &ground, &shape, &at, MARGIN);
        let field = all(&ColliderShape::HeightField(Arc::new(field)), &ground, &shape, &at);
        prop_assert!(field.len() <= 1, "{field:?}");
        for (_, manifold) in &field {
            prop_assert!((manifold.normal.y - 1.0).abs() < 1e-12);
        }
        // A box keeps its corners where others may be a twentieth of the margin deeper, and a face
        // that is pressed in its points.
        match (least(&plane), nearest(&field)) {
            (Some(x), Some(y)) => prop_assert!(
                (x - y).abs() < 0.06 * MARGIN + 0.41 * (-x.min(y)).max(0.0),
                "{x} of the plane, {y} of the field"
            ),
            (x, y) => prop_assert!(x.or(y).is_none_or(|apart| apart > MARGIN - 0.06 * MARGIN), "{x:?} of the plane, {y:?} of the field"),
        }
    }

    /// A ball over rough ground is as far from it as from the nearest of its triangles.
    #[test]
    fn a_ball_on_rough_ground_touches_the_nearest(heights in prop::collection::vec(-0.3..0.3_f64, 36), place in vector(-1.0..1.0), radius in 0.1..0.5) {
        let field = HeightField::new(&heights, 6, [0.5, 0.5]).unwrap();
        let (points, wide) = (field.points().to_vec(), field.columns());
        // Above all of the ground: of a ball whose centre is under it nothing is said.
        let center = Vec3::new(place.x, 0.46 + 0.15 * place.y, place.z);
        let mut nearest_of_all = f64::INFINITY;
        for row in 0..wide - 1 {
            for column in 0..wide - 1 {
                let here = row * wide + column;
                for corners in [[here, here + wide, here + wide + 1], [here, here + wide + 1, here + 1]] {
                    nearest_of_all = nearest_of_all.min(distance(center, corners.map(|corner| points[corner])));
                }
            }
        }
        let sphere = ColliderShape::Sphere { radius };
        let found = all(&ColliderShape::HeightField(Arc::new(field)), &Isometry::at(Vec3::zero()), &sphere, &Isometry::at(center));
        match nearest(&found) {
            Some(separation) => prop_assert!((separation - (nearest_of_all - radius)).abs() < 1e-5, "{separation} and {}", nearest_of_all - radius),
            None => prop_assert!(nearest_of_all - radius > MARGIN - 1e-9, "{nearest_of_all} and {radius}"),
        }
    }

    /// A compound touches as its parts do, each at its place.
    #[test]
    fn parts_touch_one_by_one(parts in prop::collection::vec((placement(), support_map()), 1..4), at in placement(), shape in support_map(), bt in placement()) {
        let compound = ColliderShape::Compound(Arc::new(Compound::new(parts.clone())));
        let found = all(&compound, &at, &shape, &bt);
        let mut expected = Vec::new();
        for (number, (inner, part)) in (0..).zip(&parts) {
            let manifold = contact_manifold(part, &at.then(inner), &shape, &bt, MARGIN);
            if !manifold.points().is_empty() {
                expected.push((number, manifold));
            }
        }
        prop_assert_eq!(&found, &expected);
        // As parts of a compound in a compound, too.
        let nested = ColliderShape::Compound(Arc::new(Compound::new([(Isometry::at(Vec3::zero()), compound)])));
        prop_assert_eq!(all(&nested, &at, &shape, &bt).len(), expected.len());
        let aabb = nested.aabb(&at, 0.0).unwrap();
        for (inner, part) in &parts {
            let of_part = part.aabb(&at.then(inner), -1e-9).unwrap();
            prop_assert!(aabb.low.x <= of_part.low.x && aabb.high.x >= of_part.high.x);
            prop_assert!(aabb.low.y <= of_part.low.y && aabb.high.z >= of_part.high.z);
        }
    }
}

/// A ball, a capsule or a box from a centimetre to a hundred metres, up to 1:500, and how thick
/// half of it is.
fn any_size() -> impl Strategy<Value = (ColliderShape<f64>, f64)> {
    let power = |range: std::ops::Range<f64>| range.prop_map(|exponent: f64| 10.0_f64.powf(exponent));
    (power(-2.0..2.0), [power(-2.7..0.0), power(-2.7..0.0)], 0..5_u32).prop_map(|(size, [a, b], kind)| match kind {
        0 => (ColliderShape::Sphere { radius: size }, size),
        1 => (ColliderShape::Capsule { radius: size * a, half_height: size }, size * a),
        kind => {
            let [x, y, z] = [size, size * a, size * b];
            let half_extents = [Vec3::new(x, y, z), Vec3::new(z, x, y), Vec3::new(y, z, x)][kind as usize - 2];
            (ColliderShape::Cuboid { half_extents }, size * a.min(b))
        }
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// Level ground of triangles up to 1:500, anywhere and turned in any way, is a half-space to
    /// what is over it, whatever its size.
    #[test]
    fn ground_of_any_triangles_has_one_face((shape, thick) in any_size(), lies in any::<bool>(), turn in rotation(), long in 1.1..4.0_f64, narrow in -2.7..0.0_f64, place in [-0.5..0.5, -0.5..0.5_f64], far in vector(-1e4..1e4), ground_turn in rotation(), gap in -0.4..0.9_f64) {
        let margin = (0.02 * thick).min(0.01);
        let flat = Quat { x: 0.0, y: 0.0, z: 0.0, w: 1.0 };
        // Blades that stand on a corner of slivers may be found a seventh of their margin higher.
        let lies = lies || thick < 0.1 * shape.aabb(&Isometry::at(Vec3::zero()), 0.0).map(|aabb| length(aabb.high)).unwrap();
        let local = Isometry { position: Vec3::zero(), orientation: if lies { flat } else { turn } };
        let reach = shape.aabb(&local, 0.0).map(|aabb| aabb.high).unwrap();
        let width = reach.x.max(reach.z) * long;
        let step = (width * 10.0_f64.powf(narrow)).max(1e-6);
        let rows = 2 * (reach.z * 1.5 / step).ceil() as usize + 4;
        let field = HeightField::new(vec![0.0; 4 * rows], 4, [width, step]).unwrap();
        let ground = Isometry { position: far, orientation: ground_turn };
        let height = reach.y + gap * margin;
        let position = far + ground_turn.rotate(Vec3::new(place[0] * width, height, place[1] * step));
        let at = Isometry { position, orientation: (ground_turn * local.orientation).normalize() };
        let plane = contact_manifold(&ColliderShape::HalfSpace, &ground, &shape, &at, margin);
        let field = ColliderShape::HeightField(Arc::new(field));
        let mut found = Vec::new();
        contact_manifolds(&field, &ground, &shape, &at, margin, &mut |_, manifold| found.push(*manifold));
        prop_assert_eq!(found.len(), 1);
        let up = ground_turn.rotate(Vec3::new(0.0, 1.0, 0.0));
        prop_assert!(length(found[0].normal - up) < 1e-9, "{:?}, {:?}", found[0].normal, up);
        let (x, y) = (least(&plane).unwrap(), least(&found[0]).unwrap());
        // Places are known to a part of how far away they are.
        prop_assert!((x - y).abs() < 0.06 * margin + 1e-11, "{x} of the plane, {y} of the field, margin {margin}");
        // What lies flat stands on all of its corners: its points are as wide as it.
        if let (true, ColliderShape::Cuboid { half_extents: h }) = (lies, &shape) {
            prop_assert_eq!(found[0].points().len(), 4);
            let width = found[0].points().iter().map(|point| length(point.position - at.position)).fold(0.0, f64::max);
            prop_assert!((width - length(*h)).abs() <= margin + 1e-9 * length(*h), "{width} of {}", length(*h));
        }
    }
}

/// Of a point from a triangle, by looking at the face and every side.
fn distance(point: Vector, [a, b, c]: [Vector; 3]) -> f64 {
    let of_side = |from: Vector, to: Vector| {
        let along = to - from;
        let t = ((point - from).dot(along) / along.dot(along)).clamp(0.0, 1.0);
        length(from + along * t - point)
    };
    let normal = (b - a).cross(c - a);
    let inside =
        [(a, b), (b, c), (c, a)].iter().all(|(from, to)| (*to - *from).cross(point - *from).dot(normal) >= 0.0);
    let sides = of_side(a, b).min(of_side(b, c)).min(of_side(c, a));
    if inside { sides.min((point - a).dot(normal).abs() / length(normal)) } else { sides }
}

/// Numbers that make no ground are refused, each by name.
#[test]
fn what_is_no_ground_is_refused() {
    let of = |count: usize, columns: usize, spacing: [f64; 2]| HeightField::new(vec![0.0; count], columns, spacing);
    for (field, message) in [
        (of(4, 0, [1.0; 2]), "4 heights are no two full rows of 0"),
        (of(4, 1, [1.0; 2]), "4 heights are no two full rows of 1"),
        (of(3, 3, [1.0; 2]), "3 heights are no two full rows of 3"),
        (of(4, 2, [1.0, 0.0]), "the spacing of rows must be from 1e-6 to 1e6 m, it is 0.0"),
        (of(4, 2, [f64::NAN, 1.0]), "the spacing of columns must be from 1e-6 to 1e6 m, it is NaN"),
    ] {
        assert_eq!(field.unwrap_err().to_string(), message);
    }
}
