//! Bodies of any source: what is to be spawned, with its collider and its appearance.

pub(crate) mod appearance;
pub(crate) mod collider;
pub(crate) mod collider_geometry;
pub(crate) mod force;
pub(crate) mod scene_body;
pub(crate) mod surface_material;
