//! What a scene file may say, and how it is read.

pub(crate) mod collider_model;
pub(crate) mod error_context;
pub(crate) mod force_model;
pub(crate) mod gear_model;
pub(crate) mod joint_model;
pub(crate) mod joint_options_model;
pub(crate) mod json_comments;
pub(crate) mod mesh_shape;
pub(crate) mod orientation_model;
pub(crate) mod parse;
pub(crate) mod scene_model;
pub(crate) mod shape_advice;
