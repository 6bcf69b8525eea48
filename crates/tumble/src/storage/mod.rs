//! The one way to the components of bodies in a `hecs::World`: chunks of columns, and bodies by
//! index.

pub(crate) mod body_index;
pub(crate) mod body_order;
pub(crate) mod chunk;
pub(crate) mod plain_chunk;
pub(crate) mod tile_io;
pub(crate) mod type_marks;
pub(crate) mod world_columns;
