//! Neutral bodies, as every source of them is read to: mass and motion, collider, appearance.

pub(crate) mod appearance;
pub(crate) mod collider_geometry;
pub(crate) mod imported_body;
pub(crate) mod imported_collider;
pub(crate) mod imported_gear;
pub(crate) mod imported_joint;
pub(crate) mod surface_material;
