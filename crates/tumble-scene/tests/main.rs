//! Files of scenes, built-in scenes and their fields.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking, in its helper functions too")]

mod axes;
mod builtin_scenes;
#[path = "../../tumble-import/tests/cases/mod.rs"]
mod cases;
mod colliders;
mod contact_scenes;
mod file_sweeps;
mod force_scenes;
mod forces;
mod gear_files;
mod gltf_bodies;
mod gltf_joints;
mod gltf_physics;
mod ground;
mod joint_files;
mod joint_ranges;
mod joint_scenes;
mod joint_sweeps;
mod locked_axes;
mod mesh_files;
mod named_files;
mod never_panics;
mod precision;
mod robot_joints;
mod robots;
mod spinning_scenes;
mod stress_scene;
mod urdf;
mod written_joints;
