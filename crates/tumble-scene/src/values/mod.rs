//! Values in scene files: checks and lists.

pub(crate) mod checked;
pub(crate) mod tuple;
