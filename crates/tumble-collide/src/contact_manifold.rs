//! Contact manifolds of any two shapes: dispatch on shape types, and pairs of compound parts.

use tumble_math::lane::Vec3;

use crate::capsule::{Rod, capsule_and_capsule, capsule_and_sphere, cuboid_and_capsule};
use crate::collider_shape::{ColliderShape, Isometry};
use crate::convex_pair::convex_and_convex;
use crate::cuboids::{CuboidLanes, cuboid_pair};
use crate::half_space::{half_space_and_capsule, half_space_and_cuboid, half_space_and_sphere};
use crate::half_space_pair::half_space_and_other;
use crate::manifold::Manifold;
use crate::mesh_pair::surface_and_convex;
use crate::scalar::Scalar;
use crate::sphere::{cuboid_and_sphere, sphere_and_sphere};

/// How two shapes touch, with all points where they are at most `margin` \[m\] apart. The normal
/// goes from the first to the second.
///
/// Of a compound, a mesh or a height field it is the manifold of the part that is nearest or
/// deepest; [`contact_manifolds`] shows all of them. Half-spaces do not touch each other, and no
/// more do surfaces. What is not finite touches nothing.
///
/// ```
/// use tumble_collide::{ColliderShape, Isometry, contact_manifold};
/// use tumble_math::lane::Vec3;
///
/// let ground = (ColliderShape::HalfSpace, Isometry::at(Vec3::zero()));
/// let can = (
///     ColliderShape::Cylinder { radius: 0.5, half_height: 1.0 },
///     Isometry::at(Vec3::new(0.0, 1.001, 0.0)),
/// );
/// // It stands on four points of its rim, a millimetre above the ground.
/// let manifold = contact_manifold(&ground.0, &ground.1, &can.0, &can.1, 0.02_f64);
/// assert_eq!(manifold.points().len(), 4);
/// assert!(manifold.points().iter().all(|point| (point.separation - 0.001).abs() < 1e-15));
/// ```
pub fn contact_manifold<R: Scalar>(
    first: &ColliderShape<R>,
    first_at: &Isometry<R>,
    second: &ColliderShape<R>,
    second_at: &Isometry<R>,
    margin: R,
) -> Manifold<R> {
    if !is_composed(first) && !is_composed(second) {
        return single([first, second], [first_at, second_at], margin, None);
    }
    let mut nearest: Option<(R, Manifold<R>)> = None;
    contact_manifolds(first, first_at, second, second_at, margin, &mut |_, manifold| {
        for point in manifold.points() {
            if nearest.as_ref().is_none_or(|(least, _)| point.separation < *least) {
                nearest = Some((point.separation, *manifold));
            }
        }
    });
    nearest.map_or(Manifold::none(), |(_, manifold)| manifold)
}

/// As [`contact_manifold`] of shapes that had the unit vector `normal` a moment ago, world frame:
/// round ones that still have a common normal near it are found along that, even if by now there
/// is a shorter way out.
///
/// ```
/// use tumble_collide::{ColliderShape, Isometry, contact_manifold, contact_manifold_near};
/// use tumble_math::lane::Vec3;
///
/// let egg = ColliderShape::Ellipsoid { radii: Vec3::new(1.0, 2.0, 1.0_f64) };
/// let (here, there) =
///     (Isometry::at(Vec3::zero()), Isometry::at(Vec3::new(1.9, 1.0, 0.0)));
/// let known = contact_manifold(&egg, &here, &egg, &there, 0.1);
/// let moved = Isometry::at(Vec3::new(1.91, 1.0, 0.0));
/// let again = contact_manifold_near(&egg, &here, &egg, &moved, 0.1, known.normal);
/// let found = contact_manifold(&egg, &here, &egg, &moved, 0.1);
/// assert!((again.points()[0].separation - found.points()[0].separation).abs() < 1e-12);
/// ```
pub fn contact_manifold_near<R: Scalar>(
    first: &ColliderShape<R>,
    first_at: &Isometry<R>,
    second: &ColliderShape<R>,
    second_at: &Isometry<R>,
    margin: R,
    normal: Vec3<R>,
) -> Manifold<R> {
    if is_composed(first) || is_composed(second) {
        return contact_manifold(first, first_at, second, second_at, margin);
    }
    single([first, second], [first_at, second_at], margin, Some(normal))
}

/// As [`contact_manifold`] of two convex shapes that are no half-space, but with a point where they
/// are nearest even if no faces or edges lie over one another there. Of others it has no points.
///
/// ```
/// use tumble_collide::{ColliderShape, Isometry, contact_manifold, nearest_manifold};
/// use tumble_math::lane::Vec3;
///
/// let cube = ColliderShape::Cuboid { half_extents: Vec3::splat(0.5_f64) };
/// // Corners of both, a metre apart along the diagonal.
/// let (here, there) =
///     (Isometry::at(Vec3::zero()), Isometry::at(Vec3::splat(1.0 + 1.0 / 3.0_f64.sqrt())));
/// assert!(contact_manifold(&cube, &here, &cube, &there, 2.0).points().is_empty());
/// let manifold = nearest_manifold(&cube, &here, &cube, &there, 2.0);
/// assert!((manifold.points()[0].separation - 1.0).abs() < 1e-9);
/// ```
pub fn nearest_manifold<R: Scalar>(
    first: &ColliderShape<R>,
    first_at: &Isometry<R>,
    second: &ColliderShape<R>,
    second_at: &Isometry<R>,
    margin: R,
) -> Manifold<R> {
    if first_at.is_somewhere() && second_at.is_somewhere() {
        convex_and_convex([first, second], [first_at, second_at], margin, None)
    } else {
        Manifold::none()
    }
}

/// Shows how all parts of two shapes touch: for each pair of parts that are near, the number of the
/// pair and the manifold, as [`contact_manifold`] has them.
///
/// Parts are those of a compound and, of a mesh or a height field, its flat pieces, edges and
/// corners. The number of a pair is the same from step to step, in no particular order, and zero
/// for shapes of one part; of shapes that have more than 2^32 pairs of parts between them, some
/// share a number. Manifolds without points are left out.
///
/// ```
/// use std::sync::Arc;
/// use tumble_collide::{ColliderShape, Compound, Isometry, contact_manifolds};
/// use tumble_math::lane::Vec3;
///
/// let sphere =
///     |x: f64| (Isometry::at(Vec3::new(x, 0.0, 0.0)), ColliderShape::Sphere { radius: 0.5 });
/// let dumbbell = ColliderShape::Compound(Arc::new(Compound::new([sphere(-1.0), sphere(1.0)])));
/// let mut found = Vec::new();
/// let (ground, above) = (Isometry::at(Vec3::zero()), Isometry::at(Vec3::new(0.0, 0.5, 0.0)));
/// contact_manifolds(
///     &ColliderShape::HalfSpace,
///     &ground,
///     &dumbbell,
///     &above,
///     0.02,
///     &mut |pair, manifold| {
///         found.push((pair, manifold.points()[0].position.x));
///     },
/// );
/// assert_eq!(found, [(0, -1.0), (1, 1.0)]);
/// ```
pub fn contact_manifolds<R: Scalar>(
    first: &ColliderShape<R>,
    first_at: &Isometry<R>,
    second: &ColliderShape<R>,
    second_at: &Isometry<R>,
    margin: R,
    visit: &mut impl FnMut(u32, &Manifold<R>),
) {
    if !is_composed(first) && !is_composed(second) {
        let manifold = single([first, second], [first_at, second_at], margin, None);
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

fn is_composed<R>(shape: &ColliderShape<R>) -> bool {
    matches!(shape, ColliderShape::Compound(_) | ColliderShape::Mesh(_) | ColliderShape::HeightField(_))
}

/// The same where one has parts, with the numbers of the parts of either.
fn composed<R: Scalar>(
    [first, second]: [&ColliderShape<R>; 2],
    [first_at, second_at]: [&Isometry<R>; 2],
    margin: R,
    visit: Visit<'_, R>,
) {
    use ColliderShape::{Compound, HalfSpace, HeightField, Mesh};
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
        _ => visit([0, 0], &single([first, second], [first_at, second_at], margin, None)),
    }
}

/// Whether the boxes of two shapes meet; of what has no end they always do.
fn are_near<R: Scalar>(shapes: [&ColliderShape<R>; 2], at: [&Isometry<R>; 2], margin: R) -> bool {
    let aabb = |which: usize, margin: R| shapes[which].aabb(at[which], margin);
    aabb(0, margin).zip(aabb(1, R::splat(0.0))).is_none_or(|(a, b)| a.meets(&b))
}

/// Of two shapes the one with the lower rank is the first; of equal ones either may be.
fn rank<R>(shape: &ColliderShape<R>) -> u32 {
    match shape {
        ColliderShape::HalfSpace => 0,
        ColliderShape::Cuboid { .. } => 1,
        ColliderShape::Hull(_) => 2,
        ColliderShape::Cylinder { .. } => 3,
        ColliderShape::Cone { .. } => 4,
        ColliderShape::Frustum { .. } => 5,
        ColliderShape::Capsule { .. } => 6,
        ColliderShape::TaperedCapsule { .. } => 7,
        ColliderShape::Ellipsoid { .. } => 8,
        ColliderShape::Sphere { .. } => 9,
        ColliderShape::Mesh(_) | ColliderShape::HeightField(_) | ColliderShape::Compound(_) => 10,
    }
}

/// Two shapes of one part each, or a half-space and a surface; with the normal that they had a
/// moment ago, if they had one.
fn single<R: Scalar>(
    [first, second]: [&ColliderShape<R>; 2],
    [first_at, second_at]: [&Isometry<R>; 2],
    margin: R,
    near: Option<Vec3<R>>,
) -> Manifold<R> {
    use ColliderShape::{Capsule, Cuboid, HalfSpace, Sphere};
    if !first_at.is_somewhere() || !second_at.is_somewhere() {
        return Manifold::none();
    }
    if rank(first) > rank(second) {
        let near = near.map(|normal| normal * R::splat(-1.0));
        return single([second, first], [second_at, first_at], margin, near).swapped();
    }
    match (first, second) {
        (&Sphere { radius: a }, &Sphere { radius: b }) => {
            sphere_and_sphere(a, first_at.position, b, second_at.position, margin)
        }
        (&Cuboid { half_extents }, &Sphere { radius }) => {
            cuboid_and_sphere(half_extents, first_at, radius, second_at.position, margin)
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
        (&Capsule { radius: a, half_height }, &Sphere { radius: b }) => {
            capsule_and_sphere(&Rod::new(a, half_height, first_at), b, second_at.position, margin)
        }
        (&Capsule { radius: a, half_height: h }, &Capsule { radius: b, half_height: k }) => {
            capsule_and_capsule(&Rod::new(a, h, first_at), &Rod::new(b, k, second_at), margin)
        }
        (HalfSpace, HalfSpace) => Manifold::none(),
        (HalfSpace, &Sphere { radius }) => half_space_and_sphere(first_at, radius, second_at.position, margin),
        (HalfSpace, &Cuboid { half_extents }) => half_space_and_cuboid(first_at, half_extents, second_at, margin),
        (HalfSpace, &Capsule { radius, half_height }) => {
            half_space_and_capsule(first_at, radius, half_height, second_at, margin)
        }
        (HalfSpace, _) => half_space_and_other(first_at, second, second_at, margin),
        _ => convex_and_convex([first, second], [first_at, second_at], margin, near),
    }
}
