//! Two convex shapes of any kind: the direction in which they are furthest apart or overlap least,
//! and the points where they are nearest along it.

use tumble_math::lane::{Quat, Vec3};

use crate::collider_shape::{ColliderShape, Isometry};
use crate::common_normal::{CommonNormal, common_normal_again};
use crate::epa::{Penetration, penetration, penetration_of_flat};
use crate::face_clipping::FaceClipping;
use crate::feature::Near;
use crate::gjk::{Nearest, nearest};
use crate::manifold::Manifold;
use crate::minkowski::Difference;
use crate::scalar::Scalar;
use crate::support_map::{Convex, Vector, narrow, unit, wide};

/// A face is taken for a direction between edges that separates by no more than this \[m\]: it
/// holds a body better, and a choice that changes back and forth holds it worst.
pub(crate) const FACE_LEAD: f64 = 5e-4;
/// Where something is round, by no more than what its direction is uncertain by.
const ROUND_LEAD: f64 = 1e-7;

/// How two shapes are to each other, in the frame of the first.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Approach {
    /// Unit vector from the first to the second.
    pub(crate) normal: Vector,
    /// Of what is inside the layers, along the normal.
    pub(crate) between: f64,
    /// By how much a direction that was not taken would separate them more.
    pub(crate) lead: f64,
    /// On the inner surface of the first.
    pub(crate) on_first: Vector,
}

/// How two shapes are to each other, unless what is inside their layers is further apart than
/// `limit`, or nothing is finite.
pub(crate) fn approach(shapes: &Difference<'_>, limit: f64) -> Option<Approach> {
    let found = match nearest(shapes, limit) {
        Nearest::Far => return None,
        Nearest::Apart { between, on_first } => {
            let distance = between.dot(between).sqrt();
            Approach { normal: between * (1.0 / distance), between: distance, lead: 0.0, on_first }
        }
        Nearest::Overlap(simplex) => {
            let found = penetration(shapes, &simplex).unwrap_or_else(|| flat(shapes));
            let between = shapes.separation(found.normal);
            Approach { normal: found.normal, between, lead: 0.0, on_first: found.on_first }
        }
    };
    let is_finite = found.between < limit && found.normal.dot(found.normal) > 0.5;
    is_finite.then_some(found)
}

/// The same of shapes that had this unit normal a moment ago, in the frame of the first.
fn approach_again(shapes: &Difference<'_>, near: Option<Vector>, limit: f64) -> Option<Approach> {
    let again = near.and_then(|near| {
        let found = common_normal_again(shapes, near)?;
        // What overlaps has others, of faces that are turned away: worse than the old one.
        let holds = found.separation > 0.0 || (found.separation >= shapes.separation(near) && has_both(shapes, &found));
        holds.then_some(found)
    });
    match again {
        Some(CommonNormal { normal, separation, on_first }) => {
            (separation < limit).then_some(Approach { normal, between: separation, lead: 0.0, on_first })
        }
        None => approach(shapes, limit),
    }
}

/// Whether the middle between nearest points is inside both shapes, which then overlap.
fn has_both(shapes: &Difference<'_>, found: &CommonNormal) -> bool {
    let middle = found.on_first + found.normal * (0.5 * found.separation);
    shapes.first.contains(middle) && shapes.second.contains(shapes.turned_back(middle - shapes.position))
}

/// Shapes whose difference has no volume: a point in a triangle, or edges that cross.
fn flat(shapes: &Difference<'_>) -> Penetration {
    let apart = shapes.place(shapes.second.middle()) - shapes.first.middle();
    let up = Vector::new(0.0, 1.0, 0.0);
    // A triangle without area has none.
    let of_face = shapes.first.face_normal(apart).filter(|normal| normal.dot(*normal) > 0.5);
    let normal = of_face.unwrap_or(if apart.dot(apart) > 0.0 { unit(apart) } else { up });
    penetration_of_flat(shapes, normal)
}

/// Along the normal of a face of either where that is as good.
pub(crate) fn with_faces_first(shapes: &Difference<'_>, found: &Approach) -> Approach {
    let faceted = shapes.first.is_faceted() && shapes.second.is_faceted();
    let lead = if faceted { FACE_LEAD } else { ROUND_LEAD };
    let of_first = shapes.first.face_normal(found.normal);
    let of_second = shapes.second.face_normal(shapes.turned_back(found.normal * -1.0));
    let faces = [of_first, of_second.map(|normal| shapes.turn(normal) * -1.0)];
    let mut best = found.between;
    let separations = faces.map(|face| face.map(|normal| (normal, shapes.separation(normal))));
    for (_, separation) in separations.into_iter().flatten() {
        if separation > best {
            best = separation;
        }
    }
    let taken = separations.into_iter().flatten().find(|(_, separation)| *separation >= best - lead);
    taken.map_or(*found, |(normal, between)| Approach { normal, between, lead: best - between, ..*found })
}

/// A placement in double precision.
pub(crate) fn wide_placement<R: Scalar>(at: &Isometry<R>) -> Isometry<f64> {
    let Quat { x, y, z, w } = at.orientation;
    let orientation = Quat { x: x.into(), y: y.into(), z: z.into(), w: w.into() };
    Isometry { position: wide(at.position), orientation: orientation.normalize() }
}

/// Two shapes as seen from the first; `None` where either is nowhere.
pub(crate) fn difference<'a>(
    first: Convex<'a>,
    first_at: &Isometry<f64>,
    second: Convex<'a>,
    second_at: &Isometry<f64>,
) -> Option<Difference<'a>> {
    let position = first_at.to_local(second_at.position);
    let [x, y, z] = second_at.orientation.axes();
    let turned = |axis: Vector| first_at.orientation.rotate_back(axis);
    let axes = [turned(x), turned(y), turned(z)];
    let size = position.dot(position) + axes[0].dot(axes[0]) + axes[1].dot(axes[1]) + axes[2].dot(axes[2]);
    size.is_finite().then_some(Difference { first, second, position, axes })
}

/// The points of an approach, in the frame of the first.
pub(crate) fn manifold_of(shapes: &Difference<'_>, found: &Approach, layers: [f64; 2], margin: f64) -> Manifold<f64> {
    let Approach { normal, between, lead, on_first } = *found;
    let separation = between - (layers[0] + layers[1]);
    let middles = [shapes.first.middle(), shapes.place(shapes.second.middle())];
    let face_clipping = FaceClipping { normal, separation, layers, margin };
    let near = Near::at(separation, margin);
    let of_first = shapes.first.feature(normal, near);
    let of_second = shapes.second.feature(shapes.turned_back(normal * -1.0), near);
    let of_second = of_second.seen(|point| shapes.place(point), |v| shapes.turn(v));
    let nearest = on_first + normal * (layers[0] + 0.5 * separation);
    face_clipping.manifold(&of_first, &of_second, nearest, lead, middles)
}

/// From the first to the second; along the normal that they had a moment ago, world frame, if they
/// have one near it.
pub(crate) fn convex_and_convex<R: Scalar>(
    [first, second]: [&ColliderShape<R>; 2],
    [first_at, second_at]: [&Isometry<R>; 2],
    margin: R,
    near: Option<Vec3<R>>,
) -> Manifold<R> {
    let found = Convex::of(first).zip(Convex::of(second)).and_then(|((first, layer_1), (second, layer_2))| {
        let at = wide_placement(first_at);
        let shapes = difference(first, &at, second, &wide_placement(second_at))?;
        let (layers, margin) = ([layer_1, layer_2], margin.into());
        let near = near.map(|normal| at.orientation.rotate_back(unit(wide(normal))));
        let found = approach_again(&shapes, near, margin + layer_1 + layer_2)?;
        // What has a layer around it is round at its edges.
        let found = if layer_1 + layer_2 > 0.0 { found } else { with_faces_first(&shapes, &found) };
        Some(manifold_of(&shapes, &found, layers, margin))
    });
    found.map_or(Manifold::none(), |manifold| {
        manifold.seen(|point| first_at.to_world(narrow(point)), |v| first_at.orientation.rotate(narrow(v)))
    })
}
