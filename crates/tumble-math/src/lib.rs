//! The mathematics of one rigid body: rotations, inertia tensors, mass properties of shapes, free
//! rotation.
//!
//! ```
//! use tumble_math::{Amount, Part, Shape};
//!
//! // A hammer: its mass, its centre of mass, and the axes about which it spins freely.
//! let handle = Part::new(Shape::cylinder(0.012, 0.15), Amount::Density(700.0));
//! let head = Part::new(Shape::cuboid([0.06, 0.015, 0.015]), Amount::Density(7850.0))
//!     .at([0.0, 0.15, 0.0]);
//! let hammer = Shape::compound([handle, head]).own_mass_properties()?;
//! assert!((hammer.mass() - 0.943).abs() < 1e-3);
//! assert!((hammer.center_of_mass().y - 0.135).abs() < 1e-3);
//! let principal = hammer.inertia()?.principal();
//! assert!(principal.spin_instability(0) > 0.0); // about its head it flips over
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Everything that is done once, when a body is made, is in f64. What runs in every step is written
//! once over [`lane::Lane`] and takes f32, f64 or a vector of either.
//!
//! # Conventions
//!
//! - SI units. Vectors are columns; `R(q) v` takes body to world coordinates.
//! - Quaternions are glam's, `(x, y, z, w)` with `w` the scalar; `a * b` turns by `b` first.
//! - The off-diagonal elements of an inertia tensor are minus the integrals of `x y`, `y z` and
//!   `x z`.
//! - Angles are in radians. `EulerRot::XYZ` turns about moving axes, `EulerRot::XYZEx` about fixed
//!   ones.
//!
//! # What to take from glam
//!
//! glam's types are used as they are, and what glam does exactly is not wrapped: products,
//! conjugates, [slerp](glam::DQuat::slerp), [quaternion to matrix](glam::DMat3::from_quat),
//! [axis and angle to quaternion](glam::DQuat::from_axis_angle) and
//! [to matrix](glam::DMat3::from_axis_angle),
//! [Euler angles to quaternion](glam::DQuat::from_euler),
//! [4x4 transforms](glam::DMat4::from_rotation_translation). Its ways back lose digits in places;
//! use [`to_axis_angle`], [`to_scaled_axis`], [`to_euler`], [`angle_between`] and the checked
//! [`quat_from_matrix`] of this crate.

// On docs.rs items say which feature they need.
#![cfg_attr(docsrs, feature(doc_cfg))]

pub mod lane;

/// Gives error types the `Debug` that they are `Display`ed by, so that a `main` which returns one
/// ends with a sentence.
#[doc(hidden)]
#[macro_export]
macro_rules! debug_as_display {
    ($($Error:ty),+) => {
        $(impl std::fmt::Debug for $Error {
            fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                std::fmt::Display::fmt(self, formatter)
            }
        })+
    };
}

mod decay;
mod free_rotation;
mod orientation;

pub use decay::{Decay, decay};
pub use free_rotation::{FreeRotation, LARGEST_KAPPA, MAX_PARTS, rotate_freely};
pub use orientation::{orientation_rate, rotate_exactly, rotate_to_first_order};

mod equivalent_ellipsoid;
mod euler;
mod inertia;
mod inertia_error;
mod kinematics;
mod mass_error;
mod mass_properties;
mod merge_bodies;
mod mesh;
mod nearest_rotation;
mod principal;
mod revolved;
mod rotation;
mod shape;
mod shape_error;
mod solids;
mod symmetric;
mod symmetric_eigen;
mod unit;
mod yaw_pitch_roll;

pub use equivalent_ellipsoid::equivalent_ellipsoid;
pub use euler::to_euler;
pub use glam::EulerRot;
pub use inertia::{InertiaTensor, parallel_axis};
pub use inertia_error::InertiaError;
pub use kinematics::{
    ForceAndTorque, angular_acceleration, moment_about_axis, torque_for_angular_acceleration, velocity_at_point,
};
pub use mass_error::MassError;
pub use mass_properties::MassProperties;
pub use merge_bodies::{MovingBody, WeldError, WeldedBody, weld};
pub use mesh::{HullError, MeshAudit, MeshDefect, MeshError, MeshRepair, SolidMesh, TriangleMesh, convex_hull};
pub use nearest_rotation::{change_of_basis_of_transform, nearest_rotation};
pub use principal::PrincipalInertia;
pub use rotation::{
    NotARotation, ROTATION_TOLERANCE, angle_between, change_of_basis, cross_product_matrix, from_scaled_axis,
    left_multiplication_matrix, quat_from_matrix, right_multiplication_matrix, to_axis_angle, to_scaled_axis,
};
pub use shape::{Amount, Part, Shape};
pub use shape_error::{ShapeError, ShapeErrorReason};
pub use yaw_pitch_roll::YawPitchRoll;
