//! Bodies as they are made: from a shape and a mass to components, one by one or in batches.

pub(crate) mod body_columns;
pub(crate) mod body_error;
pub(crate) mod bundle;
pub(crate) mod change_mass;
pub(crate) mod rigid_body;
pub(crate) mod set_velocity;
pub(crate) mod spawn_bodies;
pub(crate) mod spawn_ground;
pub(crate) mod weld;
