//! Manifolds of several pairs side by side, for callers with lanes of their own.
//!
//! Everything here is `#[inline(always)]`, and what calls it must be too, down from where the
//! instruction set of the lanes is enabled.

use tumble_math::lane::{Lane, Vec3};

use crate::manifold::{ContactPoint, MAX_MANIFOLD_POINTS, Manifold, Points};
use crate::scalar::Scalar;

pub use crate::cuboids::{CuboidLanes, cuboid_gap, cuboid_pair, cuboid_reach};
pub use crate::sphere_lanes::sphere_pair;

/// How pairs of shapes touch, each as a [`Manifold`] says it.
///
/// ```
/// use tumble_collide::lanes::sphere_pair;
/// use tumble_math::lane::Vec3;
///
/// // One pair is a lane of one.
/// let apart = sphere_pair(1.0, 0.5, Vec3::new(2.0_f64, 0.0, 0.0), 0.02);
/// assert_eq!(apart.count, 0.0);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct ManifoldLanes<L> {
    /// Unit vectors from the first shapes to the second, world frame.
    pub normal: Vec3<L>,
    /// How far the points go along with the second shape, from 0 to 1.
    pub carried: L,
    /// How many points there are, from 0 to 4.
    pub count: L,
    /// The points half-way between the surfaces, from the second shape's origin along the world's
    /// axes \[m\].
    pub places: [Vec3<L>; MAX_MANIFOLD_POINTS],
    /// Distance of the surfaces along the normal there \[m\].
    pub separations: [L; MAX_MANIFOLD_POINTS],
    /// Which vertices, edges and faces meet there, as whole numbers below 2^24.
    pub features: [L; MAX_MANIFOLD_POINTS],
}

impl<R: Scalar> ManifoldLanes<R> {
    /// The manifold of one pair whose second shape has its origin here.
    pub(crate) fn of_one(&self, origin: Vec3<R>) -> Manifold<R> {
        let mut points = Points::none();
        for j in 0..MAX_MANIFOLD_POINTS {
            if R::splat(j as f64) < self.count {
                points.push(ContactPoint {
                    position: origin + self.places[j],
                    separation: self.separations[j],
                    feature: Into::<f64>::into(self.features[j]) as u32,
                });
            }
        }
        if points.is_empty() { Manifold::none() } else { Manifold::new(self.normal, self.carried, points) }
    }
}

/// More than any length \[m\].
pub(crate) const FAR: f64 = 1e30;

/// -1 below zero, else 1.
#[inline(always)]
pub(crate) fn sign<L: Lane>(x: L) -> L {
    let one = L::splat(1.0);
    L::select(x.lt(L::splat(0.0)), -one, one)
}
