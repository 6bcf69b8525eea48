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
mod collide;
mod cuboids;
mod geometry;
mod half_space;
pub mod lanes;
mod manifold;
mod reduction;
mod scalar;

pub use bounds::Bounds;
pub use broad_phase::{BroadPhase, Proxy};
pub use collide::collide;
pub use geometry::{Geometry, Placement};
pub use manifold::{ContactPoint, MOST_POINTS, Manifold};
pub use scalar::Scalar;
