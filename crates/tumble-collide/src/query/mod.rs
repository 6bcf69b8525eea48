//! Queries: rays and shapes that are cast, points and shapes that are tested, against one shape or
//! a tree of many boxes.
//!
//! All is computed in double precision, in the frame of the shape that is asked.

pub(crate) mod heights;
pub(crate) mod line;
pub(crate) mod overlap;
pub(crate) mod point;
pub(crate) mod query_tree;
pub(crate) mod ray;
pub(crate) mod round_line;
pub(crate) mod shape_cast;
pub(crate) mod triangle_line;
