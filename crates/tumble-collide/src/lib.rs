//! Where shapes touch: which of them are near each other, and the points, normals and distances of
//! those that are.
//!
//! Nothing here knows of mass, velocity or time. All is generic over the precision, [`Scalar`], and
//! does the same in the same order on every machine: basic IEEE arithmetic, ties broken by index.
//!
//! ```
//! use tumble_collide::{ColliderShape, Isometry, contact_manifold};
//! use tumble_math::lane::Vec3;
//!
//! let sphere = ColliderShape::Sphere { radius: 0.5 };
//! let (ground, origin) = (ColliderShape::HalfSpace, Isometry::at(Vec3::zero()));
//! let above = Isometry::at(Vec3::new(0.0, 0.49, 0.0));
//! let manifold = contact_manifold(&ground, &origin, &sphere, &above, 0.02);
//! // The sphere is a centimetre inside the ground, whose surface looks up to it.
//! assert_eq!((manifold.normal.y, manifold.points().len()), (1.0, 1));
//! assert!((manifold.points()[0].separation - -0.01_f64).abs() < 1e-15);
//! ```

mod aabb;
mod broad_phase;
mod bvh;
mod capsule;
mod cast;
#[cfg(test)]
mod cast_tests;
mod collider_shape;
mod common_normal;
mod compound;
mod contact_manifold;
mod convex_hull;
mod convex_pair;
mod course;
mod cuboids;
mod epa;
mod face_clipping;
mod feature;
mod frustum;
mod furthest;
mod gjk;
mod half_space;
mod half_space_pair;
mod height_field;
pub mod lanes;
mod manifold;
mod manifold_reduction;
mod mesh;
mod mesh_pair;
mod minkowski;
#[cfg(test)]
mod pair_tests;
mod passage;
mod query;
mod scalar;
mod segments;
mod sphere;
mod sphere_lanes;
mod support_map;
mod surface;
mod surface_cast;
mod surface_hits;
mod surface_piece;
mod triangle_approach;
mod triangle_cuboid;
#[cfg(test)]
mod triangle_tests;
mod underside;
mod work;

pub use aabb::Aabb;
pub use broad_phase::{BroadPhase, Proxy};
pub use cast::{Follow, Meeting};
pub use collider_shape::{ColliderShape, Isometry};
pub use compound::Compound;
pub use contact_manifold::{contact_manifold, contact_manifold_near, contact_manifolds, nearest_manifold};
pub use convex_hull::ConvexHull;
pub use course::Course;
pub use height_field::{HeightField, HeightFieldError};
pub use manifold::{ContactPoint, MAX_MANIFOLD_POINTS, Manifold};
pub use mesh::Mesh;
pub use passage::Passage;
pub use query::point::NearestPoint;
pub use query::query_tree::{QueryTree, TreeBox};
pub use query::ray::{Ray, ShapeRayHit};
pub use query::shape_cast::ShapeCastHit;
pub use scalar::Scalar;
#[cfg(feature = "count-work")]
pub use work::work_done;

/// The snippet of the README, run as a doctest.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
