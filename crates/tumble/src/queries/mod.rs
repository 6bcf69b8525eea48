//! Queries: what rays meet, what is near a point, what a shape overlaps or is stopped by.
//!
//! They read the poses and colliders that a world has now, whoever wrote them.

pub(crate) mod hits;
pub(crate) mod query_cache;
pub(crate) mod query_filter;
pub(crate) mod query_index;
pub(crate) mod ray;
pub(crate) mod world_queries;

pub use crate::queries::hits::{PartHit, PointHit, RayHit, ShapeHit};
pub use crate::queries::query_filter::QueryFilter;
pub use crate::queries::query_index::QueryIndex;
pub use crate::queries::ray::Ray;
pub use crate::queries::world_queries::Queries;
