//! All differences of a point of one convex shape and a point of another: how far the origin is
//! from this set is how far the shapes are apart.

use crate::support_map::{Convex, Vector};
use crate::work;

/// Two convex shapes, seen from the first.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Difference<'a> {
    pub(crate) first: Convex<'a>,
    pub(crate) second: Convex<'a>,
    /// The second shape's origin.
    pub(crate) position: Vector,
    /// The second shape's axes.
    pub(crate) axes: [Vector; 3],
}

/// A point of the difference, and the point of the first shape that it is made of.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reached {
    pub(crate) point: Vector,
    pub(crate) on_first: Vector,
}

impl Difference<'_> {
    /// The furthest in a direction.
    pub(crate) fn support(&self, d: Vector) -> Reached {
        work::reached();
        let on_first = self.first.support(d);
        Reached { point: on_first - self.second_support(d * -1.0), on_first }
    }

    /// The second shape's furthest point in a direction.
    pub(crate) fn second_support(&self, d: Vector) -> Vector {
        self.place(self.second.support(self.turned_back(d)))
    }

    /// Whether either is round somewhere.
    pub(crate) fn has_round_core(&self) -> bool {
        self.first.has_round_core() || self.second.has_round_core()
    }

    /// How far they are apart along a unit vector from the first to the second; negative where they
    /// overlap.
    pub(crate) fn separation(&self, normal: Vector) -> f64 {
        -self.support(normal).point.dot(normal)
    }

    /// From the second shape's coordinates to the first's: of a point,
    pub(crate) fn place(&self, point: Vector) -> Vector {
        self.position + self.turn(point)
    }

    /// of a direction,
    pub(crate) fn turn(&self, v: Vector) -> Vector {
        self.axes[0] * v.x + self.axes[1] * v.y + self.axes[2] * v.z
    }

    /// and back.
    pub(crate) fn turned_back(&self, v: Vector) -> Vector {
        Vector::new(self.axes[0].dot(v), self.axes[1].dot(v), self.axes[2].dot(v))
    }
}
