use crate::ball::{ball_and_ball, cuboid_and_ball};
use crate::capsule::{Rod, capsule_and_ball, capsule_and_capsule, cuboid_and_capsule};
use crate::convex_pair::convex_and_convex;
use crate::cuboids::{CuboidLanes, cuboid_pair};
use crate::geometry::{Geometry, Placement};
use crate::half_space::{half_space_and_ball, half_space_and_capsule, half_space_and_cuboid};
use crate::half_space_pair::half_space_and_other;
use crate::manifold::Manifold;
use crate::scalar::Scalar;
use crate::surface_pair::surface_and_convex;

/// How two shapes touch, with all points where they are at most `margin` \[m\] apart. The normal goes from the first to the second.
///
/// Of a compound, a mesh or a height field it is the manifold of the part that is nearest or deepest; [`touching`] shows all of them.
/// Half-spaces do not touch each other, and no more do surfaces. What is not finite touches nothing.
///
/// ```
/// use tumble_collide::{Geometry, Placement, collide};
/// use tumble_math::lane::Vec3;
///
/// let ground = (Geometry::HalfSpace, Placement::at(Vec3::zero()));
/// let can = (Geometry::Cylinder { radius: 0.5, half_height: 1.0 }, Placement::at(Vec3::new(0.0, 1.001, 0.0)));
/// // It stands on four points of its rim, a millimetre above the ground.
/// let manifold = collide(&ground.0, &ground.1, &can.0, &can.1, 0.02_f64);
/// assert_eq!(manifold.points().len(), 4);
/// assert!(manifold.points().iter().all(|point| (point.separation - 0.001).abs() < 1e-15));
/// ```
pub fn collide<R: Scalar>(
    first: &Geometry<R>,
    first_at: &Placement<R>,
    second: &Geometry<R>,
    second_at: &Placement<R>,
    margin: R,
) -> Manifold<R> {
    if !is_composed(first) && !is_composed(second) {
        return single(first, first_at, second, second_at, margin);
    }
    let mut nearest: Option<(R, Manifold<R>)> = None;
    touching(first, first_at, second, second_at, margin, &mut |_, manifold| {
        for point in manifold.points() {
            if nearest.as_ref().is_none_or(|(least, _)| point.separation < *least) {
                nearest = Some((point.separation, *manifold));
            }
        }
    });
    nearest.map_or(Manifold::none(), |(_, manifold)| manifold)
}

/// Shows how all parts of two shapes touch: for each pair of parts that are near, the number of the pair and the manifold, as [`collide`] has them.
///
/// Parts are those of a compound and, of a mesh or a height field, its flat pieces, edges and corners. The number of a pair is the same from step to step, in no particular order,
/// and zero for shapes of one part; of shapes that have more than 2^32 pairs of parts between them, some share a number. Manifolds without points are left out.
///
/// ```
/// use std::sync::Arc;
/// use tumble_collide::{Compound, Geometry, Placement, touching};
/// use tumble_math::lane::Vec3;
///
/// let ball = |x: f64| (Placement::at(Vec3::new(x, 0.0, 0.0)), Geometry::Ball { radius: 0.5 });
/// let dumbbell = Geometry::Compound(Arc::new(Compound::new([ball(-1.0), ball(1.0)])));
/// let mut found = Vec::new();
/// let (ground, above) = (Placement::at(Vec3::zero()), Placement::at(Vec3::new(0.0, 0.5, 0.0)));
/// touching(&Geometry::HalfSpace, &ground, &dumbbell, &above, 0.02, &mut |pair, manifold| {
///     found.push((pair, manifold.points()[0].position.x));
/// });
/// assert_eq!(found, [(0, -1.0), (1, 1.0)]);
/// ```
pub fn touching<R: Scalar>(
    first: &Geometry<R>,
    first_at: &Placement<R>,
    second: &Geometry<R>,
    second_at: &Placement<R>,
    margin: R,
    visit: &mut impl FnMut(u32, &Manifold<R>),
) {
    if !is_composed(first) && !is_composed(second) {
        let manifold = single(first, first_at, second, second_at, margin);
        if !manifold.points().is_empty() {
            visit(0, &manifold);
        }
        return;
    }
    composed([first, second], [first_at, second_at], margin, &mut |[on_first, on_second], manifold| {
        if !manifold.points().is_empty() {
            visit(on_first.wrapping_mul(second.parts()).wrapping_add(on_second), manifold);
        }
    });
}

type Visit<'a, R> = &'a mut dyn FnMut([u32; 2], &Manifold<R>);

fn is_composed<R>(geometry: &Geometry<R>) -> bool {
    matches!(geometry, Geometry::Compound(_) | Geometry::Mesh(_) | Geometry::HeightField(_))
}

/// The same where one has parts, with the numbers of the parts of either.
fn composed<R: Scalar>(
    [first, second]: [&Geometry<R>; 2],
    [first_at, second_at]: [&Placement<R>; 2],
    margin: R,
    visit: Visit<'_, R>,
) {
    use Geometry::{Compound, HalfSpace, HeightField, Mesh};
    match (first, second) {
        (Compound(compound), _) => {
            for (number, at, part) in compound.placed(first_at) {
                if are_near([part, second], [&at, second_at], margin) {
                    composed([part, second], [&at, second_at], margin, &mut |[a, b], manifold| {
                        visit([number.saturating_add(a), b], manifold);
                    });
                }
            }
        }
        (Mesh(_) | HeightField(_), Mesh(_) | HeightField(_)) => {}
        (Mesh(mesh), _) if !matches!(second, Compound(_) | HalfSpace) => {
            surface_and_convex(mesh.as_ref(), first_at, second, second_at, margin, &mut |part, manifold| {
                visit([part, 0], manifold);
            });
        }
        (HeightField(field), _) if !matches!(second, Compound(_) | HalfSpace) => {
            surface_and_convex(field.as_ref(), first_at, second, second_at, margin, &mut |part, manifold| {
                visit([part, 0], manifold);
            });
        }
        (_, Compound(_)) | (_, Mesh(_) | HeightField(_))
            if !matches!(first, HalfSpace) || matches!(second, Compound(_)) =>
        {
            composed([second, first], [second_at, first_at], margin, &mut |[b, a], manifold| {
                visit([a, b], &manifold.swapped());
            });
        }
        _ => visit([0, 0], &single(first, first_at, second, second_at, margin)),
    }
}

/// Whether the boxes of two shapes meet; of what has no end they always do.
fn are_near<R: Scalar>(shapes: [&Geometry<R>; 2], at: [&Placement<R>; 2], margin: R) -> bool {
    let bounds = |which: usize, margin: R| shapes[which].bounds(at[which], margin);
    bounds(0, margin).zip(bounds(1, R::splat(0.0))).is_none_or(|(a, b)| a.meets(&b))
}

/// Of two shapes the one with the lower rank is the first; of equal ones either may be.
fn rank<R>(geometry: &Geometry<R>) -> u32 {
    match geometry {
        Geometry::HalfSpace => 0,
        Geometry::Cuboid { .. } => 1,
        Geometry::Hull(_) => 2,
        Geometry::Cylinder { .. } => 3,
        Geometry::Cone { .. } => 4,
        Geometry::Frustum { .. } => 5,
        Geometry::Capsule { .. } => 6,
        Geometry::TaperedCapsule { .. } => 7,
        Geometry::Ellipsoid { .. } => 8,
        Geometry::Ball { .. } => 9,
        Geometry::Mesh(_) | Geometry::HeightField(_) | Geometry::Compound(_) => 10,
    }
}

/// Two shapes of one part each, or a half-space and a surface.
fn single<R: Scalar>(
    first: &Geometry<R>,
    first_at: &Placement<R>,
    second: &Geometry<R>,
    second_at: &Placement<R>,
    margin: R,
) -> Manifold<R> {
    use Geometry::{Ball, Capsule, Cuboid, HalfSpace};
    if !first_at.is_somewhere() || !second_at.is_somewhere() {
        return Manifold::none();
    }
    if rank(first) > rank(second) {
        return single(second, second_at, first, first_at, margin).swapped();
    }
    match (first, second) {
        (&Ball { radius: a }, &Ball { radius: b }) => {
            ball_and_ball(a, first_at.position, b, second_at.position, margin)
        }
        (&Cuboid { half_extents }, &Ball { radius }) => {
            cuboid_and_ball(half_extents, first_at, radius, second_at.position, margin)
        }
        (&Cuboid { half_extents: a }, &Cuboid { half_extents: b }) => {
            let first = CuboidLanes { half_extents: a, orientation: first_at.orientation };
            let second = CuboidLanes { half_extents: b, orientation: second_at.orientation };
            let origin = second_at.position;
            cuboid_pair(&first, &second, origin - first_at.position, margin).of_one(origin)
        }
        (&Cuboid { half_extents }, &Capsule { radius, half_height }) => {
            cuboid_and_capsule(half_extents, first_at, &Rod::new(radius, half_height, second_at), margin)
        }
        (&Capsule { radius: a, half_height }, &Ball { radius: b }) => {
            capsule_and_ball(&Rod::new(a, half_height, first_at), b, second_at.position, margin)
        }
        (&Capsule { radius: a, half_height: h }, &Capsule { radius: b, half_height: k }) => {
            capsule_and_capsule(&Rod::new(a, h, first_at), &Rod::new(b, k, second_at), margin)
        }
        (HalfSpace, HalfSpace) => Manifold::none(),
        (HalfSpace, &Ball { radius }) => half_space_and_ball(first_at, radius, second_at.position, margin),
        (HalfSpace, &Cuboid { half_extents }) => half_space_and_cuboid(first_at, half_extents, second_at, margin),
        (HalfSpace, &Capsule { radius, half_height }) => {
            half_space_and_capsule(first_at, radius, half_height, second_at, margin)
        }
        (HalfSpace, _) => half_space_and_other(first_at, second, second_at, margin),
        _ => convex_and_convex(first, first_at, second, second_at, margin),
    }
}
