//! Values in files: checks, lists, and words.

pub(crate) mod checked;
pub(crate) mod combine_rule;
pub(crate) mod tuple;
