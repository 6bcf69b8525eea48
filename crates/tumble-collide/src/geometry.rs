use tumble_math::lane::{Quat, Vec3};

use crate::bounds::Bounds;
use crate::scalar::Scalar;

/// A shape that others can touch, in its own frame. Lengths are in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Geometry<R> {
    /// A ball about the origin.
    Ball {
        /// \[m\]
        radius: R,
    },
    /// A box about the origin.
    Cuboid {
        /// Half the lengths of its edges along x, y and z \[m\].
        half_extents: Vec3<R>,
    },
    /// All below the plane y = 0: ground without end.
    HalfSpace,
}

/// Where the frame of a shape is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement<R> {
    /// Its origin \[m\].
    pub position: Vec3<R>,
    /// Unit quaternion from the shape's coordinates to the world's.
    pub orientation: Quat<R>,
}

impl<R: Scalar> Placement<R> {
    /// Not turned.
    pub fn at(position: Vec3<R>) -> Self {
        let zero = Vec3::zero();
        Self { position, orientation: Quat::from_parts(R::splat(1.0), zero) }
    }

    /// World coordinates of a point of the shape.
    #[inline]
    pub(crate) fn to_world(self, point: Vec3<R>) -> Vec3<R> {
        self.position + self.orientation.rotate(point)
    }

    /// The shape's coordinates of a point of the world.
    #[inline]
    pub(crate) fn to_local(self, point: Vec3<R>) -> Vec3<R> {
        self.orientation.rotate_back(point - self.position)
    }
}

impl<R: Scalar> Geometry<R> {
    /// The smallest box along the world's axes that holds the shape, and `margin` \[m\] around it; `None` for what has no end.
    pub fn bounds(&self, at: &Placement<R>, margin: R) -> Option<Bounds<R>> {
        let half = match *self {
            Self::Ball { radius } => Vec3::splat(radius),
            Self::Cuboid { half_extents: h } => {
                let [x, y, z] = at.orientation.axes();
                let reach = |x: R, y: R, z: R| x.abs() * h.x + y.abs() * h.y + z.abs() * h.z;
                Vec3::new(reach(x.x, y.x, z.x), reach(x.y, y.y, z.y), reach(x.z, y.z, z.z))
            }
            Self::HalfSpace => return None,
        };
        Some(Bounds::about(at.position, half + Vec3::splat(margin)))
    }

    /// The longest distance of a point of the shape from its origin \[m\]; `None` for what has no end.
    pub fn reach(&self) -> Option<R> {
        match *self {
            Self::Ball { radius } => Some(radius),
            Self::Cuboid { half_extents } => Some(half_extents.dot(half_extents).sqrt()),
            Self::HalfSpace => None,
        }
    }
}
