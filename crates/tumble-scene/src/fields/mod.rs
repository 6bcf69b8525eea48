//! Numbers of a scene by their path, and worlds of one scene that differ in them.

pub(crate) mod body_path;
pub(crate) mod field_path;
pub(crate) mod file_scene;
pub(crate) mod force_path;
pub(crate) mod joint_path;
pub(crate) mod scene_template;
pub(crate) mod varied_scene;
