//! A half-space against what is not a ball, a box or a capsule.

use crate::collider_shape::{ColliderShape, Isometry};
use crate::convex_pair::wide_placement;
use crate::feature::Near;
use crate::manifold::{ContactPoint, Manifold, Points};
use crate::scalar::Scalar;
use crate::support_map::{Convex, Vector, narrow};
use crate::underside::stood_on;

/// From the half-space to points of the shape: for a hull or a surface all corners that are near,
/// for what is round the corners of what it lies on.
pub(crate) fn half_space_and_other<R: Scalar>(
    ground: &Isometry<R>,
    shape: &ColliderShape<R>,
    at: &Isometry<R>,
    margin: R,
) -> Manifold<R> {
    let (ground_at, body) = (wide_placement(ground), wide_placement(at));
    let up = body.orientation.rotate_back(ground_at.up());
    let below = body.to_local(ground_at.position);
    let near = |corner: Vector, feature: u32| {
        let height = up.dot(corner - below);
        let point = ContactPoint { position: corner - up * (0.5 * height), separation: height, feature };
        (height <= margin.into()).then_some(point)
    };
    let of_all = |corners: &[Vector]| {
        let points = corners.iter().zip(0..).filter_map(|(corner, index)| near(*corner, index));
        stood_on(points, up, margin.into())
    };
    let points = match shape {
        ColliderShape::Mesh(mesh) => of_all(mesh.points()),
        ColliderShape::HeightField(field) => of_all(field.points()),
        _ => match Convex::of(shape) {
            Some((Convex::Hull(hull), _)) => of_all(hull.points()),
            Some((support_map, _)) => {
                let down = up * -1.0;
                let margin: f64 = margin.into();
                let near_ground = Near::at(up.dot(support_map.support(down) - below), margin);
                let feature = match support_map {
                    Convex::Frustum(frustum) => {
                        frustum.cap::<4>(down, near_ground).unwrap_or_else(|| frustum.side(down))
                    }
                    _ => support_map.feature(down, near_ground),
                };
                let points = feature.corners().iter().filter_map(|corner| near(corner.at, corner.id));
                stood_on(points, up, margin)
            }
            None => Points::none(),
        },
    };
    let manifold = Manifold::new(up, 1.0, points);
    manifold.seen(|point| at.to_world(narrow(point)), |_| ground.up())
}
