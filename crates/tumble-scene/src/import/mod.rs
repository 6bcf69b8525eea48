//! Files of others, read to neutral bodies: glTF, URDF and mesh files.

pub mod gltf;
pub(crate) mod inertia_repair;
pub(crate) mod mesh_file;
pub(crate) mod named_files;
pub(crate) mod urdf;
