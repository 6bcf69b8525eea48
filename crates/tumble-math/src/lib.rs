//! placeholder

pub mod lane;

mod decay;
mod free_rotation;
mod orientation;

pub use decay::{Decay, decay};
pub use free_rotation::{LARGEST_KAPPA, MOST_PARTS, rotate_freely};
pub use orientation::{orientation_rate, rotate_exactly, rotate_to_first_order};

mod euler;
mod inertia;
mod inertia_error;
mod kinematics;
mod mass_error;
mod mass_properties;
mod principal;
mod rotation;
mod shape;
mod shape_error;
mod solids;
mod symmetric_eigen;
mod unit;

pub use euler::to_euler;
pub use glam::EulerRot;
pub use inertia::InertiaTensor;
pub use inertia_error::InertiaError;
pub use kinematics::{
    ForceAndTorque, angular_acceleration, moment_about_axis, torque_for_angular_acceleration, velocity_at_point,
};
pub use mass_error::MassError;
pub use mass_properties::MassProperties;
pub use principal::PrincipalInertia;
pub use rotation::{
    NotARotation, ROTATION_TOLERANCE, angle_between, change_of_basis, cross_product_matrix, from_scaled_axis, left_multiplication_matrix,
    quat_from_matrix, right_multiplication_matrix, to_axis_angle, to_scaled_axis,
};
pub use shape::{Amount, Part, Shape};
pub use shape_error::{ShapeError, ShapeErrorReason};
