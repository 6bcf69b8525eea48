//! The solver: bodies that interact are advanced in substeps under their contacts.

pub(crate) mod block_parts;
pub(crate) mod body_rows;
pub(crate) mod constrained_bodies;
pub(crate) mod contact;
pub(crate) mod contact_work;
pub(crate) mod direct;
pub(crate) mod energy_bounds;
pub(crate) mod gather_scatter;
pub(crate) mod gather_tiles;
pub(crate) mod graph_coloring;
pub(crate) mod halved_substeps;
pub(crate) mod joint_passes;
pub(crate) mod locked_bodies;
pub(crate) mod mechanism;
pub(crate) mod multi_world;
pub(crate) mod solver_bodies;
pub(crate) mod stack;
pub(crate) mod stages;
pub(crate) mod stale_impulses;
pub(crate) mod substeps;
