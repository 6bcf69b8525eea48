//! Joints in passes: those of nets, whose matrix would fill up, one after the other as contacts
//! are, in blocks of the same colors and with the same soft constraints.

pub(crate) mod joint_block;
pub(crate) mod joint_sheet;
pub(crate) mod loaded_bodies;
pub(crate) mod pass_joints;
pub(crate) mod pass_stages;
mod small_ldl;
