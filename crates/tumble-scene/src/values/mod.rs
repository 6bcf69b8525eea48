//! Values in scene files: checks and lists.

pub(crate) mod axes;
pub(crate) mod checked;
pub(crate) mod tuple;
