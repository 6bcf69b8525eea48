//! Mechanisms: bodies that hang together by joints, with all their joints solved at once by a
//! sparse direct factorisation.
//!
//! A substep is SHAKE and RATTLE over the engine's free motion: impulses such that the joints are
//! met where the bodies end up, and velocities along the joints in the end (R. I. McLachlan,
//! K. Modin, O. Verdier, M. Wilkins, "Geometric generalisations of SHAKE and RATTLE", 2014).

pub(crate) mod block_kernels;
mod block_layout;
pub(crate) mod block_ldl;
mod body_passes;
pub(crate) mod contact_responses;
pub(crate) mod elimination;
pub(crate) mod fours;
mod free_axis;
pub(crate) mod free_row;
mod free_row_bounds;
pub(crate) mod gear_rows;
pub(crate) mod joint_anchor;
mod joint_free_rows;
pub(crate) mod joint_potential;
pub(crate) mod joint_rows;
mod joint_values;
mod matrix_inputs;
pub(crate) mod mechanism_body;
mod mechanism_free_rows;
mod mechanism_matrix;
pub(crate) mod mechanism_misfit;
mod mechanism_rows;
pub(crate) mod mechanism_solver;
mod mechanism_substeps;
pub(crate) mod mechanisms;
pub(crate) mod passed_joints;
mod pinned_joints;
mod pinned_kind;
mod pinned_matrix;
#[cfg(test)]
mod pinned_tests;
pub(crate) mod raised_inertia;
pub(crate) mod rotations;
pub(crate) mod row_spring;
mod touched_mechanism;
mod touched_mechanisms;
