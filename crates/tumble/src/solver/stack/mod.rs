//! Stacks: the loads of bodies on each other, and the substeps that they need to stand.

mod layers;
mod load_order;
pub(crate) mod stack_stiffness;
mod supports;
