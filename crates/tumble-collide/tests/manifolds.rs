//! Promise: a manifold says how far two shapes are apart and where, and moving them apart by as
//! much parts them; whatever the frame they are seen from, and whichever of them comes first.
//!
//! Why: a solver believes what it gets here. A point beside the surfaces makes torques, a normal
//! that is not the shortest way out throws bodies through each other.

use proptest::prelude::*;
use tumble_collide::{ColliderShape, Isometry, Manifold, contact_manifold};
use tumble_math::lane::{Quat, Vec3};

const MARGIN: f64 = 0.02;
/// Edges give way to faces that separate nearly as well, and faces of the second shape to those of
/// the first.
const HYSTERESIS: f64 = 5e-4;
/// Part of the overlap of edges by which it is shorter along a face that is taken for them, at
/// most: one minus the cosine of five degrees.
const FLAT: f64 = 0.004;
const ROUNDING: f64 = 1e-12;

fn vector(range: std::ops::Range<f64>) -> impl Strategy<Value = Vec3<f64>> {
    [range.clone(), range.clone(), range].prop_map(|[x, y, z]| Vec3::new(x, y, z))
}

fn rotation() -> impl Strategy<Value = Quat<f64>> {
    // Faces and edges that are parallel are what games are made of.
    let any = (vector(-1.0..1.0), -1.0..1.0).prop_filter_map("no axis", |(v, w): (Vec3<f64>, f64)| {
        let quat = Quat { x: v.x, y: v.y, z: v.z, w };
        (quat.length_squared() > 1e-2).then(|| quat.normalize())
    });
    let half = std::f64::consts::FRAC_1_SQRT_2;
    prop_oneof![
        3 => any,
        1 => Just(Quat { x: 0.0, y: 0.0, z: 0.0, w: 1.0 }),
        1 => Just(Quat { x: 0.0, y: half, z: 0.0, w: half }),
    ]
}

fn placement() -> impl Strategy<Value = Isometry<f64>> {
    (vector(-1.5..1.5), rotation()).prop_map(|(position, orientation)| Isometry { position, orientation })
}

fn shape() -> impl Strategy<Value = ColliderShape<f64>> {
    prop_oneof![
        (0.1..1.0).prop_map(|radius| ColliderShape::Sphere { radius }),
        vector(0.1..1.0).prop_map(|half_extents| ColliderShape::Cuboid { half_extents }),
    ]
}

fn length(v: Vec3<f64>) -> f64 {
    v.dot(v).sqrt()
}

fn least(manifold: &Manifold<f64>) -> Option<f64> {
    manifold.points().iter().map(|point| point.separation).reduce(f64::min)
}

fn moved(at: &Isometry<f64>, by: Vec3<f64>) -> Isometry<f64> {
    Isometry { position: at.position + by, ..*at }
}

/// How far a point is outside a shape at the least; negative inside.
fn outside(point: Vec3<f64>, shape: &ColliderShape<f64>, at: &Isometry<f64>) -> f64 {
    let local = at.orientation.rotate_back(point - at.position);
    match *shape {
        ColliderShape::Sphere { radius } => length(local) - radius,
        ColliderShape::Cuboid { half_extents: h } => {
            (local.x.abs() - h.x).max(local.y.abs() - h.y).max(local.z.abs() - h.z)
        }
        _ => local.y,
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20_000))]

    /// Half the separation from the point, along the normal, is a surface on either side.
    #[test]
    fn points_are_between_the_surfaces(a in shape(), at in placement(), b in shape(), bt in placement()) {
        let manifold = contact_manifold(&a, &at, &b, &bt, MARGIN);
        prop_assert!(manifold.points().len() <= 4);
        for point in manifold.points() {
            prop_assert!((length(manifold.normal) - 1.0).abs() < ROUNDING);
            prop_assert!(point.separation <= MARGIN);
            let half = manifold.normal * (0.5 * point.separation);
            let (on_a, on_b) = (point.position - half, point.position + half);
            // Where an edge was taken for a corner, the surfaces are apart along it too, and the
            // point is between them.
            prop_assert!(outside(on_a, &a, &at) < ROUNDING + 0.5 * MARGIN, "{}", outside(on_a, &a, &at));
            prop_assert!(outside(on_b, &b, &bt) < ROUNDING + 0.5 * MARGIN, "{}", outside(on_b, &b, &bt));
        }
    }

    /// No point of one is in the other where they are said to be apart, and moving them apart as
    /// far as they overlap parts them.
    #[test]
    fn the_least_separation_is_the_way_out(a in shape(), at in placement(), b in shape(), bt in placement(), inside in vector(-1.0..1.0)) {
        let manifold = contact_manifold(&a, &at, &b, &bt, MARGIN);
        let within = match a {
            ColliderShape::Cuboid { half_extents } => half_extents.scale(inside),
            ColliderShape::Sphere { radius } => inside * (radius / 3.0_f64.sqrt()),
            _ => inside,
        };
        let point = at.position + at.orientation.rotate(within);
        let shared = outside(point, &b, &bt) < -HYSTERESIS;
        match least(&manifold) {
            Some(separation) => {
                prop_assert!(!shared || separation < 0.0, "a point of both, and {separation}");
                let apart = moved(&bt, manifold.normal * (MARGIN - separation - 1e-9));
                let again = contact_manifold(&a, &at, &b, &apart, MARGIN);
                if let Some(now) = least(&again) {
                    prop_assert!(now > MARGIN - 2.0 * HYSTERESIS - 1e-6, "{separation} became {now}");
                }
            }
            None => prop_assert!(!shared, "a point of both, and no contact"),
        }
    }

    #[test]
    fn either_may_come_first(a in shape(), at in placement(), b in shape(), bt in placement()) {
        let (forth, back) = (contact_manifold(&a, &at, &b, &bt, MARGIN), contact_manifold(&b, &bt, &a, &at, MARGIN));
        match (least(&forth), least(&back)) {
            (Some(x), Some(y)) => prop_assert!((x - y).abs() <= HYSTERESIS + FLAT * x.abs(), "{x} and {y}"),
            (x, y) => prop_assert!(x.or(y).is_none_or(|apart| apart > MARGIN - HYSTERESIS), "{x:?} and {y:?}"),
        }
    }

    /// The same from another place and another angle.
    #[test]
    fn space_has_no_favourite_frame(a in shape(), at in placement(), b in shape(), bt in placement(), frame in placement()) {
        let place = |p: &Isometry<f64>| Isometry {
            position: frame.position + frame.orientation.rotate(p.position),
            orientation: (frame.orientation * p.orientation).normalize(),
        };
        let (here, there) = (contact_manifold(&a, &at, &b, &bt, MARGIN), contact_manifold(&a, &place(&at), &b, &place(&bt), MARGIN));
        match (least(&here), least(&there)) {
            // Where two axes are as good as each other, rounding may choose, within what one is
            // given over the other.
            (Some(x), Some(y)) => prop_assert!((x - y).abs() <= HYSTERESIS + FLAT * x.abs(), "{x} and {y}"),
            (x, y) => prop_assert!(x.or(y).is_none_or(|apart| apart > MARGIN - HYSTERESIS), "{x:?} and {y:?}"),
        }
    }
}

/// A box flat on another touches in four points at the corners of what they share, deep as it is.
#[test]
fn a_box_on_a_box_has_four_corners() {
    let bottom = ColliderShape::Cuboid { half_extents: Vec3::new(1.0, 0.5, 1.0) };
    let top = ColliderShape::Cuboid { half_extents: Vec3::new(0.5, 0.5, 2.0) };
    let above = Isometry::at(Vec3::new(0.75, 0.99, 0.0));
    let manifold = contact_manifold(&bottom, &Isometry::at(Vec3::zero()), &top, &above, MARGIN);
    assert_eq!(manifold.normal, Vec3::new(0.0, 1.0, 0.0));
    let mut corners: Vec<[f64; 2]> =
        manifold.points().iter().map(|point| [point.position.x, point.position.z]).collect();
    corners.sort_by(|a, b| a.partial_cmp(b).unwrap());
    assert_eq!(corners, [[0.25, -1.0], [0.25, 1.0], [1.0, -1.0], [1.0, 1.0]]);
    let mut features: Vec<u32> = manifold.points().iter().map(|point| point.feature).collect();
    features.sort_unstable();
    features.dedup();
    assert_eq!(features.len(), 4);
    for point in manifold.points() {
        assert!((point.separation + 0.01).abs() < 1e-15 && (point.position.y - 0.495).abs() < 1e-15);
    }
}

/// Two bars across each other on their edges touch in one point.
#[test]
fn edges_that_cross_touch_in_one_point() {
    let bar = ColliderShape::Cuboid { half_extents: Vec3::new(2.0, 0.5, 0.5) };
    let eighth = (std::f64::consts::FRAC_PI_8.sin(), std::f64::consts::FRAC_PI_8.cos());
    let on_edge = Quat { x: eighth.0, y: 0.0, z: 0.0, w: eighth.1 };
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let across = Quat { x: 0.0, y: half, z: 0.0, w: half } * on_edge;
    let lower = Isometry { position: Vec3::zero(), orientation: on_edge };
    let upper = Isometry { position: Vec3::new(0.3, 2.0 * half - 0.01, 0.2), orientation: across };
    let manifold = contact_manifold(&bar, &lower, &bar, &upper, MARGIN);
    let [point] = manifold.points() else { panic!("{manifold:?}") };
    assert!((manifold.normal.y - 1.0).abs() < 1e-12);
    assert!((point.separation + 0.01).abs() < 1e-12);
    assert!((point.position.x - 0.3).abs() < 1e-12 && point.position.z.abs() < 1e-12, "{point:?}");
}

/// Drawn in double precision: proptest 1.12 panics in a debug build where a number drawn of a range
/// of `f32` comes to lie below its start, which it does once in some millions of draws.
fn single(range: std::ops::Range<f64>) -> impl Strategy<Value = f32> {
    range.prop_map(|number| number as f32)
}

/// As nearly as single precision can tell, or less nearly.
fn nearly() -> impl Strategy<Value = f32> {
    (single(-1.0..1.0), 3..9).prop_map(|(mantissa, exponent)| mantissa * 0.1_f32.powi(exponent))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100_000))]

    /// The corners of one are on the edges of the other but for rounding, which must not lose them:
    /// the upper box would tip over the others.
    #[test]
    fn boxes_stacked_flush_touch_at_four_corners(
        place in [nearly(), nearly()], turn in [nearly(), nearly(), nearly()], also in [nearly(), nearly(), nearly()],
        depth in single(0.004..0.01), scale in single(0.5..2.0),
    ) {
        stacked(place, turn, also, depth, scale)?;
    }
}

/// Four corners of a cube on a cube, each turned by what is nearly nothing.
fn stacked(place: [f32; 2], turn: [f32; 3], also: [f32; 3], depth: f32, scale: f32) -> Result<(), TestCaseError> {
    let half = scale * 0.5;
    let cube = ColliderShape::Cuboid { half_extents: Vec3::splat(half) };
    let turned = |[x, y, z]: [f32; 3]| Quat { x, y, z, w: 1.0 }.normalize();
    let below = Isometry { position: Vec3::new(0.0, half, 0.0), orientation: turned(also) };
    let position = Vec3::new(place[0], 3.0 * half - depth, place[1]);
    let manifold = contact_manifold(&cube, &below, &cube, &Isometry { position, orientation: turned(turn) }, 0.02);
    let mut corners = [false; 4];
    for point in manifold.points() {
        prop_assert!(point.position.x.abs() > 0.9 * half && point.position.z.abs() > 0.9 * half, "{manifold:?}");
        corners[usize::from(point.position.x > 0.0) + 2 * usize::from(point.position.z > 0.0)] = true;
    }
    prop_assert_eq!(corners, [true; 4], "{:?}", manifold);
    Ok(())
}

/// Stacks that lost a corner once: to rounding, and to where edges that lie along each other cross.
#[test]
fn stacks_that_lost_a_corner() {
    stacked([8.909_785e-8, 0.0], [0.0, 0.0, -2.286_511_5e-7], [0.0, -3.604_68e-8, 0.0], 0.004, 0.5).unwrap();
    stacked([0.0; 2], [0.0, 0.0, 2.370_527_2e-6], [0.0, 0.0, -2.887_996_7e-7], 0.004, 1.097_711_1).unwrap();
    let also = [3.859_646_7e-4, 6.119_772_4e-8, 4.135_960_2e-4];
    stacked([0.0, -9.826_812e-7], [-3.838_471e-4, -6.762_533e-9, 0.0], also, 0.004_331_267, 1.427_972).unwrap();
}
