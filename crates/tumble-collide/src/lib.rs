//! Where shapes touch: which of them are near each other, and the points, normals and distances of those that are.
//!
//! Nothing here knows of mass, velocity or time. All is generic over the precision, [`Scalar`], and does the same in the same order on
//! every machine: basic IEEE arithmetic, ties broken by index.
//!
//! ```
//! use tumble_collide::{Geometry, Placement, collide};
//! use tumble_math::lane::Vec3;
//!
//! let ball = Geometry::Ball { radius: 0.5 };
//! let (ground, origin) = (Geometry::HalfSpace, Placement::at(Vec3::zero()));
//! let above = Placement::at(Vec3::new(0.0, 0.49, 0.0));
//! let manifold = collide(&ground, &origin, &ball, &above, 0.02);
//! // The ball is a centimetre inside the ground, whose surface looks up to it.
//! assert_eq!((manifold.normal.y, manifold.points().len()), (1.0, 1));
//! assert!((manifold.points()[0].separation - -0.01_f64).abs() < 1e-15);
//! ```

mod ball;
mod balls;
mod bounds;
mod broad_phase;
mod capsule;
mod cast;
mod collide;
mod compound;
mod convex;
mod convex_hull;
mod convex_pair;
mod course;
mod cuboids;
mod epa;
mod feature;
mod frustum;
mod furthest;
mod geometry;
mod gjk;
mod half_space;
mod half_space_pair;
mod height_field;
pub mod lanes;
mod manifold;
mod mesh;
mod minkowski;
mod overlay;
#[cfg(test)]
mod pair_tests;
mod reduction;
mod scalar;
mod surface;
mod surface_pair;
mod tree;
mod underside;
mod work;

pub use bounds::Bounds;
pub use broad_phase::{BroadPhase, Proxy};
pub use cast::{Follow, Meeting};
pub use collide::{collide, touching};
pub use compound::Compound;
pub use convex_hull::ConvexHull;
pub use course::Course;
pub use geometry::{Geometry, Placement};
pub use height_field::{HeightField, HeightFieldError};
pub use manifold::{ContactPoint, MAX_MANIFOLD_POINTS, Manifold};
pub use mesh::Mesh;
pub use scalar::Scalar;
#[cfg(feature = "count-work")]
pub use work::work_done;

/// The snippet of the README, run as a doctest.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
