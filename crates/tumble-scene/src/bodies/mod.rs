//! Bodies of a scene: what is to be spawned, with its forces.

pub(crate) mod file_joint;
pub(crate) mod force;
pub(crate) mod joint_options;
pub(crate) mod scene_body;
pub(crate) mod scene_joint;
pub(crate) mod scene_joints;
