//! Sphere-sphere contacts in SIMD lanes.

use tumble_math::lane::{Lane, Vec3};

use crate::lanes::ManifoldLanes;

/// Nearer than this \[m\] two points are one: its square is a normal number in either precision.
const MIN_DISTANCE: f64 = 1e-18;

/// How balls touch, `apart` being the way from the first centre to the second \[m\]. Balls about
/// the same point are pushed apart along y.
///
/// ```
/// use tumble_collide::lanes::sphere_pair;
/// use tumble_math::lane::Vec3;
///
/// let manifold = sphere_pair(1.0, 0.5, Vec3::new(1.49_f64, 0.0, 0.0), 0.02);
/// assert_eq!((manifold.count, manifold.normal.x), (1.0, 1.0));
/// assert!((manifold.separations[0] + 0.01).abs() < 1e-15);
/// // From the second centre to the middle of the overlap.
/// assert!((manifold.places[0].x + 0.495).abs() < 1e-15);
/// ```
#[inline(always)]
pub fn sphere_pair<L: Lane>(first: L, second: L, apart: Vec3<L>, margin: L) -> ManifoldLanes<L> {
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let distance = apart.dot(apart).sqrt();
    let up = Vec3::new(zero, one, zero);
    let normal = Vec3::select(L::splat(MIN_DISTANCE).lt(distance), apart * (one / distance), up);
    let separation = distance - (first + second);
    let place = normal * (zero - (second + separation * L::splat(0.5)));
    ManifoldLanes {
        normal,
        carried: L::splat(0.5),
        count: L::select(margin.lt(separation), zero, L::select(separation.lt(L::splat(f64::INFINITY)), one, zero)),
        places: [place; 4],
        separations: [separation; 4],
        features: [zero; 4],
    }
}
