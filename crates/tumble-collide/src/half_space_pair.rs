//! A half-space against what is not a ball, a box or a capsule.

use crate::convex::{Convex, Vector, narrow};
use crate::convex_pair::wide_placement;
use crate::geometry::{Geometry, Placement};
use crate::manifold::{ContactPoint, Manifold, Points};
use crate::overlay::{as_near, keep_nearest};
use crate::reduction::reduce;
use crate::scalar::Scalar;

/// Of more points than this near the surface the lowest are looked at.
const MOST: usize = 32;

/// The lowest points of something, those that are near a plane.
struct Lowest {
    points: [ContactPoint<f64>; MOST],
    len: usize,
    margin: f64,
}

impl Lowest {
    /// One more, with its height over the plane. Where there is no room it takes the place of the highest, if that is higher.
    fn add(&mut self, position: Vector, height: f64, feature: u32) {
        let is_near = height <= self.margin;
        if !is_near {
            return;
        }
        let point = ContactPoint { position, separation: height, feature };
        if let Some(slot) = self.points.get_mut(self.len) {
            *slot = point;
            self.len += 1;
            return;
        }
        let mut highest = 0;
        for index in 1..MOST {
            if self.points[index].separation > self.points[highest].separation {
                highest = index;
            }
        }
        if height < self.points[highest].separation {
            self.points[highest] = point;
        }
    }
}

/// From the half-space to points of the shape: for a hull or a surface all corners that are near, for what is round the corners of what it lies on.
pub(crate) fn half_space_and_other<R: Scalar>(
    ground: &Placement<R>,
    geometry: &Geometry<R>,
    at: &Placement<R>,
    margin: R,
) -> Manifold<R> {
    let (ground_at, body) = (wide_placement(ground), wide_placement(at));
    let up = body.orientation.rotate_back(ground_at.up());
    let below = body.to_local(ground_at.position);
    let nothing = ContactPoint { position: Vector::zero(), separation: 0.0, feature: 0 };
    let mut lowest = Lowest { points: [nothing; MOST], len: 0, margin: margin.into() };
    let mut add = |corner: Vector, feature: u32| {
        let height = up.dot(corner - below);
        lowest.add(corner - up * (0.5 * height), height, feature);
    };
    let mut all = |corners: &[Vector]| corners.iter().zip(0..).for_each(|(corner, index)| add(*corner, index));
    match geometry {
        Geometry::Mesh(mesh) => all(mesh.points()),
        Geometry::HeightField(field) => all(field.points()),
        _ => match Convex::of(geometry) {
            Some((Convex::Hull(hull), _)) => all(hull.points()),
            Some((convex, _)) => {
                let down = up * -1.0;
                let feature = match convex {
                    Convex::Frustum(frustum) => {
                        frustum.cap::<4>(down, margin.into()).unwrap_or_else(|| frustum.side(down))
                    }
                    _ => convex.feature(down, margin.into()),
                };
                feature.corners().iter().for_each(|corner| add(corner.at, corner.id));
            }
            None => {}
        },
    }
    let near = lowest.points.get(..lowest.len).unwrap_or_default();
    let mut points = if near.is_empty() { Points::none() } else { reduce(near, up, margin.into()) };
    keep_nearest(&mut points, near, as_near(near, margin.into()));
    let manifold = Manifold::new(up, 1.0, points);
    manifold.seen(|point| at.to_world(narrow(point)), |_| ground.up())
}
