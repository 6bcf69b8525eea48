//! Free motion, mass properties and rotations.

mod closed_forms;
mod conservation;
mod convergence;
mod conversions;
mod convex_hulls;
mod far_from_origin;
mod inertia_properties;
mod lengths_of_a_step;
mod locked_axes;
mod long_run;
mod matrix_drift;
mod meshes;
mod nesc;
mod particles_and_shapes;
mod peers_w2;
mod projectile;
mod published;
mod reference;
mod reference_inertia;
mod reference_meshes;
mod reference_rotations;
mod strategies;
mod tapered_shapes;
mod tops;
mod welding;
